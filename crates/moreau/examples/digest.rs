//! Runs decks in memory and prints a number for each that stands for every bit of its displacements, of the fields at
//! its points and of its tables: two builds that print the same computed the same. With threads and without,
//!
//! ```text
//! cargo run --release -p moreau --example digest -- docs/examples/*.toml
//! cargo run --release -p moreau --no-default-features --features decks --example digest -- docs/examples/*.toml
//! ```

// A program, not a library: it prints.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use moreau::deck::Given;
use moreau::driver::threads;
use moreau::simulation::Simulation;
use std::ops::ControlFlow;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    eprintln!("threads: {}", threads());
    for path in std::env::args().skip(1) {
        let path = Path::new(&path);
        let text = std::fs::read_to_string(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let (simulation, findings) = Simulation::open(&text, folder, &Given::default());
        let Some(mut simulation) = simulation else {
            return Err(findings
                .render(&path.to_string_lossy(), &text, false)
                .into());
        };
        // Where it does not go on, its state is that of what converged.
        while let Ok(Some(_)) = simulation.advance(&mut |_, _| ControlFlow::Continue(())) {}
        let digest = digest(&simulation);
        println!(
            "{digest:016x} {:4} increments {}",
            simulation.increments(),
            path.display()
        );
    }
    Ok(())
}

/// By the sum of Fowler, Noll and Vo.
fn digest(simulation: &Simulation) -> u64 {
    let points = simulation.points().point_data;
    let values = points.iter().flat_map(|field| &field.values);
    let numbers = simulation.displacements().iter().chain(values);
    let mut bytes: Vec<u8> = numbers.flat_map(|number| number.to_le_bytes()).collect();
    for table in [simulation.history(), &simulation.contacts()] {
        for row in 0..table.rows() {
            bytes.extend(table.line(row).into_bytes());
        }
    }
    let add = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, add)
}
