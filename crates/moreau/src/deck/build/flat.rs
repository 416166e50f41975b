//! Flat serendipity cells of the reduced rule below surfaces that touch, which are too soft: warnings.

mod layers;

pub(super) use layers::warn as warn_of_layers;

use super::groups::Groups;
use super::parts::quadrature;
use crate::deck::entries::Deck;
use crate::deck::finding::{At, Findings};
use crate::mesh::{CellKind, Facet, Mesh};
use crate::numbers::{place, shown};
use nalgebra::SVector;
use std::collections::BTreeSet;

/// Length of a cell along a surface over its depth, from which on it is told: at 4 a force at one node finds twice as much way.
const FLAT: f64 = 4.0;

/// The same at which forces are right to what meshes are.
const REMEDY: f64 = 3.0;

/// Part of a ratio that is rounding.
const ROUNDING: f64 = 1e-6;

/// Warns of every surface of a contact on flat cells, once.
pub(super) fn warn<const D: usize>(deck: &Deck, groups: &Groups<D>, findings: &mut Findings) {
    let soft = soft_cells(deck, &groups.mesh);
    let mut seen = BTreeSet::new();
    let sides = deck.contacts.iter().flat_map(|c| [&c.surface, &c.against]);
    for side in sides.filter(|side| seen.insert(&side.value)) {
        // The other side may be a tool.
        let facets = groups.mesh.facet_group(&side.value).unwrap_or_default();
        surface(&groups.mesh, (side, facets), &soft, findings);
    }
}

/// The cells that are soft where they are flat.
fn soft_cells<const D: usize>(deck: &Deck, mesh: &Mesh<D>) -> BTreeSet<usize> {
    let mut soft = BTreeSet::new();
    for material in &deck.materials {
        let is_soft = |kind: CellKind| kind.soft_if_flat(quadrature(kind, material, deck.analysis));
        let cells = mesh.cell_group(&material.on.value).unwrap_or_default();
        soft.extend(cells.iter().filter(|&&cell| is_soft(mesh.kind(cell))));
    }
    soft
}

fn surface<const D: usize>(
    mesh: &Mesh<D>,
    (side, facets): (&At<String>, &[Facet]),
    soft: &BTreeSet<usize>,
    findings: &mut Findings,
) {
    let own = facets.iter().filter(|f| soft.contains(&f.cell));
    let ratios = own.map(|&facet| (facet, flatness(mesh, facet)));
    let flat: Vec<(Facet, f64)> = ratios
        .filter(|(_, ratio)| *ratio > FLAT * (1.0 + ROUNDING))
        .collect();
    let Some(&(facet, ratio)) = flat.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return;
    };
    let kind = mesh.kind(facet.cell);
    let stiffer = match kind {
        CellKind::Hex20 => "hex27 or tet10",
        _ => "quad9 or tri6",
    };
    let message = format!(
        "{} of the {} facets of \"{}\" are of flat {kind} cells with reduced quadrature, cell {} at {} is {} times as long along \
         the surface as it is deep: forces that change from node to node, as those of contact do, find such cells too soft; \
         use cells at most {REMEDY} times as long there as they are deep, or quadrature = \"full\", or {stiffer}",
        flat.len(),
        facets.len(),
        side.value,
        facet.cell,
        place(centre(mesh, facet).as_slice(), 4),
        shown(ratio, 3),
    );
    findings.warning(&side.span, message, "cells too flat");
}

/// The corners of a facet, in turn.
fn corners<const D: usize>(mesh: &Mesh<D>, facet: Facet) -> Vec<SVector<f64, D>> {
    let nodes = mesh.facet_nodes(facet);
    let corners = nodes.take(mesh.facet_kind(facet).corner_count());
    corners.map(|a| SVector::from(mesh.nodes()[a])).collect()
}

fn centre<const D: usize>(mesh: &Mesh<D>, facet: Facet) -> SVector<f64, D> {
    mean(&corners(mesh, facet))
}

fn mean<const D: usize>(points: &[SVector<f64, D>]) -> SVector<f64, D> {
    points.iter().sum::<SVector<f64, D>>() / points.len() as f64
}

/// The longest edge of a facet over the depth of its cell below it, which is volume over area where sides are parallel.
fn flatness<const D: usize>(mesh: &Mesh<D>, facet: Facet) -> f64 {
    let corners = corners(mesh, facet);
    let edges = (0..corners.len()).map(|k| corners[(k + 1) % corners.len()] - corners[k]);
    let edges: Vec<SVector<f64, D>> = edges.collect();
    let length = edges.iter().fold(0.0, |most: f64, e| most.max(e.norm()));
    // Corners come first among the nodes of a cell, as many as 2^D of a cube.
    let all = mesh.cell_nodes(facet.cell).iter().take(1 << D);
    let all: Vec<SVector<f64, D>> = all.map(|&a| SVector::from(mesh.nodes()[a])).collect();
    // From the centre of the facet to that of the cell is half of the way through it.
    let mut down = 2.0 * (mean(&all) - mean(&corners));
    let mut along: Vec<SVector<f64, D>> = Vec::new();
    for edge in edges.iter().take(D - 1) {
        let across = along.iter().fold(*edge, |e, a| e - a * a.dot(&e));
        along.extend(across.try_normalize(0.0));
    }
    for direction in &along {
        down -= direction * direction.dot(&down);
    }
    length / down.norm()
}
