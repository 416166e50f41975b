//! A small set of nodes between two halves of a set: the surface of a plane or a sphere through its
//! middle, then the minimum cut of the graph in a band around it; not the recursion.

/// Half of the width of the band, as a share of the nodes.
const BAND: f64 = 0.1;

/// Where a node of the set under way lies; the nodes of no set are outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Outside,
    Left,
    Right,
    Between,
}

/// No node: the beginning of a path, or a level that is not reached.
const NONE: u32 = u32::MAX;

/// What cutting needs, with room that is used again. The flow has a unit of capacity in every node
/// of the band: state 2b enters the band's node b, state 2b + 1 leaves it.
pub(super) struct Cutter<'c, const D: usize, A> {
    coordinates: &'c [[f64; D]],
    adjacency: A,
    side: Vec<Side>,
    /// Number in the band of a node that is in it.
    number: Vec<u32>,
    band: Vec<usize>,
    /// Whether a path runs through a node of the band, and from which it comes.
    used: Vec<bool>,
    from: Vec<u32>,
    /// Distance of a state from the left half.
    level: Vec<u32>,
    queue: Vec<u32>,
    /// How many arcs out of a node have been tried.
    tried: Vec<usize>,
}

impl<'a, 'c, const D: usize, A: Fn(usize) -> &'a [usize]> Cutter<'c, D, A> {
    pub(super) fn new(coordinates: &'c [[f64; D]], adjacency: A) -> Self {
        Self {
            coordinates,
            adjacency,
            side: vec![Side::Outside; coordinates.len()],
            number: vec![NONE; coordinates.len()],
            band: Vec::new(),
            used: Vec::new(),
            from: Vec::new(),
            level: Vec::new(),
            queue: Vec::new(),
            tried: Vec::new(),
        }
    }

    /// Left half, separator and right half of a set: no node of one half has a neighbour in the
    /// other. `None` if nothing divides the set.
    pub(super) fn cut(&mut self, set: &[usize]) -> Option<[Vec<usize>; 3]> {
        let mut best: Option<(f64, Vec<Side>, Vec<f64>)> = None;
        for surface in 0..=D {
            let values = self.values(set, surface);
            self.divide(set, &values);
            let sides = self.sides(set);
            if let Some(cost) = cost(&sides)
                && best.as_ref().is_none_or(|(least, ..)| cost < *least)
            {
                best = Some((cost, sides, values));
            }
        }
        if let Some((least, sides, values)) = &mut best {
            self.narrow(set, values);
            let narrow = self.sides(set);
            if cost(&narrow).is_some_and(|cost| cost < *least) {
                *sides = narrow;
            }
        }
        for &a in set {
            self.side[a] = Side::Outside;
        }
        let (_, sides, _) = best?;
        let of = |side| {
            let chosen = set.iter().zip(&sides).filter(|(_, s)| **s == side);
            chosen.map(|(a, _)| *a).collect()
        };
        Some([of(Side::Left), of(Side::Between), of(Side::Right)])
    }

    fn sides(&self, set: &[usize]) -> Vec<Side> {
        set.iter().map(|&a| self.side[a]).collect()
    }

    /// A number for every node whose level sets are the surfaces: a coordinate, or the distance from
    /// the nodes' median.
    fn values(&self, set: &[usize], surface: usize) -> Vec<f64> {
        let coordinate = |k: usize| set.iter().map(move |&a| self.coordinates[a][k]);
        if surface < D {
            return coordinate(surface).collect();
        }
        let middle: [f64; D] = std::array::from_fn(|k| {
            let mut all: Vec<f64> = coordinate(k).collect();
            let half = all.len() / 2;
            *all.select_nth_unstable_by(half, f64::total_cmp).1
        });
        let squared = |&a: &usize| {
            let x = self.coordinates[a].iter().zip(&middle);
            x.map(|(x, m)| (x - m) * (x - m)).sum()
        };
        set.iter().map(squared).collect()
    }

    /// Divides at the median of the values; the smaller of the two borders is between.
    fn divide(&mut self, set: &[usize], values: &[f64]) {
        let mut sorted = values.to_vec();
        let (_, &mut cut, _) = sorted.select_nth_unstable_by(set.len() / 2, f64::total_cmp);
        for (&a, &value) in set.iter().zip(values) {
            self.side[a] = if value < cut { Side::Left } else { Side::Right };
        }
        let [left, right] = [(Side::Left, Side::Right), (Side::Right, Side::Left)]
            .map(|(own, other)| self.border(set, own, other));
        for a in if right.len() <= left.len() {
            right
        } else {
            left
        } {
            self.side[a] = Side::Between;
        }
    }

    /// Nodes of a side with a neighbour on another.
    fn border(&self, set: &[usize], own: Side, other: Side) -> Vec<usize> {
        let of_own = set.iter().filter(|&&a| self.side[a] == own);
        of_own
            .copied()
            .filter(|&a| self.touches(a, other))
            .collect()
    }

    fn touches(&self, a: usize, side: Side) -> bool {
        (self.adjacency)(a).iter().any(|&b| self.side[b] == side)
    }

    /// Divides at the minimum cut of a band on both sides of the median.
    fn narrow(&mut self, set: &[usize], values: &[f64]) {
        let mut order: Vec<usize> = (0..set.len()).collect();
        order.sort_unstable_by(|&i, &j| values[i].total_cmp(&values[j]).then(i.cmp(&j)));
        let n = set.len() as f64;
        let [low, high] = [0.5 - BAND, 0.5 + BAND].map(|share| (share * n) as usize);
        for (rank, &i) in order.iter().enumerate() {
            self.side[set[i]] = if rank < low {
                Side::Left
            } else if rank < high {
                Side::Between
            } else {
                Side::Right
            };
        }
        // An edge across the whole band has one end in it.
        for a in self.border(set, Side::Left, Side::Right) {
            self.side[a] = Side::Between;
        }
        self.band.clear();
        let between = set.iter().filter(|&&a| self.side[a] == Side::Between);
        self.band.extend(between);
        for (b, &a) in self.band.iter().enumerate() {
            self.number[a] = b as u32;
        }
        let size = self.band.len();
        self.used.clear();
        self.used.resize(size, false);
        self.from.clear();
        self.from.resize(size, NONE);
        let of_left = |&b: &usize| self.touches(self.band[b], Side::Left);
        let starts: Vec<usize> = (0..size).filter(of_left).collect();
        while self.levels(&starts) {
            self.tried.clear();
            self.tried.resize(size, 0);
            for &b in &starts {
                self.augment(b);
            }
        }
        for b in 0..size {
            let reached = [2 * b, 2 * b + 1].map(|state| self.level[state] != NONE);
            self.side[self.band[b]] = match reached {
                [_, true] => Side::Left,
                [true, false] => Side::Between,
                [false, false] => Side::Right,
            };
        }
    }

    /// Distances of the states from the left half in what the paths so far leave; whether the right
    /// half is reached.
    fn levels(&mut self, starts: &[usize]) -> bool {
        self.level.clear();
        self.level.resize(2 * self.band.len(), NONE);
        self.queue.clear();
        for &b in starts {
            self.reach(2 * b, 0);
        }
        let mut arrived = false;
        let mut next = 0;
        while let Some(&state) = self.queue.get(next) {
            next += 1;
            let (state, b) = (state as usize, state as usize / 2);
            let level = self.level[state] + 1;
            if state % 2 == 0 {
                if let Some(on) = self.through(b) {
                    self.reach(on, level);
                }
                continue;
            }
            if self.used[b] {
                self.reach(2 * b, level);
            }
            let a = self.band[b];
            for &c in (self.adjacency)(a) {
                match self.side[c] {
                    Side::Right => arrived = true,
                    Side::Between => self.reach(2 * self.number[c] as usize, level),
                    _ => {}
                }
            }
        }
        arrived
    }

    fn reach(&mut self, state: usize, level: u32) {
        if self.level[state] == NONE {
            self.level[state] = level;
            self.queue.push(state as u32);
        }
    }

    /// The only state after entering a node: leaving it, or back along the path that is there.
    fn through(&self, b: usize) -> Option<usize> {
        match (self.used[b], self.from[b]) {
            (false, _) => Some(2 * b + 1),
            (true, NONE) => None,
            (true, from) => Some(2 * from as usize + 1),
        }
    }

    /// Seeks one more path from a node at the left half, level by level.
    fn augment(&mut self, start: usize) {
        let mut path = vec![2 * start];
        while let Some(&state) = path.last() {
            let (b, level) = (state / 2, self.level[state] + 1);
            let mut on = None;
            if state % 2 == 0 {
                // There is but one way on: once it has failed, the level is taken away.
                on = self.through(b).filter(|&s| self.level[s] == level);
            } else {
                let neighbours = (self.adjacency)(self.band[b]);
                while on.is_none() && self.tried[b] <= neighbours.len() {
                    let arc = self.tried[b];
                    self.tried[b] += 1;
                    let state = match neighbours.get(arc) {
                        None if self.used[b] => 2 * b,
                        None => continue,
                        Some(&c) => match self.side[c] {
                            Side::Right => {
                                self.lay(&path);
                                return;
                            }
                            Side::Between => 2 * self.number[c] as usize,
                            _ => continue,
                        },
                    };
                    on = (self.level[state] == level).then_some(state);
                }
            }
            match on {
                Some(state) => path.push(state),
                None => {
                    self.level[state] = NONE;
                    path.pop();
                }
            }
        }
    }

    /// Lays a path; where it runs backwards along another, both change their ends.
    fn lay(&mut self, path: &[usize]) {
        self.from[path[0] / 2] = NONE;
        for arc in path.windows(2) {
            let (b, c) = (arc[0] / 2, arc[1] / 2);
            match (arc[0] % 2, arc[1] % 2) {
                (0, _) if b == c => self.used[b] = true,
                (1, _) if b == c => self.used[b] = false,
                (1, _) => self.from[c] = b as u32,
                _ => {}
            }
        }
        // Every state carries one unit at most in a round.
        for &state in path {
            self.level[state] = NONE;
        }
    }
}

/// What a separator costs: its size over the geometric mean of the halves' sizes. `None` if a half
/// is empty.
fn cost(sides: &[Side]) -> Option<f64> {
    let count = |side| sides.iter().filter(|s| **s == side).count() as f64;
    let halves = count(Side::Left) * count(Side::Right);
    (halves > 0.0).then(|| count(Side::Between) / halves.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(points: &[[f64; 2]], edges: &[(usize, usize)]) -> Option<[Vec<usize>; 3]> {
        let mut adjacency = vec![Vec::new(); points.len()];
        for &(a, b) in edges {
            adjacency[a].push(b);
            adjacency[b].push(a);
        }
        let all: Vec<usize> = (0..points.len()).collect();
        let mut cutter = Cutter::new(points, |a| &adjacency[a][..]);
        let halves = cutter.cut(&all);
        assert!(cutter.side.iter().all(|side| *side == Side::Outside));
        halves
    }

    #[test]
    fn the_neck_between_two_blocks_is_found_off_the_middle() {
        // Columns of ten nodes, but of one at the neck, a few columns from the median.
        let (columns, neck, height) = (41, 18, 10);
        let at = |i: usize, j: usize| i * height + j;
        let mut points = vec![[0.0; 2]; columns * height];
        let mut edges = Vec::new();
        for i in 0..columns {
            for j in 0..height {
                points[at(i, j)] = [i as f64, 0.1 * j as f64];
                let right = i + 1 < columns && (j == 0 || (i != neck && i + 1 != neck));
                edges.extend(right.then(|| (at(i, j), at(i + 1, j))));
                let up = j + 1 < height && (i != neck || j > 0);
                edges.extend(up.then(|| (at(i, j), at(i, j + 1))));
            }
        }
        let [left, between, right] = cut(&points, &edges).expect("divided");
        assert_eq!(between.len(), 1);
        assert!(left.len().min(right.len()) >= columns * height * 4 / 10);
    }

    proptest! {
        #[test]
        fn halves_never_touch(
            points in prop::collection::vec([0.0..1.0f64, 0.0..1.0f64], 12..150),
            reach in 0.05..0.5f64,
        ) {
            let n = points.len();
            let near = |a: usize, b: usize| {
                (points[a][0] - points[b][0]).hypot(points[a][1] - points[b][1]) < reach
            };
            let edges: Vec<(usize, usize)> = (0..n)
                .flat_map(|a| (0..a).map(move |b| (a, b)))
                .filter(|&(a, b)| near(a, b))
                .collect();
            let Some([left, between, right]) = cut(&points, &edges) else {
                return Ok(());
            };
            let mut all = [&left[..], &between, &right].concat();
            all.sort_unstable();
            prop_assert!(all.iter().copied().eq(0..n));
            prop_assert!(!left.is_empty() && !right.is_empty());
            for &a in &left {
                for &b in &right {
                    prop_assert!(!edges.contains(&(a.max(b), a.min(b))), "{} and {}", a, b);
                }
            }
        }
    }
}
