//! Charts and pictures of meshes as SVG text; no files, no windows. Pixels only with the feature
//! `png`, which makes `png` of any SVG.
//!
//! | to draw … | use |
//! |---|---|
//! | curves and markers over two axes | [`Chart`] |
//! | a mesh, deformed, with a field on it | [`MeshPicture`] |
//! | what is known at quadrature points | [`nodal_average`], then [`MeshPicture::field`] |
//!
//! Every picture is a standalone SVG document without a prolog and without ids, so that any number
//! of them may be pasted into one HTML page. Equal data give equal text.
//!
//! ```
//! use moreau::mesh::{CellKind, block2, uniform};
//! use moreau::plot::{Chart, MeshPicture, Style};
//!
//! // An error that halves with the size of the cells.
//! let error: Vec<[f64; 2]> = [1.0, 0.5, 0.25].map(|h| [h, 0.02 * h]).to_vec();
//! let svg = Chart::new("Convergence", "cell size h [mm]", "relative error [–]")
//!     .log_x()
//!     .log_y()
//!     .with("quad4", Style::LinePoints, error)
//!     .to_svg()?;
//! assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>"));
//!
//! // A block that is sheared by 0.1 mm, drawn with ten times its displacement.
//! let mesh = block2("block", CellKind::Quad8, &uniform(0.0, 50.0, 10), &uniform(0.0, 20.0, 4))?;
//! let shear: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| [0.005 * x[1], 0.0]).collect();
//! let size = shear.iter().map(|u| u[0]).collect();
//! let svg = MeshPicture::new(&mesh, "Simple shear")
//!     .deformed(shear, 10.0)
//!     .field("horizontal displacement [mm]", size)
//!     .outline()
//!     .to_svg()?;
//! assert!(svg.contains("Simple shear"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod chart;
mod clip;
mod colour;
mod error;
mod figure;
mod look;
mod nodal;
mod number;
mod pen;
mod picture;
#[cfg(feature = "png")]
mod raster;
mod text;

pub use axis::{ChartAxis, Scale};
pub use chart::{Chart, Series};
pub use colour::colours;
pub use error::PlotError;
pub use figure::below_each_other;
pub use look::Style;
pub use nodal::nodal_average;
pub use picture::{Field, Mark, MeshPicture, View};
#[cfg(feature = "png")]
pub use raster::png;
