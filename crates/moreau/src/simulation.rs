//! A deck under way, in memory: stepped from outside, increment by increment, with what has been found so far as
//! tables and grids. No file is written, and nothing is printed.
//!
//! ```
//! use moreau::deck::Given;
//! use moreau::simulation::Simulation;
//! use std::{ops::ControlFlow, path::Path};
//!
//! let text = r#"
//! units = "mm-N-MPa"
//! analysis = "plane-strain"
//! mesh.block = [{ name = "bar", element = "quad8", x = [0, 50], y = [0, 20], cells = [5, 2] }]
//! material = [{ on = "bar", young = 210000.0, poisson = 0.3 }]
//! [[step]]
//! name = "pull"
//! increments = 2
//! fix = [{ on = "bar.left", u = ["x", "y"] }]
//! move = [{ on = "bar.right", u = { x = 0.1 } }]
//! "#;
//! let (simulation, findings) = Simulation::open(text, Path::new(""), &Given::default());
//! let mut simulation = simulation.unwrap_or_else(|| panic!("{}", findings.render("bar", text, false)));
//! while let Some(increment) = simulation.advance(&mut |_, _| ControlFlow::Continue(()))? {
//!     assert_eq!(increment.step, "pull");
//! }
//! let force = simulation.history().numbers("force.bar.right.x");
//! assert!(force.len() == 2 && (force[1] / force[0] - 2.0).abs() < 1e-9);
//! # Ok::<(), moreau::simulation::StepError>(())
//! ```

mod contact;
mod course;
mod diagnosis;
mod ends;
mod history;
mod json;
mod outcome;
pub(crate) mod pictures;
pub mod reference;
mod saved;
mod trace;
mod warnings;

pub use crate::vtu::{Array, Grid};
pub use diagnosis::{Diagnosis, Flip};
pub use outcome::{Outcome, RunStatus, Verdict};
pub use saved::RestoreError;

pub(crate) use course::Course;
pub(crate) use saved::{sealed, unsealed};

use crate::deck::{Deck, Findings, Given, Problem, open_with};
use crate::driver::{IncrementError, IncrementReport, Iteration, ModelError, Numbers};
use crate::grids;
use crate::laws::Status;
use crate::table::Table;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf, absolute};

/// A converged increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Converged {
    /// Name of the step.
    pub step: String,
    /// Number of the step, from 1.
    pub stage: usize,
    /// Number of steps.
    pub stages: usize,
    /// Increments the step was asked for.
    pub increments: usize,
    /// Part of all steps that has been done, in (0, 1].
    pub done: f64,
    /// The report.
    pub report: IncrementReport,
}

/// Why a simulation does not go on. What converged before is kept.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// An increment failed, or was interrupted; only then does the next call go on.
    #[error(transparent)]
    Increment(#[from] IncrementError),
    /// A step that was to end in collapse has not.
    #[error("step {step:?} was to end in collapse, but its loads are carried: increase them")]
    Carried {
        /// Name of the step.
        step: String,
    },
}

/// A step that cannot follow: shown as `findings` in the text of the deck with it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", .findings.render("the deck with this step", .text, false).trim_end())]
pub struct Refusal {
    /// The deck with the step.
    pub text: String,
    /// What is wrong with it.
    pub findings: Findings,
}

/// A problem in the plane or in space under way.
pub(crate) enum Either {
    Plane(Box<Course<2>>),
    Solid(Box<Course<3>>),
}

/// The same of either.
macro_rules! either {
    ($either:expr, $course:ident => $what:expr) => {
        match $either {
            $crate::simulation::Either::Plane($course) => $what,
            $crate::simulation::Either::Solid($course) => $what,
        }
    };
}
pub(crate) use either;

/// A deck under way.
pub struct Simulation {
    deck: Deck,
    /// What the deck is given when it is opened again, for a step that follows.
    given: Given,
    course: Either,
}

impl Simulation {
    /// Opens a deck, with what is given beside its text. Paths in it are relative to a folder. `None` if the deck has
    /// errors. Of the processes of a team the first goes on as if it were alone, the others with [`Simulation::serve`].
    pub fn open(text: &str, folder: &Path, given: &Given) -> (Option<Self>, Findings) {
        let (deck, problem, findings) = open_with(text, folder, given);
        // From wherever the process is then.
        let at = |path: &PathBuf| absolute(folder.join(path)).unwrap_or_else(|_| path.clone());
        let kept = || Given {
            meshes: (given.meshes.iter())
                .map(|(path, mesh)| (at(path), mesh.clone()))
                .collect(),
            laws: given.laws.clone(),
            ..Given::default()
        };
        let simulation = problem.map(|problem| Self::of(deck, problem, kept()));
        (simulation, findings)
    }

    /// A deck whose meshes are on disk, and its problem.
    pub fn new(deck: Deck, problem: Problem) -> Self {
        Self::of(deck, problem, Given::default())
    }

    fn of(deck: Deck, problem: Problem, given: Given) -> Self {
        let course = match problem {
            Problem::Plane(setup) => Either::Plane(Box::new(Course::new(&deck, *setup))),
            Problem::Solid(setup) => Either::Solid(Box::new(Course::new(&deck, *setup))),
        };
        Self {
            deck,
            given,
            course,
        }
    }

    /// Does what the first process of the team asks of this other one, until that has ended.
    pub fn serve(self) {
        either!(self.course, course => course.serve());
    }

    /// The deck.
    pub fn deck(&self) -> &Deck {
        &self.deck
    }

    pub(crate) fn course(&self) -> &Either {
        &self.course
    }

    /// Applies the next increment; `None` after the last. `watch` sees every iterate of every attempt, with the name
    /// of the step, and may break off: the state is then what it was before, and the next call has the same outcome,
    /// to the bit, as if there had been no interruption.
    ///
    /// # Errors
    /// [`StepError`]: the same again in every later call, unless the increment was broken off, by `watch` with
    /// [`IncrementError::Interrupted`] or by a law with [`IncrementError::Law`].
    pub fn advance(
        &mut self,
        watch: &mut dyn FnMut(&str, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Option<Converged>, StepError> {
        let Self { deck, course, .. } = self;
        either!(course, course => course.advance(deck, watch))
    }

    /// Whether all steps have been done.
    pub fn is_done(&self) -> bool {
        either!(&self.course, course => course.is_done())
    }

    /// Increments converged so far.
    pub fn increments(&self) -> usize {
        either!(&self.course, course => course.driver().increments())
    }

    /// Steps done, with the part of the one under way.
    pub fn done(&self) -> f64 {
        either!(&self.course, course => course.done())
    }

    /// Part of the run that is done, by the increments that steps plan.
    pub(crate) fn part(&self) -> f64 {
        either!(&self.course, course => course.part())
    }

    /// Gives up what is left of the step under way and the steps after it, and goes on with another: the keys of a
    /// `[[step]]` of a deck. A step that failed is given up where it failed. Expectations, which are of another end, go
    /// too, and so do the columns of the history of groups that only later steps held.
    ///
    /// # Errors
    /// [`Refusal`]; nothing has changed then.
    pub fn replace_step(&mut self, step: &str) -> Result<Findings, Refusal> {
        let begun = either!(&self.course, course => course.begun());
        let mut deck = self.deck.clone();
        deck.steps.truncate(begun);
        deck.expectations.clear();
        let text = format!("{}\n[[step]]\n{step}\n", deck.resolved());
        let (deck, problem, findings) = open_with(&text, Path::new(""), &self.given);
        let Some(problem) = problem else {
            return Err(Refusal { text, findings });
        };
        let mut next = Self::of(deck, problem, Given::default());
        let taken = match (&mut next.course, &self.course) {
            (Either::Plane(next), Either::Plane(course)) => next.take_over(course),
            (Either::Solid(next), Either::Solid(course)) => next.take_over(course),
            // The analysis is that of the deck.
            _ => Ok(()),
        };
        if let Err(error) = taken {
            let mut findings = Findings::default();
            findings.error(&(0..0), error.to_string(), "of another model");
            return Err(Refusal { text, findings });
        }
        (self.deck, self.course) = (next.deck, next.course);
        Ok(findings)
    }

    /// A row for each converged increment, as in `history.csv`.
    pub fn history(&self) -> &Table {
        either!(&self.course, course => course.history())
    }

    /// Forgets all rows of the history but the last, for whoever keeps them elsewhere.
    pub fn forget_history(&mut self) {
        either!(&mut self.course, course => course.forget_history());
    }

    /// A row for each contact point after the last increment, as in `contact.csv`.
    pub fn contacts(&self) -> Table {
        either!(&self.course, course => course.contacts(&self.deck))
    }

    /// The nodes of the mesh, two or three coordinates each.
    pub fn nodes(&self) -> Vec<f64> {
        either!(&self.course, course => course.driver().mesh().nodes().concat())
    }

    /// Displacements of the nodes since the virgin state, two or three components each.
    pub fn displacements(&self) -> &[f64] {
        either!(&self.course, course => course.driver().displacements())
    }

    /// The body with its fields, recovered at points and as means of cells. Nodes where materials meet are a point for
    /// each material.
    pub fn body(&self) -> Grid {
        either!(&self.course, course => grids::body(course.driver()))
    }

    /// The process that holds each cell, where several do.
    pub(crate) fn processes(&self) -> Option<&[u32]> {
        either!(&self.course, course => course.driver().processes())
    }

    /// The contact surfaces with gaps, slips, tractions and statuses; `None` without contacts.
    pub fn surface(&self) -> Option<Grid> {
        either!(&self.course, course => grids::surface(course.driver()))
    }

    /// The surfaces of the rigid tools where they are; `None` without tools.
    pub fn tools(&self) -> Option<Grid> {
        either!(&self.course, course => grids::tools(course.driver(), &self.deck))
    }

    /// The quadrature points with what was computed there, as a grid of one vertex each.
    pub fn points(&self) -> Grid {
        either!(&self.course, course => grids::points(course.driver()))
    }

    /// The body with the [`mode`](crate::driver::IncrementReport::mode) in which it gives way, as a field of that name;
    /// `None` for one of another number of components.
    pub fn mode(&self, motion: &[f64]) -> Option<Grid> {
        (motion.len() == self.nodes().len())
            .then(|| either!(&self.course, course => grids::mode(course.driver(), motion)))
    }

    /// The last candidate of an increment that did not converge: the body with its displacement there, and the forces
    /// that nothing balances.
    pub fn failed(&self) -> Option<Grid> {
        either!(&self.course, course => course.failed())
    }

    /// Unit of a field of the grids; empty where there is none, or none is known.
    pub fn unit(&self, field: &str) -> &'static str {
        let unit = pictures::unit(field, self.deck.units);
        unit.filter(|unit| *unit != "–").unwrap_or_default()
    }

    /// Pictures as SVG, by name: `history`, `contact`, the tractions along the surfaces of a body in the plane, pressures
    /// and statuses on those of a solid, and `deformed`, with a field of [`Simulation::body`] or a component of one, as in `displacement.x`, and
    /// displacements drawn so many times as large. What has nothing to show is left out.
    pub fn pictures(
        &self,
        field: Option<&str>,
        magnification: Option<f64>,
    ) -> Vec<(&'static str, String)> {
        let (deck, history) = (&self.deck, self.history());
        let forces = pictures::over_time(history, deck).and_then(|chart| chart.to_svg().ok());
        let mut list = vec![("history", forces)];
        if let Some(row) = history.rows().checked_sub(1) {
            let (increment, contacts) = (self.increments(), self.contacts());
            let arrays = self.body().point_data;
            let field = field.unwrap_or(pictures::usual_field(deck));
            let at = (history, row);
            let (contact, deformed) = either!(&self.course, course => {
                let mesh = course.driver().mesh();
                (
                    pictures::contact(mesh, deck, &contacts, increment, Some(&arrays)),
                    pictures::deformed(mesh, deck, &arrays, field, at, magnification),
                )
            });
            list.extend([("contact", contact), ("deformed", deformed)]);
        }
        let drawn = list.into_iter();
        drawn.filter_map(|(name, svg)| Some((name, svg?))).collect()
    }

    /// How it stands: [`RunStatus::Interrupted`] before the end.
    pub fn outcome(&self) -> Outcome {
        either!(&self.course, course => course.outcome(&self.deck))
    }

    /// Gives back the memory of the linear system at the end, after the [`outcome`](Self::outcome), which tells of it.
    pub(crate) fn free_system(&mut self) {
        either!(&mut self.course, course => course.free_system());
    }

    /// Appends all that [`Simulation::read`] needs.
    pub(crate) fn write(&self, numbers: &mut Vec<f64>) {
        either!(&self.course, course => course.write(numbers));
    }

    /// Takes over what [`Simulation::write`] left of the same deck; of no use after an error.
    pub(crate) fn read(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        either!(&mut self.course, course => course.read(numbers))
    }

    /// The state as bytes: all that [`Simulation::restore`] needs to go on as if nothing had happened.
    pub fn save(&self) -> Vec<u8> {
        let mut numbers = Vec::new();
        self.write(&mut numbers);
        sealed(&self.deck.resolved(), &numbers)
    }

    /// Takes over a state that [`Simulation::save`] left of the same deck.
    ///
    /// # Errors
    /// [`RestoreError`]; nothing has changed then.
    pub fn restore(&mut self, state: &[u8]) -> Result<(), RestoreError> {
        let numbers = unsealed(state, &self.deck.resolved()).map_err(RestoreError)?;
        let mut own = Vec::new();
        self.write(&mut own);
        self.read(&mut Numbers::Read(&numbers)).map_err(|error| {
            // What it wrote itself fits.
            let _ = self.read(&mut Numbers::Read(&own));
            RestoreError(error.to_string())
        })
    }
}

pub(crate) fn status_name(status: Status) -> &'static str {
    match status {
        Status::Open => "open",
        Status::Stick => "stick",
        Status::Slip => "slip",
        Status::Tied => "tied",
    }
}
