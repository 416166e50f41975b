//! What a process does for conjugate gradients with the entries that it holds: its part of the coarse space, and
//! sweeps over the unknowns that it has alone; not the iteration.

use moreau_algebra::{CoarseSpace, EngineError, Matrix, Share, Unpacked};

/// The part of a process in a coarse space.
///
/// Unknowns of which one process alone has entries are swept there: those of different processes share no cell, so that
/// none of them waits for another. What is left is swept by the first process, to which the entries among them go.
#[derive(Debug)]
pub(crate) struct Coarsened {
    /// By own numbers of the unknowns, fine and coarse.
    space: CoarseSpace,
    /// Coarse unknown of the whole space of each own number, ascending.
    rows: Vec<u32>,
    /// Whether no other process has entries of an unknown.
    alone: Vec<bool>,
    /// Entries that go to the first process.
    handed: Vec<u32>,
}

impl Coarsened {
    /// From the rows of P at the unknowns of a matrix, each as a count, what it follows and how far, and from whether
    /// this process has it alone; `None` where they do not fit.
    pub(crate) fn new(matrix: &Matrix, order: &mut Unpacked<'_>) -> Option<Self> {
        let (counts, unknowns) = (order.indices(), order.indices());
        let (parts, alone) = (order.reals(), order.indices());
        let alone: Vec<bool> = alone.into_iter().map(|one| one == 1).collect();
        let mut rows = unknowns.clone();
        rows.sort_unstable();
        rows.dedup();
        let own = unknowns.iter().map(|unknown| rows.binary_search(unknown));
        let mut all = own.map(|own| own.unwrap_or(0) as u32).zip(parts);
        let followed = counts.iter();
        let followed: Vec<Vec<(u32, f64)>> = followed
            .map(|&count| all.by_ref().take(count as usize).collect())
            .collect();
        let pattern = &matrix.pattern;
        let space = CoarseSpace::new(pattern, rows.len(), followed).ok()?;
        let is_shared = |row: usize| alone.get(row) == Some(&false);
        let shared = (0..pattern.size()).filter(|&j| is_shared(j));
        let handed = shared.flat_map(|j| pattern.range(j));
        let handed = handed.filter(|&k| is_shared(pattern.rows()[k] as usize));
        let handed = handed.map(|k| k as u32).collect();
        (alone.len() == pattern.size()).then_some(Self {
            space,
            rows,
            alone,
            handed,
        })
    }

    /// Row and column of the entries that go to the first process, by the unknowns `rows` of the whole system.
    pub(crate) fn places(&self, matrix: &Matrix, rows: &[u32]) -> Vec<u32> {
        let pattern = &matrix.pattern;
        let columns = (0..pattern.size()).flat_map(|j| pattern.range(j).map(move |_| j));
        let columns: Vec<usize> = columns.collect();
        let place = |&k: &u32| {
            let (i, j) = (pattern.rows()[k as usize] as usize, columns[k as usize]);
            [rows[i], rows[j]]
        };
        self.handed.iter().flat_map(place).collect()
    }

    /// Takes those entries out of the matrix.
    pub(crate) fn hand_over(&self, matrix: &mut Matrix) -> Vec<f64> {
        let (_, values) = matrix.values_mut();
        let entries = self.handed.iter();
        entries
            .map(|&k| std::mem::take(&mut values[k as usize]))
            .collect()
    }

    /// Pᵀ A P of the entries.
    pub(crate) fn project(&mut self, matrix: &Matrix) -> Result<(), EngineError> {
        self.space.project(matrix)
    }

    /// The entries of the coarse space as a part of its whole matrix.
    pub(crate) fn share(&self) -> Share<'_> {
        Share {
            pattern: Some(&self.space.matrix().pattern),
            values: self.space.matrix().values(),
            rows: &self.rows,
        }
    }

    /// Spreads numbers at the unknowns that this process has alone: zero at the others.
    fn spread(&self, numbers: &[f64]) -> Vec<f64> {
        let mut numbers = numbers.iter();
        let all = self.alone.iter();
        all.map(|&alone| match alone {
            true => numbers.next().copied().unwrap_or(0.0),
            false => 0.0,
        })
        .collect()
    }

    /// Numbers at those unknowns out of numbers at all of them.
    fn gather(&self, all: &[f64]) -> Vec<f64> {
        let pairs = all.iter().zip(&self.alone);
        pairs
            .filter(|&(_, &alone)| alone)
            .map(|(x, _)| *x)
            .collect()
    }

    /// A sweep down over the first `limit` of them under loads there: what they do, and what that leaves at all unknowns.
    pub(crate) fn sweep_down(
        &self,
        matrix: &Matrix,
        limit: usize,
        load: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let load = self.spread(load);
        let (mut x, mut left) = (vec![0.0; load.len()], vec![0.0; load.len()]);
        let moves = |row: usize| row < limit && self.alone[row];
        matrix.sweep_down(&load, moves, &mut x, &mut left);
        (self.gather(&x), left)
    }

    /// The sweep back, from displacements of all unknowns.
    pub(crate) fn sweep_up(
        &self,
        matrix: &Matrix,
        limit: usize,
        load: &[f64],
        mut x: Vec<f64>,
    ) -> Vec<f64> {
        let moves = |row: usize| row < limit && self.alone[row];
        if x.len() == self.alone.len() {
            matrix.sweep_up(&mut self.spread(load), moves, &mut x);
        }
        self.gather(&x)
    }
}
