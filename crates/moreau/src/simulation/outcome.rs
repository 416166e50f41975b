//! How a run ended: status, certificate, expectations, and a summary to paste into a report; not
//! its course.

use super::StepError;
use super::diagnosis::Diagnosis;
use super::history::History;
use super::warnings::Warnings;
use crate::contact::Certificate;
use crate::deck::{Deck, Setup, Units};
use crate::driver::{
    Collapse, Driver, Energies, IncrementError, IncrementReport, ModelError, Numbers, Saved,
    UpperBound, threads,
};
use crate::laws::Status;
use crate::numbers::shown;
use std::fmt;

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum RunStatus {
    /// All increments converged.
    Done,
    /// The model does not admit a step.
    Refused(String),
    /// A step stopped; what converged before is kept.
    NotConverged(String),
    /// The structure does not carry the loads of a step; the state is that of its mechanism.
    Collapsed(String),
    /// Stopped from outside after this increment; the run can be resumed.
    Interrupted(usize),
}

impl RunStatus {
    /// The word for it in `run.json`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Refused(_) => "refused",
            Self::NotConverged(_) => "not converged",
            Self::Collapsed(_) => "collapsed",
            Self::Interrupted(_) => "interrupted",
        }
    }

    pub(super) fn of(failure: &StepError) -> Self {
        let text = failure.to_string();
        match failure {
            StepError::Increment(IncrementError::Model(_)) => Self::Refused(text),
            StepError::Increment(IncrementError::Collapse { .. }) => Self::Collapsed(text),
            _ => Self::NotConverged(text),
        }
    }
}

/// An expectation and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The column.
    pub column: String,
    /// What was expected.
    pub expected: f64,
    /// Largest difference accepted.
    pub tolerance: f64,
    /// What was found; NaN without a converged increment.
    pub found: f64,
}

impl Verdict {
    /// Whether the expectation is met. NaN meets nothing.
    pub fn passed(&self) -> bool {
        (self.found - self.expected).abs() <= self.tolerance
    }
}

/// What is counted while running.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    factorisations: usize,
    linear: usize,
    /// Solves for tied contacts.
    solves: usize,
    newton: usize,
    contact: usize,
    cuts: usize,
    certificate: Certificate,
    relative_gap: f64,
    /// Whether each contact was ever closed.
    closed: Vec<bool>,
    /// The largest [`IncrementReport::criticality`], with its contact point and the increment.
    criticality: Option<(usize, f64, usize)>,
    pub(super) warnings: Warnings,
    /// The last collapse and the step, from 0, that ended in it.
    pub(super) collapse: Option<(usize, Collapse)>,
}

impl Tally {
    pub(super) fn new<const D: usize>(driver: &Driver<D>) -> Self {
        let contacts = driver.contacts().iter().map(|c| c.contact + 1).max();
        Self {
            factorisations: 0,
            linear: 0,
            solves: 0,
            newton: 0,
            contact: 0,
            cuts: 0,
            certificate: Certificate::default(),
            relative_gap: 0.0,
            closed: vec![false; contacts.unwrap_or(0)],
            criticality: None,
            warnings: Warnings::new(),
            collapse: None,
        }
    }

    pub(super) fn add<const D: usize>(
        &mut self,
        (driver, deck): (&Driver<D>, &Deck),
        report: &IncrementReport,
        to_collapse: bool,
    ) {
        self.factorisations += report.factorisations;
        self.linear += report.linear_iterations;
        self.solves += report.contact_solves;
        self.newton += report.newton_iterations;
        self.contact += report.contact_iterations;
        self.cuts += report.cuts;
        let (all, one) = (&mut self.certificate, &report.certificate);
        all.bipotential_gap = all.bipotential_gap.max(one.bipotential_gap);
        all.penetration = all.penetration.max(one.penetration);
        all.excess_force = all.excess_force.max(one.excess_force);
        self.relative_gap = self.relative_gap.max(report.relative_gap());
        for (k, c) in driver.contacts().iter().enumerate() {
            self.closed[c.contact] |= driver.status(k) != Status::Open;
        }
        if let Some((point, ratio)) = report.criticality
            && self.criticality.is_none_or(|most| ratio > most.1)
        {
            self.criticality = Some((point, ratio, report.increment));
        }
        self.warnings.add((driver, deck), report, to_collapse);
    }
}

impl Saved for Tally {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        let solves = [&mut self.factorisations, &mut self.linear, &mut self.solves];
        let counts = [&mut self.newton, &mut self.contact, &mut self.cuts];
        for count in solves.into_iter().chain(counts) {
            numbers.count(count)?;
        }
        let c = &mut self.certificate;
        let parts = [
            &mut c.bipotential_gap,
            &mut c.penetration,
            &mut c.excess_force,
        ];
        for value in parts.into_iter().chain([&mut self.relative_gap]) {
            numbers.value(value)?;
        }
        for closed in &mut self.closed {
            numbers.flag(closed)?;
        }
        numbers.option(
            &mut self.criticality,
            || (0, 0.0, 0),
            |(point, ratio, at), numbers| {
                numbers.count(point)?;
                numbers.value(ratio)?;
                numbers.count(at)
            },
        )?;
        self.warnings.visit(numbers)?;
        let none = || (0, Collapse::default());
        numbers.option(&mut self.collapse, none, |(stage, collapse), numbers| {
            numbers.count(stage)?;
            numbers.value(&mut collapse.load_factor)?;
            numbers.flag(&mut collapse.added)?;
            numbers.value(&mut collapse.growth)?;
            let bound = &mut collapse.upper_bound;
            numbers.option(bound, UpperBound::default, |bound, numbers| {
                numbers.value(&mut bound.load_factor)?;
                numbers.value(&mut bound.elastic_share)?;
                numbers.flag(&mut bound.coulomb)?;
                numbers.flag(&mut bound.hardens)
            })
        })
    }
}

/// How a run ended, with numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Title of the deck.
    pub title: String,
    /// Its units.
    pub units: Units,
    /// How it ended.
    pub status: RunStatus,
    /// Time that the increments took, or in a directory all, results written included.
    pub seconds: f64,
    /// When it ended, in seconds since 1970-01-01 UTC; `None` in memory.
    pub finished: Option<u64>,
    /// Converged increments.
    pub increments: usize,
    /// Newton iterations of the converged increments.
    pub newton_iterations: usize,
    /// Iterations of the contact solver in the converged increments.
    pub contact_iterations: usize,
    /// Sparse factorisations of the converged increments.
    pub factorisations: usize,
    /// Iterations of conjugate gradients in the converged increments.
    pub linear_iterations: usize,
    /// Solves with a factor for tied contacts in the converged increments.
    pub contact_solves: usize,
    /// Times that increments were halved before they converged.
    pub cuts: usize,
    /// Degrees of freedom, prescribed ones included.
    pub dofs: usize,
    /// Threads that work on cells.
    pub threads: usize,
    /// Out-of-balance force at which increments were accepted, over the largest nodal force.
    pub tolerance: f64,
    /// The worst of all increments.
    pub certificate: Certificate,
    /// The largest gap, see [`IncrementReport::relative_gap`].
    pub relative_gap: f64,
    /// The largest coefficient of friction over its critical value, see [`IncrementReport::criticality`].
    pub criticality: Option<f64>,
    /// Contact points that are open, stick and slip at the end; those held along the surface are
    /// not counted as sticking or slipping.
    pub contacts: [usize; 3],
    /// Energies at the end.
    pub energies: Energies,
    /// Final forces, moments and displacements by column of `history.csv`.
    pub values: Vec<(String, f64)>,
    /// What came of the expectations.
    pub verdicts: Vec<Verdict>,
    /// Collapse, with the name of the step: the last, if more than one collapsed.
    pub collapse: Option<(String, Collapse)>,
    /// Doubts about the deck and the run.
    pub warnings: Vec<String>,
    /// How many of them, the first, are about the deck.
    pub deck_warnings: usize,
    /// Why it did not converge.
    pub diagnosis: Option<Diagnosis>,
}

pub(super) fn conclude<const D: usize>(
    setup: &Setup<D>,
    deck: &Deck,
    history: &History,
    tally: &Tally,
    (status, diagnosis): (RunStatus, Option<Diagnosis>),
    seconds: f64,
) -> Outcome {
    let driver = &setup.driver;
    let last = |name: &str| history.value(name);
    let verdict = |e: &crate::deck::Expectation| Verdict {
        column: e.column.value.clone(),
        expected: e.value,
        tolerance: e.tolerance(),
        found: last(&e.column.value).unwrap_or(f64::NAN),
    };
    let never = |(k, closed): (usize, &bool)| {
        let (surface, tool) = driver.contact_name(k);
        let offset = deck.contacts.get(k).and_then(|c| c.gap_offset.as_ref());
        let why = match offset.is_some_and(|offset| offset.value < 0.0) {
            true => {
                ": its gap-offset is negative, which leaves room; that of an interference is positive"
            }
            false => "",
        };
        (!closed && driver.increments() > 0)
            .then(|| format!("the contact of \"{surface}\" with \"{tool}\" never closed{why}"))
    };
    let critical = |(point, ratio, increment): (usize, f64, usize)| {
        let c = driver.contacts().get(point).filter(|_| ratio >= 1.0)?;
        let (surface, tool) = driver.contact_name(c.contact);
        Some(format!(
            "the friction of \"{surface}\" with \"{tool}\" is {} times its critical value at node {} in \
             increment {increment}: other solutions are possible there beside the one found, and sudden \
             motion under a steady load",
            shown(ratio, 3),
            c.node
        ))
    };
    let mut warnings = setup.warnings.clone();
    warnings.extend(tally.warnings.sentences(driver, deck));
    warnings.extend(tally.closed.iter().enumerate().filter_map(never));
    warnings.extend(tally.criticality.and_then(critical));
    let names = history.table().columns().iter().map(|c| c.name.as_str());
    let values = names
        .filter(|n| {
            ["force.", "u.", "moment."]
                .iter()
                .any(|of| n.starts_with(of))
        })
        .filter_map(|n| Some((n.to_owned(), last(n)?)))
        .collect();
    Outcome {
        title: deck.title.clone(),
        units: deck.units,
        status,
        seconds,
        finished: None,
        increments: driver.increments(),
        newton_iterations: tally.newton,
        contact_iterations: tally.contact,
        factorisations: tally.factorisations,
        linear_iterations: tally.linear,
        contact_solves: tally.solves,
        cuts: tally.cuts,
        dofs: D * driver.mesh().nodes().len(),
        threads: threads(),
        tolerance: deck.solver.tolerance,
        certificate: tally.certificate,
        relative_gap: tally.relative_gap,
        criticality: tally.criticality.map(|c| c.1),
        values,
        verdicts: deck.expectations.iter().map(verdict).collect(),
        warnings,
        deck_warnings: setup.warnings.len(),
        contacts: [Status::Open, Status::Stick, Status::Slip].map(|s| driver.count(s)),
        energies: driver.energies(),
        collapse: tally.collapse.map(|(stage, c)| {
            let name = deck.steps.get(stage).map(|s| s.name.value.clone());
            (name.unwrap_or_default(), c)
        }),
        diagnosis,
    }
}

impl Outcome {
    /// Whether all expectations are met.
    pub fn as_expected(&self) -> bool {
        self.verdicts.iter().all(Verdict::passed)
    }

    /// The error, if there was one.
    pub fn error(&self) -> Option<&str> {
        match &self.status {
            RunStatus::Done | RunStatus::Interrupted(_) => None,
            RunStatus::Refused(error)
            | RunStatus::NotConverged(error)
            | RunStatus::Collapsed(error) => Some(error),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() {
            writeln!(f, "{}", self.title)?;
        }
        self.write_status(f)?;
        self.write_effort(f)?;
        if self.increments > 0 {
            self.write_mechanics(f)?;
        }
        if let Some((step, collapse)) = &self.collapse {
            writeln!(f, "  limit load    step \"{step}\": {collapse}")?;
        }
        self.write_values(f)?;
        if let Some(diagnosis) = &self.diagnosis {
            write!(f, "{diagnosis}")?;
        }
        for warning in &self.warnings {
            writeln!(f, "  warning: {warning}")?;
        }
        Ok(())
    }
}

impl Outcome {
    fn write_status(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let status = match &self.status {
            RunStatus::Done => "done".to_owned(),
            RunStatus::Refused(error) => format!("refused: {error}"),
            RunStatus::NotConverged(error) => format!("not converged: {error}"),
            RunStatus::Collapsed(error) => format!("collapsed: {error}"),
            RunStatus::Interrupted(increment) => format!("interrupted after increment {increment}"),
        };
        let warned = match self.warnings.len() {
            0 => "",
            1 => ", with a warning below",
            _ => ", with warnings below",
        };
        writeln!(f, "  status        {status}{warned}")
    }

    fn write_effort(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted = |count: usize, what: &str| match count {
            0 => String::new(),
            some => format!(" and {some} {what}"),
        };
        let linear = counted(self.linear_iterations, "conjugate gradients")
            + &counted(self.contact_solves, "solves for contact");
        writeln!(
            f,
            "  effort        {} increments, {} Newton and {} contact iterations, {} factorisations{linear}, {} cuts; \
             {:.2} s on {} threads, {} degrees of freedom",
            self.increments,
            self.newton_iterations,
            self.contact_iterations,
            self.factorisations,
            self.cuts,
            self.seconds,
            self.threads,
            self.dofs
        )
    }

    /// Contacts, energies and the certificate.
    fn write_mechanics(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (units, e) = (self.units, &self.energies);
        let [open, stick, slip] = self.contacts;
        let energy = units.energy();
        writeln!(f, "  contact       {open} open, {stick} stick, {slip} slip")?;
        writeln!(
            f,
            "  energy        external {} {energy} = stored {} + plastic {} + friction {} + \
             springs {} + imbalance {}",
            shown(e.external_work, 7),
            shown(e.stored, 7),
            shown(e.plastic_dissipation, 7),
            shown(e.friction_dissipation, 7),
            shown(e.penalty, 4),
            shown(e.imbalance(), 4)
        )?;
        writeln!(
            f,
            "  certificate   bipotential gap {:.2e} {energy} ({:.1e} of the work), penetration \
             {:.1e} {}, force outside the cone {:.1e} {}",
            self.certificate.bipotential_gap,
            self.relative_gap,
            self.certificate.penetration,
            units.length(),
            self.certificate.excess_force,
            units.force()
        )
    }

    /// Values at the end, and those that were expected.
    fn write_values(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in &self.values {
            let unit = self.units.of_value(name);
            writeln!(f, "  {name:<24} {:>16} {unit}", shown(*value, 9))?;
        }
        for v in &self.verdicts {
            let mark = if v.passed() { "met" } else { "FAILED" };
            writeln!(
                f,
                "  expect {} = {} ± {}: found {}, {mark}",
                v.column,
                shown(v.expected, 9),
                shown(v.tolerance, 3),
                shown(v.found, 9)
            )?;
        }
        Ok(())
    }
}
