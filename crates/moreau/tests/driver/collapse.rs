//! Loads beyond what a structure carries: the load factor at collapse, its bound, and the state
//! that is left.

use moreau_contact::Plane;
use moreau_driver::{
    Axis, Collapse, Driver, IncrementError, IncrementReport, Increments, Model, ModelError,
    Nesting, Numbers, Saved, Settings, Step,
};
use moreau_laws::{Coulomb, Elastic, VonMises};
use moreau_mesh::{Axisymmetric, CellKind, Integration, PlaneStrain, block2, uniform};
use std::ops::ControlFlow;

/// Ends in collapse, after these reports.
pub(crate) fn collapse<const D: usize>(
    driver: &mut Driver<D>,
    step: &Step<D>,
    increments: usize,
) -> (Collapse, Vec<IncrementReport>) {
    let (mut reports, before) = (Vec::new(), driver.increments());
    match driver.run(step, increments, |_, r| reports.push(r.clone())) {
        Err(IncrementError::Collapse { collapse, step: s }) => {
            assert_eq!(s, step.name());
            assert_eq!(driver.increments() - before, reports.len());
            (collapse, reports)
        }
        other => panic!("expected collapse, got {other:?}"),
    }
}

/// Internal pressure at which a thick cylinder collapses \[MPa\].
pub(crate) fn limit() -> f64 {
    480.0 / 3f64.sqrt() * 2f64.ln()
}

pub(crate) fn cylinder(settings: Settings<2>) -> Driver<2> {
    let (r, z) = (uniform(100.0, 200.0, 8), uniform(0.0, 10.0, 1));
    let steel = VonMises::new(210e3, 0.3, 240.0).expect("valid");
    let model = block2("body", CellKind::Quad8, &r, &z)
        .map(|mesh| Model::new(mesh, Axisymmetric))
        .map(|m| m.material("body", steel, Integration::Reduced))
        .expect("valid");
    Driver::new(model.expect("valid"), settings).expect("valid")
}

pub(crate) fn pressed(pressure: f64) -> Step<2> {
    Step::new("press")
        .fix("body", &[Axis::Y])
        .pressure("body.left", pressure)
}

#[test]
fn a_cylinder_collapses_at_its_limit_pressure_and_the_bound_is_sharp() {
    let mut driver = cylinder(Settings::default());
    let (found, reports) = collapse(&mut driver, &pressed(1.25 * limit()), 10);
    // The exact pressure is that of the continuum; the mesh differs by 1e-6.
    assert!((1.25 * found.load_factor - 1.0).abs() < 5e-6, "{found:?}");
    assert!(found.growth.abs() <= Collapse::FLAT);
    let bound = found.upper_bound.expect("von Mises");
    assert!(!bound.coulomb && bound.elastic_share < 1e-5, "{bound:?}");
    let gap = bound.load_factor / found.load_factor - 1.0;
    assert!((-1e-10..1e-5).contains(&gap), "{gap:e}");
    // Along the plateau in few increments of few iterations, one factorisation in each.
    assert!(reports.len() < 20, "{}", reports.len());
    let newton: usize = reports.iter().map(|r| r.newton_iterations).sum();
    assert!(
        newton <= 38,
        "{newton} iterations in {} increments",
        reports.len()
    );
    let last = &reports[reports.len() - 1];
    assert!(last.factorisations <= last.newton_iterations + 1 && last.newton_iterations < 8);
    assert!(last.fraction <= found.load_factor);
    assert!(last.out_of_balance < 1e-9 * limit() * 6283.0);
    // The text says it.
    let text = found.to_string();
    assert!(
        text.starts_with("collapse at load factor 0.80000") && text.contains("upper bound 0.8")
    );
    // The driver works on: unloading is elastic, and what was dissipated stays.
    let work = driver.energies().plastic_dissipation;
    let unload = Step::new("unload").fix("body", &[Axis::Y]);
    let back = driver.run(&unload, 1, |_, _| {}).expect("elastic");
    assert!(back[0].plastic_fraction < 0.5 && driver.energies().plastic_dissipation >= work);
}

/// Dead loads of the step before stay, and the factor is that of what is added to them.
#[test]
fn the_factor_is_that_of_the_loads_that_grow() {
    let mut driver = cylinder(Settings::default());
    let half = pressed(0.5 * limit());
    driver.run(&half, 2, |_, _| {}).expect("carried");
    let (found, _) = collapse(&mut driver, &pressed(1.5 * limit()), 5);
    assert!(
        found.added && found.to_string().contains(" of the way from the forces"),
        "{found}"
    );
    assert!((found.load_factor - 0.5).abs() < 5e-6, "{found:?}");
    let bound = found.upper_bound.expect("von Mises").load_factor;
    assert!((bound - found.load_factor).abs() < 1e-5, "{bound}");
}

/// With its first increments beyond collapse already, and with hardening that saturates.
#[test]
fn overloads_and_hardening_that_saturates_end_alike() {
    let mut driver = cylinder(Settings::default());
    let (found, _) = collapse(&mut driver, &pressed(7.3 * limit()), 4);
    assert!((7.3 * found.load_factor - 1.0).abs() < 5e-6, "{found:?}");
    // Linear hardening carries anything.
    let (r, z) = (uniform(100.0, 200.0, 8), uniform(0.0, 10.0, 1));
    let steel = VonMises::new(210e3, 0.3, 240.0).and_then(|s| s.with_isotropic(2000.0));
    let mesh = block2("body", CellKind::Quad8, &r, &z).expect("valid");
    let model = Model::new(mesh, Axisymmetric)
        .material("body", steel.expect("valid"), Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let reports = driver.run(&pressed(1.2 * limit()), 5, |_, _| {});
    assert_eq!(
        reports.expect("carried").last().map(|r| r.fraction),
        Some(1.0)
    );
}

/// A block on a floor, pressed by a dead load N and pushed along: it slides at μ N.
#[test]
fn a_block_slides_at_the_friction_of_its_dead_load() {
    let mesh = block2(
        "block",
        CellKind::Quad8,
        &uniform(0.0, 40.0, 4),
        &uniform(0.0, 10.0, 2),
    );
    let elastic = Elastic::new(210e3, 0.3).expect("valid");
    let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
    let model = Model::new(mesh.expect("valid"), PlaneStrain::default())
        .material("block", elastic, Integration::Reduced)
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| m.contact("block.bottom", "floor", Coulomb::new(0.3).expect("valid")))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let press = Step::new("press").pressure("block.top", 50.0);
    driver.run(&press, 1, |_, _| {}).expect("held");
    let push = Step::new("push")
        .pressure("block.top", 50.0)
        .body_force("block", [2.0, 0.0]);
    // 0.3 · 50 · 40 of the 2 · 400 N.
    let (found, reports) = collapse(&mut driver, &push, 8);
    assert!((found.load_factor - 0.75).abs() < 1e-9, "{found:?}");
    let bound = found.upper_bound.expect("elastic");
    assert!(
        bound.coulomb && (bound.load_factor - 0.75).abs() < 1e-6,
        "{bound:?}"
    );
    assert!(found.to_string().contains("no bound"), "{found}");
    let force = driver.tool_force("floor").expect("exists");
    assert!(
        (force[0] + 600.0).abs() < 1e-6 && (force[1] - 2000.0).abs() < 1e-6,
        "{force}"
    );
    assert!(reports.last().is_some_and(|r| r.stick == 0 && r.slip > 0));
}

/// Newton is given too few iterations for whole increments: the path is followed instead, and the
/// step ends at its loads all the same.
#[test]
fn a_path_that_passes_the_loads_of_the_step_ends_at_them() {
    let run = |iterations, increments| {
        let settings = Settings {
            iterations,
            ..Settings::default()
        };
        let mut driver = cylinder(settings);
        let reports = driver.run(&pressed(0.97 * limit()), increments, |_, _| {});
        let u = driver.displacement(0)[0];
        (reports.expect("carried"), u)
    };
    let (fine, expected) = run(40, 40);
    let (reports, u) = run(3, 3);
    assert!(reports.iter().map(|r| r.cuts).sum::<usize>() > 0);
    assert_eq!(reports.last().map(|r| r.fraction), Some(1.0));
    assert!(reports.len() < fine.len());
    assert!((u / expected - 1.0).abs() < 5e-3, "{u} {expected}");
}

/// Read back anywhere, before the path, on it and at its end.
#[test]
fn a_path_that_is_read_back_goes_on_to_the_bit() {
    let step = pressed(1.25 * limit());
    let mut driver = cylinder(Settings::default());
    let mut ramp = driver.begin(&step, 5).expect("valid");
    let (mut saved, mut reports) = (Vec::new(), Vec::new());
    let end = loop {
        let mut numbers = Vec::new();
        driver.write(&mut numbers);
        ramp.write(&mut numbers);
        saved.push(numbers);
        match driver.proceed(&mut ramp, &mut |_| ControlFlow::Continue(())) {
            Ok(report) => reports.push(report),
            Err(end) => break end,
        }
    };
    assert!(matches!(end, IncrementError::Collapse { .. }), "{end}");
    for (k, numbers) in saved.iter().enumerate() {
        let mut other = cylinder(Settings::default());
        let mut from = Numbers::Read(numbers);
        other.read(&mut from).expect("fits");
        let mut ramp = other.begin(&step, Increments::equal(5)).expect("valid");
        ramp.read(&mut from).expect("fits");
        for report in &reports[k..] {
            let again = other
                .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
                .expect("converges");
            assert_eq!(&again, report);
        }
        assert_eq!(
            other.proceed(&mut ramp, &mut |_| ControlFlow::Continue(())),
            Err(end.clone())
        );
        let short = &numbers[..numbers.len() - 1];
        let mut from = Numbers::Read(short);
        other.read(&mut from).expect("fits");
        let cut = ramp.read(&mut from);
        assert!(matches!(cut, Err(ModelError::Saved { .. })), "{cut:?}");
    }
}

/// Where the path is not followed, the last increments say where it leads; not where nothing yields.
#[test]
fn a_step_that_stops_before_collapse_says_how_far_it_is() {
    let outside = Settings {
        nesting: Nesting::Outside {
            tolerance: 1e-8,
            iterations: 100,
            extrapolated: true,
        },
        ..Settings::default()
    };
    let mut driver = cylinder(outside);
    match driver.run(&pressed(1.25 * limit()), 20, |_, _| {}) {
        Err(error @ IncrementError::Stopped { .. }) => {
            assert!(
                error.to_string().contains("the last increments put at "),
                "{error}"
            );
            let IncrementError::Stopped {
                limit: Some(limit),
                reached,
                ..
            } = error
            else {
                panic!("no estimate")
            };
            assert!(
                limit >= reached && (limit / 0.8 - 1.0).abs() < 1e-2,
                "{limit}"
            );
        }
        other => panic!("{other:?}"),
    }
}

/// Hardening carries more and more: a structure that has moved by its own size has no limit load.
#[test]
fn a_structure_that_runs_away_while_it_hardens_is_refused() {
    let (r, z) = (uniform(100.0, 200.0, 8), uniform(0.0, 10.0, 1));
    let steel = VonMises::new(210e3, 0.3, 240.0).and_then(|s| s.with_isotropic(1.0));
    let mesh = block2("body", CellKind::Quad8, &r, &z).expect("valid");
    let model = Model::new(mesh, Axisymmetric)
        .material("body", steel.expect("valid"), Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    match driver.run(&pressed(1.25 * limit()), 5, |_, _| {}) {
        Err(IncrementError::RunsAway { factor, growth, .. }) => {
            assert!(growth > Collapse::SLOW[0], "{growth}");
            assert!((0.8..0.9).contains(&factor), "{factor}");
        }
        other => panic!("{other:?}"),
    }
    let size = driver.mesh().size();
    let motion = driver.displacement(0)[0];
    assert!(
        motion > size && motion < 4.0 * size,
        "{motion} mm in {size} mm"
    );
}
