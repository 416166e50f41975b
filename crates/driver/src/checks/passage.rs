//! Tools and bodies that an increment takes through a body: contact is asked for at its end alone, and may be found
//! on the wrong side, or not at all.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::model::load::Loading;
use crate::model::points::turned;
use nalgebra::SVector;

/// How deep a straight way through a tool may be in it, over the length of the way inside: of a cylinder, that
/// of the chord of a quarter turn.
const CHORD: f64 = 0.2;

/// And over the size of the mesh: what is thinner does not matter.
const THIN: f64 = 1e-3;

/// How far a tool may turn: what goes round it farther is nearer on its other side. By rounding more than a quarter turn.
const QUARTER: f64 = (1.0 + 1e-9) * std::f64::consts::FRAC_PI_2;

/// Pieces of the way that are looked at, at least; farther from the tool they are longer.
const PIECES: f64 = 4096.0;

/// How deep bodies may be within each other, over the length of a facet.
const DEEP: f64 = 0.5;

/// Times that is looked at on the way, at most.
const MOST_LOOKS: f64 = 16.0;

impl<const D: usize> Driver<D> {
    /// Every contact point that comes to its tool must have come from outside of it, not through it: the
    /// straight way of the displacement increments `d_u` may cut the surface as a chord does. No tool must turn by more than
    /// a quarter turn.
    ///
    /// # Errors
    /// [`IncrementError::Turn`] and [`IncrementError::Passage`].
    pub(crate) fn check_passage(
        &self,
        d_u: &[f64],
        end: &Loading<D>,
    ) -> Result<(), IncrementError> {
        let size = self.mesh.size();
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        for (k, tool) in self.tools.iter().enumerate() {
            let turn = self.turned_by(k, end, d_u).norm();
            if turn > QUARTER {
                return Err(IncrementError::Turn {
                    tool: tool.name.clone(),
                    angle: turn,
                });
            }
        }
        for (p, motion_row) in self.points.iter().zip(&self.footing.rows) {
            let Some(tool) = p.tool else { continue };
            let (start, turn) = (self.seen(p, motion_row), self.turn_at(tool, end, d_u));
            let mut way = turned(motion_row.relative(moved), &-turn);
            if turn != self.state.loading.turn_of(tool) {
                let at = |a: usize| match a < self.mesh.nodes().len() {
                    true => self.position(a),
                    false => self.displacement(a),
                };
                let there = motion_row.relative(at) + motion_row.relative(moved);
                way = self.tools[tool].seen(there, &turn) - start;
            }
            let length = way.norm();
            if length <= THIN * size {
                continue;
            }
            let obstacle = &self.tools[tool].obstacle;
            let gap = |s: f64| obstacle.distance(&(start + way * (s / length))) - p.offset;
            let surface = gap(0.0).min(gap(length)).min(0.0);
            let piece = (0.25 * THIN * size).max(length / PIECES);
            let (mut s, mut entered, mut depth) = (0.0, 0.0, 0.0f64);
            while s < length {
                // Nothing is nearer than the distance: going as far passes nothing.
                let inside = surface - gap(s);
                let ahead = (s + inside.abs().max(piece)).min(length);
                depth = depth.max(inside);
                let out = inside <= 0.0 || ahead >= length;
                if out && depth > (THIN * size).max(CHORD * (s - entered)) {
                    return Err(IncrementError::Passage {
                        tool: self.tools[tool].name.clone(),
                        node: p.node,
                        position: self.mesh.nodes()[p.node].to_vec(),
                        depth,
                    });
                }
                if out {
                    (entered, depth) = (ahead, 0.0);
                }
                s = ahead;
            }
        }
        Ok(())
    }

    /// No node of a surface must be deeper within the other body than half a facet, at the end of an increment of large
    /// strains and on the straight way there: what is a facet behind a surface is not paired with it. Nodes that were so
    /// deep before stay what they are.
    ///
    /// # Errors
    /// [`IncrementError::Within`].
    pub(crate) fn check_bodies(&self, d_u: &[f64]) -> Result<(), IncrementError> {
        if !self.repairs() {
            return Ok(());
        }
        let positions = |part: f64| -> Vec<[f64; D]> {
            let at = |a: usize| {
                let moved = SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
                (self.position(a) + moved * part).into()
            };
            (0..self.mesh.nodes().len()).map(at).collect()
        };
        for contact in (0..self.contacts.len()).filter(|&k| self.contacts[k].pairing.is_some()) {
            let (facet, moved) = self.facet_and_motion(contact, d_u);
            let depth = |part: f64| {
                let found = self.mesh.overlap(&positions(part), self.surfaces(contact));
                found.map_or((0, 0.0), |(node, depth, _)| (node, depth))
            };
            let looks = (moved / facet).ceil().clamp(1.0, MOST_LOOKS);
            for k in (1..=looks as usize).rev() {
                let (node, deepest) = depth(k as f64 / looks);
                if deepest > DEEP * facet && depth(0.0).1 <= DEEP * facet {
                    let (surface, opposite) = self.contact_name(contact);
                    return Err(IncrementError::Within {
                        surface: surface.into(),
                        opposite: opposite.into(),
                        node,
                        position: self.mesh.nodes()[node].to_vec(),
                        depth: deepest,
                    });
                }
            }
        }
        Ok(())
    }

    /// The mean length of a facet of both surfaces of a pair, and the largest motion of their nodes \[mm\].
    pub(super) fn facet_and_motion(&self, contact: usize, d_u: &[f64]) -> (f64, f64) {
        let (surface, opposite) = self.surfaces(contact);
        let (mut sum, mut count, mut moved) = (0.0, 0.0f64, 0.0f64);
        for &facet in surface.iter().chain(opposite) {
            let nodes: Vec<usize> = self.mesh.facet_nodes(facet).collect();
            let ends = [nodes[0], nodes[1]].map(|a| self.position(a));
            sum += (ends[1] - ends[0]).norm();
            count += 1.0;
            for a in nodes {
                let own = SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
                moved = moved.max(own.norm());
            }
        }
        (sum / count.max(1.0), moved)
    }
}
