//! What a table over time does not go with: a step that has no end, a beginning that only the run knows, and a jump there.

use super::conditions::drives;
use super::groups::Groups;
use crate::deck::entries::{Action, ConditionEntry, Deck, FieldEntry, StepEntry};
use crate::deck::finding::{Class, Findings};
use crate::numbers::place;
use std::collections::HashSet;

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

    /// Whether a vector has a part in this direction.
    fn has(&self, v: &[f64]) -> bool {
        match self {
            Self::Axis(axis) => v[*axis] != 0.0,
            Self::Along(n) => n.iter().zip(v).map(|(a, b)| a * b).sum::<f64>() != 0.0,
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Axis(axis) => AXES[*axis].to_owned(),
            Self::Along(n) => place(n, 4),
        }
    }
}

/// Tables in steps until collapse, and those that begin with another value than the step before ended with, or with one
/// that only the run knows.
pub(super) fn check<const D: usize>(deck: &Deck, groups: &Groups<D>, findings: &mut Findings) {
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
            let before = &deck.steps[..number];
            let unknown = let_go(before, step, condition)
                .or_else(|| tool_freed(deck, before, condition))
                .or_else(|| group_freed(groups, before, condition));
            match unknown {
                Some(why) => {
                    let message = format!(
                        "a table for \"{}\", but the step before {why} that is known in the run only and would go \
                         off in proportion beneath the table",
                        condition.on.value
                    );
                    findings
                        .error_with(
                            &table.span,
                            message,
                            "begins with what is not known",
                            "take over from that in a step without a table before this one",
                        )
                        .about(Class::Steps);
                }
                None => jumps(before, step, condition, findings),
            }
        }
    }
}

/// That the step before holds or moves what a condition loads, in a direction in which this one does not: the force that
/// this takes.
fn let_go(before: &[StepEntry], step: &StepEntry, condition: &ConditionEntry) -> Option<String> {
    let last = before.last()?;
    let own = |step| of_group(step, &condition.on.value);
    let held = |way: &str| format!("holds or moves it along {way} by a force");
    let told = |step| own(step).flat_map(|c| parts(&c.action));
    let ways = |step| told(step).filter(|((what, _), _)| *what == DISPLACEMENT);
    let freed = || ways(last).filter(|(part, _)| ways(step).all(|(now, _)| now != *part));
    match &condition.action {
        // A tool that no force drives is where it was told to go, or left.
        Action::Push(force, _) => {
            let driven = own(last).any(|c| matches!(c.action, Action::Push(..)));
            let axis = force.iter().position(|f| *f != 0.0).filter(|_| !driven)?;
            Some(held(AXES[axis]))
        }
        Action::Moment(_) => {
            let driven = own(last).any(|c| matches!(c.action, Action::Moment(_)));
            (!driven).then(|| "holds or turns it by a moment".to_owned())
        }
        Action::Force(v) | Action::Traction(v) | Action::BodyForce(v) => {
            let way = freed().map(|((_, way), _)| way).find(|way| way.has(v))?;
            Some(held(&way.name()))
        }
        // Along whatever normals.
        Action::Pressure(_) => Some(held(&freed().next()?.0.1.name())),
        _ => None,
    }
}

/// That a tool with a motion has last been driven by a force, or turned by a moment: where it is.
fn tool_freed(deck: &Deck, before: &[StepEntry], condition: &ConditionEntry) -> Option<String> {
    let on = &condition.on.value;
    let all = before.iter().rev().flat_map(|step| of_group(step, on));
    let mut actions = all.map(|c| &c.action);
    let driven = |u: &[f64]| (0..u.len()).find(|&i| drives(deck, on, i));
    // A step that says nothing of a tool holds it where it is.
    let is_of_last = || {
        before
            .last()
            .is_some_and(|step| of_group(step, on).next().is_some())
    };
    match &condition.action {
        Action::Tool(Some(u), _) => {
            let last = actions.find(|a| matches!(a, Action::Push(..) | Action::Tool(Some(_), _)));
            let axis = driven(u).filter(|_| matches!(last, Some(Action::Push(..))))?;
            Some(match is_of_last() {
                true => format!("leaves it free along {} at a place", AXES[axis]),
                false => format!(
                    "holds it along {} where a force had left it, at a place",
                    AXES[axis]
                ),
            })
        }
        Action::Tool(None, Some(_)) => {
            let last = actions.find(|a| matches!(a, Action::Moment(_) | Action::Tool(_, Some(_))));
            let freed = matches!(last, Some(Action::Moment(_)));
            let why = match is_of_last() {
                true => "leaves it free to turn at an angle",
                false => "holds it where a moment had turned it, at an angle",
            };
            freed.then(|| why.to_owned())
        }
        _ => None,
    }
}

/// That nodes of a group are moved which the step before neither held nor moved in that direction: where they are.
fn group_freed<const D: usize>(
    groups: &Groups<D>,
    before: &[StepEntry],
    condition: &ConditionEntry,
) -> Option<String> {
    let Action::Move(components) = &condition.action else {
        return None;
    };
    let nodes = |on: &str| {
        groups
            .mesh
            .node_group(groups.nodes_of(on))
            .unwrap_or_default()
    };
    let last = before.last()?;
    let free = |axis: usize| {
        let tells = |c: &&ConditionEntry| match &c.action {
            Action::Fix(axes) => axes.contains(&axis),
            Action::Move(told) => told.iter().any(|(i, _)| *i == axis),
            Action::FixAlong(n) | Action::MoveAlong(n, _) => n[axis] != 0.0,
            _ => false,
        };
        let told = last.conditions.iter().filter(tells);
        let told: HashSet<usize> = told.flat_map(|c| nodes(&c.on.value)).collect();
        nodes(&condition.on.value)
            .iter()
            .any(|node| !told.contains(node))
    };
    let (axis, _) = components.iter().find(|(axis, _)| free(*axis))?;
    Some(format!("leaves it free along {} at a place", AXES[*axis]))
}

/// The conditions of a step on a group, or of a tool.
fn of_group<'a>(step: &'a StepEntry, on: &'a str) -> impl Iterator<Item = &'a ConditionEntry> {
    step.conditions.iter().filter(move |c| c.on.value == on)
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
        let starts = value * share + beside + 0.0; // Not −0.
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
            let share = c.last_share();
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

const AXES: [&str; 3] = ["x", "y", "z"];
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
