//! Patch tests: constant and quadratic states that a mesh must reproduce exactly; not contact.

use crate::close;
use moreau::driver::{Driver, Model, Settings, Step};
use moreau::laws::{BulkLaw, Elastic, VonMises};
use moreau::mandel::{Sym2, trace};
use moreau::mesh::{
    Axisymmetric, CellKind, Integration, PlaneStrain, Solid, block2, block3, uniform,
};
use nalgebra::SMatrix;
use verification::problems::Fallible;
use verification::problems::fields::{Field, prescribed};
use verification::problems::patches::{plane_patch, solid_patch};
use verification::problems::shapes::PLANE_ELEMENTS;

const E: f64 = 210e3;
const NU: f64 = 0.3;
/// Round-off of an elastic solution.
const ROUND_OFF: f64 = 1e-12;

/// As [`PLANE_ELEMENTS`], in space.
fn solid_kinds() -> [(CellKind, Integration); 8] {
    use CellKind::{Hex8, Hex20, Hex27, Tet4, Tet10};
    use Integration::{BBar, Full, Reduced};
    [
        (Tet4, Full),
        (Tet10, Reduced),
        (Tet10, Full),
        (Hex8, Full),
        (Hex8, BBar),
        (Hex20, Reduced),
        (Hex20, Full),
        (Hex27, Full),
    ]
}

fn mandel<const D: usize>(g: SMatrix<f64, D, D>) -> Sym2 {
    let at = |i: usize, j: usize| {
        if i < D && j < D {
            0.5 * (g[(i, j)] + g[(j, i)])
        } else {
            0.0
        }
    };
    let s = 2f64.sqrt();
    Sym2::from_column_slice(&[
        at(0, 0),
        at(1, 1),
        at(2, 2),
        s * at(1, 2),
        s * at(0, 2),
        s * at(0, 1),
    ])
}

#[track_caller]
fn assert_uniform<const D: usize>(driver: &Driver<D>, stress: &Sym2, tolerance: f64, what: &str) {
    let worst = driver
        .points()
        .iter()
        .map(|p| (p.stress - stress).norm() / stress.norm())
        .fold(0.0, f64::max);
    assert!(worst <= tolerance, "{what}: stress off by {worst:.2e}");
}

/// Displacement g·x + a, with rotation, on the outline of MacNeal and Harder's patch.
#[test]
fn macneal_harder_patch_is_exact_in_plane_strain() -> Fallible {
    let g = SMatrix::<f64, 2, 2>::new(1e-3, 0.7e-3, 0.2e-3, -0.4e-3);
    let law = Elastic::new(E, NU)?;
    let exact = law.stress(&mandel(g));
    for (kind, rule) in PLANE_ELEMENTS {
        let model =
            Model::new(plane_patch(kind)?, PlaneStrain::default()).material("patch", law, rule)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let field = |x: &[f64; 2]| {
            let u = g * nalgebra::Vector2::from(*x) + nalgebra::Vector2::new(1e-4, -2e-4);
            [u[0], u[1]]
        };
        let outline = driver.mesh().node_group("patch.outline")?;
        let loading = prescribed(&driver, &Step::new("stretch"), &outline, field)?;
        let report = driver.advance(&loading)?;
        assert_eq!(report.newton_iterations, 1, "{kind}: linear");
        assert_uniform(&driver, &exact, ROUND_OFF, &format!("{kind} {rule:?}"));
        for (node, x) in driver.mesh().nodes().iter().enumerate() {
            let error = driver.displacement(node) - nalgebra::Vector2::from(field(x));
            assert!(
                error.norm() < 1e-15,
                "{kind}: node {node} off by {:e} mm",
                error.norm()
            );
        }
    }
    Ok(())
}

/// u_r = a r, u_z = b z is the state of constant strain that axial symmetry has.
#[test]
fn macneal_harder_patch_is_exact_in_axial_symmetry() -> Fallible {
    let law = Elastic::new(E, NU)?;
    let (a, b) = (1e-3, -0.3e-3);
    let exact = law.stress(&Sym2::from_column_slice(&[a, b, a, 0.0, 0.0, 0.0]));
    for (kind, rule) in PLANE_ELEMENTS {
        for inner in [0.0, 0.5] {
            let mesh = plane_patch(kind)?.map(|[r, z]| [r + inner, z])?;
            let model = Model::new(mesh, Axisymmetric).material("patch", law, rule)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let outline = driver.mesh().node_group("patch.outline")?;
            let field = |x: &[f64; 2]| [a * x[0], b * x[1]];
            let loading = prescribed(&driver, &Step::new("stretch"), &outline, field)?;
            driver.advance(&loading)?;
            assert_uniform(
                &driver,
                &exact,
                ROUND_OFF,
                &format!("{kind} {rule:?} r > {inner}"),
            );
        }
    }
    Ok(())
}

#[test]
fn macneal_harder_patch_is_exact_in_space() -> Fallible {
    let g = SMatrix::<f64, 3, 3>::new(1.0, 0.5, -0.3, 0.2, -0.4, 0.6, 0.1, -0.7, 0.8) * 1e-3;
    let law = Elastic::new(E, NU)?;
    let exact = law.stress(&mandel(g));
    for (kind, rule) in solid_kinds() {
        let model = Model::new(solid_patch(kind)?, Solid).material("patch", law, rule)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let outline = driver.mesh().node_group("patch.outline")?;
        let inner = driver.mesh().nodes().len() - outline.len();
        let linear = kind.nodes() == kind.corner_count();
        assert!(inner == 8 || !linear && inner > 8, "{kind}: {inner}");
        let field = |x: &[f64; 3]| {
            let u = g * nalgebra::Vector3::from(*x);
            [u[0], u[1], u[2]]
        };
        let loading = prescribed(&driver, &Step::new("stretch"), &outline, field)?;
        driver.advance(&loading)?;
        assert_uniform(&driver, &exact, ROUND_OFF, &format!("{kind} {rule:?}"));
    }
    Ok(())
}

/// Uniaxial strain far into yielding: σ₁ = K ε + ⅔ σ_y, σ₂ = σ₃ = K ε − ⅓ σ_y, p = ⅔ ε − σ_y / 3G.
#[test]
fn patch_stays_uniform_in_plastic_flow() -> Fallible {
    const STRAIN: f64 = 0.005;
    let law = VonMises::new(E, NU, 300.0)?;
    let p = 2.0 / 3.0 * STRAIN - 300.0 / (3.0 * law.elastic().shear_modulus());
    for (kind, rule) in PLANE_ELEMENTS {
        for steps in [1, 10] {
            let model = Model::new(plane_patch(kind)?, PlaneStrain::default()).material(
                "patch",
                law.clone(),
                rule,
            )?;
            let mut driver = Driver::new(model, Settings::default())?;
            let outline = driver.mesh().node_group("patch.outline")?;
            for step in 1..=steps {
                let strain = STRAIN * f64::from(step) / f64::from(steps);
                let loading = prescribed(&driver, &Step::new("stretch"), &outline, |x| {
                    [strain * x[0], 0.0]
                })?;
                driver.advance(&loading)?;
            }
            let exact = Sym2::from_column_slice(&[1075.0, 775.0, 775.0, 0.0, 0.0, 0.0]);
            assert_uniform(&driver, &exact, 1e-10, &format!("{kind} {rule:?}"));
            for point in driver.points() {
                close("plastic strain", point.plastic_strain, p, 1e-10);
            }
        }
    }
    let g = SMatrix::<f64, 3, 3>::new(STRAIN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (kind, rule) in solid_kinds() {
        let model = Model::new(solid_patch(kind)?, Solid).material("patch", law.clone(), rule)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let outline = driver.mesh().node_group("patch.outline")?;
        for step in 1..=4 {
            let loading = prescribed(&driver, &Step::new("stretch"), &outline, |x| {
                let u = g * nalgebra::Vector3::from(*x) * (0.25 * f64::from(step));
                [u[0], u[1], u[2]]
            })?;
            driver.advance(&loading)?;
        }
        let exact = Sym2::from_column_slice(&[1075.0, 775.0, 775.0, 0.0, 0.0, 0.0]);
        assert_uniform(&driver, &exact, 1e-10, &format!("{kind} {rule:?}"));
    }
    Ok(())
}

/// A displacement quadratic in x and y.
struct Quadratic;

impl Field<2> for Quadratic {
    fn displacement(&self, &[x, y]: &[f64; 2]) -> [f64; 2] {
        [
            1e-4 * (x * x - 0.5 * x * y + 0.3 * y * y + x),
            1e-4 * (0.2 * x * x + 0.7 * x * y - 0.4 * y * y),
        ]
    }

    fn gradient(&self, &[x, y]: &[f64; 2]) -> [[f64; 2]; 2] {
        [
            [
                1e-4 * (2.0 * x - 0.5 * y + 1.0),
                1e-4 * (-0.5 * x + 0.6 * y),
            ],
            [1e-4 * (0.4 * x + 0.7 * y), 1e-4 * (0.7 * x - 0.8 * y)],
        ]
    }
}

#[test]
fn quadratic_field_is_exact_on_quadratic_parallelograms() -> Fallible {
    let law = Elastic::new(E, NU)?;
    // −div σ of the field, constant: σ is linear, so its slopes are differences.
    let stress = |x: f64, y: f64| law.stress(&Quadratic.strain(&[x, y]));
    let d_x = stress(1.0, 0.0) - stress(0.0, 0.0);
    let d_y = stress(0.0, 1.0) - stress(0.0, 0.0);
    let s = 2f64.sqrt();
    let body = [-(d_x[0] + d_y[5] / s), -(d_x[5] / s + d_y[1])];
    for kind in [CellKind::Quad8, CellKind::Quad9, CellKind::Tri6] {
        for rule in [Integration::Reduced, Integration::Full] {
            if kind == CellKind::Quad9 && rule == Integration::Reduced {
                // Its spurious modes are left free by the outline.
                continue;
            }
            let mesh = block2("patch", kind, &uniform(0.0, 3.0, 3), &uniform(0.0, 2.0, 3))?
                .map(|[x, y]| [x + 0.4 * y, y + 0.2 * x])?;
            let model = Model::new(mesh, PlaneStrain::default()).material("patch", law, rule)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let outline: Vec<usize> = {
                let mesh = driver.mesh();
                let facets = mesh.boundary_facets();
                facets
                    .into_iter()
                    .flat_map(|f| mesh.facet_nodes(f).collect::<Vec<_>>())
                    .collect()
            };
            let step = Step::new("load").body_force("patch", body);
            let loading = prescribed(&driver, &step, &outline, |x| Quadratic.displacement(x))?;
            driver.advance(&loading)?;
            let largest = driver
                .points()
                .iter()
                .map(|p| p.stress.norm())
                .fold(0.0, f64::max);
            for point in driver.points() {
                let error = (point.stress - stress(point.position[0], point.position[1])).norm();
                assert!(error <= 1e-10 * largest, "{kind} {rule:?}: {error:e} MPa");
                assert!(trace(&point.stress).is_finite());
            }
            for (node, x) in driver.mesh().nodes().iter().enumerate() {
                let exact = nalgebra::Vector2::from(Quadratic.displacement(x));
                let error = (driver.displacement(node) - exact).norm();
                assert!(
                    error <= 1e-10 * 1e-3,
                    "{kind} {rule:?}: node {node} off by {error:e} mm"
                );
            }
        }
    }
    Ok(())
}

/// Likewise in space, where the field has all products of two coordinates.
#[test]
fn quadratic_field_is_exact_on_quadratic_parallelepipeds() -> Fallible {
    const C: [[f64; 9]; 3] = [
        [1.0, 0.3, -0.2, -0.5, 0.4, 0.1, 1.0, 0.2, -0.3],
        [0.2, -0.4, 0.5, 0.7, -0.1, 0.3, 0.0, -0.6, 0.4],
        [-0.3, 0.6, 0.8, 0.2, 0.5, -0.7, 0.1, 0.3, 0.9],
    ];
    const SCALE: f64 = 1e-4;
    let field = |&[x, y, z]: &[f64; 3]| -> [f64; 3] {
        let terms = [x * x, y * y, z * z, x * y, y * z, z * x, x, y, z];
        C.map(|c| SCALE * c.iter().zip(terms).map(|(c, t)| c * t).sum::<f64>())
    };
    let law = Elastic::new(E, NU)?;
    let stress = |&[x, y, z]: &[f64; 3]| {
        let gradient = SMatrix::<f64, 3, 3>::from_fn(|i, j| {
            let slopes = [
                [2.0 * x, 0.0, 0.0, y, 0.0, z, 1.0, 0.0, 0.0],
                [0.0, 2.0 * y, 0.0, x, z, 0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 2.0 * z, 0.0, y, x, 0.0, 0.0, 1.0],
            ];
            SCALE * C[i].iter().zip(slopes[j]).map(|(c, s)| c * s).sum::<f64>()
        });
        law.stress(&mandel(gradient))
    };
    // −div σ, constant: σ is linear, so its slopes are differences.
    let slope = |j: usize| {
        let mut x = [0.0; 3];
        x[j] = 1.0;
        moreau::mandel::to_matrix(&(stress(&x) - stress(&[0.0; 3])))
    };
    let slopes = [slope(0), slope(1), slope(2)];
    let body = [0, 1, 2].map(|i| -(0..3).map(|j| slopes[j][(i, j)]).sum::<f64>());
    let lines = uniform(0.0, 1.0, 2);
    for (kind, rule) in solid_kinds() {
        if kind.nodes() == kind.corner_count() {
            continue;
        }
        let mesh = block3("patch", kind, &lines, &lines, &lines)?;
        let mesh = mesh.map(|[x, y, z]| [x + 0.4 * y, y + 0.2 * z, z + 0.1 * x])?;
        let model = Model::new(mesh, Solid).material("patch", law, rule)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let mesh = driver.mesh();
        let facets = mesh.boundary_facets();
        let outline: Vec<usize> = facets
            .into_iter()
            .flat_map(|f| mesh.facet_nodes(f).collect::<Vec<_>>())
            .collect();
        let step = Step::new("load").body_force("patch", body);
        let loading = prescribed(&driver, &step, &outline, field)?;
        driver.advance(&loading)?;
        let norms = driver.points().into_iter().map(|p| p.stress.norm());
        let largest = norms.fold(0.0, f64::max);
        for point in driver.points() {
            let error = (point.stress - stress(&point.position)).norm();
            assert!(error <= 1e-10 * largest, "{kind} {rule:?}: {error:e} MPa");
        }
    }
    Ok(())
}
