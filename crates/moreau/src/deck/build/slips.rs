//! What a deck may say and hardly ever means: another unit, a normal turned round. Warnings only.

use super::groups::Groups;
use super::parts::Surface;
use crate::deck::entries::{Action, ContactEntry, Curve, Deck, FrictionEntry};
use crate::deck::finding::{At, Findings};
use crate::mesh::Facet;
use crate::numbers::shown;
use nalgebra::SVector;

/// Part of Young's modulus that the yield stress of a solid stays below: metals a hundredth, polymers
/// a twentieth.
const STRONGEST: f64 = 0.1;

/// Part of a yield stress, and of an elastic strain, by which a table of total strains may miss both.
const NEAR_YIELD: f64 = 0.01;
const ELASTIC: f64 = 0.2;

/// Young's modulus of diamond, rounded up, and of soft rubber \[Pa\].
const STIFFEST: f64 = 2e12;
const SOFTEST: f64 = 1e6;

/// Cosine of the angle between an outward normal and the direction to a tool, from which on a surface faces it.
const FACES: f64 = 0.1;

/// Distance from a tool, in sizes of the mesh, that is not rounding.
const OUTSIDE: f64 = 1e-6;

/// Coefficient of friction from which on a number is rather one in percent.
const ROUGHEST: f64 = 10.0;

pub(super) fn warn<const D: usize>(
    deck: &Deck,
    groups: &Groups<D>,
    surface: Surface<D>,
    findings: &mut Findings,
) {
    soft(deck, findings);
    steep(deck, findings);
    total(deck, findings);
    stiff(deck, findings);
    rough(deck, findings);
    far(deck, groups, findings);
    inside(deck, groups, surface, findings);
    away(deck, groups, surface, findings);
}

/// A modulus in another unit than the yield stress.
fn soft(deck: &Deck, findings: &mut Findings) {
    let unit = deck.units.stress();
    for material in &deck.materials {
        let Some(strength) = &material.yield_stress else {
            continue;
        };
        if strength.value > STRONGEST * material.young.value {
            let message = format!(
                "\"{}\" yields at {} {unit}, more than a tenth of its Young's modulus of {} {unit}: \
                 both are in {unit}",
                material.on.value, strength.value, material.young.value
            );
            findings.warning(&material.young.span, message, "in another unit?");
        }
    }
}

/// A hardening modulus beyond that of elasticity.
fn steep(deck: &Deck, findings: &mut Findings) {
    let unit = deck.units.stress();
    for material in &deck.materials {
        let Some(hardening) = &material.isotropic else {
            continue;
        };
        let (modulus, young) = (hardening.value.linear, material.young.value);
        if modulus > young {
            let message = format!(
                "\"{}\" hardens by {modulus:?} {unit}, more than its Young's modulus of {young:?} {unit}: a slope of stress \
                 over plastic strain, both in {unit}",
                material.on.value
            );
            findings.warning(&hardening.span, message, "in another unit?");
        }
    }
}

/// A table of total strains: it has the yield stress at the elastic strain, and not at 0.
fn total(deck: &Deck, findings: &mut Findings) {
    let unit = deck.units.stress();
    for material in &deck.materials {
        let curve = material.isotropic.as_ref().map(|h| &h.value.curve);
        let (Some(Some(Curve::Table(rows))), Some(strength)) = (curve, &material.yield_stress)
        else {
            continue;
        };
        let Some(At {
            value: [p, stress],
            span,
        }) = rows.first()
        else {
            continue;
        };
        let elastic = stress / material.young.value;
        let is_near = |a: f64, b: f64, part: f64| (a - b).abs() <= part * b;
        if is_near(*stress, strength.value, NEAR_YIELD) && is_near(*p, elastic, ELASTIC) {
            let message = format!(
                "the hardening of \"{}\" begins at a plastic strain of {p:?} with the yield stress, which is there from 0 on: \
                 {stress:?} {unit} over Young's modulus is an elastic strain of {}; take it from all strains of the table",
                material.on.value,
                shown(elastic, 3)
            );
            findings.warning(span, message, "total strains?");
        }
    }
}

/// A modulus that no solid has, or a solid that yields has not.
fn stiff(deck: &Deck, findings: &mut Findings) {
    let unit = deck.units.stress();
    for material in &deck.materials {
        let young = &material.young;
        let pascal = young.value * deck.units.pascal();
        let told = if pascal > STIFFEST {
            format!(
                "stiffer than diamond, {:.3e} {unit}",
                STIFFEST / deck.units.pascal()
            )
        } else if pascal < SOFTEST && material.yields().is_some() {
            format!(
                "softer than rubber, {:.3e} {unit}, and yields",
                SOFTEST / deck.units.pascal()
            )
        } else {
            continue;
        };
        let message = format!(
            "Young's modulus of \"{}\" is {:?} {unit}: that is {told}",
            material.on.value, young.value
        );
        findings.warning(&young.span, message, "in another unit?");
    }
}

/// Friction in percent.
fn rough(deck: &Deck, findings: &mut Findings) {
    for contact in &deck.contacts {
        let (FrictionEntry::Coulomb(mu) | FrictionEntry::Limited(mu, _)) = &contact.friction else {
            continue;
        };
        if mu.value >= ROUGHEST {
            let message = format!(
                "the coefficient of friction of \"{}\" is {:?}: a tenth is 0.1, and more than a few \
                 is no more than sticking",
                contact.surface.value, mu.value
            );
            findings.warning(&mu.span, message, "in percent?");
        }
    }
}

/// Displacements, or a mesh, in another unit of length.
fn far<const D: usize>(deck: &Deck, groups: &Groups<D>, findings: &mut Findings) {
    let (size, unit) = (groups.mesh.size(), deck.units.length());
    for condition in deck.steps.iter().flat_map(|s| &s.conditions) {
        let largest = match &condition.action {
            Action::Move(components) => components.iter().fold(0.0, |m: f64, c| c.1.abs().max(m)),
            Action::MoveAlong(_, u) => u.abs(),
            _ => continue,
        };
        if largest > size {
            let message = format!(
                "\"{}\" is moved by {} {unit}, but the whole mesh is {size:.3} {unit} in size: both are in \
                 {unit}",
                condition.on.value,
                shown(largest, 6)
            );
            findings.warning(&condition.span, message, "in another unit?");
        }
    }
}

/// Tools that face away from the body: its cells at the contact are within them.
fn inside<const D: usize>(
    deck: &Deck,
    groups: &Groups<D>,
    surface: Surface<D>,
    findings: &mut Findings,
) {
    for contact in &deck.contacts {
        let tool = deck
            .tools
            .iter()
            .find(|t| t.name.value == contact.against.value);
        let (Some(tool), Ok(facets)) = (tool, groups.mesh.facet_group(&contact.surface.value))
        else {
            continue;
        };
        let Some(Ok(obstacle)) = surface(&tool.shape.value) else {
            continue;
        };
        let center = |cell: usize| {
            let nodes = groups.mesh.cell_nodes(cell);
            let at = |&n: &usize| SVector::from(groups.mesh.nodes()[n]);
            nodes.iter().map(at).sum::<SVector<f64, D>>() / nodes.len() as f64
        };
        if facets
            .iter()
            .all(|f| obstacle.distance(&center(f.cell)) < 0.0)
        {
            let message = format!(
                "all cells at \"{}\" lie inside of the tool \"{}\": a normal points out of the tool, \
                 a polyline has it on its right, and `inside = true` makes a tool hollow",
                contact.surface.value, tool.name.value
            );
            findings.warning(&tool.shape.span, message, "turned round?");
        }
    }
}

/// Tools that no surface given to them faces: only its edge can touch.
fn away<const D: usize>(
    deck: &Deck,
    groups: &Groups<D>,
    surface: Surface<D>,
    findings: &mut Findings,
) {
    let steps = deck.steps.iter().flat_map(|s| &s.conditions);
    let turns = |tool: &str| {
        let is_turn = |a: &Action| matches!(a, Action::Tool(_, Some(_)) | Action::Moment(_));
        steps
            .clone()
            .any(|c| c.on.value == tool && is_turn(&c.action))
    };
    let mesh = &groups.mesh;
    for tool in deck.tools.iter().filter(|t| !turns(&t.name.value)) {
        let against = |c: &&ContactEntry| c.against.value == tool.name.value;
        let contacts: Vec<&ContactEntry> = deck.contacts.iter().filter(against).collect();
        let (Some(first), Some(Ok(obstacle))) = (contacts.first(), surface(&tool.shape.value))
        else {
            continue;
        };
        let facets = contacts
            .iter()
            .filter_map(|c| mesh.facet_group(&c.surface.value).ok());
        let facets: Vec<Facet> = facets.flatten().copied().collect();
        let normals = mesh.node_normals(mesh.nodes(), &facets);
        let faces = |(&node, normal): (&usize, &[f64; D])| {
            let x = SVector::from(mesh.nodes()[node]);
            -SVector::from(*normal).dot(&obstacle.normal(&x)) > FACES
        };
        // What is inside of a tool is told to have it turned round, and that it begins there.
        let farther = |node: &usize, side: f64| {
            let x = SVector::from(mesh.nodes()[*node]);
            side * obstacle.distance(&x) > OUTSIDE * mesh.size()
        };
        let lies_outside = normals.keys().any(|node| farther(node, 1.0))
            && !normals.keys().any(|node| farther(node, -1.0));
        if lies_outside && !normals.iter().any(faces) {
            let message = format!(
                "\"{}\" does not face the tool \"{}\" anywhere: only its edge can touch, and what lies beside it passes into the \
                 tool; give the side of the body that is opposite",
                first.surface.value, tool.name.value
            );
            findings.warning(&first.surface.span, message, "another side?");
        }
    }
}
