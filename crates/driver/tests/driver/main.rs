//! Contracts of the driver's public items.

mod anisotropic;
mod block;
mod collapse;
mod steps;
mod tools;
