//! The linear system of a mesh, its factor or what replaces it; no contact.

pub(crate) mod coarse;
pub(crate) mod everywhere;
pub(crate) mod others;
pub(crate) mod suspension;
pub(crate) mod system;
