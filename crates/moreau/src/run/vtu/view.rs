//! The mesh of a body if it can be drawn: in the plane.

use crate::driver::Driver;
use crate::mesh::Mesh;

/// What is drawn of a driver.
pub trait View {
    /// The mesh of a plane body.
    fn plane(&self) -> Option<&Mesh<2>>;
}

impl View for Driver<2> {
    fn plane(&self) -> Option<&Mesh<2>> {
        Some(self.mesh())
    }
}

impl View for Driver<3> {
    fn plane(&self) -> Option<&Mesh<2>> {
        None
    }
}
