//! Nodes of tied surfaces that no tie holds: warnings; what cannot be tied at all is an error of the model.

use crate::deck::entries::Deck;
use crate::deck::finding::Findings;
use crate::driver::Driver;
use crate::numbers::place;

/// Warns of every tie with nodes that have nothing opposite.
pub(super) fn warn<const D: usize>(deck: &Deck, driver: &Driver<D>, findings: &mut Findings) {
    for (k, entry) in deck.ties.iter().enumerate() {
        let untied = driver.untied_nodes(deck.contacts.len() + k);
        let Some(&first) = untied.first() else {
            continue;
        };
        let (surface, to) = (&entry.surface.value, &entry.to.value);
        let (count, all) = (untied.len(), driver.mesh().node_group(surface));
        let message = format!(
            "{count} of the {} nodes of \"{surface}\" have nothing of \"{to}\" opposite, as node {first} at {}: they are \
             free, and may pass through what they meet later; tie a group of the facets that lie on \"{to}\" alone if \
             that is meant",
            all.map_or(0, |nodes| nodes.len()),
            place(&driver.mesh().nodes()[first], 4),
        );
        findings.warning(&entry.surface.span, message, "not all of it is tied");
    }
}
