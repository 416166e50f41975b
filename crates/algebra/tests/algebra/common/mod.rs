//! Matrices of all kinds, sparse and dense, for the tests of this crate.
// Not every test uses all of them.
#![allow(dead_code, unreachable_pub, missing_docs)]

pub mod promises;

use moreau_algebra::{Pattern, nested_dissection};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// A symmetric matrix, sparse and dense.
#[derive(Debug, Clone)]
pub struct Sample {
    pub pattern: Pattern,
    pub values: Vec<f64>,
    pub dense: DMatrix<f64>,
}

impl Sample {
    /// The entries of a dense symmetric matrix that are not zero, and its diagonal.
    pub fn new(dense: DMatrix<f64>) -> Self {
        let n = dense.nrows();
        let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            for i in j..n {
                if i == j || dense[(i, j)] != 0.0 {
                    rows.push(i as u32);
                    values.push(dense[(i, j)]);
                }
            }
            start.push(rows.len() as u32);
        }
        let pattern = Pattern::new(start, rows).expect("ascending");
        Self {
            pattern,
            values,
            dense,
        }
    }

    pub fn keeping(mut self, kept: usize) -> Self {
        self.pattern = self.pattern.keeping(kept).expect("so many");
        self
    }

    pub fn size(&self) -> usize {
        self.dense.nrows()
    }

    /// Eigenvalues over the largest, ascending.
    pub fn eigenvalues(&self) -> Vec<f64> {
        if self.size() == 0 {
            return Vec::new();
        }
        let values = self.dense.clone().symmetric_eigenvalues();
        let largest = values.amax();
        let mut all: Vec<f64> = values.iter().map(|v| v / largest).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Numbers in no order, always the same.
    pub fn right_hand_sides(&self, columns: usize) -> DMatrix<f64> {
        let n = self.size();
        DMatrix::from_fn(n, columns, |i, j| ((7 * i + 31 * j) as f64).sin() + 0.1)
    }

    /// Largest residual over the size of its terms.
    pub fn residual(&self, x: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
        if self.size() == 0 {
            return 0.0;
        }
        let size = self.dense.amax() * x.amax() * (self.size() as f64).sqrt() + b.amax();
        (&self.dense * x - b).amax() / size
    }
}

/// A graph and numbers for its edges.
pub fn graph(sizes: std::ops::Range<usize>) -> impl Strategy<Value = DMatrix<f64>> {
    let entries = |n: usize| {
        let edges = prop::collection::vec((0..n, 0..n, -1.0..1.0f64), 0..=3 * n);
        (Just(n), edges)
    };
    sizes.prop_flat_map(entries).prop_map(|(n, edges)| {
        let mut a = DMatrix::zeros(n, n);
        for (i, j, v) in edges {
            (a[(i, j)], a[(j, i)]) = (v, v);
        }
        a
    })
}

/// Positive definite: diagonally dominant, on any graph.
pub fn definite(sizes: std::ops::Range<usize>) -> impl Strategy<Value = Sample> {
    graph(sizes).prop_map(|mut a| {
        for i in 0..a.nrows() {
            a[(i, i)] = 0.5 + a.row(i).iter().map(|v| v.abs()).sum::<f64>();
        }
        Sample::new(a)
    })
}

/// Anything, on any graph; much of the diagonal is zero.
pub fn indefinite(sizes: std::ops::Range<usize>) -> impl Strategy<Value = Sample> {
    graph(sizes).prop_map(Sample::new)
}

/// [A Bᵀ; B −C] with A definite, rows of B that are independent, and C zero but for some of its diagonal, in an
/// order that mixes them; the number of rows of B.
pub fn saddle(sizes: std::ops::Range<usize>) -> impl Strategy<Value = (Sample, usize)> {
    let order = |a: Sample| {
        let n = a.size();
        let rows = prop::collection::vec((0..n, -1.0..1.0f64, 0..2u8), 1..=n.max(2) / 2);
        (Just(a), rows)
    };
    let shuffled = definite(sizes)
        .prop_flat_map(order)
        .prop_flat_map(|(a, rows)| {
            let all: Vec<usize> = (0..a.size() + rows.len()).collect();
            (Just(a), Just(rows), Just(all).prop_shuffle())
        });
    shuffled.prop_map(|(a, rows, order)| {
        let (n, m) = (a.size(), rows.len());
        let mut k = DMatrix::zeros(n + m, n + m);
        k.view_mut((0, 0), (n, n)).copy_from(&a.dense);
        for (r, &(at, b, compliant)) in rows.iter().enumerate() {
            // Each row has an unknown that no later one has: n ≥ m of them.
            for (i, b) in [(r, 1.0), ((r + 1 + at % n.max(1)).min(n - 1), b)] {
                if i == r || i >= m {
                    (k[(n + r, i)], k[(i, n + r)]) = (b, b);
                }
            }
            k[(n + r, n + r)] = -f64::from(compliant);
        }
        let mixed = DMatrix::from_fn(n + m, n + m, |i, j| k[(order[i], order[j])]);
        (Sample::new(mixed), m)
    })
}

/// Seven-point Laplacian of a cube of nodes in nested-dissection order, with `held` on every diagonal.
pub fn laplacian(n: usize, held: f64) -> (Pattern, Vec<f64>) {
    let at = |k: usize| [k % n, k / n % n, k / (n * n)];
    let points: Vec<[f64; 3]> = (0..n * n * n).map(|k| at(k).map(|i| i as f64)).collect();
    let step = [1, n, n * n];
    let beside = |k: usize| -> Vec<usize> {
        let axis = |a: usize| {
            let below = (at(k)[a] > 0).then(|| k - step[a]);
            let above = (at(k)[a] + 1 < n).then(|| k + step[a]);
            below.into_iter().chain(above)
        };
        (0..3).flat_map(axis).collect()
    };
    let adjacency: Vec<Vec<usize>> = (0..n * n * n).map(beside).collect();
    let all: Vec<usize> = (0..n * n * n).collect();
    let order = nested_dissection(&all, &points, |a| &adjacency[a]);
    let mut position = vec![0; order.len()];
    for (k, &a) in order.iter().enumerate() {
        position[a] = k as u32;
    }
    let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (k, &a) in order.iter().enumerate() {
        let mut below: Vec<u32> = adjacency[a].iter().map(|&b| position[b]).collect();
        below.retain(|&i| i as usize > k);
        below.sort_unstable();
        values.push(adjacency[a].len() as f64 + held);
        values.extend(below.iter().map(|_| -1.0));
        rows.push(k as u32);
        rows.extend(below);
        start.push(rows.len() as u32);
    }
    (Pattern::new(start, rows).expect("ascending"), values)
}

/// Size of a vector.
pub fn norm(x: &[f64]) -> f64 {
    DVector::from_column_slice(x).norm()
}
