//! Bodies that lie on each other, or within each other, and cells that share volume, where nothing joins them: warnings.

use super::groups::Groups;
use crate::deck::entries::Deck;
use crate::deck::finding::Findings;
use crate::driver::Driver;
use crate::mesh::Facet;
use crate::numbers::{place, shown};
use std::collections::BTreeMap;
use std::ops::Range;

/// The names of two bodies, and where the deck asks for the second.
type Pair = ([String; 2], Range<usize>);

pub(super) fn warn<const D: usize>(
    deck: &Deck,
    driver: &Driver<D>,
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    seams(deck, driver, groups, findings);
    within(deck, driver, groups, findings);
    shared(deck, groups, findings);
}

/// The bodies of two cells.
fn pair<const D: usize>(deck: &Deck, groups: &Groups<D>, cells: [usize; 2]) -> Pair {
    let [(own, _), (other, span)] = cells.map(|cell| groups.origin(deck, cell));
    ([own, other], span)
}

/// What is found of pairs of cells, by the pair of bodies that they are of: the first of them, and how many.
fn by_bodies<T, const D: usize>(
    (deck, groups): (&Deck, &Groups<D>),
    found: Vec<T>,
    cells: impl Fn(&T) -> [usize; 2],
) -> Vec<(Pair, Vec<T>)> {
    let bodies = groups.mesh.bodies();
    let mut body = vec![0; groups.mesh.cell_count()];
    for (k, cells) in bodies.iter().enumerate() {
        cells.iter().for_each(|&cell| body[cell] = k);
    }
    let mut sorted: BTreeMap<[usize; 2], Vec<T>> = BTreeMap::new();
    for item in found {
        let mut of = cells(&item).map(|cell| body[cell]);
        of.sort_unstable();
        sorted.entry(of).or_default().push(item);
    }
    let named = |all: Vec<T>| (pair(deck, groups, cells(&all[0])), all);
    sorted.into_values().map(named).collect()
}

/// Facets on each other.
fn seams<const D: usize>(
    deck: &Deck,
    driver: &Driver<D>,
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    let found = driver.unjoined_facets();
    for ((names, span), all) in by_bodies((deck, groups), found, |s| s.map(|f| f.cell)) {
        let mesh = &groups.mesh;
        let named = |facet: Facet| {
            let of = |name: &&str| {
                let facets = mesh.facet_group(name);
                facets.is_ok_and(|facets| facets.contains(&facet))
            };
            groups
                .names()
                .find(of)
                .map(|name| format!(" of \"{name}\""))
        };
        let [a, b] = all[0];
        let at = mesh.nodes()[mesh.facet_nodes(a).next().unwrap_or_default()];
        let surfaces = [a, b].map(|f| named(f).unwrap_or_default());
        let [own, other] = &names;
        let (what, means) = match own == other {
            true => (format!("in \"{own}\""), "that is a crack"),
            false => (
                format!("of \"{own}\" and \"{other}\""),
                "each moves as if the other were not there",
            ),
        };
        let message = format!(
            "{} pairs of facets {what} lie on each other with nodes of their own, as cell {}{} and cell {}{} at {}, and \
             neither a contact nor a tie is between them: {means}; let cells have their nodes in common there, or give a \
             tie or a contact",
            all.len(),
            a.cell,
            surfaces[0],
            b.cell,
            surfaces[1],
            place(&at, 4),
        );
        findings.warning(&span, message, "not joined");
    }
}

/// Bodies within each other.
fn within<const D: usize>(
    deck: &Deck,
    driver: &Driver<D>,
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    let found = driver.unjoined_nodes();
    for (([own, other], span), all) in by_bodies((deck, groups), found, |i| i.cells) {
        let deepest = all.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        let Some(deepest) = deepest else { continue };
        let message = format!(
            "the bodies \"{own}\" and \"{other}\" begin within each other, by {} {} at node {} at {}, {} nodes in all, \
             where neither a contact nor a tie is between them: both are there at once; move one of them",
            shown(deepest.depth, 4),
            deck.units.length(),
            deepest.node,
            place(&groups.mesh.nodes()[deepest.node], 4),
            all.len(),
        );
        findings.warning(&span, message, "within another body");
    }
}

/// Cells of one body that share volume.
fn shared<const D: usize>(deck: &Deck, groups: &Groups<D>, findings: &mut Findings) {
    let mesh = &groups.mesh;
    for (([own, other], span), all) in by_bodies((deck, groups), mesh.shared_volume(), |s| *s) {
        if own != other {
            continue;
        }
        let [a, b] = all[0];
        let message = format!(
            "{} cells of \"{own}\" share volume with others, as cell {a} at {} with cell {b}: what both fill is there twice; \
             leave one of them out of the mesh",
            all.len(),
            place(&mesh.nodes()[mesh.cell_nodes(a)[0]], 4),
        );
        findings.warning(&span, message, "cells within each other");
    }
}
