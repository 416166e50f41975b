//! What a table over time does not go with: a step that has no end, and a jump at its beginning.

use crate::deck::entries::{Action, ConditionEntry, Deck, FieldEntry, StepEntry};
use crate::deck::finding::{Class, Findings};

/// What a part of a condition acts as, and along which axis, or which unit vector.
type Part = (&'static str, Way);

#[derive(Clone, PartialEq)]
enum Way {
    Axis(usize),
    Along(Vec<f64>),
}

impl Way {
    fn along(direction: &[f64]) -> Self {
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        Self::Along(direction.iter().map(|x| x / length).collect())
    }
}

/// Tables in steps until collapse, and those that begin with another value than the step before ended with.
pub(super) fn check(deck: &Deck, findings: &mut Findings) {
    for (number, step) in deck.steps.iter().enumerate() {
        for condition in &step.conditions {
            let Some(table) = &condition.table else {
                continue;
            };
            if step.until_collapse {
                findings
                    .error_with(
                        &table.span,
                        "a table in a step with until = \"collapse\", whose loads grow by one factor",
                        "over the time of a step that does not end",
                        "a step of its own before it for what varies",
                    )
                    .about(Class::Steps);
                continue;
            }
            jumps(&deck.steps[..number], step, condition, findings);
        }
    }
}

/// The parts of a condition that start elsewhere than the steps before have ended: with others of the same kind on the
/// same group, all of which act together. One without a table goes on from what the others leave.
fn jumps(
    before: &[StepEntry],
    step: &StepEntry,
    condition: &ConditionEntry,
    findings: &mut Findings,
) {
    let Some((table, &[_, share])) = condition
        .table
        .as_ref()
        .and_then(|t| Some((t, t.value.first()?)))
    else {
        return;
    };
    for (part, value) in parts(&condition.action) {
        let beside = step
            .conditions
            .iter()
            .filter(|c| !std::ptr::eq(*c, condition));
        let beside = beside.filter(|c| c.on.value == condition.on.value);
        let beside = beside.flat_map(|c| {
            let share = c.table.as_ref().and_then(|t| Some(t.value.first()?[1]));
            let own = parts(&c.action).into_iter().filter(|(p, _)| *p == part);
            own.map(move |(_, v)| share.map(|share| v * share))
        });
        let Some(beside) = beside.sum::<Option<f64>>() else {
            continue;
        };
        let starts = value * share + beside;
        let Some(held) = held(before, &condition.on.value, &part) else {
            continue;
        };
        if (starts - held).abs() <= 1e-9 * value.abs().max(held.abs()) {
            continue;
        }
        let (what, on) = (part.0, &condition.on.value);
        let remedy = match value {
            0.0 => "a step of its own that takes it back".to_owned(),
            _ => format!("[0, {}] as the first row", (held - beside) / value + 0.0), // Not −0.
        };
        findings
            .error_with(
                &table.span,
                format!("the {what} of \"{on}\" would jump from {held} to {starts} at the beginning of the step"),
                "not where the step before ended",
                remedy,
            )
            .about(Class::Steps);
        return;
    }
}

/// What acts at the end of the steps so far; `None` for a displacement that nothing prescribes then. Loads are released
/// by a step that does not list them, and tools stay.
fn held(before: &[StepEntry], on: &str, part: &Part) -> Option<f64> {
    let of = |step: &StepEntry| -> Option<f64> {
        let own = step.conditions.iter().filter(|c| c.on.value == on);
        let values = own.flat_map(|c| {
            let last = c.table.as_ref().and_then(|t| Some(t.value.last()?[1]));
            let share = last.unwrap_or(1.0);
            parts(&c.action)
                .into_iter()
                .map(move |(p, v)| (p, v * share))
        });
        let values: Vec<f64> = values.filter(|(p, _)| p == part).map(|(_, v)| v).collect();
        (!values.is_empty()).then(|| values.iter().sum())
    };
    match part.0 {
        DISPLACEMENT => before.last().map_or(Some(0.0), of),
        MOTION | TURN => Some(before.iter().rev().find_map(of).unwrap_or(0.0)),
        _ => Some(before.last().and_then(of).unwrap_or(0.0)),
    }
}

const DISPLACEMENT: &str = "displacement";
const MOTION: &str = "motion";
const TURN: &str = "turn";

/// The numbers of a condition.
fn parts(action: &Action) -> Vec<(Part, f64)> {
    let vector = |what: &'static str, v: &[f64]| -> Vec<(Part, f64)> {
        let of = |(axis, &value)| ((what, Way::Axis(axis)), value);
        v.iter().enumerate().map(of).collect()
    };
    let motion = |u: &Option<Vec<f64>>| u.as_ref().map_or(Vec::new(), |u| vector(MOTION, u));
    match action {
        Action::Fix(axes) => axes
            .iter()
            .map(|&i| ((DISPLACEMENT, Way::Axis(i)), 0.0))
            .collect(),
        Action::FixAlong(n) => vec![((DISPLACEMENT, Way::along(n)), 0.0)],
        Action::Move(u) => u
            .iter()
            .map(|&(i, value)| ((DISPLACEMENT, Way::Axis(i)), value))
            .collect(),
        Action::MoveAlong(n, u) => vec![((DISPLACEMENT, Way::along(n)), *u)],
        Action::Pressure(p) => vec![(("pressure", Way::Axis(0)), *p)],
        Action::Traction(t) => vector("traction", t),
        Action::Force(f) => vector("force", f),
        Action::BodyForce(f) => vector("body force", f),
        Action::Temperature(FieldEntry::Constant(t)) => vec![(("temperature", Way::Axis(0)), *t)],
        // Not one number: what becomes of it is not compared.
        Action::Temperature(FieldEntry::Formula(_)) => Vec::new(),
        Action::Tool(u, turn) => {
            let turn = turn.iter().map(|turn| ((TURN, Way::Axis(0)), turn.angle));
            motion(u).into_iter().chain(turn).collect()
        }
        Action::Moment(m) => vec![(("moment", Way::Axis(0)), m.value)],
        Action::Push(f, u) => [vector("force", f), motion(u)].concat(),
    }
}
