//! Which cases run at the same time; not what one of them does.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use verification::Case;

use super::Setting;
use super::execute::{Run, execute};
use super::progress::Board;

/// Runs the cases, as many at a time as there are threads; one that compares times runs when nothing else does. Tells of each as it ends, and returns them in the order in which they were given.
///
/// # Errors
/// What `tell` returns; cases that have not begun then never do.
pub fn run<'a, E>(
    cases: &[&'a Case],
    setting: Setting,
    board: &Board,
    mut tell: impl FnMut(&Run<'a>) -> Result<(), E>,
) -> Result<Vec<Run<'a>>, E> {
    // What stands late in the report takes longest, and begins first.
    let (alone, beside): (Vec<usize>, Vec<usize>) =
        (0..cases.len()).rev().partition(|&i| cases[i].alone);
    let mut runs: Vec<(usize, Run<'a>)> = Vec::with_capacity(cases.len());
    for (turn, threads) in [(beside, setting.threads), (alone, 1)] {
        let next = AtomicUsize::new(0);
        let worker = |ended: mpsc::Sender<(usize, Run<'a>)>| {
            while let Some(&i) = turn.get(next.fetch_add(1, Ordering::Relaxed)) {
                let run = execute(cases[i], setting.quick, board.case(cases[i].name));
                if ended.send((i, run)).is_err() {
                    break;
                }
            }
        };
        thread::scope(|scope| {
            let (sender, ended) = mpsc::channel();
            for _ in 0..threads.min(turn.len()) {
                let sender = sender.clone();
                scope.spawn(|| worker(sender));
            }
            drop(sender);
            for (i, run) in ended {
                board.pause(|| tell(&run))?;
                runs.push((i, run));
            }
            Ok(())
        })?;
    }
    runs.sort_by_key(|&(i, _)| i);
    Ok(runs.into_iter().map(|(_, run)| run).collect())
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::error::Error;
    use std::sync::atomic::AtomicBool;

    use verification::{Options, Outcome};

    use super::*;
    use crate::verify::samples;

    const THREADS: Setting = Setting {
        quick: true,
        threads: 3,
    };

    #[test]
    fn the_order_of_the_report_is_that_of_the_cases() {
        let cases = samples::cases();
        let cases: Vec<_> = cases.iter().collect();
        let mut told = 0;
        let runs = run(&cases, THREADS, &Board::Silent, |_| {
            told += 1;
            Ok::<_, Infallible>(())
        });
        let names: Vec<_> = runs.unwrap().iter().map(|run| run.case.name).collect();
        assert_eq!(names, cases.iter().map(|c| c.name).collect::<Vec<_>>());
        assert_eq!(told, cases.len());
    }

    #[test]
    fn nothing_runs_beside_a_case_that_compares_times() {
        static RUNNING: AtomicBool = AtomicBool::new(false);
        static MET: AtomicBool = AtomicBool::new(false);
        fn working(_: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
            let met = RUNNING.swap(true, Ordering::SeqCst);
            MET.fetch_or(met, Ordering::SeqCst);
            thread::sleep(std::time::Duration::from_millis(20));
            RUNNING.store(false, Ordering::SeqCst);
            Ok(Outcome::default())
        }
        let alone = || Case {
            alone: true,
            run: working,
            ..samples::cases().swap_remove(0)
        };
        let cases = [alone(), samples::cases().swap_remove(0), alone()];
        let cases: Vec<_> = cases.iter().collect();
        run(&cases, THREADS, &Board::Silent, |_| Ok::<_, Infallible>(())).unwrap();
        assert!(!MET.load(Ordering::SeqCst));
    }

    #[test]
    fn a_terminal_that_is_gone_ends_the_run() {
        let cases = samples::cases();
        let cases: Vec<_> = cases.iter().collect();
        let ended = run(&cases, THREADS, &Board::Silent, |_| Err("gone"));
        assert_eq!(ended.err(), Some("gone"));
    }
}
