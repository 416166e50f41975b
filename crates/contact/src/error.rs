//! Errors of the contact crate; no messages of the driver.

use nalgebra::DMatrix;

/// What can go wrong when a contact problem is built or solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The parts of a problem do not fit together.
    #[error("{what} has {found} entries, expected {expected}")]
    Dimension {
        /// The part that does not fit.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected: contacts, or components of all contacts.
        expected: usize,
    },
    /// A NaN or an infinity in the data.
    #[error("{what} of the contact problem is not finite")]
    NotFinite {
        /// The part that holds the number.
        what: &'static str,
    },
    /// A datum of an obstacle or of a method is out of its range.
    #[error("{what} is {value}, expected {expected}")]
    OutOfRange {
        /// The datum.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The admissible range in words.
        expected: &'static str,
    },
    /// Triangles that bound nothing.
    #[error("{what}, from {:?} to {:?}{}: expected a closed surface", at[0], at[1], gap(*apart))]
    Surface {
        /// What is wrong with it.
        what: &'static str,
        /// The ends of the edge \[mm\].
        at: [[f64; 3]; 2],
        /// From an end of an open edge to the nearest corner of another one, if it is near \[mm\].
        apart: Option<f64>,
    },
    /// The interface stiffness is singular where the method needs its inverse: a body is held
    /// by contact alone.
    #[error(
        "the interface stiffness is not positive definite (pivot of component {component}): \
         this contact method needs bodies held without contact; semismooth Newton does not"
    )]
    Floating {
        /// Component at which the factorisation broke down.
        component: usize,
    },
    /// A matrix of which only one triangle is read is not symmetric.
    #[error("{what} is {} at {:?} and {} at {:?}, expected a symmetric matrix",
        values[0], (at[0], at[1]), values[1], (at[1], at[0]))]
    Unsymmetric {
        /// The matrix.
        what: &'static str,
        /// Row and column.
        at: [usize; 2],
        /// The entry there, and the one across the diagonal.
        values: [f64; 2],
    },
    /// A matrix that a problem is built from has no inverse.
    #[error(
        "{what} has no positive pivot at component {component}, expected a positive definite matrix"
    )]
    Indefinite {
        /// The matrix.
        what: &'static str,
        /// Component at which the factorisation broke down.
        component: usize,
    },
    /// A contact at which no force moves anything, so that no force can close it.
    #[error(
        "the Delassus operator has a normal compliance of {compliance} at contact {contact}, \
         expected a positive one"
    )]
    Rigid {
        /// The contact.
        contact: usize,
        /// Its normal compliance \[mm/N\].
        compliance: f64,
    },
    /// The Newton matrix of the contact problem is singular: no contact holds the body.
    #[error("the contact problem is singular: no closed contact holds the body")]
    Singular,
    /// Displacement conditions leave the relative displacement of a contact nothing to decide with,
    /// beside those of other contacts.
    #[error(
        "displacement conditions leave contact point {contact} no freedom of its own beside the \
         others: release its node, or prescribe the motion of the tool opposite"
    )]
    Overconstrained {
        /// The contact.
        contact: usize,
    },
    /// The iteration ended above its tolerance.
    #[error(
        "{solver} left a residual of {residual:.3e} N after {iterations} iterations, \
         expected at most {tolerance:.3e} N"
    )]
    NotConverged {
        /// The method.
        solver: &'static str,
        /// Iterations done.
        iterations: usize,
        /// Largest natural-map residual of a contact \[N\].
        residual: f64,
        /// Residual asked for \[N\].
        tolerance: f64,
    },
}

/// Whether the parts of a problem (name, entries found, expected) fit together.
///
/// # Errors
/// [`ContactError::Dimension`] of the first that does not.
pub(crate) fn expect_sizes(
    parts: impl IntoIterator<Item = (&'static str, usize, usize)>,
) -> Result<(), ContactError> {
    let unlike = |&(_, found, expected): &(_, usize, usize)| found != expected;
    match parts.into_iter().find(unlike) {
        Some((what, found, expected)) => Err(ContactError::Dimension {
            what,
            found,
            expected,
        }),
        None => Ok(()),
    }
}

/// Entries across the diagonal, over the largest entry, that differ by more than rounding.
const UNLIKE: f64 = 1e-9;

/// Whether a square matrix is symmetric, beyond rounding.
///
/// # Errors
/// [`ContactError::NotFinite`], [`ContactError::Unsymmetric`].
pub(crate) fn expect_symmetric(what: &'static str, a: &DMatrix<f64>) -> Result<(), ContactError> {
    expect_finite(what, a)?;
    let most = UNLIKE * a.amax();
    let below = (0..a.ncols()).flat_map(|j| (j + 1..a.nrows()).map(move |i| [i, j]));
    let pairs = below.map(|[i, j]| ([i, j], [a[(i, j)], a[(j, i)]]));
    match { pairs }.find(|(_, [v, across])| (v - across).abs() > most) {
        Some((at, values)) => Err(ContactError::Unsymmetric { what, at, values }),
        None => Ok(()),
    }
}

/// Whether all numbers of a part are finite.
///
/// # Errors
/// [`ContactError::NotFinite`].
pub(crate) fn expect_finite<'a>(
    what: &'static str,
    numbers: impl IntoIterator<Item = &'a f64>,
) -> Result<(), ContactError> {
    match numbers.into_iter().all(|v| v.is_finite()) {
        true => Ok(()),
        false => Err(ContactError::NotFinite { what }),
    }
}

fn gap(apart: Option<f64>) -> String {
    apart.map_or_else(String::new, |apart| {
        format!(", where it and another open edge have corners {apart:.1e} mm apart")
    })
}
