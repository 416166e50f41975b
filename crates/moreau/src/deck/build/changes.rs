//! What changes from the end of a step to that of the next: something, and in a step to collapse loads, and no temperature or
//! stress at the start beside them.

use super::Stage;
use super::groups::Groups;
use crate::deck::entries::{Action, ConditionEntry, Deck, StepEntry};
use crate::deck::finding::{At, Class, Findings};
use crate::driver::{Driver, Loading};

pub(super) fn check<const D: usize>(
    (deck, groups): (&Deck, &Groups<D>),
    driver: &Driver<D>,
    stages: &[Stage<D>],
    findings: &mut Findings,
) {
    stressed(deck, findings);
    let cells: Vec<usize> = driver.points().iter().map(|point| point.cell).collect();
    let tools = D * driver.mesh().nodes().len();
    let mut before = Loading::default();
    for (number, stage) in stages.iter().enumerate() {
        // What each step asks for has been found possible.
        let Ok(now) = driver.loading(&stage.step) else {
            return;
        };
        // Where a structure has collapsed is known in the run only.
        let known = !stages[..number].last().is_some_and(|s| s.until_collapse);
        if stage.until_collapse {
            let temperatures = (&before.temperature, &now.temperature);
            let of = |k: usize| [temperatures.0.at(k), temperatures.1.at(k)];
            let changed = (0..cells.len()).find(|&k| of(k)[0] != of(k)[1]);
            if let Some(k) = changed {
                heated((deck, groups), number, (cells[k], of(k)), findings);
            }
            if known && !loads(&before, &now) {
                loads_nothing(&deck.steps[number], findings);
            }
        } else if let ([.., last], true) = (&deck.steps[..number], known)
            && !changes((&before, &now), tools)
            && !varies(&deck.steps[..number], &deck.steps[number])
        {
            idle([last, &deck.steps[number]], findings);
        }
        before = now;
    }
}

/// Whether loads change on the way from one loading to another, or a reaction goes that held something.
fn loads<const D: usize>(before: &Loading<D>, now: &Loading<D>) -> bool {
    let let_go = |dof: &usize| !now.displacement.contains_key(dof);
    before.force != now.force
        || before.pressure != now.pressure
        || before.directions != now.directions
        || before.displacement.keys().any(let_go)
}

/// A step to collapse that only moves: there is no factor to find.
fn loads_nothing(step: &StepEntry, findings: &mut Findings) {
    let message = format!(
        "step \"{}\" has until = \"collapse\", and no load grows in it: a limit load is one of loads, not of motions",
        step.name.value
    );
    let help = "give it a `load` with the pressure, traction, force or body-force that the structure must not carry, or a tool a \
                `force` or a `moment`; without until = \"collapse\" it ends where what it moves has arrived";
    findings
        .error_with(&step.name.span, message, "loads nothing", help)
        .about(Class::Steps);
}

/// Whether anything is other in one loading than in another, but for where tools are: each loading has those there that its
/// step does not name as it had begun. Their degrees of freedom come last.
fn changes<const D: usize>((before, now): (&Loading<D>, &Loading<D>), tools: usize) -> bool {
    let mut before = before.clone();
    before.turn = now.turn.clone();
    for (dof, u) in before.displacement.range_mut(tools..) {
        *u = now.displacement.get(dof).copied().unwrap_or(*u);
    }
    before != *now
}

/// Whether something varies within a step, or a tool goes elsewhere than where the steps before have left it.
fn varies(before: &[StepEntry], step: &StepEntry) -> bool {
    let mut conditions = step.conditions.iter();
    conditions.any(|c| c.table.is_some() || moves_on(before, c) || turns_on(before, c))
}

/// What steps have told of a tool, the last first.
fn told<'a>(before: &'a [StepEntry], tool: &'a str) -> impl Iterator<Item = &'a ConditionEntry> {
    let all = before.iter().rev().flat_map(|step| &step.conditions);
    all.filter(move |c| c.on.value == tool)
}

/// Whether a condition moves a tool from where the steps before have left it, or from a place that only the run knows.
fn moves_on(before: &[StepEntry], condition: &ConditionEntry) -> bool {
    let (Action::Tool(Some(u), _) | Action::Push(_, Some(u))) = &condition.action else {
        return false;
    };
    let moves =
        |c: &&ConditionEntry| matches!(c.action, Action::Tool(Some(_), _) | Action::Push(..));
    let from = |v: &[f64], share: f64| v.iter().zip(u).any(|(v, u)| v * share != *u);
    match told(before, &condition.on.value).find(moves) {
        None => u.iter().any(|u| *u != 0.0),
        Some(last) => match (&last.action, &condition.action) {
            (Action::Tool(Some(v), _), _) | (Action::Push(_, Some(v)), Action::Push(..)) => {
                from(v, last.last_share())
            }
            _ => true,
        },
    }
}

/// The same of how far a tool has turned.
fn turns_on(before: &[StepEntry], condition: &ConditionEntry) -> bool {
    let Action::Tool(_, Some(turn)) = &condition.action else {
        return false;
    };
    let turns =
        |c: &&ConditionEntry| matches!(c.action, Action::Tool(_, Some(_)) | Action::Moment(_));
    match told(before, &condition.on.value).find(turns) {
        None => turn.angle != 0.0,
        Some(last) => match &last.action {
            Action::Tool(_, Some(of)) => {
                of.axis != turn.axis || of.angle * last.last_share() != turn.angle
            }
            _ => true,
        },
    }
}

/// A step in which nothing changes: of laws that know no time nothing comes of it.
fn idle([last, step]: [&StepEntry; 2], findings: &mut Findings) {
    let message = format!(
        "nothing changes in step \"{}\": what it holds, moves and loads is as at the end of step \"{}\". Values are totals, \
         counted from the undeformed state: what is to go on has a larger one",
        step.name.value, last.name.value
    );
    findings.warning(&step.name.span, message, "as the step before");
}

/// Tells of a cell whose temperature changes in a step. Where that is held, thermal stresses are what they were, and what they
/// press has its friction; where it changes beside the loads there is no one factor.
fn heated<const D: usize>(
    (deck, groups): (&Deck, &Groups<D>),
    number: usize,
    (cell, [before, now]): (usize, [f64; 2]),
    findings: &mut Findings,
) {
    let cells = |on: &str| groups.mesh.cell_group(on).unwrap_or_default();
    let heats = |step: &StepEntry| -> Option<At<String>> {
        let heats = step.conditions.iter().find(|c| {
            matches!(c.action, Action::Temperature(_)) && cells(&c.on.value).contains(&cell)
        });
        heats.map(|c| c.on.clone())
    };
    let step = &deck.steps[number];
    let why = "whose load factor is that of loads alone";
    let (span, message, remedy) = match heats(step) {
        Some(on) => (
            on.span,
            format!(
                "the temperature of \"{}\" changes from {before} to {now} K in a step with until = \"collapse\", {why}",
                on.value
            ),
            "a step before this one that brings it there, and the same temperature here".to_owned(),
        ),
        None => {
            let last = number.checked_sub(1).map(|last| &deck.steps[last]);
            let on = last.and_then(heats).map(|on| on.value).unwrap_or_default();
            (
                step.span.clone(),
                format!(
                    "a step with until = \"collapse\", {why}, takes \"{on}\" back to where it was free of stress, as a step that \
                     gives no temperature does"
                ),
                format!(
                    "the temperature of \"{on}\" as in the step before, or a step before this one that takes it back"
                ),
            )
        }
    };
    findings
        .error_with(
            &span,
            message,
            "not that of the end of the step before",
            remedy,
        )
        .about(Class::Steps);
}

/// What holds a stress at the start is a force that goes in proportion to the first step.
fn stressed(deck: &Deck, findings: &mut Findings) {
    let first = deck.steps.first().filter(|step| step.until_collapse);
    let stressed = deck
        .initial
        .iter()
        .find(|i| i.stress.iter().any(Option::is_some));
    if let (Some(_), Some(initial)) = (first, stressed) {
        findings.error_with(
            &initial.span,
            "until = \"collapse\" in the first step with a stress at the start, which what holds it would falsify",
            "is held until the end of the first step",
            "begin with a step that lets it go, of the same `fix` and without loads, or with those that balance it",
        );
    }
}
