//! From entries to a driver and its steps; the physical ranges are those of the libraries, whose
//! errors get the place of the value responsible.

mod amplitudes;
mod axes;
mod changes;
mod conditions;
mod flat;
mod groups;
mod initial;
mod laws;
mod meshes;
mod methods;
mod names;
mod parts;
mod penetrations;
mod slips;
mod ties;
mod unjoined;

use super::Given;
use super::entries::{Action, Analysis, Deck, Method};
use super::finding::{Class, Findings};
use crate::contact::{ContactSolver, GaussSeidel, Penalty, SemismoothNewton, Uzawa};
use crate::driver::{
    self, Driver, Increments, LeastGap, ModelError, Nesting, RigidMotion, Settings, Step, Support,
};
use crate::mesh::{
    Axisymmetric, CellKind, Integration, Mesh, MeshError, PlaneStrain, PlaneStress, Solid,
};
use groups::Groups;
use meshes::Files;
pub(super) use parts::quadratures;
use std::ops::Range;

/// A group of the mesh and what it measures.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupFacts {
    /// Name.
    pub name: String,
    /// `"cells"`, `"facets"` or `"nodes"`.
    pub kind: &'static str,
    /// Members.
    pub members: usize,
    /// Nodes.
    pub nodes: usize,
    /// Volume of cells, area of facets, in the units of the deck; a length or an area times the
    /// thickness, or once around the axis.
    pub measure: Option<f64>,
}

/// A body: cells connected through shared nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name of the smallest group of cells that holds it, or its number from 1.
    pub name: String,
    /// Number of its cells of each kind.
    pub cells: Vec<(CellKind, usize)>,
    /// Volume, in the units of the deck.
    pub volume: f64,
    /// What stops each of its rigid motions, by step; groups are those of the deck, contacts counted
    /// in its order.
    pub motions: Vec<Vec<RigidMotion>>,
}

/// A step and how it is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage<const D: usize> {
    /// The step.
    pub step: Step<D>,
    /// Its increments.
    pub increments: Increments,
    /// Whether its loads are to grow until the structure collapses.
    pub until_collapse: bool,
    /// Directions in which the step itself holds or moves each group of [`Setup::held`].
    pub directions: Vec<Vec<usize>>,
}

/// A driver, ready to run, and the steps.
pub struct Setup<const D: usize> {
    /// The driver in the virgin state.
    pub driver: Driver<D>,
    /// The steps.
    pub stages: Vec<Stage<D>>,
    /// Groups in `fix` and `move`, in the order of the deck, each with the group of its nodes.
    pub held: Vec<[String; 2]>,
    /// Tools, in the order of the deck.
    pub tools: Vec<String>,
    /// Whether tools have moments worth telling: where strains are large, or a tool turns.
    pub moments: bool,
    /// Surfaces of bodies that touch each other, and probes, that are not held: each once, in the order of the
    /// contacts and of the probes.
    pub surfaces: Vec<String>,
    /// Groups of the mesh.
    pub groups: Vec<GroupFacts>,
    /// Bodies: cells connected through shared nodes.
    pub bodies: Vec<Body>,
    /// The least gap of every contact before anything moves.
    pub gaps: Vec<LeastGap<D>>,
    /// What is doubtful in the deck, a sentence each.
    pub warnings: Vec<String>,
}

/// A problem in the plane or in space.
pub enum Problem {
    /// Plane strain, plane stress or axial symmetry.
    Plane(Box<Setup<2>>),
    /// A solid.
    Solid(Box<Setup<3>>),
}

/// Builds what the deck describes, on those of its mesh files that are not on disk, and with what is given beside its
/// text; `None` if that has errors.
pub(super) fn build(
    deck: &mut Deck,
    files: Files<'_>,
    given: &Given,
    findings: &mut Findings,
) -> Option<Problem> {
    match deck.analysis {
        Analysis::PlaneStrain => slice(deck, PlaneStrain::new, (files, given), findings),
        Analysis::PlaneStress => slice(deck, PlaneStress::new, (files, given), findings),
        Analysis::Axisymmetric => {
            let mesh = meshes::meridian(deck, files, findings);
            setup(deck, mesh, Axisymmetric, (parts::profile, given), findings)
                .map(|s| Problem::Plane(Box::new(s)))
        }
        Analysis::Solid => {
            let mesh = meshes::solid(deck, files, findings);
            setup(deck, mesh, Solid, (parts::surface, given), findings)
                .map(|s| Problem::Solid(Box::new(s)))
        }
    }
}

/// A problem of a slice of the thickness of the deck.
fn slice<H: driver::Analysis<2> + Default>(
    deck: &mut Deck,
    hypothesis: fn(f64) -> Result<H, MeshError>,
    (files, given): (Files<'_>, &Given),
    findings: &mut Findings,
) -> Option<Problem> {
    let hypothesis = hypothesis(deck.thickness.value).unwrap_or_else(|error| {
        let expected = "expected a positive number";
        findings.error(&deck.thickness.span, error.to_string(), expected);
        H::default()
    });
    let mesh = meshes::plane(deck, files, findings);
    setup(deck, mesh, hypothesis, (parts::profile, given), findings)
        .map(|s| Problem::Plane(Box::new(s)))
}

fn setup<const D: usize, H: driver::Analysis<D>>(
    deck: &mut Deck,
    mesh: Option<Mesh<D>>,
    hypothesis: H,
    (surface, given): (parts::Surface<D>, &Given),
    findings: &mut Findings,
) -> Option<Setup<D>> {
    let groups = mesh.map(|mesh| Groups::new(deck, mesh, findings));
    if let Some(groups) = &groups {
        for material in &mut deck.materials {
            material.kinds = groups.kinds(&material.on.value);
        }
    }
    let deck = &*deck;
    unfinished(deck, given, findings);
    names::check(deck, groups.as_ref(), findings);
    names::check_laws(deck, &given.laws, findings);
    let parts = parts::parts(deck, &given.laws, findings);
    let groups = groups?;
    initial::check((deck, &given.laws), &groups, findings);
    if findings.errors() > 0 {
        return None;
    }
    let parts = parts?;
    let mesh = groups.mesh.clone();
    let model = parts::assemble(
        deck,
        (mesh, given.team.as_ref()),
        hypothesis,
        &parts,
        surface,
        findings,
    )?;
    let stiffness = |part| parts::stiffness(deck, &groups.mesh, &hypothesis, part);
    let settings = settings(deck, stiffness, findings)?;
    let driver = driver(Driver::new(model, settings), deck, &groups, findings)?;
    if given.serves() {
        return Some(served(driver));
    }
    let stages = conditions::stages(deck, &groups);
    let mut possible = true;
    for (stage, entry) in stages.iter().zip(&deck.steps) {
        if let Err(error) = driver.loading(&stage.step) {
            findings
                .error(&entry.span, error.to_string(), "in this step")
                .about(Class::Steps);
            possible = false;
        }
    }
    if !possible {
        return None;
    }
    let gaps = driver.least_gaps();
    penetrations::warn(deck, &driver, &gaps, findings);
    ties::warn(deck, &driver, findings);
    let supports = supports(&driver, (deck, &gaps), &stages, &groups, findings);
    methods::check(deck, &supports, &groups, findings);
    conditions::doubts(deck, &gaps, findings);
    conditions::driven::<D>(deck, findings);
    conditions::heat(deck, &groups, findings);
    amplitudes::check(deck, &groups, findings);
    changes::check((deck, &groups), &driver, &stages, findings);
    conditions::inner_surfaces(deck, &groups, findings);
    slips::warn(deck, &groups, surface, findings);
    flat::warn(deck, &groups, findings);
    flat::warn_of_layers(deck, (&driver, &stages), &groups, findings);
    unjoined::warn(deck, &driver, &groups, findings);
    let held = conditions::held(deck, &groups);
    Some(Setup {
        driver,
        stages,
        surfaces: surfaces(deck, &held),
        moments: moments(deck),
        held,
        tools: deck.tools.iter().map(|t| t.name.value.clone()).collect(),
        groups: groups.facts(&hypothesis),
        bodies: groups.bodies(&hypothesis, &supports),
        gaps,
        warnings: Vec::new(),
    })
}

/// What another process than the first needs, which asks it for cells before it has found what else may be wrong.
fn served<const D: usize>(driver: Driver<D>) -> Setup<D> {
    Setup {
        driver,
        stages: Vec::new(),
        held: Vec::new(),
        tools: Vec::new(),
        moments: false,
        surfaces: Vec::new(),
        groups: Vec::new(),
        bodies: Vec::new(),
        gaps: Vec::new(),
        warnings: Vec::new(),
    }
}

/// The method and its settings.
fn settings<const D: usize>(
    deck: &Deck,
    stiffness: impl Fn(f64) -> f64,
    findings: &mut Findings,
) -> Option<Settings<D>> {
    let spring = |k: f64| Penalty::new(k, k);
    let contact: Box<dyn ContactSolver<D>> = match &deck.solver.method {
        Method::Exact => Box::new(SemismoothNewton::default()),
        Method::Uzawa => Box::new(Uzawa::default()),
        Method::GaussSeidel => Box::new(GaussSeidel::default()),
        Method::Penalty(normal, tangent) => match Penalty::new(normal.value, tangent.value) {
            Ok(penalty) => Box::new(penalty),
            Err(error) => {
                let culprit = if normal.value > 0.0 { tangent } else { normal };
                findings.error(&culprit.span, error.to_string(), "out of range");
                return None;
            }
        },
        Method::Penetration(part) => match spring(stiffness(part.value)) {
            Ok(penalty) => Box::new(penalty),
            Err(error) => {
                findings.error(&part.span, error.to_string(), "out of range");
                return None;
            }
        },
    };
    let mut settings = Settings {
        contact,
        memory: crate::memory::available(),
        tolerance: deck.solver.tolerance,
        ..Settings::default()
    };
    if deck.solver.outside {
        settings.nesting = Nesting::Outside {
            tolerance: 1e-8,
            iterations: 20_000,
            extrapolated: true,
        };
    }
    Some(settings)
}

/// The driver, or the error at the block without a material.
fn driver<const D: usize>(
    driver: Result<Driver<D>, ModelError>,
    deck: &Deck,
    groups: &Groups<D>,
    findings: &mut Findings,
) -> Option<Driver<D>> {
    match driver {
        Ok(driver) => Some(driver),
        Err(error) => {
            let cell = match &error {
                ModelError::MissingMaterial { first, .. } => *first,
                _ => 0,
            };
            let (name, span) = groups.origin(deck, cell);
            findings
                .error(&span, format!("body \"{name}\": {error}"), "of this mesh")
                .about(Class::Bodies);
            None
        }
    }
}

fn moments(deck: &Deck) -> bool {
    let mut all = deck.steps.iter().flat_map(|s| &s.conditions);
    let turns = all.any(|c| matches!(c.action, Action::Tool(_, Some(_)) | Action::Moment(_)));
    deck.analysis != Analysis::Axisymmetric && (turns || deck.finite.is_some())
}

/// What plane stress does not go with.
fn in_plane_stress(deck: &Deck, given: &Given, findings: &mut Findings) {
    if deck.analysis != Analysis::PlaneStress {
        return;
    }
    let mut refuse = |at: &Range<usize>, problem: &str, remedy: &str| {
        let message = format!("analysis = \"plane-stress\" with {problem}");
        findings.error_with(at, message, "not with this", remedy);
    };
    if let Some(finite) = &deck.finite {
        refuse(
            &finite.span,
            "strain = \"finite\": its thickness is not followed",
            "strain = \"small\", or analysis = \"solid\"",
        );
    }
    for material in &deck.materials {
        let rule = material.quadrature.as_ref();
        if let Some(rule) = rule.filter(|rule| rule.value == Integration::BBar) {
            refuse(
                &rule.span,
                "quadrature = \"b-bar\": no flow keeps an area, and no cell locks",
                "quadrature = \"full\" or \"reduced\"",
            );
        }
        let on = &material.on;
        if given.laws.contains_key(&on.value) {
            refuse(
                &on.span,
                "a law of one's own: its stress through the thickness is its own",
                "analysis = \"plane-strain\" or \"solid\"",
            );
        }
    }
}

/// What large strains do not go with.
fn unfinished(deck: &Deck, given: &Given, findings: &mut Findings) {
    in_plane_stress(deck, given, findings);
    let Some(finite) = &deck.finite else { return };
    let mut refuse = |problem: &str, remedy: &str| {
        findings.error_with(
            &finite.span,
            format!("strain = \"finite\" with {problem}"),
            "not with this",
            remedy,
        );
    };
    if deck.steps.iter().any(|s| s.until_collapse) {
        refuse(
            "until = \"collapse\": a limit load is one of small strains",
            "strain = \"small\"",
        );
    }
    if let Some(on) = given.laws.keys().next() {
        refuse(
            &format!("a law of one's own on \"{on}\": it answers for small strains"),
            "strain = \"small\"",
        );
    }
    if deck.solver.outside {
        refuse(
            "nesting = \"outside\": the nesting of the paper is one for small strains",
            "nesting = \"inside\"",
        );
    }
}

/// Surfaces of the contacts between bodies and of the ties, and probes, without those whose name the history has already.
fn surfaces(deck: &Deck, held: &[[String; 2]]) -> Vec<String> {
    let is_tool = |name: &String| deck.tools.iter().any(|t| t.name.value == *name);
    let is_held = |name: &String| held.iter().any(|[n, _]| n == name);
    let mut list: Vec<String> = Vec::new();
    let contacts = deck.contacts.iter().filter(|c| !is_tool(&c.against.value));
    let contacts = contacts.map(|c| [&c.surface.value, &c.against.value]);
    let ties = deck.ties.iter().map(|t| [&t.surface.value, &t.to.value]);
    for name in contacts.chain(ties).flatten() {
        if !list.contains(name) && !is_held(name) {
            list.push(name.clone());
        }
    }
    for probe in deck.probes.iter().map(|p| &p.value) {
        if !list.contains(probe) && !is_held(probe) {
            list.push(probe.clone());
        }
    }
    list
}

/// What stops the rigid motions of every body, step by step; motions that nothing stops are errors.
fn supports<const D: usize>(
    driver: &Driver<D>,
    (deck, gaps): (&Deck, &[LeastGap<D>]),
    stages: &[Stage<D>],
    groups: &Groups<D>,
    findings: &mut Findings,
) -> Vec<Vec<Support>> {
    let mut all = Vec::new();
    for (stage, entry) in stages.iter().zip(&deck.steps) {
        // The step has been loaded already.
        let supports = driver.supports(&stage.step).unwrap_or_default();
        for support in supports.iter().filter(|s| !s.free.is_empty()) {
            let (name, _) = groups.origin(deck, support.cell);
            let error = ModelError::FreeRigidMotion {
                body: format!("the body \"{name}\""),
                motion: support.free.join(", "),
            };
            // No contact is found between bodies that lie deep within each other.
            let unmet = gaps.iter().filter(|g| !g.met);
            let overlaps = unmet.map(|g| penetrations::sentence(deck, driver, g) + ". Until then ");
            let overlaps: String = overlaps.collect();
            let whose = match overlaps.is_empty() {
                true => String::new(),
                false => format!(", body \"{name}\""),
            };
            let step = &entry.name.value;
            let message = format!("step \"{step}\"{whose}: {overlaps}{error}");
            findings
                .error(&entry.name.span, message, "in this step")
                .about(Class::Bodies);
        }
        all.push(supports);
    }
    all
}
