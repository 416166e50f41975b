//! Incremental driver: bodies and their contacts, step by step; not the laws that hold in them.
//!
//! A [`Model`] is a mesh with materials, tools and contacts; a [`Step`] is what acts on it; the
//! [`Driver`] applies steps increment by increment. Every increment is a transaction: it converges
//! and is committed with a [`IncrementReport`], or it fails and nothing has changed.
//!
//! ```
//! use moreau_contact::Plane;
//! use moreau_driver::{Axis, Driver, Model, Settings, Step};
//! use moreau_laws::{Coulomb, VonMises};
//! use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
//!
//! // A steel block on a rigid foundation with friction, punched by 0.02 mm over half of its top.
//! let mut mesh =
//!     block2("block", CellKind::Quad8, &uniform(0.0, 50.0, 10), &uniform(0.0, 20.0, 2))?;
//! mesh.node_group_where("punch", "block.top", |x| x[0] <= 25.0)?;
//! let model = Model::new(mesh, PlaneStrain::default())
//!     .material("block", VonMises::new(210e3, 0.3, 300.0)?, Integration::Reduced)?
//!     .tool("foundation", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
//!     .contact("block.bottom", "foundation", Coulomb::new(0.1)?)?;
//! let mut driver = Driver::new(model, Settings::default())?;
//! let press = Step::new("press").fix("block.left", &[Axis::X]).displace("punch", Axis::Y, -0.02);
//! let reports = driver.run(&press, 2, |_, _| {})?;
//! let load = -driver.reaction("punch")?[1];
//! assert!((load - 6940.075726).abs() < 1e-5);
//! assert!(reports[1].relative_gap() < 1e-10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod checks;
mod driver;
mod error;
mod interface;
mod linear;
mod model;
mod newton;
mod path;
mod recovery;
mod report;
mod saved;
mod settings;
mod threads;
mod timings;
mod vector;

pub use assembly::block::{Block, BlockEnergy, CellResult, PointField, PointState, SolidBlock};
pub use assembly::cell_law::{CellLaw, CellOutput, Motion, Stiffness};
pub use assembly::cells::{Cells, ElementCells};
pub use assembly::large::Large;
pub use assembly::panel::PanelBlock;
pub use assembly::small::Small;
pub use checks::ahead::Ahead;
pub use checks::beside::Beside;
pub use checks::between::Between;
pub use checks::gaps::LeastGap;
pub use checks::narrow::Narrow;
pub use checks::rigid::Stopper;
pub use checks::smallness::{Deformation, Extent};
pub use checks::strides::Stride;
pub use checks::supports::{RigidMotion, Support};
pub use checks::swings::Swing;
pub use driver::Driver;
pub use error::{Imbalance, IncrementError, LawFault, ModelError, Place, ToolOutOfContact};
pub use model::Model;
pub use model::analysis::Analysis;
pub use model::load::{Axis, Loading, Step};
pub use model::temperature::{Field, Temperature};
pub use path::buckling::Buckling;
pub use path::increments::Increments;
pub use path::ramp::Ramp;
pub use recovery::{Recovered, points_by_material, recover};
pub use report::collapse::{Collapse, UpperBound};
pub use report::{ContactRecord, Energies, IncrementReport, Iteration};
pub use saved::{Numbers, Saved};
pub use settings::{Nesting, Seam, Settings};
pub use threads::threads;
pub use timings::{Clock, Timings};
pub use vector::SparseVector;
pub use vector::directions::Directions;
