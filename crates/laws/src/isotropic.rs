//! Isotropic hardening as a stored energy of the equivalent plastic strain; not a yield criterion.

use crate::error::{LawError, Parameter, non_negative, positive};
use std::sync::Arc;

/// Isotropic hardening: the stress R(p) by which the yield stress has risen, R(0) = 0, the slope
/// R' ≥ 0 and the energy ψ(p) = ∫₀ᵖ R that is stored.
///
/// R never falls, so that ψ is convex and the step has a potential, \[62\].
#[derive(Debug, Clone, PartialEq)]
pub struct Isotropic {
    kind: Kind,
    /// What a linear part adds to the modulus \[MPa\].
    added: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Linear {
        modulus: f64,
    },
    Voce {
        saturation: f64,
        rate: f64,
    },
    Swift {
        strength: f64,
        offset: f64,
        exponent: f64,
    },
    Table(Arc<[Knot]>),
}

/// A point of a table, and the line to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    p: f64,
    stress: f64,
    slope: f64,
    energy: f64,
}

impl From<Kind> for Isotropic {
    fn from(kind: Kind) -> Self {
        Self { kind, added: 0.0 }
    }
}

impl Isotropic {
    /// R = H p, from the modulus H \[MPa\].
    ///
    /// # Errors
    /// `Negative` unless H ≥ 0 is finite: softening has no convex potential.
    pub fn linear(modulus: f64) -> Result<Self, LawError> {
        let modulus = non_negative(Parameter::IsotropicModulus, modulus)?;
        Ok(Kind::Linear { modulus }.into())
    }

    /// R = q_∞ (1 − exp(−b p)), from the saturation q_∞ \[MPa\] and the rate b.
    ///
    /// Source: E. Voce, *Journal of the Institute of Metals* 74 (1948) 537-562.
    ///
    /// # Errors
    /// `Negative` unless q_∞ ≥ 0 and b ≥ 0 are finite.
    pub fn voce(saturation: f64, rate: f64) -> Result<Self, LawError> {
        let kind = Kind::Voce {
            saturation: non_negative(Parameter::Saturation, saturation)?,
            rate: non_negative(Parameter::SaturationRate, rate)?,
        };
        Ok(kind.into())
    }

    /// R = k (e₀ + p)ⁿ − k e₀ⁿ, from the strength k \[MPa\], the offset e₀ and the exponent n: the
    /// yield stress is k (e₀ + p)ⁿ if it starts at [`Self::initial`].
    ///
    /// Source: H. W. Swift, *Journal of the Mechanics and Physics of Solids* 1 (1952) 1-18.
    ///
    /// # Errors
    /// `Negative` unless k ≥ 0 and n ≥ 0 are finite, `NotPositive` unless e₀ > 0 is finite.
    pub fn swift(strength: f64, offset: f64, exponent: f64) -> Result<Self, LawError> {
        let kind = Kind::Swift {
            strength: non_negative(Parameter::Strength, strength)?,
            offset: positive(Parameter::Offset, offset)?,
            exponent: non_negative(Parameter::Exponent, exponent)?,
        };
        Ok(kind.into())
    }

    /// Straight lines between points (p, σ) of a tensile test, constant beyond the last:
    /// R = σ(p) − σ(0), from the plastic strain and the yield stress \[MPa\].
    ///
    /// # Errors
    /// `Table` unless there are points, all finite, the first at p = 0, with rising p and σ that
    /// does not fall.
    pub fn table(points: &[[f64; 2]]) -> Result<Self, LawError> {
        let refused = |row: usize, problem| Err(LawError::Table { row, problem });
        let Some(&[_, initial]) = points.first() else {
            return refused(1, "is missing");
        };
        let mut knots: Vec<Knot> = Vec::with_capacity(points.len());
        for (k, &[p, stress]) in points.iter().enumerate() {
            if !(p.is_finite() && stress.is_finite()) {
                return refused(k + 1, "is not finite");
            }
            let stress = stress - initial;
            let Some(last) = knots.last_mut() else {
                if p != 0.0 {
                    return refused(1, "does not start at no plastic strain");
                }
                knots.push(Knot {
                    p,
                    stress,
                    slope: 0.0,
                    energy: 0.0,
                });
                continue;
            };
            if p <= last.p {
                return refused(
                    k + 1,
                    "does not have more plastic strain than the one before",
                );
            }
            if stress < last.stress {
                return refused(
                    k + 1,
                    "softens: its stress is below the one before, or the yield stress",
                );
            }
            last.slope = (stress - last.stress) / (p - last.p);
            let energy = last.energy + 0.5 * (stress + last.stress) * (p - last.p);
            knots.push(Knot {
                p,
                stress,
                slope: 0.0,
                energy,
            });
        }
        Ok(Kind::Table(knots.into()).into())
    }

    /// The same with a linear part on top, R + H p, from the modulus H \[MPa\].
    ///
    /// # Errors
    /// `Negative` unless H ≥ 0 is finite.
    pub fn with_linear(mut self, modulus: f64) -> Result<Self, LawError> {
        let modulus = non_negative(Parameter::IsotropicModulus, modulus)?;
        match &mut self.kind {
            Kind::Linear { modulus: own } => *own += modulus,
            _ => self.added += modulus,
        }
        Ok(self)
    }

    /// The yield stress k e₀ⁿ at which Swift's law starts by itself \[MPa\]; `None` of the others.
    pub fn initial(&self) -> Option<f64> {
        match &self.kind {
            Kind::Swift {
                strength,
                offset,
                exponent,
            } => Some(strength * offset.powf(*exponent)),
            _ => None,
        }
    }

    /// R(p) \[MPa\].
    #[inline]
    pub fn stress(&self, p: f64) -> f64 {
        let own = match &self.kind {
            Kind::Linear { modulus } => modulus * p,
            Kind::Voce { saturation, rate } => -saturation * (-rate * p).exp_m1(),
            Kind::Swift {
                strength,
                offset,
                exponent,
            } => strength * ((offset + p).powf(*exponent) - offset.powf(*exponent)),
            Kind::Table(knots) => {
                let knot = at(knots, p);
                knot.stress + knot.slope * (p - knot.p)
            }
        };
        own + self.added * p
    }

    /// R'(p) \[MPa\]; at a point of a table that of the line beyond it.
    #[inline]
    pub fn modulus(&self, p: f64) -> f64 {
        let own = match &self.kind {
            Kind::Linear { modulus } => *modulus,
            Kind::Voce { saturation, rate } => saturation * rate * (-rate * p).exp(),
            Kind::Swift {
                strength,
                offset,
                exponent,
            } => strength * exponent * (offset + p).powf(exponent - 1.0),
            Kind::Table(knots) => at(knots, p).slope,
        };
        own + self.added
    }

    /// ψ(p) = ∫₀ᵖ R \[N·mm/mm³\]; convex.
    #[inline]
    pub fn energy(&self, p: f64) -> f64 {
        let own = match &self.kind {
            Kind::Linear { modulus } => 0.5 * modulus * p.powi(2),
            Kind::Voce { rate: 0.0, .. } => 0.0,
            Kind::Voce { saturation, rate } => saturation * (p + (-rate * p).exp_m1() / rate),
            Kind::Swift {
                strength,
                offset,
                exponent,
            } => {
                let power = |e: f64| e.powf(exponent + 1.0) / (exponent + 1.0);
                strength * (power(offset + p) - power(*offset) - offset.powf(*exponent) * p)
            }
            Kind::Table(knots) => {
                let knot = at(knots, p);
                let beyond = p - knot.p;
                knot.energy + (knot.stress + 0.5 * knot.slope * beyond) * beyond
            }
        };
        own + 0.5 * self.added * p.powi(2)
    }

    /// The modulus, if it is the same everywhere.
    #[inline]
    pub(crate) fn constant_modulus(&self) -> Option<f64> {
        match &self.kind {
            Kind::Linear { modulus } => Some(*modulus),
            _ => None,
        }
    }
}

/// The last point that p has reached; of a table with a first point at 0 there is one.
#[inline]
fn at(knots: &[Knot], p: f64) -> &Knot {
    let beyond = knots.partition_point(|knot| knot.p <= p);
    &knots[beyond.max(1) - 1]
}
