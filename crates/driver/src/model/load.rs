//! Steps as an engineer writes them, and the loading they amount to; not how it is applied.

use crate::error::ModelError;
use crate::model::amplitude::Amplitude;
use crate::model::points::Turn;
use crate::model::temperature::{Field, Temperature};
use crate::vector::SparseVector;
use crate::vector::directions::Directions;
use crate::vector::subspace::Subspace;
use moreau_mesh::{Facet, Mesh};
use nalgebra::SVector;
use std::collections::{BTreeMap, BTreeSet};

/// A coordinate direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// First coordinate (the radius, if axisymmetric).
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
}

impl Axis {
    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Its unit vector.
    pub(crate) fn unit<const D: usize>(self) -> SVector<f64, D> {
        SVector::from_fn(|i, _| f64::from(u8::from(i == self.index())))
    }
}

/// Letter of a coordinate direction.
pub(crate) fn axis_letter(index: usize) -> char {
    ['x', 'y', 'z'][index.min(2)]
}

/// The unit vector of a direction of a group.
pub(crate) fn unit<const D: usize>(
    on: &str,
    direction: &[f64; D],
) -> Result<SVector<f64, D>, ModelError> {
    let direction = SVector::from(*direction);
    // By the largest component first, so that no length is out of the range of numbers.
    let largest = direction.amax();
    let unit = (direction / largest).try_normalize(0.0);
    let unit = unit.filter(|n| n.iter().all(|x| x.is_finite()));
    unit.ok_or_else(|| ModelError::OutOfRange {
        what: format!("direction of the displacement of {on:?}, its length"),
        value: direction.norm(),
        expected: "a positive number",
    })
}

/// One condition of a step. Values are totals at the end of the step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Condition<const D: usize> {
    Displace {
        on: String,
        axis: Axis,
        value: f64,
    },
    DisplaceAlong {
        on: String,
        direction: [f64; D],
        value: f64,
    },
    Force {
        on: String,
        force: [f64; D],
    },
    Pressure {
        on: String,
        pressure: f64,
    },
    Traction {
        on: String,
        traction: [f64; D],
    },
    BodyForce {
        on: String,
        density: [f64; D],
    },
    Temperature {
        on: String,
        change: Field<D>,
        share: f64,
    },
    Tool {
        name: String,
        displacement: [f64; D],
    },
    Turn {
        name: String,
        axis: [f64; 3],
        angle: f64,
    },
    Push {
        name: String,
        axis: Axis,
        force: f64,
    },
    Moment {
        name: String,
        axis: [f64; 3],
        moment: f64,
    },
}

impl<const D: usize> Condition<D> {
    /// What it is in words, and the first of its numbers that is not finite.
    fn not_finite(&self) -> Option<(String, f64)> {
        let (what, on, numbers): (_, _, &[f64]) = match self {
            Self::Displace { on, value, .. } | Self::DisplaceAlong { on, value, .. } => {
                ("displacement of", on, std::slice::from_ref(value))
            }
            Self::Force { on, force } => ("force on", on, force),
            Self::Pressure { on, pressure } => ("pressure on", on, std::slice::from_ref(pressure)),
            Self::Traction { on, traction } => ("traction on", on, traction),
            Self::BodyForce { on, density } => ("force per volume on", on, density),
            // Told where it is taken, by its cell.
            Self::Temperature { on, .. } => ("temperature of", on, &[]),
            Self::Tool { name, displacement } => ("motion of tool", name, displacement),
            Self::Turn { name, angle, .. } => ("turn of tool", name, std::slice::from_ref(angle)),
            Self::Push { name, force, .. } => ("force on tool", name, std::slice::from_ref(force)),
            Self::Moment { name, moment, .. } => {
                ("moment on tool", name, std::slice::from_ref(moment))
            }
        };
        let value = numbers.iter().find(|value| !value.is_finite())?;
        Some((format!("{what} {on:?}"), *value))
    }

    /// The condition with a share of its value.
    fn scaled(&self, share: f64) -> Self {
        let mut scaled = self.clone();
        match &mut scaled {
            Self::Displace { value, .. }
            | Self::DisplaceAlong { value, .. }
            | Self::Pressure {
                pressure: value, ..
            }
            | Self::Turn { angle: value, .. }
            | Self::Moment { moment: value, .. }
            | Self::Temperature { share: value, .. }
            | Self::Push { force: value, .. } => *value *= share,
            Self::Force { force: vector, .. }
            | Self::Traction {
                traction: vector, ..
            }
            | Self::BodyForce {
                density: vector, ..
            }
            | Self::Tool {
                displacement: vector,
                ..
            } => vector.iter_mut().for_each(|v| *v *= share),
        }
        scaled
    }
}

/// A step: all conditions that hold in it, with their totals at its end. They are ramped
/// linearly from what held at the end of the step before, or as [`Step::over`] says; what is not listed is
/// released, and its reaction ramped to zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<const D: usize> {
    pub(crate) name: String,
    pub(crate) conditions: Vec<Condition<D>>,
    /// Of conditions by their number.
    pub(crate) amplitudes: BTreeMap<usize, Amplitude>,
    /// How many conditions were to have an amplitude where there were not as many.
    missing: Option<usize>,
}

impl<const D: usize> Step<D> {
    /// A step without conditions.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.into(),
            conditions: Vec::new(),
            amplitudes: BTreeMap::new(),
            missing: None,
        }
    }

    /// Name of the step.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Holds components of the displacement of a group at zero.
    pub fn fix(self, on: &str, axes: &[Axis]) -> Self {
        axes.iter()
            .fold(self, |step, &axis| step.displace(on, axis, 0.0))
    }

    /// Prescribes one component of the displacement of a group \[mm\].
    pub fn displace(self, on: &str, axis: Axis, value: f64) -> Self {
        self.with(Condition::Displace {
            on: on.into(),
            axis,
            value,
        })
    }

    /// Holds the displacement of a group along a direction at zero, u·n = 0 with n the unit vector of a direction of
    /// any length; across it the group is free.
    pub fn fix_along(self, on: &str, direction: [f64; D]) -> Self {
        self.displace_along(on, direction, 0.0)
    }

    /// Prescribes the displacement of a group along a direction of any length, u·n with n its unit vector \[mm\].
    pub fn displace_along(self, on: &str, direction: [f64; D], value: f64) -> Self {
        self.with(Condition::DisplaceAlong {
            on: on.into(),
            direction,
            value,
        })
    }

    /// A force \[N\] on a group: of facets as a traction that is the same everywhere, of nodes alone shared equally by them.
    pub fn force(self, on: &str, force: [f64; D]) -> Self {
        self.with(Condition::Force {
            on: on.into(),
            force,
        })
    }

    /// A pressure \[MPa\] on a group of facets, positive towards the body.
    pub fn pressure(self, on: &str, pressure: f64) -> Self {
        self.with(Condition::Pressure {
            on: on.into(),
            pressure,
        })
    }

    /// A traction \[MPa\] on a group of facets, \[78\].
    pub fn traction(self, on: &str, traction: [f64; D]) -> Self {
        self.with(Condition::Traction {
            on: on.into(),
            traction,
        })
    }

    /// A force per volume \[N/mm³\] in a group of cells.
    pub fn body_force(self, on: &str, density: [f64; D]) -> Self {
        self.with(Condition::BodyForce {
            on: on.into(),
            density,
        })
    }

    /// Changes the temperature of a group of cells by so much since the body was free of stress \[K\], by position in
    /// the undeformed body; it counts where [`Model::expansion`](crate::Model::expansion) says how much a kelvin expands.
    /// Cells of which a step says nothing end it at the temperature at which they were free of stress.
    pub fn temperature(
        self,
        on: &str,
        change: impl Fn(&[f64; D]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.with(Condition::Temperature {
            on: on.into(),
            change: Field::new(change),
            share: 1.0,
        })
    }

    /// Moves a tool by a total translation from its first position \[mm\], once in a step; under axial symmetry along the
    /// axis alone.
    pub fn tool(self, name: &str, displacement: [f64; D]) -> Self {
        self.with(Condition::Tool {
            name: name.into(),
            displacement,
        })
    }

    /// Turns a tool about its reference point by a total angle \[rad\] since its first position:
    /// counter-clockwise in the plane, and about `axis` in space, which has any length. Once in a step.
    pub fn turn(self, name: &str, axis: [f64; 3], angle: f64) -> Self {
        self.with(Condition::Turn {
            name: name.into(),
            axis,
            angle,
        })
    }

    /// Drives a tool along an axis by a total force on it \[N\], which it hands on to what it touches;
    /// it moves along that axis as this asks, whatever [`Step::tool`] says of it. Along the others
    /// it stays where it is or moves as it is told.
    pub fn push(self, name: &str, axis: Axis, force: f64) -> Self {
        self.with(Condition::Push {
            name: name.into(),
            axis,
            force,
        })
    }

    /// Turns a tool about its reference point by a total moment on it \[N·mm\], which it hands on to what it touches:
    /// counter-clockwise in the plane, and in space about `axis`, which has any length and keeps its direction. It turns
    /// as this asks, whatever [`Step::turn`] says of it.
    pub fn moment(self, name: &str, axis: [f64; 3], moment: f64) -> Self {
        self.with(Condition::Moment {
            name: name.into(),
            axis,
            moment,
        })
    }

    /// Number of conditions, one for each axis, group and tool of which it says something.
    pub fn len(&self) -> usize {
        self.conditions.len()
    }

    /// Whether nothing holds in it.
    pub fn is_empty(&self) -> bool {
        self.conditions.is_empty()
    }

    /// Gives the values of the conditions added last, so many of them, an amplitude: rows of the time in the step,
    /// from 0 to 1, and the share of the value that acts then, linear in between. The totals at the end of the step
    /// are the last shares. An increment ends at every row.
    ///
    /// A step starts at what held before: the first row says how much of the value that was. A step in which there are
    /// fewer conditions is refused where it begins.
    pub fn over(mut self, last: usize, rows: &[[f64; 2]]) -> Self {
        let all = self.conditions.len();
        self.missing = self.missing.or((last > all).then_some(last));
        let amplitude = Amplitude::new(rows);
        let of = all.saturating_sub(last)..all;
        self.amplitudes.extend(of.map(|k| (k, amplitude.clone())));
        self
    }

    /// Times strictly within the step at which an amplitude has a row, in order.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let times = self.amplitudes.values().flat_map(Amplitude::breaks);
        let mut times: Vec<f64> = times.collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The step with each condition times what `part` makes of its amplitude, or once without one.
    fn shared(&self, part: impl Fn(&Amplitude) -> f64) -> Self {
        let scaled = |(k, condition): (usize, &Condition<D>)| match self.amplitudes.get(&k) {
            Some(amplitude) => condition.scaled(part(amplitude)),
            None => condition.clone(),
        };
        Self {
            name: self.name.clone(),
            conditions: self.conditions.iter().enumerate().map(scaled).collect(),
            amplitudes: BTreeMap::new(),
            missing: self.missing,
        }
    }

    /// The step without amplitudes: the totals at its end.
    pub(crate) fn totals(&self) -> Self {
        self.shared(|amplitude| amplitude.at(1.0))
    }

    /// The step of what the amplitudes add at a time to the straight way between its ends, as the difference of both.
    pub(crate) fn bent(&self, time: f64) -> [Self; 2] {
        [
            self.shared(|amplitude| amplitude.bend(time)),
            self.shared(|_| 0.0),
        ]
    }

    /// Whether all values are numbers and all amplitudes such, of conditions that there are, and no tool is told twice where
    /// to go.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        if let Some(last) = self.missing {
            return Err(ModelError::OutOfRange {
                what: format!(
                    "conditions in step {:?} with an amplitude, their number",
                    self.name
                ),
                value: last as f64,
                expected: "at most those before it",
            });
        }
        if let Some((what, value)) = self.conditions.iter().find_map(Condition::not_finite) {
            return Err(ModelError::OutOfRange {
                what: format!("{what} in step {:?}", self.name),
                value,
                expected: "a finite number",
            });
        }
        let mut told = BTreeSet::new();
        for condition in &self.conditions {
            let (tool, what) = match condition {
                Condition::Tool { name, .. } => (name, "moves"),
                Condition::Turn { name, .. } => (name, "turns"),
                _ => continue,
            };
            if !told.insert((tool, what)) {
                return Err(ModelError::TwoMotions {
                    step: self.name.clone(),
                    tool: tool.clone(),
                    what,
                });
            }
        }
        let mut all = self.amplitudes.values();
        all.try_for_each(|amplitude| amplitude.check(&self.name))
    }

    fn with(mut self, condition: Condition<D>) -> Self {
        self.conditions.push(condition);
        self
    }
}

/// Most sides of a cell.
const SIDES: usize = 6;

/// The facet of an entry of [`Loading::pressure`].
pub(crate) fn facet_of(entry: usize) -> Facet {
    Facet {
        cell: entry / SIDES,
        facet: entry % SIDES,
    }
}

/// All that acts on the model at an instant: totals, not increments. A tool is a body of two nodes after those of the
/// mesh: one for its translation, and after these one whose first component is how far a moment has turned it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loading<const D: usize> {
    /// Prescribed displacements by degree of freedom, `D·node + axis`, along its direction \[mm\].
    pub displacement: BTreeMap<usize, f64>,
    /// The directions of these, where they are not the axes.
    pub directions: Directions,
    /// Applied forces \[N\].
    pub force: SparseVector,
    /// Pressures that follow their surface \[MPa\]: on side s of cell c the entry 6c + s. Those of a step are here under large
    /// strains, and under small ones among the forces, on the undeformed surface.
    pub pressure: SparseVector,
    /// How much warmer the cells are than when they were free of stress \[K\].
    pub temperature: Temperature,
    /// How far tools have turned \[rad\]: of tool k the components 3k, 3k + 1 and 3k + 2 of a vector along
    /// the axis, as long as the angle. Nothing of a tool that a moment turns.
    pub turn: SparseVector,
    /// Axes of the moments that turn tools: of tool k the components 3k, 3k + 1 and 3k + 2 of a unit vector. The moment
    /// itself is a force, see [`Driver::tool_turn`](crate::Driver::tool_turn).
    pub axle: SparseVector,
}

impl<const D: usize> Loading<D> {
    /// The loading at the part s of the way from `self` to `end`, both with the same prescribed
    /// degrees of freedom. At s = 1 it is `end` exactly.
    pub fn towards(&self, end: &Self, s: f64) -> Self {
        if s >= 1.0 {
            return end.clone();
        }
        let mix = |a: f64, b: f64| a + s * (b - a);
        Self {
            displacement: end
                .displacement
                .iter()
                .map(|(dof, &b)| {
                    (
                        *dof,
                        mix(self.displacement.get(dof).copied().unwrap_or(b), b),
                    )
                })
                .collect(),
            directions: end.directions.clone(),
            force: self.force.with(&end.force, mix),
            pressure: self.pressure.with(&end.pressure, mix),
            temperature: self.temperature.with(&end.temperature, mix),
            turn: self.turn.with(&end.turn, mix),
            axle: end.axle.clone(),
        }
    }

    /// Whether a prescribed component of displacements `u` is off by no more than what the product with its direction
    /// rounds.
    pub(crate) fn is_rounding(&self, dof: usize, off: f64, u: &[f64]) -> bool {
        let size = || self.directions.entries(dof).map(|(j, _)| u[j].abs());
        self.directions.is_turned(dof) && off.abs() <= 4.0 * f64::EPSILON * size().sum::<f64>()
    }

    /// Directions in which a node is held.
    pub(crate) fn held_at(&self, node: usize) -> Subspace<D> {
        let is_held = |dof: usize| self.displacement.contains_key(&dof);
        Subspace::of_node(node, &self.directions, is_held)
    }

    /// Directions in which a node is free.
    pub(crate) fn free_at(&self, node: usize) -> Subspace<D> {
        self.held_at(node).complement()
    }

    /// Adds a multiple of a vector to the force on a node.
    pub(crate) fn push(&mut self, node: usize, share: f64, vector: &[f64; D]) {
        for i in 0..D {
            self.force.add(D * node + i, share * vector[i]);
        }
    }

    /// Adds a pressure on a facet \[MPa\].
    pub(crate) fn press(&mut self, facet: Facet, pressure: f64) {
        self.pressure
            .add(SIDES * facet.cell + facet.facet, pressure);
    }

    /// How far a tool has turned.
    pub(crate) fn turn_of(&self, tool: usize) -> Turn {
        Turn::from_fn(|i, _| self.turn.at(3 * tool + i))
    }

    /// The axis of the moment that turns a tool; `None` of one that turns as told.
    pub(crate) fn axle_of(&self, tool: usize) -> Option<Turn> {
        let axle = Turn::from_fn(|i, _| self.axle.at(3 * tool + i));
        (axle.norm() > 0.0).then_some(axle)
    }

    /// Takes out how far the tools have turned that moments turn.
    pub(crate) fn release_turns(&mut self) {
        let turn = std::mem::take(&mut self.turn);
        let told = turn
            .into_iter()
            .filter(|(k, _)| self.axle_of(k / 3).is_none());
        self.turn = told.collect();
    }

    /// The first number that is not finite, or that is of none of so many degrees of freedom or of no facet of
    /// the mesh; nodes beyond those of the mesh are tools.
    pub(crate) fn check(&self, mesh: &Mesh<D>, dofs: usize) -> Result<(), ModelError> {
        let tools = mesh.nodes().len();
        let place = |node: usize| match node.checked_sub(tools) {
            Some(tool) => format!("tool {tool}"),
            None => format!("node {node}"),
        };
        let error = |what: String, value: f64| ModelError::OutOfRange {
            what,
            value,
            expected: "a finite number",
        };
        let last = self.displacement.last_key_value().map(|(&dof, _)| dof);
        if let Some(dof) = last.max(self.force.last()).filter(|&dof| dof >= dofs) {
            return Err(ModelError::OutOfRange {
                what: "degree of freedom of a load".into(),
                value: dof as f64,
                expected: "one of the model",
            });
        }
        if !self.directions.are_sound::<D>(D * tools) {
            return Err(ModelError::OutOfRange {
                what: "directions of prescribed displacements".into(),
                value: f64::NAN,
                expected: "orthonormal ones, as many as a node of the mesh has displacements",
            });
        }
        for (&dof, &u) in &self.displacement {
            if !u.is_finite() {
                let (node, axis) = (dof / D, axis_letter(dof % D));
                return Err(error(format!("prescribed u_{axis} of {}", place(node)), u));
            }
        }
        for (dof, f) in self.force.iter() {
            if !f.is_finite() {
                let (node, axis) = (dof / D, axis_letter(dof % D));
                return Err(error(format!("force f_{axis} on {}", place(node)), f));
            }
        }
        for (k, pressure) in self.pressure.iter() {
            if !mesh.has_facet(facet_of(k)) {
                return Err(ModelError::OutOfRange {
                    what: "facet of a pressure".into(),
                    value: k as f64,
                    expected: "one of the mesh",
                });
            }
            if !pressure.is_finite() {
                return Err(error(format!("pressure on cell {}", k / SIDES), pressure));
            }
        }
        for (k, angle) in self.turn.iter().chain(self.axle.iter()) {
            if !angle.is_finite() {
                return Err(error(format!("turn of tool {}", k / 3), angle));
            }
        }
        Ok(())
    }

    /// Whether the same displacements are prescribed, along the same directions.
    pub(crate) fn moves_the_same_as(&self, other: &Self) -> bool {
        self.displacement.keys().eq(other.displacement.keys())
            && self.directions == other.directions
    }

    /// Part of `previous` that this increment repeats: (this, previous) / (previous, previous),
    /// taken over the prescribed motions, over the forces if nothing is moved, or over the temperatures if nothing is
    /// loaded.
    pub(crate) fn ratio(&self, previous: &Self) -> f64 {
        let motions = |l: &Self| -> Vec<f64> { l.displacement.values().copied().collect() };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (new, old) = (motions(self), motions(previous));
        let moved = dot(&old, &old) + previous.turn.inner(&previous.turn);
        if moved > 0.0 {
            return (dot(&new, &old) + self.turn.inner(&previous.turn)) / moved;
        }
        for (new, old) in [
            (&self.force, &previous.force),
            (&self.pressure, &previous.pressure),
        ] {
            let loaded = old.inner(old);
            if loaded > 0.0 {
                return new.inner(old) / loaded;
            }
        }
        let heated = previous.temperature.inner(&previous.temperature);
        if heated > 0.0 {
            return self.temperature.inner(&previous.temperature) / heated;
        }
        0.0
    }

    /// `self + (end − start)`, for loadings with the same prescribed degrees of freedom.
    pub(crate) fn and(&self, end: &Self, start: &Self) -> Self {
        let more = end.increment_from(start);
        let sum = |a: f64, b: f64| a + b;
        let of = |dof: &usize| more.displacement.get(dof).copied().unwrap_or(0.0);
        let own = self.displacement.iter();
        Self {
            displacement: own.map(|(dof, &u)| (*dof, u + of(dof))).collect(),
            directions: self.directions.clone(),
            force: self.force.with(&more.force, sum),
            pressure: self.pressure.with(&more.pressure, sum),
            temperature: self.temperature.with(&more.temperature, sum),
            turn: self.turn.with(&more.turn, sum),
            axle: self.axle.clone(),
        }
    }

    /// `self − start`, for loadings with the same prescribed degrees of freedom.
    pub(crate) fn increment_from(&self, start: &Self) -> Self {
        Self {
            displacement: self
                .displacement
                .iter()
                .map(|(d, &u)| (*d, u - start.displacement.get(d).copied().unwrap_or(u)))
                .collect(),
            directions: self.directions.clone(),
            force: self.force.with(&start.force, |b, a| b - a),
            pressure: self.pressure.with(&start.pressure, |b, a| b - a),
            temperature: self.temperature.with(&start.temperature, |b, a| b - a),
            turn: self.turn.with(&start.turn, |b, a| b - a),
            axle: self.axle.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second would take the place of the first, or add to it, where both are totals.
    #[test]
    fn a_tool_is_told_once_where_to_go() {
        let step = || Step::<2>::new("press");
        let axis = [0.0, 0.0, 1.0];
        let moved = || step().tool("punch", [0.0, -0.1]).tool("die", [0.0, 0.1]);
        let whole = moved().turn("punch", axis, 0.1).turn("die", axis, 0.1);
        assert_eq!(whole.check(), Ok(()));
        let twice = [
            (moved().tool("punch", [0.1, 0.0]), "moves"),
            (whole.turn("punch", axis, 0.2), "turns"),
        ];
        for (step, expected) in twice {
            match step.check() {
                Err(ModelError::TwoMotions { tool, what, .. }) => {
                    assert_eq!((tool.as_str(), what), ("punch", expected));
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn amplitudes_are_those_of_conditions_that_there_are() {
        let rows = [[0.0, 0.0], [1.0, 1.0]];
        let step = || Step::<2>::new("press").fix("left", &[Axis::X, Axis::Y]);
        assert_eq!(step().over(2, &rows).check(), Ok(()));
        for refused in [
            step().over(3, &rows),
            step().over(3, &rows).fix("top", &[Axis::X]),
        ] {
            match refused.check() {
                Err(ModelError::OutOfRange { value, .. }) => assert_eq!(value, 3.0),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn directions_have_any_length_but_none() {
        let n = unit("side", &[3e200, 4e200]).expect("a direction");
        assert!((n - SVector::<f64, 2>::new(0.6, 0.8)).norm() < 1e-15);
        assert_eq!(
            unit("side", &[0.0, -1e-300]),
            Ok(SVector::<f64, 2>::new(0.0, -1.0))
        );
        for direction in [[0.0, 0.0], [f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
            let error = unit("side", &direction);
            assert!(
                matches!(error, Err(ModelError::OutOfRange { .. })),
                "{error:?}"
            );
        }
    }
}
