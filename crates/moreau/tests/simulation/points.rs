//! What is computed at quadrature points, as a grid, beside that of the body.

use moreau::driver::{Analysis, Driver, Model, Settings};
use moreau::grids::{Array, body, points};
use moreau::laws::{BulkLaw, Elastic, VonMises};
use moreau::mandel::from_matrix;
use moreau::mesh::{Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3};
use nalgebra::{Matrix3, Vector3};

/// Rounding of sums and of Newton's end.
const ROUND_OFF: f64 = 1e-11;
pub(super) const RULES: [Integration; 3] =
    [Integration::Reduced, Integration::Full, Integration::BBar];

/// Zero where the plane has no component.
pub(super) fn three(v: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0))
}

/// All nodes of a body displaced as a function says; its volume and its state.
fn displaced<const D: usize, H: Analysis<D>>(
    (mesh, hypothesis): (&Mesh<D>, H),
    (law, rule): (impl BulkLaw, Integration),
    u: impl Fn(&[f64; D]) -> [f64; 3],
) -> (f64, Driver<D>) {
    let all: Vec<usize> = (0..mesh.cell_count()).collect();
    let volume = mesh.measure(&all, &hypothesis);
    let model = Model::new(mesh.clone(), hypothesis)
        .material("b", law, rule)
        .expect("a material");
    let mut driver = Driver::new(model, Settings::default()).expect("a driver");
    let mut loading = driver.applied().clone();
    for (node, x) in mesh.nodes().iter().enumerate() {
        let u = u(x);
        loading
            .displacement
            .extend((0..D).map(|i| (D * node + i, u[i])));
    }
    driver.advance(&loading).expect("converges");
    (volume, driver)
}

/// Bodies of every kind of cell, distorted but with straight edges, in which the rules of volumes
/// and of forces are exact.
pub(super) fn plane() -> impl Iterator<Item = Mesh<2>> {
    let kinds = CellKind::ALL.into_iter().filter(|k| k.dimension() == 2);
    kinds.map(|kind| {
        let mesh = block2("b", kind, &[1.0, 1.4, 2.0], &[0.0, 0.5, 1.5]).expect("a mesh");
        let skewed = |x: [f64; 2]| [x[0] + 0.3 * x[1], x[1] + 0.1 * x[0]];
        mesh.map(skewed).expect("a mesh")
    })
}

pub(super) fn space() -> impl Iterator<Item = Mesh<3>> {
    let kinds = CellKind::ALL.into_iter().filter(|k| k.dimension() == 3);
    kinds.map(|kind| {
        let lines = [[0.0, 0.4, 1.0], [0.0, 0.5, 1.5], [0.0, 0.6, 0.9]];
        let mesh = block3("b", kind, &lines[0], &lines[1], &lines[2]).expect("a mesh");
        let skewed = |x: [f64; 3]| [x[0] + 0.3 * x[1], x[1] - 0.2 * x[2], x[2] + 0.1 * x[0]];
        mesh.map(skewed).expect("a mesh")
    })
}

pub(super) fn values<'a>(arrays: &'a [Array], name: &str) -> &'a [f64] {
    let array = arrays.iter().find(|a| a.name == name);
    &array.unwrap_or_else(|| panic!("no {name}")).values
}

pub(super) fn near(a: f64, b: f64, size: f64, what: &str) {
    assert!((a - b).abs() <= ROUND_OFF * size, "{what}: {a} {b}");
}

/// Under an affine displacement every point has it, and the one stress that it makes.
fn uniform<const D: usize, H: Analysis<D>>(
    meshes: impl Iterator<Item = Mesh<D>>,
    hypothesis: &H,
    gradient: Matrix3<f64>,
) {
    let law = Elastic::new(1000.0, 0.3).expect("a law");
    let strain = from_matrix(&(0.5 * (gradient + gradient.transpose())));
    let [x, y, z, yz, xz, xy]: [f64; 6] = law.respond(&Default::default(), &strain).stress.into();
    let root = 2f64.sqrt();
    let exact = [x, y, z, xy / root, yz / root, xz / root];
    let at = |x: &[f64]| gradient * Vector3::from(three(x));
    for mesh in meshes {
        for rule in RULES {
            let state = ((&mesh, *hypothesis), (law, rule));
            let (volume, driver) = displaced(state.0, state.1, |x| at(x).into());
            let grid = points(&driver);
            let what = format!("{} {rule:?}", mesh.kind(0));
            let sum: f64 = values(&grid.point_data, "volume").iter().sum();
            near(sum, volume, volume, &what);
            let u = values(&grid.point_data, "displacement").chunks_exact(3);
            let stress = values(&grid.point_data, "stress").chunks_exact(6);
            for ((x, u), stress) in grid.points.iter().zip(u).zip(stress) {
                (0..3).for_each(|i| near(u[i], at(x)[i], 0.1, &what));
                (0..6).for_each(|i| near(stress[i], exact[i], 100.0, &what));
            }
        }
    }
}

#[test]
fn a_uniform_stress_is_exact_at_every_point_and_their_volumes_are_that_of_the_body() {
    let strained = Matrix3::new(2.0, 5.0, 0.0, -1.0, -3.0, 0.0, 0.0, 0.0, 0.0) * 1e-2;
    uniform(plane(), &PlaneStrain::new(2.5).expect("a slice"), strained);
    // Hoops are strained like radii.
    let strained = Matrix3::new(2.0, 0.0, 0.0, 4.0, -3.0, 0.0, 0.0, 0.0, 2.0) * 1e-2;
    uniform(plane(), &Axisymmetric, strained);
    let strained = Matrix3::new(2.0, 5.0, 1.0, -1.0, -3.0, 2.0, 4.0, 0.0, 1.0) * 1e-2;
    uniform(space(), &Solid, strained);
}

/// What the body has in a cell is the mean by volume of what the points have that name it.
fn means<const D: usize, H: Analysis<D>>(meshes: impl Iterator<Item = Mesh<D>>, hypothesis: &H) {
    let law = VonMises::new(1000.0, 0.3, 5.0)
        .and_then(|law| law.with_kinematic(100.0))
        .expect("a law");
    let bent = |x: &[f64; D]| three(&x.map(|x| 0.02 * x * x));
    for mesh in meshes {
        let rule = mesh.kind(0).integration();
        let (_, driver) = displaced((&mesh, *hypothesis), (law.clone(), rule), bent);
        let (body, grid) = (body(&driver), points(&driver));
        let volume = values(&grid.point_data, "volume");
        let cell = values(&grid.point_data, "cell");
        let point = values(&grid.point_data, "point");
        assert!(cell.iter().zip(point).is_sorted(), "cell by cell");
        for array in &body.cell_data[1..] {
            let raw = values(&grid.point_data, &array.name);
            let n = array.components;
            for (c, mean) in array.values.chunks_exact(n).enumerate() {
                let own = (0..cell.len()).filter(|&p| cell[p] == c as f64);
                let total: f64 = own.clone().map(|p| volume[p]).sum();
                for (i, &mean) in mean.iter().enumerate() {
                    let sum: f64 = own.clone().map(|p| volume[p] * raw[n * p + i]).sum();
                    near(sum / total, mean, 10.0, &array.name);
                }
            }
        }
        let flowed = values(&grid.point_data, "equivalent_plastic_strain");
        assert!(flowed.iter().any(|&p| p > 0.0));
        let pushed = values(&grid.point_data, "back_stress").chunks_exact(6);
        for (p, x) in flowed.iter().zip(pushed) {
            assert_eq!(
                *p > 0.0,
                x.iter().any(|c| *c != 0.0),
                "the point of its state"
            );
        }
    }
}

#[test]
fn cells_have_the_means_of_their_points() {
    means(plane(), &PlaneStrain::default());
    means(plane(), &Axisymmetric);
    means(space(), &Solid);
}
