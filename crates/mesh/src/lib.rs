//! Finite elements, quadrature, modelling hypotheses and meshes with named groups; nothing here
//! knows a constitutive law or an unknown, or opens a file.
//!
//! | to … | use |
//! |---|---|
//! | interpolate in a cell, `u = N U` \[76\] | [`Element`]: [`Tri3`], [`Tri6`], [`Quad4`], [`Quad8`], [`Quad9`], [`Tet4`], [`Tet10`], [`Hex8`], [`Hex20`], [`Hex27`] |
//! | integrate over it, \[78\] | [`Element::rule`], [`Rule`], [`Integration`] |
//! | strain it, `ε = B U` \[77\] | [`Hypothesis`]: [`PlaneStrain`], [`PlaneStress`], [`Axisymmetric`], [`Solid`] |
//! | hold nodes, cells and named groups | [`Mesh`], always valid once constructed |
//! | pair two surfaces | [`Mesh::mortar_rows`] |
//! | make one | [`block2`], [`block3`] on the lines of [`uniform`], [`geometric`], [`refine`] |
//! | read one, from the bytes of a file | [`read_gmsh`], [`read_abaqus`] |
//! | read a surface in space | [`read_stl`], [`read_gmsh_skin`] |
//! | write one | [`write_gmsh`] |
//!
//! Cells are numbered as in Gmsh, lengths are in millimetres, tensors are Mandel vectors
//! `[11, 22, 33, √2·23, √2·13, √2·12]`.
//!
//! ```
//! use moreau_mesh::{CellKind, MeshError, PlaneStrain, block2, uniform};
//!
//! # fn main() -> Result<(), MeshError> {
//! // A block of 50 mm by 20 mm with named sides, as 10 × 2 quadratic cells.
//! let mesh = block2(
//!     "block",
//!     CellKind::Quad8,
//!     &uniform(0.0, 50.0, 10),
//!     &uniform(0.0, 20.0, 2),
//! )?;
//! assert_eq!(mesh.cell_count(), 20);
//!
//! // A uniform pressure loads the nodes of one quadratic edge by 1/6, 2/3 and 1/6.
//! let top = mesh.facet_group("block.top")?;
//! let shares = mesh.facet_shares(&top[..1], &PlaneStrain::default());
//! let areas: Vec<f64> = shares.iter().map(|share| share.area / 5.0).collect();
//! for (area, exact) in areas.iter().zip([1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]) {
//!     assert!((area - exact).abs() < 1e-14);
//! }
//!
//! // A misspelt group is an error that names the nearest one.
//! let error = mesh.node_group("block.botom").unwrap_err();
//! assert!(error.to_string().contains("block.bottom"));
//! # Ok(())
//! # }
//! ```

pub mod abaqus;
pub mod cell;
pub mod element;
pub mod error;
pub mod generate;
mod geometry;
pub mod gmsh;
pub mod hypothesis;
pub mod mesh;
mod nearest;
pub mod pairing;
pub mod quadrature;
pub mod read;
mod sample;
pub mod skin;

pub use abaqus::{read_abaqus, read_abaqus_noting};
pub use cell::{CellKind, FacetKind, UnknownKind};
pub use element::{
    Element, Hex8, Hex20, Hex27, Line2, Line3, Mapped, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6,
};
pub use error::{GroupKind, MeshError};
pub use generate::{block2, block3, geometric, refine, uniform};
pub use gmsh::{read_gmsh, read_gmsh_noting, read_gmsh_skin, write_gmsh};
pub use hypothesis::{Axisymmetric, Entry, Hypothesis, PlaneStrain, PlaneStress, Solid};
pub use mesh::{Facet, Mesh, NodeKind, PositiveShare, Pressed, Share};
pub use nearest::nearest;
pub use pairing::{Fold, Intrusion, MortarRow, MultiplierChoices, Pairing};
pub use quadrature::{Integration, Point, Rule, gauss};
pub use read::{Loss, Place, ReadError};
pub use skin::{Skin, read_stl};
