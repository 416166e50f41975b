//! What can be wrong with the data of a law; not numerical failures, of which these laws have none.

use std::fmt;

/// A parameter of a law; displayed as its name in a sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Parameter {
    /// Young's modulus E.
    YoungsModulus,
    /// Yield stress σ_y.
    YieldStress,
    /// Modulus H of isotropic hardening.
    IsotropicModulus,
    /// Modulus C of a term of kinematic hardening.
    KinematicModulus,
    /// Recall γ of a term of kinematic hardening.
    Recall,
    /// Saturation q_∞ of Voce's hardening.
    Saturation,
    /// Rate b of Voce's hardening.
    SaturationRate,
    /// Strength k of Swift's hardening.
    Strength,
    /// Offset e₀ of Swift's hardening.
    Offset,
    /// Exponent n of Swift's hardening.
    Exponent,
    /// Limit g₀ of the shear in a contact.
    FrictionLimit,
    /// Coefficient of friction along the first tangent.
    FrictionAlong,
    /// Coefficient of friction along the second tangent.
    FrictionAcross,
    /// Friction k_f of a soil.
    MaterialFriction,
    /// Mean stress c₀ of the apex of a cone.
    Apex,
    /// Cohesion c of a soil.
    Cohesion,
    /// Friction angle φ of a soil.
    FrictionAngle,
    /// Dilatancy angle ψ of a soil.
    DilatancyAngle,
    /// Another one, by its name.
    Other(&'static str),
}

impl From<&'static str> for Parameter {
    fn from(name: &'static str) -> Self {
        Self::Other(name)
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::YoungsModulus => "Young's modulus",
            Self::YieldStress => "yield stress",
            Self::IsotropicModulus => "isotropic hardening modulus",
            Self::KinematicModulus => "kinematic hardening modulus",
            Self::Recall => "recall of kinematic hardening",
            Self::Saturation => "saturation of hardening",
            Self::SaturationRate => "rate of hardening",
            Self::Strength => "strength of hardening",
            Self::Offset => "offset of hardening",
            Self::Exponent => "exponent of hardening",
            Self::FrictionLimit => "friction limit",
            Self::FrictionAlong => "friction along the first tangent",
            Self::FrictionAcross => "friction along the second tangent",
            Self::MaterialFriction => "friction of the material",
            Self::Apex => "apex stress",
            Self::Cohesion => "the cohesion",
            Self::FrictionAngle => "the friction angle",
            Self::DilatancyAngle => "the dilatancy angle",
            Self::Other(name) => name,
        })
    }
}

/// Data that define no law. Every constructor checks its data, so a constructed law is valid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// A modulus or limit that must be positive and finite is not.
    #[error("{parameter} must be positive and finite, got {value}")]
    NotPositive {
        /// The quantity.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// A modulus that must be non-negative and finite is not.
    #[error("{parameter} must be non-negative and finite, got {value}")]
    Negative {
        /// The quantity.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// Poisson's ratio outside the open interval ]−1, ½[ of isotropic stability, or within 10⁻⁹ of its ends.
    #[error(
        "Poisson's ratio must lie in ]-1, 0.5[, no nearer to its ends than 1e-9, got {poisson}"
    )]
    PoissonOutOfRange {
        /// The ratio ν.
        poisson: f64,
    },
    /// A coefficient of friction that is negative, infinite or NaN.
    #[error("the coefficient of friction must be non-negative and finite, got {friction}")]
    NegativeFriction {
        /// The coefficient μ.
        friction: f64,
    },
    /// A dilatancy outside [0, friction]: the bipotential would not be convex.
    #[error("the dilatancy must lie in [0, {friction}], the friction, got {dilatancy}")]
    DilatancyOutOfRange {
        /// The dilatancy k_t.
        dilatancy: f64,
        /// The friction k_f that bounds it.
        friction: f64,
    },
    /// An angle of a soil outside its range.
    #[error("{parameter} must lie in {range}, in degrees, got {degrees}")]
    AngleOutOfRange {
        /// The angle.
        parameter: Parameter,
        /// Its value in degrees.
        degrees: f64,
        /// The range in words.
        range: &'static str,
    },
    /// A table of hardening that is none.
    #[error("row {row} of the hardening table {problem}")]
    Table {
        /// The row, counted from 1.
        row: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// An energy or a criterion of a material with axes that is not positive in every direction.
    #[error("{of} is not positive definite: some strain or stress would cost nothing")]
    NotDefinite {
        /// What is not.
        of: &'static str,
    },
    /// A table of the bound of the shear that is none.
    #[error("row {row} of the friction table {problem}")]
    ShearTable {
        /// The row, counted from 1.
        row: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A damage outside [0, 1[.
    #[error("the damage must lie in [0, 1[, got {damage}")]
    DamageOutOfRange {
        /// The damage D.
        damage: f64,
    },
}

/// The value, if it is positive and finite: the check of a constructor.
///
/// # Errors
/// [`LawError::NotPositive`].
pub fn positive(parameter: impl Into<Parameter>, value: f64) -> Result<f64, LawError> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    let parameter = parameter.into();
    Err(LawError::NotPositive { parameter, value })
}

/// The value, if it is non-negative and finite: the check of a constructor.
///
/// # Errors
/// [`LawError::Negative`].
pub fn non_negative(parameter: impl Into<Parameter>, value: f64) -> Result<f64, LawError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(value);
    }
    let parameter = parameter.into();
    Err(LawError::Negative { parameter, value })
}
