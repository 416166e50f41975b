//! Gaps of contacts before anything is solved: the least of each, and bodies that lie within each other;
//! not what contact makes of them.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::model::load::Loading;
use moreau_mesh::Facet;
use nalgebra::SVector;

/// The least gap of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastGap<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The gap, negative where one is within the other \[mm\].
    pub gap: f64,
    /// The node where that is, of either surface.
    pub node: usize,
    /// Where that is now \[mm\].
    pub position: [f64; D],
    /// Nodes that are within what they are in contact with.
    pub inside: usize,
    /// Whether contact is found there: not at a node that is deeper within the other body than a facet is long.
    pub met: bool,
}

/// Motion in an increment, over the depth of what begins within something else, up to which a shorter one is as good as the
/// same.
const SAME: f64 = 0.1;

/// Penetrations below this part of the size of the mesh are rounding of a file.
const ROUNDING: f64 = 1e-6;

impl<const D: usize> Driver<D> {
    /// The least gap of every contact that meets something, with what displacements there are.
    pub fn least_gaps(&self) -> Vec<LeastGap<D>> {
        let count = (self.points.iter()).fold(0, |most, p| most.max(p.contact + 1));
        (0..count).filter_map(|k| self.least_gap(k)).collect()
    }

    /// Penetration from which on surfaces are said to be within each other \[mm\].
    pub fn rounding_of_gaps(&self) -> f64 {
        ROUNDING * self.mesh.size()
    }

    /// How many nodes of the surface of a contact are deeper than so much \[mm\] within what they are in contact with.
    pub fn nodes_within(&self, contact: usize, depth: f64) -> usize {
        self.gaps(contact).filter(|(gap, _)| *gap < -depth).count()
    }

    /// The gaps of a contact with their nodes; none of nodes that face nothing.
    fn gaps(&self, contact: usize) -> impl Iterator<Item = (f64, usize)> {
        let pairs = self.points.iter().zip(&self.footing.rows);
        let own = pairs.filter(move |(p, _)| p.contact == contact && p.tied.is_none());
        own.filter_map(|(p, motion_row)| {
            let gap = match p.tool {
                Some(tool) => {
                    let at = self.displacement(self.tool_node(tool));
                    let turn = self.state.loading.turn_of(tool);
                    let tool = &self.tools[tool];
                    let seen = |a| tool.seen(self.position(a) - at, &turn);
                    let node = tool.opposite(p).distance(&seen(p.node)) - p.offset;
                    // In a changed basis the gap of a point has its neighbours in it.
                    p.gap(tool.opposite(p), seen).max(node)
                }
                None => motion_row.plane(&SVector::zeros())?.1 - p.offset,
            };
            Some((gap, p.node))
        })
    }

    /// What begins within something else by far more than the first increment, from one loading to another, moves anything: if
    /// that one has no balance, no shorter one has. `None` where it changes loads, which are less in a shorter one.
    pub(crate) fn overlap_at_start(
        &self,
        start: &Loading<D>,
        end: &Loading<D>,
    ) -> Option<LeastGap<D>> {
        if self.state.increment > 0 {
            return None;
        }
        let grows = end.increment_from(start);
        let loads = [&grows.force, &grows.pressure];
        if loads.iter().any(|load| !load.is_zero()) || start.temperature != end.temperature {
            return None;
        }
        let gaps = self.least_gaps().into_iter().filter(|g| g.inside > 0);
        let deepest = gaps.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        (self.driven(&grows) <= SAME * -deepest.gap).then_some(deepest)
    }

    /// Why an increment failed that begins with an overlap.
    pub(crate) fn overlapping(&self, gap: &LeastGap<D>, cause: IncrementError) -> IncrementError {
        let (surface, opposite) = self.contact_name(gap.contact);
        IncrementError::Overlap {
            surface: surface.to_owned(),
            opposite: opposite.to_owned(),
            depth: -gap.gap,
            node: gap.node,
            position: gap.position.to_vec(),
            inside: gap.inside,
            cause: Box::new(cause),
        }
    }

    fn least_gap(&self, contact: usize) -> Option<LeastGap<D>> {
        let gaps: Vec<(f64, usize)> = self.gaps(contact).collect();
        let least = gaps.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let within = |gap: f64| gap < -self.rounding_of_gaps();
        let inside = gaps.iter().filter(|g| within(g.0)).count();
        let found = |&(gap, node): &(f64, usize), inside: usize, met: bool| LeastGap {
            contact,
            gap,
            node,
            position: self.position(node).into(),
            inside,
            met,
        };
        let met = least.map(|l| found(l, inside, true));
        let deeper = self.overlap(contact).filter(|&(node, depth, _)| {
            // A gap that was found is the mean around its node along its normal, which is what counts: where curved meshes do
            // not match, nodes are within facets whose gaps are open.
            within(-depth) && met.is_none_or(|m| !within(m.gap)) && !self.is_met(contact, node)
        });
        match deeper {
            Some((node, depth, inside)) => Some(found(&(-depth, node), inside, false)),
            None => met,
        }
    }

    /// Whether a gap was found of which a node of either surface of a pair is a part.
    fn is_met(&self, contact: usize, node: usize) -> bool {
        let pairs = self.points.iter().zip(&self.footing.rows);
        let mut own = pairs.filter(|(p, _)| p.contact == contact).map(|p| p.1);
        let none = SVector::zeros();
        own.any(|row| {
            row.plane(&none).is_some() && row.weights().any(|(a, w)| a == node && w != 0.0)
        })
    }

    /// The node of either surface of a pair that is deepest within the other body, how much deeper than where the contact
    /// lets it touch, and how many are within; `None` on a tool.
    fn overlap(&self, contact: usize) -> Option<(usize, f64, usize)> {
        self.contacts[contact].pairing?;
        let nodes = 0..self.mesh.nodes().len();
        let positions: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
        let (surface, opposite) = self.surfaces(contact);
        let sides = [(surface, opposite), (opposite, surface)];
        let overlaps = sides.map(|s| self.mesh.overlap(&positions, s));
        let deepest = overlaps.into_iter().flatten();
        let own = self.points.iter().filter(|p| p.contact == contact);
        let into = own.fold(0.0, |most: f64, p| most.max(-p.offset));
        let deepest = deepest.map(|(node, depth, inside)| (node, depth - into, inside));
        deepest.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The facets of the surface of a contact and of the surface opposite, of which a tool has none.
    pub(crate) fn surfaces(&self, contact: usize) -> (&[Facet], &[Facet]) {
        let (surface, opposite) = self.contact_name(contact);
        let facets = |name| self.mesh.facet_group(name).unwrap_or(&[]);
        (facets(surface), facets(opposite))
    }
}
