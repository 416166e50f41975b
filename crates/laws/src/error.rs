//! What can be wrong with the data of a law; not numerical failures, of which these laws have none.

/// Data that define no law. Every constructor checks its data, so a constructed law is valid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// A modulus or limit that must be positive and finite is not.
    #[error("{name} must be positive and finite, got {value}")]
    NotPositive {
        /// The quantity.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A modulus that must be non-negative and finite is not.
    #[error("{name} must be non-negative and finite, got {value}")]
    Negative {
        /// The quantity.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Poisson's ratio outside the open interval ]−1, ½[ of isotropic stability.
    #[error("Poisson's ratio must lie in ]-1, 0.5[, got {poisson}")]
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
    #[error("{name} must lie in {range}, in degrees, got {degrees}")]
    AngleOutOfRange {
        /// The angle.
        name: &'static str,
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
    /// A damage outside [0, 1[.
    #[error("the damage must lie in [0, 1[, got {damage}")]
    DamageOutOfRange {
        /// The damage D.
        damage: f64,
    },
}

/// The value, if it is positive and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, LawError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(LawError::NotPositive { name, value })
    }
}

/// The value, if it is non-negative and finite.
pub(crate) fn non_negative(name: &'static str, value: f64) -> Result<f64, LawError> {
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(LawError::Negative { name, value })
    }
}
