//! Bodies and tools within each other before anything moves: warnings, with the depth and the place.

use crate::deck::entries::Deck;
use crate::deck::finding::Findings;
use crate::driver::{Driver, LeastGap};
use crate::numbers::{place, shown};

/// What is within what, by how much and where.
pub(super) fn sentence<const D: usize>(
    deck: &Deck,
    driver: &Driver<D>,
    gap: &LeastGap<D>,
) -> String {
    let (surface, opposite) = driver.contact_name(gap.contact);
    let (depth, length) = (shown(-gap.gap, 6), deck.units.length());
    let what = match deck.tools.iter().any(|t| t.name.value == opposite) {
        true => format!("the tool \"{opposite}\" begins inside of the body at \"{surface}\""),
        false => format!("the bodies at \"{surface}\" and \"{opposite}\" overlap"),
    };
    let consequence = match gap.met {
        true => {
            "the first increment pushes apart what is free to move, with the stresses that this takes; if \
             that is not meant, move one of them, or let the contact `adjust` its gaps"
        }
        false => {
            "deeper than a facet is long, so that no contact is found between them: move one of them"
        }
    };
    format!(
        "{what}, by {depth} {length} at node {} at {}, {} nodes in all; {consequence}",
        gap.node,
        place(&gap.position, 4),
        gap.inside
    )
}

/// Warns of every contact that begins with a penetration which its `gap-offset` does not ask for.
pub(super) fn warn<const D: usize>(
    deck: &Deck,
    driver: &Driver<D>,
    gaps: &[LeastGap<D>],
    findings: &mut Findings,
) {
    for gap in gaps.iter().filter(|g| g.inside > 0) {
        let Some(entry) = deck.contacts.get(gap.contact) else {
            continue;
        };
        let asked = entry.gap_offset.as_ref().map_or(0.0, |o| o.value.max(0.0));
        // Told is what is beyond that: where curved meshes do not match there is a little.
        let beyond = match gap.met {
            true => LeastGap {
                gap: gap.gap + asked,
                inside: driver.nodes_within(gap.contact, asked + driver.rounding_of_gaps()),
                ..*gap
            },
            false => *gap,
        };
        if beyond.inside > 0 {
            let message = sentence(deck, driver, &beyond);
            findings.warning(&entry.surface.span, message, "inside from the first");
        }
    }
}
