//! Two bodies in space pressed and dragged: what methods, axes, sides and increments may change; an
//! incline.

use super::space::Pile;
use super::*;
use moreau::contact::{ContactSolver, GaussSeidel, SemismoothNewton, Uzawa};
use moreau::laws::Status;
use moreau::mesh::Solid;
use nalgebra::{Rotation3, Unit, Vector3};

/// The lower block stands out on all sides, and its lines meet those of the upper nowhere.
fn gripped(cells: [[usize; 3]; 2]) -> Pile {
    Pile {
        maps: [|x| x, |[x, z]| [1.3 * x - 1.1, 1.25 * z - 0.8 + 0.1 * x]],
        young: [E, E / 4.0],
        friction: FRICTION,
        ..Pile::new([CellKind::Hex8; 2], cells)
    }
}

const FRICTION: f64 = 0.15;

const COARSE: [[usize; 3]; 2] = [[4, 2, 3], [5, 2, 4]];

/// Pressed, then dragged, along changing directions.
const PATH: [[f64; 3]; 3] = [
    [0.0, -2e-3, 0.0],
    [1.5e-3, -2.5e-3, 7e-4],
    [1.2e-3, -2.2e-3, -5e-4],
];

/// Pressed and dragged by displacements of the upper side in the frame of the pile.
fn grip(driver: &Driver<3>, pile: &Pile, motion: [f64; 3]) -> Fallible<Loading<3>> {
    let mesh = driver.mesh();
    let held = [
        mesh.node_group("upper.top")?,
        mesh.node_group("lower.bottom")?,
    ]
    .concat();
    let motion = pile.turn(motion);
    let field = |x: &[f64; 3]| match pile.back(*x)[1] > 0.0 {
        true => motion,
        false => [0.0; 3],
    };
    Ok(prescribed(driver, &Step::new("grip"), &held, field)?)
}

fn run(pile: &Pile, settings: Settings<3>) -> Fallible<Driver<3>> {
    let mut driver = pile.driver(pile.mesh()?, settings)?;
    for motion in PATH {
        let end = grip(&driver, pile, motion)?;
        driver.advance(&end)?;
        action_is_reaction(&driver, pile.surfaces())?;
    }
    Ok(driver)
}

/// The largest distance of contact forces after a turn, over the largest force.
fn farthest(a: &Driver<3>, b: &Driver<3>, turn: Rotation3<f64>) -> f64 {
    let pairs = || a.contacts().iter().zip(b.contacts());
    assert_eq!(a.contacts().len(), b.contacts().len());
    let most = pairs().map(|(a, _)| a.force.norm()).fold(0.0, f64::max);
    let apart = pairs().map(|(a, b)| (turn * a.force - b.force).norm());
    apart.fold(0.0, f64::max) / most
}

#[test]
fn all_methods_find_the_same_forces_between_two_solids() -> Fallible {
    let pile = gripped(COARSE);
    let first = run(&pile, Settings::default())?;
    let slips = |s: Status| first.contacts().iter().any(|c| c.status == s);
    assert!(slips(Status::Slip) && slips(Status::Stick));
    // Friction is a cone, not a pyramid: slip goes in many directions.
    for c in first.contacts().iter().filter(|c| c.status == Status::Slip) {
        let (u, t) = (c.u.fixed_rows::<2>(1), c.t.fixed_rows::<2>(1));
        close("bound", t.norm(), FRICTION * c.t[0], 1e-9);
        assert!(u.dot(&t) <= -(1.0 - 1e-9) * u.norm() * t.norm());
    }
    let others: [Box<dyn ContactSolver<3>>; 3] = [
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
        let apart = farthest(&first, &run(&pile, settings)?, Rotation3::identity());
        assert!(apart <= 1e-8, "{name}: {apart:.2e}");
    }
    Ok(())
}

#[test]
fn two_solids_turned_feel_turned_forces() -> Fallible {
    for kinds in [[CellKind::Hex8; 2], [CellKind::Tet4, CellKind::Hex8]] {
        let pile = Pile {
            kinds,
            ..gripped(COARSE)
        };
        let first = run(&pile, Settings::default())?;
        let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, -0.7));
        let rotation = Rotation3::from_axis_angle(&axis, f64::to_radians(37.0));
        let turned = Pile { rotation, ..pile };
        let apart = farthest(&first, &run(&turned, Settings::default())?, rotation);
        assert!(apart <= 1e-9, "{kinds:?}: {apart:.2e}");
    }
    Ok(())
}

/// 4.11: which side carries the multipliers matters to the order of the mesh size.
#[test]
fn the_choice_of_the_non_mortar_side_fades_with_refinement_in_space() -> Fallible {
    let stored = |swapped: bool, n: usize| -> Fallible<f64> {
        let pile = Pile {
            swapped,
            ..gripped([[2 * n, n, 2 * n], [3 * n, n, 3 * n]])
        };
        let mut driver = pile.driver(pile.mesh()?, Settings::default())?;
        let end = grip(&driver, &pile, PATH[0])?;
        driver.advance(&end)?;
        action_is_reaction(&driver, pile.surfaces())?;
        Ok(driver.energies().stored)
    };
    let mut apart = Vec::new();
    for n in [1, 2, 4] {
        let (a, b) = (stored(false, n)?, stored(true, n)?);
        apart.push((a / b - 1.0).abs());
    }
    // The edges of the upper body are singular, and lie anywhere in the faces of the lower.
    assert!(apart[0] < 5e-2 && apart[2] < 0.25 * apart[0], "{apart:?}");
    Ok(())
}

/// 3.6, NAFEMS CGS-4, with solids: F/G = (tan α + μ)/(1 − μ tan α), for any meshes.
#[test]
fn a_solid_block_is_pushed_up_an_incline() -> Fallible {
    const TAN: f64 = 0.1;
    /// So light that the deformed surface is as steep as the undeformed one.
    const DENSITY: f64 = 1e-2;
    for (friction, expected) in [(0.0, 0.1), (0.2, 0.306_122_4), (0.3, 0.412_371_1)] {
        for swapped in [false, true] {
            let pile = Pile {
                friction,
                swapped,
                young: [E; 2],
                rotation: Rotation3::from_axis_angle(&Vector3::z_axis(), f64::atan(TAN)),
                ..gripped(COARSE)
            };
            let mut driver = pile.driver(pile.mesh()?, Settings::default())?;
            let push = Step::new("push")
                .fix("lower.bottom", &[Axis::X, Axis::Y, Axis::Z])
                .fix("upper.back", &[Axis::Z])
                .displace("upper.left", Axis::X, 1e-3)
                .body_force("upper", [0.0, -DENSITY, 0.0]);
            let reports = driver.run(&push, 2, |_, _| {})?;
            assert!(reports.iter().all(|r| r.cuts == 0), "no increment was cut");
            let volume = driver
                .mesh()
                .measure(driver.mesh().cell_group("upper")?, &Solid);
            let force = driver.reaction("upper.left")?[0];
            let what = format!("F/G at μ = {friction}, swapped {swapped}");
            close(&what, force / (DENSITY * volume), expected, 1e-6);
            action_is_reaction(&driver, pile.surfaces())?;
        }
    }
    Ok(())
}
