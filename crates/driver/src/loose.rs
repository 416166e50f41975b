//! Tools driven by a force that touch nothing yet: how far they are, and where their force takes
//! them; not what stops them.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::load::Loading;
use nalgebra::SVector;
use std::fmt;

/// Gaps below this part of the size of the mesh are closed.
const CLOSED: f64 = 1e-9;
/// How near a tool on its way must come to touch, in parts of the size of the mesh.
const TOUCHING: f64 = 1e-6;
/// How far its way is followed, in sizes of the mesh beyond the first gap.
const FARTHEST: f64 = 10.0;

/// A tool driven by a force that touches nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct LooseTool {
    /// The tool.
    pub tool: String,
    /// The force on it \[N\].
    pub force: Vec<f64>,
    /// The surface nearest to it.
    pub surface: String,
    /// Where the surface is nearest \[mm\].
    pub position: Vec<f64>,
    /// How far it is from there \[mm\].
    pub gap: f64,
    /// The motion along its force after which it touches, if there is one \[mm\].
    pub meets: Option<Vec<f64>>,
}

/// Numbers to six digits.
fn significant(values: &[f64]) -> Vec<f64> {
    let short = |v: &f64| format!("{v:.5e}").parse().unwrap_or(*v);
    values.iter().map(short).collect()
}

impl fmt::Display for LooseTool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            tool,
            force,
            surface,
            ..
        } = self;
        let (gap, at) = (significant(&[self.gap])[0], significant(&self.position));
        write!(
            f,
            "tool {tool:?} is driven by the force {force:?} and nothing resists it: it touches nothing. \
             Nearest to it is {surface:?}, {gap} away at {at:?}; "
        )?;
        match &self.meets {
            Some(motion) => write!(
                f,
                "moved by {:?} it would touch: begin with a step that moves it there, and drive it from \
                 there",
                significant(motion)
            ),
            None => f.write_str(
                "on the way of its force it meets nothing: put it elsewhere, or turn the force",
            ),
        }
    }
}

impl<const D: usize> Driver<D> {
    /// The least gap of the points that a tool may touch, after a further motion of it, with the point;
    /// `None` if there are none.
    fn tool_gap(&self, tool: usize, motion: &SVector<f64, D>) -> Option<(f64, usize)> {
        let at = self.displacement(self.tool_node(tool)) + motion;
        let obstacle = &self.tools[tool].obstacle;
        let points = self.points.iter().enumerate();
        let gaps = points
            .filter(|(_, p)| p.tool == Some(tool))
            .map(|(k, p)| (p.gap(obstacle.as_ref(), |a| self.position(a) - at), k));
        gaps.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The displacement increments that may be repeated: those that are about to be committed, less
    /// what a driven tool has moved to close its gap.
    pub(crate) fn repeatable(&self, mut d_u: Vec<f64>, end: &Loading<D>) -> Vec<f64> {
        for tool in 0..self.tools.len() {
            let first = D * self.tool_node(tool);
            let driven = (first..first + D).filter(|dof| !end.displacement.contains_key(dof));
            let driven: Vec<usize> = driven.collect();
            let moved = driven.iter().fold(0.0f64, |m, &dof| m.hypot(d_u[dof]));
            if moved == 0.0 {
                continue;
            }
            let gap = self.tool_gap(tool, &SVector::zeros()).map_or(0.0, |g| g.0);
            if gap > CLOSED * self.mesh.size() {
                let rest = (1.0 - gap / moved).max(0.0);
                driven.iter().for_each(|&dof| d_u[dof] *= rest);
            }
        }
        d_u
    }

    /// The first tool with a force under a loading that touches nothing, if there is one.
    pub(crate) fn loose_tool(&self, end: &Loading<D>) -> Option<ModelError> {
        let size = self.mesh.size();
        (0..self.tools.len()).find_map(|tool| {
            let force = SVector::from(end.force.at_node::<D>(self.tool_node(tool)));
            let (gap, nearest) = self.tool_gap(tool, &SVector::zeros())?;
            if force.norm() == 0.0 || gap <= TOUCHING * size {
                return None;
            }
            // Nothing is nearer than the gap: going as far can pass nothing.
            let way = force.normalize();
            let (mut gone, mut left) = (gap, gap);
            while left > TOUCHING * size && gone < FARTHEST * size + gap {
                left = self.tool_gap(tool, &(way * gone))?.0;
                gone += left.max(TOUCHING * size);
            }
            let meets = left <= TOUCHING * size;
            let point = &self.points[nearest];
            Some(ModelError::LooseTool(Box::new(LooseTool {
                tool: self.tools[tool].name.clone(),
                force: force.iter().copied().collect(),
                surface: self.contact_name(point.contact).0.to_owned(),
                position: self.position(point.node).iter().copied().collect(),
                gap,
                meets: meets.then(|| (way * gone).iter().copied().collect()),
            })))
        })
    }
}
