//! Contact with friction regularised by springs, the penalty law of \[81\]-\[82\]; not the exact
//! law, to which it tends as 1/k.

use crate::error::{LawError, positive};
use crate::friction::coulomb::Coulomb;
use crate::local::{Local, Status, direction, tangential, tangential_norm};
use nalgebra::SMatrix;

/// Coulomb contact in series with a normal spring k_n and a tangential spring k_t \[N/mm\].
///
/// The inf-convolution of the bipotential of contact with the energy \[81\] of the springs, \[82\]
/// with the dissipation at the irreversible displacement uᶠ. The irreversible part obeys the exact
/// law, as the plastic strain obeys the flow rule: (−uᶠ, t) is extremal for b_c, and the springs
/// give uᶠ = u + diag(1/k)(t − t₀*) with t₀* = (0, t_t0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularisedCoulomb {
    coulomb: Coulomb,
    normal: f64,
    tangent: f64,
}

/// Outcome of a step of the regularised contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularisedResponse<const D: usize> {
    /// The force t at the end of the step \[N\], in K_μ.
    pub force: Local<D>,
    /// ∂t/∂u \[N/mm\], with respect to u and not −u: diag(−k_n, −k_t) in stick, unsymmetric in
    /// slip, where the pressure bounds t_t.
    pub tangent: SMatrix<f64, D, D>,
    /// The irreversible displacement uᶠ \[mm\], for which the exact law holds.
    pub irreversible: Local<D>,
    /// The status, \[35\].
    pub status: Status,
}

impl RegularisedCoulomb {
    /// From the coefficient of friction μ ≥ 0 and the stiffnesses k_n, k_t > 0 \[N/mm\].
    ///
    /// # Errors
    /// `NegativeFriction` unless μ ≥ 0 is finite; `NotPositive` unless k_n, k_t > 0 are finite.
    pub fn new(
        friction: f64,
        normal_stiffness: f64,
        tangent_stiffness: f64,
    ) -> Result<Self, LawError> {
        Ok(Self {
            coulomb: Coulomb::new(friction)?,
            normal: positive("normal stiffness", normal_stiffness)?,
            tangent: positive("tangent stiffness", tangent_stiffness)?,
        })
    }

    /// The exact law that is regularised.
    pub fn coulomb(&self) -> &Coulomb {
        &self.coulomb
    }

    /// Normal stiffness k_n \[N/mm\].
    pub fn normal_stiffness(&self) -> f64 {
        self.normal
    }

    /// Tangential stiffness k_t \[N/mm\].
    pub fn tangent_stiffness(&self) -> f64 {
        self.tangent
    }

    /// Response to u = (u_n, Δu_t): the *total* gap at the end of the step and the slip
    /// *increment* \[mm\], from the force t₀ at the start \[N\], of which only t_t0 is remembered.
    ///
    /// t_n = k_n ⟨−u_n⟩₊, and t_t is the trial t_t0 − k_t Δu_t clipped to the disc of radius
    /// μ t_n (*not* projected on K_μ: slip must not raise the pressure).
    #[inline]
    pub fn respond<const D: usize>(&self, t0: &Local<D>, u: &Local<D>) -> RegularisedResponse<D> {
        let mu = self.coulomb.friction();
        let trial = self.trial(t0, u);
        let status = self.status(&trial);

        let mut force = self.clipped(&trial, trial[0]);
        force[0] = trial[0];

        let mut tangent = SMatrix::zeros();
        if status != Status::Open {
            tangent[(0, 0)] = -self.normal;
        }
        match status {
            Status::Open => {}
            Status::Stick | Status::Tied => {
                for i in 1..D {
                    tangent[(i, i)] = -self.tangent;
                }
            }
            Status::Slip => {
                let norm = tangential_norm(&trial);
                let tau = direction(&trial);
                if norm > 0.0 {
                    let shrunk = -self.tangent * (mu * trial[0] / norm);
                    tangent -= shrunk * tau * tau.transpose();
                    for i in 1..D {
                        tangent[(i, i)] += shrunk;
                        tangent[(i, 0)] = -self.normal * mu * tau[i];
                    }
                }
            }
        }

        RegularisedResponse {
            force,
            tangent,
            irreversible: self.irreversible(t0, u, &force),
            status,
        }
    }

    /// The regularised incremental bipotential \[82\] at a given pressure t_n ≥ 0 \[N·mm\]:
    ///
    /// inf over uᶠ, uᶠ_n ≥ 0, of
    /// t_t0·uᶠ_t + μ t_n ‖uᶠ_t‖ + ½ k_t ‖Δu_t − uᶠ_t‖² + ½ k_n (u_n − uᶠ_n)².
    ///
    /// Convex and continuously differentiable in u, with ∂/∂u = t₀* − t for the force t of
    /// [`Self::respond`] if t_n is the pressure found there: a fixed point, not a minimum.
    pub fn potential<const D: usize>(&self, t0: &Local<D>, u: &Local<D>, t_n: f64) -> f64 {
        let trial = self.trial(t0, u);
        let mut force = self.clipped(&trial, t_n);
        force[0] = trial[0];
        self.convolved(t0, u, t_n, &self.irreversible(t0, u, &force))
    }

    /// The bracket whose infimum over uᶠ_n ≥ 0 is [`Self::potential`] \[N·mm\]; strictly convex
    /// in uᶠ.
    pub fn convolved<const D: usize>(
        &self,
        t0: &Local<D>,
        u: &Local<D>,
        t_n: f64,
        u_f: &Local<D>,
    ) -> f64 {
        let spring = u - u_f;
        tangential(t0).dot(u_f)
            + self.coulomb.friction() * t_n * tangential_norm(u_f)
            + 0.5 * self.tangent * tangential_norm(&spring).powi(2)
            + 0.5 * self.normal * spring[0].powi(2)
    }

    /// (k_n ⟨−u_n⟩₊, t_t0 − k_t Δu_t).
    #[inline]
    fn trial<const D: usize>(&self, t0: &Local<D>, u: &Local<D>) -> Local<D> {
        let mut trial = t0 - self.tangent * u;
        // Not `f64::max`, which would turn NaN into contact lost.
        trial[0] = if u[0] >= 0.0 {
            0.0
        } else {
            -self.normal * u[0]
        };
        trial
    }

    #[inline]
    fn status<const D: usize>(&self, trial: &Local<D>) -> Status {
        let mu = self.coulomb.friction();
        if trial[0] == 0.0 {
            Status::Open
        } else if mu > 0.0 && tangential_norm(trial) <= mu * trial[0] {
            Status::Stick
        } else {
            Status::Slip
        }
    }

    /// The tangential trial, clipped to the disc of radius μ t_n.
    #[inline]
    fn clipped<const D: usize>(&self, trial: &Local<D>, t_n: f64) -> Local<D> {
        let radius = self.coulomb.friction() * t_n;
        if tangential_norm(trial) <= radius {
            tangential(trial)
        } else {
            radius * direction(trial)
        }
    }

    /// uᶠ = u + diag(1/k)(t − t₀*).
    #[inline]
    fn irreversible<const D: usize>(&self, t0: &Local<D>, u: &Local<D>, t: &Local<D>) -> Local<D> {
        let mut u_f = u + (t - t0) / self.tangent;
        u_f[0] = if t[0] == 0.0 { u[0] } else { 0.0 };
        u_f
    }
}
