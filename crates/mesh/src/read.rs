//! What the readers of mesh files share: their error, and the way from numbered nodes and elements
//! to a [`Mesh`](crate::Mesh); knows no file format.

mod draft;
mod error;
mod loss;

pub(crate) use draft::{Cell, Draft, Side};
pub use error::{Place, ReadError};
pub use loss::Loss;
