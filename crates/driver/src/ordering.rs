//! Fill-reducing order of the nodes by geometric nested dissection; not the factorisation.

/// Sets of at most this many nodes are not dissected further.
const LEAF: usize = 32;

/// Orders `nodes` by recursive bisection: halves first, the separator between them last, so that
/// eliminating a half never touches the other. Returns the nodes in their order of elimination.
///
/// `adjacency(a)` lists the neighbours of node a; those outside `nodes` are ignored.
pub(crate) fn nested_dissection<'a, const D: usize>(
    nodes: &[usize],
    coordinates: &[[f64; D]],
    adjacency: impl Fn(usize) -> &'a [usize],
) -> Vec<usize> {
    const SEPARATOR: u32 = u32::MAX;
    // The part of the dissection that a node belongs to; 0 is outside.
    let mut part = vec![0u32; coordinates.len()];
    for &a in nodes {
        part[a] = 1;
    }
    let mut parts = 1;
    let mut reversed = Vec::with_capacity(nodes.len());
    let mut stack = vec![(nodes.to_vec(), 1u32)];
    // Reading the order backwards, a separator comes before its halves: one stack suffices.
    while let Some((set, own)) = stack.pop() {
        let Some((axis, cut)) = (set.len() > LEAF)
            .then(|| bisector(&set, coordinates))
            .flatten()
        else {
            reversed.extend(set.iter().rev());
            continue;
        };
        let (left, right) = (parts + 1, parts + 2);
        parts += 2;
        for &a in &set {
            part[a] = if coordinates[a][axis] < cut {
                left
            } else {
                right
            };
        }
        debug_assert!(own != SEPARATOR);
        let border = |from: u32, to: u32| -> Vec<usize> {
            let touches =
                |&&a: &&usize| part[a] == from && adjacency(a).iter().any(|&b| part[b] == to);
            set.iter().filter(touches).copied().collect()
        };
        let (of_right, of_left) = (border(right, left), border(left, right));
        let separator = if of_right.len() <= of_left.len() {
            of_right
        } else {
            of_left
        };
        for &a in &separator {
            part[a] = SEPARATOR;
        }
        reversed.extend(separator.iter().rev());
        for side in [left, right] {
            let half: Vec<usize> = set.iter().copied().filter(|&a| part[a] == side).collect();
            if !half.is_empty() {
                stack.push((half, side));
            }
        }
    }
    reversed.reverse();
    reversed
}

/// Axis of the longest side of the set's box and the median coordinate on it; `None` if all nodes
/// have the same coordinates or the median does not split them.
fn bisector<const D: usize>(set: &[usize], coordinates: &[[f64; D]]) -> Option<(usize, f64)> {
    let extent = |k: usize| {
        let (low, high) = set
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &a| {
                (l.min(coordinates[a][k]), h.max(coordinates[a][k]))
            });
        high - low
    };
    let axis = (0..D).max_by(|&k, &l| extent(k).total_cmp(&extent(l)))?;
    let mut values: Vec<f64> = set.iter().map(|&a| coordinates[a][axis]).collect();
    let middle = values.len() / 2;
    let (below, &mut cut, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    below.iter().any(|&v| v < cut).then_some((axis, cut))
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
    fn coincident_nodes_and_subsets_are_ordered_once() {
        let points = vec![[1.0, 1.0]; 100];
        let subset: Vec<usize> = (10..90).collect();
        let mut order = nested_dissection(&subset, &points, |_| &[]);
        order.sort_unstable();
        assert_eq!(order, subset);
    }
}
