//! The order of elimination, of any graph.

use crate::common::graph;
use moreau_algebra::nested_dissection;
use proptest::prelude::*;

proptest! {
    /// Whatever the graph and wherever its nodes are, also all in one place or nowhere.
    #[test]
    fn an_order_is_a_permutation(
        a in graph(0..120), spread in 0..3u8, dimension_is_two in any::<bool>(),
    ) {
        let n = a.nrows();
        let neighbours = |i: usize| (0..n).filter(|&j| j != i && a[(i, j)] != 0.0).collect();
        let adjacency: Vec<Vec<usize>> = (0..n).map(neighbours).collect();
        let place = |i: usize, axis: usize| match spread {
            0 => 1.0,
            1 => (12.9898 * (i + 7 * axis) as f64).sin(),
            _ => if i.is_multiple_of(5) { f64::NAN } else { i as f64 },
        };
        let nodes: Vec<usize> = (0..n).filter(|i| i % 7 != 3).collect();
        let mut order = if dimension_is_two {
            let points: Vec<[f64; 2]> = (0..n).map(|i| [place(i, 0), place(i, 1)]).collect();
            nested_dissection(&nodes, &points, |i| &adjacency[i])
        } else {
            let points: Vec<[f64; 3]> = (0..n).map(|i| [0, 1, 2].map(|k| place(i, k))).collect();
            nested_dissection(&nodes, &points, |i| &adjacency[i])
        };
        order.sort_unstable();
        prop_assert_eq!(order, nodes);
    }
}
