//! Seconds of the processor, which a loaded machine does not spoil as it does those of the wall.

use std::time::Duration;

use cpu_time::ThreadTime;

/// Seconds over which a short solution is repeated; the fastest counts.
pub const REPEAT: f64 = 0.05;

/// Processor time of this thread, on which all methods run, less what looking at the clock takes.
pub struct Clock {
    cost: Duration,
}

impl Clock {
    /// A clock that knows what a look at it costs.
    pub fn new() -> Self {
        let cost = || ThreadTime::now().elapsed();
        let least = (0..1000).map(|_| cost()).min().unwrap_or_default();
        let cost = least.max(Duration::from_nanos(1));
        Self { cost }
    }

    /// Seconds of a computation, no fewer than a look at the clock takes, and its result: nothing takes
    /// no time, and no ratio of two times is infinite.
    pub fn time<T>(&self, compute: impl FnOnce() -> T) -> (f64, T) {
        let start = ThreadTime::now();
        let result = compute();
        let spent = start.elapsed();
        let own = spent.saturating_sub(self.cost).max(self.cost);
        (own.as_secs_f64(), result)
    }

    /// The fastest of several runs of a computation that tells its own seconds, and its last result.
    pub fn fastest<T>(&self, mut compute: impl FnMut() -> (f64, T)) -> (f64, T) {
        let begin = ThreadTime::now();
        let mut least = f64::INFINITY;
        loop {
            let (seconds, result) = compute();
            least = least.min(seconds);
            if begin.elapsed().as_secs_f64() > REPEAT {
                return (least, result);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_computes_takes_time() {
        let clock = Clock::new();
        let (seconds, sum) =
            clock.time(|| (0..10_000_000).fold(0.0, |s: f64, k| s + f64::sqrt(k.into())));
        assert!(seconds > 0.0 && sum > 0.0);
        assert!((0..1000).all(|_| clock.time(|| ()).0 > 0.0));
        let mut left = vec![2.0, 1.0, 3.0];
        let (least, last) = clock.fastest(|| {
            std::hint::black_box((0..1_000_000).map(f64::from).sum::<f64>());
            (left.pop().unwrap_or(4.0), left.len())
        });
        assert!(least == 1.0 && last == 0);
    }
}
