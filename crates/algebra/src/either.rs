//! L Lᵀ of a matrix that is positive definite, L D Lᵀ of one that is not; neither of them.

use nalgebra::DMatrix;

use crate::cholesky::Cholesky;
use crate::engine::{Cost, Engine, EngineError, Inertia, TooLarge};
use crate::ldlt::Ldlt;
use crate::pattern::Pattern;

/// [`Cholesky`] of a matrix that is positive definite, [`Ldlt`] of one that is not: of matrices of which few
/// are indefinite.
///
/// Which of both depends on the matrix alone. The memory of an analysis is that of one factor; the first matrix
/// that is not definite asks for another.
#[derive(Debug)]
pub struct Either {
    pattern: Pattern,
    memory: Option<u64>,
    definite: Cholesky,
    indefinite: Option<Ldlt>,
    is_definite: bool,
}

impl Either {
    fn engine(&mut self) -> &mut dyn Engine {
        match &mut self.indefinite {
            Some(indefinite) if !self.is_definite => indefinite,
            _ => &mut self.definite,
        }
    }

    fn factor(&self) -> &dyn Engine {
        match &self.indefinite {
            Some(indefinite) if !self.is_definite => indefinite,
            _ => &self.definite,
        }
    }
}

impl Engine for Either {
    fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge> {
        Ok(Self {
            pattern: pattern.clone(),
            memory,
            definite: Cholesky::analyse(pattern, memory)?,
            indefinite: None,
            is_definite: true,
        })
    }

    fn size(&self) -> usize {
        self.definite.size()
    }

    fn kept(&self) -> usize {
        self.definite.kept()
    }

    fn cost(&self) -> Cost {
        self.factor().cost()
    }

    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        self.is_definite = true;
        let definite = self.definite.factorise(values);
        if !matches!(definite, Err(EngineError::NotPositiveDefinite { .. })) {
            return definite;
        }
        self.is_definite = false;
        let indefinite = match self.indefinite.take() {
            Some(engine) => engine,
            None => Ldlt::analyse(&self.pattern, self.memory)?,
        };
        self.indefinite.insert(indefinite).factorise(values)
    }

    fn least_pivot(&self) -> f64 {
        self.factor().least_pivot()
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.engine().solve(x)
    }

    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.engine().condense(x)
    }

    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.engine().expand(x)
    }

    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        self.factor().schur()
    }
}
