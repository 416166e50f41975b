//! Factorisation of the dense matrices of the contact problem; the only file of this crate that
//! names the library that does it.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par};
use nalgebra::{DMatrix, DVector};

/// Pivots below this part of the largest are rounding: the matrix is singular.
pub(crate) const SINGULAR: f64 = 1e-14;

/// L U = P A with partial pivoting.
pub struct Lu {
    factors: DMatrix<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    memory: MemBuffer,
    /// The least pivot over the largest.
    pub least_pivot: f64,
    /// The largest pivot.
    pub largest_pivot: f64,
}

impl Lu {
    /// Factorises a square matrix; `None` if it is singular to rounding or holds NaN.
    ///
    /// # Panics
    /// If it is not square.
    pub fn new(mut a: DMatrix<f64>) -> Option<Self> {
        let n = a.nrows();
        let (mut forward, mut inverse) = (vec![0usize; n], vec![0usize; n]);
        let request = StackReq::or(
            factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()),
            solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
        );
        let mut memory = MemBuffer::try_new(request).ok()?;
        // One thread: the same factors to the bit wherever it runs.
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(a.as_mut_slice(), n, n),
            &mut forward,
            &mut inverse,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        let pivots = a.diagonal();
        let largest_pivot = pivots.amax();
        let least_pivot = match n {
            0 => 1.0,
            _ => pivots.amin() / largest_pivot,
        };
        // NaN is refused, too.
        (least_pivot > SINGULAR).then_some(Self {
            factors: a,
            forward,
            inverse,
            memory,
            least_pivot,
            largest_pivot,
        })
    }

    /// x of A x = b.
    ///
    /// # Panics
    /// If b has not as many rows as A.
    pub fn solve(&mut self, mut b: DVector<f64>) -> DVector<f64> {
        let n = b.len();
        let factors = MatRef::from_column_major_slice(self.factors.as_slice(), n, n);
        solve::solve_in_place(
            factors,
            factors,
            PermRef::new_checked(&self.forward, &self.inverse, n),
            MatMut::from_column_major_slice_mut(b.as_mut_slice(), n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        b
    }
}
