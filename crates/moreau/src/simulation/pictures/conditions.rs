//! What a step of a plane deck does to its bodies, as marks on a picture before anything is computed: supports, motions,
//! loads, contacts with their gaps; not the tools' outlines.

use crate::deck::{Action, ConditionEntry, Deck, Setup, StepEntry};
use crate::mesh::Mesh;
use crate::numbers::shown;
use crate::plot::Mark;
use crate::simulation::tools::Sheet;
use nalgebra::{Vector2, Vector3};

/// Marks along the longest side of the body, at most.
const MOST: f64 = 24.0;
/// Significant digits.
const DIGITS: usize = 4;
const MOTION: &str = "#1f5fbf";
const LOAD: &str = "#c02626";
const CONTACT: &str = "#e07b00";
const INK: &str = "#333333";

/// The marks of a step.
pub(super) fn marks(deck: &Deck, setup: &Setup<2>, step: &StepEntry) -> Vec<Mark> {
    let scene = Scene::new(deck, setup.driver.mesh());
    let mut marks = Vec::new();
    for contact in &deck.contacts {
        marks.extend(scene.surface(&contact.surface.value));
    }
    for condition in &step.conditions {
        scene.condition(condition, &mut marks);
    }
    let length = deck.units.length();
    for gap in &setup.gaps {
        let Some(contact) = deck.contacts.get(gap.contact) else {
            continue;
        };
        let found = match gap.gap.abs() <= setup.driver.rounding_of_gaps() {
            true => "touches".to_owned(),
            false => format!("gap {} {length}", shown(gap.gap, DIGITS)),
        };
        let friction = &contact.friction;
        marks.push(Mark::Label {
            at: gap.position,
            towards: scene.inwards(gap.position),
            text: format!("{}: {found}, friction {friction}", contact.against.value),
            colour: CONTACT,
        });
    }
    marks
}

/// The body with what marks have to know of it.
struct Scene<'a> {
    deck: &'a Deck,
    mesh: &'a Mesh<2>,
    centre: Vector2<f64>,
    /// Half of its width and of its height \[mm\].
    half: Vector2<f64>,
    /// Least distance of marks \[mm\].
    apart: f64,
}

impl<'a> Scene<'a> {
    fn new(deck: &'a Deck, mesh: &'a Mesh<2>) -> Self {
        let (low, high) = mesh.bounds();
        let (low, high) = (Vector2::from(low), Vector2::from(high));
        Self {
            deck,
            mesh,
            centre: 0.5 * (low + high),
            half: 0.5 * (high - low),
            apart: (high - low).amax() / MOST,
        }
    }

    /// The axis direction that leads from a place towards the middle of the body.
    fn inwards(&self, at: [f64; 2]) -> [f64; 2] {
        let way = self.centre - Vector2::from(at);
        // By the side that it is nearest to.
        let part = way.abs().component_div(&self.half);
        match part.y >= part.x {
            true => [0.0, way.y.signum()],
            false => [way.x.signum(), 0.0],
        }
    }

    /// Places of the nodes of a group, as far apart as marks.
    fn places(&self, group: &str) -> Vec<[f64; 2]> {
        let nodes = self.mesh.node_group(group).unwrap_or_default();
        self.thinned(nodes.iter().map(|&a| (self.mesh.nodes()[a], [0.0; 2])))
            .into_iter()
            .map(|(x, _)| x)
            .collect()
    }

    /// Middles of the facets of a group with their outward unit normals, as far apart as marks.
    fn facets(&self, group: &str) -> Vec<([f64; 2], [f64; 2])> {
        let facets = self.mesh.facet_group(group).unwrap_or_default();
        let middle = |facet: &crate::mesh::Facet| {
            let nodes: Vec<usize> = self.mesh.facet_nodes(*facet).collect();
            let [a, b] = [nodes[0], nodes[1]].map(|a| Vector2::from(self.mesh.nodes()[a]));
            let along = (b - a).normalize();
            ((0.5 * (a + b)).into(), [along.y, -along.x])
        };
        self.thinned(facets.iter().map(middle))
    }

    fn thinned(
        &self,
        places: impl Iterator<Item = ([f64; 2], [f64; 2])>,
    ) -> Vec<([f64; 2], [f64; 2])> {
        let mut kept: Vec<([f64; 2], [f64; 2])> = Vec::new();
        for (x, n) in places {
            let near = |k: &([f64; 2], [f64; 2])| {
                (Vector2::from(k.0) - Vector2::from(x)).norm() < self.apart
            };
            if !kept.iter().any(near) {
                kept.push((x, n));
            }
        }
        kept
    }

    /// The facets of a contact.
    fn surface(&self, group: &str) -> Vec<Mark> {
        let facets = self.mesh.facet_group(group).unwrap_or_default().iter();
        let line = |facet: &crate::mesh::Facet| {
            let nodes: Vec<usize> = self.mesh.facet_nodes(*facet).collect();
            let order: &[usize] = if nodes.len() > 2 { &[0, 2, 1] } else { &[0, 1] };
            let points = order.iter().map(|&k| self.mesh.nodes()[nodes[k]]);
            Mark::Line {
                points: points.collect(),
                colour: CONTACT,
            }
        };
        facets.map(line).collect()
    }

    fn condition(&self, condition: &ConditionEntry, marks: &mut Vec<Mark>) {
        let on = condition.on.value.as_str();
        let units = self.deck.units;
        match &condition.action {
            Action::Fix(axes) => self.held(on, axes, marks),
            Action::Move(given) => {
                let still = given
                    .iter()
                    .filter(|(_, u)| *u == 0.0)
                    .map(|(axis, _)| *axis);
                self.held(on, &still.collect::<Vec<_>>(), marks);
                let u = components(given.iter().copied());
                let places: Vec<_> = self.places(on).into_iter().map(|x| (x, [0.0; 2])).collect();
                self.arrows(&places, u, units.length(), MOTION, marks);
            }
            Action::FixAlong(n) => self.held_along(on, n, marks),
            Action::MoveAlong(n, u) if *u == 0.0 => self.held_along(on, n, marks),
            Action::MoveAlong(n, u) => {
                let n = Vector2::from(components(n.iter().copied().enumerate())).normalize();
                let places: Vec<_> = self.places(on).into_iter().map(|x| (x, [0.0; 2])).collect();
                self.arrows(&places, (n * *u).into(), units.length(), MOTION, marks);
            }
            Action::Pressure(pressure) => {
                let facets = self.facets(on);
                for &(at, n) in &facets {
                    let along = n.map(|n| -n * pressure.signum());
                    marks.push(Mark::Arrow {
                        at,
                        along,
                        ends: *pressure > 0.0,
                        colour: LOAD,
                    });
                }
                let text = format!("pressure {} {}", shown(*pressure, DIGITS), units.stress());
                self.label(&facets, text, LOAD, marks);
            }
            Action::Traction(t) => {
                let t = components(t.iter().copied().enumerate());
                self.arrows(&self.facets(on), t, units.stress(), LOAD, marks);
            }
            Action::Force(f) | Action::BodyForce(f) => {
                let nodes = self.mesh.node_group(on).unwrap_or_default();
                let sum: Vector2<f64> = nodes
                    .iter()
                    .map(|&a| Vector2::from(self.mesh.nodes()[a]))
                    .sum();
                let middle = sum / nodes.len().max(1) as f64;
                let f = components(f.iter().copied().enumerate());
                let unit = match &condition.action {
                    Action::Force(_) => units.force().to_owned(),
                    _ => format!("{}/{}³", units.force(), units.length()),
                };
                self.arrows(&[(middle.into(), [0.0; 2])], f, &unit, LOAD, marks);
            }
            Action::Tool(way, turn) => {
                let mut said = Vec::new();
                if let Some(way) = way {
                    let u = components(way.iter().copied().enumerate());
                    said.push(format!("{} {}", place(u), units.length()));
                    self.tool(on, Some((u, MOTION)), marks);
                }
                if let Some(turn) = turn {
                    said.push(format!("turns by {}°", shown(turn.angle, DIGITS)));
                }
                self.named(on, &said.join(", "), marks);
            }
            Action::Moment(moment) => {
                let said = format!("moment {} {}", shown(moment.value, DIGITS), units.energy());
                self.named(on, &said, marks);
            }
            Action::Push(force, _) => {
                let f = components(force.iter().copied().enumerate());
                self.tool(on, Some((f, LOAD)), marks);
                self.named(on, &format!("{} {}", place(f), units.force()), marks);
            }
        }
    }

    /// Supports along axes.
    fn held(&self, group: &str, axes: &[usize], marks: &mut Vec<Mark>) {
        for at in self.places(group) {
            for &axis in axes.iter().filter(|axis| **axis < 2) {
                let out = (at[axis] - self.centre[axis]).signum();
                let mut from = [0.0; 2];
                from[axis] = out;
                marks.push(Mark::Support { at, from });
            }
        }
    }

    /// Supports along a direction, from the side that leads out of the body.
    fn held_along(&self, group: &str, direction: &[f64], marks: &mut Vec<Mark>) {
        let n = Vector2::from(components(direction.iter().copied().enumerate())).normalize();
        for at in self.places(group) {
            let out = n.dot(&(Vector2::from(at) - self.centre)).signum();
            let from = (n * out).into();
            marks.push(Mark::Support { at, from });
        }
    }

    /// Arrows along a vector, that end where they point into the body, and its components beside one of them.
    fn arrows(
        &self,
        places: &[([f64; 2], [f64; 2])],
        v: [f64; 2],
        unit: &str,
        colour: &'static str,
        marks: &mut Vec<Mark>,
    ) {
        let v_ = Vector2::from(v);
        let Some(along) = v_.try_normalize(0.0) else {
            return;
        };
        for &(at, n) in places {
            let out = match n == [0.0; 2] {
                true => Vector2::from(at) - self.centre,
                false => Vector2::from(n),
            };
            marks.push(Mark::Arrow {
                at,
                along: along.into(),
                ends: along.dot(&out) < 0.0,
                colour,
            });
        }
        self.label(places, format!("{} {unit}", place(v)), colour, marks);
    }

    /// A text outside of the place in the middle of some.
    fn label(
        &self,
        places: &[([f64; 2], [f64; 2])],
        text: String,
        colour: &'static str,
        marks: &mut Vec<Mark>,
    ) {
        if let Some(&(at, _)) = places.get(places.len() / 2) {
            let towards = self.inwards(at).map(|t| -t);
            marks.push(Mark::Label {
                at,
                towards,
                text,
                colour,
            });
        }
    }

    /// The place of a tool's surface that is nearest to the body.
    fn nearest(&self, name: &str) -> Option<Vector2<f64>> {
        let tool = self.deck.tools.iter().find(|t| t.name.value == name)?;
        let centre = Vector3::new(self.centre.x, self.centre.y, 0.0);
        let sheet = Sheet::new(tool, 2, centre, self.mesh.size());
        let ends = |piece: &Vec<usize>| [piece[0], piece[1]].map(|k| sheet.points[k].xy());
        let foot = |[a, b]: [Vector2<f64>; 2]| {
            let way = b - a;
            let part = way.dot(&(self.centre - a)) / way.norm_squared().max(f64::MIN_POSITIVE);
            a + way * part.clamp(0.0, 1.0)
        };
        let feet = sheet.pieces.iter().map(|piece| foot(ends(piece)));
        let far = |x: &Vector2<f64>| (x - self.centre).norm();
        feet.min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// An arrow on a tool.
    fn tool(&self, name: &str, arrow: Option<([f64; 2], &'static str)>, marks: &mut Vec<Mark>) {
        let along =
            arrow.and_then(|(v, colour)| Some((Vector2::from(v).try_normalize(0.0)?, colour)));
        if let (Some(at), Some((along, colour))) = (self.nearest(name), along) {
            let into = along.dot(&(self.centre - at)) > 0.0;
            marks.push(Mark::Arrow {
                at: at.into(),
                along: along.into(),
                ends: into,
                colour,
            });
        }
    }

    /// The name of a tool with what it does.
    fn named(&self, name: &str, what: &str, marks: &mut Vec<Mark>) {
        if let Some(at) = self.nearest(name) {
            let at: [f64; 2] = at.into();
            marks.push(Mark::Label {
                at,
                towards: self.inwards(at).map(|t| -t),
                text: format!("{name}: {what}"),
                colour: INK,
            });
        }
    }
}

fn components(given: impl Iterator<Item = (usize, f64)>) -> [f64; 2] {
    let mut v = [0.0; 2];
    for (axis, value) in given {
        if let Some(own) = v.get_mut(axis) {
            *own = value;
        }
    }
    v
}

fn place(v: [f64; 2]) -> String {
    format!("({}, {})", shown(v[0], DIGITS), shown(v[1], DIGITS)).replace('-', "−")
}
