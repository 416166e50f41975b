//! A block under large strains that is dragged over another one, three times its length and across many edges.

use super::*;
use moreau::driver::IncrementReport;
use moreau::laws::{Status, VonMises};
use nalgebra::Vector2;
use verification::problems::large::{Cells, QUAD4, QUAD8};

const LENGTH: f64 = 8.0;
const WAY: f64 = 3.0 * LENGTH;
const PRESSED: f64 = 0.2;
const MU: f64 = 0.3;
const STEPS: usize = 24;

/// Cells along the base for every eight and a quarter of the block's, at a distance from its ends.
fn dragged(kinds: [Cells; 2], finer: usize) -> Fallible<Driver<2>> {
    let block = |name: &str, kind: Cells, x: [f64; 2], y: [f64; 2], cells: [usize; 2]| {
        let (x, y) = (
            uniform(x[0], x[1], finer * cells[0]),
            uniform(y[0], y[1], finer * cells[1]),
        );
        block2(name, kind.0, &x, &y)
    };
    let mesh = block("base", kinds[0], [-6.0, 40.0], [-5.0, 0.0], [37, 3])?.joined(block(
        "block",
        kinds[1],
        [0.0, LENGTH],
        [0.0, 4.0],
        [8, 3],
    )?)?;
    let elastic = VonMises::new(10e3, NU, 1e9)?;
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("base", elastic.clone(), kinds[0].1)?
        .material("block", elastic, kinds[1].1)?
        .contact("block.bottom", "base.top", Coulomb::new(MU)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Force on a surface, and its moment about the origin.
fn resultant(driver: &Driver<2>, surface: &str) -> Fallible<(Vector2<f64>, f64)> {
    let (mut force, mut moment) = (Vector2::zeros(), 0.0);
    for a in driver.mesh().node_group(surface)? {
        let x = Vector2::from(driver.mesh().nodes()[a]) + driver.displacement(a);
        let f = driver.nodal_contact_force(a);
        force += f;
        moment += x.perp(&f);
    }
    Ok((force, moment))
}

/// What holds at the end of every increment: action is reaction, in forces and in moments, and what slips obeys
/// Coulomb's law, against its slip.
fn obeys(driver: &Driver<2>) -> Fallible {
    let (own, other) = (
        resultant(driver, "block.bottom")?,
        resultant(driver, "base.top")?,
    );
    let size: f64 = driver.contacts().iter().map(|c| c.force.norm()).sum();
    let left = (own.0 + other.0).norm();
    assert!(
        left <= 1e-14 * size,
        "{left:e} N of {size} N are not returned"
    );
    let left = (own.1 + other.1).abs();
    assert!(
        left <= 1e-13 * size * WAY,
        "{left:e} Nmm of {} are not",
        own.1
    );
    for c in driver.contacts() {
        assert!(
            c.u[0] >= -1e-9 * PRESSED,
            "{} is {:e} mm inside",
            c.node,
            c.u[0]
        );
        match c.status {
            Status::Open => assert!(c.t.norm() == 0.0 && c.u[0] > 0.0),
            Status::Stick => assert!(c.u[1].abs() <= 1e-9 * PRESSED && c.t[1].abs() <= MU * c.t[0]),
            Status::Tied => unreachable!("no tie"),
            Status::Slip => {
                let excess = c.t[1] + MU * c.t[0] * c.u[1].signum();
                assert!(
                    excess.abs() <= 1e-9 * size,
                    "{} is {excess:e} N off",
                    c.node
                );
            }
        }
    }
    Ok(())
}

/// Presses the block on and drags it, while the whole turns by an angle; the forces on the block after every
/// increment of the way, in the frame that turns.
fn forces(
    mut driver: Driver<2>,
    angle: f64,
    mut watch: impl FnMut(&Driver<2>, &IncrementReport) -> Fallible,
) -> Fallible<Vec<Vector2<f64>>> {
    let nodes = driver.mesh().nodes().to_vec();
    let (low, high) = (
        driver.mesh().node_group("base.bottom")?,
        driver.mesh().node_group("block.top")?,
    );
    let mut end = driver.applied().clone();
    let mut apply = |driver: &mut Driver<2>, way: f64, depth: f64| -> Fallible<IncrementReport> {
        let turn = Rotation2::new(angle * way / WAY);
        for (group, moved) in [(&low, [0.0, 0.0]), (&high, [way, -depth])] {
            for &a in group {
                let x = Vector2::from(nodes[a]);
                let u = turn * (x + Vector2::from(moved)) - x;
                (0..2).for_each(|i| _ = end.displacement.insert(2 * a + i, u[i]));
            }
        }
        Ok(driver.advance(&end)?)
    };
    for k in 1..=2 {
        apply(&mut driver, 0.0, 0.5 * PRESSED * f64::from(k))?;
    }
    let mut all = Vec::new();
    for k in 1..=STEPS {
        let way = WAY * k as f64 / STEPS as f64;
        let report = apply(&mut driver, way, PRESSED)?;
        obeys(&driver)?;
        watch(&driver, &report)?;
        all.push(Rotation2::new(-angle * way / WAY) * driver.contact_force("block.bottom")?);
    }
    Ok(all)
}

/// How much a component varies once the block slips, over its mean.
fn variation(forces: &[Vector2<f64>], component: usize) -> f64 {
    let steady = forces[8..].iter().map(|f| f[component].abs());
    let (low, high) = steady
        .clone()
        .fold((f64::INFINITY, 0.0f64), |(l, h), f| (l.min(f), h.max(f)));
    2.0 * (high - low) / (high + low)
}

/// All slips, and the resultants do not depend on where the block is, but for the edges of the mesh that it goes
/// over: the finer that is, the less.
#[test]
fn a_block_is_dragged_over_three_times_its_length() -> Fallible {
    let mut iterations = 0;
    let mut along = |kinds, finer| {
        forces(dragged(kinds, finer)?, 0.0, |_, report| {
            assert_eq!((report.open, report.stick, report.cuts), (0, 0, 0));
            // Once it is under way.
            if report.increment > 6 {
                iterations = report.newton_iterations.max(iterations);
            }
            Ok(())
        })
    };
    along([QUAD8, QUAD8], 1)?;
    let forces = [along([QUAD4, QUAD8], 1)?, along([QUAD4, QUAD8], 2)?];
    assert!(iterations <= 4, "{iterations} iterations");
    for component in 0..2 {
        let [coarse, fine] = forces.each_ref().map(|f| variation(f, component));
        assert!(
            fine < coarse && coarse < 0.03,
            "component {component} varies by {coarse:e}, on a finer mesh by {fine:e}"
        );
    }
    Ok(())
}

/// The same with the whole turning by 70° on the way: slips are those of the one body on the other.
#[test]
fn what_turns_on_the_way_does_not_matter() -> Fallible {
    let straight = forces(dragged([QUAD8, QUAD4], 1)?, 0.0, |_, _| Ok(()))?;
    let turned = forces(dragged([QUAD8, QUAD4], 1)?, 70f64.to_radians(), |_, _| {
        Ok(())
    })?;
    for (k, (a, b)) in straight.iter().zip(&turned).enumerate() {
        let off = (a - b).norm() / a.norm();
        assert!(off <= 1e-8, "increment {k}: {off:e}");
    }
    Ok(())
}
