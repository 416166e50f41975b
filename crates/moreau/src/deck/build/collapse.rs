//! What a step to collapse does not go with, whose loads alone grow: a temperature that changes, and a stress at the start.

use super::Stage;
use super::groups::Groups;
use crate::deck::entries::{Action, Deck, StepEntry};
use crate::deck::finding::{At, Class, Findings};
use crate::driver::{Driver, Temperature};

pub(super) fn check<const D: usize>(
    (deck, groups): (&Deck, &Groups<D>),
    driver: &Driver<D>,
    stages: &[Stage<D>],
    findings: &mut Findings,
) {
    stressed(deck, findings);
    let cells: Vec<usize> = driver.points().iter().map(|point| point.cell).collect();
    for (number, stage) in stages.iter().enumerate() {
        if !stage.until_collapse {
            continue;
        }
        let at_end = |stage: &Stage<D>| driver.loading(&stage.step).map(|l| l.temperature);
        let before = number.checked_sub(1).map(|last| at_end(&stages[last]));
        // What each step asks for has been found possible.
        let (Ok(before), Ok(now)) = (before.unwrap_or(Ok(Temperature::default())), at_end(stage))
        else {
            continue;
        };
        let changed = (0..cells.len()).find(|&k| before.at(k) != now.at(k));
        if let Some(point) = changed {
            let change = [before.at(point), now.at(point)];
            heated((deck, groups), number, (cells[point], change), findings);
        }
    }
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
