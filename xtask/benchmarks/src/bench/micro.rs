//! The kernels one by one: the time of a call, the least of some batches.

use std::error::Error;
use std::hint::black_box;
use std::time::{Duration, Instant};

use moreau::contact::{CondensedProblem, ContactSolver, SemismoothNewton};
use moreau::driver::{Analysis, Block, Motion, Settings, SolidBlock, Stiffness};
use moreau::laws::{BulkLaw, Coulomb, Local, VonMises, VonMisesState};
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use nalgebra::{DMatrix, DVector};
use verification::paper;

/// Time of a batch, and number of batches of which the fastest counts.
const BATCH: Duration = Duration::from_millis(50);
const BATCHES: usize = 7;

/// Prints the time of one call, in parts of `each`.
fn time(what: &str, each: usize, mut work: impl FnMut()) {
    let mut calls = 1;
    loop {
        let clock = Instant::now();
        (0..calls).for_each(|_| work());
        if clock.elapsed() >= BATCH || calls >= 1 << 30 {
            break;
        }
        calls *= 2;
    }
    let batch = |_| {
        let clock = Instant::now();
        (0..calls).for_each(|_| work());
        clock.elapsed().as_secs_f64() / (calls * each) as f64
    };
    let least = (0..BATCHES).map(batch).fold(f64::INFINITY, f64::min);
    println!("{what:<56} {:>12.1} ns", 1e9 * least);
}

pub(super) fn run() -> Result<bool, Box<dyn Error>> {
    let steel = VonMises::new(paper::YOUNG, paper::POISSON, paper::YIELD_STRESS)?;
    let old = VonMisesState::default();
    for (what, size) in [("elastic", 1e-4), ("plastic", 1e-2)] {
        let d_eps = moreau::mandel::Sym2::from([size, -0.4 * size, 0.0, 0.0, 0.0, 0.3 * size]);
        let what = format!("von Mises, {what}: stress, tangent, state");
        time(&what, 1, || {
            black_box(steel.respond(black_box(&old), black_box(&d_eps)));
        });
    }
    let law = Coulomb::new(0.3)?;
    let force = Local::<3>::new(1.0, 0.8, -0.5);
    time("projection on Coulomb's cone in space", 1, || {
        black_box(law.project(black_box(&force)));
    });

    let lines = uniform(0.0, 10.0, 8);
    let mesh = block2("block", CellKind::Quad8, &lines, &lines)?;
    let members: Vec<usize> = (0..mesh.cell_count()).collect();
    let cells = PlaneStrain::default()
        .cells(&mesh, CellKind::Quad8, &members, Integration::Reduced)
        .ok_or("an element of another dimension")?;
    let again = PlaneStrain::default()
        .cells(&mesh, CellKind::Quad8, &members, Integration::Reduced)
        .ok_or("an element of another dimension")?;
    let mut blocks: [(&str, Box<dyn Block<2>>); 2] = [
        (
            "small strains",
            Box::new(SolidBlock::new(members.clone(), cells, steel.clone())),
        ),
        (
            "large strains",
            Box::new(SolidBlock::large(members, again, steel)),
        ),
    ];
    let at_rest = vec![0.0; 2 * mesh.nodes().len()];
    for (strains, block) in &mut blocks {
        for (size, state) in [(1e-4, "elastic"), (1e-2, "plastic")] {
            let stretched = |x: &[f64; 2]| [size * x[0], 0.3 * size * x[1]];
            let d_u: Vec<f64> = mesh.nodes().iter().flat_map(stretched).collect();
            for (what, kind) in [
                ("forces and stiffness", Stiffness::Total(1.0)),
                (
                    "forces and what flow adds to the stiffness",
                    Stiffness::Plastic(1.0),
                ),
                ("forces and elastic stiffness", Stiffness::Total(0.0)),
                ("forces", Stiffness::None),
            ] {
                let what = format!("cell quad8 of four points, {strains}, {state}: {what}");
                let motion = Motion::new(&at_rest, &d_u);
                time(&what, mesh.cell_count(), || {
                    block.evaluate(black_box(motion), kind, &mut |cell| {
                        black_box(cell.force);
                    });
                });
            }
        }
    }

    for contacts in [40, 160] {
        let n = 2 * contacts;
        // The kernel of a half-plane, roughly: stiff on the diagonal and falling with the distance.
        let stiffness = DMatrix::from_fn(n, n, |i, j| {
            let apart = (i / 2).abs_diff(j / 2) as f64;
            let same: f64 = if i % 2 == j % 2 { 1.0 } else { 0.1 };
            1e5 * if i == j {
                2.0
            } else {
                -same / (4.0 * (1.0 + apart) * (1.0 + apart))
            }
        });
        let load = DVector::from_fn(n, |i, _| 10.0 * (1.0 + (0.3 * i as f64).sin()));
        let zero = vec![Local::<2>::zeros(); contacts];
        let law = vec![Coulomb::new(0.2)?; contacts];
        let problem = CondensedProblem::new(stiffness, load, zero.clone(), law, zero)?;
        let solver = SemismoothNewton::default();
        let cold = solver.solve(&problem, None)?;
        let what = format!("contact problem of {contacts} contacts, from nothing");
        time(&what, 1, || {
            black_box(solver.solve(black_box(&problem), None).is_ok());
        });
        let what = format!("contact problem of {contacts} contacts, from its solution");
        time(&what, 1, || {
            black_box(solver.solve(black_box(&problem), Some(&cold)).is_ok());
        });
    }

    for cells in [[40, 16], [80, 32]] {
        let mut driver = paper::block(cells, 0.1, Integration::Reduced, Settings::default())?;
        let reports = driver.run(&super::press(2), 2, |_, _| {})?;
        let count: usize = reports.iter().map(|r| r.factorisations).sum();
        let seconds = driver.timings().factorisation.as_secs_f64() / count.max(1) as f64;
        let what = format!("factorisation of {} unknowns", driver.unknowns());
        println!("{what:<56} {:>12.1} ns", 1e9 * seconds);
    }
    Ok(true)
}
