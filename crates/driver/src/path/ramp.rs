//! A step under way: increments in sequence, halved where they fail; not the increment itself.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::error::ModelError;
use crate::model::load::{Loading, Step};
use crate::newton::control::Control;
use crate::path::increments::Increments;
use crate::report::collapse::Collapse;
use crate::report::{IncrementReport, Iteration};
use crate::saved::{Numbers, Saved};
use crate::settings::Nesting;
use crate::vector::SparseVector;
use crate::vector::largest;
use std::ops::ControlFlow;

/// A step under way: the loadings at both of its ends, and how far it has come.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp<const D: usize> {
    step: String,
    start: Loading<D>,
    end: Loading<D>,
    /// Times within the step at which the way from start to end bends, and the loadings there.
    knots: Vec<(f64, Loading<D>)>,
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
    /// Work of the loads at the end of the step on the displacements of the step so far \[N·mm\].
    work: f64,
    /// How the structure yielded to the loads in the last two increments, the last one first.
    yielded: [Option<Yielded>; 2],
    /// The load factor as an unknown, once that is what it takes.
    path: Option<Path>,
    /// Part of the step at which the body was found where it snaps to, until that is done.
    beyond: Option<f64>,
}

/// Stiffness against the loads of a step in an increment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Yielded {
    /// Mean of λ.
    factor: f64,
    /// Δλ over the work of the whole loads on the displacements of the increment \[1/(N·mm)\].
    stiffness: f64,
    /// That work \[N·mm\].
    work: f64,
}

impl Yielded {
    /// The increment from λ = `before` to `after`, in which the loads of the whole step do `work`
    /// \[N·mm\]; `None` where they do none.
    fn between(before: f64, after: f64, work: f64) -> Option<Self> {
        (work > 0.0).then(|| Self {
            factor: 0.5 * (before + after),
            stiffness: (after - before) / work,
            work,
        })
    }

    /// Whether λ rose in the first of two increments and fell in the last.
    fn passes_limit(first: Self, last: Self) -> bool {
        first.stiffness > 0.0 && last.stiffness < 0.0
    }

    /// Where two increments in a row tend to if λ = λ∞ − A/(w + w₀) over the work w: the square root of
    /// the stiffness is then linear in λ, and zero at λ∞. `None` where nothing yields.
    fn limit(first: Self, last: Self) -> Option<f64> {
        let roots = [first, last].map(|y| y.stiffness.sqrt());
        let softer = roots[1] < (1.0 - SOFTER) * roots[0] && last.factor > first.factor;
        softer.then(|| {
            let ahead = roots[1] / (roots[0] - roots[1]);
            last.factor + (last.factor - first.factor) * ahead
        })
    }
}

/// How the path of equilibria is followed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Path {
    /// Compliance of the spring that the loads are applied through \[N·mm\].
    compliance: f64,
    /// Motion of its far end in the next attempt \[N·mm\].
    length: f64,
    /// Δλ of the last increment.
    last: f64,
    /// The largest λ so far.
    peak: f64,
    /// [`Collapse::growth`] in the last increment; infinite before the first.
    growth: f64,
    /// How far its increments have moved the structure at most \[mm\].
    moved: f64,
    /// Whether that was the end.
    ended: bool,
}

/// Least relative loss of the root of the stiffness from which a limit load is estimated.
const SOFTER: f64 = 0.02;

/// Compliance of the spring, over that of the structure: small, to stay on the path where the
/// structure softens.
const SPRING: f64 = 1e-2;

/// Motion in an increment along a path of large strains, in sizes of the mesh, up to which it is doubled: the path
/// is to be seen.
const SEEN: f64 = 5e-3;

/// Part of the loads of a step that forces at its start are rounding below.
const NONE: f64 = 1e-9;

/// Part of the largest load that is left where a body that snaps takes leave of what pushes it.
const LEFT: f64 = 0.05;

/// Times that an increment is halved at most where a tool moves through a body.
const MOST_CUTS: usize = 30;

impl<const D: usize> Ramp<D> {
    /// Part of the step that has been done, in [0, 1].
    pub fn done(&self) -> f64 {
        self.done
    }

    /// Whether the step is done.
    pub fn is_done(&self) -> bool {
        self.whole >= self.increments.pieces()
    }
}

impl<const D: usize> Saved for Ramp<D> {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        self.start.visit(numbers)?;
        self.end.visit(numbers)?;
        for (_, loading) in &mut self.knots {
            loading.visit(numbers)?;
        }
        for count in [&mut self.whole, &mut self.easy, &mut self.cuts] {
            numbers.count(count)?;
        }
        let (done, length) = (&mut self.done, &mut self.length);
        for value in [done, length, &mut self.plastic_fraction, &mut self.work] {
            numbers.value(value)?;
        }
        for yielded in &mut self.yielded {
            numbers.option(yielded, Yielded::default, |y, numbers| {
                numbers.value(&mut y.factor)?;
                numbers.value(&mut y.work)?;
                numbers.value(&mut y.stiffness)
            })?;
        }
        numbers.option(&mut self.path, Path::default, |path, numbers| {
            let (compliance, length) = (&mut path.compliance, &mut path.length);
            let (last, peak) = (&mut path.last, &mut path.peak);
            let (growth, moved) = (&mut path.growth, &mut path.moved);
            for value in [compliance, length, last, peak, growth, moved] {
                numbers.value(value)?;
            }
            numbers.flag(&mut path.ended)
        })?;
        numbers.option(
            &mut self.beyond,
            || 0.0,
            |beyond, numbers| numbers.value(beyond),
        )
    }
}

impl<const D: usize> Ramp<D> {
    /// The loading at a time of the step, in [0, 1].
    fn at(&self, time: f64) -> Loading<D> {
        let next = self.knots.iter().position(|(knot, _)| time <= *knot);
        let last = next.unwrap_or(self.knots.len()).checked_sub(1);
        let (from, start) =
            last.map_or((0.0, &self.start), |k| (self.knots[k].0, &self.knots[k].1));
        let (to, end) = next.map_or((1.0, &self.end), |k| (self.knots[k].0, &self.knots[k].1));
        start.towards(end, (time - from) / (to - from))
    }

    /// Where the next attempt ends, and whether an equal piece of the step ends there.
    fn target(&self) -> (f64, bool) {
        let pieces = self.increments.pieces();
        let base = 1.0 / pieces as f64;
        let tiny = 1e-9 * base;
        let next = match self.whole + 1 >= pieces {
            true => 1.0,
            false => (self.whole + 1) as f64 * base,
        };
        let reach = self.done + self.length;
        let knots = self.knots.iter().map(|(knot, _)| *knot);
        let knot = knots.into_iter().find(|knot| *knot > self.done + tiny);
        let at_end = reach >= next - tiny;
        match knot {
            // One that all but coincides with the end of a piece is that.
            Some(knot) if (knot - next).abs() <= tiny && at_end => (next, true),
            Some(knot) if knot < next && reach >= knot - tiny => (knot, false),
            _ if at_end => (next, true),
            _ => (reach, false),
        }
    }

    /// Whether forces other than by rounding are there at the start.
    fn begins_under_forces(&self) -> bool {
        let most = |loading: &Loading<D>| largest(loading.force.iter().map(|(_, f)| f));
        most(&self.start) > NONE * most(&self.end)
    }

    /// Whether something that the step prescribes is moved.
    fn moves(&self) -> bool {
        let to = self.knots.iter().map(|(_, loading)| loading);
        to.chain([&self.end])
            .any(|to| self.start.displacement != to.displacement || self.start.turn != to.turn)
    }

    /// Whether the temperature of something changes.
    fn heats(&self) -> bool {
        let to = self.knots.iter().map(|(_, loading)| loading);
        to.chain([&self.end])
            .any(|to| self.start.temperature != to.temperature)
    }

    /// Takes note of an increment from λ = `before`, and of the work that the loads of the whole step
    /// did in it.
    fn converged(&mut self, report: &IncrementReport, before: f64, work: f64) {
        let yielded = Yielded::between(before, report.fraction, work);
        self.yielded = [yielded, self.yielded[0]];
        self.cuts = 0;
        self.plastic_fraction = report.plastic_fraction;
        self.work += work;
    }

    /// The load factor that the last two increments tend to, no less than what was reached; `None` where
    /// nothing yields, or something is moved or heated.
    fn estimated_limit(&self) -> Option<f64> {
        let [Some(last), Some(first)] = self.yielded else {
            return None;
        };
        let straight = self.knots.is_empty() && !self.moves() && !self.heats();
        let limit = Yielded::limit(first, last).filter(|_| straight);
        limit.map(|limit| limit.max(self.done))
    }

    /// The error of a step that has been cut as far as allowed, after a last attempt in whose last iterate a part of the
    /// volume flows: what no increment before has made flow may be why there is no other.
    fn stopped(&self, cause: IncrementError, smallest: f64, flows: f64) -> IncrementError {
        let plastic_fraction = match &cause {
            IncrementError::NotConverged {
                plastic_fraction, ..
            } => *plastic_fraction,
            _ => flows,
        };
        let plastic_fraction = plastic_fraction.max(self.plastic_fraction);
        IncrementError::Stopped {
            step: self.step.clone(),
            reached: self.done,
            smallest,
            plastic_fraction,
            limit: self.estimated_limit(),
            moves: self.moves(),
            cause: Box::new(cause),
        }
    }
}

impl<const D: usize> Driver<D> {
    /// Begins a step in a number of equal increments or in [`Increments`]; none is applied yet.
    ///
    /// # Errors
    /// See [`Driver::loading`]; [`ModelError::OutOfRange`] for increments that are no parts of a step.
    pub fn begin(
        &self,
        step: &Step<D>,
        increments: impl Into<Increments>,
    ) -> Result<Ramp<D>, ModelError> {
        let end = self.loading(step)?;
        let increments = increments.into();
        increments.check()?;
        let start = self.start_of(&end);
        Ok(Ramp {
            step: step.name.clone(),
            knots: self.knots(step, [&start, &end])?,
            start,
            end,
            increments,
            whole: 0,
            done: 0.0,
            length: increments.start,
            easy: 0,
            cuts: 0,
            plastic_fraction: 0.0,
            work: 0.0,
            yielded: [None; 2],
            path: None,
            beyond: None,
        })
    }

    /// Applies the next increment of a step, halving it as often as it takes, and doubling again
    /// after one that converges, as [`Increments`] say; `watch` sees every iterate of every attempt, and may break
    /// it off there: the next call goes on as if it had not.
    ///
    /// Where only loads grow and an increment of theirs fails, their factor becomes an unknown: the
    /// step goes along the path of equilibria, on to its end or to collapse.
    /// [`IncrementReport::fraction`] is then that factor.
    ///
    /// # Errors
    /// [`IncrementError::Collapse`] where displacements grow at a constant load, and
    /// [`IncrementError::RunsAway`] where they grow with a load that does, [`IncrementError::SnapsAway`] where they lead away
    /// from what pushes;
    /// [`IncrementError::Stopped`] when the increment has been halved as often as the settings allow;
    /// what converged before is kept. [`IncrementError::Model`] for a step that makes no sense;
    /// [`IncrementError::Interrupted`] where `watch` breaks off, and [`IncrementError::Law`] where a law does.
    pub fn proceed(
        &mut self,
        ramp: &mut Ramp<D>,
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        // One that was read may be of another model.
        self.check_loading(&ramp.start)?;
        self.check_loading(&ramp.end)?;
        for (_, loading) in &ramp.knots {
            self.check_loading(loading)?;
        }
        let (before, at_hand) = (ramp.clone(), self.at_hand());
        let outcome = self.attempts(ramp, watch);
        if outcome.as_ref().is_err_and(IncrementError::is_broken_off) {
            *ramp = before;
            self.put_back(at_hand)?;
        }
        outcome
    }

    /// The next increment: attempts until one converges or none may follow.
    fn attempts(
        &mut self,
        ramp: &mut Ramp<D>,
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        let mut may_leap = false;
        loop {
            if let Some(path) = ramp.path {
                return self.follow(ramp, path, watch);
            }
            self.may_leap = may_leap;
            let (target, at_end) = ramp.target();
            let loading = ramp.at(target);
            let cuts = ramp.cuts;
            let watch = &mut |i: &Iteration<'_>| watch(&Iteration { cuts, ..*i });
            match self.advance_watched(&loading, watch) {
                Ok(mut report) => {
                    report.fraction = target;
                    report.cuts = cuts;
                    let before = std::mem::replace(&mut ramp.done, target);
                    ramp.beyond = ramp.beyond.filter(|beyond| *beyond > target);
                    ramp.whole += usize::from(at_end);
                    let iterations = report.newton_iterations;
                    ramp.length = ramp
                        .increments
                        .next(ramp.length, &mut ramp.easy, iterations);
                    ramp.converged(&report, before, self.last_work(&self.load(ramp)));
                    return Ok(report);
                }
                Err(error) if error.is_final() => return Err(error),
                Err(cause) => {
                    if let Some(gap) = self.overlap_at_start(&ramp.at(ramp.done), &loading) {
                        let cause = self.overlapping(&gap, cause);
                        let (length, flows) = (target - ramp.done, self.plastic_fraction());
                        return Err(ramp.stopped(cause, length, flows));
                    }
                    // Halved exactly, and until it is not what has just failed.
                    ramp.length *= 0.5;
                    while ramp.length >= (1.0 - 1e-9) * (target - ramp.done) {
                        ramp.length *= 0.5;
                    }
                    ramp.cuts += 1;
                    // How far contact can follow is known, and shorter increments get there.
                    let follows = matches!(
                        cause,
                        IncrementError::Passage { .. }
                            | IncrementError::Turn { .. }
                            | IncrementError::Within { .. }
                    );
                    let cuts = if follows {
                        MOST_CUTS
                    } else {
                        self.settings.cuts
                    };
                    let fewest = ramp.increments.start * 0.5f64.powi(cuts as i32);
                    let smallest = ramp.increments.min.unwrap_or(fewest);
                    ramp.path = self.path(ramp).filter(|_| !follows);
                    if matches!(cause, IncrementError::Snap { .. }) && ramp.moves() {
                        ramp.beyond = Some(target);
                    }
                    if ramp.path.is_none() && ramp.length < smallest {
                        // No shorter one leads on: the body leaps to where it was found.
                        if let Some(beyond) = ramp.beyond.take() {
                            (may_leap, ramp.length) = (true, beyond - ramp.done);
                            continue;
                        }
                        let stopped =
                            ramp.stopped(cause, 2.0 * ramp.length, self.plastic_fraction());
                        return Err(self.out_of_hand(ramp, stopped));
                    }
                }
            }
        }
    }

    /// Why a step stopped: a tool that nothing holds, or that friction holds no further, if there is one.
    fn out_of_hand(&self, ramp: &Ramp<D>, stopped: IncrementError) -> IncrementError {
        let is_singular = |error: &IncrementError| match error {
            IncrementError::Stopped { cause, .. } => cause.is_singular(),
            _ => false,
        };
        let loose = self.loose_tool(&ramp.end).or_else(|| {
            is_singular(&stopped)
                .then(|| self.spinning_tool(&ramp.end))
                .flatten()
        });
        let loose = loose.or_else(|| self.slipping_tool(&ramp.end));
        loose.map_or(stopped, Into::into)
    }

    /// The loads of a whole step, where the body is now \[N\].
    fn load(&self, ramp: &Ramp<D>) -> SparseVector {
        let rest = vec![0.0; self.state.displacement.len()];
        self.nodal_forces(&ramp.end.increment_from(&ramp.start), &rest)
    }

    /// The path of a step that moves nothing and whose loads grow by one factor, from after its first increment on.
    fn path(&self, ramp: &Ramp<D>) -> Option<Path> {
        let moves = ramp.moves() || ramp.heats() || !ramp.knots.is_empty();
        let (last, before) = self.state.last.as_ref()?;
        let rest = vec![0.0; last.len()];
        let load = self.load(ramp);
        let square = load.inner(&load);
        if moves
            || self.settings.nesting != Nesting::Inside
            || !(ramp.done > 0.0 && square > 0.0 && ramp.work > 0.0)
        {
            return None;
        }
        let factor = self.nodal_forces(before, &rest).inner(&load) / square;
        let compliance = SPRING * ramp.work / ramp.done;
        let length = load.dot(last) + compliance * factor;
        (length > 0.0).then_some(Path {
            compliance,
            length,
            last: factor,
            peak: ramp.done,
            growth: f64::INFINITY,
            moved: 0.0,
            ended: false,
        })
    }

    /// What a path that has ended is: collapse, or one that still rises.
    fn ended(&self, ramp: &Ramp<D>, path: &Path, load: &SparseVector) -> IncrementError {
        let step = ramp.step.clone();
        let collapse = Collapse {
            load_factor: path.peak,
            added: ramp.begins_under_forces(),
            growth: path.growth,
            upper_bound: self.upper_bound(load, ramp.done),
        };
        match collapse.runs_away() {
            true => IncrementError::RunsAway {
                step,
                factor: ramp.done,
                growth: path.growth,
            },
            false => IncrementError::Collapse { step, collapse },
        }
    }

    /// Applies the next increment along a path, halved as often as it takes.
    fn follow(
        &mut self,
        ramp: &mut Ramp<D>,
        mut path: Path,
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        let load = self.load(ramp);
        let grows = ramp.end.increment_from(&ramp.start);
        if path.ended {
            return Err(self.ended(ramp, &path, &load));
        }
        // Where nothing presses any more what follows is the way of the tool alone.
        if ramp.done < LEFT * path.peak && self.is_let_go() {
            return Err(IncrementError::SnapsAway {
                step: ramp.step.clone(),
                limit: path.peak,
            });
        }
        let mut halved = 0;
        loop {
            let mut control = Control {
                factor: ramp.done,
                grows: &grows,
                load: &load,
                start: ramp.done,
                last: path.last,
                compliance: path.compliance,
                length: path.length,
            };
            let cuts = ramp.cuts;
            let watch = &mut |i: &Iteration<'_>| watch(&Iteration { cuts, ..*i });
            let mut outcome = self.advance_along(&mut control, watch);
            let done = control.factor;
            if let Ok(None) = outcome {
                // The path passes the end of the step: to the end, then.
                let end = ramp.end.clone();
                outcome = self.advance_watched(&end, watch).map(|mut report| {
                    report.fraction = 1.0;
                    ramp.whole = ramp.increments.pieces();
                    Some(report)
                });
            } else if let Ok(Some(report)) = &mut outcome {
                report.fraction = done;
            }
            match outcome {
                Ok(Some(mut report)) => {
                    report.cuts = cuts;
                    let work = self.last_work(&load);
                    let before = std::mem::replace(&mut ramp.done, report.fraction);
                    ramp.converged(&report, before, work);
                    if self.has_large_strains()
                        && let [Some(last), Some(first)] = ramp.yielded
                        && Yielded::passes_limit(first, last)
                    {
                        report.limit = Some(before);
                        report.mode = self.path_mode();
                    }
                    path.last = report.fraction - before;
                    path.peak = path.peak.max(report.fraction);
                    path.growth = path.last * (ramp.work / work).abs() / path.peak;
                    let size = self.mesh.size();
                    path.moved += self.last_motion();
                    // Where strains are large, loads may fall and rise again.
                    let flat = path.growth <= Collapse::FLAT && !self.has_large_strains();
                    let is_far = path.moved > size || self.tools_motion() > size;
                    let rises = self.has_large_strains() && path.growth > Collapse::SLOW[0];
                    path.ended = flat || is_far && !rises;
                    let easy = report.newton_iterations <= 2 * Increments::EASY && halved == 0;
                    if easy && !(self.has_large_strains() && self.last_motion() > SEEN * size) {
                        path.length *= 2.0;
                    }
                    ramp.path = Some(path);
                    return Ok(report);
                }
                Err(error) if error.is_final() => return Err(error),
                Ok(None) => {}
                Err(cause)
                    if ramp.done < LEFT * path.peak
                        && (cause.is_singular() || self.loose_tool(&ramp.end).is_some()) =>
                {
                    return Err(IncrementError::SnapsAway {
                        step: ramp.step.clone(),
                        limit: path.peak,
                    });
                }
                Err(cause) => {
                    path.length *= 0.5;
                    ramp.path = Some(path);
                    ramp.cuts += 1;
                    halved += 1;
                    if halved > self.settings.cuts {
                        let stopped = ramp.stopped(cause, path.last.abs(), self.plastic_fraction());
                        return Err(self.out_of_hand(ramp, stopped));
                    }
                }
            }
        }
    }

    /// Largest displacement of the last increment \[mm\].
    fn last_motion(&self) -> f64 {
        let last = self.state.last.as_ref();
        last.map_or(0.0, |(d_u, _)| {
            largest(d_u[..self.mesh_dofs()].iter().copied())
        })
    }

    /// Largest motion of a driven tool in the last increment, of its turn at the size of the mesh \[mm\].
    fn tools_motion(&self) -> f64 {
        let driven = |dof: &usize| !self.state.loading.displacement.contains_key(dof);
        let tools = (self.mesh_dofs()..self.state.displacement.len()).filter(driven);
        let last = self.state.last.as_ref();
        last.map_or(0.0, |(d_u, _)| largest(tools.map(|dof| d_u[dof])))
    }

    /// Work of loads on the displacements of the last increment \[N·mm\].
    fn last_work(&self, load: &SparseVector) -> f64 {
        self.state
            .last
            .as_ref()
            .map_or(0.0, |(d_u, _)| load.dot(d_u))
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
        mut observe: impl FnMut(&Self, &IncrementReport),
    ) -> Result<Vec<IncrementReport>, IncrementError> {
        let mut ramp = self.begin(step, increments)?;
        let mut reports = Vec::new();
        while !ramp.is_done() {
            let report = self.proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))?;
            observe(self, &report);
            reports.push(report);
        }
        Ok(reports)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// λ = 1 − A/(w + w₀) in three steps of λ, whose ends and not whose means would be a hundredth off.
    #[test]
    fn two_increments_of_a_hyperbola_tend_to_its_limit() {
        let (a, w0) = (0.6, 0.9);
        let work = |factor: f64| a / (1.0 - factor) - w0;
        let of = |before: f64, after: f64| {
            Yielded::between(before, after, work(after) - work(before)).expect("work is done")
        };
        let limit = Yielded::limit(of(0.70, 0.72), of(0.72, 0.74)).expect("it yields");
        assert!((limit - 1.0).abs() < 1e-3, "{limit}");
        assert!(!Yielded::passes_limit(of(0.70, 0.72), of(0.72, 0.74)));
        assert_eq!(Yielded::between(0.2, 0.4, 0.0), None);
        let elastic = Yielded::between(0.0, 0.2, 3.0).expect("work is done");
        assert_eq!(Yielded::limit(elastic, elastic), None);
    }
}
