//! One increment by Newton's method; not the sequence of increments.

pub(crate) mod chord;
pub(crate) mod commit;
pub(crate) mod control;
pub(crate) mod criteria;
pub(crate) mod descent;
pub(crate) mod following;
pub(crate) mod heat;
pub(crate) mod increment;
pub(crate) mod iterate;
pub(crate) mod line_search;
pub(crate) mod linearised;
pub(crate) mod nested;
pub(crate) mod pressures;
pub(crate) mod stability;
pub(crate) mod tangent;
pub(crate) mod unsymmetric;
