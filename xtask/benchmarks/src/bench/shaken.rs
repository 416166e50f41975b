//! What a rounding error may cost: the same run on coordinates that differ in their last digits.

use std::error::Error;
use std::time::Instant;

use moreau::driver::Settings;
use verification::paper;

/// Relative size of the differences.
const SIZE: f64 = 1e-13;

/// Prints the fastest, the median and the slowest of some runs of every size, with what the slowest
/// took; false if it took ten times the median.
pub(super) fn run(
    sizes: &[[usize; 2]],
    (friction, increments): (f64, usize),
    runs: u64,
) -> Result<bool, Box<dyn Error>> {
    let mut steady = true;
    for &cells in sizes {
        let mut all = Vec::new();
        for seed in 0..runs.max(1) {
            let clock = Instant::now();
            let mut driver =
                paper::shaken_block(cells, friction, (seed, SIZE), Settings::default())?;
            let reports = driver.run(&super::press(increments), increments, |_, _| {})?;
            let newton: usize = reports.iter().map(|r| r.newton_iterations).sum();
            let contact: usize = reports.iter().map(|r| r.contact_iterations).sum();
            let cuts: usize = reports.iter().map(|r| r.cuts).sum();
            all.push((clock.elapsed().as_secs_f64(), seed, newton, contact, cuts));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let median = all[all.len() / 2].0;
        let (worst, seed, newton, contact, cuts) = all[all.len() - 1];
        let most = all.iter().map(|r| r.3).max().unwrap_or(0);
        println!(
            "{}x{} friction {friction}: {} runs, fastest {:.3} s, median {median:.3} s, slowest \
             {worst:.3} s (seed {seed}: {newton} Newton iterations, {contact} of the contact, {cuts} \
             cuts); at most {most} iterations of the contact",
            cells[0],
            cells[1],
            all.len(),
            all[0].0,
        );
        steady &= worst < 10.0 * median;
    }
    Ok(steady)
}
