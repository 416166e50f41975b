//! Contact nodes that displacement conditions hold, on either side or on both, on the finer side or
//! on the coarser: their multipliers go to their neighbours, and nothing else is lost.

use super::*;
use moreau::laws::Status;
use moreau::mesh::Solid;

use CellKind::{Hex8, Hex20, Hex27, Quad4, Quad8, Quad9, Tet10, Tri6};

/// Pairs of cells and meshes, the finer body above or below and either as the non-mortar side.
fn stacks<H: Blocks<D>, const D: usize>(kinds: &[[CellKind; 2]]) -> Vec<Stack<H, D>> {
    let mut all = Vec::new();
    for &kinds in kinds {
        for cells in [[[3, 1, 3], [4, 1, 4]], [[5, 1, 5], [2, 1, 2]]] {
            for swapped in [false, true] {
                let stack = Stack::new(kinds, cells.map(|c: [usize; 3]| from_fn(|i| c[i])));
                all.push(Stack { swapped, ..stack });
            }
        }
    }
    all
}

fn plane() -> Vec<Stack<PlaneStrain, 2>> {
    stacks(&[[Quad4, Quad4], [Quad8, Quad8], [Quad9, Tri6]])
}

fn space() -> Vec<Stack<Solid, 3>> {
    stacks(&[[Hex8, Hex8], [Hex20, Hex20], [Hex27, Hex8], [Tet10, Hex20]])
}

/// The displacement of a pressure with a shear along x, of both blocks.
fn exact<H: Blocks<D>, const D: usize>(x: &[f64; D], shear: f64) -> [f64; D] {
    let p = PRESSURE / E;
    let side = NU * (1.0 - H::ACROSS) * p;
    let down = (1.0 - NU * H::ACROSS.abs()) * p;
    let slope = 2.0 * shear * (1.0 + NU) / E;
    from_fn(|i| match i {
        0 => side * x[0] + slope * x[1],
        1 => -down * x[1],
        _ => side * x[2],
    })
}

/// Puts a stack under a pressure, and a shear that sticks, with sides of bodies that move as in the
/// exact solution: its state is that.
fn press<H: Blocks<D>, const D: usize>(
    driver: &mut Driver<D>,
    stack: &Stack<H, D>,
    sides: &[&str],
    shear: f64,
) -> Fallible {
    let top = from_fn(|i| [shear, -PRESSURE, 0.0][i]);
    let mut step = Step::new("press").traction("upper.top", top);
    for (side, sign) in [("left", -1.0), ("right", 1.0)] {
        let side_load = from_fn(|i| if i == 1 { sign * shear } else { 0.0 });
        for body in ["upper", "lower"] {
            step = step.traction(&format!("{body}.{side}"), side_load);
        }
    }
    let mut held = driver.mesh().node_group("lower.bottom")?;
    for side in sides {
        held.extend(driver.mesh().node_group(side)?);
    }
    let end = prescribed(driver, &step, &held, |x| exact::<H, D>(x, shear))?;
    driver.advance(&end)?;
    let mut stress = squeezed::<H, D>();
    stress[5] = 2f64.sqrt() * shear;
    uniform_stress(driver, stress, &format!("{} {sides:?}", stack.what()));
    action_is_reaction(driver, stack.surfaces())?;
    Ok(())
}

/// Sides of one body or of both, where the interface ends, without friction and sticking under a
/// shear: the state stays uniform, and the points that are left share all of the surface.
#[test]
fn a_uniform_state_passes_beside_nodes_that_are_held() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(stacks: Vec<Stack<H, D>>) -> Fallible {
        let both: &[&str] = &["upper.left", "lower.left"];
        let round: &[&str] = &["upper.left", "upper.right", "lower.left", "lower.right"];
        for stack in stacks {
            for (k, sides) in [&both[..1], &both[1..], both, round]
                .into_iter()
                .enumerate()
            {
                let shear = if k % 2 == 0 { 0.0 } else { 20.0 };
                let stack = Stack {
                    friction: 2.0 * shear / PRESSURE,
                    ..stack.clone()
                };
                let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
                press(&mut driver, &stack, sides, shear)?;
                let what = format!("{} {sides:?}", stack.what());
                uniform_pressure(&driver, PRESSURE, &what);
                let area: f64 = driver.contacts().iter().map(|c| c.area).sum();
                close(&what, area, H::FOOTPRINT, 1e-12);
                // None at a node that is wholly held.
                let name = stack.surfaces()[0].split('.').next().unwrap_or_default();
                for side in sides.iter().filter(|s| s.starts_with(name)) {
                    let held = driver.mesh().node_group(side)?;
                    for c in driver.contacts().iter().filter(|c| held.contains(&c.node)) {
                        assert!(c.area == 0.0 && c.status == Status::Open, "{what}");
                        assert_eq!(c.traction().norm(), 0.0, "{what}");
                    }
                }
            }
        }
        Ok(())
    }
    check(plane())?;
    check(space())
}

/// Held in one step and not in the next, under the same load: the state stays, and the nodes have
/// their multipliers again.
#[test]
fn a_node_that_is_released_has_a_multiplier_again() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(stacks: Vec<Stack<H, D>>) -> Fallible {
        for stack in stacks.into_iter().step_by(3) {
            let friction = 0.5;
            let stack = Stack { friction, ..stack };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            press(&mut driver, &stack, &["upper.left", "lower.left"], 20.0)?;
            assert!(driver.contacts().iter().any(|c| c.area == 0.0));
            press(&mut driver, &stack, &[], 20.0)?;
            assert!(driver.contacts().iter().all(|c| c.area > 0.0));
        }
        Ok(())
    }
    check(plane())?;
    check(space())
}

/// A body of which every node is held, as rigid as a tool, on the finer mesh and on the coarser: it
/// squeezes the other evenly.
#[test]
fn a_body_that_is_held_as_a_whole_presses_evenly() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(stacks: Vec<Stack<H, D>>) -> Fallible {
        for stack in stacks {
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let mesh = driver.mesh();
            let mut upper: Vec<usize> = Vec::new();
            for &cell in mesh.cell_group("upper")? {
                upper.extend(mesh.cell_nodes(cell));
            }
            let down = 1.0 - NU * H::ACROSS.abs();
            let travel = down * PRESSURE / E * HEIGHT;
            let mut step = Step::new("press").fix("lower.bottom", &[Axis::Y]);
            for (low, _, axis) in sides::<D>() {
                step = step.fix(&format!("lower.{low}"), &[axis]);
            }
            let move_down = |_: &[f64; D]| from_fn(|i| if i == 1 { -travel } else { 0.0 });
            let end = prescribed(&driver, &step, &upper, move_down)?;
            driver.advance(&end)?;
            let what = stack.what();
            let stress = Sym2::from_column_slice(&squeezed::<H, D>());
            for point in driver.points() {
                let exact = if point.position[1] < 0.0 {
                    stress
                } else {
                    stress * 0.0
                };
                let off = (point.stress - exact).norm() / stress.norm();
                assert!(off <= 1e-9, "{what}: stress off by {off:.2e}");
            }
            uniform_pressure(&driver, PRESSURE, &what);
            action_is_reaction(&driver, stack.surfaces())?;
        }
        Ok(())
    }
    check(plane())?;
    check(space())
}

/// A finer body on a coarser one, held at two of its sides and pressed on the third, so that what nodes can do is
/// not what their neighbours can: turned as a whole, it moves as it would if it were not.
#[test]
fn what_is_held_along_the_interface_is_held_however_it_is_turned() -> Fallible {
    let odd = Unit::new_normalize(Vector3::new(1.0, 2.0, -0.5));
    for (kind, cells, swapped) in [
        (Hex8, [[2, 2, 3], [3, 1, 2]], false),
        (Hex8, [[2, 1, 2], [1, 1, 1]], false),
        (Hex20, [[2, 1, 2], [1, 1, 1]], false),
        (Hex8, [[2, 1, 2], [1, 1, 1]], true),
    ] {
        let moved =
            |rotation: SMatrix<f64, 3, 3>| -> Fallible<(Vec<SVector<f64, 3>>, Vec<Status>)> {
                let stack = Stack::<Solid, 3>::new([kind, kind], cells);
                let stack = Stack {
                    friction: 0.3,
                    swapped,
                    rotation,
                    ..stack
                };
                let along = |k: usize| stack.turn(from_fn(|i| if i == k { 1.0 } else { 0.0 }));
                let step = Step::new("press")
                    .fix_along("lower.bottom", along(0))
                    .fix_along("lower.bottom", along(1))
                    .fix_along("lower.back", along(2))
                    .fix_along("upper.left", along(0))
                    .fix_along("upper.back", along(2))
                    .pressure("upper.top", PRESSURE);
                let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
                driver.run(&step, 1, |_, _| {})?;
                let all = 0..driver.mesh().nodes().len();
                let back = |a| rotation.tr_mul(&driver.displacement(a));
                let statuses = driver.contacts().iter().map(|c| c.status);
                Ok((all.map(back).collect(), statuses.collect()))
            };
        let (straight, statuses) = moved(SMatrix::identity())?;
        let largest = straight.iter().map(|u| u.norm()).fold(0.0, f64::max);
        for (axis, angle) in [
            (Vector3::y_axis(), 30.0),
            (Vector3::z_axis(), 45.0),
            (odd, 77.0),
        ] {
            let angle: f64 = angle;
            let turn = Rotation3::from_axis_angle(&axis, angle.to_radians());
            let (turned, found) = moved(turn.into_inner())?;
            assert_eq!(found, statuses, "{kind:?} {swapped} {angle}");
            for (a, (u, v)) in straight.iter().zip(&turned).enumerate() {
                let off = (u - v).norm();
                assert!(
                    off <= 1e-8 * largest,
                    "{kind:?} {swapped} {angle}: node {a} {off:e} of {largest:e}"
                );
            }
        }
    }
    Ok(())
}

/// The nodes of a side are moved across the interface and free along it. How much of the force goes through them is the
/// same in one increment as in several, and under large strains: in those the interface has turned a little, and a
/// multiplier that a node gave way to by nothing would be one that it gives way to by hardly anything.
#[test]
fn what_is_held_across_the_interface_bears_however_little_it_turns() -> Fallible {
    for kind in [Quad4, Quad8, Tri6] {
        let pressed = |large: Option<f64>, increments: usize| -> Fallible<f64> {
            let stack = Stack::<PlaneStrain, 2>::new([kind, kind], [[6, 4], [4, 4]]);
            // A yield stress that nothing reaches.
            let stack = Stack {
                large,
                yield_stress: large.map(|_| E),
                ..stack
            };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let down = -PRESSURE / E * HEIGHT;
            let step = Step::new("press")
                .fix("lower.bottom", &[Axis::X, Axis::Y])
                .fix("upper.right", &[Axis::X])
                .displace("upper.top", Axis::Y, down)
                .displace("upper.left", Axis::Y, down);
            driver.run(&step, increments, |_, _| {})?;
            let [own, _] = stack.surfaces();
            Ok(driver.contact_force(own)?.norm())
        };
        let once = pressed(None, 1)?;
        close(&format!("{kind:?}"), pressed(None, 2)?, once, 0.01);
        close(&format!("{kind:?}"), pressed(Some(E), 2)?, once, 0.02);
    }
    Ok(())
}
