//! What is seen of an increment while it is solved: where it begins, and that its steps lead downhill.

use moreau_driver::{
    Analysis, Axis, Block, Driver, IncrementReport, Model, Motion, Settings, SolidBlock, Step,
};
use moreau_laws::{Elastic, VonMises};
use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use std::ops::ControlFlow;

/// An iterate: displacement increments \[mm\] and what they leave out of balance \[N\].
struct Seen {
    d_u: Vec<f64>,
    residual: Vec<f64>,
}

/// Applies a step in one increment: its iterates from the first guess on, and its report.
fn watched(driver: &mut Driver<2>, step: &Step<2>) -> (Vec<Seen>, IncrementReport) {
    let mut iterates = Vec::new();
    let mut ramp = driver.begin(step, 1).expect("valid");
    let report = driver.proceed(&mut ramp, &mut |now| {
        iterates.push(Seen {
            d_u: now.d_u.to_vec(),
            residual: now.residual.to_vec(),
        });
        ControlFlow::Continue(())
    });
    (iterates, report.expect("converges"))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A bar that is pulled to some parts of a way: of each increment the first guess and what it becomes \[mm\].
fn guesses(large: bool, ends: &[f64], way: f64) -> Vec<[Vec<f64>; 2]> {
    let (x, y) = (uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1));
    let mesh = block2("bar", CellKind::Quad8, &x, &y).expect("valid");
    let start = match large {
        true => Model::with_large_strains,
        false => Model::new,
    };
    let elastic = Elastic::new(1000.0, 0.3).expect("valid");
    let model = start(mesh, PlaneStrain::default())
        .material("bar", elastic, Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let pulled = |end: &f64| {
        let step = Step::new("pull")
            .fix("bar.left", &[Axis::X, Axis::Y])
            .displace("bar.right", Axis::X, end * way)
            .displace("bar.right", Axis::Y, 0.5 * end * way);
        let (iterates, _) = watched(&mut driver, &step);
        let [guess, .., found] = iterates.as_slice() else {
            panic!("at least two iterates");
        };
        [guess.d_u.clone(), found.d_u.clone()]
    };
    ends.iter().map(pulled).collect()
}

/// How far the guess of the last increment is from what it becomes \[mm\].
fn off(large: bool, ends: &[f64], way: f64) -> f64 {
    let guesses = guesses(large, ends, way);
    let [guess, found] = &guesses[ends.len() - 1];
    let differences = guess.iter().zip(found).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// Of third order, where increments are equal and where they are not; with two equilibria known of second.
#[test]
fn a_smooth_path_is_foreseen() {
    for (ends, order) in [
        (&[1.0, 2.0, 3.0, 4.0][..], 3),
        (&[1.0, 2.0, 3.0, 3.7], 3),
        (&[1.0, 1.5, 2.5, 4.0], 3),
        (&[1.0, 2.0], 2),
    ] {
        let [coarse, fine] = [0.04, 0.02].map(|way| off(true, ends, way));
        let found = (coarse / fine).log2();
        assert!((found - f64::from(order)).abs() < 0.2, "{ends:?}: {found}");
    }
    // Of small strains the elastic path is straight.
    assert!(off(false, &[1.0, 2.0, 3.5], 0.04) < 1e-12);
}

/// Displacements that increments prescribe are in their guesses to the last bit, although tenths are none in binary: a first
/// step that had to make up for rounding would be taken as it is, however far it leads.
#[test]
fn what_is_prescribed_is_reached_by_a_guess() {
    let tenths = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
    let lengths = [0.1, 0.1, 0.3 - 0.2, 0.4 - 0.3, 0.5 - 0.4, 0.6 - 0.5];
    for ([guess, found], length) in guesses(true, &tenths, 1.0).iter().zip(lengths).skip(1) {
        assert!(
            guess.contains(&length) && found.contains(&length),
            "{length}"
        );
    }
}

/// What turns back, or comes from far shorter increments, tells nothing.
#[test]
fn a_path_that_turns_back_is_not_foreseen() {
    let moved = off(true, &[1.0, 2.0, 1.5], 0.04);
    assert!((moved - 0.02).abs() < 1e-6, "{moved}");
    assert!(off(true, &[1.0, 1.1, 2.0], 0.04) > 0.03);
}

/// Pulls a strip that is held over half of its width, in one increment: a block of its own, iterates and report.
fn pulled(hardening: f64, traction: f64) -> (impl Block<2>, Vec<Seen>, IncrementReport) {
    let (x, y) = (uniform(0.0, 10.0, 8), uniform(0.0, 20.0, 8));
    let mut mesh = block2("strip", CellKind::Quad8, &x, &y).expect("valid");
    mesh.node_group_where("ligament", "strip.bottom", |x| x[0] <= 5.0)
        .expect("not empty");
    let steel = VonMises::new(210e3, 0.3, 300.0).and_then(|s| s.with_isotropic(hardening));
    let (steel, plane) = (steel.expect("valid"), PlaneStrain::default());
    let all: Vec<usize> = (0..mesh.cell_count()).collect();
    let cells = plane
        .cells(&mesh, CellKind::Quad8, &all, Integration::Reduced)
        .expect("an element of the plane");
    let block = SolidBlock::new(all, cells, steel.clone());
    let model = Model::new(mesh, plane)
        .material("strip", steel, Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("pull")
        .fix("strip.left", &[Axis::X])
        .fix("ligament", &[Axis::Y])
        .pressure("strip.top", -traction);
    let (iterates, report) = watched(&mut driver, &step);
    (block, iterates, report)
}

/// ΔΦ, \[74\], without contact: close to collapse the imbalance rises on the way, and ΔΦ never does; beyond it most steps
/// overshoot, and none goes farther than to where the slope of ΔΦ is half of that at its begin.
#[test]
fn the_potential_decreases_from_iterate_to_iterate() {
    for (hardening, traction) in [(0.0, 258.0), (100.0, 300.0)] {
        let (block, iterates, report) = pulled(hardening, traction);
        assert!(report.plastic_fraction > 0.05 && report.cuts == 0);
        assert!(report.shortened_steps > 10 || hardening == 0.0);
        assert!(report.residuals.windows(2).any(|r| r[1] > r[0]));
        // Nothing has moved in the first: what is out of balance is the load.
        let load = &iterates[0].residual;
        let rest = vec![0.0; load.len()];
        let potential = |i: &Seen| -> f64 {
            let stored = block.potential(Motion::new(&rest, &i.d_u));
            stored.expect("a potential") - dot(load, &i.d_u)
        };
        for pair in iterates.windows(2) {
            let [before, after] = [&pair[0], &pair[1]].map(potential);
            let rises = after > before + 1e-10 * before.abs();
            assert!(!rises || hardening > 0.0, "{before} {after}");
            let step = pair[1].d_u.iter().zip(&pair[0].d_u).map(|(b, a)| b - a);
            let step: Vec<f64> = step.collect();
            let [begin, end] = [&pair[0], &pair[1]].map(|i| -dot(&step, &i.residual));
            assert!(begin < 0.0 && end <= 0.5 * begin.abs(), "{begin} {end}");
        }
    }
}
