//! Laws of the bulk that answer for many points at once, from numbers and not from types: what a law of another
//! language is; not a law.

use crate::bulk::{BulkLaw, Numbers};
use moreau_mandel::{Sym2, Sym4};
use std::fmt::Debug;

/// Points of a body that a law is asked for at once. Nothing at one of them depends on another.
#[derive(Debug)]
pub struct Panel<'a> {
    /// Strain increments Δε of the whole step, a tensor a point.
    pub d_eps: &'a [Sym2],
    /// States at its start: the numbers of a point, in the order of [`PanelLaw::initial`], and then those of the next.
    pub old: &'a [f64],
    /// Where the stresses at its end belong \[MPa\], a tensor a point.
    pub stress: &'a mut [Sym2],
    /// Where the tangents ∂σ₁/∂Δε belong \[MPa\], 6×6 a point.
    pub tangent: &'a mut [Sym4],
    /// Where the states at its end belong, as those at its start.
    pub new: &'a mut [f64],
}

/// Why a law has no answer, in its own words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoAnswer(pub String);

/// A law of the bulk in R³ that answers for a panel of points: what [`BulkLaw`] is, of a state whose numbers are
/// counted when it runs. It is as pure: a step without strain changes nothing, and what it was asked before does not
/// matter.
///
/// Energies are not its own: what is stored is that of linear elasticity under its stress, and all else is dissipated.
pub trait PanelLaw: Debug + Send + Sync {
    /// The numbers of the state that every point starts from; their count is that of every state.
    fn initial(&self) -> Vec<f64>;

    /// Names and components of the numbers of a state, in their order, that are worth seeing as fields: 1 of a scalar, 3
    /// of a vector, 6 of a symmetric tensor as in [`Sym2`]. As in [`BulkLaw::fields`].
    fn fields(&self) -> Vec<(String, usize)> {
        Vec::new()
    }

    /// Whether the tangents are symmetric.
    fn is_symmetric(&self) -> bool {
        true
    }

    /// Writes the response at every point of a panel.
    ///
    /// # Errors
    /// [`NoAnswer`]; what the panel then holds is not looked at.
    fn respond(&self, panel: Panel<'_>) -> Result<(), NoAnswer>;
}

/// A law of points as one of panels: asked point by point.
#[derive(Debug, Clone)]
pub struct PointByPoint<L>(pub L);

impl<L: BulkLaw + Debug> PanelLaw for PointByPoint<L> {
    fn initial(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.0.initial().visit(&mut |x| numbers.push(*x));
        numbers
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric()
    }

    fn respond(&self, panel: Panel<'_>) -> Result<(), NoAnswer> {
        let law = &self.0;
        let mut state = law.initial();
        let mut old = panel.old.iter();
        let mut new = panel.new.iter_mut();
        let out = panel.stress.iter_mut().zip(panel.tangent);
        for (d_eps, (stress, tangent)) in panel.d_eps.iter().zip(out) {
            state.visit(&mut |x| *x = old.next().copied().unwrap_or(f64::NAN));
            let mut response = law.respond(&state, d_eps);
            (*stress, *tangent) = (response.stress, response.tangent);
            if !law.is_symmetric() {
                *tangent += law.lacking(&state, d_eps);
            }
            response.state.visit(&mut |x| {
                if let Some(new) = new.next() {
                    *new = *x;
                }
            });
        }
        Ok(())
    }
}
