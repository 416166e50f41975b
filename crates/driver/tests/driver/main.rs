//! Contracts of the driver's public items.

mod anisotropic;
mod block;
mod coarse;
mod collapse;
mod increments;
mod klarbring;
mod refusals;
mod steps;
mod tools;
