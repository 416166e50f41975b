//! Names: every one used exists, holds what is needed, and no name is given twice.

use super::groups::Groups;
use crate::deck::Laws;
use crate::deck::entries::{Action, ContactEntry, Deck};
use crate::deck::finding::{At, Class, Findings, did_you_mean};
use std::collections::BTreeSet;

/// What a group must hold.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Needed {
    Cells,
    Facets,
    Nodes,
    /// Facets or nodes: shared by the nodes of a body a force would be larger where its cells are smaller.
    Loaded,
}

pub(super) fn check<const D: usize>(
    deck: &Deck,
    groups: Option<&Groups<D>>,
    findings: &mut Findings,
) {
    let used = used(deck, groups, findings);
    for entry in &deck.groups {
        if !used.contains(&entry.name.value) && findings.errors() == 0 {
            let message = format!("no condition uses the group \"{}\"", entry.name.value);
            findings.warning(&entry.name.span, message, "not used");
        }
    }
    idle_names(deck, groups, &used, findings);
    for entry in &deck.tools {
        let mut contacts = deck.contacts.iter();
        let touched = contacts.any(|c| c.against.value == entry.name.value);
        if !touched && findings.errors() == 0 {
            let message = format!("no [[contact]] uses the tool \"{}\"", entry.name.value);
            findings.warning(&entry.name.span, message, "touches nothing");
        }
    }
    twice(deck, groups, findings);
}

/// Every law that is given stands in place of that of a material.
pub(super) fn check_laws(deck: &Deck, laws: &Laws, findings: &mut Findings) {
    let materials = || deck.materials.iter().map(|m| &m.on);
    let names = || materials().map(|on| on.value.as_str());
    for given in laws.keys() {
        if names().any(|name| name == given) {
            continue;
        }
        let near = did_you_mean(given, names());
        let message = format!("a law is given on \"{given}\", and no material is on that{near}");
        let span = materials().next().map_or(0..0, |on| on.span.clone());
        findings
            .error(&span, message, "where there is a material")
            .about(Class::Names);
    }
}

/// Names that materials, contacts, conditions and groups use; errors for those that are not what is
/// needed there.
fn used<const D: usize>(
    deck: &Deck,
    groups: Option<&Groups<D>>,
    findings: &mut Findings,
) -> BTreeSet<String> {
    let mut used = BTreeSet::new();
    let tools = &deck.tool_names;
    for material in &deck.materials {
        let on = &material.on;
        group(on, Needed::Cells, tools, groups, &mut used, findings);
    }
    for entry in &deck.initial {
        group(&entry.on, Needed::Cells, tools, groups, &mut used, findings);
    }
    for contact in &deck.contacts {
        for on in &contact.parts {
            group(on, Needed::Facets, tools, groups, &mut used, findings);
        }
        opposite(&contact.against, deck, groups, &mut used, findings);
    }
    for tie in &deck.ties {
        for on in tie.parts.iter().chain([&tie.to]) {
            group(on, Needed::Facets, tools, groups, &mut used, findings);
        }
    }
    for condition in deck.steps.iter().flat_map(|step| &step.conditions) {
        let on = &condition.on;
        match needed(&condition.action) {
            Some(needed) => group(on, needed, tools, groups, &mut used, findings),
            None => tool(on, deck, &mut used, findings),
        }
    }
    for probe in &deck.probes {
        group(probe, Needed::Nodes, tools, groups, &mut used, findings);
    }
    used.extend(deck.groups.iter().map(|g| g.on.value.clone()));
    used
}

/// What the group of a condition must hold; `None` where the condition is on a tool.
fn needed(action: &Action) -> Option<Needed> {
    match action {
        Action::Tool(..) | Action::Push(..) | Action::Moment(_) => None,
        Action::Fix(_) | Action::FixAlong(_) | Action::Move(_) | Action::MoveAlong(..) => {
            Some(Needed::Nodes)
        }
        Action::Force(_) => Some(Needed::Loaded),
        Action::Pressure(_) | Action::Traction(_) => Some(Needed::Facets),
        Action::BodyForce(_) | Action::Temperature(_) => Some(Needed::Cells),
    }
}

/// Groups of the mesh file that nothing uses, in one warning.
fn idle_names<const D: usize>(
    deck: &Deck,
    groups: Option<&Groups<D>>,
    used: &BTreeSet<String>,
    findings: &mut Findings,
) {
    let (Some(first), Some(groups), 0) = (deck.mesh_files.first(), groups, findings.errors())
    else {
        return;
    };
    let of_deck = |name: &str| {
        let of_block = deck.blocks.iter().any(|b| {
            let rest = name.strip_prefix(b.name.value.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        });
        let mut parts = deck.mesh_files.iter().flat_map(|part| &part.name);
        let is_part = parts.any(|part| part.value == name);
        // Surfaces of several parts are groups of their own.
        let contacts = deck.contacts.iter().map(|c| &c.surface);
        let mut joined = contacts.chain(deck.ties.iter().flat_map(|t| [&t.surface, &t.to]));
        let is_joined = joined.any(|on| on.value == name);
        let is_group = || deck.groups.iter().any(|g| g.name.value == name);
        of_block || is_part || is_joined || is_group()
    };
    let idle: Vec<String> = groups
        .names()
        .filter(|name| !used.contains(*name) && !of_deck(name))
        .map(|name| format!("\"{name}\""))
        .collect();
    if !idle.is_empty() {
        let message = format!("nothing uses these groups of the mesh: {}", idle.join(", "));
        findings.warning(&first.file.span, message, "has groups that are not used");
    }
}

fn group<const D: usize>(
    name: &At<String>,
    needed: Needed,
    tools: &[String],
    groups: Option<&Groups<D>>,
    used: &mut BTreeSet<String>,
    findings: &mut Findings,
) {
    used.insert(name.value.clone());
    let Some(groups) = groups else { return };
    if groups.is_broken(&name.value) {
        return;
    }
    if tools.contains(&name.value) && !groups.has(&name.value) {
        let message = format!(
            "\"{}\" is a tool, expected a group of the mesh: tools stand in `against` and in `tools`",
            name.value
        );
        findings
            .error(&name.span, message, "a tool")
            .about(Class::Names);
        return;
    }
    let fits = |n: &str| match needed {
        Needed::Cells => groups.mesh.cell_group(n).is_ok(),
        Needed::Facets => groups.mesh.facet_group(n).is_ok(),
        Needed::Nodes => true,
        Needed::Loaded => groups.mesh.facet_group(n).is_ok() || groups.mesh.cell_group(n).is_err(),
    };
    if !groups.has(&name.value) {
        let near = did_you_mean(&name.value, groups.names().filter(|n| fits(n)));
        let message = format!("no group \"{}\"{near}", name.value);
        findings
            .error(&name.span, message, "not a group")
            .about(Class::Names);
    } else if !fits(&name.value) {
        let what = match needed {
            Needed::Cells => "a group of cells (a body)",
            Needed::Loaded => {
                "a group of facets (a side of a body) or of nodes: it is `body-force` that loads a body"
            }
            _ => "a group of facets (a side of a body)",
        };
        let found = match groups.mesh.cell_group(&name.value).is_ok() {
            true => "cells",
            false if groups.mesh.facet_group(&name.value).is_ok() => "facets",
            false => "nodes",
        };
        let near = did_you_mean(&name.value, groups.names().filter(|n| fits(n)));
        findings
            .error(
                &name.span,
                format!("\"{}\" holds {found}, expected {what}{near}", name.value),
                format!("holds {found}"),
            )
            .about(Class::Names);
    }
}

fn tool(name: &At<String>, deck: &Deck, used: &mut BTreeSet<String>, findings: &mut Findings) {
    used.insert(name.value.clone());
    if !deck.tool_names.contains(&name.value) {
        let near = did_you_mean(&name.value, deck.tool_names.iter().map(String::as_str));
        let message = format!("no tool \"{}\"{near}", name.value);
        findings
            .error(&name.span, message, "not a tool")
            .about(Class::Names);
    }
}

/// A tool, or the surface of another body.
fn opposite<const D: usize>(
    name: &At<String>,
    deck: &Deck,
    groups: Option<&Groups<D>>,
    used: &mut BTreeSet<String>,
    findings: &mut Findings,
) {
    used.insert(name.value.clone());
    let Some(groups) = groups else { return };
    let is_tool = deck.tool_names.contains(&name.value);
    if is_tool || groups.is_broken(&name.value) || groups.mesh.facet_group(&name.value).is_ok() {
        return;
    }
    let facets = groups
        .names()
        .filter(|n| groups.mesh.facet_group(n).is_ok());
    let tools = deck.tool_names.iter().map(String::as_str);
    let near = did_you_mean(&name.value, tools.chain(facets));
    let message = format!("no tool \"{}\"{near}", name.value);
    findings
        .error(&name.span, message, "neither a tool nor a side of a body")
        .about(Class::Names);
}

/// Names of tools and steps that are given twice. Groups complain for themselves.
fn twice<const D: usize>(deck: &Deck, groups: Option<&Groups<D>>, findings: &mut Findings) {
    for (k, tool) in deck.tools.iter().enumerate() {
        let name = &tool.name.value;
        if deck.tools[..k].iter().any(|t| t.name.value == *name) {
            let message = format!("a tool named \"{name}\" exists already: names must differ");
            findings
                .error(&tool.name.span, message, "used twice")
                .about(Class::Names);
        } else if groups.is_some_and(|g| g.has(name)) {
            let message = format!("a group is named \"{name}\" as well: names must differ");
            findings
                .error(&tool.name.span, message, "used twice")
                .about(Class::Names);
        }
    }
    for (k, step) in deck.steps.iter().enumerate() {
        let name = &step.name.value;
        if deck.steps[..k].iter().any(|s| s.name.value == *name) {
            let message = format!("a step named \"{name}\" exists already: names must differ");
            findings
                .error(&step.name.span, message, "used twice")
                .about(Class::Names);
        }
    }
    for (k, block) in deck.blocks.iter().enumerate() {
        let name = &block.name.value;
        if deck.blocks[..k].iter().any(|b| b.name.value == *name) {
            let message = format!("a block named \"{name}\" exists already: names must differ");
            findings
                .error(&block.name.span, message, "used twice")
                .about(Class::Names);
        }
    }
    for (k, material) in deck.materials.iter().enumerate() {
        let name = &material.on.value;
        if deck.materials[..k].iter().any(|m| m.on.value == *name) {
            let message = format!("\"{name}\" has a material already, expected one for each body");
            findings
                .error(&material.on.span, message, "given twice")
                .about(Class::Names);
        }
    }
    for (k, contact) in deck.contacts.iter().enumerate() {
        let (name, against) = (&contact.surface.value, &contact.against.value);
        let is_same = |c: &ContactEntry| c.surface.value == *name && c.against.value == *against;
        if deck.contacts[..k].iter().any(is_same) {
            let message = format!("\"{name}\" has a contact with \"{against}\" already");
            findings
                .error(&contact.surface.span, message, "given twice")
                .about(Class::Names);
        }
    }
}
