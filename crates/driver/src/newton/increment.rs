//! One increment by Newton's method with the contact problem solved inside every iteration; not
//! the sequence of increments.

use crate::assembly::cell_law::Stiffness;
use crate::driver::Driver;
use crate::error::IncrementError;
use crate::interface::tied::Held;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::newton::chord::Chord;
use crate::newton::control::Control;
use crate::newton::descent::{TERMS, stiffer};
use crate::newton::iterate::{Candidate, Iterate};
use crate::newton::line_search::NewtonStep;
use crate::newton::linearised::{Answer, Linearised};
use crate::newton::tangent::STIFFENED;
use crate::newton::tangent::Turning;
use crate::report::Iteration;
use crate::report::counts::Counts;
use crate::vector::{SparseVector, largest};
use moreau_contact::{ContactError, ContactSolution};
use std::borrow::Cow;
use std::ops::ControlFlow;

/// Part of the tolerance at which an increment with tied contacts is accepted as long as steps make the
/// residual smaller.
const WELL: f64 = 0.1;

/// Imbalance over the forces in play, from which on a tangent that is not positive definite leads nowhere.
const FAR: f64 = 0.1;

/// Iterations in which the residual is not halved, after which steps have to go downhill.
const STRAYING: usize = 4;

/// An increment on its way from one loading to another.
pub(crate) struct Increment<'a, 'c, const D: usize> {
    pub(crate) start: &'a Loading<D>,
    /// Under control a guess, as the displacements are.
    end: Cow<'a, Loading<D>>,
    control: Option<&'a mut Control<'c, D>>,
    pub(crate) iterate: Iterate,
    /// Prescribed displacements that the iterate does not have, and the next step makes up for \[mm\].
    pub(crate) missing: SparseVector,
    /// The last solution of the contact problem.
    pub(crate) solution: Option<ContactSolution<D>>,
    chord: Chord,
    held: Held<D>,
    /// Iterations in which the residual has to be halved, where there are other ways to try.
    pub(crate) patience: Option<usize>,
    /// Whether nothing holds a body at the equilibrium that is looked for, which is then the nearest.
    pub(crate) loose: bool,
    pub(crate) counts: Counts,
}

/// How far an iterate is from balance.
struct Balance<const D: usize> {
    /// Of the contact points, where the prescribed displacements have arrived.
    kinematics: Vec<Kinematics<D>>,
    /// At every degree of freedom \[N\]; zero at those prescribed.
    residual: Vec<f64>,
    /// Its largest entry \[N\].
    largest: f64,
    /// Size of the forces in play \[N\].
    scale: f64,
    /// The largest entry at which the increment is accepted \[N\].
    accepted: f64,
}

impl<'a, 'c, const D: usize> Increment<'a, 'c, D> {
    /// Whether the iterate has all prescribed displacements.
    fn has_arrived(&self) -> bool {
        self.missing.is_zero()
    }

    /// Whether the next step moves tools: the first, where some are prescribed to move.
    fn moves_tools(&self, first_tool: usize) -> bool {
        let (start, end) = (&self.start.displacement, &self.end.displacement);
        let moves = !start.range(first_tool..).eq(end.range(first_tool..));
        self.counts.newton == 1 && (moves || self.start.turn != self.end.turn)
    }

    /// Takes note of what the system did since `before`, its counts at the start.
    pub(crate) fn count(&mut self, system: &System) {
        let (factorisations, conjugate) = self.counts.before;
        self.counts.factorisations = system.factorisations - factorisations;
        self.counts.linear += system.conjugate - conjugate;
    }
}

impl<const D: usize> Driver<D> {
    /// An increment at its first iterate: a guess of the displacement increments, under the committed
    /// contact forces. Under control the loading at the end is a first guess too.
    pub(crate) fn begin_increment<'a, 'c>(
        &mut self,
        system: &mut System,
        (start, end): (&'a Loading<D>, &'a Loading<D>),
        mut d_u: Vec<f64>,
        control: Option<&'a mut Control<'c, D>>,
    ) -> Increment<'a, 'c, D> {
        self.begin_grips(system, start);
        let increments = end.displacement.iter();
        for (&dof, u) in increments.filter(|&(&dof, _)| !end.directions.is_turned(dof)) {
            let increment = u - start.displacement.get(&dof).unwrap_or(u);
            // Tools resist nothing: they are where they shall be from the first. Of bodies a guess may be off by rounding.
            let off = (d_u[dof] - increment).abs();
            if dof >= self.mesh_dofs() || off <= 4.0 * f64::EPSILON * increment.abs() {
                d_u[dof] = increment;
            }
        }
        // One that a force takes through a gap begins where it meets the body: its last solution is that of the gap.
        let last = match self.meet(end, &mut d_u) {
            true => None,
            false => self.state.solution.clone(),
        };
        let missing = self.missing(start, end, &d_u);
        system.begin();
        let tangent = Stiffness::Plastic(1.0);
        let heated = self.thermal_force(end);
        Increment {
            start,
            end: Cow::Borrowed(end),
            control,
            iterate: Iterate {
                assembly: self.assemble(system, end, (&d_u, &missing), tangent),
                d_u,
                contact: self.state.contact.clone(),
                heated,
                part: 0.0,
            },
            missing,
            solution: last,
            chord: Chord::default(),
            held: Held::default(),
            patience: None,
            loose: false,
            counts: Counts {
                solves: 1,
                before: (system.factorisations, system.conjugate),
                ..Counts::default()
            },
        }
    }

    /// Finds the equilibrium at the end of an increment. What is counted on a way that leads to none is kept.
    pub(crate) fn balance(
        &mut self,
        system: &mut System,
        mut increment: Increment<'_, '_, D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Candidate<D>, IncrementError> {
        let found = self.found(system, &mut increment, watch);
        if found.is_err() {
            increment.count(system);
            self.spent.add(&increment.counts);
        }
        let (
            Balance {
                kinematics,
                largest,
                ..
            },
            solution,
        ) = found?;
        Ok(Candidate {
            d_u: increment.iterate.d_u,
            internal: increment.iterate.assembly.internal,
            kinematics,
            solution,
            out_of_balance: largest,
            counts: increment.counts,
        })
    }

    /// Iterates until there is balance, and how it is with the contact solution then.
    fn found(
        &mut self,
        system: &mut System,
        increment: &mut Increment<'_, '_, D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<(Balance<D>, ContactSolution<D>), IncrementError> {
        loop {
            let mut balance = self.balance_of(system, increment)?;
            self.tell(increment, &balance, watch)?;
            if let Some(solution) = self.accepted(system, increment, &balance) {
                let (end, iterate) = (&increment.end, &increment.iterate);
                let stands = (balance.kinematics.as_slice(), solution.status.as_slice());
                if !self.release(&solution.force)
                    && !self.reground(system, (end, &iterate.d_u), stands)?
                {
                    let state = (balance.kinematics.as_slice(), solution.status.as_slice());
                    let held = &mut increment.held;
                    increment.counts.negative =
                        self.negative_eigenvalues(system, &increment.end, state, held);
                    increment.count(system);
                    return Ok((balance, solution));
                }
                increment.solution = Some(solution);
                balance = self.balance_of(system, increment)?;
            } else if balance.largest <= balance.accepted
                && let Some(solution) = &increment.solution
                && let stands = (balance.kinematics.as_slice(), solution.status.as_slice())
                && self.reground(system, (&increment.end, &increment.iterate.d_u), stands)?
            {
                balance = self.balance_of(system, increment)?;
            }
            self.check_progress(system, increment, &balance)?;
            let step = match self.newton_step(system, increment, balance) {
                Err(IncrementError::Contact {
                    source: ContactError::Singular,
                    ..
                }) if self.grip_everywhere() => {
                    increment.missing =
                        self.missing(increment.start, &increment.end, &increment.iterate.d_u);
                    continue;
                }
                step => step?,
            };
            self.go_along(system, increment, &step);
        }
    }

    /// Where the iterate stands, with the normals of where it is.
    ///
    /// # Errors
    /// [`Driver::pair_at`]; [`IncrementError::Law`].
    fn balance_of(
        &mut self,
        system: &System,
        increment: &mut Increment<'_, '_, D>,
    ) -> Result<Balance<D>, IncrementError> {
        self.check_laws()?;
        let arrived = increment.has_arrived();
        let (iterate, end) = (&mut increment.iterate, &*increment.end);
        self.follow_surfaces(end, &iterate.d_u)?;
        let kinematics = if arrived {
            self.kinematics(system, end, &iterate.d_u)
        } else {
            let mut reached = iterate.d_u.clone();
            increment.missing.add_to(&mut reached, 1.0);
            self.kinematics(system, end, &reached)
        };
        if iterate.part >= 1.0
            && let Some(solution) = &increment.solution
        {
            // The normals may have turned with the step.
            iterate.contact = self.contact_forces(&kinematics, &solution.force);
        }
        let residual = iterate.residual(end, system.prescribed());
        let largest = largest(residual.iter().copied());
        let scale = self.force_scale((&iterate.assembly, iterate.heated), end, &iterate.contact);
        if increment.counts.newton > 0 {
            increment.counts.residuals.push(largest);
        }
        // Forces of an iterative contact solver are out of balance by what it left.
        let solution = increment.solution.as_ref();
        let left = solution.map_or(0.0, |solution| self.slack(system, solution, scale));
        Ok(Balance {
            accepted: self.accepted_residual(system, scale, &iterate.d_u) + left,
            kinematics,
            residual,
            largest,
            scale,
        })
    }

    fn tell(
        &self,
        increment: &Increment<'_, '_, D>,
        balance: &Balance<D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<(), IncrementError> {
        let iteration = Iteration {
            increment: self.state.increment + 1,
            cuts: 0,
            newton: increment.counts.newton,
            contact_iterations: increment.counts.last_contact,
            out_of_balance: balance.largest,
            scale: balance.scale,
            d_u: &increment.iterate.d_u[..self.mesh_dofs()],
            residual: &balance.residual[..self.mesh_dofs()],
            status: increment.solution.as_ref().map_or(&[], |s| &s.status),
        };
        match watch(self, &iteration) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(IncrementError::Interrupted),
        }
    }

    /// The contact solution of an iterate that is in balance and obeys the contact law; `None` of any
    /// other.
    fn accepted(
        &self,
        system: &System,
        increment: &mut Increment<'_, '_, D>,
        balance: &Balance<D>,
    ) -> Option<ContactSolution<D>> {
        let iterate = &increment.iterate;
        // Ties round off more than forces do: what another step makes smaller is no rounding yet.
        let rounded = !system.is_tied()
            || balance.largest <= WELL * self.settings.tolerance * balance.scale
            || increment.counts.no_longer_improves();
        let balanced = iterate.part >= 1.0
            && balance.largest <= balance.accepted
            && rounded
            && self.is_near(
                system,
                (&iterate.d_u, increment.solution.as_ref()),
                (increment.start, &increment.end),
            );
        let holds = |s: &mut ContactSolution<D>| {
            balanced && self.law_holds(system, &balance.kinematics, s, balance.scale)
        };
        increment.solution.take_if(holds)
    }

    /// # Errors
    /// After too many iterations, or where they go round or stagnate, or where forces are no numbers.
    fn check_progress(
        &self,
        system: &System,
        increment: &Increment<'_, '_, D>,
        balance: &Balance<D>,
    ) -> Result<(), IncrementError> {
        let iteration = increment.counts.newton;
        let counts = &increment.counts;
        let wanders = |patience| counts.stagnates(patience) && balance.largest > balance.accepted;
        let ends = iteration >= self.settings.iterations
            || counts.goes_round()
            || increment.patience.is_some_and(wanders);
        if ends && increment.counts.undetermined {
            // The motion that the statuses left free has no end.
            let source = ContactError::Singular;
            return Err(IncrementError::Contact { iteration, source });
        }
        if ends
            && balance.largest <= balance.accepted
            && let Some(solution) = &increment.solution
            && !self.law_holds(system, &balance.kinematics, solution, balance.scale)
        {
            // What lacks is not in the forces.
            let source = ContactError::NotConverged {
                solver: "Newton's method on the bodies, which are in balance, and the law of contact",
                iterations: iteration,
                residual: self.law_residual(system, &balance.kinematics, solution),
                tolerance: self.law_tolerance(system, solution, balance.scale),
            };
            return Err(IncrementError::Contact { iteration, source });
        }
        if ends || !balance.largest.is_finite() {
            return Err(self.not_converged(&balance.residual, iteration, balance.accepted));
        }
        Ok(())
    }

    /// Solves the increment linearised at its iterate.
    fn newton_step(
        &mut self,
        system: &mut System,
        increment: &mut Increment<'_, '_, D>,
        balance: Balance<D>,
    ) -> Result<NewtonStep, IncrementError> {
        let arrived = increment.has_arrived();
        let imbalance = match arrived {
            true => balance.largest,
            false => increment.iterate.once_arrived(&balance.residual),
        };
        increment.counts.newton += 1;
        let force = match &increment.solution {
            Some(solution) => solution.force.clone(),
            None => self.previous_forces(&balance.kinematics),
        };
        let turning = self.turning(&increment.end, &balance.kinematics, &force);
        self.renew_tangent(system, increment, &balance, &turning)?;
        // What a tool has moved is missing in the first iterate as well.
        let moved = increment.moves_tools(self.mesh_dofs());
        let flows = increment.iterate.assembly.flows;
        let expected = increment
            .chord
            .contact_residual(imbalance, balance.accepted);
        // Where the step is linear it may be the last.
        let exact = !flows || increment.control.is_some();
        let enough = if exact { 0.0 } else { expected };
        let accuracy = (expected, balance.accepted);
        let missing = std::mem::take(&mut increment.missing);
        // An unstable equilibrium that the iteration leads to is one, and told; what displacements or tools that move give
        // the bodies is no way down.
        let astray = increment.counts.stagnates(STRAYING);
        let descends = astray && arrived && !moved && increment.control.is_none();
        let (answer, contact) = self.solve_step(
            system,
            increment,
            (&balance, &missing),
            (enough, imbalance, accuracy),
            descends && self.asks_for_descent(system),
        )?;
        let (step, factor) = (answer.step, answer.growth);
        self.grip(&answer.solution.force);
        increment.solution = Some(answer.solution);
        let last = increment
            .chord
            .may_serve(balance.accepted, system.steps_per_factorisation());
        let elastic = system.holds_elastic_factor() && !flows;
        Ok(NewtonStep {
            turned: turning.change(&step),
            displacement: step,
            factor,
            growth: match &increment.control {
                Some(control) => control.load.scaled(factor),
                None => SparseVector::default(),
            },
            contact,
            complete: !moved && arrived,
            arrives: !arrived,
            slack: (increment.solution.as_ref())
                .map_or(0.0, |s| self.slack(system, s, balance.scale)),
            tangent: !(elastic || self.is_symmetric() && last),
            allowed: self.allowed(&increment.counts.residuals),
        })
    }

    /// Solves the linearised increment that makes up for what is missing; a step that has to go downhill and does not is
    /// found anew, held by proximal terms. Returns its answer with the contact forces at its end.
    fn solve_step(
        &mut self,
        system: &mut System,
        increment: &mut Increment<'_, '_, D>,
        of: (&Balance<D>, &SparseVector),
        accuracy: (f64, f64, (f64, f64)),
        descends: bool,
    ) -> Result<(Answer<D>, SparseVector), IncrementError> {
        let (mut answer, mut contact) = self.solve_held(system, increment, of, accuracy, 0.0)?;
        if !descends {
            return Ok((answer, contact));
        }
        let load = increment.iterate.assembly.load(&[&increment.end.force]);
        let mut held = 0.0;
        for _ in 0..TERMS {
            let Some(next) = stiffer(&load, (&answer, &contact), held) else {
                break;
            };
            held = next;
            match self.solve_held(system, increment, of, accuracy, held) {
                Ok(found) => (answer, contact) = found,
                // Stiffer it may have a solution.
                Err(IncrementError::Contact { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok((answer, contact))
    }

    /// Solves the linearised increment with a proximal term of its contact problem \[N/mm\]: again where the factorised
    /// tangent lacks something, or surfaces move with the step.
    fn solve_held(
        &mut self,
        system: &mut System,
        increment: &mut Increment<'_, '_, D>,
        (balance, missing): (&Balance<D>, &SparseVector),
        (enough, imbalance, accuracy): (f64, f64, (f64, f64)),
        proximal: f64,
    ) -> Result<(Answer<D>, SparseVector), IncrementError> {
        let at = (&increment.iterate, &*increment.end);
        let mut unsymmetric = self.unsymmetric(system, at, imbalance, accuracy);
        let load = increment.iterate.assembly.load(&[&increment.end.force]);
        // Along a path the tangent of large strains may be that of nothing that stands.
        let follows = increment.control.is_some() && self.has_large_strains();
        let mut blends = STIFFENED.iter().filter(|_| follows);
        let mut following = self.following(system, accuracy);
        let mut reached = increment.iterate.d_u.clone();
        missing.add_to(&mut reached, 1.0);
        let mut kinematics = Cow::Borrowed(balance.kinematics.as_slice());
        let rounding = self.rounding(system, &increment.iterate.d_u);
        let is_left_to_contact =
            increment.solution.is_some() && balance.largest <= balance.accepted;
        let weight = if is_left_to_contact {
            system.shift()
        } else {
            0.0
        };
        loop {
            let mut linearised = Linearised {
                kinematics: &kinematics,
                loading: &increment.end,
                missing,
                guess: increment.solution.as_ref(),
                border: increment
                    .control
                    .as_ref()
                    .map(|c| (c.load, c.compliance, c.missing(&increment.iterate.d_u))),
                enough,
                weight,
                rounding,
                proximal,
                loose: increment.loose,
                held: &mut increment.held,
            };
            let load = match &unsymmetric {
                None => load.clone(),
                Some(u) => u.load(&load),
            };
            let answer = match self.answer(system, &mut linearised, load, &mut increment.counts) {
                Ok(answer) => answer,
                Err(error) => {
                    if let Some(best) = following.as_mut().and_then(|f| f.best.take()) {
                        return Ok(best);
                    }
                    let (now, given) = (&mut increment.iterate, (&*increment.end, missing));
                    let mut stiffens = |part| self.blend(system, now, given, part).is_ok();
                    if blends.any(|&part| stiffens(part)) {
                        continue;
                    }
                    return Err(error);
                }
            };
            let contact = self.contact_forces(&kinematics, &answer.solution.force);
            increment.solution = Some(answer.solution.clone());
            let (iterate, prescribed) = (&increment.iterate, system.prescribed());
            let at = (iterate, &*increment.end);
            let settled = self.settles(&mut unsymmetric, at, &answer.step, prescribed);
            let Some(following) = &mut following else {
                if settled {
                    return Ok((answer, contact));
                }
                increment.counts.linear += 1;
                continue;
            };
            let ways = (iterate.d_u.as_slice(), reached.as_slice());
            let given = (answer, &contact);
            let paired = self.pair_along((system, &increment.end), following, ways, given)?;
            if !settled {
                following.asks_for_others();
            }
            match paired {
                Some(next) => kinematics = Cow::Owned(next),
                None if settled => {
                    if let Some(best) = following.best.take() {
                        return Ok(best);
                    }
                }
                None => {}
            }
            increment.counts.linear += 1;
        }
    }

    /// Takes the tangent at the iterate, unless the factor of an earlier one serves.
    fn renew_tangent(
        &mut self,
        system: &mut System,
        increment: &mut Increment<'_, '_, D>,
        balance: &Balance<D>,
        turning: &Turning,
    ) -> Result<(), IncrementError> {
        let (imbalance, accepted) = (balance.largest, balance.accepted);
        let worth = system.steps_per_factorisation();
        // What a symmetric tangent lacks is that of its own iterate.
        let serves = self.is_symmetric()
            && increment.has_arrived()
            && increment.chord.serves(imbalance, accepted, worth);
        if !serves {
            let far = imbalance > FAR * balance.scale;
            let given = (&*increment.end, &increment.missing);
            self.linearise(system, &mut increment.iterate, given, turning, far)?;
        }
        increment.chord.begin(imbalance, !serves);
        Ok(())
    }

    /// Goes along a step as far as it leads towards balance.
    fn go_along(
        &mut self,
        system: &mut System,
        increment: &mut Increment<'_, '_, D>,
        step: &NewtonStep,
    ) {
        let part = self.search(system, &increment.end, step, &mut increment.iterate);
        increment.chord.taken(part);
        if part < 1.0 && step.arrives {
            increment.missing =
                self.missing(increment.start, &increment.end, &increment.iterate.d_u);
        }
        increment.counts.shortened += usize::from(part < 1.0);
        if let Some(control) = &mut increment.control {
            control.factor += part * step.factor;
            let grown = Loading {
                pressure: control.grows.pressure.scaled(part * step.factor),
                ..Loading::default()
            };
            let iterate = &mut increment.iterate;
            self.pressure_force(&grown, &iterate.d_u)
                .add_to(&mut iterate.assembly.internal, -1.0);
            increment.end = Cow::Owned(control.loading(increment.start));
        }
    }

    /// Prescribed displacement increments that `d_u` does not have yet \[mm\].
    pub(crate) fn missing(
        &self,
        start: &Loading<D>,
        end: &Loading<D>,
        d_u: &[f64],
    ) -> SparseVector {
        let mut missing = SparseVector::default();
        for (&dof, &u) in &end.displacement {
            let increment = u - start.displacement.get(&dof).copied().unwrap_or(u);
            let left = increment - end.directions.component(dof, |j| d_u[j]);
            if !end.is_rounding(dof, left, d_u) {
                let entries = end.directions.entries(dof);
                entries.for_each(|(j, c)| missing.add(j, c * left));
            }
        }
        missing
    }
}
