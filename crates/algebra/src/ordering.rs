//! Fill-reducing order of the nodes by nested dissection: cuts by planes and spheres, moved to the
//! smallest separators nearby; not the factorisation.

mod separator;

use separator::Cutter;

/// Sets of at most this many nodes are not dissected further.
const LEAF: usize = 8;

/// Orders `nodes` by recursive bisection: halves first, the separator between them last, so that
/// eliminating a half never touches the other. Returns the nodes in their order of elimination.
///
/// `adjacency(a)` lists the neighbours of node a, as they list a; those outside `nodes` are ignored.
pub fn nested_dissection<'a, const D: usize>(
    nodes: &[usize],
    coordinates: &[[f64; D]],
    adjacency: impl Fn(usize) -> &'a [usize],
) -> Vec<usize> {
    let mut cutter = Cutter::new(coordinates, adjacency);
    let mut reversed = Vec::with_capacity(nodes.len());
    let mut stack = vec![nodes.to_vec()];
    // Reading the order backwards, a separator comes before its halves: one stack suffices.
    while let Some(set) = stack.pop() {
        let cut = (set.len() > LEAF).then(|| cutter.cut(&set)).flatten();
        let Some([left, separator, right]) = cut else {
            reversed.extend(set.iter().rev());
            continue;
        };
        reversed.extend(separator.iter().rev());
        stack.extend([left, right]);
    }
    reversed.reverse();
    reversed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: usize) -> (Vec<[f64; 2]>, Vec<Vec<usize>>) {
        let at = |i: usize, j: usize| j * n + i;
        let mut points = vec![[0.0; 2]; n * n];
        let mut adjacency = vec![Vec::new(); n * n];
        for j in 0..n {
            for i in 0..n {
                points[at(i, j)] = [i as f64, j as f64];
                for (k, l) in [(i + 1, j), (i, j + 1)] {
                    if k < n && l < n {
                        adjacency[at(i, j)].push(at(k, l));
                        adjacency[at(k, l)].push(at(i, j));
                    }
                }
            }
        }
        (points, adjacency)
    }

    /// Entries of the Cholesky factor under an order, by symbolic elimination.
    fn fill(order: &[usize], adjacency: &[Vec<usize>]) -> usize {
        let mut position = vec![usize::MAX; adjacency.len()];
        for (k, &a) in order.iter().enumerate() {
            position[a] = k;
        }
        let mut later: Vec<std::collections::BTreeSet<usize>> = order
            .iter()
            .map(|&a| {
                adjacency[a]
                    .iter()
                    .map(|&b| position[b])
                    .filter(|&p| p > position[a])
                    .collect()
            })
            .collect();
        let mut entries = 0;
        for k in 0..order.len() {
            entries += later[k].len();
            let column = later[k].clone();
            if let Some(&parent) = column.first() {
                later[parent].extend(column.iter().filter(|&&p| p > parent));
            }
        }
        entries
    }

    #[test]
    fn is_a_permutation_that_saves_fill() {
        let (points, adjacency) = grid(32);
        let all: Vec<usize> = (0..points.len()).collect();
        let order = nested_dissection(&all, &points, |a| &adjacency[a]);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, all);
        let (dissected, natural) = (fill(&order, &adjacency), fill(&all, &adjacency));
        assert!(
            3 * dissected < 2 * natural,
            "fill {dissected}, lexicographic {natural}"
        );
    }

    #[test]
    fn moving_the_nodes_costs_little() {
        let (mut points, adjacency) = grid(40);
        let all: Vec<usize> = (0..points.len()).collect();
        let entries = |points: &[[f64; 2]]| {
            fill(
                &nested_dissection(&all, points, |a| &adjacency[a]),
                &adjacency,
            )
        };
        let straight = entries(&points);
        // Lines through the nodes are lost, and cells towards a corner become small.
        for (a, x) in points.iter_mut().enumerate() {
            let wave = (12.9898 * a as f64).sin();
            *x = [
                (x[0] + 0.4 * wave).powi(2),
                (x[1] - 0.4 * wave.cos()).powi(2),
            ];
        }
        let moved = entries(&points);
        assert!(
            10 * moved <= 11 * straight,
            "fill {moved}, straight {straight}"
        );
    }

    #[test]
    fn coincident_nodes_and_subsets_are_ordered_once() {
        let points = vec![[1.0, 1.0]; 100];
        let subset: Vec<usize> = (10..90).collect();
        let mut order = nested_dissection(&subset, &points, |_| &[]);
        order.sort_unstable();
        assert_eq!(order, subset);
    }
}
