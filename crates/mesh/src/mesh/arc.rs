//! Arc length along lines of edges in the plane; not curves in space.

use super::{Facet, Mesh};
use crate::gauss;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

impl<const D: usize> Mesh<D> {
    /// Arc length \[mm\] at every node of a surface, along its edges from the end of least x, or of least y among
    /// those; along a closed line from such a corner on. Lines that do not hang together follow one another. Nothing in space.
    pub fn arc_length(&self, surface: &[Facet]) -> BTreeMap<usize, f64> {
        let lines = if D == 2 { surface } else { &[] };
        let edges: Vec<Vec<usize>> = lines
            .iter()
            .map(|&facet| self.facet_nodes(facet).collect())
            .collect();
        let mut at: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for (k, edge) in edges.iter().enumerate() {
            for corner in &edge[..2] {
                at.entry(*corner).or_default().insert(k);
            }
        }
        let mut arc = BTreeMap::new();
        let mut s = 0.0;
        while let Some(first) = self.start(&at) {
            arc.entry(first).or_insert(s);
            let mut corner = first;
            while let Some(k) = at.get_mut(&corner).and_then(BTreeSet::pop_first) {
                let edge = &edges[k];
                let ahead = usize::from(edge[0] == corner);
                let halves = self.halves(edge);
                let (half, whole) = (halves[1 - ahead], halves[0] + halves[1]);
                if let Some(&mid) = edge.get(2) {
                    arc.insert(mid, s + half);
                }
                s += whole;
                corner = edge[ahead];
                if let Some(others) = at.get_mut(&corner) {
                    others.remove(&k);
                }
                arc.entry(corner).or_insert(s);
            }
            at.retain(|_, edges| !edges.is_empty());
        }
        arc
    }

    /// The corner that a line begins with: its end, or any corner of a closed one.
    fn start(&self, edges: &BTreeMap<usize, BTreeSet<usize>>) -> Option<usize> {
        let least = |ends: bool| {
            let of = edges.iter().filter(|(_, k)| (k.len() == 1) == ends);
            of.map(|(&corner, _)| corner).min_by(|&a, &b| {
                let axes = self.nodes()[a].iter().zip(&self.nodes()[b]);
                let orders = axes.map(|(a, b)| a.total_cmp(b));
                orders.fold(Ordering::Equal, Ordering::then)
            })
        };
        least(true).or_else(|| least(false))
    }

    /// Lengths of an edge before and behind its middle ξ = 0.
    fn halves(&self, edge: &[usize]) -> [f64; 2] {
        let x = |k: usize| self.nodes()[edge[k]];
        let mid = match edge.len() {
            2 => std::array::from_fn(|i| 0.5 * (x(0)[i] + x(1)[i])),
            _ => x(2),
        };
        let length = |from: f64| {
            let points = gauss(4).points.into_iter();
            let parts = points.map(|p| {
                let xi = from + 0.5 * (p.xi[0] + 1.0);
                let slope =
                    |i: usize| (xi - 0.5) * x(0)[i] + (xi + 0.5) * x(1)[i] - 2.0 * xi * mid[i];
                0.5 * p.weight * (0..D).fold(0.0, |l: f64, i| l.hypot(slope(i)))
            });
            parts.sum::<f64>()
        };
        [length(-1.0), length(0.0)]
    }
}

#[cfg(test)]
mod tests {
    use crate::CellKind;
    use crate::generate::{block2, uniform};
    use std::f64::consts::PI;

    /// Around a quarter of a ring: along its bore, whatever the order of the facets; around all of it.
    #[test]
    fn arcs_are_as_long_as_arcs() {
        let (r, angle) = (uniform(1.0, 2.0, 3), uniform(0.0, 0.5 * PI, 12));
        let ring = block2("ring", CellKind::Quad8, &r, &angle).expect("a block");
        let ring = ring
            .map(|[r, a]| [r * a.cos(), r * a.sin()])
            .expect("a ring");
        let bore = ring.facet_group("ring.left").expect("a group");
        let turned: Vec<_> = bore.iter().rev().copied().collect();
        let arc = ring.arc_length(bore);
        assert_eq!(arc, ring.arc_length(&turned));
        assert_eq!(arc.len(), 25);
        for (&node, s) in &arc {
            let [x, y] = ring.nodes()[node];
            let angle = 0.5 * PI - y.atan2(x);
            assert!((s - angle).abs() < 1e-5, "{s} {angle}");
        }
        let sides = ["ring.left", "ring.right", "ring.bottom", "ring.top"];
        let groups = sides.map(|name| ring.facet_group(name).expect("a group"));
        let round = ring.arc_length(&groups.concat());
        let longest = round.values().copied().fold(0.0, f64::max);
        // Up to the middle of the edge that closes it, a third long.
        assert!(
            (longest - (1.5 * PI + 2.0 - 1.0 / 6.0)).abs() < 1e-4,
            "{longest}"
        );
    }

    #[test]
    fn lines_follow_one_another() {
        let x = uniform(0.0, 3.0, 3);
        let block = block2("b", CellKind::Quad4, &x, &uniform(0.0, 1.0, 1)).expect("a block");
        let groups = ["b.top", "b.bottom"].map(|name| block.facet_group(name).expect("a group"));
        let arc = block.arc_length(&groups.concat());
        let expected = [0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0];
        let off = arc.values().zip(expected).map(|(s, e)| (s - e).abs());
        assert!(off.fold(0.0, f64::max) < 1e-14, "{arc:?}");
    }
}
