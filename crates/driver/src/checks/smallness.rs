//! How far displacements are from small ones, on which the analysis is linear in them: strains, rotations,
//! cells turned inside out; not what large ones would change.

use crate::assembly::block::PointState;
use crate::driver::Driver;
use moreau_mandel::from_matrix;
use nalgebra::Matrix3;

/// The largest value of a field, and how much of the body is beyond what counts as small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent<const D: usize> {
    /// The largest value at a quadrature point.
    pub largest: f64,
    /// The cell with it.
    pub cell: usize,
    /// Where it is in the undeformed body \[mm\].
    pub position: [f64; D],
    /// Part beyond the limit, of the sum of |σ : ε| or, if that is more, of the volume.
    pub beyond: f64,
}

impl<const D: usize> Extent<D> {
    const NONE: Self = Self {
        largest: 0.0,
        cell: 0,
        position: [0.0; D],
        beyond: 0.0,
    };

    fn reach(&mut self, value: f64, point: &PointState<D>) {
        if value > self.largest {
            (self.largest, self.cell, self.position) = (value, point.cell, point.position);
        }
    }
}

/// How large the deformation since the virgin state is.
///
/// With the displacement gradient H, the strain of a large deformation is ε + ½ HᵀH: what is left out is
/// of the size of the strain squared and of the rotation squared. One cell at the corner of a punch is
/// strained without bound by a finer mesh; what counts is how much of the work of the stresses,
/// and of the volume, is beyond the limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Deformation<const D: usize> {
    /// Principal strains in magnitude; beyond [`Deformation::STRAIN`].
    pub strain: Extent<D>,
    /// Rotations \[rad\]; beyond [`Deformation::ROTATION`].
    pub rotation: Extent<D>,
    /// Cells that the displacements turn inside out, each with its worst point where that is now \[mm\].
    pub inverted: Vec<(usize, [f64; D])>,
}

impl<const D: usize> Deformation<D> {
    /// Principal strain up to which strains count as small.
    pub const STRAIN: f64 = 0.05;
    /// Rotation up to which rotations count as small \[rad\]: 10°, of which 1 − cos is 1.5 %.
    pub const ROTATION: f64 = 10.0 * std::f64::consts::PI / 180.0;
}

/// Displacement gradient below which no cell is turned inside out, extrapolated to its nodes or not.
const FAR_FROM_INVERTED: f64 = 0.1;

/// Part of the work, or of the volume, that is not told as one at the corners of a punch.
const TENTH: f64 = 0.1;

/// Largest principal value in magnitude of a symmetric matrix, if that is above a bound.
fn principal(a: &Matrix3<f64>, bound: f64) -> f64 {
    match a.norm() > bound {
        true => a.symmetric_eigenvalues().amax(),
        false => 0.0,
    }
}

impl<const D: usize> Driver<D> {
    /// How large strains and rotations have become.
    pub fn deformation(&self) -> Deformation<D> {
        let (mut strain, mut rotation) = (Extent::NONE, Extent::NONE);
        let (mut all, mut strained, mut turned) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        let mut steepest: f64 = 0.0;
        let u = &self.state.displacement[..self.mesh_dofs()];
        for block in &self.blocks {
            block.gradients(u, &mut |point, h| {
                let linear = (h + h.transpose()) * 0.5;
                let skew = (h - h.transpose()) * 0.5;
                // Twice the square of the angle is the sum of the squares of all entries.
                let angle = skew.norm() / std::f64::consts::SQRT_2;
                let bound = strain.largest.min(Deformation::<D>::STRAIN);
                let stretch = principal(&linear, bound);
                let power = point.stress.dot(&from_matrix(&linear));
                let shares = [point.weight * power.abs(), point.weight];
                steepest = steepest.max(h.norm());
                strain.reach(stretch, point);
                rotation.reach(angle, point);
                for k in 0..2 {
                    all[k] += shares[k];
                    strained[k] +=
                        f64::from(u8::from(stretch > Deformation::<D>::STRAIN)) * shares[k];
                    turned[k] +=
                        f64::from(u8::from(angle > Deformation::<D>::ROTATION)) * shares[k];
                }
            });
        }
        let part = |of: [f64; 2]| {
            let parts = [0, 1].map(|k| if all[k] > 0.0 { of[k] / all[k] } else { 0.0 });
            parts[0].max(parts[1])
        };
        (strain.beyond, rotation.beyond) = (part(strained), part(turned));
        let inverted = match steepest > FAR_FROM_INVERTED {
            true => {
                let nodes = 0..self.mesh.nodes().len();
                let positions: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
                self.mesh.inverted(&positions)
            }
            false => Vec::new(),
        };
        Deformation {
            strain,
            rotation,
            inverted,
        }
    }

    /// The strain of the last increment that a tenth of the work, or of the volume if that has more, exceeds where plastic
    /// strain has been: the largest principal logarithmic strain in magnitude, of the positions at the start of the increment.
    /// Laws go straight from one deformation to the next, and what is on the way is not seen.
    pub fn strain_of_increment(&self) -> f64 {
        let Some((d_u, _)) = &self.state.last else {
            return 0.0;
        };
        let (d_u, u) = (
            &d_u[..self.mesh_dofs()],
            &self.state.displacement[..self.mesh_dofs()],
        );
        let (mut strained, mut all) = (Vec::new(), [0.0; 2]);
        for block in &self.blocks {
            let mut last = Vec::new();
            block.gradients(d_u, &mut |_, h| last.push(*h));
            let mut last = last.into_iter();
            block.gradients(u, &mut |point, h| {
                let d_h = last.next().unwrap_or_default();
                let Some(before) = (Matrix3::identity() + h - d_h).try_inverse() else {
                    return;
                };
                let stretch = Matrix3::identity() + d_h * before;
                let squares = (stretch.transpose() * stretch).symmetric_eigenvalues();
                let strain = squares.map(|square| 0.5 * square.ln()).amax();
                let power = point.stress.dot(&from_matrix(
                    &(0.5 * (stretch + stretch.transpose()) - Matrix3::identity()),
                ));
                let shares = [point.weight * power.abs(), point.weight];
                (0..2).for_each(|k| all[k] += shares[k]);
                if point.plastic_strain > 0.0 {
                    strained.push((strain, shares));
                }
            });
        }
        strained.sort_by(|a, b| b.0.total_cmp(&a.0));
        let exceeded = |k: usize| {
            let mut left = TENTH * all[k];
            let found = strained.iter().find(|(_, shares)| {
                left -= shares[k];
                left < 0.0
            });
            found.map_or(0.0, |(strain, _)| *strain)
        };
        exceeded(0).max(exceeded(1))
    }

    /// The quality of the worst cell where the body is, which cell that is, and where, as
    /// [`Mesh::worst_quality`](moreau_mesh::Mesh::worst_quality) has it.
    pub fn worst_quality(&self) -> (f64, usize, [f64; D]) {
        let nodes = 0..self.mesh.nodes().len();
        let positions: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
        self.mesh.worst_quality(&positions)
    }

    /// K_σ v of the committed stresses σ: ∫ (∂v/∂x · σ) : ∂δv/∂x dΩ at every degree of freedom \[N\].
    pub(crate) fn stress_stiffness(&self, v: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.state.displacement.len()];
        for block in &self.blocks {
            block.add_stress_stiffness(v, &mut force);
        }
        force
    }
}
