//! Why an increment did not converge, and what to change; not the error itself.

use super::status_name;
use super::trace::Trace;
use crate::contact::ContactError;
use crate::deck::{Action, ConditionEntry, Deck, Method, Units};
use crate::driver::{Driver, Imbalance, IncrementError, Step};
use crate::laws::Status;
use std::fmt;

/// Part of the volume that flows, above which flow is widespread.
const WIDESPREAD: f64 = 0.02;

/// A contact point whose status does not settle.
#[derive(Debug, Clone, PartialEq)]
pub struct Flip {
    /// The node.
    pub node: usize,
    /// Its position in the undeformed body.
    pub position: Vec<f64>,
    /// Its statuses in the last iterations, oldest first.
    pub statuses: Vec<Status>,
}

/// What is known of an increment that did not converge.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// The five nodes with the largest force that nothing balances, worst first.
    pub worst: Vec<Imbalance>,
    /// Contact points whose status changed in the last iterations.
    pub flips: Vec<Flip>,
    /// Part of the volume that flows plastically.
    pub plastic_fraction: f64,
    /// Estimate of the load factor at collapse from the last increments, in parts of the loads of the
    /// step, if they tell.
    pub limit: Option<f64>,
    /// What to change first.
    pub suggestion: String,
    /// Units of the deck.
    pub units: Units,
}

impl Diagnosis {
    /// Of a step of a deck that stopped.
    pub(super) fn new<const D: usize>(
        driver: &Driver<D>,
        deck: &Deck,
        (stage, step): (usize, Option<&Step<D>>),
        trace: &Trace,
        error: &IncrementError,
    ) -> Self {
        let (cause, plastic_fraction, limit) = match error {
            IncrementError::Stopped {
                cause,
                plastic_fraction,
                limit,
                ..
            } => (cause.as_ref(), *plastic_fraction, *limit),
            other => (other, 0.0, None),
        };
        let flip = |(k, c): (usize, &crate::driver::ContactRecord<D>)| {
            let statuses = trace.statuses.iter().filter_map(|s| s.get(k).copied());
            let statuses: Vec<Status> = statuses.collect();
            let settled = statuses.windows(2).all(|s| s[0] == s[1]);
            (!settled).then(|| Flip {
                node: c.node,
                position: c.position.to_vec(),
                statuses,
            })
        };
        let flips: Vec<Flip> = driver
            .contacts()
            .iter()
            .enumerate()
            .filter_map(flip)
            .collect();
        let last = trace.statuses.back().filter(|_| trace.is_of_next(driver));
        let singular = matches!(
            cause,
            IncrementError::Contact {
                source: ContactError::Singular,
                ..
            }
        );
        let free = step.filter(|_| pushed(deck, stage).is_none());
        let seen = |k: usize| match last.is_some_and(|all| all.get(k) == Some(&Status::Open)) {
            true => Status::Open,
            false => Status::Stick,
        };
        let free = free.and_then(|step| {
            // Where nothing says which of them gave way, what slides is asked for first.
            let all = |status: Status| driver.let_go(step, |_| status).filter(|_| singular);
            let left = driver.let_go(step, seen).map(|free| (free, false));
            let left = left.or_else(|| Some((all(Status::Slip)?, true)));
            let ((cell, motion), slides) = left.or_else(|| Some((all(Status::Open)?, false)))?;
            Some((driver.body_in_words(cell), motion, slides))
        });
        let suggestion = match (free, deck.steps.get(stage)) {
            (Some((body, motion, true)), Some(step)) => format!(
                "contacts alone hold {body} against its {motion}, and they open, or slide under more than friction \
                 bears: hold it in step \"{}\", press it on more, or end the step before",
                step.name.value
            ),
            (Some((body, motion, false)), Some(step)) => format!(
                "nothing holds {body} any longer, free is its {motion}: the contacts that held it are open; end step \
                 \"{}\" before, or hold it there",
                step.name.value
            ),
            _ => suggestion(deck, stage, cause, plastic_fraction, !flips.is_empty()),
        };
        let worst = match cause {
            IncrementError::NotConverged { worst, .. } => worst.clone(),
            _ if trace.is_of_next(driver) => driver.worst(&trace.residual),
            _ => Vec::new(),
        };
        Self {
            worst: worst.into_iter().filter(|w| w.force != 0.0).collect(),
            flips,
            plastic_fraction,
            limit,
            suggestion,
            units: deck.units,
        }
    }
}

/// What drives a tool by a force or a moment in a step.
fn pushed(deck: &Deck, stage: usize) -> Option<&ConditionEntry> {
    let mut conditions = deck.steps.get(stage)?.conditions.iter();
    conditions.find(|c| matches!(c.action, Action::Push(..) | Action::Moment(..)))
}

fn suggestion(
    deck: &Deck,
    stage: usize,
    cause: &IncrementError,
    plastic_fraction: f64,
    flips: bool,
) -> String {
    let Some(step) = deck.steps.get(stage) else {
        return String::new();
    };
    let name = &step.name.value;
    let load = step.conditions.iter().find(|c| {
        matches!(
            c.action,
            Action::Pressure(_)
                | Action::Traction(_)
                | Action::Force(_)
                | Action::BodyForce(_)
                | Action::Push(..)
                | Action::Moment(..)
        )
    });
    let pushed = pushed(deck, stage);
    let yields = deck.materials.iter().any(|m| m.yields().is_some());
    let yields = yields && plastic_fraction > WIDESPREAD;
    let exact = deck.solver.method == Method::Exact && !deck.solver.outside;
    match (load, cause) {
        (_, IncrementError::Contact { .. }) if !exact => {
            "set contact = \"exact\" in [solver]: it needs no parameter and no contraction".into()
        }
        (Some(load), _) if yields => format!(
            "the load on \"{}\" is probably beyond the limit load: in step \"{name}\" prescribe a \
             displacement there instead (move), which passes the limit and shows the load",
            load.on.value
        ),
        (_, IncrementError::Contact { .. }) if exact && pushed.is_some() => format!(
            "nothing holds the tool \"{}\" against its force or moment, it slides off or its contact opens: turn the \
             force towards the surface, give the contact friction, or prescribe the motion of the tool \
             (move, turn) along what slides",
            pushed.map_or("", |p| &p.on.value)
        ),
        (
            _,
            IncrementError::Overlap {
                surface, opposite, ..
            },
        ) => format!(
            "move \"{opposite}\" off \"{surface}\" where it stands in the deck, and let the first step bring it there"
        ),
        (_, IncrementError::NotFinite { .. }) => format!(
            "in step \"{name}\" prescribe what the model can follow: displacements of its size at most, and \
             loads of the size of its strength, in the units of the deck"
        ),
        (_, IncrementError::Law(_)) => format!(
            "let the law of the material answer with numbers at larger strains, or in step \"{name}\" allow smaller \
             increments"
        ),
        (_, IncrementError::Mechanism { node, axis, .. }) => {
            format!("hold u_{axis} near node {node}, or bring it into contact: it moves freely")
        }
        _ if flips => format!(
            "contact statuses do not settle: in step \"{name}\" use increments = {}",
            2 * step.increments.count()
        ),
        _ => format!(
            "in step \"{name}\" allow smaller increments: increments = {{ start = {:?}, min = 1e-7, \
             max = {:?} }}",
            0.5 * step.increments.start,
            step.increments.start
        ),
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.worst.is_empty() {
            writeln!(f, "  nodes farthest out of balance")?;
        }
        for w in &self.worst {
            let (node, at, unit) = (w.node, &w.position, self.units.force());
            writeln!(f, "    node {node} at {at:?}: {:.3e} {unit}", w.force)?;
        }
        if !self.flips.is_empty() {
            writeln!(f, "  contact points whose status does not settle")?;
        }
        for flip in self.flips.iter().take(5) {
            let names: Vec<&str> = flip.statuses.iter().map(|s| status_name(*s)).collect();
            let (node, at) = (flip.node, &flip.position);
            writeln!(f, "    node {node} at {at:?}: {}", names.join(", "))?;
        }
        if self.flips.len() > 5 {
            writeln!(f, "    and {} more", self.flips.len() - 5)?;
        }
        let percent = 100.0 * self.plastic_fraction;
        writeln!(f, "  plastic flow in {percent:.1} % of the volume")?;
        if let Some(limit) = self.limit {
            writeln!(
                f,
                "  the last increments tend to collapse at {:.1} % of the loads of the step",
                100.0 * limit
            )?;
        }
        writeln!(f, "  try: {}", self.suggestion)
    }
}
