//! Two bodies pressed and dragged, in the plane: what methods, axes, sides and increments may change.

use super::*;
use moreau::contact::{ContactSolver, GaussSeidel, SemismoothNewton, Uzawa};
use moreau::driver::Nesting;
use moreau::laws::Status;

/// Pressed, then dragged, by displacements of the upper side in the frame of the stack.
fn grip(driver: &Driver<2>, stack: &Stack, motion: [f64; 2]) -> Fallible<Loading<2>> {
    let mesh = driver.mesh();
    let (top, bottom) = (
        mesh.node_group("upper.top")?,
        mesh.node_group("lower.bottom")?,
    );
    let held: Vec<usize> = top.iter().chain(&bottom).copied().collect();
    let motion = stack.turn(motion);
    let back = Rotation2::new(-stack.angle);
    let field = |x: &[f64; 2]| match (back * Vector2::from(*x))[1] > 0.0 {
        true => motion,
        false => [0.0; 2],
    };
    Ok(prescribed(driver, &Step::new("grip"), &held, field)?)
}

fn gripped() -> Stack {
    Stack {
        lines: [uniform(0.0, 4.0, 6), uniform(-1.1, 5.3, 7)],
        young: [E, E / 4.0],
        friction: 0.2,
        ..Stack::new(CellKind::Quad8, [1, 1])
    }
}

const PATH: [[f64; 2]; 3] = [[0.0, -2e-3], [4e-4, -2.5e-3], [-2e-4, -2e-3]];

fn run(stack: &Stack, path: &[[f64; 2]], settings: Settings<2>) -> Fallible<Driver<2>> {
    let mut driver = stack.driver(stack.mesh()?, settings)?;
    for motion in path {
        let end = grip(&driver, stack, *motion)?;
        driver.advance(&end)?;
    }
    action_is_reaction(&driver, stack.surfaces())?;
    Ok(driver)
}

fn farthest(a: &Driver<2>, b: &Driver<2>, turn: f64) -> f64 {
    let turn = Rotation2::new(turn);
    let pairs = || a.contacts().iter().zip(b.contacts());
    let most = pairs().map(|(a, _)| a.force.norm()).fold(0.0, f64::max);
    pairs()
        .map(|(a, b)| (turn * a.force - b.force).norm())
        .fold(0.0, f64::max)
        / most
}

#[test]
fn all_methods_find_the_same_forces_between_two_bodies() -> Fallible {
    let stack = gripped();
    let first = run(&stack, &PATH, Settings::default())?;
    let slips = |s: Status| first.contacts().iter().any(|c| c.status == s);
    assert!(slips(Status::Slip) && slips(Status::Stick));
    let others: [Box<dyn ContactSolver<2>>; 3] = [
        Box::new(SemismoothNewton::default()),
        Box::new(GaussSeidel::default()),
        Box::new(Uzawa::default()),
    ];
    for contact in others {
        let name = format!("{contact:?}");
        let settings = Settings {
            contact,
            ..Settings::default()
        };
        let apart = farthest(&first, &run(&stack, &PATH, settings)?, 0.0);
        assert!(apart <= 1e-8, "{name}: {apart:.2e}");
    }
    let nesting = Nesting::Outside {
        tolerance: 1e-6,
        iterations: 20_000,
    };
    let settings = Settings {
        nesting,
        ..Settings::default()
    };
    let path = &PATH[..1];
    let first = run(&stack, path, Settings::default())?;
    let apart = farthest(&first, &run(&stack, path, settings)?, 0.0);
    assert!(apart <= 1e-4, "the paper's nesting: {apart:.2e}");
    Ok(())
}

#[test]
fn two_bodies_turned_feel_turned_forces() -> Fallible {
    let first = run(&gripped(), &PATH, Settings::default())?;
    for angle in [0.7, PI / 2.0, -2.5] {
        let stack = Stack { angle, ..gripped() };
        let apart = farthest(&first, &run(&stack, &PATH, Settings::default())?, angle);
        assert!(apart <= 1e-9, "{angle}: {apart:.2e}");
    }
    Ok(())
}

/// 4.11: which side carries the multipliers matters to the order of the mesh size.
#[test]
fn the_choice_of_the_non_mortar_side_fades_with_refinement() -> Fallible {
    let stored = |swapped: bool, n: usize| -> Fallible<f64> {
        let stack = Stack {
            lines: [uniform(0.0, 4.0, 3 * n), uniform(-1.1, 5.3, 4 * n)],
            swapped,
            ..gripped()
        };
        let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
        let end = grip(&driver, &stack, PATH[0])?;
        driver.advance(&end)?;
        action_is_reaction(&driver, stack.surfaces())?;
        Ok(driver.energies().stored)
    };
    let mut apart = Vec::new();
    for n in [1, 2, 4] {
        let (a, b) = (stored(false, n)?, stored(true, n)?);
        apart.push((a / b - 1.0).abs());
    }
    // The corners of the upper body are singular, and lie anywhere in the edges of the lower.
    assert!(apart[0] < 3e-2 && apart[2] < 0.5 * apart[0], "{apart:?}");
    Ok(())
}

/// Work is stored or dissipated, to the order of the increment.
#[test]
fn the_energy_of_two_bodies_is_balanced() -> Fallible {
    let stack = gripped();
    let mut left = Vec::new();
    for steps in [8, 16, 32] {
        let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
        let mut from = [0.0; 2];
        for to in PATH {
            for k in 1..=steps {
                let s = k as f64 / steps as f64;
                let motion = [0, 1].map(|i| from[i] + s * (to[i] - from[i]));
                let end = grip(&driver, &stack, motion)?;
                let report = driver.advance(&end)?;
                assert!(report.relative_gap().abs() < 1e-10);
            }
            from = to;
        }
        let energies = driver.energies();
        assert!(energies.friction_dissipation > 1e-3 * energies.external_work);
        left.push((energies.imbalance() / energies.friction_dissipation).abs());
    }
    assert!(
        left[2] < 0.05 && left[2] < 0.6 * left[1] && left[1] < 0.6 * left[0],
        "{left:?}"
    );
    Ok(())
}
