//! Bodies on tools of many curved triangles; the tools' surface itself is tested where it is.

use moreau_contact::{Plane, Triangulated};
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic};
use moreau_mesh::{CellKind, Solid, block3, uniform};
use std::f64::consts::{FRAC_PI_2, TAU};

const SEGMENTS: usize = 64;

/// A drawing die: a ring from 7 to 25, its top at -1, whose inner edge is rounded by 3, by an angle of sharp edges.
fn die(sharp: f64) -> Triangulated {
    let round = (0..=6).map(|k| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(k) / 6.0).sin_cos();
        (10.0 - 3.0 * sin, -4.0 + 3.0 * cos)
    });
    let ends = [(7.0, -12.0), (25.0, -12.0)];
    let profile: Vec<(f64, f64)> = [(25.0, -1.0)]
        .into_iter()
        .chain(round)
        .chain(ends)
        .collect();
    let count = profile.len();
    let turned = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / SEGMENTS as f64).sin_cos();
        profile.iter().map(move |&(r, y)| [r * cos, y, r * sin])
    };
    let points: Vec<[f64; 3]> = (0..SEGMENTS).flat_map(turned).collect();
    let cell = |k: usize| {
        let (own, next) = (k / count * count, (k / count + 1) % SEGMENTS * count);
        let [a, b] = [k % count, (k + 1) % count];
        [[own + a, own + b, next + b], [own + a, next + b, next + a]]
    };
    let faces: Vec<[usize; 3]> = (0..SEGMENTS * count).flat_map(cell).collect();
    Triangulated::new(&points, &faces, sharp).expect("closed")
}

/// A sheet held on a die by a plane that a force drives: its forces are in balance after three iterations, and friction
/// of a smooth edge is asked for no more digits than its patches have.
#[test]
fn a_sheet_is_held_on_the_round_edge_of_a_die() {
    let held = |sharp: f64| {
        let lines = uniform(0.0, 15.0, 5);
        let mesh = block3("b", CellKind::Hex8, &lines, &[-1.0, 0.0], &lines).expect("valid");
        let law = Elastic::new(70e3, 0.33).expect("valid");
        let coulomb = Coulomb::new(0.1).expect("valid");
        let holder = Plane::new([0.0; 3], [0.0, -1.0, 0.0]).expect("valid");
        let model = Model::with_large_strains(mesh, Solid)
            .material("b", law, CellKind::Hex8.integration())
            .and_then(|m| m.tool("die", die(sharp)))
            .and_then(|m| m.tool("holder", holder))
            .and_then(|m| m.contact("b.top", "holder", coulomb))
            .and_then(|m| m.contact("b.bottom", "die", coulomb))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = Step::new("hold")
            .fix("b.left", &[Axis::X])
            .fix("b.back", &[Axis::Z])
            .push("holder", Axis::Y, -2000.0);
        let reports = driver.run(&step, 1, |_, _| {}).expect("converges");
        let iterations: usize = reports.iter().map(|r| r.newton_iterations).sum();
        (iterations, driver.tool_force("die").expect("there"))
    };
    let ((smooth, force), (_, faceted)) = (held(0.5), held(0.01));
    assert!(smooth <= 5, "{smooth}");
    assert!((force[1] - 2000.0).abs() < 1e-6, "{force}");
    assert!(
        (force - faceted).norm() < 1e-3 * faceted.norm(),
        "{force} {faceted}"
    );
}
