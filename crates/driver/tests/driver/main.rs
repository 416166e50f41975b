//! Contracts of the driver's public items.

mod block;
mod collapse;
mod steps;
mod tools;
