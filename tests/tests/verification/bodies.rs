//! Contact of two deformable bodies, meshed as they like, in the plane and in space: patches, a block
//! on an incline, Hertz, rings shrunk on each other, and what no choice of meshes or methods may
//! change; not tools.

mod between;
mod cornered;
mod curved;
mod dragged;
mod folded;
mod grip;
mod held;
mod patches;
mod stack;
mod turned;

use crate::close;
use moreau::driver::{Axis, Driver, Model, ModelError, Settings, Step};
use moreau::laws::{Coulomb, Elastic};
use moreau::mandel::Sym2;
use moreau::mesh::{CellKind, Mesh, Pairing, PlaneStrain, block2, uniform};
use nalgebra::{Matrix3, Rotation2, Rotation3, SMatrix, SVector, Unit, Vector3};
use stack::*;
use std::array::from_fn;
use std::f64::consts::PI;
use verification::problems::Fallible;
use verification::problems::fields::prescribed;

const E: f64 = 210e3;
const NU: f64 = 0.3;
const PRESSURE: f64 = 80.0;
/// Sides of a block along x, y and z.
const WIDTH: f64 = 6.0;
const HEIGHT: f64 = 2.0;
const DEPTH: f64 = 5.0;
