//! What is prescribed of displacements, and what is out of balance beside it; not how much of them.

use crate::vector::SparseVector;
use crate::vector::directions::Directions;

/// The components of displacements that are prescribed.
#[derive(Debug, Default)]
pub(crate) struct Prescribed {
    /// Ascending.
    pub(crate) dofs: Vec<usize>,
    pub(crate) directions: Directions,
}

impl Prescribed {
    /// Takes out of forces what acts on these components.
    pub(crate) fn clear(&self, forces: &mut [f64]) {
        for &dof in &self.dofs {
            self.directions.set(dof, 0.0, forces);
        }
    }
}

/// Forces less the internal ones, at every degree of freedom \[N\]; nothing of those on what is prescribed.
pub(crate) fn residual(
    internal: &[f64],
    forces: &[&SparseVector],
    prescribed: &Prescribed,
) -> Vec<f64> {
    let mut left: Vec<f64> = internal.iter().map(|f| -f).collect();
    forces.iter().for_each(|f| f.add_to(&mut left, 1.0));
    prescribed.clear(&mut left);
    left
}
