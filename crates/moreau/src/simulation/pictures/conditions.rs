//! What a step of a deck does to its bodies, as marks on a picture before anything is computed: supports, motions,
//! loads, contacts with their gaps; not the tools' outlines.

use crate::deck::{Action, ConditionEntry, Deck, FieldEntry, Setup, StepEntry};
use crate::grids::Sheet;
use crate::mesh::Mesh;
use crate::numbers::shown;
use crate::plot::Mark;
use crate::vtu::three;
use nalgebra::{SVector, Vector3};
use std::collections::BTreeMap;

/// Marks along the longest side of the body, at most.
const MOST: f64 = 24.0;
/// The same in space, where they stand on faces.
const MOST_IN_SPACE: f64 = 10.0;
/// Significant digits.
const DIGITS: usize = 4;
const MOTION: &str = "#1f5fbf";
const LOAD: &str = "#c02626";
const CONTACT: &str = "#e07b00";
const INK: &str = "#333333";

/// The marks of a step.
pub(super) fn marks<const D: usize>(
    deck: &Deck,
    setup: &Setup<D>,
    step: &StepEntry,
) -> Vec<Mark<D>> {
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
struct Scene<'a, const D: usize> {
    deck: &'a Deck,
    mesh: &'a Mesh<D>,
    centre: SVector<f64, D>,
    /// Half of its width and of its height \[mm\].
    half: SVector<f64, D>,
    /// Least distance of marks \[mm\].
    apart: f64,
}

impl<'a, const D: usize> Scene<'a, D> {
    fn new(deck: &'a Deck, mesh: &'a Mesh<D>) -> Self {
        let (low, high) = mesh.bounds();
        let (low, high) = (SVector::from(low), SVector::from(high));
        Self {
            deck,
            mesh,
            centre: 0.5 * (low + high),
            half: 0.5 * (high - low),
            apart: (high - low).amax() / if D == 2 { MOST } else { MOST_IN_SPACE },
        }
    }

    /// The axis direction that leads from a place towards the middle of the body.
    fn inwards(&self, at: [f64; D]) -> [f64; D] {
        let way = self.centre - SVector::from(at);
        // By the side that it is nearest to.
        let part = way.abs().component_div(&self.half);
        // Above or below, if all sides are as near.
        let first = match part[1] >= part[0] {
            true => 1,
            false => 0,
        };
        let axis = (2..D).fold(first, |k, i| if part[i] > part[k] { i } else { k });
        std::array::from_fn(|i| if i == axis { way[i].signum() } else { 0.0 })
    }

    /// Places of the nodes of a group, as far apart as marks.
    fn places(&self, group: &str) -> Vec<[f64; D]> {
        let nodes = self.mesh.node_group(group).unwrap_or_default();
        self.thinned(nodes.iter().map(|&a| (self.mesh.nodes()[a], [0.0; D])))
            .into_iter()
            .map(|(x, _)| x)
            .collect()
    }

    /// Middles of the facets of a group with their outward unit normals, as far apart as marks.
    fn facets(&self, group: &str) -> Vec<([f64; D], [f64; D])> {
        let facets = self.mesh.facet_group(group).unwrap_or_default();
        let middle = |facet: &crate::mesh::Facet| {
            let corners = self.mesh.facet_kind(*facet).corner_count();
            let nodes: Vec<usize> = self.mesh.facet_nodes(*facet).take(corners).collect();
            let x = |k: usize| SVector::from(self.mesh.nodes()[nodes[k]]);
            let middle: SVector<f64, D> =
                (0..corners).map(x).sum::<SVector<f64, D>>() / corners as f64;
            (
                middle.into(),
                outward(&(0..corners).map(x).collect::<Vec<_>>()).into(),
            )
        };
        self.thinned(facets.iter().map(middle))
    }

    fn thinned(
        &self,
        places: impl Iterator<Item = ([f64; D], [f64; D])>,
    ) -> Vec<([f64; D], [f64; D])> {
        let mut kept: Vec<([f64; D], [f64; D])> = Vec::new();
        for (x, n) in places {
            let near = |k: &([f64; D], [f64; D])| {
                (SVector::from(k.0) - SVector::from(x)).norm() < self.apart
            };
            if !kept.iter().any(near) {
                kept.push((x, n));
            }
        }
        kept
    }

    /// The facets of a contact.
    fn surface(&self, group: &str) -> Vec<Mark<D>> {
        let facets = self.mesh.facet_group(group).unwrap_or_default();
        let mut sides: BTreeMap<[usize; 2], (Vec<usize>, usize)> = BTreeMap::new();
        for facet in facets {
            let nodes: Vec<usize> = self.mesh.facet_nodes(*facet).collect();
            let corners = self.mesh.facet_kind(*facet).corner_count();
            // In the plane the facet itself, in space the edges around it.
            let edges = if D == 2 { 1 } else { corners };
            for k in 0..edges {
                let [a, b] = [nodes[k], nodes[(k + 1) % corners]];
                let line: Vec<usize> = [Some(&a), nodes.get(corners + k), Some(&b)]
                    .into_iter()
                    .flatten()
                    .copied()
                    .collect();
                sides.entry([a.min(b), a.max(b)]).or_insert((line, 0)).1 += 1;
            }
        }
        // Of a surface in space its border.
        let border = sides.into_values().filter(|side| side.1 == 1);
        let line = |(nodes, _): (Vec<usize>, usize)| Mark::Line {
            points: nodes.iter().map(|&a| self.mesh.nodes()[a]).collect(),
            colour: CONTACT,
        };
        border.map(line).collect()
    }

    fn condition(&self, condition: &ConditionEntry, marks: &mut Vec<Mark<D>>) {
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
                let u = components::<D>(given.iter().copied());
                let places: Vec<_> = self.places(on).into_iter().map(|x| (x, [0.0; D])).collect();
                self.arrows(&places, u, units.length(), MOTION, marks);
            }
            Action::FixAlong(n) => self.held_along(on, n, marks),
            Action::MoveAlong(n, u) if *u == 0.0 => self.held_along(on, n, marks),
            Action::MoveAlong(n, u) => {
                let n = unit::<D>(n);
                let places: Vec<_> = self.places(on).into_iter().map(|x| (x, [0.0; D])).collect();
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
                let t = components::<D>(t.iter().copied().enumerate());
                self.arrows(&self.facets(on), t, units.stress(), LOAD, marks);
            }
            Action::Force(f) | Action::BodyForce(f) => {
                let nodes = self.mesh.node_group(on).unwrap_or_default();
                let sum: SVector<f64, D> = nodes
                    .iter()
                    .map(|&a| SVector::from(self.mesh.nodes()[a]))
                    .sum();
                let middle = sum / nodes.len().max(1) as f64;
                let f = components::<D>(f.iter().copied().enumerate());
                let unit = match &condition.action {
                    Action::Force(_) => units.force().to_owned(),
                    _ => format!("{}/{}³", units.force(), units.length()),
                };
                self.arrows(&[(middle.into(), [0.0; D])], f, &unit, LOAD, marks);
            }
            Action::Temperature(change) => {
                let said = match change {
                    FieldEntry::Constant(t) => format!("warmer by {} K", shown(*t, DIGITS)),
                    FieldEntry::Formula(text) => format!("warmer by {} K", text.trim()),
                };
                let nodes = self.mesh.node_group(on).unwrap_or_default();
                let sum: SVector<f64, D> = nodes
                    .iter()
                    .map(|&a| SVector::from(self.mesh.nodes()[a]))
                    .sum();
                let middle = sum / nodes.len().max(1) as f64;
                self.label(&[(middle.into(), [0.0; D])], said, LOAD, marks);
            }
            Action::Tool(way, turn) => {
                let mut said = Vec::new();
                if let Some(way) = way {
                    let u = components::<D>(way.iter().copied().enumerate());
                    said.push(format!("{} {}", place(u), units.length()));
                    self.tool(on, Some((u, MOTION)), marks);
                }
                if let Some(turn) = turn {
                    let about = match D {
                        2 => String::new(),
                        _ => format!(" about {:?}", turn.axis),
                    };
                    said.push(format!("turns by {}°{about}", shown(turn.angle, DIGITS)));
                }
                self.named(on, &said.join(", "), marks);
            }
            Action::Moment(moment) => {
                let said = format!("moment {} {}", shown(moment.value, DIGITS), units.energy());
                self.named(on, &said, marks);
            }
            Action::Push(force, _) => {
                let f = components::<D>(force.iter().copied().enumerate());
                self.tool(on, Some((f, LOAD)), marks);
                self.named(on, &format!("{} {}", place(f), units.force()), marks);
            }
        }
    }

    /// Supports along axes.
    fn held(&self, group: &str, axes: &[usize], marks: &mut Vec<Mark<D>>) {
        for at in self.places(group) {
            for &axis in axes.iter().filter(|axis| **axis < D) {
                let out = (at[axis] - self.centre[axis]).signum();
                let mut from = [0.0; D];
                from[axis] = out;
                marks.push(Mark::Support { at, from });
            }
        }
    }

    /// Supports along a direction, from the side that leads out of the body.
    fn held_along(&self, group: &str, direction: &[f64], marks: &mut Vec<Mark<D>>) {
        let n = unit::<D>(direction);
        for at in self.places(group) {
            let out = n.dot(&(SVector::from(at) - self.centre)).signum();
            let from = (n * out).into();
            marks.push(Mark::Support { at, from });
        }
    }

    /// Arrows along a vector, that end where they point into the body, and its components beside one of them.
    fn arrows(
        &self,
        places: &[([f64; D], [f64; D])],
        v: [f64; D],
        unit: &str,
        colour: &'static str,
        marks: &mut Vec<Mark<D>>,
    ) {
        let v_ = SVector::from(v);
        let Some(along) = v_.try_normalize(0.0) else {
            return;
        };
        for &(at, n) in places {
            let out = match n == [0.0; D] {
                true => SVector::from(at) - self.centre,
                false => SVector::from(n),
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
        places: &[([f64; D], [f64; D])],
        text: String,
        colour: &'static str,
        marks: &mut Vec<Mark<D>>,
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
    fn nearest(&self, name: &str) -> Option<SVector<f64, D>> {
        let tool = self.deck.tools.iter().find(|t| t.name.value == name)?;
        let centre = Vector3::from(three(self.centre.as_slice()));
        let sheet = Sheet::new(tool, D, centre, self.mesh.size());
        let own = |k: usize| SVector::<f64, D>::from_fn(|i, _| sheet.points[k][i]);
        let foot = |piece: &Vec<usize>| {
            if D > 2 {
                let sum: SVector<f64, D> = piece.iter().map(|&k| own(k)).sum();
                return sum / piece.len() as f64;
            }
            let [a, b] = [own(piece[0]), own(piece[1])];
            let way = b - a;
            let part = way.dot(&(self.centre - a)) / way.norm_squared().max(f64::MIN_POSITIVE);
            a + way * part.clamp(0.0, 1.0)
        };
        let feet = sheet.pieces.iter().map(foot);
        let far = |x: &SVector<f64, D>| (x - self.centre).norm();
        feet.min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// An arrow on a tool.
    fn tool(&self, name: &str, arrow: Option<([f64; D], &'static str)>, marks: &mut Vec<Mark<D>>) {
        let along =
            arrow.and_then(|(v, colour)| Some((SVector::from(v).try_normalize(0.0)?, colour)));
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
    fn named(&self, name: &str, what: &str, marks: &mut Vec<Mark<D>>) {
        if let Some(at) = self.nearest(name) {
            let at: [f64; D] = at.into();
            marks.push(Mark::Label {
                at,
                towards: self.inwards(at).map(|t| -t),
                text: format!("{name}: {what}"),
                colour: INK,
            });
        }
    }
}

/// The direction of a support as a unit vector.
fn unit<const D: usize>(direction: &[f64]) -> SVector<f64, D> {
    SVector::from(components::<D>(direction.iter().copied().enumerate())).normalize()
}

fn components<const D: usize>(given: impl Iterator<Item = (usize, f64)>) -> [f64; D] {
    let mut v = [0.0; D];
    for (axis, value) in given {
        if let Some(own) = v.get_mut(axis) {
            *own = value;
        }
    }
    v
}

fn place<const D: usize>(v: [f64; D]) -> String {
    let v = v.map(|v| shown(v, DIGITS));
    format!("({})", v.join(", ")).replace('-', "−")
}

/// The outward unit normal of a facet by its corners.
fn outward<const D: usize>(corners: &[SVector<f64, D>]) -> SVector<f64, D> {
    let side =
        |a: usize, b: usize| -> Vector3<f64> { three((corners[b] - corners[a]).as_slice()).into() };
    let normal = match corners.len() {
        2 => side(0, 1).cross(&Vector3::z()),
        3 => side(0, 1).cross(&side(0, 2)),
        _ => side(0, 2).cross(&side(1, 3)),
    };
    let normal = normal.try_normalize(0.0).unwrap_or_default();
    SVector::from_fn(|i, _| normal[i])
}
