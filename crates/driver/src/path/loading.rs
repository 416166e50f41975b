//! What a step asks of a model, degree of freedom by degree of freedom; not the conditions of a step
//! themselves.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::load::{Axis, Condition, Loading, Step, axis_letter};
use crate::model::points::{Turn, tool_index};
use crate::vector::SparseVector;
use std::collections::{BTreeMap, BTreeSet};

/// Sine of the angle between two axes that is rounding.
const TILTED: f64 = 1e-9;

/// Turn that is rounding, of a tool that has been turned back \[rad\].
const TURNED_BACK: f64 = 1e-12;

impl<const D: usize> Driver<D> {
    /// The loading at the end of a step.
    ///
    /// # Errors
    /// Unknown groups and tools, displacements prescribed twice, numbers that are not finite.
    pub fn loading(&self, step: &Step<D>) -> Result<Loading<D>, ModelError> {
        step.check()?;
        let step = &step.totals();
        let mesh = &self.mesh;
        let mut loading = Loading::default();
        let mut moved: BTreeMap<usize, f64> = BTreeMap::new();
        for condition in &step.conditions {
            match condition {
                Condition::Displace { on, axis, value } => {
                    self.displace(&step.name, (on, *axis, *value), &mut moved)?;
                }
                Condition::DisplaceAlong { .. } => {}
                Condition::Force { on, force } => {
                    let facets = mesh.facet_group(on).unwrap_or_default();
                    let shares = self.measure.facet_shares(mesh, facets);
                    let area: f64 = shares.iter().map(|s| s.area).sum();
                    // Facets on the axis have none.
                    if area > 0.0 {
                        for s in shares {
                            loading.push(s.node, s.area / area, force);
                        }
                        continue;
                    }
                    if force[0] != 0.0 {
                        self.check_area(step, on)?;
                    }
                    let nodes = mesh.node_group(on)?;
                    for &node in &nodes {
                        loading.push(node, 1.0 / nodes.len() as f64, force);
                    }
                }
                Condition::Pressure { on, pressure } => {
                    let facets = mesh.facet_group(on)?;
                    self.check_area(step, on)?;
                    if self.has_large_strains() {
                        facets.iter().for_each(|&f| loading.press(f, *pressure));
                        continue;
                    }
                    for s in self.measure.facet_shares(mesh, facets) {
                        loading.push(s.node, -pressure, &s.normal);
                    }
                }
                Condition::Traction { on, traction } => {
                    self.check_area(step, on)?;
                    for s in self.measure.facet_shares(mesh, mesh.facet_group(on)?) {
                        loading.push(s.node, s.area, traction);
                    }
                }
                Condition::BodyForce { on, density } => {
                    for (node, share) in self.measure.volume_shares(mesh, mesh.cell_group(on)?) {
                        loading.push(node, share, density);
                    }
                }
                Condition::Temperature { .. }
                | Condition::Tool { .. }
                | Condition::Turn { .. }
                | Condition::Push { .. }
                | Condition::Moment { .. } => {}
            }
        }
        self.hold_axis(step, &mut moved)?;
        loading.directions = self.displace_along(step, &mut moved)?;
        self.move_tools(step, &mut moved)?;
        loading.turn = self.turns(step)?;
        for condition in &step.conditions {
            if let Condition::Push { name, axis, force } = condition {
                let dof = self.pushed(name, *axis, *force)?;
                moved.remove(&dof);
                loading.force.add(dof, *force);
            }
        }
        self.drive_turns(step, &mut moved, &mut loading)?;
        loading.displacement = moved;
        loading.temperature = self.temperature(step)?;
        self.check_loading(&loading)?;
        Ok(loading)
    }

    /// Prescribes a displacement of a group along an axis.
    fn displace(
        &self,
        step: &str,
        (on, axis, value): (&str, Axis, f64),
        moved: &mut BTreeMap<usize, f64>,
    ) -> Result<(), ModelError> {
        if axis.index() >= D {
            return Err(ModelError::OutOfRange {
                what: format!("direction of the displacement of {on:?}"),
                value: axis.index() as f64,
                expected: "a direction below the dimension of the model",
            });
        }
        for node in self.mesh.node_group(on)? {
            let dof = D * node + axis.index();
            if let Some(&first) = moved.get(&dof)
                && first != value
            {
                return Err(ModelError::TwoDisplacements {
                    step: step.to_owned(),
                    node,
                    axis: axis_letter(axis.index()),
                    first,
                    second: value,
                });
            }
            moved.insert(dof, value);
        }
        Ok(())
    }

    /// Prescribes where tools go; one that is not mentioned stays where it is.
    fn move_tools(
        &self,
        step: &Step<D>,
        moved: &mut BTreeMap<usize, f64>,
    ) -> Result<(), ModelError> {
        let tools = self.mesh_dofs()..self.state.displacement.len();
        moved.extend(tools.map(|dof| (dof, self.state.displacement[dof])));
        for condition in &step.conditions {
            if let Condition::Tool { name, displacement } = condition {
                let node = self.tool_node(tool_index(&self.tools, name)?);
                for (i, &u) in displacement.iter().enumerate() {
                    if u != 0.0 {
                        self.check_way(("motion", name), i, u)?;
                    }
                    moved.insert(D * node + i, u);
                }
            }
        }
        Ok(())
    }

    /// How far tools have turned in the end; one that is not mentioned turns no further.
    fn turns(&self, step: &Step<D>) -> Result<SparseVector, ModelError> {
        let before = &self.state.loading;
        let mut turns = before.turn.clone();
        for condition in &step.conditions {
            if let Condition::Turn { name, axis, angle } = condition {
                let tool = tool_index(&self.tools, name)?;
                let told = ("turn in degrees of", angle.to_degrees());
                let by = self.axle(name, axis, told)? * *angle - before.turn_of(tool);
                (0..3).for_each(|i| turns.add(3 * tool + i, by[i]));
            }
        }
        Ok(turns)
    }

    /// Lets moments turn tools: about axes of which the largest component is positive, so that a moment that changes its
    /// sign keeps its axis.
    fn drive_turns(
        &self,
        step: &Step<D>,
        moved: &mut BTreeMap<usize, f64>,
        loading: &mut Loading<D>,
    ) -> Result<(), ModelError> {
        for condition in &step.conditions {
            let Condition::Moment { name, axis, moment } = condition else {
                continue;
            };
            let tool = tool_index(&self.tools, name)?;
            let axle = self.axle(name, axis, ("moment on", *moment))?;
            let axle = axle * axle[axle.iamax()].signum();
            let turned = self.state.loading.turn_of(tool);
            if axle.cross(&turned).norm() > (TILTED * turned.norm()).max(TURNED_BACK) {
                return Err(ModelError::TiltedAxle {
                    tool: name.clone(),
                    axis: axis.to_vec(),
                    turned: turned.iter().copied().collect(),
                });
            }
            let sign = axle.dot(&Turn::from(*axis)).signum();
            let dof = self.turn_dof(tool);
            if loading.axle_of(tool).is_none() {
                (0..3).for_each(|i| loading.axle.add(3 * tool + i, axle[i]));
            }
            moved.remove(&dof);
            loading.force.add(dof, sign * moment / self.mesh.size());
        }
        loading.release_turns();
        Ok(())
    }

    /// The degree of freedom along which a force drives a tool.
    fn pushed(&self, name: &str, axis: Axis, force: f64) -> Result<usize, ModelError> {
        let node = self.tool_node(tool_index(&self.tools, name)?);
        self.check_way(("force", name), axis.index(), force)?;
        Ok(D * node + axis.index())
    }

    /// Whether the analysis lets a tool move along an axis.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] of the motion or force that is told, which makes a tool of revolution grow.
    fn check_way(
        &self,
        (what, tool): (&str, &str),
        axis: usize,
        value: f64,
    ) -> Result<(), ModelError> {
        let translations = self.measure.rigid_modes(&[0.0; D]);
        if translations.iter().any(|m| m.get(axis) == Some(&1.0)) {
            return Ok(());
        }
        Err(ModelError::OutOfRange {
            what: format!("{what} along {} of tool {tool:?}", axis_letter(axis)),
            value,
            expected: "none: the analysis lets no tool move along it, as one of revolution would grow",
        })
    }

    /// The unit vector along an axis of any length, about which a tool is to turn as is told.
    fn axle(
        &self,
        name: &str,
        axis: &[f64; 3],
        (what, value): (&str, f64),
    ) -> Result<Turn, ModelError> {
        let axis = Turn::from(*axis);
        let unit = axis
            .try_normalize(0.0)
            .filter(|a| a.iter().all(|x| x.is_finite()));
        let Some(unit) = unit.filter(|a| D == 3 || a.z.abs() == 1.0) else {
            return Err(ModelError::OutOfRange {
                what: format!("axis that tool {name:?} turns about, its length"),
                value: axis.norm(),
                expected: match D {
                    3 => "a positive number",
                    _ => "that of a normal of the plane",
                },
            });
        };
        if self.measure.rigid_modes(&[1.0; D]).len() < 3 {
            return Err(ModelError::OutOfRange {
                what: format!("{what} tool {name:?}"),
                value,
                expected: "none: the analysis lets no tool turn",
            });
        }
        Ok(unit)
    }

    /// The loadings at the times within a step at which an amplitude has a row, from those at its ends.
    pub(crate) fn knots(
        &self,
        step: &Step<D>,
        [start, end]: [&Loading<D>; 2],
    ) -> Result<Vec<(f64, Loading<D>)>, ModelError> {
        let at = |time: f64| {
            let [bent, straight] = step.bent(time);
            let (bent, straight) = (self.loading(&bent)?, self.loading(&straight)?);
            Ok((time, start.towards(end, time).and(&bent, &straight)))
        };
        step.breaks().into_iter().map(at).collect()
    }

    /// The loading that holds now, with the prescribed displacements of `end`: those that are new
    /// start where the body is, and the reactions of those released become forces.
    pub(crate) fn start_of(&self, end: &Loading<D>) -> Loading<D> {
        let state = &self.state;
        let mut start = state.loading.clone();
        start.axle = end.axle.clone();
        start.release_turns();
        let held = state.loading.displacement.keys().map(|dof| dof / D);
        let held: BTreeSet<usize> = held.collect();
        for node in held {
            let released = end.free_at(node).part(&self.nodal_reaction(node));
            start.push(node, 1.0, &released.into());
        }
        let rest = vec![0.0; state.displacement.len()];
        for tool in 0..self.tools.len() {
            // What turned as told is turned from now on by the moment that this took.
            if let (Some(axle), None) = (end.axle_of(tool), state.loading.axle_of(tool)) {
                let moment = self.moment(tool, &rest, &state.contacts).dot(&axle);
                start
                    .force
                    .add(self.turn_dof(tool), moment / self.mesh.size());
            }
        }
        let at = |(&dof, &u): (&usize, &f64)| {
            let here = end.directions.component(dof, |j| state.displacement[j]);
            match end.is_rounding(dof, here - u, &state.displacement) {
                true => (dof, u),
                false => (dof, here),
            }
        };
        start.displacement = end.displacement.iter().map(at).collect();
        start.directions = end.directions.clone();
        start
    }
}
