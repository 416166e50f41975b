//! Friction of two coefficients: a block that slides over a plane pulls as its ellipse says, whatever
//! the direction of the axis, and along what a plane of symmetry leaves.

use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, ModelError, Settings, Step};
use moreau_laws::{AnisotropicCoulomb, Coulomb, Elastic, Friction, Status};
use moreau_mesh::{CellKind, Integration, Solid, block3, uniform};
use nalgebra::SVector;

type Vector = SVector<f64, 3>;

/// A block on a floor, which its top is pressed on and then dragged over far enough to slide.
fn dragged(law: Friction, axis: Option<[f64; 3]>, drag: [f64; 2], held: &[Axis]) -> Driver<3> {
    let (plan, height) = (uniform(0.0, 10.0, 3), uniform(0.0, 5.0, 2));
    let mesh = block3("block", CellKind::Hex8, &plan, &plan, &height).expect("valid");
    let floor = Plane::new([0.0; 3], [0.0, 0.0, 1.0]).expect("valid");
    let mut model = Model::new(mesh, Solid)
        .material(
            "block",
            Elastic::new(1000.0, 0.2).expect("valid"),
            Integration::Full,
        )
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| m.contact("block.back", "floor", law))
        .expect("valid");
    if let Some(axis) = axis {
        model = model.along(axis).expect("along the floor");
    }
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let top = |name: &str, [x, y]: [f64; 2]| {
        let step = Step::new(name).displace("block.front", Axis::Z, -0.02);
        let step = step.displace("block.front", Axis::X, x);
        match held.contains(&Axis::Y) {
            true => step.fix("block.bottom", &[Axis::Y]),
            false => step.displace("block.front", Axis::Y, y),
        }
    };
    driver
        .run(&top("press", [0.0; 2]), 1, |_, _| {})
        .expect("converges");
    let reports = driver
        .run(&top("drag", drag), 8, |_, _| {})
        .expect("converges");
    assert!(reports.iter().all(|r| r.relative_gap() < 1e-10));
    driver
}

/// Normal force and friction on the block, once all that touches slides.
fn forces(driver: &Driver<3>) -> (f64, Vector) {
    let touching = driver
        .contacts()
        .iter()
        .filter(|c| c.status != Status::Open);
    let mut sum = Vector::zeros();
    for contact in touching {
        assert_eq!(contact.status, Status::Slip, "{contact:?}");
        sum += contact.force;
    }
    (sum.z, Vector::new(sum.x, sum.y, 0.0))
}

/// The force of the closed form: against a slip d, with a, b along the axis and across,
/// −N (μ_a² d_a a + μ_b² d_b b) / √((μ_a d_a)² + (μ_b d_b)²). It is not parallel to the slip. How far the
/// block lags behind to either side settles the faster the longer the way of an increment is.
#[test]
fn a_sliding_block_pulls_as_the_ellipse_says() {
    let mu = [0.1, 0.4];
    let law = AnisotropicCoulomb::new(mu[0], mu[1]).expect("valid");
    for (degrees, drag) in [
        (0.0f64, [60.0, 80.0]),
        (30.0, [60.0, 80.0]),
        (90.0, [100.0, 0.0]),
        (-50.0, [-30.0, 90.0]),
    ] {
        let (s, c) = degrees.to_radians().sin_cos();
        let axis = [c, s, 0.0];
        // Only what lies in the surface counts, and no length.
        let given = [7.0 * c, 7.0 * s, 3.0];
        let driver = dragged(law.into(), Some(given), drag, &[]);
        let (normal, found) = forces(&driver);
        let (a, b) = (Vector::from(axis), Vector::new(-s, c, 0.0));
        let d = Vector::new(drag[0], drag[1], 0.0);
        let resisted = (mu[0] * d.dot(&a)).hypot(mu[1] * d.dot(&b));
        let expected = (a * mu[0].powi(2) * d.dot(&a) + b * mu[1].powi(2) * d.dot(&b)) / resisted;
        assert!(normal > 100.0);
        let apart = (found + expected * normal).norm() / normal;
        assert!(
            apart < 1e-9,
            "{degrees}°: {found} for {} ({apart:e})",
            -expected * normal
        );
    }
}

/// With equal coefficients it is Coulomb's friction, whatever the axis.
#[test]
fn equal_coefficients_are_one() {
    let two = AnisotropicCoulomb::new(0.2, 0.2).expect("valid");
    let one = Coulomb::new(0.2).expect("valid");
    let drag = [0.03, 0.01];
    let turned = dragged(two.into(), Some([1.0, 2.0, 0.0]), drag, &[]);
    let plain = dragged(one.into(), None, drag, &[]);
    for node in 0..plain.mesh().nodes().len() {
        let apart = (turned.displacement(node) - plain.displacement(node)).norm();
        assert!(apart < 1e-10, "{node}: {apart:e}");
    }
}

/// On a plane of symmetry one tangent is left, with the coefficient that holds along it.
#[test]
fn a_plane_of_symmetry_leaves_one_coefficient() {
    let law = AnisotropicCoulomb::new(0.1, 0.4).expect("valid");
    for (axis, mu) in [([1.0, 0.0, 0.0], 0.1), ([0.0, 1.0, 0.0], 0.4)] {
        let driver = dragged(law.into(), Some(axis), [1.0, 0.0], &[Axis::Y]);
        let on_plane = driver.contacts().iter().filter(|c| c.position[1] == 0.0);
        let mut count = 0;
        for contact in on_plane.filter(|c| c.status != Status::Open) {
            let (normal, friction) = (contact.force.z, contact.force.x);
            assert!(
                (friction + mu * normal).abs() < 1e-9 * normal.max(1.0),
                "{contact:?}"
            );
            count += 1;
        }
        assert!(count > 1);
    }
}

#[test]
fn an_axis_that_is_none_is_refused() {
    let lines = uniform(0.0, 1.0, 1);
    let contact = || {
        let mesh = block3("b", CellKind::Hex8, &lines, &lines, &lines).expect("valid");
        let floor = Plane::new([0.0; 3], [0.0, 0.0, 1.0]).expect("valid");
        Model::new(mesh, Solid)
            .tool("floor", floor)
            .and_then(|m| {
                m.contact(
                    "b.back",
                    "floor",
                    AnisotropicCoulomb::new(0.1, 0.2).expect("valid"),
                )
            })
            .expect("valid")
    };
    let refused = |axis: [f64; 3]| contact().along(axis).err().expect("refused");
    for axis in [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        assert!(matches!(refused(axis), ModelError::OutOfRange { .. }));
    }
    match refused([0.0, 0.0, -2.0]) {
        ModelError::NormalAxis { surface, .. } => assert_eq!(surface, "b.back"),
        other => panic!("{other:?}"),
    }
}
