//! Laws, tools and frictions of a deck, and the model they make; their ranges are checked by the
//! libraries.

use crate::contact::{Ball, ContactError, Plane};
use crate::deck::entries::{Deck, FrictionEntry, Hardening, MaterialEntry, Shape};
use crate::deck::finding::{At, Findings};
use crate::driver::{Analysis, Model, ModelError};
use crate::laws::{
    Coulomb, Elastic, Friction, Isotropic, LawError, LimitedCoulomb, Tresca, VonMises,
};
use crate::mesh::{CellKind, Integration, Mesh};
use std::ops::Range;

/// A bulk law.
#[derive(Debug, Clone)]
enum Law {
    Elastic(Elastic),
    VonMises(VonMises),
}

/// What a model needs beside its mesh.
pub(super) struct Parts {
    laws: Vec<Law>,
    frictions: Vec<Friction>,
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
            Err((span, problem)) => findings.error(&span, problem, "out of range"),
        }
        locking(deck, material, findings);
    }
    let mut frictions = Vec::new();
    for contact in &deck.contacts {
        match friction(&contact.friction) {
            Ok(law) => {
                if !law.resists_slip() {
                    let (FrictionEntry::Coulomb(given)
                    | FrictionEntry::Tresca(given)
                    | FrictionEntry::Limited(given, _)) = &contact.friction;
                    findings.warning(
                        &given.span,
                        format!(
                            "the contact of \"{}\" is frictionless",
                            contact.surface.value
                        ),
                        "friction 0",
                    );
                }
                frictions.push(law);
            }
            Err((span, error)) => findings.error(&span, error.to_string(), "out of range"),
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

/// A friction law; or what is wrong with it, and where.
fn friction(entry: &FrictionEntry) -> Result<Friction, (Range<usize>, LawError)> {
    let at = |given: &At<f64>| {
        let span = given.span.clone();
        move |error| (span, error)
    };
    Ok(match entry {
        FrictionEntry::Coulomb(mu) => Coulomb::new(mu.value).map_err(at(mu))?.into(),
        FrictionEntry::Tresca(limit) => Tresca::new(limit.value).map_err(at(limit))?.into(),
        FrictionEntry::Limited(mu, limit) => LimitedCoulomb::new(mu.value, limit.value)
            .map_err(|error| match error {
                LawError::NegativeFriction { .. } => at(mu)(error),
                _ => at(limit)(error),
            })?
            .into(),
    })
}

/// A bulk law; or what is wrong with it, and where.
fn law(material: &MaterialEntry) -> Result<Law, (Range<usize>, String)> {
    let (young, poisson) = (material.young.value, material.poisson.value);
    let moduli = |error: LawError| {
        let at = match (&error, &material.yield_stress) {
            (LawError::PoissonOutOfRange { .. }, _) => &material.poisson,
            (LawError::NotPositive { name, .. }, Some(at)) if name.contains("yield") => at,
            _ => &material.young,
        };
        (at.span.clone(), error.to_string())
    };
    let Some(yield_stress) = &material.yield_stress else {
        return Ok(Law::Elastic(Elastic::new(young, poisson).map_err(moduli)?));
    };
    let mut law = VonMises::new(young, poisson, yield_stress.value).map_err(moduli)?;
    if let Some(given) = &material.isotropic {
        law = law.with_hardening(hardening(given, yield_stress)?);
    }
    for [modulus, recall] in &material.kinematic {
        law = law
            .with_recall(modulus.value, recall.value)
            .map_err(|error| {
                let at = match &error {
                    LawError::Negative { name, .. } if name.contains("recall") => recall,
                    _ => modulus,
                };
                (at.span.clone(), error.to_string())
            })?;
    }
    Ok(Law::VonMises(law))
}

/// Relative difference of a yield stress and that at which a curve starts: what is rounded off in a
/// deck, not another material.
const SAME_YIELD: f64 = 0.01;

/// Isotropic hardening, which must start at the yield stress; or what is wrong with it, and where.
fn hardening(
    given: &At<Hardening>,
    yield_stress: &At<f64>,
) -> Result<Isotropic, (Range<usize>, String)> {
    let wrong = |error: LawError| (given.span.clone(), error.to_string());
    let start = |stress: f64, span: &Range<usize>| match (stress / yield_stress.value - 1.0).abs() {
        difference if difference <= SAME_YIELD => Ok(()),
        _ => Err((
            span.clone(),
            format!(
                "hardening starts at a stress of {stress:.6}, but yield-stress is {}",
                yield_stress.value
            ),
        )),
    };
    match &given.value {
        Hardening::Linear(modulus) => Isotropic::linear(*modulus).map_err(wrong),
        Hardening::Voce([saturation, rate]) => Isotropic::voce(*saturation, *rate).map_err(wrong),
        Hardening::Swift([strength, offset, exponent]) => {
            let law = Isotropic::swift(*strength, *offset, *exponent).map_err(wrong)?;
            law.initial().map_or(Ok(()), |s| start(s, &given.span))?;
            Ok(law)
        }
        Hardening::Table(rows) => {
            let mut points: Vec<[f64; 2]> = rows.iter().map(|row| row.value).collect();
            let mut added = 0;
            match points.first() {
                // The yield stress is the point that a table without one starts at.
                Some(&[p, _]) if p > 0.0 => {
                    points.insert(0, [0.0, yield_stress.value]);
                    added = 1;
                }
                Some(&[_, stress]) => start(stress, &rows[0].span)?,
                None => {}
            }
            Isotropic::table(&points).map_err(|error| match error {
                LawError::Table { row, problem } if row > added && row - added <= rows.len() => {
                    let row = row - added;
                    let error = LawError::Table { row, problem };
                    (rows[row - 1].span.clone(), error.to_string())
                }
                error => wrong(error),
            })
        }
    }
}

/// The rule that does not lock for an element, or the one that the deck asks for.
pub(in crate::deck) fn quadrature(kind: CellKind, material: &MaterialEntry) -> Integration {
    match &material.quadrature {
        Some(rule) => rule.value,
        None if matches!(kind, CellKind::Tri6 | CellKind::Quad8 | CellKind::Quad9) => {
            Integration::Reduced
        }
        None => Integration::Full,
    }
}

/// Elements in which a body gets its material: those of the block it is, or is a part of.
pub(in crate::deck) fn kinds<'a>(
    deck: &'a Deck,
    material: &'a MaterialEntry,
) -> impl Iterator<Item = CellKind> + 'a {
    let mut name = &material.on.value;
    // A group is a part of one before it: the walk ends.
    for group in deck.groups.iter().rev() {
        if group.name.value == *name {
            name = &group.on.value;
        }
    }
    deck.blocks
        .iter()
        .filter(move |b| b.name.value == *name)
        .map(|b| b.element.value)
}

fn locking(deck: &Deck, material: &MaterialEntry, findings: &mut Findings) {
    let Some(yield_stress) = &material.yield_stress else {
        return;
    };
    for kind in kinds(deck, material) {
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

/// The model.
pub(super) fn assemble<const D: usize, H: Analysis<D>>(
    deck: &Deck,
    mesh: Mesh<D>,
    hypothesis: H,
    parts: &Parts,
    findings: &mut Findings,
) -> Option<Model<D, H>> {
    let mut note = |span: &Range<usize>, error: ModelError| {
        findings.error(span, error.to_string(), "here");
    };
    let mut model = Model::new(mesh, hypothesis);
    for (entry, law) in deck.materials.iter().zip(&parts.laws) {
        let kind = model
            .mesh()
            .cell_group(&entry.on.value)
            .ok()
            .and_then(|cells| Some(model.mesh().kind(*cells.first()?)))?;
        let rule = quadrature(kind, entry);
        let name = &entry.on.value;
        let added = match law {
            Law::Elastic(law) => model.material(name, *law, rule),
            Law::VonMises(law) => model.material(name, law.clone(), rule),
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
