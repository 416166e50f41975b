//! Methods for the contact problem that need the inverse of a stiffness: errors where a step has none. Whatever contacts, ties
//! or the surfaces before a driven tool have to hold is a motion without stiffness to them.

use super::groups::Groups;
use crate::deck::entries::{Action, Deck, Method};
use crate::deck::finding::Findings;
use crate::driver::{Stopper, Support};

/// The key of a method that needs every body held by displacements, and every tool moved; `None` of the others.
fn inverting(deck: &Deck) -> Option<&'static str> {
    match (deck.solver.outside, &deck.solver.method) {
        (true, _) => Some("nesting = \"outside\""),
        (_, Method::Uzawa) => Some("contact = \"uzawa\""),
        (_, Method::GaussSeidel) => Some("contact = \"gauss-seidel\""),
        _ => None,
    }
}

/// Refuses a method in the first step that it cannot solve, with the bodies' supports in every step.
pub(super) fn check<const D: usize>(
    deck: &Deck,
    supports: &[Vec<Support>],
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    let Some(method) = inverting(deck) else {
        return;
    };
    let mut refuse = |step: &str, problem: &str, way_out: &str| {
        findings.error_with(
            &deck.solver.chosen,
            format!(
                "{method} in step \"{step}\": {problem}, and this method needs the inverse of a stiffness without its \
                 contacts"
            ),
            "does not go with this step",
            format!("`contact = \"exact\"`, which needs no inverse; or {way_out}"),
        );
    };
    for (entry, bodies) in deck.steps.iter().zip(supports) {
        let step = &entry.name.value;
        let drives = |action: &Action| matches!(action, Action::Push(..) | Action::Moment(_));
        if let Some(driven) = entry.conditions.iter().find(|c| drives(&c.action)) {
            let problem = format!(
                "the tool \"{}\" is driven, and nothing but its contacts resists that",
                driven.on.value
            );
            return refuse(step, &problem, "prescribe the motion of the tool");
        }
        for body in bodies {
            let held = |stopper: Stopper| match stopper {
                Stopper::Displacement => None,
                Stopper::Tie => Some("ties alone stop"),
                Stopper::Contact => Some("contacts alone stop"),
                Stopper::Friction => Some("friction alone stops"),
            };
            let mut motions = body.motions.iter();
            let Some((name, stops)) =
                motions.find_map(|m| Some((&m.name, m.stopper.and_then(held)?)))
            else {
                continue;
            };
            let (body, _) = groups.origin(deck, body.cell);
            let problem = format!("{stops} the {name} of the body \"{body}\"");
            return refuse(step, &problem, "hold the body by displacements");
        }
    }
}
