//! A body that bends easily: small forces between large stiffnesses.

use moreau_contact::Ball;
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic};
use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

/// A cantilever of this length and unit height, bent by a cylinder at nine tenths of it: the beam's
/// deflection under the force that is found, and a few iterations for it.
#[test]
fn a_slender_cantilever_is_bent_as_a_beam_is() {
    for length in [100.0, 300.0, 1000.0] {
        let (x, y) = (uniform(0.0, length, 100), uniform(0.0, 1.0, 2));
        let mesh = block2("b", CellKind::Quad8, &x, &y).expect("valid");
        let (young, poisson, by) = (210e3, 0.3, 1e-3);
        let at = 0.9 * length;
        let model = Model::new(mesh, PlaneStrain::default())
            .material(
                "b",
                Elastic::new(young, poisson).expect("valid"),
                Integration::Reduced,
            )
            .and_then(|m| m.tool("t", Ball::new([at, 6.0], 5.0).expect("valid")))
            .and_then(|m| m.contact("b.top", "t", Coulomb::new(0.2).expect("valid")))
            .expect("valid");
        let step = Step::new("bend")
            .fix("b.left", &[Axis::X, Axis::Y])
            .tool("t", [0.0, -by]);
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let reports = driver.run(&step, 1, |_, _| {}).expect("converges");
        assert!(
            reports[0].cuts == 0 && reports[0].newton_iterations <= 6,
            "{reports:?}"
        );
        let force = -driver.tool_force("t").expect("exists")[1];
        // F = 3 E' I δ / a³, of plane strain, I = 1/12.
        let beam = 3.0 * young / (1.0 - poisson * poisson) / 12.0 * by / at.powi(3);
        assert!(
            (force / beam - 1.0).abs() < 5e-3,
            "{length}: {force} {beam}"
        );
    }
}
