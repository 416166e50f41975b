//! Sparse Cholesky factorisation with kept symbolic work and buffers; not the order of the unknowns.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{simplicial, supernodal};
use nalgebra::{DMatrix, DVector};
use std::fmt;

use crate::pattern::Pattern;

/// A pivot that is not positive: the matrix is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the pivot of row {row} is not positive")]
pub struct NotPositiveDefinite {
    /// Row of the pivot in the order of the matrix.
    pub row: usize,
}

/// What a factor takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Entries.
    pub entries: f64,
    /// Multiplications of a factorisation.
    pub operations: f64,
}

/// A factor that is not made, or that there is no room for.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the factor has {entries:.3e} entries, and there is room for {room:.3e}")]
pub struct TooLarge {
    /// Entries of the factor.
    pub entries: f64,
    /// Entries that there is room for.
    pub room: f64,
}

/// L Lᵀ = A, in the order in which A is given.
pub struct Cholesky {
    size: usize,
    symbolic: supernodal::SymbolicSupernodalCholesky<u32>,
    factor: Vec<f64>,
    memory: MemBuffer,
    /// Room for the rows below a supernode.
    below: Vec<f64>,
    /// Multiplications of a factorisation.
    operations: f64,
    par: Par,
}

/// Operations from which on a factorisation runs on all threads: some seconds, for threads have to
/// wait for each other, and on a busy machine long.
const PARALLEL: f64 = 1e11;

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
            .field("size", &self.size)
            .field("entries", &self.factor.len())
            .finish_non_exhaustive()
    }
}

impl Cholesky {
    /// Symbolic factorisation, once for a pattern; the factor may take `memory` \[bytes\].
    ///
    /// # Errors
    /// [`TooLarge`] if it takes more, more than a 32-bit index counts, or more than is `accepted`.
    pub fn analyse(
        pattern: &Pattern,
        memory: Option<u64>,
        accepted: impl FnOnce(Cost) -> bool,
    ) -> Result<Self, TooLarge> {
        let threads = |operations| {
            if operations > PARALLEL {
                Par::rayon(0)
            } else {
                Par::Seq
            }
        };
        Self::analyse_for(pattern, threads, (memory, accepted))
    }

    /// What the factor of a pattern takes.
    pub fn cost(pattern: &Pattern) -> Cost {
        let mut cost = None;
        let _ = Self::analyse(pattern, None, |found| {
            cost = Some(found);
            false
        });
        // There is none where not even the indices have room.
        cost.unwrap_or(Cost {
            entries: f64::INFINITY,
            operations: f64::INFINITY,
        })
    }

    /// The threads may depend on the number of operations.
    fn analyse_for(
        pattern: &Pattern,
        threads: impl Fn(f64) -> Par,
        (free, accepted): (Option<u64>, impl FnOnce(Cost) -> bool),
    ) -> Result<Self, TooLarge> {
        let n = pattern.size();
        let upper = pattern.transposed();
        let request = StackReq::or(
            simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, pattern.entries()),
            supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n),
        );
        let by_free = free.map_or(f64::INFINITY, |bytes| {
            bytes as f64 / size_of::<f64>() as f64
        });
        let room = by_free.min(f64::from(u32::MAX));
        let too_large = |entries: f64| TooLarge { entries, room };
        let mut memory = MemBuffer::try_new(request).map_err(|_| too_large(n as f64))?;
        let (mut tree, mut counts) = (vec![0i32; n], vec![0u32; n]);
        let tree = simplicial::prefactorize_symbolic_cholesky(
            &mut tree,
            &mut counts,
            upper.as_ref(),
            MemStack::new(&mut memory),
        );
        let counted = || counts.iter().map(|&count| f64::from(count));
        let entries: f64 = counted().sum();
        let operations: f64 = counted().map(|count| count * count).sum();
        let cost = Cost {
            entries,
            operations,
        };
        if entries > room || !accepted(cost) {
            return Err(too_large(entries));
        }
        let symbolic = supernodal::factorize_supernodal_symbolic_cholesky(
            upper.as_ref(),
            tree,
            &counts,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .map_err(|_| too_large(entries))?;
        let rows = symbolic.col_ptr_for_row_idx().windows(2);
        let below = rows.map(|r| (r[1] - r[0]) as usize).max().unwrap_or(0);
        let par = threads(operations);
        let request = supernodal::factorize_supernodal_numeric_llt_scratch::<u32, f64>(
            &symbolic,
            par,
            Default::default(),
        );
        let entries = symbolic.len_val() as f64;
        let mut factor = Vec::new();
        let reserved = factor.try_reserve_exact(symbolic.len_val());
        if entries > room || reserved.is_err() {
            return Err(too_large(entries));
        }
        factor.resize(symbolic.len_val(), 0.0);
        Ok(Self {
            size: n,
            factor,
            memory: MemBuffer::try_new(request).map_err(|_| too_large(entries))?,
            below: vec![0.0; below],
            operations,
            par,
            symbolic,
        })
    }

    /// Entries stored of the factor, with the zeros that make its columns alike.
    pub fn entries(&self) -> usize {
        self.factor.len()
    }

    /// Multiplications of a factorisation.
    pub fn operations(&self) -> f64 {
        self.operations
    }

    /// Factorises the matrix with these values on the pattern that was analysed.
    pub fn factorise(
        &mut self,
        pattern: &Pattern,
        values: &[f64],
    ) -> Result<(), NotPositiveDefinite> {
        // Threads share out the entries of the dense updates, not their sums: the factor is the same
        // to the bit wherever it runs.
        supernodal::factorize_supernodal_numeric_llt(
            &mut self.factor,
            SparseColMatRef::new(pattern.lower.as_ref(), values),
            Default::default(),
            &self.symbolic,
            self.par,
            MemStack::new(&mut self.memory),
            Default::default(),
        )
        .map(|_| ())
        .map_err(|LltError::NonPositivePivot { index }| NotPositiveDefinite { row: index })
    }

    /// The least pivot over what the diagonal of the matrix was there: of the size of rounding where the
    /// matrix is singular.
    pub fn least_pivot(&self, pattern: &Pattern, values: &[f64]) -> f64 {
        let mut least = f64::INFINITY;
        for s in 0..self.symbolic.n_supernodes() {
            let (start, width, rows, factor) = self.supernode(s);
            for (j, column) in factor.chunks_exact(width + rows.len()).enumerate() {
                let pivot = column[j] * column[j];
                least = least.min(pivot / values[pattern.diagonal(start + j)]);
            }
        }
        least
    }

    /// First column, number of columns, rows below and values, column by column, of supernode s.
    fn supernode(&self, s: usize) -> (usize, usize, &[u32], &[f64]) {
        let all = &self.symbolic;
        let (start, end) = (all.supernode_begin()[s], all.supernode_end()[s]);
        let width = (end - start) as usize;
        let (at, of) = (all.col_ptr_for_val(), all.col_ptr_for_row_idx());
        let values = &self.factor[at[s] as usize..at[s + 1] as usize];
        let below = values.len().checked_div(width).unwrap_or(0) - width;
        let rows = &all.row_idx()[of[s] as usize..][..below];
        (start as usize, width, rows, values)
    }

    /// x ← L⁻¹ x.
    pub fn forward(&mut self, x: &mut [f64]) {
        let mut below = std::mem::take(&mut self.below);
        for s in 0..self.symbolic.n_supernodes() {
            let (start, width, rows, values) = self.supernode(s);
            let height = width + rows.len();
            let own = &mut x[start..start + width];
            for (j, column) in values.chunks_exact(height).enumerate() {
                let solved = own[j] / column[j];
                own[j] = solved;
                for (x, l) in own[j + 1..].iter_mut().zip(&column[j + 1..width]) {
                    *x -= l * solved;
                }
            }
            let sum = &mut below[..rows.len()];
            sum.fill(0.0);
            let columns = values.chunks(TOGETHER * height);
            for (columns, own) in columns.zip(own.chunks(TOGETHER)) {
                add_product(columns, (width, height), own, sum);
            }
            for (&i, sum) in rows.iter().zip(sum) {
                x[i as usize] -= *sum;
            }
        }
        self.below = below;
    }

    /// x ← L⁻ᵀ x.
    pub fn backward(&mut self, x: &mut [f64]) {
        let mut below = std::mem::take(&mut self.below);
        for s in (0..self.symbolic.n_supernodes()).rev() {
            let (start, width, rows, values) = self.supernode(s);
            let height = width + rows.len();
            let known = &mut below[..rows.len()];
            for (&i, known) in rows.iter().zip(known.iter_mut()) {
                *known = x[i as usize];
            }
            let own = &mut x[start..start + width];
            let columns = values.chunks(TOGETHER * height);
            for (columns, own) in columns.zip(own.chunks_mut(TOGETHER)) {
                subtract_products(columns, (width, height), known, own);
            }
            for (j, column) in values.chunks_exact(height).enumerate().rev() {
                let sum = dot(&column[j + 1..width], &own[j + 1..]);
                own[j] = (own[j] - sum) / column[j];
            }
        }
        self.below = below;
    }

    /// Hands on row, column and value of the entries of the last `size` rows and columns of L, both
    /// counted from their first.
    #[inline]
    fn trailing_entries(&self, size: usize, mut each: impl FnMut(usize, usize, f64)) {
        let first = self.size - size;
        for s in (0..self.symbolic.n_supernodes()).rev() {
            let (start, width, rows, values) = self.supernode(s);
            if start + width <= first {
                break;
            }
            let columns = values.chunks_exact(width + rows.len());
            for (j, column) in (start..).zip(columns).filter(|(j, _)| *j >= first) {
                for i in j..start + width {
                    each(i - first, j - first, column[i - start]);
                }
                for (&i, &l) in rows.iter().zip(&column[width..]) {
                    each(i as usize - first, j - first, l);
                }
            }
        }
    }

    /// The last `size` rows and columns of L, lower triangular.
    pub fn trailing(&self, size: usize) -> DMatrix<f64> {
        let mut block = DMatrix::zeros(size, size);
        self.trailing_entries(size, |i, j, l| block[(i, j)] = l);
        block
    }

    /// L_cc x with the last rows and columns of L, as many as x has.
    pub fn trailing_times(&self, x: &[f64]) -> DVector<f64> {
        let mut product = DVector::zeros(x.len());
        self.trailing_entries(x.len(), |i, j, l| product[i] += l * x[j]);
        product
    }

    /// L_ccᵀ x with the last rows and columns of L, as many as x has.
    pub fn trailing_transposed_times(&self, x: &[f64]) -> DVector<f64> {
        let mut product = DVector::zeros(x.len());
        self.trailing_entries(x.len(), |i, j, l| product[j] += l * x[i]);
        product
    }

    /// Entries of the factor: to make in a test the faults that memory and kernels make.
    pub fn factor_mut(&mut self) -> &mut [f64] {
        &mut self.factor
    }
}

/// Columns that are read at once: what they are added to, or multiplied by, is read once for all.
const TOGETHER: usize = 4;

/// sum ← sum + Σ column x below the first `width` entries of some columns of this height.
fn add_product(columns: &[f64], (width, height): (usize, usize), x: &[f64], sum: &mut [f64]) {
    if let ([a, b, c, d], 4) = (x, columns.len() / height) {
        let (p, rest) = columns.split_at(height);
        let (q, rest) = rest.split_at(height);
        let (r, s) = rest.split_at(height);
        let (p, q, r, s) = (&p[width..], &q[width..], &r[width..], &s[width..]);
        for ((((sum, p), q), r), s) in sum.iter_mut().zip(p).zip(q).zip(r).zip(s) {
            *sum += (p * a + q * b) + (r * c + s * d);
        }
        return;
    }
    for (column, x) in columns.chunks_exact(height).zip(x) {
        for (sum, l) in sum.iter_mut().zip(&column[width..]) {
            *sum += l * x;
        }
    }
}

/// x ← x − column·known for some columns, below their first `width` entries.
fn subtract_products(
    columns: &[f64],
    (width, height): (usize, usize),
    known: &[f64],
    x: &mut [f64],
) {
    if let ([a, b, c, d], 4) = (&mut *x, columns.len() / height) {
        let (p, rest) = columns.split_at(height);
        let (q, rest) = rest.split_at(height);
        let (r, s) = rest.split_at(height);
        let [p, q, r, s] = dots([&p[width..], &q[width..], &r[width..], &s[width..]], known);
        *a -= p;
        *b -= q;
        *c -= r;
        *d -= s;
        return;
    }
    for (column, x) in columns.chunks_exact(height).zip(x) {
        *x -= dot(&column[width..], known);
    }
}

/// The products of four columns with one, each in an order that lets a processor add several at once.
fn dots(columns: [&[f64]; 4], known: &[f64]) -> [f64; 4] {
    const LANES: usize = 4;
    let mut sums = [[0.0; LANES]; 4];
    let whole = known.len() - known.len() % LANES;
    let [p, q, r, s] = columns.map(|c| c[..whole].chunks_exact(LANES));
    let known_lanes = known[..whole].chunks_exact(LANES);
    for ((((x, p), q), r), s) in known_lanes.zip(p).zip(q).zip(r).zip(s) {
        for k in 0..LANES {
            sums[0][k] += p[k] * x[k];
            sums[1][k] += q[k] * x[k];
            sums[2][k] += r[k] * x[k];
            sums[3][k] += s[k] * x[k];
        }
    }
    let mut out = [0.0; 4];
    for ((out, sums), column) in out.iter_mut().zip(sums).zip(columns) {
        let rest = column[whole..].iter().zip(&known[whole..]);
        *out = sums.iter().sum::<f64>() + rest.map(|(l, x)| l * x).sum::<f64>();
    }
    out
}

/// Σ a b in an order that lets a processor add several at once.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a
        .remainder()
        .iter()
        .zip(b.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a.zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    rest + sums.iter().sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nested_dissection;
    use nalgebra::DVector;
    use proptest::prelude::*;

    /// Arrow matrix plus a random band: sparse rows with a dense tail.
    fn sample(n: usize, seed: &[f64]) -> (Pattern, Vec<f64>, DMatrix<f64>) {
        let mut dense = DMatrix::zeros(n, n);
        let mut column_start = vec![0];
        let (mut row, mut values) = (Vec::new(), Vec::new());
        for j in 0..n {
            for i in j..n {
                if i == j || i - j == 3 || i + 2 >= n {
                    let v = if i == j {
                        8.0
                    } else {
                        seed[(i * 7 + j) % seed.len()]
                    };
                    dense[(i, j)] = v;
                    dense[(j, i)] = v;
                    row.push(i as u32);
                    values.push(v);
                }
            }
            column_start.push(row.len() as u32);
        }
        // Diagonally dominant, hence positive definite.
        for i in 0..n {
            let sum: f64 = (0..n)
                .filter(|&j| j != i)
                .map(|j| dense[(i, j)].abs())
                .sum();
            dense[(i, i)] += sum;
            values[column_start[i] as usize] += sum;
        }
        (Pattern::new(column_start, row), values, dense)
    }

    proptest! {
        #[test]
        fn solves_and_gives_its_trailing_block(
            n in 4usize..40, seed in prop::collection::vec(-1.0..1.0f64, 13), tail in 1usize..4,
        ) {
            let (pattern, values, dense) = sample(n, &seed);
            let mut cholesky = Cholesky::analyse(&pattern, None, |_| true).expect("small");
            cholesky.factorise(&pattern, &values).expect("definite");
            let x = DVector::from_fn(n, |i, _| (i as f64).cos());
            let mut b = (&dense * &x).as_slice().to_vec();
            cholesky.forward(&mut b);
            cholesky.backward(&mut b);
            prop_assert!((DVector::from_vec(b) - &x).norm() < 1e-11);
            // L_cc L_ccᵀ is the Schur complement of the trailing block.
            let l = cholesky.trailing(tail);
            let (m, c) = (n - tail, tail);
            let inner = dense.view((0, 0), (m, m)).into_owned();
            let coupling = dense.view((m, 0), (c, m)).into_owned();
            let schur = dense.view((m, m), (c, c))
                - &coupling * inner.try_inverse().expect("definite") * coupling.transpose();
            prop_assert!((&l * l.transpose() - schur).norm() < 1e-10);
        }
    }

    /// Springs in a row of which only the first is held, by a soft one: a motion with that little stiffness; the
    /// cost is that of the factor.
    #[test]
    fn the_least_pivot_tells_what_hardly_resists() {
        let n = 6;
        let mut start = vec![0];
        let (mut row, mut values) = (Vec::new(), Vec::new());
        for j in 0..n {
            row.extend((j..n.min(j + 2)).map(|i| i as u32));
            start.push(row.len() as u32);
        }
        let pattern = Pattern::new(start, row);
        for held in [1.0, 1e-6, 1e-12] {
            values.clear();
            for j in 0..n {
                let ends = if j == 0 { held } else { 1.0 };
                values.push(if j + 1 < n { ends + 1.0 } else { ends });
                if j + 1 < n {
                    values.push(-1.0);
                }
            }
            let mut cholesky = Cholesky::analyse(&pattern, None, |_| true).expect("small");
            cholesky.factorise(&pattern, &values).expect("definite");
            // The last pivot is that of the springs in series.
            let series = 1.0 / (1.0 / held + (n - 1) as f64);
            let least = cholesky.least_pivot(&pattern, &values);
            assert!((least / series - 1.0).abs() < 1e-3, "{least:e} {series:e}");
        }
        let cost = Cholesky::cost(&pattern);
        assert_eq!(cost.entries, (2 * n - 1) as f64);
        assert_eq!(cost.operations, (4 * (n - 1) + 1) as f64);
    }

    /// Seven-point Laplacian of a cube of nodes, made definite, in nested-dissection order.
    fn laplacian(n: usize) -> (Pattern, Vec<f64>) {
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
        let (mut column_start, mut row, mut values) = (vec![0], Vec::new(), Vec::new());
        for (k, &a) in order.iter().enumerate() {
            let mut below: Vec<u32> = adjacency[a].iter().map(|&b| position[b]).collect();
            below.retain(|&i| i as usize > k);
            below.sort_unstable();
            values.push(6.0 + 1.0 / (2.0 + a as f64));
            values.extend(below.iter().map(|_| -1.0));
            row.push(k as u32);
            row.extend(below);
            column_start.push(row.len() as u32);
        }
        (Pattern::new(column_start, row), values)
    }

    #[test]
    fn the_factor_is_the_same_to_the_bit_on_any_number_of_threads() {
        let (pattern, values) = laplacian(22);
        let factor = |par: Par, threads: usize| {
            let mut cholesky =
                Cholesky::analyse_for(&pattern, |_| par, (None, |_| true)).expect("small");
            assert!(cholesky.operations() > 1e8);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("threads");
            pool.install(|| cholesky.factorise(&pattern, &values))
                .expect("definite");
            cholesky.factor
        };
        let one = factor(Par::Seq, 1);
        for threads in [1, 2, 3] {
            assert!(one == factor(Par::rayon(0), threads), "{threads} threads");
        }
    }

    #[test]
    fn a_factor_larger_than_the_memory_that_is_free_is_refused_before_it_is_made() {
        let (pattern, _) = laplacian(6);
        let analysed = |memory| Cholesky::analyse(&pattern, memory, |_| true);
        let entries = analysed(None).expect("small").entries();
        // The columns alone, without the zeros that make those of a supernode alike.
        for bytes in [0, 4 * entries as u64, 8 * entries as u64 - 8] {
            let no = analysed(Some(bytes)).expect_err("too large");
            assert!(no.entries > no.room && no.entries <= entries as f64);
            assert_eq!(no.room, bytes as f64 / 8.0);
        }
        assert!(analysed(Some(8 * entries as u64)).is_ok());
    }

    #[test]
    fn an_indefinite_matrix_is_refused_at_its_row() {
        let pattern = Pattern::new(vec![0, 2, 3], vec![0, 1, 1]);
        let mut cholesky = Cholesky::analyse(&pattern, None, |_| true).expect("small");
        assert_eq!(
            cholesky.factorise(&pattern, &[1.0, 2.0, 1.0]),
            Err(NotPositiveDefinite { row: 1 })
        );
        cholesky
            .factorise(&pattern, &[1.0, 0.5, 1.0])
            .expect("definite");
    }
}
