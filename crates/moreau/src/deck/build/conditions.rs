//! Steps from their entries, and doubts about them; values are not checked here.

use super::Stage;
use super::groups::Groups;
use crate::deck::At;
use crate::deck::entries::{Action, ConditionEntry, Deck, FieldEntry, StepEntry, TurnEntry};
use crate::deck::finding::{Class, Findings};
use crate::driver::{Axis, LeastGap, Step};
use crate::mesh::Facet;
use crate::numbers::place;
use std::collections::HashSet;

const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// The steps of a deck.
pub(super) fn stages<const D: usize>(deck: &Deck, groups: &Groups<D>) -> Vec<Stage<D>> {
    let fixed = |v: &[f64]| std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0));
    let held = held(deck, groups);
    let stage = |entry: &crate::deck::StepEntry| {
        let mut step = Step::new(&entry.name.value);
        for condition in &entry.conditions {
            let on = condition.on.value.as_str();
            let nodes = groups.nodes_of(on);
            let before = step.len();
            step = match &condition.action {
                Action::Fix(axes) => {
                    let axes: Vec<Axis> = axes.iter().map(|&i| AXES[i]).collect();
                    step.fix(nodes, &axes)
                }
                Action::FixAlong(n) => step.fix_along(nodes, fixed(n)),
                Action::MoveAlong(n, u) => step.displace_along(nodes, fixed(n), *u),
                Action::Move(components) => components
                    .iter()
                    .fold(step, |s, &(i, value)| s.displace(nodes, AXES[i], value)),
                Action::Force(force) => step.force(nodes, fixed(force)),
                Action::Pressure(pressure) => step.pressure(on, *pressure),
                Action::Traction(traction) => step.traction(on, fixed(traction)),
                Action::BodyForce(density) => step.body_force(on, fixed(density)),
                Action::Temperature(change) => {
                    let change = change.clone();
                    step.temperature(on, move |x| change.at(x))
                }
                Action::Tool(motion, turn) => {
                    let moved = motion.iter().fold(step, |s, u| s.tool(on, fixed(u)));
                    let turned = |s: Step<D>, turn: &TurnEntry| {
                        s.turn(on, turn.axis, turn.angle.to_radians())
                    };
                    turn.iter().fold(moved, turned)
                }
                Action::Moment(moment) => step.moment(on, moment.axis, moment.value),
                Action::Push(force, motion) => {
                    let moved = motion.iter().fold(step, |s, u| s.tool(on, fixed(u)));
                    let driven = (0..D).filter(|&i| force[i] != 0.0 || drives(deck, on, i));
                    driven.fold(moved, |s, i| s.push(on, AXES[i], force[i]))
                }
            };
            if let Some(table) = &condition.table {
                let added = step.len() - before;
                step = step.over(added, &table.value);
            }
        }
        let directions = |name: &String| {
            let own = entry.conditions.iter().filter(|c| c.on.value == *name);
            own.flat_map(|c| directions(&c.action)).collect()
        };
        Stage {
            step,
            increments: entry.increments,
            until_collapse: entry.until_collapse,
            directions: held.iter().map(|[name, _]| directions(name)).collect(),
        }
    };
    deck.steps.iter().map(stage).collect()
}

/// Whether any step drives a tool along an axis by a force: it then does where that force is zero too.
pub(super) fn drives(deck: &Deck, tool: &str, axis: usize) -> bool {
    let all = deck.steps.iter().flat_map(|s| &s.conditions);
    let mut own = all.filter(|c| c.on.value == tool);
    own.any(|c| matches!(&c.action, Action::Push(force, _) if force.get(axis).is_some_and(|f| *f != 0.0)))
}

/// Axes along which what a condition prescribes of displacements has a part.
pub(super) fn directions(action: &Action) -> Vec<usize> {
    match action {
        Action::Fix(axes) => axes.clone(),
        Action::Move(components) => components.iter().map(|(axis, _)| *axis).collect(),
        Action::FixAlong(n) | Action::MoveAlong(n, _) => {
            (0..n.len()).filter(|&i| n[i] != 0.0).collect()
        }
        _ => Vec::new(),
    }
}

/// Groups in `fix` and `move`, each once, with the group of their nodes.
pub(super) fn held<const D: usize>(deck: &Deck, groups: &Groups<D>) -> Vec<[String; 2]> {
    let mut held: Vec<[String; 2]> = Vec::new();
    for condition in deck.steps.iter().flat_map(|s| &s.conditions) {
        let name = &condition.on.value;
        let holds = !directions(&condition.action).is_empty();
        if holds && !held.iter().any(|[n, _]| n == name) {
            held.push([name.clone(), groups.nodes_of(name).to_owned()]);
        }
    }
    held
}

/// Loads that are zero throughout, and a deck that loads nothing.
pub(super) fn doubts<const D: usize>(deck: &Deck, gaps: &[LeastGap<D>], findings: &mut Findings) {
    let size = |action: &Action| -> Option<f64> {
        let largest = |v: &[f64]| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        match action {
            Action::Fix(_) | Action::FixAlong(_) => None,
            Action::MoveAlong(_, u) => Some(u.abs()),
            Action::Move(components) => Some(components.iter().fold(0.0, |m, c| c.1.abs().max(m))),
            Action::Pressure(p) => Some(p.abs()),
            Action::Traction(v) | Action::Force(v) | Action::BodyForce(v) => Some(largest(v)),
            Action::Temperature(FieldEntry::Constant(change)) => Some(change.abs()),
            Action::Temperature(FieldEntry::Formula(_)) => Some(1.0),
            Action::Tool(motion, turn) => {
                let moved = motion.as_ref().map_or(0.0, |u| largest(u));
                Some(moved.max(turn.map_or(0.0, |t| t.angle.abs())))
            }
            // A roll that turns freely.
            Action::Moment(moment) => (moment.value != 0.0).then(|| moment.value.abs()),
            Action::Push(force, motion) => {
                let moved = motion.as_ref().map_or(0.0, |u| largest(u));
                Some(largest(force).max(moved))
            }
        }
    };
    let all = || deck.steps.iter().flat_map(|s| &s.conditions);
    let loaded =
        |name: &str| all().any(|c| c.on.value == name && size(&c.action).is_some_and(|s| s > 0.0));
    for condition in all().filter(|c| size(&c.action) == Some(0.0)) {
        // A load that returns to zero is an unloading.
        let held = matches!(
            condition.action,
            Action::Move(_) | Action::MoveAlong(..) | Action::Tool(..)
        );
        let on = &condition.on.value;
        if !held && !loaded(on) {
            let message = match condition.action {
                Action::Push(..) => format!(
                    "the force on \"{on}\" is zero in all steps: it drives the tool nowhere, which stays where it is"
                ),
                _ => format!("the load on \"{on}\" is zero in all steps"),
            };
            findings.warning(&condition.span, message, "zero");
        }
    }
    // What begins within something else is loaded by that, as a ring on its shaft; or it begins under a stress.
    let fits = gaps.iter().any(|g| g.inside > 0) || !deck.initial.is_empty();
    if !fits && !all().any(|c| size(&c.action).is_some_and(|s| s > 0.0)) {
        let span = deck.steps.first().map_or(0..0, |s| s.name.span.clone());
        findings.warning(
            &span,
            "nothing loads the model: no move, load or tool motion is other than zero",
            "no load",
        );
    }
}

/// Motions of tools along axes in which a force drives them, and those that take back what a force drove without saying
/// that the force goes.
pub(super) fn driven<const D: usize>(deck: &Deck, findings: &mut Findings) {
    const AXES: [&str; 3] = ["x", "y", "z"];
    for (number, step) in deck.steps.iter().enumerate() {
        for condition in &step.conditions {
            let on = &condition.on.value;
            match &condition.action {
                Action::Push(_, Some(u)) => {
                    let Some(axis) = (0..D).find(|&i| u[i] != 0.0 && drives(deck, on, i)) else {
                        continue;
                    };
                    let message = format!(
                        "a motion of \"{on}\" along {0}, beside a force, though another step gives it a force along {0}",
                        AXES[axis]
                    );
                    let label = "the force would decide how far it goes, being zero";
                    let help = "put 0 there, or move it in a step without a force";
                    let error = findings.error_with(&condition.span, message, label, help);
                    error.about(Class::Steps);
                }
                Action::Tool(Some(u), _) if u.iter().any(|u| *u != 0.0) => {
                    let before = deck.steps[..number].iter().rev();
                    let Some((force, name)) = before.flat_map(|s| driven_in(s, on)).next() else {
                        continue;
                    };
                    let Some(axis) = (0..D).find(|&i| force[i] != 0.0 && u[i] == 0.0) else {
                        continue;
                    };
                    let message = format!(
                        "step \"{}\" takes \"{on}\" back to 0 along {}, where a force drove it in step \"{name}\": what it \
                         bears there goes with that",
                        step.name.value, AXES[axis]
                    );
                    let label =
                        format!("force = {} keeps it, zeros let go of it", place(&force, 6));
                    findings.warning(&condition.span, message, label);
                }
                _ => {}
            }
        }
    }
}

/// The force at the end of a step that moves or drives a tool, and the name of the step: zeros where it moves it.
fn driven_in<'a>(step: &'a StepEntry, on: &str) -> Option<(Vec<f64>, &'a str)> {
    let of = |c: &ConditionEntry| match &c.action {
        Action::Push(force, _) => Some(force.iter().map(|f| f * c.last_share()).collect()),
        Action::Tool(Some(u), _) => Some(vec![0.0; u.len()]),
        _ => None,
    };
    let mut own = step.conditions.iter().filter(|c| c.on.value == on);
    Some((own.find_map(of)?, &step.name.value))
}

/// Temperatures that expand nothing, and expansions that no temperature reaches.
pub(super) fn heat<const D: usize>(deck: &Deck, groups: &Groups<D>, findings: &mut Findings) {
    let cells = |name: &str| groups.mesh.cell_group(name).unwrap_or_default();
    let heated = deck.steps.iter().flat_map(|s| &s.conditions);
    let heated: Vec<_> = heated
        .filter(|c| matches!(c.action, Action::Temperature(_)))
        .map(|c| &c.on)
        .collect();
    let expands = deck.materials.iter().filter(|m| m.expansion.is_some());
    let expanding: HashSet<usize> = expands
        .clone()
        .flat_map(|m| cells(&m.on.value))
        .copied()
        .collect();
    for on in &heated {
        if !cells(&on.value).iter().any(|cell| expanding.contains(cell)) {
            let message = format!(
                "the temperature of \"{}\" strains nothing: no material there has an expansion",
                on.value
            );
            findings.warning(
                &on.span,
                message,
                "expansion = 1.2e-5 is that of steel per kelvin",
            );
        }
    }
    let warm: HashSet<usize> = heated
        .iter()
        .flat_map(|on| cells(&on.value))
        .copied()
        .collect();
    for material in expands {
        let at = material
            .expansion
            .as_ref()
            .map_or(&material.on.span, |e| &e.span);
        if !cells(&material.on.value)
            .iter()
            .any(|cell| warm.contains(cell))
        {
            let message = format!(
                "the expansion of \"{}\" does nothing: no step gives it a temperature",
                material.on.value
            );
            let label = "load = [{ on = …, temperature = … }]";
            findings.warning(at, message, label);
        }
    }
}

/// Contacts and tractions on facets between two cells: what lies inside a body touches nothing.
pub(super) fn inner_surfaces<const D: usize>(
    deck: &Deck,
    groups: &Groups<D>,
    findings: &mut Findings,
) {
    // The sides of a block are on its boundary.
    if deck.mesh_files.is_empty() {
        return;
    }
    let boundary: HashSet<Facet> = groups.mesh.boundary_facets().into_iter().collect();
    let loads = deck
        .steps
        .iter()
        .flat_map(|s| &s.conditions)
        .filter(|c| matches!(c.action, Action::Pressure(_) | Action::Traction(_)));
    // A tool that is called as a group is one: see `Model::contact`.
    let is_tool = |on: &&At<String>| deck.tools.iter().any(|t| t.name.value == on.value);
    let opposites = deck.contacts.iter().map(|c| &c.against);
    let opposites = opposites.filter(|on| !is_tool(on));
    let surfaces = deck.contacts.iter().map(|c| &c.surface).chain(opposites);
    let ties = deck.ties.iter().flat_map(|t| [&t.surface, &t.to]);
    for on in surfaces.chain(ties).chain(loads.map(|c| &c.on)) {
        let facets = groups.mesh.facet_group(&on.value).unwrap_or_default();
        let inside = facets.iter().filter(|f| !boundary.contains(f)).count();
        if inside > 0 {
            findings.warning(
                &on.span,
                format!(
                    "{inside} of the {} facets of \"{}\" lie between two cells, inside a body",
                    facets.len(),
                    on.value
                ),
                "not on the surface",
            );
        }
    }
}
