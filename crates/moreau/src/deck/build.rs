//! From entries to a driver and its steps; the physical ranges are those of the libraries, whose
//! errors get the place of the value responsible.

mod conditions;
mod groups;
mod names;
mod parts;

use super::entries::{Analysis, Deck, Method};
use super::finding::Findings;
use crate::contact::{ContactSolver, GaussSeidel, Penalty, SemismoothNewton, Uzawa};
use crate::driver::{Analysis as Cells, Driver, ModelError, Nesting, Settings, Step, StepError};
use crate::mesh::{Axisymmetric, Mesh, PlaneStrain, Solid, block2, block3};
use groups::Groups;
pub(super) use parts::{kinds, quadrature};

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

/// A step and how it is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage<const D: usize> {
    /// The step.
    pub step: Step<D>,
    /// Equal increments.
    pub increments: usize,
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
    /// Groups of the mesh.
    pub groups: Vec<GroupFacts>,
    /// Volume of the body of each block.
    pub volumes: Vec<f64>,
}

/// A problem in the plane or in space.
pub enum Problem {
    /// Plane strain or axial symmetry.
    Plane(Box<Setup<2>>),
    /// A solid.
    Solid(Box<Setup<3>>),
}

/// Builds what the deck describes; `None` if that has errors.
pub(super) fn build(deck: &Deck, findings: &mut Findings) -> Option<Problem> {
    match deck.analysis {
        Analysis::PlaneStrain => {
            let thickness = match PlaneStrain::new(deck.thickness.value) {
                Ok(hypothesis) => Some(hypothesis),
                Err(error) => {
                    let expected = "expected a positive number";
                    findings.error(&deck.thickness.span, error.to_string(), expected);
                    None
                }
            };
            let mesh = plane_mesh(deck, findings);
            setup(deck, mesh, thickness.unwrap_or_default(), findings)
                .map(|s| Problem::Plane(Box::new(s)))
        }
        Analysis::Axisymmetric => {
            for block in &deck.blocks {
                let x = &block.grid[0];
                if let Some(least) = x.value.lines().first().filter(|x| **x < 0.0) {
                    findings.error(
                        &x.span,
                        format!("the block reaches the radius {least}, expected x ≥ 0"),
                        "x is the radius",
                    );
                }
            }
            let mesh = plane_mesh(deck, findings);
            setup(deck, mesh, Axisymmetric, findings).map(|s| Problem::Plane(Box::new(s)))
        }
        Analysis::Solid => {
            let mesh = joined(deck, findings, |block, lines: [Vec<f64>; 3]| {
                let [x, y, z] = &lines;
                block3(&block.name.value, block.element.value, x, y, z)
            });
            setup(deck, mesh, Solid, findings).map(|s| Problem::Solid(Box::new(s)))
        }
    }
}

fn plane_mesh(deck: &Deck, findings: &mut Findings) -> Option<Mesh<2>> {
    joined(deck, findings, |block, lines: [Vec<f64>; 2]| {
        let [x, y] = &lines;
        block2(&block.name.value, block.element.value, x, y)
    })
}

/// All blocks in one mesh, no node merged.
fn joined<const D: usize>(
    deck: &Deck,
    findings: &mut Findings,
    make: impl Fn(&super::BlockEntry, [Vec<f64>; D]) -> Result<Mesh<D>, crate::mesh::MeshError>,
) -> Option<Mesh<D>> {
    if !deck.mesh_understood {
        return None;
    }
    let mut mesh: Option<Mesh<D>> = None;
    for block in &deck.blocks {
        let lines = std::array::from_fn(|i| block.grid[i].value.lines());
        let joined = make(block, lines).and_then(|new| match mesh.take() {
            Some(old) => old.joined(new),
            None => Ok(new),
        });
        match joined {
            Ok(joined) => mesh = Some(joined),
            Err(error) => {
                findings.error(&block.name.span, error.to_string(), "of this block");
                return None;
            }
        }
    }
    mesh
}

fn setup<const D: usize, H: Cells<D>>(
    deck: &Deck,
    mesh: Option<Mesh<D>>,
    hypothesis: H,
    findings: &mut Findings,
) -> Option<Setup<D>> {
    let groups = mesh.map(|mesh| Groups::new(deck, mesh, findings));
    names::check(deck, groups.as_ref(), findings);
    let parts = parts::parts(deck, findings);
    let groups = groups?;
    if findings.errors() > 0 {
        return None;
    }
    let parts = parts?;
    let model = parts::assemble(deck, groups.mesh.clone(), hypothesis, &parts, findings)?;
    let settings = settings(deck, findings)?;
    let driver = driver(Driver::new(model, settings), deck, &groups, findings)?;
    let stages = conditions::stages(deck, &groups);
    let mut possible = true;
    for (stage, entry) in stages.iter().zip(&deck.steps) {
        if let Err(error) = driver.loading(&stage.step) {
            findings.error(&entry.span, error.to_string(), "in this step");
            possible = false;
        }
    }
    if !possible {
        return None;
    }
    // What is free to move is found on a second driver, under no load: the first stays virgin.
    let model = parts::assemble(deck, groups.mesh.clone(), hypothesis, &parts, findings)?;
    let scratch = Settings {
        iterations: 1,
        ..Settings::default()
    };
    free_motions(
        Driver::new(model, scratch).ok()?,
        deck,
        &stages,
        &groups,
        findings,
    );
    conditions::doubts(deck, findings);
    let volumes = deck
        .blocks
        .iter()
        .filter_map(|b| groups.mesh.cell_group(&b.name.value).ok())
        .map(|cells| groups.mesh.measure(cells, &hypothesis))
        .collect();
    Some(Setup {
        driver,
        stages,
        held: conditions::held(deck, &groups),
        tools: deck.tools.iter().map(|t| t.name.value.clone()).collect(),
        groups: groups.facts(&hypothesis),
        volumes,
    })
}

/// The method and its settings.
fn settings<const D: usize>(deck: &Deck, findings: &mut Findings) -> Option<Settings<D>> {
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
    };
    let mut settings = Settings {
        contact,
        ..Settings::default()
    };
    if deck.solver.outside {
        settings.nesting = Nesting::Outside {
            tolerance: 1e-8,
            iterations: 20_000,
        };
    }
    if let Some(cuts) = deck.steps.iter().filter_map(|s| s.cuts).max() {
        settings.cuts = cuts;
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
            let bare = match &error {
                ModelError::MissingMaterial { first, .. } => groups.block_of(deck, *first),
                _ => deck.blocks.first(),
            };
            let span = bare.map_or(0..0, |b| b.name.span.clone());
            findings.error(&span, error.to_string(), "of this block");
            None
        }
    }
}

/// Notes rigid motions that nothing resists, step by step.
fn free_motions<const D: usize>(
    mut driver: Driver<D>,
    deck: &Deck,
    stages: &[Stage<D>],
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    for (stage, entry) in stages.iter().zip(&deck.steps) {
        let Ok(mut loading) = driver.loading(&stage.step) else {
            return;
        };
        loading.displacement.values_mut().for_each(|u| *u = 0.0);
        loading.force.iter_mut().for_each(|f| *f = 0.0);
        loading.tools.iter_mut().for_each(|u| u.fill(0.0));
        if let Err(StepError::Model(error)) = driver.advance(&loading) {
            let of = match &error {
                ModelError::FreeRigidMotion { cell, .. } => groups.block_of(deck, *cell),
                _ => None,
            };
            let name = of.map_or(String::new(), |b| format!(", body \"{}\"", b.name.value));
            let message = format!("step \"{}\"{name}: {error}", entry.name.value);
            findings.error(&entry.name.span, message, "in this step");
        }
    }
}
