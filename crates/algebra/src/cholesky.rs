//! L Lᵀ = A of sparse positive definite matrices, supernode by supernode; not the order of the unknowns.

mod branches;
mod numeric;
mod sweep;
#[cfg(test)]
mod tests;

use nalgebra::DMatrix;
use pulp::Arch;
use std::fmt;

use crate::dense::square;
use crate::engine::{Cost, Engine, EngineError, Inertia, TooLarge, check_columns, check_values};
use crate::panel::SIDES;
use crate::pattern::Pattern;
use crate::symbolic::Symbolic;
use branches::Branches;
use numeric::{Numeric, Updates};
use sweep::{Factor, Sweeps};

/// L Lᵀ = A, in the order in which A is given.
///
/// The unknowns that are kept are eliminated with the others, as the last: S = L_cc L_ccᵀ, and A as a whole
/// has to be positive definite. Where A is not, but A + σE is, with E the identity on the kept unknowns, S is
/// that of A + σE less σE.
pub struct Cholesky {
    symbolic: Symbolic,
    updates: Updates,
    branches: Branches,
    factor: Vec<f64>,
    sweeps: Sweeps,
    least_pivot: f64,
    factorised: bool,
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
        let symbolic = Symbolic::new(pattern, memory)?;
        let too_large = TooLarge {
            entries: symbolic.cost.entries,
            room: symbolic.room,
        };
        let mut factor = Vec::new();
        let entries = symbolic.supernodes.len_val();
        factor.try_reserve_exact(entries).map_err(|_| too_large)?;
        factor.resize(entries, 0.0);
        let branches = Branches::new(&symbolic);
        Ok(Self {
            factor,
            updates: Updates::new(&symbolic),
            sweeps: Sweeps::new(&symbolic, &branches),
            branches,
            least_pivot: f64::INFINITY,
            factorised: false,
            arch: Arch::new(),
            symbolic,
        })
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
        let numeric = Numeric {
            symbolic: &self.symbolic,
            updates: &self.updates,
            values,
        };
        numeric
            .factorise(&self.branches, &mut self.factor)
            .map_err(|row| EngineError::NotPositiveDefinite { row })?;
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
