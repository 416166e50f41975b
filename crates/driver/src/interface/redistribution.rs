//! Contact points that displacement conditions, or the tools they are on, leave no freedom of their own: between bodies
//! their multipliers go to their neighbours, on a tool to the nearest; not the multipliers themselves.
//!
//! A node of the non-mortar side that is held cannot answer its multiplier, and where many nodes are
//! held opposite to few that are free, their multipliers are more than what decides them. The sum of
//! two multipliers is one again: Σ Φ_a = 1 stays true, so that a uniform pressure passes as before,
//! and weights that are means of weights keep linear fields, and action equal to reaction.
//!
//! Two bodies side by side on a rough floor have no freedom at a corner where it holds both: how much of the force between
//! them goes through that corner, and how much into the floor beneath, nothing would decide. Where both slip on it, nothing
//! decides the shear between them at that corner, which is left out.
//!
//! Where nodes are held opposite to a tool that a force drives, rigid meets rigid: the one that the tool
//! comes to first stops it, and what others at the same distance would bear nothing decides.

use crate::driver::Driver;
use crate::interface::elimination::{Elimination, row};
use crate::model::footing::Ground;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics};
use crate::vector::Combination;
use crate::vector::subspace::Subspace;
use moreau_mesh::Facet;
use nalgebra::SVector;
use std::collections::{BTreeMap, BTreeSet};

/// Way of a tool, over the size of the mesh, that is rounding of positions.
const NO_WAY: f64 = 1e-12;

/// Least coefficient of a row over its largest weight, after those before it have been taken out, for it to
/// say something of its own: forces grow by its inverse.
const DISTINCT: f64 = 0.05;

impl<const D: usize> Driver<D> {
    /// Hands over the multipliers of the points of a contact that a loading holds.
    pub(crate) fn redistribute_multipliers(
        &self,
        motion_rows: &mut [RelativeMotionRow<D>],
        (contact, surface): (usize, &[Facet]),
        loading: &Loading<D>,
    ) {
        let own = |c: usize| self.points[c].node;
        let ties = self.ties_by_node();
        let crosses = |c: usize| self.crosses(c, &motion_rows[c], &ties);
        let is_held = |&c: &usize| crosses(c) || loading.free_at(own(c)).dimension() < D;
        let meets = |c: &usize| self.points[*c].contact == contact;
        let all: Vec<usize> = (0..self.points.len())
            .filter(|c| meets(c) && motion_rows[*c].plane(&SVector::zeros()).is_some())
            .collect();
        let grounds = self.grounds_of(motion_rows, &all);
        if grounds.is_empty() && !all.iter().any(is_held) {
            return;
        }
        let neighbours = self.neighbours(surface);
        // Those that cannot give way at all, next to others that can. Whether a node that is free in some directions gives way
        // to a pressure would hang on the last digit of its normal.
        let stiff = |&c: &usize| crosses(c) || loading.free_at(own(c)).dimension() == 0;
        let (held, mut kept): (BTreeSet<usize>, BTreeSet<usize>) = all.into_iter().partition(stiff);
        let mut stranded = Vec::new();
        for c in held {
            let takers = self.takers(c, &kept, &neighbours);
            if takers.is_empty() {
                stranded.push(c);
            } else {
                give(motion_rows, c, &takers);
            }
        }
        kept.extend(stranded);
        // Those about which the others say all.
        loop {
            let spare = self.spare(motion_rows, (&kept, &grounds), loading);
            if spare.is_empty() {
                self.leave_to_tools(motion_rows, (&kept, &grounds), loading);
                return;
            }
            kept.retain(|c| !spare.contains(c));
            for c in spare {
                let mut takers = self.takers(c, &kept, &neighbours);
                if takers.is_empty() {
                    let nearest =
                        |a: &&usize, b: &&usize| self.apart(c, **a).total_cmp(&self.apart(c, **b));
                    takers.extend(kept.iter().min_by(nearest).map(|&k| (k, 1.0)));
                }
                // Where no point says anything, nothing is lost by what is kept.
                if !takers.is_empty() {
                    give(motion_rows, c, &takers);
                }
            }
        }
    }

    /// What tools hold of the points between bodies that are at nodes on a tool, and of what is opposite to them.
    fn grounds_of(
        &self,
        motion_rows: &[RelativeMotionRow<D>],
        between: &[usize],
    ) -> Vec<Ground<D>> {
        let own = |ground: &Ground<D>| self.points[ground.point].own.iter().map(|o| o.0);
        let grounds = &self.footing.grounds;
        let held: BTreeSet<usize> = grounds.iter().flat_map(own).collect();
        let crossing = between
            .iter()
            .filter(|&&c| held.contains(&self.points[c].node));
        let moved: BTreeSet<usize> = crossing.flat_map(|&c| motion_rows[c].nodes()).collect();
        let bears = |ground: &&Ground<D>| own(ground).any(|a| moved.contains(&a));
        grounds.iter().filter(bears).copied().collect()
    }

    /// What tools hold, as rows that come before those of others.
    fn held_by(
        &self,
        grounds: &[Ground<D>],
        motion_rows: &[RelativeMotionRow<D>],
        loading: &Loading<D>,
    ) -> Elimination {
        let mut rows = Elimination::new(self.state.displacement.len());
        let unknown = |dof: usize| (!loading.displacement.contains_key(&dof)).then_some(dof);
        for ground in grounds {
            let (c, none) = (ground.point, SVector::zeros());
            let free = loading.free_at(self.points[c].node);
            let k = Kinematics::new(&self.points[c], &ground.normal, 0.0, &none, &free);
            let held = if ground.sticks { D } else { 1 };
            for j in (0..held).filter(|&j| k.active[j]) {
                let row = row((&motion_rows[c], &loading.directions), &k, j, unknown);
                rows.solve(D * c + j, &row, &[]);
            }
        }
        rows
    }

    /// Leaves to tools what they hold of the motion along the surface between bodies, on both sides of it.
    fn leave_to_tools(
        &self,
        motion_rows: &mut [RelativeMotionRow<D>],
        (kept, grounds): (&BTreeSet<usize>, &[Ground<D>]),
        loading: &Loading<D>,
    ) {
        if grounds.is_empty() {
            return;
        }
        let mut held = self.held_by(grounds, motion_rows, loading);
        let unknown = |dof: usize| (!loading.displacement.contains_key(&dof)).then_some(dof);
        for &c in kept {
            let (motion_row, point) = (&motion_rows[c], &self.points[c]);
            let Some((n, _)) = motion_row.plane(&SVector::zeros()) else {
                continue;
            };
            let free = motion_row.free(point.node, |a| loading.free_at(a));
            let mut is_held = |m: &SVector<f64, D>| {
                let k = Kinematics::new(point, m, 0.0, &SVector::zeros(), &free);
                let along = row((motion_row, &loading.directions), &k, 0, unknown);
                !held.is_independent(&along, DISTINCT * motion_row.largest_weight())
            };
            let own = |ground: &&Ground<D>| {
                let nodes = &self.points[ground.point].own;
                nodes.iter().any(|&(a, _)| a == point.node)
            };
            let normals = grounds.iter().filter(own).map(|ground| ground.normal);
            let across = normals.filter(|m| m.dot(&n).abs() < DISTINCT && is_held(m));
            motion_rows[c].grounded = across.collect();
        }
    }

    /// The points of ties by the nodes that their rows move.
    fn ties_by_node(&self) -> BTreeMap<usize, Vec<usize>> {
        let mut ties: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (t, tie) in self.points.iter().enumerate() {
            for (a, _) in tie.tied.iter().flat_map(|row| row.weights()) {
                ties.entry(a).or_default().push(t);
            }
        }
        ties
    }

    /// Whether a point says what a tie says already. A node in two ties has a multiplier in the first alone, or the second
    /// would say what neighbours say; and the contact of two bodies ends at the nodes that are tied to each other, of either
    /// side.
    fn crosses(
        &self,
        c: usize,
        motion_row: &RelativeMotionRow<D>,
        ties: &BTreeMap<usize, Vec<usize>>,
    ) -> bool {
        let point = &self.points[c];
        let beside = ties.get(&point.node).filter(|_| point.tool.is_none());
        let is_crossed = |tie: &ContactPoint<D>| match point.tied {
            Some(_) => tie.contact < point.contact && tie.node == point.node,
            None => tie.tied.as_ref().is_some_and(|row| {
                let opposite =
                    |(b, _): &(usize, f64)| motion_row.opposite.iter().any(|o| o.0 == *b);
                let own = tie.node == point.node && row.opposite.iter().any(opposite);
                own || motion_row.is_along(row, DISTINCT)
            }),
        };
        beside.is_some_and(|ties| ties.iter().any(|&t| is_crossed(&self.points[t])))
    }

    /// Opens the points at which held nodes meet a driven tool, but for the one that each tool comes to
    /// first: after the least way gap / |m|, m the normal along the free directions of the tool. What is
    /// behind it is not reached; what is reached with it, and stops other motions than it does, wedges
    /// the tool: then neither is first for long, and the increment does not converge.
    pub(crate) fn stop_once(
        &self,
        free_at: impl Fn(usize) -> Subspace<D>,
        kinematics: &mut [Kinematics<D>],
    ) {
        // By tool, the point and the way to it.
        let mut first: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
        let mut rest = Vec::new();
        for (c, (p, k)) in self.points.iter().zip(kinematics.iter()).enumerate() {
            let Some(tool) = p.tool.filter(|_| k.active[0]) else {
                continue;
            };
            let n = k.axes.column(0);
            let along = |node: usize| free_at(node).part(&n.into_owned());
            if p.own.iter().any(|&(a, _)| along(a).norm() > 0.0) {
                continue;
            }
            let way = k.u[0] / along(self.tool_node(tool)).norm();
            match first.get_mut(&tool) {
                None => {
                    first.insert(tool, (c, way));
                }
                Some(first) if way < first.1 - NO_WAY * self.mesh.size() => {
                    rest.push(std::mem::replace(first, (c, way)).0);
                }
                Some(_) => rest.push(c),
            }
        }
        for c in rest {
            let k = &kinematics[c];
            kinematics[c] = Kinematics::apart(k.law, k.gap);
        }
    }

    /// Nodes that share a facet, by node.
    fn neighbours(&self, surface: &[Facet]) -> BTreeMap<usize, BTreeSet<usize>> {
        let mut neighbours: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for &facet in surface {
            for a in self.mesh.facet_nodes(facet) {
                let beside = self.mesh.facet_nodes(facet).filter(|&b| b != a);
                neighbours.entry(a).or_default().extend(beside);
            }
        }
        neighbours
    }

    /// Square of the distance of the nodes of two points \[mm²\].
    fn apart(&self, a: usize, b: usize) -> f64 {
        let position = |c: usize| SVector::from(self.mesh.nodes()[self.points[c].node]);
        let apart: SVector<f64, D> = position(a) - position(b);
        apart.norm_squared()
    }

    /// The points beside one, with parts of its multiplier: as the inverse square of their distances.
    fn takers(
        &self,
        c: usize,
        kept: &BTreeSet<usize>,
        neighbours: &BTreeMap<usize, BTreeSet<usize>>,
    ) -> Vec<(usize, f64)> {
        let beside = neighbours.get(&self.points[c].node);
        let is_beside = |k: &&usize| beside.is_some_and(|b| b.contains(&self.points[**k].node));
        let takers: Vec<(usize, f64)> = kept
            .iter()
            .filter(is_beside)
            .map(|&k| (k, 1.0 / self.apart(c, k)))
            .collect();
        let sum: f64 = takers.iter().map(|t| t.1).sum();
        takers
            .into_iter()
            .map(|(k, part)| (k, part / sum))
            .collect()
    }

    /// A point with its first tangent where its node is free along the surface, if it is held in other directions: what is
    /// said of each direction by itself is the same however the bodies are turned.
    fn aligned(&self, c: usize, n: &SVector<f64, D>, loading: &Loading<D>) -> ContactPoint<D> {
        let mut point = self.points[c].clone();
        let own = loading.free_at(point.node);
        if own.dimension() < D {
            let tangents = own.common(&Subspace::spanned(&[*n]).complement());
            point.axis = tangents.vectors().next().or(point.axis);
        }
        point
    }

    /// Points that are held, of which the relative displacement, as far as it is free, is determined
    /// by those of others: by those on tools, then by the points with a freedom of their own, then by those with one
    /// opposite nearly to themselves. Where only that is determined by others which is along the directions in which they
    /// are held, ties are kept as they are, and contacts say what their nodes can do.
    fn spare(
        &self,
        motion_rows: &mut [RelativeMotionRow<D>],
        (kept, grounds): (&BTreeSet<usize>, &[Ground<D>]),
        loading: &Loading<D>,
    ) -> Vec<usize> {
        let is_free = |dof: usize| !loading.displacement.contains_key(&dof);
        let own = |c: usize| (0..D).map(move |i| D * self.points[c].node + i);
        let nodes = |ground: &Ground<D>| self.points[ground.point].own.iter().map(|o| o.0);
        let grounded: BTreeSet<usize> = grounds.iter().flat_map(nodes).collect();
        let is_held = |c: usize| !own(c).all(is_free) || grounded.contains(&self.points[c].node);
        let alone = |c: usize| match is_held(c) {
            true => self.footing.opposite[c],
            false => f64::INFINITY,
        };
        // Weights that are equal but for rounding are equal.
        let mut order: Vec<(f32, usize)> = kept.iter().map(|&c| (alone(c) as f32, c)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut rows = self.held_by(grounds, motion_rows, loading);
        let mut spare = Vec::new();
        for (alone, c) in order {
            let motion_row = &motion_rows[c];
            let mut own_only = false;
            let Some((n, gap)) = motion_row.plane(&SVector::zeros()) else {
                continue;
            };
            let point = &self.aligned(c, &n, loading);
            let least = DISTINCT * motion_row.largest_weight();
            let is_grounded = grounded.contains(&point.node);
            let unknown = |dof: usize| is_free(dof).then_some(dof);
            let rows_in = |free: &Subspace<D>| -> Vec<(usize, Combination)> {
                let k = Kinematics::new(point, &n, gap, &SVector::zeros(), free);
                let given = (motion_row, &loading.directions);
                let active = (0..D).filter(|&j| k.active[j]);
                active
                    .map(|j| (D * c + j, row(given, &k, j, unknown)))
                    .collect()
            };
            let are_distinct = |all: &[(usize, Combination)], rows: &mut Elimination| {
                // What tools hold of the motion along the surface is left to them afterwards.
                let decisive = if is_grounded { 1 } else { D };
                let mut own = all.iter().take(decisive);
                own.all(|(_, row)| rows.is_independent(row, least))
            };
            let mut all = rows_in(&motion_row.free(point.node, |a| loading.free_at(a)));
            if alone.is_finite() && !are_distinct(&all, &mut rows) {
                let own = loading.free_at(point.node);
                let parts = match point.law.is_tie() {
                    true => own.dimension() > 0,
                    false => own.part(&n).norm() > DISTINCT,
                };
                if parts {
                    all = rows_in(&own);
                }
                if !(parts && are_distinct(&all, &mut rows)) {
                    spare.push(c);
                    continue;
                }
                own_only = !point.law.is_tie();
            }
            let own: Vec<usize> = own(c).collect();
            for (component, row) in all {
                // What cannot be solved for is refused where the increment is.
                rows.solve(component, &row, &own);
            }
            motion_rows[c].own_only |= own_only;
        }
        spare
    }
}

/// Adds parts of the multiplier of a point to those of others; it has none then.
fn give<const D: usize>(
    motion_rows: &mut [RelativeMotionRow<D>],
    from: usize,
    takers: &[(usize, f64)],
) {
    let given = std::mem::take(&mut motion_rows[from]);
    for &(taker, part) in takers {
        motion_rows[taker].take_over(&given, part);
    }
}
