//! Nodal averages: exact for linear fields, within the range of the points, blind to what is no number.

use super::{ROUND_OFF, block};
use moreau::driver::PointState;
use moreau::mesh::{
    CellKind, Element, Integration, Mesh, PlaneStrain, Quad4, Quad8, Tri3, Tri6, block2,
};
use moreau::plot::nodal_average;

/// The quadrature points of a mesh of cells of element E, with plastic strain f.
fn points<E: Element<2, N>, const N: usize>(
    mesh: &Mesh<2>,
    integration: Integration,
    f: impl Fn([f64; 2]) -> f64,
) -> Vec<PointState<2>> {
    let thickness = PlaneStrain::default();
    let rule = E::rule(integration).points;
    (0..mesh.cell_count())
        .flat_map(|cell| {
            let nodes: [[f64; 2]; N] =
                std::array::from_fn(|a| mesh.nodes()[mesh.cell_nodes(cell)[a]]);
            rule.iter()
                .map(move |p| (cell, p.weight, E::map(&nodes, p.xi)))
        })
        .map(|(cell, weight, at)| PointState {
            cell,
            position: at.x,
            weight: weight * at.det * moreau::mesh::Hypothesis::measure(&thickness, &at.x),
            stress: moreau::mandel::Sym2::zeros(),
            jacobian: 1.0,
            plastic_strain: f(at.x),
        })
        .collect()
}

/// Points, at least three a cell, of a skewed mesh of each element.
fn cases(f: impl Fn([f64; 2]) -> f64 + Copy) -> Vec<(Mesh<2>, Vec<PointState<2>>)> {
    let skewed = |kind| {
        block(kind)
            .map(|x| [x[0] + 0.3 * x[1], x[1] + 0.05 * x[0]])
            .expect("a mesh")
    };
    let [t_3, t_6] = [CellKind::Tri3, CellKind::Tri6].map(skewed);
    let [q_4, q_8] = [CellKind::Quad4, CellKind::Quad8].map(skewed);
    let full = Integration::Full;
    let p_6 = points::<Tri6, 6>(&t_6, full, f);
    let p_4 = points::<Quad4, 4>(&q_4, full, f);
    let p_8 = points::<Quad8, 8>(&q_8, Integration::Reduced, f);
    let p_9 = points::<Quad8, 8>(&q_8, full, f);
    let p_3 = points::<Tri3, 3>(&t_3, full, f);
    vec![
        (t_6, p_6),
        (q_4, p_4),
        (q_8.clone(), p_8),
        (q_8, p_9),
        (t_3, p_3),
    ]
}

fn range(points: &[PointState<2>]) -> [f64; 2] {
    points
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            [low.min(p.plastic_strain), high.max(p.plastic_strain)]
        })
}

#[test]
fn nodal_averages_are_exact_for_linear_fields_within_their_range() {
    let f = |x: [f64; 2]| 0.3 + 2.0 * x[0] - 0.7 * x[1];
    // A linear triangle has one point, from which no slope can be had.
    for (mesh, points) in &cases(f)[..4] {
        let [low, high] = range(points);
        let values = nodal_average(mesh, points, |p| p.plastic_strain);
        for (x, value) in mesh.nodes().iter().zip(values) {
            let exact = f(*x).clamp(low, high);
            assert!(
                (value - exact).abs() < 100.0 * ROUND_OFF,
                "{x:?}: {value} for {exact}"
            );
        }
    }
}

#[test]
fn nodal_averages_stay_in_the_range_of_the_points() {
    let f = |x: [f64; 2]| {
        if x[0] < 2.0 {
            0.0
        } else {
            (7.0 * x[0]).sin().abs() + x[1]
        }
    };
    for (mesh, points) in cases(f) {
        let [low, high] = range(&points);
        for value in nodal_average(&mesh, &points, |p| p.plastic_strain) {
            assert!((low..=high).contains(&value));
        }
    }
}

#[test]
fn nodal_averages_weigh_cells_by_volume() {
    // Cells of lengths 1 and 3 with constants 0 and 4: at the nodes between them, 3.
    let mesh = block2("b", CellKind::Quad4, &[0.0, 1.0, 4.0], &[0.0, 1.0]).expect("a mesh");
    let points = points::<Quad4, 4>(
        &mesh,
        Integration::Full,
        |x| if x[0] < 1.0 { 0.0 } else { 4.0 },
    );
    let values = nodal_average(&mesh, &points, |p| p.plastic_strain);
    for (x, value) in mesh.nodes().iter().zip(values) {
        let exact = if x[0] == 1.0 {
            3.0
        } else if x[0] < 1.0 {
            0.0
        } else {
            4.0
        };
        assert!((value - exact).abs() < ROUND_OFF, "{x:?}: {value}");
    }
}

#[test]
fn nodal_averages_ignore_what_is_not_a_number() {
    let mesh = block(CellKind::Quad4);
    assert!(
        nodal_average(&mesh, &[], |_| 1.0)
            .iter()
            .all(|v| v.is_nan())
    );
    let mut points = points::<Quad4, 4>(&mesh, Integration::Full, |_| 2.0);
    points[0].plastic_strain = f64::NAN;
    points[5].plastic_strain = f64::INFINITY;
    points[9].weight = f64::NAN;
    points[13].cell = 1000;
    let values = nodal_average(&mesh, &points, |p| p.plastic_strain);
    assert!(values.iter().all(|v| (v - 2.0).abs() < ROUND_OFF));
}
