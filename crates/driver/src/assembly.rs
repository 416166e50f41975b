//! Cells with their laws, and where what they give is added up; not the factor of the sum.

pub(crate) mod block;
pub(crate) mod cell_law;
pub(crate) mod cells;
pub(crate) mod large;
pub(crate) mod numbering;
pub(crate) mod panel;
pub(crate) mod scatter;
pub(crate) mod small;
pub(crate) mod spread;
pub(crate) mod turned;
