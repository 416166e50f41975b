//! Laws, tools and frictions of a deck, and the model they make; their ranges are checked by the
//! libraries.

use super::groups::HIDDEN;
use crate::contact::{Ball, ContactError, Plane};
use crate::deck::entries::{Deck, MaterialEntry, Shape};
use crate::deck::finding::Findings;
use crate::driver::{Analysis, Model, ModelError};
use crate::laws::{Coulomb, Elastic, LawError, VonMises};
use crate::mesh::{CellKind, Integration, Mesh, MeshError};
use std::ops::Range;

/// A bulk law.
#[derive(Debug, Clone, Copy)]
enum Law {
    Elastic(Elastic),
    VonMises(VonMises),
}

/// What a model needs beside its mesh.
pub(super) struct Parts {
    laws: Vec<Law>,
    frictions: Vec<Coulomb>,
}

/// A rigid surface.
enum Surface<const D: usize> {
    Plane(Plane<D>),
    Ball(Ball<D>),
}

/// The laws; `None` if some are none.
pub(super) fn parts(deck: &Deck, findings: &mut Findings) -> Option<Parts> {
    let mut laws = Vec::new();
    for material in &deck.materials {
        match law(material) {
            Ok(law) => laws.push(law),
            Err(error) => {
                let span = culprit(material, &error);
                findings.error(&span, error.to_string(), "out of range");
            }
        }
        locking(material, findings);
    }
    let mut frictions = Vec::new();
    for contact in &deck.contacts {
        match Coulomb::new(contact.friction.value) {
            Ok(law) => frictions.push(law),
            Err(error) => {
                let span = &contact.friction.span;
                findings.error(span, error.to_string(), "out of range");
            }
        }
        if contact.friction.value == 0.0 {
            findings.warning(
                &contact.friction.span,
                format!(
                    "the contact of \"{}\" is frictionless",
                    contact.surface.value
                ),
                "friction 0",
            );
        }
    }
    for tool in &deck.tools {
        let checked = match deck.analysis.dimension() {
            2 => surface::<2>(&tool.shape.value).map(|_| ()),
            _ => surface::<3>(&tool.shape.value).map(|_| ()),
        };
        if let Err(error) = checked {
            findings.error(&tool.shape.span, error.to_string(), "out of range");
        }
    }
    (findings.errors() == 0).then_some(Parts { laws, frictions })
}

fn law(material: &MaterialEntry) -> Result<Law, LawError> {
    let (young, poisson) = (material.young.value, material.poisson.value);
    let Some(yield_stress) = &material.yield_stress else {
        return Ok(Law::Elastic(Elastic::new(young, poisson)?));
    };
    let value = |m: &Option<crate::deck::At<f64>>| m.as_ref().map_or(0.0, |m| m.value);
    let law = VonMises::new(young, poisson, yield_stress.value)?
        .with_isotropic(value(&material.isotropic))?
        .with_kinematic(value(&material.kinematic))?;
    Ok(Law::VonMises(law))
}

/// Place of the value that a law complains about.
fn culprit(material: &MaterialEntry, error: &LawError) -> Range<usize> {
    let at = match error {
        LawError::PoissonOutOfRange { .. } => Some(&material.poisson),
        LawError::NotPositive { name, .. } if name.contains("yield") => {
            material.yield_stress.as_ref()
        }
        LawError::Negative { name, .. } if name.contains("kinematic") => {
            material.kinematic.as_ref()
        }
        LawError::Negative { .. } => material.isotropic.as_ref(),
        _ => None,
    };
    at.unwrap_or(&material.young).span.clone()
}

/// The rule that does not lock for an element, or the one that the deck asks for.
fn quadrature(kind: CellKind, material: &MaterialEntry) -> Integration {
    match &material.quadrature {
        Some(rule) => rule.value,
        None if matches!(kind, CellKind::Tri6 | CellKind::Quad8 | CellKind::Quad9) => {
            Integration::Reduced
        }
        None => Integration::Full,
    }
}

/// The rules of the cells of a material, each with the kinds that have it.
pub(in crate::deck) fn quadratures(material: &MaterialEntry) -> Vec<(Integration, Vec<CellKind>)> {
    let mut rules: Vec<(Integration, Vec<CellKind>)> = Vec::new();
    for &kind in &material.kinds {
        let rule = quadrature(kind, material);
        match rules.iter_mut().find(|(r, _)| *r == rule) {
            Some((_, kinds)) => kinds.push(kind),
            None => rules.push((rule, vec![kind])),
        }
    }
    rules
}

fn locking(material: &MaterialEntry, findings: &mut Findings) {
    let Some(yield_stress) = &material.yield_stress else {
        return;
    };
    for &kind in &material.kinds {
        let quadratic = matches!(kind, CellKind::Tri6 | CellKind::Quad8 | CellKind::Quad9);
        let full = quadrature(kind, material) == Integration::Full;
        if full && !quadratic {
            findings.warning(
                &yield_stress.span,
                format!(
                    "{kind} with full quadrature locks in plastic flow: loads come out too high; \
                     use a quadratic element"
                ),
                "plastic flow keeps volumes",
            );
        }
    }
}

fn surface<const D: usize>(shape: &Shape) -> Result<Surface<D>, ContactError> {
    let fixed = |v: &[f64]| std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0));
    Ok(match shape {
        Shape::Plane(point, normal) => Surface::Plane(Plane::new(fixed(point), fixed(normal))?),
        Shape::Ball(center, radius, hollow, _) => {
            let ball = Ball::new(fixed(center), *radius)?;
            Surface::Ball(if *hollow { ball.hollow() } else { ball })
        }
    })
}

/// The group of a material with its rule; where its cells have several, a hidden group for each.
fn by_rule<const D: usize>(
    mesh: &mut Mesh<D>,
    material: &MaterialEntry,
) -> Result<Vec<(String, Integration)>, MeshError> {
    let on = &material.on.value;
    let mut rules = quadratures(material);
    if rules.len() < 2 {
        return Ok(rules
            .pop()
            .map(|(rule, _)| (on.clone(), rule))
            .into_iter()
            .collect());
    }
    let mut pieces = Vec::new();
    for (k, (rule, kinds)) in rules.into_iter().enumerate() {
        let of_kind = |c: &&usize| kinds.contains(&mesh.kind(**c));
        let cells = mesh
            .cell_group(on)?
            .iter()
            .filter(of_kind)
            .copied()
            .collect();
        let name = format!("{on}{HIDDEN}{k}");
        mesh.add_cell_group(&name, cells)?;
        pieces.push((name, rule));
    }
    Ok(pieces)
}

/// The model.
pub(super) fn assemble<const D: usize, H: Analysis<D>>(
    deck: &Deck,
    mut mesh: Mesh<D>,
    hypothesis: H,
    parts: &Parts,
    findings: &mut Findings,
) -> Option<Model<D, H>> {
    let mut note = |span: &Range<usize>, error: ModelError| {
        findings.error(span, error.to_string(), "here");
    };
    let mut pieces = Vec::new();
    for (entry, law) in deck.materials.iter().zip(&parts.laws) {
        for (name, rule) in by_rule(&mut mesh, entry)
            .map_err(|e| note(&entry.on.span, e.into()))
            .ok()?
        {
            pieces.push((entry, *law, name, rule));
        }
    }
    let mut model = Model::new(mesh, hypothesis);
    for (entry, law, name, rule) in pieces {
        let added = match law {
            Law::Elastic(law) => model.material(&name, law, rule),
            Law::VonMises(law) => model.material(&name, law, rule),
        };
        model = added.map_err(|e| note(&entry.on.span, e)).ok()?;
    }
    for tool in &deck.tools {
        let name = &tool.name.value;
        let added = match surface(&tool.shape.value).ok()? {
            Surface::Plane(plane) => model.tool(name, plane),
            Surface::Ball(ball) => model.tool(name, ball),
        };
        model = added.map_err(|e| note(&tool.name.span, e)).ok()?;
    }
    for (entry, law) in deck.contacts.iter().zip(&parts.frictions) {
        let added = model.contact(&entry.surface.value, &entry.against.value, *law);
        model = added.map_err(|e| note(&entry.surface.span, e)).ok()?;
    }
    Some(model)
}
