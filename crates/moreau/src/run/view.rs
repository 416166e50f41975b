//! What is seen of a body beside its displacement: nodal fields, and the mesh if it can be drawn; in
//! the plane and in space they are had differently.

use crate::driver::{Driver, PointState};
use crate::mandel::von_mises;
use crate::mesh::Mesh;
use crate::plot::nodal_average;

/// A field of the material, on the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodalField {
    /// Von Mises stress.
    VonMises,
    /// Equivalent plastic strain.
    PlasticStrain,
}

impl NodalField {
    fn of<const D: usize>(self, point: &PointState<D>) -> f64 {
        match self {
            Self::VonMises => von_mises(&point.stress),
            Self::PlasticStrain => point.plastic_strain,
        }
    }
}

/// Fields of a driver.
pub trait View {
    /// Nodal values: in the plane extrapolated and averaged, in space averages of the means of
    /// the cells.
    fn nodal(&self, field: NodalField) -> Vec<f64>;

    /// The mesh of a plane body.
    fn plane(&self) -> Option<&Mesh<2>>;
}

impl View for Driver<2> {
    fn nodal(&self, field: NodalField) -> Vec<f64> {
        nodal_average(self.mesh(), &self.points(), |p| field.of(p))
    }

    fn plane(&self) -> Option<&Mesh<2>> {
        Some(self.mesh())
    }
}

impl View for Driver<3> {
    fn nodal(&self, field: NodalField) -> Vec<f64> {
        let mesh = self.mesh();
        let mut cells = vec![(0.0, 0.0); mesh.cell_count()];
        for point in self.points() {
            cells[point.cell].0 += point.weight * field.of(&point);
            cells[point.cell].1 += point.weight;
        }
        let mut nodes = vec![(0.0, 0.0); mesh.nodes().len()];
        for (cell, (sum, volume)) in cells.into_iter().enumerate() {
            for &node in mesh.cell_nodes(cell) {
                nodes[node].0 += sum;
                nodes[node].1 += volume;
            }
        }
        nodes
            .into_iter()
            .map(|(sum, volume)| sum / volume)
            .collect()
    }

    fn plane(&self) -> Option<&Mesh<2>> {
        None
    }
}
