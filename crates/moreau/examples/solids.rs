//! What MUMPS takes for the stiffness of a cube of 20-node hexahedra, with blocks of low rank and without: unknowns,
//! entries and operations of the factor, time, memory, and the error of a solution.
//!
//! `cargo run --release -p moreau --features distributed --example solids -- CELLS [LOW_RANK [metis]]`
//!
//! CELLS go along an edge, LOW_RANK is the error that blocks may leave, 0 for none; `metis` eliminates in the order that
//! METIS finds, instead of that of nested dissection that the embedded engine takes. Memory is the largest that the process has held
//! up to then, on one process; of several numbers of cells run it again for each.

// A program, not a library: it prints.
#![allow(clippy::print_stdout)]

use moreau::algebra::{Cost, Engine, EngineError, Inertia, Matrix, Pattern, Share, Team, TooLarge};
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::Elastic;
use moreau::mesh::{CellKind, Integration, Solid, block3, uniform};
use moreau_mumps::{Options, Processes};
use nalgebra::DMatrix;
use std::error::Error;
use std::sync::{Arc, Mutex};
use std::time::Instant;

type Kept = Arc<Mutex<Option<(Pattern, Vec<f64>)>>>;

/// A team of one whose engine keeps the matrix and gives up.
#[derive(Debug)]
struct Keeping(Kept);

#[derive(Debug)]
struct Keeper(Kept, Pattern);

impl Team for Keeping {
    fn rank(&self) -> usize {
        0
    }
    fn size(&self) -> usize {
        1
    }
    fn send(&self, _: usize, _: &[u8]) {}
    fn receive(&self, _: usize) -> Vec<u8> {
        Vec::new()
    }
    fn engine(&self, of: &Pattern, _: Option<u64>, _: bool) -> Result<Box<dyn Engine>, TooLarge> {
        Ok(Box::new(Keeper(self.0.clone(), of.clone())))
    }
    fn assist(&self, _: &[u8], _: Share<'_>) {}
}

impl Engine for Keeper {
    fn analyse(_: &Pattern, _: Option<u64>) -> Result<Self, TooLarge> {
        let (entries, room) = (0.0, 0.0);
        Err(TooLarge { entries, room })
    }
    fn size(&self) -> usize {
        self.1.size()
    }
    fn kept(&self) -> usize {
        self.1.kept()
    }
    fn cost(&self) -> Cost {
        // Of whatever it is asked for, the factor of the stiffness itself is to be made.
        let (entries, operations) = (f64::INFINITY, f64::INFINITY);
        Cost {
            entries,
            operations,
        }
    }
    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        if let Ok(mut kept) = self.0.lock() {
            *kept = Some((self.1.clone(), values.to_vec()));
        }
        Err(EngineError::NotFactorised)
    }
    fn least_pivot(&self) -> f64 {
        0.0
    }
    fn solve(&mut self, _: &mut [f64]) -> Result<(), EngineError> {
        Err(EngineError::NotFactorised)
    }
    fn condense(&mut self, _: &mut [f64]) -> Result<(), EngineError> {
        Err(EngineError::NotFactorised)
    }
    fn expand(&mut self, _: &mut [f64]) -> Result<(), EngineError> {
        Err(EngineError::NotFactorised)
    }
    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        Err(EngineError::NotFactorised)
    }
}

/// The elastic stiffness of a cube that is held at one side.
fn stiffness(cells: usize) -> Result<(Pattern, Vec<f64>), Box<dyn Error>> {
    let line = uniform(0.0, 10.0, cells);
    let mesh = block3("cube", CellKind::Hex20, &line, &line, &line)?;
    let kept = Kept::default();
    let model = Model::new(mesh, Solid)
        .on_team(Arc::new(Keeping(kept.clone())))
        .material("cube", Elastic::new(210e3, 0.3)?, Integration::Reduced)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let all = [Axis::X, Axis::Y, Axis::Z];
    let step = Step::new("pull")
        .fix("cube.left", &all)
        .pressure("cube.right", -1.0);
    // It gives up as soon as there is a matrix.
    let _ = driver.run(&step, 1, |_, _| {});
    let kept = kept.lock().map_err(|_| "poisoned")?.take();
    kept.ok_or_else(|| "no matrix".into())
}

/// Largest memory of the process so far \[MB\].
fn memory() -> f64 {
    let table = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = table.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|l| l.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) / 1e3
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let cells: usize = arguments
        .next()
        .ok_or("how many cells along an edge?")?
        .parse()?;
    let low_rank: Option<f64> = arguments.next().map(|e| e.parse()).transpose()?;
    let low_rank = low_rank.filter(|&e| e > 0.0);
    let (pattern, values) = stiffness(cells)?;
    let options = Options {
        low_rank,
        metis: arguments.next().is_some_and(|order| order == "metis"),
        ..Options::default()
    };
    let before = memory();
    let team = Processes::begin(options).ok_or("MPI")?;
    let clock = Instant::now();
    let mut engine = team.engine(&pattern, None, true)?;
    let analysis = clock.elapsed().as_secs_f64();
    let Cost {
        entries,
        operations,
    } = engine.cost();
    let clock = Instant::now();
    engine.factorise(&values)?;
    let factorisation = clock.elapsed().as_secs_f64();
    // A solution that is known.
    let exact: Vec<f64> = (0..engine.size()).map(|i| (i as f64).sin()).collect();
    let mut matrix = Matrix::new(pattern);
    matrix.values_mut().1.copy_from_slice(&values);
    let zero = vec![0.0; exact.len()];
    let mut x: Vec<f64> = matrix.residual(&exact, &zero).iter().map(|f| -f).collect();
    let clock = Instant::now();
    engine.solve(&mut x)?;
    let solve = clock.elapsed().as_secs_f64();
    let error = x.iter().zip(&exact).map(|(x, e)| (x - e).abs());
    let error = error.fold(0.0, f64::max);
    let low_rank = low_rank.map_or("none".to_owned(), |e| format!("{e:.0e}"));
    println!(
        "{cells} cells, {} unknowns, {} entries of K, low rank {low_rank}: factor {entries:.3e} entries, \
         {operations:.3e} multiplications; analysis {analysis:.1} s, factorisation {factorisation:.1} s, \
         solve {solve:.2} s; memory {before:.0} MB before, {:.0} MB after; error {error:.1e}",
        exact.len(),
        values.len(),
        memory()
    );
    drop(engine);
    team.end();
    Ok(())
}
