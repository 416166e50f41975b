//! Bodies of a single layer of cells with the mean dilatation, which bend too softly: warnings.

use super::mean;
use crate::deck::build::Stage;
use crate::deck::build::groups::Groups;
use crate::deck::build::parts::quadrature;
use crate::deck::entries::{Analysis, Deck, MaterialEntry, Shape};
use crate::deck::finding::{At, Findings};
use crate::driver::{Driver, Loading};
use crate::mesh::{CellKind, Facet, Integration, Mesh};
use crate::numbers::place;
use nalgebra::SVector;
use std::collections::{BTreeMap, BTreeSet};

/// Fewest cells of a layer that may bend.
const CELLS: usize = 3;

/// Length between the centres of the outermost cells of a layer over its thickness, from which on it may bend: that of three
/// square ones.
const LONG: f64 = 2.0;

/// Part of a length, and of the square of a direction, that is rounding.
const ROUNDING: f64 = 1e-6;

/// Warns of every body of a single layer, once.
pub(in crate::deck::build) fn warn<const D: usize>(
    deck: &Deck,
    (driver, stages): (&Driver<D>, &[Stage<D>]),
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    let mesh = &groups.mesh;
    let averaged = averaged(deck, mesh);
    if averaged.is_empty() {
        return;
    }
    let free = free(deck, (driver, stages), mesh);
    for body in mesh.bodies() {
        let own = body.iter().filter(|cell| averaged.contains_key(cell));
        let thin = own
            .clone()
            .filter_map(|&c| Some((c, thickness(mesh, c, &free)?)));
        let (all, thin): (usize, Vec<(usize, f64)>) = (own.clone().count(), thin.collect());
        if thin.len() >= CELLS && 2 * thin.len() > all && is_long(mesh, &thin) {
            tell(mesh, (&thin, all), averaged[&thin[0].0], findings);
        }
    }
}

/// The facets of the surface across which nothing holds a body throughout: they are on no support, no table, no axis, and tied to
/// nothing.
fn free<const D: usize>(
    deck: &Deck,
    (driver, stages): (&Driver<D>, &[Stage<D>]),
    mesh: &Mesh<D>,
) -> BTreeSet<Facet> {
    let loadings: Vec<Loading<D>> = stages
        .iter()
        .filter_map(|stage| driver.loading(&stage.step).ok())
        .collect();
    let bends = |facet: &Facet| {
        let held = |loading| is_held(mesh, *facet, loading);
        let on_axis = deck.analysis == Analysis::Axisymmetric && is_on_axis(mesh, *facet);
        !on_axis && (loadings.is_empty() || !loadings.iter().all(held))
    };
    let of = |side: &At<String>| mesh.facet_group(&side.value).unwrap_or_default();
    let mut free: BTreeSet<Facet> = mesh.boundary_facets().into_iter().collect();
    for facet in deck
        .ties
        .iter()
        .flat_map(|tie| [&tie.surface, &tie.to])
        .flat_map(of)
    {
        free.remove(facet);
    }
    for contact in &deck.contacts {
        let tool = (deck.tools.iter()).find(|tool| tool.name.value == contact.against.value);
        if let Some(Shape::Plane(point, normal)) = tool.map(|tool| &tool.shape.value) {
            let bedded = of(&contact.surface).iter();
            let bedded = bedded.filter(|&&facet| lies_on(mesh, facet, (point, normal)));
            bedded.for_each(|facet| {
                free.remove(facet);
            });
        }
    }
    free.retain(bends);
    free
}

fn tell<const D: usize>(
    mesh: &Mesh<D>,
    (thin, all): (&[(usize, f64)], usize),
    material: &MaterialEntry,
    findings: &mut Findings,
) {
    let cell = thin[0].0;
    let kind = mesh.kind(cell);
    let quadratic = match kind {
        CellKind::Hex8 => "hex20",
        _ => "quad8",
    };
    let message = format!(
        "{} of the {all} {kind} cells of a body have its surface on two opposite sides, as cell {cell} at {}: a single layer with \
         quadrature = \"b-bar\" bends across itself with two thirds of its stiffness or less, however fine it is along; use two \
         or more cells across, four of which lack a fiftieth, or {quadratic}",
        thin.len(),
        place(centre(mesh, cell).as_slice(), 4),
    );
    findings.warning(&material.on.span, message, "a single layer of cells");
}

/// The cells of which the dilatation is a mean, with their material.
fn averaged<'a, const D: usize>(
    deck: &'a Deck,
    mesh: &Mesh<D>,
) -> BTreeMap<usize, &'a MaterialEntry> {
    let mut averaged = BTreeMap::new();
    for material in &deck.materials {
        let is_averaged = |kind: CellKind| {
            let linear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
            linear && quadrature(kind, material, deck.analysis) == Integration::BBar
        };
        let cells = mesh.cell_group(&material.on.value).unwrap_or_default();
        let own = cells.iter().filter(|&&cell| is_averaged(mesh.kind(cell)));
        averaged.extend(own.map(|&cell| (cell, material)));
    }
    averaged
}

fn centre<const D: usize>(mesh: &Mesh<D>, cell: usize) -> SVector<f64, D> {
    let nodes = mesh.cell_nodes(cell).iter();
    let places: Vec<SVector<f64, D>> = nodes.map(|&a| SVector::from(mesh.nodes()[a])).collect();
    mean(&places)
}

/// How far two opposite facets of a cell are apart, the least, where both are among the free ones.
fn thickness<const D: usize>(mesh: &Mesh<D>, cell: usize, free: &BTreeSet<Facet>) -> Option<f64> {
    let facets = mesh.kind(cell).facets();
    let number = 0..facets.len();
    let pairs = number.flat_map(|a| (a + 1..facets.len()).map(move |b| [a, b]));
    let opposite = pairs.filter(|[a, b]| facets[*a].iter().all(|node| !facets[*b].contains(node)));
    let facets = opposite.map(|pair| pair.map(|facet| Facet { cell, facet }));
    facets
        .filter(|pair| pair.iter().all(|facet| free.contains(facet)))
        .map(|pair| pair.map(|facet| super::centre(mesh, facet)))
        .map(|[a, b]| (a - b).norm())
        .reduce(f64::min)
}

/// Whether a layer is long enough to bend.
fn is_long<const D: usize>(mesh: &Mesh<D>, thin: &[(usize, f64)]) -> bool {
    let thickness = thin.iter().map(|(_, t)| t).sum::<f64>() / thin.len() as f64;
    let first = centre(mesh, thin[0].0);
    let (mut low, mut high) = (first, first);
    for (cell, _) in thin {
        let at = centre(mesh, *cell);
        (low, high) = (low.inf(&at), high.sup(&at));
    }
    (high - low).norm() >= LONG * thickness * (1.0 - ROUNDING)
}

/// Whether a loading prescribes how all nodes of a facet move across it.
fn is_held<const D: usize>(mesh: &Mesh<D>, facet: Facet, loading: &Loading<D>) -> bool {
    let corners = super::corners(mesh, facet);
    // Of two opposite facets the way from one centre to the other is across them; here that to the centre of the cell.
    let across = super::centre(mesh, facet) - centre(mesh, facet.cell);
    let mut along: Vec<SVector<f64, D>> = Vec::new();
    for k in 1..D {
        let edge = corners[k] - corners[k - 1];
        let left = along.iter().fold(edge, |e, a| e - a * a.dot(&e));
        along.extend(left.try_normalize(0.0));
    }
    let normal = along.iter().fold(across, |n, a| n - a * a.dot(&n));
    let Some(normal) = normal.try_normalize(0.0) else {
        return false;
    };
    let mut nodes = mesh.facet_nodes(facet);
    nodes.all(|a| {
        let dofs = (D * a..D * a + D).filter(|dof| loading.displacement.contains_key(dof));
        let parts = dofs.map(|dof| loading.directions.along::<D>(dof).dot(&normal));
        parts.map(|part| part * part).sum::<f64>() > 1.0 - ROUNDING
    })
}

/// Whether a facet lies on the axis of revolution.
fn is_on_axis<const D: usize>(mesh: &Mesh<D>, facet: Facet) -> bool {
    let mut nodes = mesh.facet_nodes(facet);
    nodes.all(|a| mesh.nodes()[a][0].abs() <= ROUNDING * mesh.size())
}

/// Whether a facet lies on a plane.
fn lies_on<const D: usize>(
    mesh: &Mesh<D>,
    facet: Facet,
    (point, normal): (&[f64], &[f64]),
) -> bool {
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    let mut nodes = mesh.facet_nodes(facet);
    nodes.all(|a| {
        let from = mesh.nodes()[a].iter().zip(point).map(|(x, p)| x - p);
        let above: f64 = from.zip(normal).map(|(d, n)| d * n).sum();
        above.abs() <= ROUNDING * mesh.size() * length
    })
}
