//! Two bodies pressed and dragged, in the plane and in space: what methods, axes, sides and
//! increments may change; an incline.

use super::*;
use moreau::contact::{ContactSolver, GaussSeidel, SemismoothNewton, Uzawa};
use moreau::driver::{Loading, Nesting};
use moreau::laws::{Status, Tresca};
use moreau::mesh::Solid;

/// A stack and the motions of its upper side, in its own frame: pressed, then dragged, along changing
/// directions.
#[derive(Clone)]
struct Grip<H, const D: usize> {
    stack: Stack<H, D>,
    path: Vec<[f64; D]>,
}

/// The lower block stands out on all sides, and its lines meet those of the upper nowhere.
fn plane(cells: [[usize; 2]; 2]) -> Grip<PlaneStrain, 2> {
    let mut stack = Stack::new([CellKind::Quad8; 2], cells);
    stack.lines[0][0] = uniform(0.0, 4.0, cells[0][0]);
    stack.lines[1][0] = uniform(-1.1, 5.3, cells[1][0]);
    stack.young = [E, E / 4.0];
    stack.friction = 0.2;
    let path = vec![[0.0, -2e-3], [4e-4, -2.5e-3], [-2e-4, -2e-3]];
    Grip { stack, path }
}

/// The same in space.
fn space(cells: [[usize; 3]; 2]) -> Grip<Solid, 3> {
    let mut stack = Stack::new([CellKind::Hex8; 2], cells);
    stack.maps[1] = |[x, y, z]| [1.3 * x - 1.1, y, 1.25 * z - 0.8 + 0.1 * x];
    stack.young = [E, E / 4.0];
    stack.friction = 0.15;
    let path = vec![
        [0.0, -2e-3, 0.0],
        [1.5e-3, -2.5e-3, 7e-4],
        [1.2e-3, -2.2e-3, -5e-4],
    ];
    Grip { stack, path }
}

const PLANE: [[usize; 2]; 2] = [[6, 2], [7, 2]];
const SPACE: [[usize; 3]; 2] = [[4, 2, 3], [5, 2, 4]];

impl<H: Blocks<D>, const D: usize> Grip<H, D> {
    /// Pressed and dragged by displacements of the upper side.
    fn end(&self, driver: &Driver<D>, motion: [f64; D]) -> Fallible<Loading<D>> {
        let mesh = driver.mesh();
        let held = [
            mesh.node_group("upper.top")?,
            mesh.node_group("lower.bottom")?,
        ]
        .concat();
        let motion = self.stack.turn(motion);
        let field = |x: &[f64; D]| match self.stack.back(*x)[1] > 0.0 {
            true => motion,
            false => [0.0; D],
        };
        Ok(prescribed(driver, &Step::new("grip"), &held, field)?)
    }

    fn run(&self, settings: Settings<D>) -> Fallible<Driver<D>> {
        let mut driver = self.stack.driver(self.stack.mesh()?, settings)?;
        for &motion in &self.path {
            let end = self.end(&driver, motion)?;
            driver.advance(&end)?;
            action_is_reaction(&driver, self.stack.surfaces())?;
        }
        Ok(driver)
    }
}

/// The largest distance of contact forces after a turn, over the largest force.
fn farthest<const D: usize>(a: &Driver<D>, b: &Driver<D>, turn: SMatrix<f64, D, D>) -> f64 {
    let pairs = || a.contacts().iter().zip(b.contacts());
    assert_eq!(a.contacts().len(), b.contacts().len());
    let most = pairs().map(|(a, _)| a.force.norm()).fold(0.0, f64::max);
    let apart = pairs().map(|(a, b)| (turn * a.force - b.force).norm());
    apart.fold(0.0, f64::max) / most
}

#[test]
fn all_methods_find_the_same_forces_between_two_bodies() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(grip: &Grip<H, D>) -> Fallible {
        let first = grip.run(Settings::default())?;
        let slips = |s: Status| first.contacts().iter().any(|c| c.status == s);
        assert!(slips(Status::Slip) && slips(Status::Stick));
        // Friction is a cone, not a pyramid: slip goes in many directions.
        for c in first.contacts().iter().filter(|c| c.status == Status::Slip) {
            let (u, t) = (c.u.rows(1, D - 1), c.t.rows(1, D - 1));
            close("bound", t.norm(), grip.stack.friction * c.t[0], 1e-9);
            assert!(u.dot(&t) <= -(1.0 - 1e-9) * u.norm() * t.norm());
        }
        let others: [Box<dyn ContactSolver<D>>; 3] = [
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
            let apart = farthest(&first, &grip.run(settings)?, SMatrix::identity());
            assert!(apart <= 1e-8, "{name}: {apart:.2e}");
        }
        Ok(())
    }
    check(&plane(PLANE))?;
    check(&space(SPACE))?;
    let mut pressed = plane(PLANE);
    pressed.path.truncate(1);
    let nesting = Nesting::Outside {
        tolerance: 1e-6,
        iterations: 20_000,
        extrapolated: true,
    };
    let settings = Settings {
        nesting,
        ..Settings::default()
    };
    let first = pressed.run(Settings::default())?;
    let apart = farthest(&first, &pressed.run(settings)?, SMatrix::identity());
    assert!(apart <= 1e-4, "the paper's nesting: {apart:.2e}");
    Ok(())
}

#[test]
fn two_bodies_turned_feel_turned_forces() -> Fallible {
    fn check<H: Blocks<D>, const D: usize>(
        grip: Grip<H, D>,
        turns: &[SMatrix<f64, D, D>],
    ) -> Fallible {
        let first = grip.run(Settings::default())?;
        for &rotation in turns {
            let mut grip = grip.clone();
            grip.stack.rotation = rotation;
            let apart = farthest(&first, &grip.run(Settings::default())?, rotation);
            assert!(apart <= 1e-9, "{}: {apart:.2e}", grip.stack.what());
        }
        Ok(())
    }
    check(
        plane(PLANE),
        &[0.7, PI / 2.0, -2.5].map(|angle| *Rotation2::new(angle).matrix()),
    )?;
    let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, -0.7));
    let turn = [*Rotation3::from_axis_angle(&axis, f64::to_radians(37.0)).matrix()];
    for kinds in [[CellKind::Hex8; 2], [CellKind::Tet4, CellKind::Hex8]] {
        let mut grip = space(SPACE);
        grip.stack.kinds = kinds;
        check(grip, &turn)?;
    }
    Ok(())
}

/// 4.11: which side carries the multipliers matters to the order of the mesh size. The edges of the
/// upper body are singular, and lie anywhere in the facets of the lower.
#[test]
fn the_choice_of_the_non_mortar_side_fades_with_refinement() -> Fallible {
    fn apart<H: Blocks<D>, const D: usize>(
        make: impl Fn(usize) -> Grip<H, D>,
    ) -> Fallible<[f64; 3]> {
        let mut apart = [0.0; 3];
        for (apart, n) in apart.iter_mut().zip([1, 2, 4]) {
            let mut stored = [0.0; 2];
            for (stored, swapped) in stored.iter_mut().zip([false, true]) {
                let mut grip = make(n);
                grip.stack.swapped = swapped;
                grip.path.truncate(1);
                *stored = grip.run(Settings::default())?.energies().stored;
            }
            *apart = (stored[0] / stored[1] - 1.0).abs();
        }
        Ok(apart)
    }
    let flat = apart(|n| plane([[3 * n, 2], [4 * n, 2]]))?;
    assert!(flat[0] < 3e-2 && flat[2] < 0.5 * flat[0], "{flat:?}");
    let solid = apart(|n| space([[2 * n, n, 2 * n], [3 * n, n, 3 * n]]))?;
    assert!(solid[0] < 5e-2 && solid[2] < 0.25 * solid[0], "{solid:?}");
    Ok(())
}

/// Work is stored or dissipated, to the order of the increment.
#[test]
fn the_energy_of_two_bodies_is_balanced() -> Fallible {
    let grip = plane(PLANE);
    let mut left = Vec::new();
    for steps in [8, 16, 32] {
        let mut driver = grip.stack.driver(grip.stack.mesh()?, Settings::default())?;
        let mut from = [0.0; 2];
        for &to in &grip.path {
            for k in 1..=steps {
                let s = k as f64 / steps as f64;
                let motion = [0, 1].map(|i| from[i] + s * (to[i] - from[i]));
                let end = grip.end(&driver, motion)?;
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

/// A bound of the shear that does not hang on the pressure is that of what is covered, also where
/// facets of the non-mortar side are covered in part.
#[test]
fn a_constant_bound_of_the_shear_counts_where_bodies_meet() -> Fallible {
    const BOUND: f64 = 5.0;
    fn check<H: Blocks<D>, const D: usize>(mut stack: Stack<H, D>) -> Fallible {
        stack.lines[1][0] = uniform(-1.1, 7.2, 6);
        for swapped in [false, true] {
            stack.swapped = swapped;
            let [own, other] = stack.surfaces();
            let mut model = Model::new(stack.mesh()?, stack.hypothesis);
            for (name, kind) in ["upper", "lower"].into_iter().zip(stack.kinds) {
                model = model.material(name, Elastic::new(E, NU)?, kind.integration())?;
            }
            let model = model.contact(own, other, Tresca::new(BOUND)?)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let mut step = Step::new("drag")
                .fix("lower.bottom", &[Axis::X, Axis::Y])
                .displace("upper.top", Axis::X, 0.02)
                .pressure("upper.top", PRESSURE);
            if D == 3 {
                step = step
                    .fix("lower.bottom", &[Axis::Z])
                    .fix("upper.top", &[Axis::Z]);
            }
            driver.run(&step, 1, |_, _| {})?;
            let what = stack.what();
            let open = driver
                .contacts()
                .iter()
                .filter(|c| c.status == Status::Open);
            assert!(open.clone().all(|c| c.area == 0.0), "{what}");
            action_is_reaction(&driver, stack.surfaces())?;
            let shear = driver.contacts().iter().map(|c| c.t.rows(1, D - 1).norm());
            close(&what, shear.sum(), BOUND * H::FOOTPRINT, 1e-9);
        }
        Ok(())
    }
    check(Stack::<PlaneStrain, 2>::new([CellKind::Quad8; 2], PLANE))?;
    check(Stack::<Solid, 3>::new(
        [CellKind::Hex20, CellKind::Hex8],
        SPACE,
    ))
}

/// 3.6, NAFEMS CGS-4: F/G = (tan α + μ)/(1 − μ tan α), for any meshes.
#[test]
fn a_block_is_pushed_up_an_incline() -> Fallible {
    const TAN: f64 = 0.1;
    /// So light that the deformed surface is as steep as the undeformed one.
    const DENSITY: f64 = 1e-2;
    fn check<H: Blocks<D>, const D: usize>(
        stack: Stack<H, D>,
        supports: &[(&str, Axis)],
    ) -> Fallible {
        for (friction, expected) in [
            (0.0, 0.1),
            (0.1, 0.202_020_2),
            (0.2, 0.306_122_4),
            (0.3, 0.412_371_1),
        ] {
            for swapped in [false, true] {
                let stack = Stack {
                    friction,
                    swapped,
                    ..stack.clone()
                };
                let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
                let weight = from_fn(|i| if i == 1 { -DENSITY } else { 0.0 });
                let mut push = Step::new("push")
                    .displace("upper.left", Axis::X, 1e-3)
                    .body_force("upper", weight);
                for &(on, axis) in supports {
                    push = push.fix(on, &[axis]);
                }
                let reports = driver.run(&push, 2, |_, _| {})?;
                assert!(reports.iter().all(|r| r.cuts == 0), "no increment was cut");
                let mesh = driver.mesh();
                let volume = mesh.measure(mesh.cell_group("upper")?, &stack.hypothesis);
                let force = driver.reaction("upper.left")?[0];
                let what = format!("F/G at μ = {friction}, swapped {swapped}");
                close(&what, force / (DENSITY * volume), expected, 1e-6);
                action_is_reaction(&driver, stack.surfaces())?;
                let closed = || {
                    driver
                        .contacts()
                        .iter()
                        .filter(|c| c.status != Status::Open)
                };
                assert!(friction == 0.0 || closed().all(|c| c.status == Status::Slip));
                assert!(closed().count() >= 3);
            }
        }
        Ok(())
    }
    let angle = f64::atan(TAN);
    let base = [("lower.bottom", Axis::X), ("lower.bottom", Axis::Y)];
    let mut flat = Stack::<PlaneStrain, 2>::new([CellKind::Quad8; 2], [[5, 2], [6, 2]]);
    flat.lines[1][0] = uniform(-1.0, 8.0, 6);
    flat.rotation = *Rotation2::new(angle).matrix();
    check(flat, &base)?;
    let mut solid = space(SPACE).stack;
    solid.young = [E; 2];
    solid.rotation = *Rotation3::from_axis_angle(&Vector3::z_axis(), angle).matrix();
    let across = [("lower.bottom", Axis::Z), ("upper.back", Axis::Z)];
    check(solid, &[base, across].concat())
}
