//! A deck written out again with every default spelt; not a copy of the file.

use super::build::quadratures;
use super::entries::{
    Action, Adjust, BlockEntry, ConditionEntry, ContactEntry, Deck, FileEntry, Grid, GroupEntry,
    Hardening, InitialEntry, MaterialEntry, Method, Part, Shape, StepEntry, ToolEntry, TurnEntry,
    Vtu,
};
use super::finding::At;
use crate::driver::Increments;
use crate::mesh::Integration;
use std::fmt::{self, Write};

/// Where a material has several rules.
const BY_ELEMENT: &str = "by element";
const AXES: [&str; 3] = ["x", "y", "z"];

impl Deck {
    /// The deck as TOML, with every default spelt out: it describes the same problem.
    pub fn resolved(&self) -> String {
        let mut out = String::new();
        // Writing to a string does not fail.
        let _ = write(self, &mut out);
        out
    }

    /// The quadrature of a material, chosen by the deck or by its elements: `"by element"` where
    /// these differ, or are not known because the mesh is not.
    pub fn quadrature(&self, material: &MaterialEntry) -> &'static str {
        match quadratures(material, self.analysis)[..] {
            [(Integration::Reduced, _)] => "reduced",
            [(Integration::Full, _)] => "full",
            [(Integration::BBar, _)] => "b-bar",
            _ => BY_ELEMENT,
        }
    }
}

fn text(value: &str) -> String {
    toml::Value::String(value.to_owned()).to_string()
}

fn write(deck: &Deck, out: &mut String) -> fmt::Result {
    head(deck, out)?;
    files(deck, out)?;
    for entry in &deck.blocks {
        block(entry, out)?;
    }
    for entry in &deck.groups {
        group(entry, out)?;
    }
    for entry in &deck.materials {
        material(deck, entry, out)?;
    }
    for entry in &deck.initial {
        initial(entry, out)?;
    }
    for entry in &deck.tools {
        tool(entry, out)?;
    }
    for entry in &deck.contacts {
        contact(entry, out)?;
    }
    for entry in &deck.ties {
        writeln!(out, "\n[[tie]]\nsurface = {}", surface(&entry.parts))?;
        writeln!(out, "to = {}", text(&entry.to.value))?;
    }
    for entry in &deck.steps {
        step(entry, deck.analysis.dimension(), out)?;
    }
    tail(deck, out)
}

fn head(deck: &Deck, out: &mut String) -> fmt::Result {
    writeln!(out, "title = {}", text(&deck.title))?;
    writeln!(out, "units = \"{}\"", deck.units.name())?;
    writeln!(out, "analysis = \"{}\"", deck.analysis.name())?;
    let strain = if deck.finite.is_some() {
        "finite"
    } else {
        "small"
    };
    writeln!(out, "strain = \"{strain}\"")?;
    if deck.analysis.has_thickness() {
        writeln!(out, "thickness = {:?}", deck.thickness.value)?;
    }
    Ok(())
}

/// The mesh files: one as it is, or each a part.
fn files(deck: &Deck, out: &mut String) -> fmt::Result {
    if let Some(checksum) = &deck.found_checksum {
        writeln!(out, "checksum = \"{checksum}\"")?;
    }
    let dimension = deck.analysis.dimension();
    for (k, part) in deck.mesh_files.iter().enumerate() {
        // What is written stands in another folder than the deck.
        let file = &part.file.value;
        let path = std::path::absolute(file).unwrap_or_else(|_| file.clone());
        let is_plain = *part == FileEntry::plain(part.file.clone(), dimension);
        let table = if is_plain && k == 0 {
            "[mesh]"
        } else {
            "[[mesh.part]]"
        };
        writeln!(out, "\n{table}\nfile = {}", text(&path.to_string_lossy()))?;
        if is_plain {
            continue;
        }
        if let Some(name) = &part.name {
            writeln!(out, "name = {}", text(&name.value))?;
        }
        writeln!(out, "scale = {:?}", part.scale)?;
        if let Some(turn) = &part.turn {
            writeln!(out, "turn = {}", turned(turn, dimension))?;
        }
        writeln!(out, "position = {:?}", part.position)?;
    }
    Ok(())
}

/// A turn: a number in the plane.
fn turned(turn: &TurnEntry, dimension: usize) -> String {
    match dimension {
        2 => format!("{:?}", turn.angle),
        _ => format!("{{ axis = {:?}, angle = {:?} }}", turn.axis, turn.angle),
    }
}

fn block(block: &BlockEntry, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[mesh.block]]\nname = {}", text(&block.name.value))?;
    writeln!(out, "element = \"{}\"", block.element.value)?;
    for (axis, grid) in AXES.iter().zip(&block.grid) {
        match &grid.value {
            Grid::Range(ends, _) => writeln!(out, "{axis} = {ends:?}")?,
            Grid::Lines(lines) => writeln!(out, "{axis} = {{ lines = {lines:?} }}")?,
        }
    }
    let cells: Vec<usize> = block.grid.iter().map(|g| g.value.cells()).collect();
    writeln!(out, "cells = {cells:?}")?;
    Ok(())
}

fn group(group: &GroupEntry, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[mesh.group]]\nname = {}", text(&group.name.value))?;
    writeln!(out, "on = {}", text(&group.on.value))?;
    match &group.part.value {
        Part::Nearest(point) => writeln!(out, "nearest = {point:?}")?,
        Part::Box(limits) => {
            for (axis, limit) in AXES.iter().zip(limits) {
                if let Some(ends) = limit {
                    writeln!(out, "{axis} = {ends:?}")?;
                }
            }
        }
    }
    Ok(())
}

fn material(deck: &Deck, material: &MaterialEntry, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[material]]\non = {}", text(&material.on.value))?;
    match material.axes.as_ref().and_then(|a| a.elastic.as_ref()) {
        Some(given) => {
            let [young, poisson, shear] = given.value;
            writeln!(
                out,
                "orthotropic = {{ young = {young:?}, poisson = {poisson:?}, shear = {shear:?} }}"
            )?;
        }
        None => {
            writeln!(out, "young = {:?}", material.young.value)?;
            writeln!(out, "poisson = {:?}", material.poisson.value)?;
        }
    }
    if let Some(axes) = &material.axes {
        if let Some(hill) = &axes.hill {
            writeln!(out, "hill = {}", hill.value)?;
        }
        if let Some(directions) = &axes.directions {
            writeln!(out, "axes = {}", directions.value)?;
        }
    }
    if let Some(yield_stress) = &material.yield_stress {
        writeln!(out, "yield-stress = {:?}", yield_stress.value)?;
        let none = Hardening {
            linear: 0.0,
            curve: None,
        };
        let hardening = material.isotropic.as_ref().map_or(&none, |h| &h.value);
        writeln!(out, "hardening = {hardening}")?;
        let terms = material.kinematic.iter().map(|[modulus, recall]| {
            let (modulus, recall) = (modulus.value, recall.value);
            format!("{{ modulus = {modulus:?}, recall = {recall:?} }}")
        });
        let terms: Vec<String> = terms.collect();
        if material.axes.is_none() {
            writeln!(out, "kinematic = [{}]", terms.join(", "))?;
        }
    }
    if let Some(soil) = &material.soil {
        writeln!(out, "cohesion = {:?}", soil.cohesion.value)?;
        writeln!(out, "friction-angle = {:?}", soil.friction_angle.value)?;
        writeln!(out, "dilatancy-angle = {:?}", soil.dilatancy_angle.value)?;
    }
    if let Some(expansion) = &material.expansion {
        writeln!(out, "expansion = {:?}", expansion.value)?;
    }
    let quadrature = deck.quadrature(material);
    if quadrature != BY_ELEMENT {
        writeln!(out, "quadrature = \"{quadrature}\"")?;
    }
    Ok(())
}

fn initial(entry: &InitialEntry, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[initial]]\non = {}", text(&entry.on.value))?;
    let components = ["xx", "yy", "zz", "xy", "yz", "xz"]
        .iter()
        .zip(&entry.stress);
    let given =
        components.filter_map(|(key, value)| Some(format!("{key} = {}", value.as_ref()?.value)));
    let given: Vec<String> = given.collect();
    if !given.is_empty() {
        writeln!(out, "stress = {{ {} }}", given.join(", "))?;
    }
    if let Some(p) = &entry.p {
        writeln!(out, "p = {}", p.value)?;
    }
    Ok(())
}

fn tool(tool: &ToolEntry, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[tool]]\nname = {}", text(&tool.name.value))?;
    match &tool.shape.value {
        Shape::Plane(point, normal) => {
            writeln!(out, "plane = {{ point = {point:?}, normal = {normal:?} }}")?;
        }
        Shape::Ball(center, radius, hollow, key) => {
            writeln!(
                out,
                "{key} = {{ center = {center:?}, radius = {radius:?} }}"
            )?;
            writeln!(out, "inside = {hollow}")?;
        }
        Shape::Cylinder(center, axis, radius, hollow) => {
            writeln!(
                out,
                "cylinder = {{ center = {center:?}, axis = {axis:?}, radius = {radius:?} }}"
            )?;
            writeln!(out, "inside = {hollow}")?;
        }
        Shape::Polyline(points, radii) if radii.is_empty() => {
            writeln!(out, "polyline = {points:?}")?;
        }
        Shape::Polyline(points, radii) => {
            writeln!(
                out,
                "profile = {{ points = {points:?}, radii = {radii:?} }}"
            )?;
        }
        Shape::Triangles(entry) => {
            let path = std::path::absolute(&entry.file).unwrap_or_else(|_| entry.file.clone());
            let group = entry.group.as_ref();
            let group = group.map_or(String::new(), |g| format!(", group = {}", text(g)));
            writeln!(
                out,
                "surface = {{ file = {}{group}, sharp = {:?} }}",
                text(&path.to_string_lossy()),
                entry.sharp
            )?;
            writeln!(out, "inside = {}", entry.hollow)?;
        }
    }
    if let Some(reference) = &tool.reference {
        writeln!(out, "reference = {:?}", reference.value)?;
    }
    Ok(())
}

/// One group, or several.
fn surface(parts: &[At<String>]) -> String {
    let parts: Vec<String> = parts.iter().map(|p| text(&p.value)).collect();
    match parts.as_slice() {
        [one] => one.clone(),
        _ => format!("[{}]", parts.join(", ")),
    }
}

fn contact(contact: &ContactEntry, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[contact]]\nsurface = {}", surface(&contact.parts))?;
    writeln!(out, "against = {}", text(&contact.against.value))?;
    writeln!(out, "friction = {}", contact.friction)?;
    if let Some(offset) = &contact.gap_offset {
        writeln!(out, "gap-offset = {:?}", offset.value)?;
    }
    match contact.adjust.as_ref().map(|a| a.value) {
        None => {}
        Some(Adjust::Near) => writeln!(out, "adjust = true")?,
        Some(Adjust::Within(distance)) => writeln!(out, "adjust = {distance:?}")?,
    }
    Ok(())
}

fn step(step: &StepEntry, dimension: usize, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[[step]]\nname = {}", text(&step.name.value))?;
    if step.until_collapse {
        writeln!(out, "until = \"collapse\"")?;
    }
    let Increments { start, min, max } = step.increments;
    match min {
        None => writeln!(out, "increments = {}", step.increments.count())?,
        Some(min) => writeln!(
            out,
            "increments = {{ start = {start:?}, min = {min:?}, max = {max:?} }}"
        )?,
    }
    for (key, list) in lists(&step.conditions, dimension) {
        writeln!(out, "{key} = [{}]", list.join(", "))?;
    }
    Ok(())
}

/// The conditions of a step, by key.
fn lists(conditions: &[ConditionEntry], dimension: usize) -> [(&'static str, Vec<String>); 4] {
    let mut lists = [
        ("fix", Vec::new()),
        ("move", Vec::new()),
        ("load", Vec::new()),
        ("tools", Vec::new()),
    ];
    for condition in conditions {
        let on = text(&condition.on.value);
        let (list, item) = match &condition.action {
            Action::Fix(axes) => {
                let axes: Vec<&str> = axes.iter().map(|&i| AXES[i]).collect();
                (0, format!("{{ on = {on}, u = {axes:?} }}"))
            }
            Action::Move(components) => {
                let u: Vec<String> = components
                    .iter()
                    .map(|(i, v)| format!("{} = {v:?}", AXES[*i]))
                    .collect();
                (1, format!("{{ on = {on}, u = {{ {} }} }}", u.join(", ")))
            }
            Action::FixAlong(n) => (0, format!("{{ on = {on}, along = {n:?} }}")),
            Action::MoveAlong(n, u) => (1, format!("{{ on = {on}, along = {n:?}, u = {u:?} }}")),
            Action::Pressure(p) => (2, format!("{{ on = {on}, pressure = {p:?} }}")),
            Action::Traction(v) => (2, format!("{{ on = {on}, traction = {v:?} }}")),
            Action::Force(v) => (2, format!("{{ on = {on}, force = {v:?} }}")),
            Action::BodyForce(v) => (2, format!("{{ on = {on}, body-force = {v:?} }}")),
            Action::Temperature(t) => (2, format!("{{ on = {on}, temperature = {t} }}")),
            Action::Tool(motion, turn) => {
                let motion = motion.iter().map(|v| format!(", move = {v:?}"));
                let turn = turn.iter();
                let turn = turn.map(|turn| format!(", turn = {}", turned(turn, dimension)));
                let all: String = motion.chain(turn).collect();
                (3, format!("{{ name = {on}{all} }}"))
            }
            Action::Moment(moment) => {
                let moment = match dimension {
                    2 => format!("{:?}", moment.value),
                    _ => format!("{{ axis = {:?}, value = {:?} }}", moment.axis, moment.value),
                };
                (3, format!("{{ name = {on}, moment = {moment} }}"))
            }
            Action::Push(v, None) => (3, format!("{{ name = {on}, force = {v:?} }}")),
            Action::Push(v, Some(u)) => {
                (3, format!("{{ name = {on}, move = {u:?}, force = {v:?} }}"))
            }
        };
        lists[list].1.push(match &condition.table {
            None => item,
            Some(table) => {
                let open = item.strip_suffix(" }").unwrap_or(&item);
                format!("{open}, table = {:?} }}", table.value)
            }
        });
    }
    lists
}

fn tail(deck: &Deck, out: &mut String) -> fmt::Result {
    let method = match &deck.solver.method {
        Method::Exact => "\"exact\"".to_owned(),
        Method::Uzawa => "\"uzawa\"".to_owned(),
        Method::GaussSeidel => "\"gauss-seidel\"".to_owned(),
        Method::Penalty(n, t) => format!(
            "{{ penalty = {{ normal = {:?}, tangent = {:?} }} }}",
            n.value, t.value
        ),
        Method::Penetration(part) => format!("{{ penetration = {:?} }}", part.value),
    };
    writeln!(out, "\n[solver]")?;
    match deck.solver.outside {
        // Uzawa's method, and no other.
        true => writeln!(out, "nesting = \"outside\"")?,
        false => writeln!(out, "contact = {method}\nnesting = \"inside\"")?,
    }
    writeln!(out, "threads = {}", deck.solver.threads)?;
    writeln!(out, "tolerance = {:?}", deck.solver.tolerance)?;
    writeln!(out, "\n[output]")?;
    if let Some(directory) = &deck.directory {
        writeln!(out, "directory = {}", text(directory))?;
    }
    for (key, which) in [("vtu", deck.vtu), ("points", deck.points)] {
        writeln!(out, "{key} = \"{}\"", Vtu::NAMES[which as usize])?;
    }
    writeln!(out, "checkpoint = {}", deck.checkpoint)?;
    if !deck.probes.is_empty() {
        let probes: Vec<String> = deck.probes.iter().map(|p| text(&p.value)).collect();
        writeln!(out, "probes = [{}]", probes.join(", "))?;
    }
    if !deck.expectations.is_empty() {
        writeln!(out, "\n[expect]")?;
    }
    for expectation in &deck.expectations {
        let column = text(&expectation.column.value);
        write!(out, "{column} = {{ value = {:?}", expectation.value)?;
        for (key, tolerance) in [
            ("relative", expectation.relative),
            ("absolute", expectation.absolute),
        ] {
            if let Some(tolerance) = tolerance {
                write!(out, ", {key} = {tolerance:?}")?;
            }
        }
        writeln!(out, " }}")?;
    }
    Ok(())
}
