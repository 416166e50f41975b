//! What the statuses of its contacts leave free of a condensed system, stable or not; not the contact problem.

use crate::interface::condensation::InFrames;
use crate::interface::elimination::Transformation;
use moreau_algebra::{DenseCholesky, DenseLdlt};
use nalgebra::{DMatrix, DVector};

/// The interface in the components of relative displacements that are free, and in the unknowns y that no contact
/// force acts on.
pub(crate) struct Free {
    transformation: Transformation,
    /// Of all components of contacts and the y after them.
    free: Vec<usize>,
    /// S on these, and the springs of what gives way with one \[N/mm\].
    stiffness: DMatrix<f64>,
}

impl Free {
    /// Of `components` of contacts, each of which gives way against a spring \[N/mm\], or not at all.
    pub(crate) fn new(
        frames: InFrames,
        components: usize,
        gives: impl Fn(usize) -> Option<f64>,
    ) -> Self {
        let InFrames {
            transformation,
            stiffness,
            ..
        } = frames;
        let own = (0..components).filter_map(|k| Some((k, gives(k)?)));
        let rest = (components..stiffness.nrows()).map(|k| (k, 0.0));
        let (free, springs): (Vec<usize>, Vec<f64>) = own.chain(rest).unzip();
        let mut own =
            DMatrix::from_fn(free.len(), free.len(), |i, j| stiffness[(free[i], free[j])]);
        for (i, spring) in springs.into_iter().enumerate() {
            own[(i, i)] += spring;
        }
        Self {
            transformation,
            free,
            stiffness: own,
        }
    }

    /// Negative eigenvalues of the stiffness, but those below a part of the largest diagonal.
    pub(crate) fn negative(&self, none: f64) -> usize {
        if DenseCholesky::new(self.stiffness.clone()).is_some() {
            return 0;
        }
        let none = none * self.stiffness.diagonal().amax();
        self.factor().map_or(0, |f| f.inertia(none).negative)
    }

    /// Its factor, of any sign; `None` where it holds what is no number.
    pub(crate) fn factor(&self) -> Option<DenseLdlt> {
        DenseLdlt::new(self.stiffness.clone())
    }

    /// Interface displacements x under forces g at the interface unknowns \[N\].
    pub(crate) fn displacement(&self, factor: &DenseLdlt, g: &DVector<f64>) -> DVector<f64> {
        let g = self.transformation.transposed(g);
        let mut own = DVector::from_iterator(self.free.len(), self.free.iter().map(|&k| g[k]));
        factor.solve(&mut own);
        let mut z = DVector::zeros(g.len());
        for (&k, own) in self.free.iter().zip(own.iter()) {
            z[k] = *own;
        }
        self.transformation.apply(&z)
    }
}
