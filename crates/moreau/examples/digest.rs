//! Runs decks in memory and prints a number for each that stands for every bit of its state: two builds that print the
//! same computed the same. With threads and without,
//!
//! ```text
//! cargo run --release -p moreau --example digest -- docs/examples/*.toml
//! cargo run --release -p moreau --no-default-features --features decks --example digest -- docs/examples/*.toml
//! ```

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
        let digest = simulation
            .save()
            .iter()
            .fold(0xcbf2_9ce4_8422_2325, |h: u64, b| {
                (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3)
            });
        println!(
            "{digest:016x} {:4} increments {}",
            simulation.increments(),
            path.display()
        );
    }
    Ok(())
}
