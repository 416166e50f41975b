//! Nodes of bodies within tools beside the surfaces that touch them, where no contact is asked for; not the contact.

use crate::driver::Driver;
use nalgebra::SVector;
use std::collections::BTreeSet;

/// Where a body has moved into a tool beside the surface that touches it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beside<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The deepest node.
    pub node: usize,
    /// Where it is now \[mm\].
    pub position: [f64; D],
    /// How deep it is within the tool \[mm\].
    pub depth: f64,
    /// How many nodes are.
    pub count: usize,
}

/// Depth that counts, in parts of the mean length of a facet of the surface.
const DEEP: f64 = 0.1;

/// Cosine of the angle between an outward normal and the direction to a tool, from which on a surface faces it: what does and
/// has no contact was left out on purpose, as beside a punch that is told as a plane.
const FACES: f64 = 0.5;

impl<const D: usize> Driver<D> {
    /// Where a body is deepest within a tool that presses it elsewhere, on nodes that have no contact with that tool and were
    /// not within it in the virgin state; `None` if none is deeper than a tenth of a facet.
    pub fn beside_contacts(&self) -> Option<Beside<D>> {
        let pressing = self.state.contacts.iter().zip(&self.points);
        let pressing = pressing.filter(|(c, p)| c.t[0] > 0.0 && p.tool.is_some());
        let contacts: BTreeSet<usize> = pressing.map(|(_, p)| p.contact).collect();
        let all = contacts.into_iter().filter_map(|k| self.beside(k));
        all.max_by(|a, b| a.depth.total_cmp(&b.depth))
    }

    fn beside(&self, contact: usize) -> Option<Beside<D>> {
        let first = self.points.iter().find(|p| p.contact == contact)?;
        let number = first.tool?;
        let (tool, turn) = (&self.tools[number], self.state.loading.turn_of(number));
        let at = self.displacement(self.tool_node(number));
        let own = self.points.iter().filter(|p| p.tool == Some(number));
        let own: BTreeSet<usize> = own.map(|p| p.node).collect();
        let deep = DEEP
            * self
                .facet_and_motion(contact, &vec![0.0; self.state.displacement.len()])
                .0;
        let body = self.skin.get(&first.node)?.0;
        let others = self.skin.iter();
        let others = others.filter(|(a, (of, _))| *of == body && !own.contains(a));
        let depth = |(&a, (_, normal)): (&usize, &(usize, SVector<f64, D>))| {
            let virgin = SVector::from(self.mesh.nodes()[a]);
            let now = tool.seen(self.position(a) - at, &turn);
            let depth = -tool.obstacle.distance(&now);
            let counts = || {
                let faces = -normal.dot(&tool.obstacle.normal(&virgin)) > FACES;
                !faces && tool.obstacle.distance(&virgin) > -deep
            };
            (depth > deep && counts()).then_some((a, depth))
        };
        let within: Vec<(usize, f64)> = others.filter_map(depth).collect();
        let &(node, depth) = within.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Beside {
            contact,
            node,
            position: self.position(node).into(),
            depth,
            count: within.len(),
        })
    }
}
