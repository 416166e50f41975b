//! A part that folds until its surface touches itself, against the same part with two surfaces that are told apart.

use super::*;
use moreau::contact::Plane;
use moreau::laws::VonMises;
use nalgebra::Vector2;

/// Arms, radius of the middle of the bend, thickness.
const ARM: f64 = 8.0;
const RADIUS: f64 = 1.5;
const THICK: f64 = 1.0;
const LENGTH: f64 = 2.0 * ARM + PI * RADIUS;

/// What was at s along a strip and q above its middle, where that is bent to a hairpin.
fn bent([s, q]: [f64; 2]) -> [f64; 2] {
    let (bend, r) = (PI * RADIUS, RADIUS - q);
    match s {
        s if s <= ARM => [s, q],
        s if s <= ARM + bend => {
            let (sin, cos) = ((s - ARM) / RADIUS).sin_cos();
            [ARM + r * sin, RADIUS - r * cos]
        }
        s => [2.0 * ARM + bend - s, 2.0 * RADIUS - q],
    }
}

/// A strip bent to a hairpin that is open to the left; what was its top is inside.
fn hairpin() -> Fallible<Mesh<2>> {
    let (s, q) = (
        uniform(0.0, LENGTH, 41),
        uniform(-0.5 * THICK, 0.5 * THICK, 2),
    );
    let mut mesh = block2("strip", CellKind::Quad8, &s, &q)?.map(bent)?;
    // All but the facet in the middle of the bend.
    mesh.facet_group_where("low", "strip.top", |x| x[1] < RADIUS - 0.01)?;
    mesh.facet_group_where("high", "strip.top", |x| x[1] > RADIUS + 0.01)?;
    mesh.facet_group_where("base", "strip.bottom", |x| x[1] < RADIUS && x[0] < 6.0)?;
    mesh.facet_group_where("push", "strip.bottom", |x| x[1] > RADIUS && x[0] < 6.0)?;
    Ok(mesh)
}

/// Presses the arms together and pulls one along the other; forces on the upper one.
fn closed(own: &str, opposite: &str) -> Fallible<(Driver<2>, Vec<Vector2<f64>>)> {
    let elastic = VonMises::new(10e3, NU, 1e9)?;
    let model = Model::with_large_strains(hairpin()?, PlaneStrain::default())
        .material("strip", elastic, CellKind::Quad8.integration())?
        .contact(own, opposite, Coulomb::new(0.2)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = |x: f64, y: f64| {
        Step::new("fold")
            .fix("base", &[Axis::X, Axis::Y])
            .displace("push", Axis::X, x)
            .displace("push", Axis::Y, y)
    };
    let mut forces = Vec::new();
    let gap = 2.0 * RADIUS - THICK;
    for (x, y, increments) in [(0.0, -1.1 * gap, 8), (1.5, -1.1 * gap, 6)] {
        driver.run(&step(x, y), increments, |driver, _| {
            forces.push(driver.reaction("push").expect("a group"));
        })?;
    }
    Ok((driver, forces))
}

#[test]
fn a_surface_that_meets_itself_is_as_two_that_meet() -> Fallible {
    let (two, expected) = closed("low", "high")?;
    let (one, found) = closed("strip.top", "strip.top")?;
    let size = expected.iter().map(|f| f.norm()).fold(0.0, f64::max);
    assert!(size > 100.0);
    for (k, (a, b)) in expected.iter().zip(&found).enumerate() {
        let off = (a - b).norm() / size;
        assert!(off <= 1e-8, "increment {k}: {a} {b}");
    }
    let touching = |driver: &Driver<2>| driver.contacts().iter().filter(|c| c.t[0] > 0.0).count();
    assert!(touching(&one) > 2, "{}", touching(&one));
    assert_eq!(touching(&one), touching(&two));
    // All that the surface gives itself.
    let (mut force, mut moment, mut all) = (Vector2::zeros(), 0.0, 0.0);
    for a in one.mesh().node_group("strip.top")? {
        let f = one.nodal_contact_force(a);
        force += f;
        moment += (Vector2::from(one.mesh().nodes()[a]) + one.displacement(a)).perp(&f);
        all += f.norm();
    }
    assert!(force.norm() <= 1e-13 * all, "{force}");
    assert!(moment.abs() <= 1e-12 * all * ARM, "{moment}");
    Ok(())
}

/// Under small strains a fold is none.
#[test]
fn small_strains_refuse_a_surface_against_itself() -> Fallible {
    let model = Model::new(hairpin()?, PlaneStrain::default());
    let refused = model.contact("strip.top", "strip.top", Coulomb::new(0.2)?);
    assert!(matches!(
        refused.err(),
        Some(ModelError::SmallSelfContact { .. })
    ));
    Ok(())
}

/// A strip bent to an S of three arms, all to the right of where it begins.
fn zigzag() -> Fallible<Mesh<2>> {
    let length = 3.0 * ARM + 2.0 * PI * RADIUS;
    let (s, q) = (
        uniform(0.0, length, 36),
        uniform(-0.5 * THICK, 0.5 * THICK, 2),
    );
    let bend = PI * RADIUS;
    Ok(block2("strip", CellKind::Quad4, &s, &q)?.map(|[s, q]| {
        if s <= 2.0 * ARM + bend {
            return bent([s, q]);
        }
        let (round, r) = (s - 2.0 * ARM - bend, RADIUS + q);
        match round {
            s if s <= bend => {
                let (sin, cos) = (s / RADIUS).sin_cos();
                [-r * sin, 3.0 * RADIUS - r * cos]
            }
            s => [s - bend, 4.0 * RADIUS + q],
        }
    })?)
}

/// The surface that a tool presses may meet itself elsewhere: as long as it does not, nothing changes. Each node then has two
/// multipliers, of normals that are nearly the same.
#[test]
fn a_surface_that_might_meet_itself_is_pressed_as_one_that_does_not() -> Fallible {
    let pressed = |of_itself: bool| -> Fallible<Vector2<f64>> {
        let top = Plane::new([0.0, 4.0 * RADIUS + 0.5 * THICK], [0.0, -1.0])?;
        let mut model = Model::with_large_strains(zigzag()?, PlaneStrain::default())
            .material(
                "strip",
                Elastic::new(1e3, NU)?,
                CellKind::Quad4.integration(),
            )?
            .tool("top", top)?;
        if of_itself {
            model = model.contact("strip.top", "strip.top", Coulomb::new(0.0)?)?;
        }
        let model = model.contact("strip.top", "top", Coulomb::new(0.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let step = Step::new("press")
            .fix("strip.left", &[Axis::X, Axis::Y])
            .tool("top", [0.0, -0.5]);
        driver.run(&step, 10, |_, _| {})?;
        Ok(driver.reaction("strip.left").expect("a group"))
    };
    let (alone, both) = (pressed(false)?, pressed(true)?);
    assert!(alone.norm() > 1e-3, "{alone}");
    assert!(
        (alone - both).norm() < 1e-9 * alone.norm(),
        "{alone} {both}"
    );
    Ok(())
}
