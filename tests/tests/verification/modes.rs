//! Motions of cells that cost no energy, counted as the zero eigenvalues of their stiffness: the
//! rigid ones and the spurious ones of reduced rules; not hourglass control.

use moreau::driver::{Analysis, Block, Motion, SolidBlock, Stiffness};
use moreau::laws::Elastic;
use moreau::mesh::{
    Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use nalgebra::DMatrix;
use verification::problems::Fallible;

/// Zero eigenvalues of the stiffness of all cells of a mesh, assembled.
fn zero_modes<H: Analysis<D>, const D: usize>(
    mesh: &Mesh<D>,
    hypothesis: &H,
    rule: Integration,
) -> Fallible<usize> {
    let members: Vec<usize> = (0..mesh.cell_count()).collect();
    let cells = hypothesis
        .cells(mesh, mesh.kind(0), &members, rule)
        .ok_or("an element of another dimension")?;
    let mut block = SolidBlock::new(members, cells, Elastic::new(1.0, 0.3)?);
    let dofs = D * mesh.nodes().len();
    let mut stiffness = DMatrix::<f64>::zeros(dofs, dofs);
    let size = D * mesh.cell_nodes(0).len();
    let rest = vec![0.0; dofs];
    let rest = Motion::new(&rest, &rest);
    block.evaluate(rest, Stiffness::Total(0.0), &mut |result| {
        let nodes = mesh.cell_nodes(result.cell);
        let dof = |k: usize| D * nodes[k / D] + k % D;
        let mut entries = result.stiffness.iter();
        for i in 0..size {
            for (j, k) in (i..size).zip(entries.by_ref()) {
                stiffness[(dof(i), dof(j))] += k;
                if i != j {
                    stiffness[(dof(j), dof(i))] += k;
                }
            }
        }
    });
    let eigenvalues = stiffness.symmetric_eigenvalues();
    let largest = eigenvalues.amax();
    assert!(
        eigenvalues.iter().all(|&v| v > -1e-12 * largest),
        "not positive semi-definite"
    );
    Ok(eigenvalues
        .iter()
        .filter(|v| v.abs() <= 1e-10 * largest)
        .count())
}

/// A block of n × 1 cells, distorted.
fn plane_block(kind: CellKind, n: usize) -> Fallible<Mesh<2>> {
    let mesh = block2(
        "cell",
        kind,
        &uniform(1.0, 1.0 + n as f64, n),
        &uniform(0.0, 1.0, 1),
    )?;
    Ok(mesh.map(|[x, y]| [x + 0.2 * y - 0.1 * x * y, y + 0.1 * x])?)
}

/// One triangle with the nodes of its kind.
fn triangle(kind: CellKind) -> Fallible<Mesh<2>> {
    let nodes = [
        [1.0, 0.0],
        [2.0, 0.1],
        [1.2, 0.9],
        [1.5, 0.05],
        [1.6, 0.5],
        [1.1, 0.45],
    ];
    let count = kind.nodes();
    Ok(Mesh::new(
        nodes[..count].to_vec(),
        vec![(kind, (0..count).collect())],
    )?)
}

/// One quadratic solid cell on its reference nodes, distorted.
fn quadratic_cell(kind: CellKind) -> Fallible<Mesh<3>> {
    let nodes = kind.reference_nodes().map(|xi| [xi[0], xi[1], xi[2]]);
    let all = (0..kind.nodes()).collect();
    let mesh = Mesh::new(nodes.collect(), vec![(kind, all)])?;
    let bend = |[x, y, z]: [f64; 3]| [x + 0.1 * y * z, y + 0.2 * x, z - 0.1 * x * y];
    Ok(mesh.map(bend)?)
}

/// The mean dilatation costs no rank.
#[test]
fn b_bar_leaves_the_rigid_motions_only() -> Fallible {
    use Integration::BBar;
    let plane = PlaneStrain::default();
    let square = plane_block(CellKind::Quad4, 1)?;
    assert_eq!(zero_modes(&square, &plane, BBar)?, 3);
    assert_eq!(zero_modes(&square, &Axisymmetric, BBar)?, 1);
    let line = uniform(0.0, 1.0, 1);
    let cube = block3("cell", CellKind::Hex8, &line, &line, &line)?;
    let cube = cube.map(|[x, y, z]| [x + 0.1 * y * z, y + 0.2 * x, z - 0.1 * x * y])?;
    assert_eq!(zero_modes(&cube, &Solid, BBar)?, 6);
    Ok(())
}

#[test]
fn full_rules_leave_the_rigid_motions_only() -> Fallible {
    use Integration::Full;
    let plane = PlaneStrain::default();
    assert_eq!(zero_modes(&triangle(CellKind::Tri3)?, &plane, Full)?, 3);
    assert_eq!(zero_modes(&triangle(CellKind::Tri6)?, &plane, Full)?, 3);
    assert_eq!(
        zero_modes(&plane_block(CellKind::Quad4, 1)?, &plane, Full)?,
        3
    );
    assert_eq!(
        zero_modes(&plane_block(CellKind::Quad8, 1)?, &plane, Full)?,
        3
    );
    assert_eq!(
        zero_modes(&plane_block(CellKind::Quad9, 1)?, &plane, Full)?,
        3
    );
    // Axial symmetry: the axial translation.
    let axial = Axisymmetric;
    assert_eq!(zero_modes(&triangle(CellKind::Tri3)?, &axial, Full)?, 2);
    assert_eq!(zero_modes(&triangle(CellKind::Tri6)?, &axial, Full)?, 1);
    assert_eq!(
        zero_modes(&plane_block(CellKind::Quad4, 1)?, &axial, Full)?,
        1
    );
    assert_eq!(
        zero_modes(&plane_block(CellKind::Quad8, 1)?, &axial, Full)?,
        1
    );
    assert_eq!(
        zero_modes(&plane_block(CellKind::Quad9, 1)?, &axial, Full)?,
        1
    );
    let line = uniform(0.0, 1.0, 1);
    let cube = block3("cell", CellKind::Hex8, &line, &line, &line)?;
    let cube = cube.map(|[x, y, z]| [x + 0.1 * y * z, y + 0.2 * x, z - 0.1 * x * y])?;
    assert_eq!(zero_modes(&cube, &Solid, Full)?, 6);
    let corners = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 1.0, 0.1],
        [0.1, 0.2, 1.0],
    ];
    let tetrahedron = Mesh::new(corners, vec![(CellKind::Tet4, vec![0, 1, 2, 3])])?;
    assert_eq!(zero_modes(&tetrahedron, &Solid, Full)?, 6);
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27] {
        assert_eq!(
            zero_modes(&quadratic_cell(kind)?, &Solid, Full)?,
            6,
            "{kind}"
        );
    }
    Ok(())
}

/// Unknowns less the strains at the points, or the rigid motions if that is more.
#[test]
fn reduced_rules_leave_their_known_spurious_modes() -> Fallible {
    use Integration::Reduced;
    let plane = PlaneStrain::default();
    assert_eq!(zero_modes(&triangle(CellKind::Tri6)?, &plane, Reduced)?, 3);
    let one = |kind: CellKind| plane_block(kind, 1);
    assert_eq!(zero_modes(&one(CellKind::Quad4)?, &plane, Reduced)?, 8 - 3);
    assert_eq!(
        zero_modes(&one(CellKind::Quad8)?, &plane, Reduced)?,
        16 - 12
    );
    assert_eq!(
        zero_modes(&one(CellKind::Quad9)?, &plane, Reduced)?,
        18 - 12
    );
    let line = uniform(0.0, 1.0, 1);
    let cube = block3("cell", CellKind::Hex8, &line, &line, &line)?;
    assert_eq!(zero_modes(&cube, &Solid, Reduced)?, 24 - 6);
    let cell = quadratic_cell;
    assert_eq!(zero_modes(&cell(CellKind::Tet10)?, &Solid, Reduced)?, 6);
    assert_eq!(zero_modes(&cell(CellKind::Hex20)?, &Solid, Reduced)?, 12);
    assert_eq!(
        zero_modes(&cell(CellKind::Hex27)?, &Solid, Reduced)?,
        81 - 48
    );
    Ok(())
}

/// The spurious mode of the eight-node quadrilateral cannot pass to a neighbour.
#[test]
fn spurious_mode_of_quad8_does_not_communicate() -> Fallible {
    let plane = PlaneStrain::default();
    let two = plane_block(CellKind::Quad8, 2)?;
    assert_eq!(zero_modes(&two, &plane, Integration::Reduced)?, 3);
    Ok(())
}
