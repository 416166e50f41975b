//! L Lᵀ = A of sparse positive definite matrices, supernode by supernode; not the order of the unknowns.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal;
use nalgebra::DMatrix;
use pulp::Arch;
use std::fmt;

use crate::dense::square;
use crate::engine::{Cost, Engine, EngineError, Inertia, TooLarge, check_columns, check_values};
use crate::panel::SIDES;
use crate::pattern::Pattern;
use crate::sweep::{Factor, Sweeps};
use crate::symbolic::Symbolic;

/// L Lᵀ = A, in the order in which A is given.
///
/// The unknowns that are kept are eliminated with the others, as the last: S = L_cc L_ccᵀ, and A as a whole
/// has to be positive definite. Where A is not, but A + σE is, with E the identity on the kept unknowns, S is
/// that of A + σE less σE.
pub struct Cholesky {
    symbolic: Symbolic,
    factor: Vec<f64>,
    memory: MemBuffer,
    sweeps: Sweeps,
    least_pivot: f64,
    factorised: bool,
    par: Par,
    /// Instructions that the processor has.
    arch: Arch,
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
            .field("size", &self.size())
            .field("kept", &self.kept())
            .field("cost", &self.symbolic.cost)
            .finish_non_exhaustive()
    }
}

impl Cholesky {
    /// On threads of another number than the operations ask for, if one is given.
    pub(crate) fn analyse_for(
        pattern: &Pattern,
        memory: Option<u64>,
        threads: Option<Par>,
    ) -> Result<Self, TooLarge> {
        let symbolic = Symbolic::new(pattern, memory)?;
        let par = threads.unwrap_or_else(|| symbolic.par());
        let too_large = TooLarge {
            entries: symbolic.cost.entries,
            room: symbolic.room,
        };
        let request = supernodal::factorize_supernodal_numeric_llt_scratch::<u32, f64>(
            &symbolic.supernodes,
            par,
            Default::default(),
        );
        let mut factor = Vec::new();
        let entries = symbolic.supernodes.len_val();
        factor.try_reserve_exact(entries).map_err(|_| too_large)?;
        factor.resize(entries, 0.0);
        Ok(Self {
            factor,
            memory: MemBuffer::try_new(request).map_err(|_| too_large)?,
            sweeps: Sweeps::new(&symbolic),
            least_pivot: f64::INFINITY,
            factorised: false,
            par,
            arch: Arch::new(),
            symbolic,
        })
    }

    /// The least pivot over what the diagonal of the matrix was there.
    fn least(&self, values: &[f64]) -> f64 {
        let mut least = f64::INFINITY;
        for s in 0..self.symbolic.count() {
            let node = self.symbolic.supernode(s);
            let height = node.width + node.rows.len();
            let columns = self.factor[node.values].chunks_exact(height);
            for (j, column) in columns.enumerate() {
                let diagonal = values[self.symbolic.pattern.diagonal(node.start + j)];
                least = least.min(column[j] * column[j] / diagonal);
            }
        }
        least
    }

    /// x ← L⁻¹ x with the first columns of L, so many, of at most [`SIDES`] right-hand sides; what is below
    /// is condensed.
    fn forward(&mut self, columns: usize, x: &mut [f64]) {
        let factor = Factor {
            symbolic: &self.symbolic,
            values: &self.factor,
            columns,
            arch: self.arch,
        };
        self.sweeps.forward(factor, x);
    }

    /// x ← L⁻ᵀ x with the first columns of L, so many, where the unknowns after them are known.
    fn backward(&mut self, columns: usize, x: &mut [f64]) {
        let factor = Factor {
            symbolic: &self.symbolic,
            values: &self.factor,
            columns,
            arch: self.arch,
        };
        self.sweeps.backward(factor, x);
    }

    /// Right-hand sides, as many at once as are worth it.
    fn check(&self, x: &[f64]) -> Result<usize, EngineError> {
        check_columns(x, self.size())?;
        if !self.factorised {
            return Err(EngineError::NotFactorised);
        }
        Ok((SIDES * self.size()).max(1))
    }
}

impl Engine for Cholesky {
    fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
        Self::analyse_for(pattern, memory, None)
    }

    fn size(&self) -> usize {
        self.symbolic.pattern.size()
    }

    fn kept(&self) -> usize {
        self.symbolic.pattern.kept()
    }

    fn cost(&self) -> Cost {
        self.symbolic.cost
    }

    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        self.factorised = false;
        let pattern = &self.symbolic.pattern;
        check_values(values, pattern)?;
        // Threads share out the entries of the dense updates, not their sums: the factor is the same
        // to the bit wherever it runs.
        supernodal::factorize_supernodal_numeric_llt(
            &mut self.factor,
            SparseColMatRef::new(pattern.lower.as_ref().as_ref(), values),
            Default::default(),
            &self.symbolic.supernodes,
            self.par,
            MemStack::new(&mut self.memory),
            Default::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| {
            EngineError::NotPositiveDefinite { row: index }
        })?;
        self.least_pivot = self.least(values);
        self.factorised = true;
        Ok(Inertia {
            positive: self.size() - self.kept(),
            ..Inertia::default()
        })
    }

    fn least_pivot(&self) -> f64 {
        self.least_pivot
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let at_once = self.check(x)?;
        for x in x.chunks_mut(at_once) {
            self.forward(self.size(), x);
            self.backward(self.size(), x);
        }
        Ok(())
    }

    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let at_once = self.check(x)?;
        for x in x.chunks_mut(at_once) {
            self.forward(self.size() - self.kept(), x);
        }
        Ok(())
    }

    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        let at_once = self.check(x)?;
        for x in x.chunks_mut(at_once) {
            self.backward(self.size() - self.kept(), x);
        }
        Ok(())
    }

    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        if !self.factorised {
            return Err(EngineError::NotFactorised);
        }
        let (kept, first) = (self.kept(), self.size() - self.kept());
        let mut l = DMatrix::zeros(kept, kept);
        for s in (0..self.symbolic.count()).rev() {
            let node = self.symbolic.supernode(s);
            if node.start + node.width <= first {
                break;
            }
            let values = &self.factor[node.values.clone()];
            let columns = values.chunks_exact(node.width + node.rows.len());
            for (j, column) in columns.enumerate() {
                if node.start + j < first {
                    continue;
                }
                let (own, below) = column[j..].split_at(node.width - j);
                let at = node.start + j - first;
                let mut l = l.column_mut(at);
                l.as_mut_slice()[at..at + own.len()].copy_from_slice(own);
                for (&i, &v) in node.rows.iter().zip(below) {
                    l[i as usize - first] = v;
                }
            }
        }
        Ok(square(l))
    }
}
