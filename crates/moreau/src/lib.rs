//! Elastoplastic solids in unilateral contact with Coulomb friction, exactly: the facade of the
//! crates that do the work.
//!
//! | layer | crate | here |
//! |---|---|---|
//! | sparse systems | `moreau-algebra` | [`algebra`] |
//! | tensors | `moreau-mandel` | [`mandel`] |
//! | elements, meshes | `moreau-mesh` | [`mesh`] |
//! | laws, bipotentials | `moreau-laws` | [`laws`] |
//! | contact problem and solvers | `moreau-contact` | [`contact`] |
//! | steps, reports, stresses at nodes | `moreau-driver` | [`driver`] |
//! | charts and pictures | | [`plot`] |
//! | problems in text files | | [`deck`] |
//! | mesh files | | [`files`] |
//! | fields of a driver as grids and VTK files | | [`grids`] |
//! | a deck under way, in memory | | [`simulation`], [`table`] |
//! | the same with files around it | | [`run`] |
//! | the command | | `command` |
//! | memory that there is | | [`memory`] |
//!
//! Problems in text files, mesh files and results are behind the feature `decks`, the command behind
//! `command`, both on unless `default-features = false` says otherwise; `png` is off.
//!
//! ```
//! use moreau::{contact::*, driver::*, laws::*, mesh::*};
//!
//! // An elastic block that nothing but a rough floor holds, under pressure.
//! let mesh = block2("block", CellKind::Quad8, &uniform(0.0, 4.0, 4), &uniform(0.0, 2.0, 2))?;
//! let model = Model::new(mesh, PlaneStrain::default())
//!     .material("block", Elastic::new(210e3, 0.3)?, Integration::Reduced)?
//!     .tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
//!     .contact("block.bottom", "floor", Coulomb::new(0.3)?)?;
//! let mut driver = Driver::new(model, Settings::default())?;
//! driver.run(&Step::new("load").pressure("block.top", 10.0), 1, |_, _| {})?;
//! assert!((driver.tool_force("floor")?[1] - 40.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "command")]
pub mod command;
#[cfg(feature = "decks")]
pub mod deck;
#[cfg(feature = "decks")]
pub mod files;
#[cfg(feature = "decks")]
pub mod grids;
#[cfg(feature = "decks")]
pub mod memory;
#[cfg(feature = "decks")]
pub mod numbers;
pub mod plot;
#[cfg(feature = "decks")]
pub mod run;
#[cfg(feature = "decks")]
pub mod simulation;
#[cfg(feature = "decks")]
pub mod table;
#[cfg(feature = "decks")]
mod vtu;

pub use moreau_algebra as algebra;
pub use moreau_contact as contact;
pub use moreau_driver as driver;
pub use moreau_laws as laws;
pub use moreau_mandel as mandel;
pub use moreau_mesh as mesh;

/// The example of the README, compiled and run.
#[doc = include_str!("../../../README.md")]
#[cfg(doctest)]
pub struct Readme;
