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

/// A thin strip, bowed by its end and pressed by a roll, snaps away from under it on the way. Without friction the
/// equilibrium at the end is that of the elastic energy, whatever the increments, and one that lasts: steps of Newton's
/// method beyond the limit point, which lead up to one that does not, are turned downhill.
#[test]
fn what_snaps_comes_to_rest_where_it_stays() {
    let ends = [5, 20].map(|increments| {
        let (x, y) = (uniform(0.0, 30.0, 20), uniform(0.0, 0.1, 2));
        let mesh = block2("b", CellKind::Quad8, &x, &y).expect("valid");
        let law = Elastic::new(2000.0, 0.3).expect("valid");
        let roll = Ball::new([13.334157, 3.1], 3.0).expect("valid");
        let model = Model::with_large_strains(mesh, PlaneStrain::default())
            .material("b", law, Integration::Reduced)
            .and_then(|m| m.tool("roll", roll))
            .and_then(|m| m.contact("b.top", "roll", Coulomb::new(0.0).expect("valid")))
            .expect("valid");
        let bow = Step::new("bow")
            .fix("b.left", &[Axis::X])
            .displace("b.right", Axis::X, -0.818)
            .displace("b.right", Axis::Y, 0.0)
            .tool("roll", [0.0, -3.944]);
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let reports = driver.run(&bow, increments, |_, _| {});
        let reports = reports.unwrap_or_else(|e| panic!("{increments}: {e}"));
        let iterations: usize = reports.iter().map(|r| r.newton_iterations).sum();
        assert!(iterations < 250, "{increments}: {iterations}");
        assert!(reports.iter().all(|r| r.negative_eigenvalues == 0));
        driver.tool_force("roll").expect("exists")[1]
    });
    let [few, many] = ends;
    assert!((few - many).abs() < 1e-6 * few.abs(), "{ends:?}");
    assert!(few < -1e-4, "{few}");
}
