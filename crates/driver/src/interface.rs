//! Contact points seen from the bodies: where they are, and the problem that a linearised increment leaves of
//! them; not its solution.

pub(crate) mod condensation;
pub(crate) mod corners;
pub(crate) mod elimination;
pub(crate) mod free;
pub(crate) mod grips;
pub(crate) mod grounds;
pub(crate) mod kinematics;
pub(crate) mod nearby;
pub(crate) mod pairing;
pub(crate) mod redistribution;
pub(crate) mod tied;
