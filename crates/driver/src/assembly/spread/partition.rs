//! Which process holds which cell: by halving the graph of the cells, again and again; not what it does with it.

use moreau_mesh::Mesh;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// How many cells change sides for nothing before a pass of exchanges ends.
const IN_VAIN: usize = 200;
const PASSES: usize = 8;

/// Shares of the cells by process: the first holds besides about as much as a quarter of all cells takes, and sweeps its
/// unknowns while the others wait. So with equal sums on all of n it has 1 − n / 5 times what each other one has; some in
/// any case.
fn shares(processes: usize) -> Vec<usize> {
    let mut shares = vec![5; processes.max(1)];
    shares[0] = 5usize.saturating_sub(processes).max(1);
    shares
}

/// The process of every cell, of so many: parts by [`shares`], to one in a hundred of the cells at each halving, with few
/// nodes between them. A halving starts from several orders of the cells, along the axes and by the distance in the graph
/// from its end, and lets cells change sides as long as that leaves fewer nodes between: C. M. Fiduccia and R. M.
/// Mattheyses, *A linear-time heuristic for improving network partitions*, 19th Design Automation Conference (1982)
/// 175-181. It depends on nothing but the mesh.
pub(crate) fn partition<const D: usize>(mesh: &Mesh<D>, processes: usize) -> Vec<u32> {
    parts(mesh, &shares(processes))
}

/// The same by the shares of all processes.
fn parts<const D: usize>(mesh: &Mesh<D>, shares: &[usize]) -> Vec<u32> {
    let mut process = vec![0; mesh.cell_count()];
    let mut halving = Halving::new(mesh);
    let all: Vec<usize> = (0..mesh.cell_count()).collect();
    let mut parts = vec![(all, 0, shares)];
    while let Some((cells, first, shares)) = parts.pop() {
        if shares.len() == 1 {
            cells.iter().for_each(|&c| process[c] = first as u32);
            continue;
        }
        let (lower, higher) = shares.split_at(shares.len() / 2);
        let [of_lower, of_all] = [lower, shares].map(|s| s.iter().sum::<usize>());
        let [low, high] = halving.cut(&cells, (cells.len() * of_lower + of_all / 2) / of_all);
        parts.push((low, first, lower));
        parts.push((high, first + lower.len(), higher));
    }
    process
}

/// A set of cells that is cut in two, with room that is used again.
struct Halving<'m, const D: usize> {
    mesh: &'m Mesh<D>,
    /// Cells at each node: those of node a from `start[a]` on.
    cells: Vec<u32>,
    start: Vec<usize>,
    /// The half of a cell of the set.
    side: Vec<Option<bool>>,
    /// Cells of both halves at each node.
    held: Vec<[u32; 2]>,
    /// Nodes with cells of both halves, and cells of the lower one.
    between: usize,
    low: usize,
    /// Cells that have changed sides in this pass.
    moved: Vec<bool>,
}

impl<'m, const D: usize> Halving<'m, D> {
    fn new(mesh: &'m Mesh<D>) -> Self {
        let mut start = vec![0; mesh.nodes().len() + 1];
        let count = mesh.cell_count();
        (0..count).for_each(|c| mesh.cell_nodes(c).iter().for_each(|&a| start[a + 1] += 1));
        (1..start.len()).for_each(|a| start[a] += start[a - 1]);
        let mut next = start.clone();
        let mut cells = vec![0; start[start.len() - 1]];
        for c in 0..count {
            for &a in mesh.cell_nodes(c) {
                cells[next[a]] = c as u32;
                next[a] += 1;
            }
        }
        Self {
            mesh,
            cells,
            start,
            side: vec![None; count],
            held: vec![[0; 2]; mesh.nodes().len()],
            between: 0,
            low: 0,
            moved: vec![false; count],
        }
    }

    /// Two parts of a set, the first of about `lower` cells.
    fn cut(&mut self, set: &[usize], lower: usize) -> [Vec<usize>; 2] {
        let mut best: Option<(usize, Vec<Option<bool>>)> = None;
        for order in self.orders(set) {
            for (k, &cell) in order.iter().enumerate() {
                self.put(cell, Some(k >= lower));
            }
            self.exchange(set, lower);
            if best.as_ref().is_none_or(|(least, _)| self.between < *least) {
                let sides = set.iter().map(|&cell| self.side[cell]).collect();
                best = Some((self.between, sides));
            }
            set.iter().for_each(|&cell| self.put(cell, None));
        }
        let mut parts = [Vec::new(), Vec::new()];
        for (&cell, side) in set
            .iter()
            .zip(best.into_iter().flat_map(|(_, sides)| sides))
        {
            parts[usize::from(side == Some(true))].push(cell);
        }
        parts
    }

    /// The cells along every axis, and by the distance from one that is far from another.
    fn orders(&mut self, set: &[usize]) -> Vec<Vec<usize>> {
        let middle = |cell: usize, axis: usize| {
            let nodes = self.mesh.cell_nodes(cell);
            let sum: f64 = nodes.iter().map(|&a| self.mesh.nodes()[a][axis]).sum();
            sum / nodes.len() as f64
        };
        let along = |axis: usize| {
            let mut cells: Vec<(f64, usize)> =
                set.iter().map(|&cell| (middle(cell, axis), cell)).collect();
            cells.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            cells.into_iter().map(|(_, cell)| cell).collect()
        };
        let mut all: Vec<Vec<usize>> = (0..D).map(along).collect();
        // Two breadth-first searches lead to an end: twice the first is one to be safe.
        let mut first = set.first().copied();
        for _ in 0..2 {
            first = first.and_then(|cell| self.by_distance(set, cell).last().copied());
        }
        all.extend(first.map(|cell| self.by_distance(set, cell)));
        all
    }

    /// The cells of a set in the order of their distance from one of them; what does not hang together with it follows
    /// in the same way.
    fn by_distance(&mut self, set: &[usize], first: usize) -> Vec<usize> {
        // Those of the set that have not been reached.
        set.iter().for_each(|&cell| self.side[cell] = Some(false));
        let mut order = Vec::with_capacity(set.len());
        let mut queue = VecDeque::new();
        for &seed in std::iter::once(&first).chain(set) {
            if self.side[seed].take().is_some() {
                queue.push_back(seed);
            }
            while let Some(cell) = queue.pop_front() {
                order.push(cell);
                for &a in self.mesh.cell_nodes(cell) {
                    for &next in &self.cells[self.start[a]..self.start[a + 1]] {
                        if self.side[next as usize].take().is_some() {
                            queue.push_back(next as usize);
                        }
                    }
                }
            }
        }
        order
    }

    /// Puts a cell into a half, or takes it out of the set.
    fn put(&mut self, cell: usize, side: Option<bool>) {
        let old = std::mem::replace(&mut self.side[cell], side);
        let lies_low = |side| usize::from(side == Some(false));
        self.low = self.low + lies_low(side) - lies_low(old);
        for &a in self.mesh.cell_nodes(cell) {
            let held = &mut self.held[a];
            let shared = |held: &[u32; 2]| usize::from(held[0] > 0 && held[1] > 0);
            let before = shared(held);
            if let Some(old) = old {
                held[usize::from(old)] -= 1;
            }
            if let Some(new) = side {
                held[usize::from(new)] += 1;
            }
            self.between = self.between + shared(held) - before;
        }
    }

    /// How many nodes fewer there are between the halves when a cell changes sides.
    fn gain(&self, cell: usize) -> i32 {
        let Some(side) = self.side[cell] else {
            return 0;
        };
        let (own, other) = (usize::from(side), usize::from(!side));
        let nodes = self.mesh.cell_nodes(cell).iter();
        nodes
            .map(|&a| match (self.held[a][own], self.held[a][other]) {
                (1, 1..) => 1,
                (2.., 0) => -1,
                _ => 0,
            })
            .sum()
    }

    /// Lets cells change sides, the most useful first, each once in a pass; what is in vain is taken back.
    fn exchange(&mut self, set: &[usize], lower: usize) {
        let slack = set.len() / 100;
        for _ in 0..PASSES {
            let before = self.between;
            let (mut least, mut kept) = (before, 0);
            let mut moves: Vec<usize> = Vec::new();
            let mut queues = [BinaryHeap::new(), BinaryHeap::new()];
            for &cell in set {
                let at_border = |&a: &usize| self.held[a][0] > 0 && self.held[a][1] > 0;
                if self.mesh.cell_nodes(cell).iter().any(at_border) {
                    self.queue(cell, &mut queues);
                }
            }
            while moves.len() < kept + IN_VAIN {
                let Some(cell) = self.next(&mut queues, lower, slack + 1) else {
                    break;
                };
                self.put(cell, self.side[cell].map(|side| !side));
                self.moved[cell] = true;
                moves.push(cell);
                if self.between < least && self.low.abs_diff(lower) <= slack {
                    (least, kept) = (self.between, moves.len());
                }
                for &a in self.mesh.cell_nodes(cell) {
                    for k in self.start[a]..self.start[a + 1] {
                        self.queue(self.cells[k] as usize, &mut queues);
                    }
                }
            }
            for &cell in &moves[kept..] {
                self.put(cell, self.side[cell].map(|side| !side));
            }
            moves.iter().for_each(|&cell| self.moved[cell] = false);
            if least == before {
                return;
            }
        }
    }

    /// Lets a cell of the set wait for its turn, in the queue of its half.
    fn queue(&self, cell: usize, queues: &mut [BinaryHeap<(i32, Reverse<usize>)>; 2]) {
        if let Some(side) = self.side[cell]
            && !self.moved[cell]
        {
            queues[usize::from(side)].push((self.gain(cell), Reverse(cell)));
        }
    }

    /// The cell that is to change sides next, so that the halves are as large as they should be to within some cells.
    fn next(
        &self,
        queues: &mut [BinaryHeap<(i32, Reverse<usize>)>; 2],
        lower: usize,
        slack: usize,
    ) -> Option<usize> {
        // What was said of a cell before its neighbours moved is said again behind it.
        for (side, queue) in queues.iter_mut().enumerate() {
            while let Some(&(gain, Reverse(cell))) = queue.peek() {
                let stands = self.side[cell] == Some(side == 1) && self.gain(cell) == gain;
                if stands && !self.moved[cell] {
                    break;
                }
                queue.pop();
            }
        }
        let allowed = [self.low + slack > lower, self.low < lower + slack];
        let best = (0..2)
            .filter(|&side| allowed[side])
            .max_by_key(|&side| queues[side].peek().copied())?;
        queues[best].pop().map(|(_, Reverse(cell))| cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_mesh::{CellKind, block2, uniform};

    /// Nodes of several processes.
    fn shared<const D: usize>(mesh: &Mesh<D>, process: &[u32]) -> usize {
        let mut of = vec![None; mesh.nodes().len()];
        let mut shared = vec![false; mesh.nodes().len()];
        for (cell, &p) in process.iter().enumerate() {
            for &a in mesh.cell_nodes(cell) {
                shared[a] |= of[a].replace(p).is_some_and(|q| q != p);
            }
        }
        shared.into_iter().filter(|&s| s).count()
    }

    fn sizes(process: &[u32], processes: usize) -> Vec<usize> {
        let of = |p| process.iter().filter(|&&q| q as usize == p).count();
        (0..processes).map(of).collect()
    }

    #[test]
    fn parts_are_equally_large_and_lie_together() {
        let (x, y) = (uniform(0.0, 12.0, 12), uniform(0.0, 4.0, 4));
        let mesh = block2("block", CellKind::Quad4, &x, &y).expect("valid");
        for processes in 1..=7 {
            let of = parts(&mesh, &vec![1; processes]);
            let fair = 48 / processes;
            for own in sizes(&of, processes) {
                assert!(own >= fair && own <= fair + 2, "{own}");
            }
        }
        assert_eq!(shared(&mesh, &parts(&mesh, &[1; 2])), 5);
        assert_eq!(shared(&mesh, &parts(&mesh, &[1; 3])), 10);
        assert_eq!(partition(&mesh, 60).len(), 48);
    }

    #[test]
    fn the_first_process_has_fewer_cells_than_each_other_one() {
        let (x, y) = (uniform(0.0, 20.0, 20), uniform(0.0, 16.0, 16));
        let mesh = block2("block", CellKind::Quad4, &x, &y).expect("valid");
        for (processes, first, other) in [(2, 120, 200), (3, 53, 133), (4, 20, 100), (7, 10, 52)] {
            let all = sizes(&partition(&mesh, processes), processes);
            assert!(all[0].abs_diff(first) <= 6, "{all:?}");
            let fair = |&own: &usize| own.abs_diff(other) <= 8;
            assert!(all[1..].iter().all(fair), "{all:?}");
        }
        assert_eq!(sizes(&partition(&mesh, 1), 1), [320]);
        // Two cells are enough for two processes.
        let pair = block2("pair", CellKind::Quad4, &x[..3], &y[..2]).expect("valid");
        assert_eq!(sizes(&partition(&pair, 2), 2), [1, 1]);
    }

    /// A strip that is bent to a U: halving it along its longest side cuts both of its legs.
    #[test]
    fn a_bent_strip_is_cut_across_once() {
        let (x, y) = (uniform(0.0, 40.0, 40), uniform(0.0, 4.0, 4));
        let strip = block2("strip", CellKind::Quad4, &x, &y).expect("valid");
        let bent = strip
            .map(|[x, y]| match 20.0 - x {
                leg if leg.abs() > 5.0 => [leg.abs() - 5.0, -leg.signum() * (1.0 + y)],
                bend => {
                    let angle = std::f64::consts::FRAC_PI_2 * bend / 5.0;
                    [-(1.0 + y) * angle.cos(), -(1.0 + y) * angle.sin()]
                }
            })
            .expect("valid");
        let process = parts(&bent, &[1; 2]);
        assert_eq!(sizes(&process, 2), [80, 80]);
        assert_eq!(shared(&bent, &process), 5);
    }

    /// A staircase between the halves is straightened.
    #[test]
    fn fewer_nodes_are_between_than_along_any_axis() {
        let lines = uniform(0.0, 16.0, 16);
        let square = block2("square", CellKind::Quad4, &lines, &lines).expect("valid");
        let turned = square
            .map(|[x, y]| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y])
            .expect("valid");
        let process = parts(&turned, &[1; 2]);
        let along = (0..2).map(|axis| {
            let mut cells: Vec<usize> = (0..256).collect();
            let at = |c: usize| turned.nodes()[turned.cell_nodes(c)[0]][axis];
            cells.sort_by(|&a, &b| at(a).total_cmp(&at(b)));
            let mut process = vec![0; 256];
            cells[128..].iter().for_each(|&c| process[c] = 1);
            shared(&turned, &process)
        });
        let least = along.min().expect("two axes");
        assert!(shared(&turned, &process) < least && least > 20, "{least}");
        assert!(sizes(&process, 2)[0].abs_diff(128) <= 2);
    }
}
