//! Pressures on surfaces that move: a surface that is closed, and derivatives by differences.

use super::{ROUND_OFF, distorted_cell, kinds};
use moreau_mesh::{Axisymmetric, Hypothesis, Mesh, PlaneStrain, Solid};

const PRESSURE: f64 = 1.7;

/// The nodes of a mesh elsewhere.
fn moved<const D: usize>(mesh: &Mesh<D>) -> Vec<[f64; D]> {
    let nodes = mesh.nodes().iter().enumerate();
    let to = |(a, x): (usize, &[f64; D])| {
        std::array::from_fn(|i| 3.0 + 1.2 * x[i] + 0.2 * (1.7 * (a * D + i) as f64).cos())
    };
    nodes.map(to).collect()
}

/// Forces on all nodes of a cell under pressure on every side, and their derivatives.
fn pressed<H: Hypothesis<D>, const D: usize>(
    mesh: &Mesh<D>,
    positions: &[[f64; D]],
    hypothesis: &H,
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let size = D * positions.len();
    let (mut force, mut derivative) = (vec![0.0; size], vec![vec![0.0; size]; size]);
    let facets = mesh.boundary_facets().into_iter().map(|f| (f, PRESSURE));
    mesh.press(facets, &|a| positions[a], hypothesis, &mut |pressed| {
        let dofs: Vec<usize> = pressed
            .nodes
            .iter()
            .flat_map(|&a| (0..D).map(move |i| D * a + i))
            .collect();
        for (k, &row) in dofs.iter().enumerate() {
            force[row] += pressed.force[k];
            for (l, &column) in dofs.iter().enumerate() {
                derivative[row][column] += pressed.derivative[k * dofs.len() + l];
            }
        }
    });
    (force, derivative)
}

/// The volume of the cell with its nodes elsewhere.
fn volume<H: Hypothesis<D>, const D: usize>(
    mesh: &Mesh<D>,
    positions: &[[f64; D]],
    hypothesis: &H,
) -> f64 {
    let cells = vec![(mesh.kind(0), mesh.cell_nodes(0).to_vec())];
    let elsewhere = Mesh::new(positions.to_vec(), cells).expect("valid");
    elsewhere.measure(&[0], hypothesis)
}

/// Along every degree of freedom: the force is −p ∂V/∂x, and the derivatives are those of the force.
fn obeys<H: Hypothesis<D>, const D: usize>(mesh: &Mesh<D>, hypothesis: &H) {
    let kind = mesh.kind(0);
    let start = moved(mesh);
    let (force, derivative) = pressed(mesh, &start, hypothesis);
    let size = force.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
    let step = 1e-5;
    for dof in 0..force.len() {
        let [before, after] = [-step, step].map(|by| {
            let mut positions = start.clone();
            positions[dof / D][dof % D] += by;
            let (force, _) = pressed(mesh, &positions, hypothesis);
            (volume(mesh, &positions, hypothesis), force)
        });
        let work = -PRESSURE * (after.0 - before.0) / (2.0 * step);
        let error = (force[dof] - work).abs();
        assert!(error < 1e-8 * size, "{kind:?} {dof}: {error:e}");
        for (row, values) in derivative.iter().enumerate() {
            let difference = (after.1[row] - before.1[row]) / (2.0 * step);
            let error = (values[dof] - difference).abs();
            assert!(error < 1e-8 * size, "{kind:?} {row} {dof}: {error:e}");
            // A surface that is closed has a potential.
            let other = derivative[dof][row];
            assert!(
                (values[dof] - other).abs() < ROUND_OFF * size,
                "{kind:?} {row} {dof}"
            );
        }
    }
}

#[test]
fn a_pressure_on_all_sides_works_against_the_volume() {
    for kind in kinds(2) {
        obeys(
            &distorted_cell::<2>(kind),
            &PlaneStrain::new(2.5).expect("valid"),
        );
        obeys(&distorted_cell::<2>(kind), &Axisymmetric);
    }
    for kind in kinds(3) {
        obeys(&distorted_cell::<3>(kind), &Solid);
    }
}
