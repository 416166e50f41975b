//! The cases of `cargo xtask verify`, in the order of the report.

use crate::Case;

/// All cases.
pub fn all() -> Vec<Case> {
    vec![]
}
