//! A square that is pressed on its corner into a block, without friction: what the corner meets turns away under it.

use super::*;
use moreau::laws::VonMises;
use verification::problems::large::QUAD4;

const SIDE: f64 = 6.0;
const PRESSED: f64 = 1.5;
const STEPS: usize = 20;

/// The surface whose nodes are kept out of the other, and that.
fn pressed(surface: &str, opposite: &str) -> Fallible<Driver<2>> {
    let (kind, law, _) = QUAD4;
    let on_corner = |[x, y]: [f64; 2]| {
        let x = Rotation2::new(PI / 4.0) * nalgebra::Vector2::new(x, y);
        [x[0], x[1]]
    };
    let across = uniform(0.0, SIDE, 10);
    let mut mesh = block2("square", kind, &across, &across)?
        .map(on_corner)?
        .joined(block2(
            "base",
            kind,
            &uniform(-10.0, 10.0, 20),
            &uniform(-8.0, 0.0, 8),
        )?)?;
    for (name, sides) in [
        ("low", ["square.left", "square.bottom"]),
        ("high", ["square.right", "square.top"]),
    ] {
        let facets = sides.map(|side| mesh.facet_group(side).map(<[_]>::to_vec));
        let [first, second] = facets;
        mesh.add_facet_group(name, [first?, second?].concat())?;
    }
    let elastic = VonMises::new(1e3, NU, 1e9)?;
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("base", elastic.clone(), law)?
        .material("square", elastic, law)?
        .contact(surface, opposite, Coulomb::new(0.0)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let (fixed, moved) = (
        driver.mesh().node_group("base.bottom")?,
        driver.mesh().node_group("high")?,
    );
    let mut end = driver.applied().clone();
    for k in 1..=STEPS {
        let depth = PRESSED * k as f64 / STEPS as f64;
        for (group, u) in [(&fixed, [0.0, 0.0]), (&moved, [0.0, -depth])] {
            for &a in group {
                (0..2).for_each(|i| _ = end.displacement.insert(2 * a + i, u[i]));
            }
        }
        let report = driver.advance(&end)?;
        assert!(
            report.cuts == 0 && report.newton_iterations <= 6,
            "increment {k}: {report:?}"
        );
    }
    Ok(driver)
}

/// A point that bears on a node would fall to either side without friction but for the bodies themselves: surfaces that are
/// paired where a step leads lead it hundreds of times as far away. Either surface may be the one whose nodes are kept out.
#[test]
fn a_square_is_pressed_on_its_corner_without_friction() -> Fallible {
    let mut forces = Vec::new();
    for (surface, opposite) in [("low", "base.top"), ("base.top", "low")] {
        let force = pressed(surface, opposite)?.contact_force("low")?;
        assert!(force[0].abs() <= 1e-6 * force[1], "{surface}: {force}");
        forces.push(force[1]);
    }
    assert!(
        (forces[0] - forces[1]).abs() < 0.1 * forces[0],
        "{forces:?}"
    );
    Ok(())
}
