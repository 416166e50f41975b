//! `moreau check`: what a deck was understood to say; nothing is solved.

use super::{INPUT_ERROR, folder, read, report, say, tell};
use crate::deck::{
    Action, Analysis, Deck, FieldEntry, Given, MaterialEntry, Method, Problem, Setup, Shape,
    SoilEntry, open_with,
};
use crate::driver::{RigidMotion, Stopper};
use crate::numbers::{place, shown};
use crate::simulation::pictures::planned;
use std::path::Path;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Digits of volumes and areas.
const DIGITS: usize = 7;

/// Checks a deck; the exit status.
pub(super) fn check(path: &Path, given: &Given, picture: Option<&Path>) -> u8 {
    let Some(text) = read(path) else {
        return INPUT_ERROR;
    };
    let (deck, problem, findings) = open_with(&text, folder(path), given);
    report(&findings, path, &text);
    match problem {
        None => INPUT_ERROR,
        Some(problem) => {
            head(&deck);
            match &problem {
                Problem::Plane(setup) => model(&deck, setup),
                Problem::Solid(setup) => model(&deck, setup),
            }
            conditions(&deck);
            say!("no rigid motion is free; the deck can be run");
            picture.map_or(0, |file| draw(&deck, &problem, file))
        }
    }
}

/// Draws every step into a file of its own, the first into the one that is named; the exit status.
fn draw(deck: &Deck, problem: &Problem, file: &Path) -> u8 {
    for step in 0..deck.steps.len() {
        let svg = match problem {
            Problem::Plane(setup) => planned(deck, setup, step),
            Problem::Solid(setup) => planned(deck, setup, step),
        };
        let Some(svg) = svg else {
            continue;
        };
        let name = |number: usize| {
            let stem = file.file_stem().unwrap_or_default().to_string_lossy();
            let end = file.extension().unwrap_or_default().to_string_lossy();
            file.with_file_name(format!("{stem}-{number}.{end}"))
        };
        let to = match step {
            0 => file.to_owned(),
            step => name(step + 1),
        };
        if let Err(error) = std::fs::write(&to, svg) {
            tell!("cannot write {}: {error}", to.display());
            return INPUT_ERROR;
        }
        say!("picture    {}", to.display());
    }
    0
}

fn head(deck: &Deck) {
    if !deck.title.is_empty() {
        say!("{}", deck.title);
    }
    say!("units      {}", deck.units.name());
    let thickness = match deck.analysis {
        slice if slice.has_thickness() => {
            format!(", {} {} thick", deck.thickness.value, deck.units.length())
        }
        crate::deck::Analysis::Axisymmetric => " (forces are of the whole ring)".into(),
        _ => String::new(),
    };
    say!("analysis   {}{thickness}", deck.analysis.name());
}

fn model<const D: usize>(deck: &Deck, setup: &Setup<D>) {
    mesh(deck, setup);
    bodies(deck, setup);
    groups(deck, setup);
    for entry in &deck.materials {
        material(deck, entry);
    }
    for tool in &deck.tools {
        let is_revolved = deck.analysis == Analysis::Axisymmetric;
        let shape = shape(&tool.shape.value, (deck.units.length(), is_revolved));
        say!("tool       {}: {shape}", tool.name.value);
    }
    for index in 0..deck.contacts.len() {
        contact(deck, setup, index);
    }
    for (k, tie) in deck.ties.iter().enumerate() {
        let points = setup.driver.contacts().iter();
        let points = points
            .filter(|c| c.contact == deck.contacts.len() + k)
            .count();
        say!(
            "tie        {} to {}, {points} points",
            tie.surface.value,
            tie.to.value
        );
    }
    say!("solver     {}", method(deck));
}

fn mesh<const D: usize>(deck: &Deck, setup: &Setup<D>) {
    let mesh = setup.driver.mesh();
    say!(
        "mesh       {} nodes, {} cells, {} degrees of freedom",
        mesh.nodes().len(),
        mesh.cell_count(),
        D * mesh.nodes().len()
    );
    for entry in &deck.mesh_files {
        say!("           from {}", entry.file.value.display());
    }
}

fn bodies<const D: usize>(deck: &Deck, setup: &Setup<D>) {
    let length = deck.units.length();
    for body in &setup.bodies {
        let cells: Vec<String> = body.cells.iter().map(|(k, n)| format!("{n} {k}")).collect();
        say!(
            "body       {}: {}, volume {} {length}³",
            body.name,
            cells.join(", "),
            shown(body.volume, DIGITS)
        );
        motions(deck, &body.motions);
    }
}

fn groups<const D: usize>(deck: &Deck, setup: &Setup<D>) {
    let length = deck.units.length();
    for group in &setup.groups {
        let unit = if group.kind == "cells" { "³" } else { "²" };
        let measure = group.measure.map_or(String::new(), |m| {
            format!(", {} {length}{unit}", shown(m, DIGITS))
        });
        say!(
            "group      {}: {} {}, {} nodes{measure}",
            group.name,
            group.members,
            group.kind,
            group.nodes
        );
    }
}

fn material(deck: &Deck, material: &MaterialEntry) {
    let stress = deck.units.stress();
    let elastic = match material.axes.as_ref().and_then(|a| a.elastic.as_ref()) {
        Some(given) => {
            let [young, poisson, shear] = given.value;
            format!("orthotropic, E {young:?} {stress}, ν {poisson:?}, G {shear:?} {stress}")
        }
        None => format!(
            "E {} {stress}, ν {}",
            material.young.value, material.poisson.value
        ),
    };
    say!(
        "material   {}: {elastic}, {}; {} quadrature",
        material.on.value,
        strength(material, stress),
        deck.quadrature(material)
    );
}

/// What the material bears, and how it hardens.
fn strength(material: &MaterialEntry, unit: &str) -> String {
    let soil = |soil: &SoilEntry| {
        format!(
            "cohesion {} {unit}, friction angle {}°, dilatancy angle {}°",
            soil.cohesion.value, soil.friction_angle.value, soil.dilatancy_angle.value
        )
    };
    let Some(yield_stress) = &material.yield_stress else {
        return material.soil.as_ref().map_or("elastic".to_owned(), soil);
    };
    let hardening = match &material.isotropic {
        Some(h) => h.value.to_string(),
        None => "none".to_owned(),
    };
    let kinematic = match material.kinematic.len() {
        0 => "none".to_owned(),
        1 => "of 1 term".to_owned(),
        n => format!("of {n} terms"),
    };
    format!(
        "yield stress {} {unit}, isotropic hardening {hardening}, kinematic {kinematic}",
        yield_stress.value
    )
}

/// A shape in words, with the unit of length and whether it is turned about the axis.
fn shape(shape: &Shape, (length, is_revolved): (&str, bool)) -> String {
    let inside = |hollow: bool| if hollow { ", hollow" } else { "" };
    match shape {
        Shape::Plane(point, normal) => format!("plane through {point:?}, normal {normal:?}"),
        Shape::Ball(center, radius, hollow, key) => {
            let inside = inside(*hollow);
            let key = match center.first() {
                Some(&0.0) if is_revolved => "ball",
                _ if is_revolved => "ring of round section",
                _ => key,
            };
            format!("{key} around {center:?}, radius {radius} {length}{inside}")
        }
        Shape::Cylinder(center, axis, radius, hollow) => {
            let inside = inside(*hollow);
            format!("cylinder around {center:?} along {axis:?}, radius {radius} {length}{inside}")
        }
        Shape::Polyline(points, radii) if radii.is_empty() => format!("polyline {points:?}"),
        Shape::Polyline(points, radii) => {
            format!("polyline {points:?} with its corners rounded by {radii:?} {length}")
        }
        Shape::Triangles(entry) => {
            let (n, inside) = (entry.skin.triangles.len(), inside(entry.hollow));
            let file = entry.file.display();
            format!(
                "{n} triangles of {file}, sharp above {}°{inside}",
                entry.sharp
            )
        }
    }
}

fn contact<const D: usize>(deck: &Deck, setup: &Setup<D>, index: usize) {
    let (contact, length) = (&deck.contacts[index], deck.units.length());
    let points = setup.driver.contacts().iter();
    let points = points.filter(|c| c.contact == index).count();
    let offset = contact.gap_offset.as_ref();
    let offset = offset.map_or(String::new(), |o| {
        format!(", touching at {} {length}", o.value)
    });
    let adjusted = if contact.adjust.is_some() {
        ", adjusted"
    } else {
        ""
    };
    say!(
        "contact    {} against {}, friction {}, {points} points{offset}{adjusted}",
        contact.surface.value,
        contact.against.value,
        contact.friction
    );
    if let Some(gap) = setup.gaps.iter().find(|g| g.contact == index) {
        say!(
            "           least gap {} {length}, at node {} at {}",
            shown(gap.gap, DIGITS),
            gap.node,
            place(&gap.position, DIGITS)
        );
    }
}

fn method(deck: &Deck) -> String {
    match &deck.solver.method {
        _ if deck.solver.outside => "Uzawa around the nonlinear solve".to_owned(),
        Method::Exact => "exact, semismooth Newton".to_owned(),
        Method::Uzawa => "exact, Uzawa".to_owned(),
        Method::GaussSeidel => "exact, Gauss-Seidel".to_owned(),
        Method::Penalty(n, t) => format!("penalty, {} and {}", n.value, t.value),
        Method::Penetration(part) => format!("penalty, penetration {} of a cell", part.value),
    }
}

/// What stops the rigid motions of a body; steps that are as the one before are not repeated.
fn motions(deck: &Deck, steps: &[Vec<RigidMotion>]) {
    let mut before = None;
    for (step, motions) in deck.steps.iter().zip(steps) {
        if before.replace(motions) == Some(motions) {
            say!("           step {}: as before", step.name.value);
            continue;
        }
        for motion in motions {
            let (step, name) = (&step.name.value, &motion.name);
            let by = stopping(deck, motion);
            say!("           step {step}: {by} {name}");
        }
    }
}

fn stopping(deck: &Deck, motion: &RigidMotion) -> String {
    let group = |(name, directions): &(String, Vec<String>)| {
        format!("{name} along {}", directions.join(", "))
    };
    let what = match motion.stopper {
        Some(Stopper::Friction) => "friction",
        _ => "contact",
    };
    let contact = |&k: &usize| {
        let Some(contact) = deck.contacts.get(k) else {
            let tie = &deck.ties[k - deck.contacts.len()];
            return format!("tie of {} to {}", tie.surface.value, tie.to.value);
        };
        let (surface, opposite) = (&contact.surface.value, &contact.against.value);
        format!("{what} of {surface} with {opposite}")
    };
    let mut list: Vec<String> = motion.groups.iter().map(group).collect();
    list.extend(motion.contacts.iter().map(contact));
    let only = match motion.stopper {
        Some(Stopper::Displacement | Stopper::Tie) | None => "",
        _ if motion.groups.is_empty() => "only ",
        _ => "",
    };
    let verb = if list.len() > 1 { "stop" } else { "stops" };
    format!("{only}{} {verb}", list.join(" and "))
}

fn conditions(deck: &Deck) {
    let (length, force, stress) = (deck.units.length(), deck.units.force(), deck.units.stress());
    for step in &deck.steps {
        say!(
            "step       {}: {}",
            step.name.value,
            match step.increments.min {
                Some(min) => format!(
                    "automatic increments, from {} on between {min} and {} of the step",
                    step.increments.start, step.increments.max
                ),
                None => format!("{} increments", step.increments.count()),
            }
        );
        for condition in &step.conditions {
            let what = match &condition.action {
                Action::Fix(axes) => {
                    let axes: Vec<&str> = axes.iter().map(|&i| AXES[i]).collect();
                    format!("fixed along {}", axes.join(", "))
                }
                Action::Move(u) => {
                    let u: Vec<String> = u
                        .iter()
                        .map(|(i, v)| format!("u_{} = {v} {length}", AXES[*i]))
                        .collect();
                    u.join(", ")
                }
                Action::FixAlong(n) => format!("fixed along {}", place(n, DIGITS)),
                Action::MoveAlong(n, u) => {
                    format!("moved by {u} {length} along {}", place(n, DIGITS))
                }
                Action::Pressure(p) => format!("pressure {p} {stress}"),
                Action::Traction(t) => format!("traction {t:?} {stress}"),
                Action::Force(f) => format!("force {f:?} {force}"),
                Action::BodyForce(f) => format!("body force {f:?} {force}/{length}³"),
                Action::Temperature(FieldEntry::Constant(t)) => format!("warmer by {t} K"),
                Action::Temperature(FieldEntry::Formula(t)) => format!("warmer by {} K", t.trim()),
                Action::Tool(motion, turn) => {
                    let motion = motion.iter().map(|u| format!("moves by {u:?} {length}"));
                    let turn = turn.iter().map(|turn| match deck.analysis.dimension() {
                        2 => format!("turns by {}°", turn.angle),
                        _ => format!("turns by {}° about {:?}", turn.angle, turn.axis),
                    });
                    let all: Vec<String> = motion.chain(turn).collect();
                    format!("tool {}", all.join(" and "))
                }
                Action::Moment(m) => {
                    let axis = match deck.analysis.dimension() {
                        2 => String::new(),
                        _ => format!(" about {:?}", m.axis),
                    };
                    let unit = deck.units.energy();
                    format!("tool is turned by the moment {} {unit}{axis}", m.value)
                }
                Action::Push(f, None) if f.iter().all(|f| *f == 0.0) => {
                    "tool has no force and stays where it is".into()
                }
                Action::Push(f, None) => format!("tool is driven by {f:?} {force}"),
                Action::Push(f, Some(u)) => {
                    format!("tool is driven by {f:?} {force}, else moves by {u:?} {length}")
                }
            };
            let over = condition.table.as_ref().map(|table| {
                let row = |row: &[f64; 2]| format!("{} at {}", row[1], row[0]);
                let rows: Vec<String> = table.value.iter().map(row).collect();
                format!(", times {} of the step", rows.join(", "))
            });
            let over = over.unwrap_or_default();
            say!("           {}: {what}{over}", condition.on.value);
        }
    }
    for e in &deck.expectations {
        say!(
            "expect     {} = {} ± {:.3e}",
            e.column.value,
            e.value,
            e.tolerance()
        );
    }
}
