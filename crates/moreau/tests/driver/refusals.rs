//! What the driver refuses, and that it changes nothing then.

use crate::steps::on_floor;
use moreau_contact::GaussSeidel;
use moreau_driver::{
    Axis, Driver, ElementCells, IncrementError, Model, ModelError, Nesting, Numbers, Saved,
    Settings, SolidBlock, Step,
};
use moreau_laws::Elastic;
use moreau_mesh::{Axisymmetric, CellKind, Integration, PlaneStrain, Quad4, Quad8, block2};
use std::ops::ControlFlow;

#[test]
fn a_body_pulled_off_its_floor_is_an_error_that_changes_nothing() {
    let mut driver = on_floor(
        [4, 2],
        0.0,
        0.0,
        Settings {
            cuts: 2,
            ..Settings::default()
        },
    );
    let step = Step::new("pull")
        .fix("block.left", &[Axis::X])
        .pressure("block.top", -1.0);
    match driver.run(&step, 1, |_, _| {}) {
        Err(IncrementError::Stopped { reached, cause, .. }) => {
            assert_eq!(reached, 0.0);
            assert!(matches!(*cause, IncrementError::Contact { .. }), "{cause}");
        }
        other => panic!("expected Stopped, got {other:?}"),
    }
    assert_eq!(driver.increments(), 0);
    assert!(
        driver
            .contacts()
            .iter()
            .all(|c| driver.displacement(c.node).norm() == 0.0)
    );
}

#[test]
fn a_factor_larger_than_the_memory_is_refused_with_both_sizes() {
    let settings = |memory| Settings {
        memory: Some(memory),
        ..Settings::default()
    };
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.1);
    let mut driver = on_floor([8, 4], 0.0, 0.1, settings(4096));
    let found = driver.run(&step, 1, |_, _| {});
    let told = found
        .as_ref()
        .err()
        .map(ToString::to_string)
        .unwrap_or_default();
    assert!(
        told.contains("there is room for 4.096 kB;") && told.contains(" kB, and"),
        "{told}"
    );
    match found {
        Err(IncrementError::Model(ModelError::TooLarge {
            unknowns,
            needed,
            room,
        })) => {
            assert!(unknowns > 100 && needed > 8.0 * unknowns as f64 / 1e9);
            assert_eq!(room, 4096.0 / 1e9);
        }
        other => panic!("expected TooLarge, got {other:?}"),
    }
}

/// A loading is open to its users: what is of another model, or no number, is told and changes nothing.
#[test]
fn a_loading_of_another_model_is_refused() {
    let mut driver = on_floor([4, 2], 0.0, 0.1, Settings::default());
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.1);
    let loading = driver.loading(&step).expect("valid");
    // A tool has two nodes.
    let unknown = 2 * (driver.mesh().nodes().len() + 2);
    let (mut forced, mut moved, mut wild) = (loading.clone(), loading.clone(), loading);
    forced.force.add(unknown, 1.0);
    moved.displacement.insert(unknown, 1.0);
    wild.force.add(0, f64::NAN);
    for (loading, told) in [
        (forced, "degree of freedom"),
        (moved, "degree of freedom"),
        (wild, "force f_x on node 0"),
    ] {
        let Err(IncrementError::Model(ModelError::OutOfRange { what, .. })) =
            driver.advance(&loading)
        else {
            panic!("{told} passes");
        };
        assert!(what.contains(told), "{what}");
        assert_eq!(driver.increments(), 0);
    }
}

/// The same of a ramp that was saved, where it begins and where it ends.
#[test]
fn a_saved_ramp_of_another_model_is_refused() {
    let mut driver = on_floor([4, 2], 0.0, 0.1, Settings::default());
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.1);
    let ramp = driver.begin(&step, 2).expect("valid");
    let mut numbers = Vec::new();
    ramp.write(&mut numbers);
    // Prescribed displacements by how many numbers, then no directions (two lists), no forces, no pressures, no
    // temperatures, no turns and no axes of moments, then the same of the end.
    let loading = 8 + numbers[0] as usize;
    assert_eq!(numbers[0], numbers[loading]);
    for first in [1, loading + 1] {
        let mut other = numbers.clone();
        let last = first + numbers[0] as usize - 2;
        other[last] = 1e6;
        let mut ramp = ramp.clone();
        ramp.read(&mut Numbers::Read(&other)).expect("whole");
        let outcome = driver.proceed(&mut ramp, &mut |_| ControlFlow::Continue(()));
        let Err(IncrementError::Model(ModelError::OutOfRange { value, .. })) = outcome else {
            panic!("expected OutOfRange, got {outcome:?}");
        };
        assert_eq!((value, driver.increments()), (1e6, 0));
    }
    let mut ramp = ramp.clone();
    ramp.read(&mut Numbers::Read(&numbers)).expect("whole");
    assert!(
        driver
            .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
            .is_ok()
    );
}

#[test]
fn the_papers_nesting_cannot_hold_a_floating_body() {
    let nesting = Nesting::Outside {
        tolerance: 1e-6,
        iterations: 100,
        extrapolated: true,
    };
    let mut driver = on_floor(
        [4, 2],
        0.0,
        0.3,
        Settings {
            nesting,
            cuts: 0,
            ..Settings::default()
        },
    );
    let load = driver.run(&Step::new("load").pressure("block.top", 40.0), 1, |_, _| {});
    assert!(
        matches!(load, Err(IncrementError::Stopped { .. })),
        "{load:?}"
    );
}

#[test]
fn gauss_seidel_says_that_it_cannot_hold_a_floating_body() {
    let settings = Settings {
        contact: Box::new(GaussSeidel::default()),
        cuts: 0,
        ..Settings::default()
    };
    let mut driver = on_floor([4, 2], 0.0, 0.3, settings);
    let error = driver
        .run(&Step::new("load").pressure("block.top", 40.0), 1, |_, _| {})
        .expect_err("not definite");
    assert!(
        error
            .to_string()
            .contains("needs bodies held without contact; semismooth Newton does not"),
        "{error}"
    );
}

/// A block from outside brings cells of the mesh, each once, on their own nodes; an element as many nodes
/// as they have.
#[test]
fn blocks_that_do_not_fit_the_mesh_are_refused() {
    let line = [0.0, 1.0, 2.0];
    let mesh = || block2("b", CellKind::Quad8, &line, &line).expect("valid");
    let rule = Integration::Full;
    let plane = PlaneStrain::default();
    let wrong = ElementCells::new::<Quad4, _>(&mesh(), &[0], &plane, rule);
    let message = wrong.err().map(|e| e.to_string());
    assert_eq!(
        message.as_deref(),
        Some("cell 0 has not the 4 nodes of the element")
    );
    assert!(ElementCells::new::<Quad8, _>(&mesh(), &[4], &plane, rule).is_err());
    let block = |members: &[usize], of: &[usize]| {
        let cells = ElementCells::new::<Quad8, _>(&mesh(), of, &plane, rule).expect("valid");
        let law = Elastic::new(1.0, 0.3).expect("valid");
        SolidBlock::new(members.to_vec(), Box::new(cells), law)
    };
    let model = || Model::new(mesh(), plane);
    let refused = |members: &[usize], of: &[usize]| {
        let error = model().block("mine", block(members, of)).err();
        error.expect("refused").to_string()
    };
    assert!(refused(&[0, 9], &[0, 1]).contains("cell 9 of block \"mine\" is none of the mesh"));
    assert!(refused(&[0, 1], &[0, 2]).contains("nodes that are not those of its cell"));
    assert!(refused(&[0, 0], &[0, 0]).contains("cell 0 of group \"mine\" has a material already"));
    assert!(
        model()
            .block("mine", block(&[0, 1, 2, 3], &[0, 1, 2, 3]))
            .is_ok()
    );
    // As many as it has itself.
    for (members, of) in [(&[0, 1, 2, 3][..], &[0, 1][..]), (&[0][..], &[0, 1][..])] {
        let told = refused(members, of);
        assert!(
            told.contains("cells of the mesh that block \"mine\" names"),
            "{told}"
        );
    }
    // The same numbers elsewhere, by as little as can be.
    let stretched = [0.0, 1.0, 2.0_f64.next_up()];
    let other = block2("b", CellKind::Quad8, &stretched, &line).expect("valid");
    let cells = ElementCells::new::<Quad8, _>(&other, &[0, 1, 2, 3], &plane, rule).expect("valid");
    let law = Elastic::new(1.0, 0.3).expect("valid");
    let elsewhere = SolidBlock::new(vec![0, 1, 2, 3], Box::new(cells), law);
    let told = model()
        .block("mine", elsewhere)
        .err()
        .expect("refused")
        .to_string();
    assert!(
        told.contains("cell 1 of block \"mine\" has its nodes elsewhere"),
        "{told}"
    );
}

/// No increment meets a tolerance that is none, or is found without iterations.
#[test]
fn settings_that_no_increment_meets_are_refused() {
    let outside = |tolerance, iterations| Settings {
        nesting: Nesting::Outside {
            tolerance,
            iterations,
            extrapolated: true,
        },
        ..Settings::default()
    };
    let inside = |tolerance, iterations| Settings {
        tolerance,
        iterations,
        ..Settings::default()
    };
    let mesh = || block2("b", CellKind::Quad8, &[0.0, 1.0], &[0.0, 1.0]).expect("valid");
    let driver = |settings: Settings<2>| {
        let law = Elastic::new(1.0, 0.3).expect("valid");
        let model =
            Model::new(mesh(), PlaneStrain::default()).material("b", law, Integration::Full);
        Driver::new(model.expect("valid"), settings).map(|_| ())
    };
    assert_eq!(driver(inside(1e-10, 1)), Ok(()));
    assert_eq!(driver(outside(1e-8, 1)), Ok(()));
    let cases = [0.0, -1.0, f64::NAN, f64::INFINITY].map(|t| (t, 10));
    for (tolerance, iterations) in cases.into_iter().chain([(1e-8, 0)]) {
        for settings in [
            inside(tolerance, iterations),
            outside(tolerance, iterations),
        ] {
            let error = driver(settings).err();
            assert!(
                matches!(error, Some(ModelError::OutOfRange { .. })),
                "{tolerance} {iterations}: {error:?}"
            );
        }
    }
}

/// Around an axis nothing is on its other side.
#[test]
fn a_negative_radius_is_refused() {
    let driver = |from: f64| {
        let mesh = block2("b", CellKind::Quad8, &[from, 1.0], &[0.0, 1.0]).expect("valid");
        let law = Elastic::new(1.0, 0.3).expect("valid");
        let model = Model::new(mesh, Axisymmetric).material("b", law, Integration::Full);
        Driver::new(model.expect("valid"), Settings::default()).map(|_| ())
    };
    assert_eq!(driver(0.0), Ok(()));
    match driver(-1.0) {
        Err(ModelError::OutOfRange { what, value, .. }) => {
            assert!(
                what.contains("radius of node 0") && value == -1.0,
                "{what} {value}"
            );
        }
        other => panic!("{other:?}"),
    }
}

/// A state whose displacements are no numbers, or whose counts are none that could have been counted, is none to go on from.
#[test]
fn a_saved_state_of_no_numbers_is_refused() {
    let driver = || on_floor([4, 2], 0.0, 0.1, Settings::default());
    let mut numbers = Vec::new();
    driver().write(&mut numbers);
    assert!(driver().read(&mut Numbers::Read(&numbers)).is_ok());
    // The increments, the farthest, the largest force, a flag, and after their number the displacements.
    for (at, value) in [(0, 1e300), (5, f64::NAN), (6, f64::INFINITY), (1, f64::NAN)] {
        let mut other = numbers.clone();
        other[at] = value;
        let error = driver().read(&mut Numbers::Read(&other)).err();
        assert!(
            matches!(error, Some(ModelError::OutOfRange { .. })),
            "{at}: {error:?}"
        );
    }
}

/// An index that is none is told as such.
#[test]
fn a_node_or_contact_that_there_is_not_is_named() {
    let driver = on_floor([4, 2], 0.0, 0.1, Settings::default());
    let told = |call: &dyn Fn(&Driver<2>)| -> String {
        let call = std::panic::AssertUnwindSafe(|| call(&driver));
        let panic = std::panic::catch_unwind(call).expect_err("an index beyond");
        panic.downcast_ref::<String>().cloned().unwrap_or_default()
    };
    let nodes: [&dyn Fn(&Driver<2>); 3] = [
        &|d| drop(d.displacement(9999).norm().to_string()),
        &|d| drop(d.nodal_reaction(9999).norm().to_string()),
        &|d| drop(d.nodal_contact_force(9999).norm().to_string()),
    ];
    for call in nodes {
        assert_eq!(told(call), "node 9999 is none of the mesh");
    }
    assert_eq!(
        told(&|d| drop(d.contact_name(9).0.to_owned())),
        "contact 9 is none of the model"
    );
}

/// A value that is no number is told by the condition that has it, not by what became of it.
#[test]
fn a_condition_that_is_no_number_is_told() {
    let driver = on_floor([4, 2], 0.0, 0.1, Settings::default());
    let (nan, step) = (f64::NAN, || {
        Step::new("press").fix("block.left", &[Axis::X])
    });
    for (step, expected) in [
        (step().pressure("punch", nan), "pressure on \"punch\""),
        (
            step().traction("punch", [0.0, f64::INFINITY]),
            "traction on \"punch\"",
        ),
        (step().force("punch", [nan, 0.0]), "force on \"punch\""),
        (
            step().body_force("block", [nan, 0.0]),
            "force per volume on \"block\"",
        ),
        (
            step().displace("punch", Axis::Y, nan),
            "displacement of \"punch\"",
        ),
        (
            step().displace_along("punch", [0.0, 1.0], nan),
            "displacement of \"punch\"",
        ),
        (step().tool("floor", [0.0, nan]), "motion of tool \"floor\""),
        (
            step().turn("floor", [0.0, 0.0, 1.0], nan),
            "turn of tool \"floor\"",
        ),
        (
            step().push("floor", Axis::Y, nan),
            "force on tool \"floor\"",
        ),
        (
            step().moment("floor", [0.0, 0.0, 1.0], nan),
            "moment on tool \"floor\"",
        ),
    ] {
        match driver.loading(&step) {
            Err(ModelError::OutOfRange { what, .. }) => {
                assert_eq!(what, format!("{expected} in step \"press\""));
            }
            other => panic!("{expected}: {other:?}"),
        }
    }
}
