//! Models and steps that make no sense, and loads that cannot be carried: each ends in an error
//! that names the culprit, with the state untouched; no panics, no answers.

use crate::close;
use moreau::contact::{ContactError, GaussSeidel, Plane};
use moreau::driver::{Axis, Driver, IncrementError, Model, ModelError, Settings, Step};
use moreau::laws::{Coulomb, Elastic, VonMises};
use moreau::mesh::{CellKind, Integration, Mesh, MeshError, PlaneStrain, block2, uniform};
use verification::problems::Fallible;
use verification::problems::limit::collapse_of;
use verification::problems::punched::Punched;

const RULE: Integration = Integration::Reduced;

fn mesh() -> Fallible<Mesh<2>> {
    Ok(block2(
        "block",
        CellKind::Quad8,
        &uniform(0.0, 4.0, 4),
        &uniform(0.0, 2.0, 2),
    )?)
}

fn steel() -> Fallible<VonMises> {
    Ok(VonMises::new(210e3, 0.3, 300.0)?)
}

fn floor() -> Fallible<Plane<2>> {
    Ok(Plane::new([0.0, 0.0], [0.0, 1.0])?)
}

/// A block on a floor with the given friction.
fn on_floor(friction: f64, settings: Settings<2>) -> Fallible<Driver<2>> {
    let model = Model::new(mesh()?, PlaneStrain::default())
        .material("block", steel()?, RULE)?
        .tool("floor", floor()?)?
        .contact("block.bottom", "floor", Coulomb::new(friction)?)?;
    Ok(Driver::new(model, settings)?)
}

/// The error of a step, with the assertion that it has changed nothing.
#[track_caller]
fn refused(driver: &mut Driver<2>, step: &Step<2>) -> IncrementError {
    let bits = |driver: &Driver<2>| -> Vec<u64> {
        let nodes = 0..driver.mesh().nodes().len();
        let u = nodes.flat_map(|n| driver.displacement(n).iter().copied().collect::<Vec<_>>());
        let t = driver
            .contacts()
            .iter()
            .flat_map(|c| c.t.iter().copied().collect::<Vec<_>>());
        let s = driver
            .points()
            .into_iter()
            .flat_map(|p| p.stress.iter().copied().collect::<Vec<_>>());
        u.chain(t).chain(s).map(f64::to_bits).collect()
    };
    let before = (bits(driver), driver.increments(), driver.energies());
    let error = driver
        .run(step, 1, |_, _| {})
        .expect_err("the step makes no sense");
    let after = (bits(driver), driver.increments(), driver.energies());
    assert!(before == after, "the state has changed: {error}");
    assert!(!error.to_string().is_empty());
    error
}

#[test]
fn free_rigid_motions_are_refused() -> Fallible {
    let press = |name: &str| Step::new(name).pressure("block.top", 10.0);
    // Frictionless on a floor, without a support at the side.
    let mut driver = on_floor(0.0, Settings::default())?;
    match refused(&mut driver, &press("slide")) {
        IncrementError::Model(ModelError::FreeRigidMotion { body, motion }) => {
            assert_eq!(body, "the body \"block\"");
            assert_eq!(motion, "translation along x");
        }
        other => panic!("{other:?}"),
    }
    // With a support it stands.
    driver.run(&press("stand").fix("block.left", &[Axis::X]), 1, |_, _| {})?;
    // With friction, too.
    on_floor(0.3, Settings::default())?.run(&press("stick"), 1, |_, _| {})?;

    // No support at all: three motions, any of them.
    let model = Model::new(mesh()?, PlaneStrain::default()).material("block", steel()?, RULE)?;
    let mut floating = Driver::new(model, Settings::default())?;
    let error = refused(&mut floating, &press("fly"));
    assert!(
        matches!(
            &error,
            IncrementError::Model(ModelError::FreeRigidMotion { .. })
        ),
        "{error:?}"
    );
    // Held at one node: it turns about it.
    let mut pinned = mesh()?;
    pinned.node_group_where("pin", "block", |x| x[0] == 0.0 && x[1] == 0.0)?;
    let model = Model::new(pinned, PlaneStrain::default()).material("block", steel()?, RULE)?;
    let mut turning = Driver::new(model, Settings::default())?;
    match refused(&mut turning, &press("turn").fix("pin", &[Axis::X, Axis::Y])) {
        IncrementError::Model(ModelError::FreeRigidMotion { motion, .. }) => {
            assert!(motion.contains("rotation"), "{motion}");
        }
        other => panic!("{other:?}"),
    }
    // A second body that nobody holds.
    let second = block2(
        "loose",
        CellKind::Quad8,
        &uniform(10.0, 11.0, 1),
        &uniform(0.0, 1.0, 1),
    )?;
    let both = mesh()?.joined(second)?;
    let model = Model::new(both, PlaneStrain::default())
        .material("block", steel()?, RULE)?
        .material("loose", steel()?, RULE)?;
    let mut driver = Driver::new(model, Settings::default())?;
    match refused(
        &mut driver,
        &Step::new("hold").fix("block.left", &[Axis::X, Axis::Y]),
    ) {
        IncrementError::Model(ModelError::FreeRigidMotion { body, .. }) => {
            assert_eq!(body, "the body \"loose\"");
        }
        other => panic!("{other:?}"),
    }
    Ok(())
}

/// A body that only contact holds, pulled off it.
#[test]
fn a_body_pulled_off_its_foundation_is_an_error() -> Fallible {
    let mut driver = on_floor(
        0.3,
        Settings {
            cuts: 2,
            ..Settings::default()
        },
    )?;
    match refused(&mut driver, &Step::new("lift").pressure("block.top", -10.0)) {
        IncrementError::Stopped {
            step,
            reached,
            cause,
            ..
        } => {
            assert_eq!((step.as_str(), reached), ("lift", 0.0));
            assert!(
                matches!(*cause, IncrementError::Contact { .. }),
                "{cause:?}"
            );
        }
        other => panic!("{other:?}"),
    }
    // The driver works on after it.
    driver.run(
        &Step::new("press").pressure("block.top", 10.0),
        1,
        |_, _| {},
    )?;
    assert!((driver.tool_force("floor")?[1] - 40.0).abs() < 1e-9);
    Ok(())
}

/// A method that needs the bodies held says so.
#[test]
fn gauss_seidel_refuses_a_floating_body() -> Fallible {
    let contact = Box::new(GaussSeidel::default());
    let mut driver = on_floor(
        0.3,
        Settings {
            contact,
            cuts: 0,
            ..Settings::default()
        },
    )?;
    match refused(&mut driver, &Step::new("press").pressure("block.top", 10.0)) {
        IncrementError::Stopped { cause, .. } => match *cause {
            IncrementError::Contact {
                iteration: 1,
                source: ContactError::Floating { .. },
            } => {}
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
    Ok(())
}

/// Too few iterations and no cuts: the numbers of the failure are in the error.
#[test]
fn an_increment_that_cannot_converge_says_by_how_much() -> Fallible {
    let settings = Settings {
        iterations: 2,
        cuts: 0,
        ..Settings::default()
    };
    let punched = Punched::default();
    let mut driver = punched.driver(punched.half_mesh()?, settings)?;
    match refused(&mut driver, &punched.press(0.2)) {
        IncrementError::Stopped {
            step,
            reached,
            smallest,
            plastic_fraction,
            cause,
            ..
        } => {
            assert_eq!((step.as_str(), reached, smallest), ("press", 0.0, 1.0));
            match *cause {
                IncrementError::NotConverged {
                    iterations,
                    out_of_balance,
                    tolerance,
                    worst,
                    plastic_fraction: p,
                } => {
                    assert_eq!((iterations, worst.len()), (2, 5));
                    assert!(out_of_balance > tolerance && out_of_balance.is_finite());
                    assert!(tolerance > 0.0);
                    let forces: Vec<f64> = worst.iter().map(|w| w.force).collect();
                    assert!(
                        forces.is_sorted_by(|a, b| a >= b),
                        "worst first: {forces:?}"
                    );
                    assert!(forces[0] >= out_of_balance * (1.0 - 1e-12));
                    for w in &worst {
                        assert_eq!(w.position, driver.mesh().nodes()[w.node].to_vec());
                    }
                    assert_eq!(p, plastic_fraction);
                    assert!(p > 0.0 && p <= 1.0);
                }
                other => panic!("{other:?}"),
            }
        }
        other => panic!("{other:?}"),
    }
    Ok(())
}

/// Increments that converged before the stop are kept, and their part of the step is told.
#[test]
fn a_stopped_step_keeps_what_converged() -> Fallible {
    let settings = Settings {
        iterations: 3,
        cuts: 2,
        ..Settings::default()
    };
    let punched = Punched::default();
    let mut driver = punched.driver(punched.half_mesh()?, settings)?;
    let mut seen = 0;
    match driver.run(&punched.press(0.2), 20, |_, _| seen += 1) {
        Err(IncrementError::Stopped {
            reached, smallest, ..
        }) => {
            assert!(seen > 0);
            assert_eq!(driver.increments(), seen);
            close("smallest", smallest, 0.05 * 0.25, 1e-12);
            let nodes = driver.mesh().node_group("punch")?;
            let depth = driver.displacement(nodes[0])[1];
            close("depth", depth, -0.2 * reached, 1e-12);
        }
        other => panic!("expected a stop, found {other:?}"),
    }
    Ok(())
}

/// Uniform tension in plane strain collapses at 2/√3 σ_y, though no mechanism of it is the one.
#[test]
fn uniform_tension_collapses_at_its_yield_stress() -> Fallible {
    let model = Model::new(mesh()?, PlaneStrain::default()).material("block", steel()?, RULE)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let limit = 2.0 / 3f64.sqrt() * 300.0;
    let step = Step::new("pull")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::Y])
        .pressure("block.right", -2.0 * limit);
    let found = collapse_of(&mut driver, &step, 10)?;
    close("load factor", found.load_factor, 0.5, 1e-6);
    for point in driver.points() {
        close("stress", point.stress[0], limit, 1e-6);
    }
    let bound = found.upper_bound.ok_or("von Mises has a bound")?;
    close("bound", bound.load_factor, 0.5, 1e-6);
    Ok(())
}

#[test]
fn numbers_that_are_not_finite_are_refused() -> Fallible {
    let mut driver = on_floor(0.3, Settings::default())?;
    driver.run(
        &Step::new("press").pressure("block.top", 10.0),
        1,
        |_, _| {},
    )?;
    for bad in [f64::NAN, f64::INFINITY] {
        let steps = [
            (Step::new("p").pressure("block.top", bad), "pressure"),
            (Step::new("t").traction("block.top", [bad, 0.0]), "traction"),
            (Step::new("f").force("block.top", [0.0, bad]), "force"),
            (Step::new("b").body_force("block", [0.0, bad]), "force"),
            (
                Step::new("d").displace("block.top", Axis::Y, bad),
                "displacement",
            ),
            (Step::new("k").tool("floor", [bad, 0.0]), "tool"),
        ];
        for (step, named) in steps {
            match refused(&mut driver, &step) {
                IncrementError::Model(ModelError::OutOfRange { what, value, .. }) => {
                    assert!(
                        what.contains(named) && !value.is_finite(),
                        "{what}: {value}"
                    );
                }
                other => panic!("{}: {other:?}", step.name()),
            }
        }
    }
    Ok(())
}

#[test]
fn unknown_names_are_refused_with_the_nearest() -> Fallible {
    let mut driver = on_floor(0.3, Settings::default())?;
    match refused(
        &mut driver,
        &Step::new("press").pressure("block.topp", 10.0),
    ) {
        IncrementError::Model(ModelError::Mesh(MeshError::UnknownGroup { name, nearest })) => {
            assert_eq!(
                (name.as_str(), nearest.as_deref()),
                ("block.topp", Some("block.top"))
            );
        }
        other => panic!("{other:?}"),
    }
    match refused(
        &mut driver,
        &Step::new("press").fix("blok.left", &[Axis::X]),
    ) {
        IncrementError::Model(ModelError::Mesh(MeshError::UnknownGroup { nearest, .. })) => {
            assert_eq!(nearest.as_deref(), Some("block.left"));
        }
        other => panic!("{other:?}"),
    }
    match refused(&mut driver, &Step::new("move").tool("flor", [0.0, 0.1])) {
        IncrementError::Model(ModelError::UnknownTool { name, nearest }) => {
            assert_eq!((name.as_str(), nearest.as_deref()), ("flor", Some("floor")));
        }
        other => panic!("{other:?}"),
    }
    // Cells where facets are asked for.
    match refused(&mut driver, &Step::new("press").pressure("block", 10.0)) {
        IncrementError::Model(ModelError::Mesh(MeshError::WrongGroup { name, .. })) => {
            assert_eq!(name, "block");
        }
        other => panic!("{other:?}"),
    }
    assert!(matches!(
        driver.reaction("punsh"),
        Err(ModelError::Mesh(MeshError::UnknownGroup { .. }))
    ));
    assert!(matches!(
        driver.tool_force("punch"),
        Err(ModelError::UnknownTool { .. })
    ));
    let model = || -> Fallible<_> { Ok(Model::new(mesh()?, PlaneStrain::default())) };
    let error = model()?
        .contact("block.bottom", "floor", Coulomb::new(0.1)?)
        .err();
    assert!(
        matches!(error, Some(ModelError::UnknownOpposite { .. })),
        "{error:?}"
    );
    let error = model()?.material("blocks", steel()?, RULE).err();
    match error {
        Some(ModelError::Mesh(MeshError::UnknownGroup { nearest, .. })) => {
            assert_eq!(nearest.as_deref(), Some("block"));
        }
        other => panic!("{other:?}"),
    }
    Ok(())
}

#[test]
fn materials_must_cover_every_cell_once() -> Fallible {
    let mut halves = mesh()?;
    let right = (0..8).filter(|c| c % 4 >= 2).collect();
    halves.add_cell_group("right", right)?;
    let model = Model::new(halves.clone(), PlaneStrain::default()).material(
        "right",
        Elastic::new(1e3, 0.3)?,
        RULE,
    )?;
    match Driver::new(model, Settings::default()).err() {
        Some(ModelError::MissingMaterial { count: 4, first: 0 }) => {}
        other => panic!("{other:?}"),
    }
    let twice = Model::new(halves, PlaneStrain::default())
        .material("right", Elastic::new(1e3, 0.3)?, RULE)?
        .material("block", steel()?, RULE);
    match twice.err() {
        Some(ModelError::TwoMaterials { cell: 2, group }) => assert_eq!(group, "block"),
        other => panic!("{other:?}"),
    }
    Ok(())
}

#[test]
fn contradicting_conditions_are_refused() -> Fallible {
    let mut driver = on_floor(0.3, Settings::default())?;
    // The corner belongs to both sides.
    let step = Step::new("tear")
        .displace("block.left", Axis::Y, 0.1)
        .displace("block.top", Axis::Y, 0.2);
    match refused(&mut driver, &step) {
        IncrementError::Model(ModelError::TwoDisplacements {
            step,
            node,
            axis,
            first,
            second,
        }) => {
            assert_eq!(
                (step.as_str(), axis, first, second),
                ("tear", 'y', 0.1, 0.2)
            );
            assert_eq!(driver.mesh().nodes()[node], [0.0, 2.0]);
        }
        other => panic!("{other:?}"),
    }
    // The same value twice is no contradiction.
    let step = Step::new("hold")
        .fix("block.left", &[Axis::X, Axis::Y])
        .fix("block.left", &[Axis::Y]);
    driver.run(&step, 1, |_, _| {})?;
    // No third direction in the plane.
    let error = refused(&mut driver, &Step::new("out").fix("block.left", &[Axis::Z]));
    assert!(
        matches!(&error, IncrementError::Model(ModelError::OutOfRange { .. })),
        "{error:?}"
    );

    let model = || -> Fallible<_> {
        Ok(Model::new(mesh()?, PlaneStrain::default())
            .material("block", steel()?, RULE)?
            .tool("floor", floor()?)?
            .tool("wall", Plane::new([4.0, 0.0], [-1.0, 0.0])?)?
            .contact("block.bottom", "floor", Coulomb::new(0.1)?)?)
    };
    match model()?
        .contact("block.right", "floor", Coulomb::new(0.1)?)
        .err()
    {
        Some(ModelError::SharedContactNode {
            position,
            first,
            second,
            opposite,
            ..
        }) => {
            assert_eq!(position, vec![4.0, 0.0]);
            assert_eq!(
                [first.as_str(), second.as_str(), opposite.as_str()],
                ["block.bottom", "block.right", "floor"]
            );
        }
        other => panic!("{other:?}"),
    }
    match model()?.tool("wall", floor()?).err() {
        Some(ModelError::DuplicateTool { name }) => assert_eq!(name, "wall"),
        other => panic!("{other:?}"),
    }
    Ok(())
}
