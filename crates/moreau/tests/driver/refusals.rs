//! What the driver refuses, and that it changes nothing then.

use crate::steps::on_floor;
use moreau_contact::GaussSeidel;
use moreau_driver::{
    Axis, ElementCells, IncrementError, Model, ModelError, Nesting, Numbers, Saved, Settings,
    SolidBlock, Step,
};
use moreau_laws::Elastic;
use moreau_mesh::{CellKind, Integration, PlaneStrain, Quad4, Quad8, block2};
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
    match driver.run(&step, 1, |_, _| {}) {
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
}
