//! What a law that is given from outside cannot answer, and where; not the laws.

use std::fmt;

/// A quadrature point.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Cell of the mesh.
    pub cell: usize,
    /// Point of the cell, from 0.
    pub point: usize,
    /// Its position in the undeformed body \[mm\].
    pub position: Vec<f64>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            cell,
            point,
            position,
        } = self;
        write!(f, "at point {point} of cell {cell}, {position:?}")
    }
}

/// A law of panels that has no answer, or one that is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawFault {
    /// It says so itself.
    #[error("the law of a material has no answer: {problem}")]
    NoAnswer {
        /// What it says.
        problem: String,
    },
    /// Something is no number: as a law answers a strain that it does not reach. Whoever is in search of balance turns
    /// back from there.
    #[error("the {what} of the law of a material is no number {place}")]
    NotFinite {
        /// `"stress"`, `"tangent"` or `"state"`.
        what: &'static str,
        /// Where.
        place: Place,
    },
    /// A tangent is not as symmetric as the law says that all are.
    #[error(
        "the tangent of the law of a material is off symmetry by {found:.3e} MPa {place}, expected at most \
         {allowed:.3e} MPa: correct it, or let the law say that it is not symmetric"
    )]
    Unsymmetric {
        /// Largest difference of two entries that should be one \[MPa\].
        found: f64,
        /// What rounding explains \[MPa\].
        allowed: f64,
        /// Where.
        place: Place,
    },
    /// The tangent of a point at rest is not that of an elastic body.
    #[error(
        "the tangent of the law of a material at rest is not symmetric and positive definite: nothing is elastic to \
         begin with"
    )]
    NotElastic,
}

impl LawFault {
    /// Whether it is an error of the law, at which an increment is given up as if it had not begun, and not just a
    /// strain that is too large.
    pub fn breaks_off(&self) -> bool {
        !matches!(self, Self::NotFinite { .. })
    }
}
