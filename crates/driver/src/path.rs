//! The sequence of increments, and where it ends: collapse and buckling; not the iteration of one.

mod along;
mod axis;
mod bifurcation;
pub(crate) mod buckling;
mod equilibrium;
pub(crate) mod increments;
pub(crate) mod loading;
pub(crate) mod mechanism;
mod predictor;
pub(crate) mod ramp;
mod rest;
