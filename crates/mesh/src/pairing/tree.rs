//! Search of boxes that overlap a box, by a binary tree of bounding boxes; not of what is in them.

use super::face::Aabb;

/// A tree of boxes, halved at the median along the longest side.
pub(super) struct Tree<const D: usize> {
    boxes: Vec<Aabb<D>>,
    /// The boxes in the order of the tree.
    order: Vec<usize>,
    branches: Vec<Branch<D>>,
}

/// The boxes `order[first..last]` and the box around them; the first half is the next branch.
struct Branch<const D: usize> {
    around: Aabb<D>,
    first: usize,
    last: usize,
    /// Branch of the second half; `None` at a leaf.
    second: Option<usize>,
}

/// Boxes in a leaf.
const LEAF: usize = 4;

impl<const D: usize> Tree<D> {
    pub(super) fn new(boxes: Vec<Aabb<D>>) -> Self {
        let mut tree = Self {
            order: (0..boxes.len()).collect(),
            branches: Vec::new(),
            boxes,
        };
        tree.halve(0, tree.boxes.len());
        tree
    }

    /// Adds the branch of a range, and those of its halves.
    fn halve(&mut self, first: usize, last: usize) {
        let join = |(low, high): Aabb<D>, &k: &usize| {
            let (l, h) = self.boxes[k];
            (
                std::array::from_fn(|i| f64::min(low[i], l[i])),
                std::array::from_fn(|i| f64::max(high[i], h[i])),
            )
        };
        let nothing = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        let (low, high) = self.order[first..last].iter().fold(nothing, join);
        let branch = self.branches.len();
        self.branches.push(Branch {
            around: (low, high),
            first,
            last,
            second: None,
        });
        if last - first <= LEAF {
            return;
        }
        let span = |i: &usize| high[*i] - low[*i];
        let axis = (0..D)
            .max_by(|a, b| span(a).total_cmp(&span(b)))
            .unwrap_or(0);
        let center = |k: usize| self.boxes[k].0[axis] + self.boxes[k].1[axis];
        self.order[first..last].sort_by(|&a, &b| center(a).total_cmp(&center(b)));
        let middle = first.midpoint(last);
        self.halve(first, middle);
        self.branches[branch].second = Some(self.branches.len());
        self.halve(middle, last);
    }

    /// The boxes that overlap one, ascending.
    pub(super) fn within(&self, target: &Aabb<D>) -> Vec<usize> {
        let mut found = Vec::new();
        let mut open = vec![0];
        while let Some(k) = open.pop() {
            let branch = &self.branches[k];
            if !overlap(&branch.around, target) {
                continue;
            }
            match branch.second {
                Some(second) => open.extend([k + 1, second]),
                None => {
                    let leaf = self.order[branch.first..branch.last].iter();
                    found.extend(leaf.filter(|&&k| overlap(&self.boxes[k], target)));
                }
            }
        }
        found.sort_unstable();
        found
    }
}

fn overlap<const D: usize>(a: &Aabb<D>, b: &Aabb<D>) -> bool {
    (0..D).all(|i| a.0[i] <= b.1[i] && b.0[i] <= a.1[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn finds_what_a_walk_over_all_finds(
            corners in prop::collection::vec((prop::array::uniform2(0.0..10.0f64), 0.0..1.5f64), 0..60),
            low in prop::array::uniform2(0.0..10.0f64),
            size in 0.0..5.0f64,
        ) {
            let boxes: Vec<Aabb<2>> = corners.iter().map(|(c, s)| (*c, c.map(|v| v + s))).collect();
            let target = (low, low.map(|v| v + size));
            let all: Vec<usize> = (0..boxes.len()).filter(|&k| overlap(&boxes[k], &target)).collect();
            prop_assert_eq!(Tree::new(boxes).within(&target), all);
        }
    }
}
