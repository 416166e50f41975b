//! Elastoplastic solids in unilateral contact with Coulomb friction, exactly: the facade of the
//! crates that do the work.
//!
//! | layer | crate | here |
//! |---|---|---|
//! | tensors | `moreau-mandel` | [`mandel`] |
//! | elements, meshes | `moreau-mesh` | [`mesh`] |
//! | laws, bipotentials | `moreau-laws` | [`laws`] |
//! | contact problem and solvers | `moreau-contact` | [`contact`] |
//! | steps and reports | `moreau-driver` | [`driver`] |
//! | charts and pictures | | [`plot`] |

pub mod plot;

pub use moreau_contact as contact;
pub use moreau_driver as driver;
pub use moreau_laws as laws;
pub use moreau_mandel as mandel;
pub use moreau_mesh as mesh;

/// The example of the README, compiled and run.
#[doc = include_str!("../../../README.md")]
#[cfg(doctest)]
pub struct Readme;
