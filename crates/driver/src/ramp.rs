//! A step under way: increments in sequence, halved where they fail; not the increment itself.

use crate::ModelError;
use crate::driver::Driver;
use crate::error::StepError;
use crate::increments::Increments;
use crate::load::{Loading, Step};
use crate::report::{Iteration, StepReport};
use crate::saved::{Reader, write_loading};

/// A step under way: the loadings at both of its ends, and how far it has come.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp<const D: usize> {
    step: String,
    start: Loading<D>,
    end: Loading<D>,
    increments: Increments,
    /// Equal pieces done: counted, so that their ends are exact multiples of the base.
    whole: usize,
    done: f64,
    /// Length of the next attempt.
    length: f64,
    /// Easy increments in a row.
    easy: usize,
    /// Times that the next increment has been halved.
    cuts: usize,
    /// Plastic fraction of the last converged increment.
    plastic_fraction: f64,
}

impl<const D: usize> Ramp<D> {
    /// Part of the step that has been done, in [0, 1].
    pub fn done(&self) -> f64 {
        self.done
    }

    /// Whether the step is done.
    pub fn is_done(&self) -> bool {
        self.whole >= self.increments.pieces()
    }

    /// Appends all that [`Ramp::read`] needs.
    pub fn write(&self, out: &mut Vec<f64>) {
        write_loading(&self.start, out);
        write_loading(&self.end, out);
        out.extend([self.whole as f64, self.done, self.length]);
        out.extend([self.easy as f64, self.cuts as f64, self.plastic_fraction]);
    }

    /// The ramp of a step in the increments that it began with, as [`Ramp::write`] left it.
    ///
    /// # Errors
    /// [`ModelError::Saved`] for numbers that are too few.
    pub fn read(
        step: &Step<D>,
        increments: Increments,
        from: &mut Reader<'_>,
    ) -> Result<Self, ModelError> {
        Ok(Self {
            step: step.name.clone(),
            start: from.loading()?,
            end: from.loading()?,
            increments,
            whole: from.count()?,
            done: from.number()?,
            length: from.number()?,
            easy: from.count()?,
            cuts: from.count()?,
            plastic_fraction: from.number()?,
        })
    }
}

impl<const D: usize> Driver<D> {
    /// Begins a step in a number of equal increments or in [`Increments`]; none is applied yet.
    ///
    /// # Errors
    /// See [`Driver::loading`].
    pub fn begin(
        &self,
        step: &Step<D>,
        increments: impl Into<Increments>,
    ) -> Result<Ramp<D>, ModelError> {
        let end = self.loading(step)?;
        let increments = increments.into();
        Ok(Ramp {
            step: step.name.clone(),
            start: self.start_of(&end),
            end,
            increments,
            whole: 0,
            done: 0.0,
            length: increments.start,
            easy: 0,
            cuts: 0,
            plastic_fraction: 0.0,
        })
    }

    /// Applies the next increment of a step, halving it as often as it takes, and doubling again
    /// after one that converges, as [`Increments`] say; `watch` sees every iterate of every attempt.
    ///
    /// # Errors
    /// [`StepError::Stopped`] when the increment has been halved as often as the settings allow;
    /// what converged before is kept. [`StepError::Model`] for a step that makes no sense.
    pub fn proceed(
        &mut self,
        ramp: &mut Ramp<D>,
        watch: &mut dyn FnMut(&Iteration<'_>),
    ) -> Result<StepReport, StepError> {
        let pieces = ramp.increments.pieces();
        let base = 1.0 / pieces as f64;
        let fewest = ramp.increments.start * 0.5f64.powi(self.settings.cuts as i32);
        let smallest = ramp.increments.min.unwrap_or(fewest);
        loop {
            let next = (ramp.whole + 1) as f64 * base;
            let at_end = ramp.done + ramp.length >= next - 1e-9 * base;
            let target = match at_end {
                true if ramp.whole + 1 >= pieces => 1.0,
                true => next,
                false => ramp.done + ramp.length,
            };
            let loading = ramp.start.towards(&ramp.end, target);
            let cuts = ramp.cuts;
            let watch = &mut |i: &Iteration<'_>| watch(&Iteration { cuts, ..*i });
            match self.advance_watched(&loading, watch) {
                Ok(mut report) => {
                    report.fraction = target;
                    report.cuts = cuts;
                    ramp.done = target;
                    ramp.whole += usize::from(at_end);
                    let iterations = report.newton_iterations;
                    ramp.length = ramp
                        .increments
                        .next(ramp.length, &mut ramp.easy, iterations);
                    ramp.cuts = 0;
                    ramp.plastic_fraction = report.plastic_fraction;
                    return Ok(report);
                }
                Err(error @ StepError::Model(_)) => return Err(error),
                Err(cause) => {
                    // Halved exactly, and until it is not what has just failed.
                    ramp.length *= 0.5;
                    while ramp.length >= (1.0 - 1e-9) * (target - ramp.done) {
                        ramp.length *= 0.5;
                    }
                    ramp.cuts += 1;
                    if ramp.length < smallest {
                        let last = ramp.plastic_fraction;
                        let plastic_fraction = match &cause {
                            StepError::NotConverged {
                                plastic_fraction, ..
                            } => plastic_fraction.max(last),
                            _ => last,
                        };
                        return Err(StepError::Stopped {
                            step: ramp.step.clone(),
                            reached: ramp.done,
                            smallest: 2.0 * ramp.length,
                            plastic_fraction,
                            cause: Box::new(cause),
                        });
                    }
                }
            }
        }
    }

    /// Applies a step in a number of equal increments or in [`Increments`] to its end, as [`Driver::proceed`] does. `observe` sees
    /// the driver after every converged increment.
    ///
    /// # Errors
    /// See [`Driver::begin`] and [`Driver::proceed`].
    pub fn run(
        &mut self,
        step: &Step<D>,
        increments: impl Into<Increments>,
        mut observe: impl FnMut(&Self, &StepReport),
    ) -> Result<Vec<StepReport>, StepError> {
        let mut ramp = self.begin(step, increments)?;
        let mut reports = Vec::new();
        while !ramp.is_done() {
            let report = self.proceed(&mut ramp, &mut |_| {})?;
            observe(self, &report);
            reports.push(report);
        }
        Ok(reports)
    }
}
