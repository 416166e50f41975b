//! What is seen of a body beside its displacement: nodal fields and a picture; in the plane and in
//! space they are had differently.

use crate::driver::{Driver, PointState};
use crate::mandel::von_mises;
use crate::plot::{MeshPicture, PlotError, nodal_average};

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

/// Fields and pictures of a driver.
pub trait View {
    /// Nodal values: in the plane extrapolated and averaged, in space averages of the means of
    /// the cells.
    fn nodal(&self, field: NodalField) -> Vec<f64>;

    /// A picture of the deformed body with a field on it, in the plane only.
    fn picture(
        &self,
        title: &str,
        label: &str,
        field: NodalField,
    ) -> Option<Result<String, PlotError>>;
}

impl View for Driver<2> {
    fn nodal(&self, field: NodalField) -> Vec<f64> {
        nodal_average(self.mesh(), &self.points(), |p| field.of(p))
    }

    fn picture(
        &self,
        title: &str,
        label: &str,
        field: NodalField,
    ) -> Option<Result<String, PlotError>> {
        let mesh = self.mesh();
        let displacement: Vec<[f64; 2]> = (0..mesh.nodes().len())
            .map(|n| self.displacement(n).into())
            .collect();
        let largest = displacement
            .iter()
            .map(|u| u[0].hypot(u[1]))
            .fold(0.0, f64::max);
        let magnification = match largest > 0.0 {
            true => round(0.05 * mesh.size() / largest),
            false => 1.0,
        };
        let picture = MeshPicture::new(mesh, title)
            .deformed(displacement, magnification)
            .field(label, self.nodal(field))
            .outline();
        Some(picture.to_svg())
    }
}

/// 1, 2 or 5 times a power of ten, at most the value.
fn round(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let digit = value / power;
    let digit = [5.0, 2.0].into_iter().find(|d| *d <= digit).unwrap_or(1.0);
    digit * power
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

    fn picture(&self, _: &str, _: &str, _: NodalField) -> Option<Result<String, PlotError>> {
        None
    }
}
