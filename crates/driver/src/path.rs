//! The sequence of increments, and where it ends: collapse and buckling; not one increment.

mod along;
mod bifurcation;
pub(crate) mod buckling;
pub(crate) mod increments;
pub(crate) mod loading;
pub(crate) mod mechanism;
mod predictor;
pub(crate) mod ramp;
