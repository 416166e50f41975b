//! Large strains against an independent implementation, increment by increment: blocks, cylinders and rings
//! between platens, a bar that necks; not one point of material.

use moreau::driver::{Analysis, Axis, Numbers, Step};
use moreau::mesh::{Axisymmetric, PlaneStrain};
use verification::problems::Fallible;
use verification::problems::large::{
    Billet, CYLINDER, Difference, QUAD4, QUAD8, RING, SQUARE, Tables, bar, indented, turned,
};

const EXACT: f64 = 1e-9;

fn check(off: &Difference, what: &str) {
    let exact = off.load < EXACT && off.plastic_strain < EXACT && off.position < EXACT;
    assert!(exact && off.force < 10.0 * EXACT, "{what}: {off:?}");
    assert_eq!(off.statuses, 0, "{what}: {off:?}");
}

/// Squeezes a billet by a part of its height.
fn squeezed<H: Analysis<2>>(
    billet: Billet<'_>,
    hypothesis: H,
    (hardening, friction): (f64, f64),
    (travel, increments): (f64, usize),
    name: &str,
) -> Fallible<Difference> {
    let mut driver = billet.driver(hypothesis, hardening, friction)?;
    let tables = Tables::read(name)?;
    let mut off = Difference::default();
    let step = billet.held("upset").tool("platen", [0.0, -travel]);
    driver.run(&step, increments, |driver, report| {
        let force = driver.tool_force("platen").expect("a tool");
        off.compare((driver, report), (force[1], "tool0_Fy"), &tables);
    })?;
    check(&off, name);
    Ok(off)
}

#[test]
fn a_block_is_upset_between_platens_that_hold_it() -> Fallible {
    fn upset<H: Analysis<2>>(hypothesis: H, name: &str) -> Fallible {
        let mut driver = SQUARE.driver(hypothesis, 500.0, 0.0)?;
        let step = SQUARE
            .held("upset")
            .fix("block.top", &[Axis::X])
            .displace("block.top", Axis::Y, -2.0)
            // Out of the way.
            .tool("platen", [0.0, 20.0]);
        let tables = Tables::read(name)?;
        let mut off = Difference::default();
        driver.run(&step, 20, |driver, report| {
            let load = driver.reaction("block.top").expect("a group")[1];
            off.compare((driver, report), (load, "driven_force"), &tables);
        })?;
        check(&off, name);
        Ok(())
    }
    upset(PlaneStrain::default(), "F2bond_Q8_8x8_H500")?;
    upset(Axisymmetric, "F2bondax_Q8_8x8_H500")
}

#[test]
fn a_block_is_upset_with_friction() -> Fallible {
    for (kind, mus) in [(QUAD8, [0.0, 0.3, 1.0].as_slice()), (QUAD4, &[0.1])] {
        for &mu in mus {
            let name = format!("F2_{}_8x8_mu{mu}_H500", kind.2);
            let billet = Billet { kind, ..SQUARE };
            let plane = PlaneStrain::default();
            let off = squeezed(billet, plane, (500.0, mu), (4.0, 40), &name)?;
            assert!(off.iterations <= 6, "{name}: {off:?}");
        }
    }
    Ok(())
}

/// Without hardening the tangent is indefinite, and shear bands form.
#[test]
fn a_block_without_hardening_is_upset_with_friction() -> Fallible {
    let plane = PlaneStrain::default();
    for mu in [0.0, 0.1, 0.3] {
        let name = format!("F2_Q8_8x8_mu{mu}_H0");
        squeezed(SQUARE, plane, (0.0, mu), (4.0, 40), &name)?;
    }
    Ok(())
}

/// With μ = 1 there are several equilibria from increment 31 on, and rounding may decide which is found. That of the reference
/// is among those to which parts of the last increment lead, forwards or backwards, in every increment.
#[test]
#[expect(clippy::print_stdout, reason = "says which equilibria there are")]
fn a_block_without_hardening_that_sticks_has_several_equilibria() -> Fallible {
    let name = "F2_Q8_8x8_mu1_H0";
    let tables = Tables::read(name)?;
    let block = || SQUARE.driver(PlaneStrain::default(), 0.0, 1.0);
    let (mut driver, mut trial) = (block()?, block()?);
    let mut last = Vec::new();
    for k in 1..=40 {
        let step = SQUARE
            .held("upset")
            .tool("platen", [0.0, -0.1 * f64::from(k)]);
        let (end, mut before) = (driver.loading(&step)?, Vec::new());
        driver.write(&mut before);
        let starts = [None].into_iter().chain((-15..=15).map(Some));
        let mut nearest: Option<(Difference, Vec<f64>, Vec<f64>)> = None;
        for tenths in starts {
            trial.read(&mut Numbers::Read(&before))?;
            if let Some(tenths) = tenths {
                let part: Vec<f64> = last.iter().map(|u| 0.1 * f64::from(tenths) * u).collect();
                trial.guess(&part)?;
            }
            let Ok(report) = trial.advance(&end) else {
                continue;
            };
            let (mut now, mut after) = (Difference::default(), Vec::new());
            let force = trial.tool_force("platen")?;
            now.compare((&trial, &report), (force[1], "tool0_Fy"), &tables);
            trial.write(&mut after);
            let exact = now.load < EXACT;
            if k > 30 && !(exact && tenths.is_none()) {
                let start = tenths.map_or("the path".into(), |n| format!("{n} tenths"));
                println!("increment {k}, from {start}: {:.4} N", force[1]);
            }
            let d_u = trial.displacements().iter().zip(driver.displacements());
            let d_u: Vec<f64> = d_u.map(|(u, before)| u - before).collect();
            if nearest
                .as_ref()
                .is_none_or(|(least, ..)| now.load < least.load)
            {
                nearest = Some((now, after, d_u));
            }
            if exact || k <= 30 {
                break;
            }
        }
        let (now, after, d_u) = nearest.ok_or("no equilibrium")?;
        check(&now, &format!("{name}, increment {k}"));
        last = d_u;
        driver.read(&mut Numbers::Read(&after))?;
    }
    Ok(())
}

#[test]
fn a_cylinder_is_upset_with_friction() -> Fallible {
    for mu in [0.0, 0.1, 0.3] {
        let name = format!("F3cyl_Q8_8x12_mu{mu}");
        let off = squeezed(CYLINDER, Axisymmetric, (500.0, mu), (7.5, 50), &name)?;
        assert!(off.iterations <= 6, "{name}: {off:?}");
    }
    Ok(())
}

#[test]
fn a_ring_is_squeezed_with_friction() -> Fallible {
    let rings = [0.0, 0.1, 0.4].map(|mu| (QUAD8, mu));
    for (kind, mu) in rings.into_iter().chain([(QUAD4, 0.2)]) {
        let name = format!("F3ring_{}_12x8_mu{mu}_H500", kind.2);
        let billet = Billet { kind, ..RING };
        let off = squeezed(billet, Axisymmetric, (500.0, mu), (1.5, 50), &name)?;
        assert!(off.iterations <= 6, "{name}: {off:?}");
    }
    Ok(())
}

#[test]
fn a_bar_is_drawn_until_it_necks() -> Fallible {
    for kind in [QUAD8, QUAD4] {
        let mut driver = bar(kind)?;
        let name = format!("F4_{}_4x15_n140", kind.2);
        let (tables, mut off) = (Tables::read(&name)?, Difference::default());
        let step = Step::new("draw")
            .fix("bar.left", &[Axis::X])
            .fix("bar.bottom", &[Axis::Y])
            .displace("bar.top", Axis::Y, 7.0);
        driver.run(&step, 140, |driver, report| {
            let load = driver.reaction("bar.top").expect("a group")[1];
            off.compare((driver, report), (load, "driven_force"), &tables);
        })?;
        check(&off, &name);
        // One more where the neck begins, and all beside it unloads.
        assert!(off.iterations <= 7, "{name}: {off:?}");
    }
    Ok(())
}

#[test]
fn a_block_is_indented_by_a_disc() -> Fallible {
    let mut driver = indented(0.2)?;
    let name = "F5_Q8_lev1_mu0.2";
    let (tables, mut off) = (Tables::read(name)?, Difference::default());
    let step = Step::new("indent")
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .fix("block.left", &[Axis::X])
        .tool("disc", [0.0, -3.0]);
    driver.run(&step, 60, |driver, report| {
        let force = driver.tool_force("disc").expect("a tool");
        off.compare((driver, report), (force[1], "tool0_Fy"), &tables);
        let moment = driver.tool_moment("disc").expect("a tool");
        off.compare((driver, report), (moment.z, "tool0_M"), &tables);
    })?;
    check(&off, name);
    Ok(())
}

#[test]
fn a_block_is_squeezed_between_platens_that_turn() -> Fallible {
    for (name, quarter) in [("straight", 0.0), ("rot90", std::f64::consts::FRAC_PI_2)] {
        let mut driver = turned()?;
        let name = format!("F6_Q8_8x8_mu0.3_{name}");
        let (tables, mut off) = (Tables::read(&name)?, Difference::default());
        for k in 1..=40 {
            let part = f64::from(k) / 40.0;
            let (angle, closed) = (quarter * part, 3.0 * part);
            let (s, c) = angle.sin_cos();
            let axis = [0.0, 0.0, 1.0];
            let step = Step::new("squeeze")
                .fix("pin", &[Axis::X, Axis::Y])
                .tool("top", [s * closed, -c * closed])
                .turn("top", axis, angle)
                .tool("bottom", [-s * closed, c * closed])
                .turn("bottom", axis, angle);
            driver.run(&step, 1, |driver, report| {
                let force = driver.tool_force("top").expect("a tool");
                let load = c * force[1] - s * force[0];
                off.compare((driver, report), (load, "tool0_Fy_body"), &tables);
            })?;
        }
        check(&off, &name);
    }
    Ok(())
}
