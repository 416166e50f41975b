//! Stresses of cells under large strains: of which volume they are, where the dilatation of a cell is its mean.

use super::points::{RULES, near, plane, space, three, values};
use super::{finish, simulation};
use moreau::driver::{Analysis, Driver, Model, Settings};
use moreau::grids::{body, points};
use moreau::laws::{BulkLaw, Elastic, VonMises};
use moreau::mesh::{Axisymmetric, Integration, Mesh, PlaneStrain, Solid};
use nalgebra::Matrix3;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const YIELD: f64 = 5.0;

/// All nodes of a mesh moved where no cell keeps its shape, and the body with each of the rules of its cells, of a law.
fn bent<const D: usize, H: Analysis<D>>(
    mesh: &Mesh<D>,
    hypothesis: H,
    law: &impl BulkLaw,
) -> Vec<(Integration, Driver<D>)> {
    let of_rule = |rule| {
        let model = Model::with_large_strains(mesh.clone(), hypothesis)
            .material("b", law.clone(), rule)
            .expect("a material");
        let mut driver = Driver::new(model, Settings::default()).expect("a driver");
        let mut loading = driver.applied().clone();
        for (node, x) in mesh.nodes().iter().enumerate() {
            let [x, y, z] = three(x);
            let u = [0.1 * x * x + 0.05 * x * y, -0.2 * x * y, 0.1 * y * z];
            let of_node = (0..D).map(|i| (D * node + i, u[i]));
            loading.displacement.extend(of_node);
        }
        driver.advance(&loading).expect("converges");
        (rule, driver)
    };
    RULES.map(of_rule).into()
}

/// The mesh where the body is.
fn moved<const D: usize>(driver: &Driver<D>) -> Mesh<D> {
    let mesh = driver.mesh();
    let at = |a: usize| std::array::from_fn(|i| mesh.nodes()[a][i] + driver.displacement(a)[i]);
    let cell = |c| (mesh.kind(c), mesh.cell_nodes(c).to_vec());
    let nodes = (0..mesh.nodes().len()).map(at).collect();
    Mesh::new(nodes, (0..mesh.cell_count()).map(cell).collect()).expect("a mesh")
}

/// Volumes over those of the undeformed body at all points: of their cells as they lie there where the dilatation is their
/// mean, and of the gradient of the displacements elsewhere, as written.
fn jacobians<const D: usize, H: Analysis<D>>(
    driver: &Driver<D>,
    hypothesis: H,
    rule: Integration,
) -> Vec<f64> {
    let (mesh, now, grid) = (driver.mesh(), moved(driver), points(driver));
    let cell = values(&grid.point_data, "cell").iter().map(|c| *c as usize);
    let own = values(&grid.point_data, "jacobian");
    let of_cell = |c| now.measure(&[c], &hypothesis) / mesh.measure(&[c], &hypothesis);
    cell.zip(own)
        .map(
            |(c, own)| match rule == Integration::BBar && mesh.kind(c).nodes() == 1 << D {
                true => of_cell(c),
                false => *own,
            },
        )
        .collect()
}

/// A symmetric tensor of VTK as a matrix.
fn matrix(v: &[f64]) -> Matrix3<f64> {
    Matrix3::new(v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2])
}

/// Virtual displacements that are linear in the places where the body is: Σ σ J w = Σ f ⊗ x, with hoops beside the radii.
fn balances<const D: usize, H: Analysis<D>>(
    meshes: impl Iterator<Item = Mesh<D>>,
    hypothesis: H,
    hoops: bool,
) {
    let law = VonMises::new(YOUNG, POISSON, YIELD).expect("a law");
    for mesh in meshes {
        for (rule, driver) in bent(&mesh, hypothesis, &law) {
            let grid = points(&driver);
            let what = format!("{} {rule:?}", mesh.kind(0));
            let volume = values(&grid.point_data, "volume");
            let jacobian = values(&grid.point_data, "jacobian");
            let stress = values(&grid.point_data, "stress").chunks_exact(6);
            let mut inside = Matrix3::zeros();
            for (stress, (v, j)) in stress.zip(volume.iter().zip(jacobian)) {
                inside += matrix(stress) * (v * j);
            }
            let now = moved(&driver);
            let mut outside = Matrix3::zeros();
            for (a, x) in now.nodes().iter().enumerate() {
                let [force, x] = [three(driver.nodal_reaction(a).as_slice()), three(x)];
                outside += Matrix3::from_fn(|i, j| force[i] * x[j]);
            }
            if hoops {
                near(inside[(0, 0)] + inside[(2, 2)], outside[(0, 0)], 1e3, &what);
                near(inside[(1, 0)], outside[(1, 0)], 1e3, &what);
                near(inside[(1, 1)], outside[(1, 1)], 1e3, &what);
            } else {
                for (i, j) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
                    near(inside[(i, j)], outside[(i, j)], 1e3, &what);
                }
            }
            for (found, expected) in jacobian.iter().zip(jacobians(&driver, hypothesis, rule)) {
                near(*found, expected, 1.0, &what);
            }
        }
    }
}

#[test]
fn stresses_of_the_deformed_volume_are_in_balance_with_the_forces_where_the_body_is() {
    balances(plane(), PlaneStrain::new(2.5).expect("a slice"), false);
    balances(plane(), Axisymmetric, true);
    balances(space(), Solid, false);
}

/// What flows is at the limit, as the law has it of the stress of the undeformed volume, in points, cells and nodes.
fn yields<const D: usize, H: Analysis<D>>(meshes: impl Iterator<Item = Mesh<D>>, hypothesis: H) {
    let law = VonMises::new(YOUNG, POISSON, YIELD).expect("a law");
    for mesh in meshes {
        for (rule, driver) in bent(&mesh, hypothesis, &law) {
            let what = format!("{} {rule:?}", mesh.kind(0));
            let (grid, body) = (points(&driver), body(&driver));
            let jacobian = jacobians(&driver, hypothesis, rule);
            let von_mises = values(&grid.point_data, "von_mises");
            let flowed = values(&grid.point_data, "equivalent_plastic_strain");
            assert!(flowed.iter().all(|p| *p > 0.0), "{what}");
            for (s, j) in von_mises.iter().zip(&jacobian) {
                near(s * j, YIELD, YIELD, &what);
            }
            let most = jacobian.iter().map(|j| YIELD / j).fold(0.0, f64::max);
            for data in [&body.cell_data, &body.point_data] {
                let found = values(data, "von_mises")
                    .iter()
                    .fold(0.0f64, |m, s| m.max(*s));
                assert!(found <= most * (1.0 + 1e-9), "{what}: {found} {most}");
            }
        }
    }
}

#[test]
fn no_stress_that_is_written_is_beyond_the_limit_of_a_perfectly_plastic_law() {
    yields(plane(), PlaneStrain::default());
    yields(plane(), Axisymmetric);
    yields(space(), Solid);
}

/// τ = λ tr ε + 2 μ ε of an elastic body, of the strains and the Jacobian that are written.
fn elastic<const D: usize, H: Analysis<D>>(meshes: impl Iterator<Item = Mesh<D>>, hypothesis: H) {
    let law = Elastic::new(YOUNG, POISSON).expect("a law");
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let lame = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    for mesh in meshes {
        for (rule, driver) in bent(&mesh, hypothesis, &law) {
            let what = format!("{} {rule:?}", mesh.kind(0));
            let grid = points(&driver);
            let strain = values(&grid.point_data, "logarithmic_strain").chunks_exact(6);
            let stress = values(&grid.point_data, "stress").chunks_exact(6);
            let jacobian = values(&grid.point_data, "jacobian");
            for ((strain, stress), j) in strain.zip(stress).zip(jacobian) {
                let (strain, stress) = (matrix(strain), matrix(stress));
                near(strain.trace().exp(), *j, 1.0, &what);
                let law = Matrix3::identity() * (lame * strain.trace()) + strain * (2.0 * shear);
                near((law - stress * *j).amax(), 0.0, YOUNG, &what);
            }
        }
    }
}

#[test]
fn strains_that_are_written_are_those_of_the_stresses() {
    elastic(plane(), PlaneStrain::default());
    elastic(plane(), Axisymmetric);
    elastic(space(), Solid);
}

/// A billet that sticks to its platens: its corners at the axis and at the edge change their volume much less than their points do.
#[test]
fn a_billet_of_linear_cells_does_not_exceed_its_limit() {
    for (analysis, held) in [
        ("axisymmetric", ""),
        ("plane-strain", r#", { on = "b.left", u = ["x"] }"#),
    ] {
        let done = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "{analysis}"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad4"
x = [0, 8]
y = [0, 10]
cells = [4, 5]
[[material]]
on = "b"
young = 210000
poisson = 0.3
yield-stress = 300
[[step]]
name = "press"
increments = 12
fix = [{{ on = "b.bottom", u = ["x", "y"] }}{held}]
move = [{{ on = "b.top", u = {{ x = 0, y = -3 }} }}]
"#
        )));
        let grid = done.points();
        let jacobian = values(&grid.point_data, "jacobian");
        let least = jacobian.iter().fold(f64::INFINITY, |m, j| m.min(*j));
        let most = 300.0 / least;
        for data in [&grid.point_data, &done.body().point_data] {
            let found = values(data, "von_mises")
                .iter()
                .fold(0.0f64, |m, s| m.max(*s));
            assert!(found <= most * (1.0 + 1e-9), "{analysis}: {found} {most}");
        }
        // A metal hardly changes its volume.
        assert!((1.0 - least).abs() < 0.02, "{analysis}: {least}");
    }
}
