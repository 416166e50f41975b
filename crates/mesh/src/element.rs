//! Nodal elements on reference cells, one a file; not the cells of a mesh, which choose one of
//! these at run time by their [`CellKind`](crate::CellKind).

mod hex20;
mod hex27;
mod hex8;
mod line2;
mod line3;
mod quad4;
mod quad8;
mod quad9;
mod tet10;
mod tet4;
mod tri3;
mod tri6;

pub use hex8::Hex8;
pub use hex20::Hex20;
pub use hex27::Hex27;
pub use line2::Line2;
pub use line3::Line3;
pub use quad4::Quad4;
pub use quad8::Quad8;
pub use quad9::Quad9;
pub use tet4::Tet4;
pub use tet10::Tet10;
pub use tri3::Tri3;
pub use tri6::Tri6;

use crate::geometry::{basis, cofactors, dot, interpolate};
use crate::quadrature::{Integration, Rule};

/// Nodal element on a reference cell of R^D with N nodes, numbered as in Gmsh; implemented by
/// zero-sized types.
///
/// The N_a are the interpolation of \[76\], u = N U: N_a(ξ_b) = δ_ab and Σ N_a = 1.
pub trait Element<const D: usize, const N: usize>: 'static + Send + Sync {
    /// Reference coordinates ξ_a of the nodes, corners first.
    const NODES: [[f64; D]; N];

    /// Nodes of the facets: corners first, then mid-side nodes, each after the corner of the same
    /// place, then the middle.
    ///
    /// Facets are oriented outwards: walking a facet of the plane from its first to its second
    /// node, the cell is on the left; seen from outside, a facet in space turns anticlockwise.
    const FACETS: &'static [&'static [usize]];

    /// Shape functions N_a(ξ) \[–\].
    fn shape(xi: [f64; D]) -> [f64; N];

    /// Their gradients ∂N_a/∂ξ_j in the reference cell \[–\]; Σ_a ∂N_a/∂ξ_j = 0.
    fn shape_gradient(xi: [f64; D]) -> [[f64; D]; N];

    /// The quadrature rule that integrates the nodal forces \[78\] over the cell.
    fn rule(integration: Integration) -> Rule<D>;

    /// The isoparametric map x(ξ) = Σ N_a(ξ) x_a of a cell with the given nodes \[mm\], and the
    /// shape functions as functions of x.
    ///
    /// The determinant is positive in the cells of a [`Mesh`](crate::Mesh); where it is zero the
    /// gradients are not finite.
    fn map(nodes: &[[f64; D]; N], xi: [f64; D]) -> Mapped<D, N> {
        let shape = Self::shape(xi);
        let reference = Self::shape_gradient(xi);
        let g = basis(&reference, nodes);
        let c = cofactors(&g);
        let det = dot(&g[0], &c[0]);
        let gradient = reference
            .map(|d| std::array::from_fn(|i| (0..D).map(|j| d[j] * c[j][i]).sum::<f64>() / det));
        Mapped {
            x: interpolate(&shape, nodes),
            shape,
            gradient,
            det,
        }
    }
}

/// A point of a cell, with what assembling needs there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapped<const D: usize, const N: usize> {
    /// Position x \[mm\].
    pub x: [f64; D],
    /// Shape functions N_a \[–\].
    pub shape: [f64; N],
    /// Their gradients ∂N_a/∂x_i \[1/mm\].
    pub gradient: [[f64; D]; N],
    /// Determinant of ∂x/∂ξ \[mm^D\], the factor from reference to physical volume.
    pub det: f64,
}
