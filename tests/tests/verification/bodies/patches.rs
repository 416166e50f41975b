//! Uniform states that pass between meshes that do not match, in the plane and in space.

use super::*;
use moreau::laws::Status;
use moreau::mandel::from_matrix;

use moreau::mesh::{Axisymmetric, Solid};

use CellKind::{Hex8, Hex20, Hex27, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6};

/// Turned about the middle, the less the farther from it: no face is a parallelogram.
fn swirled<const D: usize>(at: [f64; D]) -> [f64; D] {
    let (x, z) = (at[0], at[D - 1]);
    let both = (PI * x / WIDTH).sin() * (PI * z / DEPTH).sin();
    let (s, c) = (0.5 * both).sin_cos();
    let (a, b) = (x - 0.5 * WIDTH, z - 0.5 * DEPTH);
    let mut moved = at;
    (moved[0], moved[D - 1]) = (0.5 * WIDTH + c * a - s * b, 0.5 * DEPTH + s * a + c * b);
    moved
}

/// Lines shifted by up to √2/5, more so in the middle; the sides stay what they are.
fn shifted(lines: Vec<f64>, sign: f64) -> Vec<f64> {
    let size = lines[lines.len() - 1];
    let shift = |x: f64| x + sign * 2f64.sqrt() / 5.0 * (PI * x / size).sin();
    lines.into_iter().map(shift).collect()
}

/// Pairs of cells with pairs of meshes, either body as the non-mortar side; of one footprint. Sides
/// of faces are straight: what bends lines is for linear cells in space.
fn stacks<H: Blocks<D>, const D: usize>(kinds: &[[CellKind; 2]]) -> Vec<Stack<H, D>> {
    let mut all = Vec::new();
    for &kinds in kinds {
        let new = |cells: [[usize; 3]; 2]| {
            Stack::<H, D>::new(kinds, cells.map(|c| from_fn(|axis| c[axis])))
        };
        let mut lines = new([[4, 1, 3], [5, 1, 4]]);
        let lower = &mut lines.lines[1];
        for (axis, sign) in [(0, 1.0), (2, -1.0)].into_iter().take(D - 1) {
            lower[axis] = shifted(std::mem::take(&mut lower[axis]), sign);
        }
        let mut stacks = vec![
            new([[3, 1, 2], [3, 1, 2]]),
            new([[3, 1, 3], [4, 1, 4]]),
            new([[5, 1, 2], [2, 1, 5]]),
            lines,
        ];
        let linear = |k: CellKind| k.nodes() == k.corner_count();
        if D == 3 && kinds.into_iter().all(linear) {
            let maps = [|x| x, swirled as Map<D>];
            let stack = new([[4, 1, 4], [4, 1, 3]]);
            stacks.push(Stack { maps, ..stack });
        }
        for stack in stacks {
            for swapped in [false, true] {
                let stack = stack.clone();
                all.push(Stack { swapped, ..stack });
            }
        }
    }
    all
}

fn plane() -> Vec<Stack<PlaneStrain, 2>> {
    stacks(&[[Quad4, Quad4], [Quad8, Quad8], [Tri6, Quad4], [Tri3, Quad9]])
}

fn space() -> Vec<Stack<Solid, 3>> {
    stacks(&[
        [Hex8, Hex8],
        [Tet4, Hex8],
        [Tet4, Tet4],
        [Hex20, Hex20],
        [Hex27, Hex27],
        [Tet10, Tet10],
        [Hex8, Tet10],
        [Hex20, Hex8],
        [Tet10, Hex20],
        [Hex27, Tet4],
    ])
}

/// 4.7 and 4.8: the upper body is held by its contact and planes of symmetry alone.
#[test]
fn a_uniform_pressure_passes_between_meshes_that_do_not_match() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(stacks: Vec<Stack<H, D>>) -> Fallible {
        for (stack, ratio) in stacks.into_iter().zip([1.0, 10.0, 1000.0].iter().cycle()) {
            let young = [E, E / ratio];
            let stack = Stack { young, ..stack };
            let what = format!("{}, 1:{ratio}", stack.what());
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let step = stack.held("press").pressure("upper.top", PRESSURE);
            let reports = driver.run(&step, 1, |_, _| {})?;
            uniform_stress(&driver, squeezed::<H, D>(), &what);
            let force = action_is_reaction(&driver, stack.surfaces())?;
            close("resultant", force[1], PRESSURE * H::FOOTPRINT, 1e-10);
            uniform_pressure(&driver, PRESSURE, &what);
            // None goes without a share, not even on an axis.
            assert!(driver.contacts().iter().all(|c| c.area > 0.0), "{what}");
            let report = &reports[0];
            assert!(report.relative_gap().abs() < 1e-12);
            assert!(report.certificate.penetration < 1e-12);
            let work = report.energies.external_work;
            close("energy", report.energies.stored, work, 1e-9);
        }
        Ok(())
    }
    check(plane())?;
    check::<Axisymmetric, 2>(stacks(&[
        [Quad4, Quad8],
        [Quad8, Quad8],
        [Quad8, Tri3],
        [Tri6, Quad9],
    ]))?;
    check(space())
}

/// 4.2 and 4.8: pressed far beyond yield without any room to the sides, σ₂ = σ₃ = σ₁ + σ_y and
/// p = ⅔ ε − σ_y / 3G with ε = (P − ⅔ σ_y) / K, in bodies of unlike stiffness.
#[test]
fn a_plastic_state_passes_between_meshes_that_do_not_match() -> Fallible {
    const YIELD: f64 = 300.0;
    const LOAD: f64 = 1075.0;
    fn check<H: Blocks<D>, const D: usize>(stacks: Vec<Stack<H, D>>) -> Fallible {
        for stack in stacks {
            let stack = Stack {
                young: [E, E / 3.0],
                yield_stress: Some(YIELD),
                ..stack
            };
            let what = stack.what();
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let mut step = stack.held("press").pressure("upper.top", LOAD);
            for body in ["upper", "lower"] {
                for (_, high, axis) in sides::<D>() {
                    step = step.fix(&format!("{body}.{high}"), &[axis]);
                }
            }
            driver.run(&step, 2, |_, _| {})?;
            let side = YIELD - LOAD;
            uniform_stress(&driver, [side, -LOAD, side, 0.0, 0.0, 0.0], &what);
            uniform_pressure(&driver, LOAD, &what);
            for point in driver.points() {
                let young = stack.young[usize::from(point.position[1] < 0.0)];
                let bulk = young / (3.0 * (1.0 - 2.0 * NU));
                let shear = young / (2.0 * (1.0 + NU));
                let strain = (LOAD - 2.0 / 3.0 * YIELD) / bulk;
                let p = 2.0 / 3.0 * strain - YIELD / (3.0 * shear);
                close(&what, point.plastic_strain, p, 1e-9);
            }
            action_is_reaction(&driver, stack.surfaces())?;
        }
        Ok(())
    }
    check(plane())?;
    check(space().into_iter().step_by(3).collect())
}

/// 4.8: pressure also on the part of the lower block that the upper does not cover.
#[test]
fn a_uniform_pressure_passes_beside_an_overhang() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(kinds: &[[CellKind; 2]]) -> Fallible {
        for &kinds in kinds {
            for swapped in [false, true] {
                let mut stack = Stack::<H, D>::new(
                    kinds,
                    [[4, 1, 3], [6, 1, 5]].map(|c: [usize; 3]| from_fn(|axis| c[axis])),
                );
                stack.swapped = swapped;
                stack.lines[1][0] = uniform(-1.5, 7.5, 6);
                if D == 3 {
                    stack.lines[1][2] = uniform(0.0, 1.25 * DEPTH, 5);
                }
                let mut mesh = stack.mesh()?;
                // Facets across the edges of the upper block take the pressure on all of them.
                let outside =
                    |x: &[f64; D]| x[0] <= 0.0 || x[0] >= WIDTH || D == 3 && x[2] >= DEPTH;
                let facets = mesh.facet_group("lower.top")?.to_vec();
                let facets = facets.into_iter().filter(|&f| {
                    let nodes: Vec<usize> = mesh.facet_nodes(f).collect();
                    let count = nodes.len() as f64;
                    let middle =
                        from_fn(|i| nodes.iter().map(|&a| mesh.nodes()[a][i]).sum::<f64>() / count);
                    outside(&middle)
                });
                let facets = facets.collect();
                mesh.add_facet_group("beside", facets)?;
                mesh.node_group_where("line", "lower.bottom", |x| x[0] < -1.0)?;
                let mut driver = stack.driver(mesh, Settings::default())?;
                let mut step = Step::new("press")
                    .fix("line", &[Axis::X])
                    .fix("lower.bottom", &[Axis::Y])
                    .fix("upper.left", &[Axis::X])
                    .pressure("beside", PRESSURE)
                    .pressure("upper.top", PRESSURE);
                if D == 3 {
                    step = step
                        .fix("upper.back", &[Axis::Z])
                        .fix("lower.back", &[Axis::Z]);
                }
                driver.run(&step, 1, |_, _| {})?;
                uniform_stress(&driver, squeezed::<H, D>(), &stack.what());
                action_is_reaction(&driver, stack.surfaces())?;
            }
        }
        Ok(())
    }
    check::<PlaneStrain, 2>(&[[Quad4, Quad4], [Quad8, Quad8]])?;
    check::<Solid, 3>(&[[Hex8, Tet4], [Tet4, Hex8], [Hex20, Tet10], [Hex27, Hex8]])
}

/// 4.8: faces turned against each other. Around the upper block the exact displacements hold what
/// it covers in part; what lies wholly beneath it is free.
#[test]
fn a_uniform_pressure_passes_between_faces_that_are_turned() -> Fallible {
    /// Twice as wide, and turned about the middle as a whole.
    fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
        let (s, c) = 0.6f64.sin_cos();
        let (a, b) = (2.2 * (x - 0.5 * WIDTH), 2.2 * (z - 0.5 * DEPTH));
        [0.5 * WIDTH + c * a - s * b, y, 0.5 * DEPTH + s * a + c * b]
    }
    for (kind, cells) in [
        (Hex8, [[11, 1, 9], [13, 1, 12]]),
        (Tet4, [[11, 1, 9], [13, 1, 12]]),
        (Hex20, [[5, 1, 4], [9, 1, 8]]),
    ] {
        for swapped in [false, true] {
            let stack = Stack {
                maps: [|x| x, turned],
                young: [E, E / 3.0],
                swapped,
                ..Stack::<Solid, 3>::new([Hex8, kind], cells)
            };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let mesh = driver.mesh();
            let mut held: Vec<usize> = Vec::new();
            let uncovered = mesh.node_group("uncovered")?;
            for &facet in mesh.facet_group("lower.top")? {
                if mesh.facet_nodes(facet).any(|a| uncovered.contains(&a)) {
                    held.extend(mesh.facet_nodes(facet));
                }
            }
            for side in ["left", "right", "back", "front", "bottom"] {
                held.extend(mesh.node_group(&format!("lower.{side}"))?);
            }
            held.sort_unstable();
            held.dedup();
            let covered = mesh.node_group("lower.top")?;
            let is_free = |a: &&usize| held.binary_search(a).is_err();
            assert!(covered.iter().filter(is_free).count() > 5);
            let e = PRESSURE / stack.young[1];
            let middle = [0.5 * WIDTH, -HEIGHT, 0.5 * DEPTH];
            let field = |x: &[f64; 3]| {
                let x: [f64; 3] = from_fn(|i| x[i] - middle[i]);
                [NU * e * x[0], -e * x[1], NU * e * x[2]]
            };
            let step = Step::new("press")
                .fix("upper.left", &[Axis::X])
                .fix("upper.back", &[Axis::Z])
                .pressure("upper.top", PRESSURE);
            let end = prescribed(&driver, &step, &held, field)?;
            driver.advance(&end)?;
            uniform_stress(&driver, squeezed::<Solid, 3>(), &stack.what());
            action_is_reaction(&driver, stack.surfaces())?;
        }
    }
    Ok(())
}

/// The stress of a pressure with a shear along a direction of the interface, as a matrix in space.
fn sheared<H: Blocks<D>, const D: usize>(along: [f64; D], shear: f64) -> Matrix3<f64> {
    let mut stress = Matrix3::zeros();
    for (i, d) in along.into_iter().enumerate() {
        stress[(i, 1)] += shear * d;
        stress[(1, i)] += shear * d;
    }
    stress[(1, 1)] -= PRESSURE;
    stress[(2, 2)] += H::ACROSS * PRESSURE;
    stress
}

/// 4.9 and 4.10: a uniform shear in any direction of an interface that is turned, first below the
/// limit, the upper body held by friction alone, then beyond, when it slips by what is left over.
#[test]
fn a_uniform_shear_sticks_then_slips_on_a_turned_interface() -> Fallible {
    const FRICTION: f64 = 0.25;
    const SLIP: f64 = 1e-4;
    fn check<H: Blocks<D>, const D: usize>(
        stacks: Vec<Stack<H, D>>,
        turns: [SMatrix<f64, D, D>; 3],
    ) -> Fallible {
        for (k, stack) in stacks.into_iter().enumerate() {
            let rotation = turns[k % 3];
            let friction = FRICTION;
            let stack = Stack {
                friction,
                rotation,
                ..stack
            };
            let what = stack.what();
            let (s, c) = (0.4 + k as f64).sin_cos();
            let along = from_fn(|i| match (D, i) {
                (2, 0) => 1.0,
                (3, 0) => c,
                (3, 2) => s,
                _ => 0.0,
            });
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            // The law of the bulk: from the stress to the strain.
            let strain = |stress: Matrix3<f64>| {
                (stress * (1.0 + NU) - Matrix3::identity() * (NU * stress.trace())) / E
            };
            let field = |at: &[f64; D], shear: f64, slip: f64| {
                let x = stack.back(*at);
                let e = strain(sheared::<H, D>([0.0; D], 0.0));
                let slope = 2.0 * shear * (1.0 + NU) / E;
                let tangential = slope * x[1] + if x[1] > 0.0 { slip } else { 0.0 };
                stack.turn(from_fn(|i| e[(i, i)] * x[i] + along[i] * tangential))
            };
            let loads = |shear: f64, top: bool| {
                let stress = sheared::<H, D>(along, shear);
                let traction =
                    |axis: usize, sign: f64| stack.turn(from_fn(|i| sign * stress[(i, axis)]));
                let mut step = Step::new("shear");
                for body in ["upper", "lower"] {
                    for (low, high, axis) in sides::<D>() {
                        let axis = axis.index();
                        step = step
                            .traction(&format!("{body}.{high}"), traction(axis, 1.0))
                            .traction(&format!("{body}.{low}"), traction(axis, -1.0));
                    }
                }
                match top {
                    true => step.traction("upper.top", traction(1, 1.0)),
                    false => step,
                }
            };
            let stress = |shear: f64| -> [f64; 6] {
                let mut q = Matrix3::identity();
                q.view_mut((0, 0), (D, D)).copy_from(&rotation);
                from_matrix(&(q * sheared::<H, D>(along, shear) * q.transpose())).into()
            };
            let bottom = driver.mesh().node_group("lower.bottom")?;
            let both = [bottom.clone(), driver.mesh().node_group("upper.top")?].concat();

            let limit = FRICTION * PRESSURE;
            let shear = 0.99 * limit;
            let end = prescribed(&driver, &loads(shear, true), &bottom, |x| {
                field(x, shear, 0.0)
            })?;
            driver.advance(&end)?;
            uniform_stress(&driver, stress(shear), &format!("stick, {what}"));
            let force = action_is_reaction(&driver, stack.surfaces())?;
            let exact = sheared::<H, D>(along, shear);
            let exact = stack.turn(from_fn(|i| -exact[(i, 1)] * H::FOOTPRINT));
            let exact = SVector::from(exact);
            assert!((force - exact).norm() <= 1e-9 * exact.norm());
            assert!(driver.contacts().iter().all(|c| c.status == Status::Stick));

            let end = prescribed(&driver, &loads(limit, false), &both, |x| {
                field(x, limit, SLIP)
            })?;
            driver.advance(&end)?;
            uniform_stress(&driver, stress(limit), &format!("slip, {what}"));
            for c in driver.contacts() {
                assert_eq!(c.status, Status::Slip, "{what}");
                let slip = c.u.iter().skip(1).map(|u| u * u).sum::<f64>().sqrt();
                close("slip", slip, SLIP, 1e-6);
            }
            action_is_reaction(&driver, stack.surfaces())?;
        }
        Ok(())
    }
    let by = |angle: f64| *Rotation2::new(angle).matrix();
    check(plane(), [by(0.0), by(PI / 6.0), by(-2.5)])?;
    let about = |axis: [f64; 3]| {
        let axis = Unit::new_normalize(axis.into());
        *Rotation3::from_axis_angle(&axis, PI / 6.0).matrix()
    };
    let oblique = about([1.0, -2.0, 0.5]);
    let turns = [SMatrix::identity(), about([0.0, 0.0, 1.0]), oblique];
    check(space().into_iter().step_by(3).collect(), turns)
}

#[test]
fn node_to_surface_fails_the_patch_test_and_keeps_the_balance() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(kind: CellKind, cells: [[usize; D]; 2]) -> Fallible {
        let stack = Stack {
            pairing: Pairing::NodeToSurface,
            ..Stack::<H, D>::new([kind; 2], cells)
        };
        let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
        let step = stack.held("press").pressure("upper.top", PRESSURE);
        driver.run(&step, 1, |_, _| {})?;
        let error = stress_error(&driver, squeezed::<H, D>());
        assert!(error > 1e-3, "{error:.2e}");
        let force = action_is_reaction(&driver, stack.surfaces())?;
        close("resultant", force[1], PRESSURE * H::FOOTPRINT, 1e-10);
        Ok(())
    }
    check::<PlaneStrain, 2>(Quad4, [[3, 2], [4, 2]])?;
    check::<Solid, 3>(Hex8, [[3, 1, 3], [4, 1, 4]])
}
