//! The contact problem of a structure that is known by a factor of its stiffness; not how it is solved.

use moreau_laws::{Friction, Local};
use nalgebra::{DVector, SMatrix};

/// A structure seen from its contacts through a factor.
///
/// B takes the displacement increments Δu of the structure to those of its contacts, in their local
/// frames: v = B Δu. Ties R, a symmetric positive semi-definite matrix a contact, add springs there,
/// and what is factorised is K + BᵀRB.
pub trait Structure<const D: usize> {
    /// Stiffness of a contact's own components \[N/mm\], that of K between the nodes there: a measure.
    fn stiffness(&self, contact: usize) -> f64;

    /// Factorises K + BᵀRB; false if that is not positive definite, beyond rounding.
    fn tie(&mut self, ties: &[SMatrix<f64, D, D>]) -> bool;

    /// v = B (K + BᵀRB)⁻¹ (f + Bᵀ z), in the order of the contacts' components \[mm\], with the load f
    /// of the structure or without it.
    fn displacement(&mut self, z: &DVector<f64>, loaded: bool) -> DVector<f64>;

    /// The same of several z at once, without the load.
    fn displacements(&mut self, z: &[DVector<f64>]) -> Vec<DVector<f64>> {
        z.iter().map(|z| self.displacement(z, false)).collect()
    }

    /// How many displacements take as long as a factorisation.
    fn worth(&self) -> f64;

    /// What one of several at once takes, over one alone.
    fn together(&self) -> f64 {
        1.0
    }
}

/// Springs in series with a contact: the law holds between its force t and u + C (t − t*).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Springs<const D: usize> {
    /// C of every component \[mm/N\].
    pub compliance: Local<D>,
    /// t*, the force at which they have their length \[N\].
    pub force: Local<D>,
}

impl<const D: usize> Springs<D> {
    /// Those of the penalty of \[81\]–\[82\]: what presses stretches them from rest, what slips from the force t₀ at the start
    /// of the step. A tie has none.
    pub fn of_penalty(compliance: Local<D>, mut previous: Local<D>, law: &Friction) -> Self {
        previous[0] = 0.0;
        match law.is_tie() {
            true => Self::default(),
            false => Self {
                compliance,
                force: previous,
            },
        }
    }

    /// C (t − t*) under a force t \[mm\].
    pub fn elongation(&self, force: &Local<D>) -> Local<D> {
        self.compliance.component_mul(&(force - self.force))
    }

    /// These and others in series with them: elongations add up.
    pub fn and(&self, others: &Self) -> Self {
        let compliance = self.compliance + others.compliance;
        let at_rest = -(self.elongation(&Local::zeros()) + others.elongation(&Local::zeros()));
        Self {
            compliance,
            force: at_rest.zip_map(&compliance, |rest, c| if c > 0.0 { rest / c } else { 0.0 }),
        }
    }
}

impl<const D: usize> Default for Springs<D> {
    /// None: the law itself.
    fn default() -> Self {
        Self {
            compliance: Local::zeros(),
            force: Local::zeros(),
        }
    }
}

/// The contact problem of one linearised increment of a structure:
///
/// ```text
/// K Δu = f + Bᵀ t,   u = g + B Δu,   (−u, t) extremal for [38] at every contact.
/// ```
///
/// It is the one of [`CondensedProblem`](crate::CondensedProblem), not condensed on the contacts: what it takes does not grow
/// with the square of their number.
pub struct TiedProblem<'a, const D: usize> {
    /// K, f and B.
    pub structure: &'a mut dyn Structure<D>,
    /// Displacement g about which the structure was linearised \[mm\].
    pub origin: Vec<Local<D>>,
    /// The law of every contact.
    pub friction: Vec<Friction>,
    /// Springs in series with every contact, zero for the law itself.
    pub springs: Vec<Springs<D>>,
    /// The largest force of the load f \[N\].
    pub load: f64,
    /// By how much that load may be rounding \[N\], as [`CondensedProblem::rounds`](crate::CondensedProblem::rounds) tells.
    pub rounding: f64,
    /// By which stiffness displacements weigh at least where a solution is judged \[N/mm\], as
    /// [`CondensedProblem::weigh`](crate::CondensedProblem::weigh) tells; zero for that of the contacts.
    pub weight: f64,
    /// Contact forces t₀ at the start of the step \[N\].
    pub previous: Vec<Local<D>>,
}
