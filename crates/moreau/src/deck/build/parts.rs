//! Laws, tools and frictions of a deck, and the model they make; their ranges are checked by the
//! libraries.

use super::groups::HIDDEN;
use super::initial;
use super::laws::{Law, RECALLED, hardening};
use crate::algebra::SharedTeam;
use crate::contact::{Ball, ContactError, Cylinder, Obstacle, Plane, Polyline, Triangulated};
use crate::deck::Laws;
use crate::deck::entries::{
    Adjust, Analysis as Hypothesis, Deck, FrictionEntry, MaterialEntry, Shape, SoilEntry,
};
use crate::deck::finding::{At, Findings};
use crate::driver::{Analysis, Model, ModelError};
use crate::laws::{
    AnisotropicCoulomb, Coulomb, DruckerPrager, Elastic, ElasticDruckerPrager, Friction, LawError,
    LimitedCoulomb, Parameter, ShearTable, Tresca, VonMises,
};
use crate::mesh::{CellKind, Integration, Mesh, MeshError};
use std::ops::Range;

/// What a model needs beside its mesh.
pub(super) struct Parts {
    laws: Vec<Law>,
    frictions: Vec<Friction>,
}

/// The laws, those given in place of those of materials; `None` if some are none.
pub(super) fn parts(deck: &Deck, given: &Laws, findings: &mut Findings) -> Option<Parts> {
    let mut laws = Vec::new();
    for material in &deck.materials {
        match law(material) {
            Ok(law) => {
                let given = given.get(&material.on.value);
                laws.push(given.map_or(law, |given| Law::Given(given.clone())));
            }
            Err((span, problem)) => {
                findings.error(&span, problem, "out of range");
            }
        }
        if deck.analysis != Hypothesis::PlaneStress {
            locking(material, deck.analysis, findings);
        }
        hourglasses(material, findings);
    }
    let mut frictions = Vec::new();
    for contact in &deck.contacts {
        match friction(&contact.friction) {
            Ok(law) => {
                if !law.resists_slip() {
                    findings.warning(
                        contact.friction.span(),
                        format!(
                            "the contact of \"{}\" is frictionless",
                            contact.surface.value
                        ),
                        "friction 0",
                    );
                }
                frictions.push(law);
            }
            Err((span, error)) => {
                findings.error(&span, error.to_string(), "out of range");
            }
        }
    }
    for tool in &deck.tools {
        let checked = match deck.analysis.dimension() {
            2 => profile(&tool.shape.value).and_then(Result::err),
            _ => surface(&tool.shape.value).and_then(Result::err),
        };
        if let Some(error) = checked {
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
        FrictionEntry::Orthotropic(mu, _) => AnisotropicCoulomb::new(mu.value[0], mu.value[1])
            .map_err(|error| (mu.span.clone(), error))?
            .into(),
        FrictionEntry::Table(rows) => {
            let points: Vec<[f64; 2]> = rows.value.iter().map(|row| row.value).collect();
            let law = ShearTable::new(&points).map_err(|error| {
                let row = match error {
                    LawError::ShearTable { row, .. } => rows.value.get(row - 1),
                    _ => None,
                };
                (row.map_or(&rows.span, |row| &row.span).clone(), error)
            })?;
            // A law lives as long as the program, and is a few numbers.
            let law: &'static ShearTable = Box::leak(Box::new(law));
            law.into()
        }
    })
}

/// A bulk law; or what is wrong with it, and where.
fn law(material: &MaterialEntry) -> Result<Law, (Range<usize>, String)> {
    let (young, poisson) = (material.young.value, material.poisson.value);
    let moduli = |error: LawError| {
        let at = match (&error, &material.yield_stress) {
            (LawError::PoissonOutOfRange { .. }, _) => &material.poisson,
            (
                LawError::NotPositive {
                    parameter: Parameter::YieldStress,
                    ..
                },
                Some(at),
            ) => at,
            _ => &material.young,
        };
        (at.span.clone(), error.to_string())
    };
    if let Some(axes) = &material.axes {
        return super::axes::law(material, axes);
    }
    if let Some(soil) = &material.soil {
        let plastic = self::soil(soil)?;
        let law = ElasticDruckerPrager::new(young, poisson, plastic).map_err(moduli)?;
        return Ok(Law::DruckerPrager(law));
    }
    let Some(yield_stress) = &material.yield_stress else {
        return Ok(Law::Elastic(Elastic::new(young, poisson).map_err(moduli)?));
    };
    let mut law = VonMises::new(young, poisson, yield_stress.value).map_err(moduli)?;
    if let Some(given) = &material.isotropic {
        law = law.with_hardening(hardening(given, yield_stress)?);
    }
    let mut recalled = [(0.0, 0.0); RECALLED];
    let mut terms = 0;
    for [modulus, recall] in &material.kinematic {
        let term = (modulus.value, recall.value);
        if let Err(error) = law.clone().with_recall([term]) {
            let at = match &error {
                LawError::Negative {
                    parameter: Parameter::Recall,
                    ..
                } => recall,
                _ => modulus,
            };
            return Err((at.span.clone(), error.to_string()));
        }
        if recall.value == 0.0 {
            law = law.with_kinematic(modulus.value).map_err(moduli)?;
        } else {
            if let Some(free) = recalled.get_mut(terms) {
                *free = term;
            }
            terms += 1;
        }
    }
    if terms > RECALLED {
        let [first, _] = &material.kinematic[0];
        let message = format!(
            "{terms} terms of kinematic hardening with recall, at most {RECALLED} are remembered"
        );
        return Err((first.span.clone(), message));
    }
    if terms == 0 {
        return Ok(Law::VonMises(law));
    }
    Ok(Law::Chaboche(law.with_recall(recalled).map_err(moduli)?))
}

/// The plastic law of a soil; or what is wrong with it, and where.
fn soil(soil: &SoilEntry) -> Result<DruckerPrager, (Range<usize>, String)> {
    let (c, friction, dilatancy) = (&soil.cohesion, &soil.friction_angle, &soil.dilatancy_angle);
    DruckerPrager::mohr_coulomb(c.value, friction.value, dilatancy.value).map_err(|error| {
        let at = match &error {
            LawError::AngleOutOfRange {
                parameter: Parameter::DilatancyAngle,
                ..
            } => dilatancy,
            LawError::AngleOutOfRange { .. } => friction,
            _ => c,
        };
        (at.span.clone(), error.to_string())
    })
}

/// The rule that the deck asks for, or else the one of the element.
pub(super) fn quadrature(
    kind: CellKind,
    material: &MaterialEntry,
    analysis: Hypothesis,
) -> Integration {
    let asked = material.quadrature.as_ref().map(|rule| rule.value);
    asked.unwrap_or(match analysis {
        Hypothesis::PlaneStress => kind.integration_in_plane_stress(),
        _ => kind.integration(),
    })
}

/// The rules of the cells of a material, each with the kinds that have it.
pub(in crate::deck) fn quadratures(
    material: &MaterialEntry,
    analysis: Hypothesis,
) -> Vec<(Integration, Vec<CellKind>)> {
    let mut rules: Vec<(Integration, Vec<CellKind>)> = Vec::new();
    for &kind in &material.kinds {
        let rule = quadrature(kind, material, analysis);
        match rules.iter_mut().find(|(r, _)| *r == rule) {
            Some((_, kinds)) => kinds.push(kind),
            None => rules.push((rule, vec![kind])),
        }
    }
    rules
}

fn locking(material: &MaterialEntry, analysis: Hypothesis, findings: &mut Findings) {
    let Some(yields) = material.yields() else {
        return;
    };
    let (dilates, why) = match material.dilates() {
        Some(said) => (Some(said), "plastic flow dilates"),
        None => (None, "plastic flow keeps volumes"),
    };
    for &kind in &material.kinds {
        let rule = quadrature(kind, material, analysis);
        if kind.locks(rule) {
            let full = match kind.locks(kind.integration()) {
                true => "",
                false => " with full quadrature",
            };
            let remedy = match full.is_empty() || dilates.is_some() {
                true => "a quadratic element",
                false => "quadrature = \"b-bar\"",
            };
            let message = format!(
                "{kind}{full} locks in plastic flow: loads come out too high; use {remedy}"
            );
            findings.warning(yields, message, why);
        }
        if let Some(said) = dilates.filter(|_| kind.stiff_if_dilating(rule)) {
            let message = format!(
                "{kind} with quadrature = \"b-bar\" is too stiff where plastic flow dilates, which one dilatation a cell does \
                 not follow: at 20° a strip footing on quad4 bears 39 % too much, 19 % on cells of half the size, 2 % on \
                 quad8; use a quadratic element"
            );
            findings.warning(said, message, why);
        }
    }
}

fn hourglasses(material: &MaterialEntry, findings: &mut Findings) {
    let Some(rule) = &material.quadrature else {
        return;
    };
    if let Some(kind) = (material.kinds.iter()).find(|kind| kind.hourglasses(rule.value)) {
        findings.warning(
            &rule.span,
            format!(
                "{kind} with reduced quadrature deforms without strain at its points, as an hourglass: displacements \
                 may alternate from node to node, or nothing hold them; leave out quadrature"
            ),
            "one point too few",
        );
    }
}

/// A rigid surface, if the shape is one of the dimension.
pub(super) type Surface<const D: usize> =
    fn(&Shape) -> Option<Result<Box<dyn Obstacle<D>>, ContactError>>;

fn fixed<const D: usize>(v: &[f64]) -> [f64; D] {
    std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0))
}

fn boxed<const D: usize, O: Obstacle<D> + 'static>(obstacle: O) -> Box<dyn Obstacle<D>> {
    Box::new(obstacle)
}

/// Planes and balls, in any dimension.
fn simple<const D: usize>(shape: &Shape) -> Option<Result<Box<dyn Obstacle<D>>, ContactError>> {
    match shape {
        Shape::Plane(point, normal) => {
            Some(Plane::new(fixed::<D>(point), fixed(normal)).map(boxed))
        }
        Shape::Ball(center, radius, hollow, _) => {
            let ball = Ball::new(fixed::<D>(center), *radius);
            Some(ball.map(|b| boxed(if *hollow { b.hollow() } else { b })))
        }
        _ => None,
    }
}

/// A surface in the plane.
pub(super) fn profile(shape: &Shape) -> Option<Result<Box<dyn Obstacle<2>>, ContactError>> {
    match shape {
        Shape::Polyline(points, radii) if radii.is_empty() => {
            Some(Polyline::new(points).map(boxed))
        }
        Shape::Polyline(points, radii) => Some(Polyline::rounded(points, radii).map(boxed)),
        other => simple(other),
    }
}

/// A surface in space.
pub(super) fn surface(shape: &Shape) -> Option<Result<Box<dyn Obstacle<3>>, ContactError>> {
    match shape {
        Shape::Cylinder(center, axis, radius, hollow) => {
            let cylinder = Cylinder::new(fixed(center), fixed(axis), *radius);
            Some(cylinder.map(|c| boxed(if *hollow { c.hollow() } else { c })))
        }
        Shape::Triangles(entry) => {
            let (skin, sharp) = (&entry.skin, entry.sharp.to_radians());
            let closed = Triangulated::new(&skin.points, &skin.triangles, sharp);
            Some(closed.map(|t| boxed(if entry.hollow { t.hollow() } else { t })))
        }
        other => simple(other),
    }
}

/// Shortest side between the corners of a surface's facets; infinite without facets.
pub(super) fn shortest_side<const D: usize>(mesh: &Mesh<D>, surface: &str) -> f64 {
    let mut least = f64::INFINITY;
    for &facet in mesh.facet_group(surface).unwrap_or_default() {
        let corners: Vec<[f64; D]> = mesh
            .facet_nodes(facet)
            .take(mesh.facet_kind(facet).corner_count())
            .map(|node| mesh.nodes()[node])
            .collect();
        for (k, a) in corners.iter().enumerate() {
            let b = &corners[(k + 1) % corners.len()];
            let squared: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
            least = least.min(squared.sqrt());
        }
    }
    least
}

/// Stiffness of a spring for every contact node \[force / length\], such that no node penetrates by
/// more than the part ε of the shortest side h of the cells in contact while the pressure stays
/// below p: k = p A / (ε h), with A the largest share of a node in the surface. The pressure p is
/// three times the largest yield stress, which a flat punch just does not reach (2.97, Prandtl), or
/// Young's modulus where a material has no yield stress.
pub(super) fn stiffness<const D: usize, H: Analysis<D>>(
    deck: &Deck,
    mesh: &Mesh<D>,
    hypothesis: &H,
    part: f64,
) -> f64 {
    let pressure = deck.materials.iter().map(|m| match &m.yield_stress {
        Some(yield_stress) => 3.0 * yield_stress.value,
        None => m.young.value,
    });
    let (mut area, mut side) = (0.0f64, f64::INFINITY);
    for contact in &deck.contacts {
        let facets = mesh.facet_group(&contact.surface.value).unwrap_or_default();
        for share in mesh.facet_shares(facets, hypothesis) {
            area = area.max(share.area);
        }
        side = side.min(shortest_side(mesh, &contact.surface.value));
    }
    match area > 0.0 {
        true => pressure.fold(0.0, f64::max) * area / (part * side),
        false => 1.0, // Nothing touches.
    }
}

/// The group of a material with its rule; where its cells have several, a hidden group for each.
fn by_rule<const D: usize>(
    mesh: &mut Mesh<D>,
    (material, analysis): (&MaterialEntry, Hypothesis),
) -> Result<Vec<(String, Integration)>, MeshError> {
    let on = &material.on.value;
    let mut rules = quadratures(material, analysis);
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
    (mut mesh, team): (Mesh<D>, Option<&SharedTeam>),
    hypothesis: H,
    parts: &Parts,
    surface: Surface<D>,
    findings: &mut Findings,
) -> Option<Model<D, H>> {
    let mut note = |span: &Range<usize>, error: ModelError| {
        let message = error.to_string();
        match error {
            ModelError::SmallSelfContact { .. } => {
                let help =
                    "strain = \"finite\", or the two sides that face each other as two surfaces";
                findings.error_with(span, message, "the same surface", help)
            }
            _ => findings.error(span, message, "here"),
        };
    };
    let mut pieces = Vec::new();
    for (entry, law) in deck.materials.iter().zip(&parts.laws) {
        for (name, rule) in by_rule(&mut mesh, (entry, deck.analysis))
            .map_err(|e| note(&entry.on.span, e.into()))
            .ok()?
        {
            let of_starts = initial::pieces(deck, &mut mesh, &name);
            for (name, start) in of_starts.map_err(|e| note(&entry.on.span, e.into())).ok()? {
                pieces.push((entry, law.clone(), (name, rule), start));
            }
        }
    }
    let mut model = match deck.finite.is_some() {
        true => Model::with_large_strains(mesh, hypothesis),
        false => Model::new(mesh, hypothesis),
    };
    if let Some(team) = team {
        model = model.on_team(team.clone());
    }
    for (entry, law, (name, rule), start) in pieces {
        let added = initial::add(model, (&name, rule), law, start.as_ref());
        let span = start.as_ref().map_or(&entry.on.span, |start| &start.span);
        model = added.map_err(|e| note(span, e)).ok()?;
    }
    for entry in &deck.materials {
        if let Some(expansion) = &entry.expansion {
            let expands = model.expansion(&entry.on.value, expansion.value);
            model = expands.map_err(|e| note(&expansion.span, e)).ok()?;
        }
    }
    for tool in &deck.tools {
        let name = &tool.name.value;
        let added = model.tool(name, surface(&tool.shape.value)?.ok()?);
        model = added.map_err(|e| note(&tool.name.span, e)).ok()?;
        if let Some(point) = &tool.reference {
            let at = model.reference(fixed(&point.value));
            model = at.map_err(|e| note(&point.span, e)).ok()?;
        }
    }
    for (entry, law) in deck.contacts.iter().zip(&parts.frictions) {
        let added = model.contact(&entry.surface.value, &entry.against.value, *law);
        let at = |error: &ModelError| match error {
            ModelError::SmallSelfContact { .. } => &entry.against.span,
            _ => &entry.surface.span,
        };
        model = added.map_err(|e| note(at(&e), e)).ok()?;
        if let FrictionEntry::Orthotropic(_, axis) = &entry.friction {
            let along = model.along(std::array::from_fn(|i| axis.value[i]));
            model = along.map_err(|e| note(&axis.span, e)).ok()?;
        }
        if let Some(offset) = &entry.gap_offset {
            let offset_by = model.gap_offset(offset.value);
            model = offset_by.map_err(|e| note(&offset.span, e)).ok()?;
        }
        if let Some(adjust) = &entry.adjust {
            let within = match adjust.value {
                Adjust::Near => 0.05 * shortest_side(model.mesh(), &entry.surface.value),
                Adjust::Within(distance) => distance,
            };
            model = model
                .adjust(within)
                .map_err(|e| note(&adjust.span, e))
                .ok()?;
        }
    }
    // After the contacts, of which the indices are those of the deck.
    for entry in &deck.ties {
        let added = model.tie(&entry.surface.value, &entry.to.value);
        let at = |error: &ModelError| match error {
            ModelError::TiedTwice { group, .. } if *group == entry.to.value => &entry.to.span,
            _ => &entry.surface.span,
        };
        model = added.map_err(|e| note(at(&e), e.clone())).ok()?;
    }
    Some(model)
}
