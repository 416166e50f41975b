//! Contracts of the driver's public items.

mod anisotropic;
mod block;
mod collapse;
mod klarbring;
mod steps;
mod tools;
