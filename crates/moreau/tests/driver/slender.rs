//! A body that bends easily: small forces between large stiffnesses.

use moreau_contact::Ball;
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic, VonMises};
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

/// An elastic strip of length 30 under a roll, and the step that bows it by its right end while the roll goes down.
fn bowed(
    (young, mu): (f64, f64),
    (height, cells): (f64, usize),
    (at, radius): (f64, f64),
    (by, down): (f64, f64),
) -> (Driver<2>, Step<2>) {
    let (x, y) = (uniform(0.0, 30.0, cells), uniform(0.0, height, 2));
    let mesh = block2("b", CellKind::Quad8, &x, &y).expect("valid");
    let law = Elastic::new(young, 0.3).expect("valid");
    let roll = Ball::new([at, height + radius], radius).expect("valid");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("b", law, Integration::Reduced)
        .and_then(|m| m.tool("roll", roll))
        .and_then(|m| m.contact("b.top", "roll", Coulomb::new(mu).expect("valid")))
        .expect("valid");
    let bow = Step::new("bow")
        .fix("b.left", &[Axis::X])
        .displace("b.right", Axis::X, -by)
        .displace("b.right", Axis::Y, 0.0)
        .tool("roll", [0.0, -down]);
    let driver = Driver::new(model, Settings::default()).expect("valid");
    (driver, bow)
}

/// A thin strip, bowed by its end and pressed by a roll, snaps away from under it on the way. Without friction the
/// equilibrium at the end is that of the elastic energy, whatever the increments, and one that lasts: steps of Newton's
/// method beyond the limit point, which lead up to one that does not, are turned downhill.
#[test]
fn what_snaps_comes_to_rest_where_it_stays() {
    let ends = [5, 20].map(|increments| {
        let (strip, roll) = ((0.1, 20), (13.334157, 3.0));
        let (mut driver, bow) = bowed((2000.0, 0.0), strip, roll, (0.818, 3.944));
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

/// A strip bowed by its end snaps away from under a roll, and is straightened again. On the way its stresses make it unstable
/// under what touches, and contact problems have no solution; held by a proximal term they have one, and the iteration goes
/// on from there. Let go it is as it was.
#[test]
fn a_bowed_strip_springs_back() {
    let (strip, roll) = ((1.0, 40), (9.195664, 1.0));
    let (mut driver, bow) = bowed((70_000.0, 0.2), strip, roll, (1.733, 1.371));
    let back = Step::new("back")
        .fix("b.left", &[Axis::X])
        .displace("b.right", Axis::X, 0.0)
        .displace("b.right", Axis::Y, 0.0)
        .tool("roll", [0.0, 1.922]);
    let mut iterations = 0;
    for (step, increments) in [(bow, 5), (back, 2)] {
        let reports = driver.run(&step, increments, |_, _| {}).expect("converges");
        iterations += reports.iter().map(|r| r.newton_iterations).sum::<usize>();
    }
    assert!(iterations < 150, "{iterations}");
    assert_eq!(driver.tool_force("roll").expect("exists").norm(), 0.0);
    assert!(driver.displacements().iter().all(|u| u.abs() < 1e-6));
}

/// A thin sheet bent between three rolls and let go in one increment: nothing holds it any more, and its forces are what
/// rounding left of those before. It comes to rest without a force, bent by what has flowed.
#[test]
fn a_sheet_let_go_between_rolls_comes_to_rest() {
    let (x, y) = (uniform(0.0, 30.0, 16), uniform(0.0, 0.2, 1));
    let mesh = block2("b", CellKind::Quad8, &x, &y).expect("valid");
    let steel = VonMises::new(210e3, 0.3, 250.0).and_then(|l| l.with_isotropic(500.0));
    let law = steel.expect("valid");
    let friction = Coulomb::new(0.3).expect("valid");
    let ball = |x, y| Ball::new([x, y], 3.0).expect("valid");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("b", law, Integration::Reduced)
        .and_then(|m| m.tool("left", ball(5.0, -3.0)))
        .and_then(|m| m.tool("right", ball(25.0, -3.0)))
        .and_then(|m| m.tool("roll", ball(14.0, 3.2)))
        .and_then(|m| m.contact("b.bottom", "left", friction))
        .and_then(|m| m.contact("b.bottom", "right", friction))
        .and_then(|m| m.contact("b.top", "roll", friction))
        .expect("valid");
    let step = |name, y| {
        Step::new(name)
            .fix("b.left", &[Axis::X])
            .tool("roll", [0.0, y])
    };
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let pressed = driver.run(&step("press", -3.0), 5, |_, _| {});
    assert!(pressed.expect("converges")[4].plastic_fraction > 0.1);
    let peak = -driver.tool_force("roll").expect("exists")[1];
    let back = driver.run(&step("back", 1.0), 1, |_, _| {});
    let back = back.expect("converges");
    assert!(
        back[0].cuts == 0 && back[0].newton_iterations < 100,
        "{back:?}"
    );
    // None beyond what balance leaves.
    let none = back[0].out_of_balance.max(1e-9 * peak);
    assert!(none < 1e-6 * peak, "{back:?}");
    for tool in ["left", "right", "roll"] {
        let force = driver.tool_force(tool).expect("exists");
        assert!(force.iter().all(|f| f.abs() <= none), "{tool}: {force:?}");
    }
    let bent = driver
        .displacements()
        .iter()
        .fold(0.0_f64, |a, u| a.max(u.abs()));
    assert!(peak > 0.1 && (0.5..4.0).contains(&bent), "{peak} {bent}");
}
