//! What an increment counts on its way; not what is told of it.

/// What an increment has counted.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    pub(crate) newton: usize,
    pub(crate) solves: usize,
    pub(crate) contact: usize,
    /// Iterations of the contact solver in the last solve.
    pub(crate) last_contact: usize,
    pub(crate) shortened: usize,
    pub(crate) factorisations: usize,
    /// Iterations of conjugate gradients, and steps for what a symmetric tangent lacks or for surfaces that move.
    pub(crate) linear: usize,
    /// [`IncrementReport::contact_solves`].
    pub(crate) contact_solves: usize,
    /// Factorisations, and iterations of conjugate gradients, that the system had done before.
    pub(crate) before: (usize, usize),
    pub(crate) residuals: Vec<f64>,
    /// [`IncrementReport::criticality`].
    pub(crate) criticality: Option<(usize, f64)>,
    /// [`IncrementReport::negative_eigenvalues`].
    pub(crate) negative: usize,
    /// Whether the statuses have left a rigid motion free on the way.
    pub(crate) undetermined: bool,
}

impl Counts {
    /// Takes over what a part of the increment has counted.
    pub(crate) fn add(&mut self, part: &Self) {
        self.newton += part.newton;
        self.solves += part.solves;
        self.contact += part.contact;
        self.shortened += part.shortened;
        self.factorisations += part.factorisations;
        self.linear += part.linear;
        self.contact_solves += part.contact_solves;
        self.undetermined |= part.undetermined;
        self.criticality = part.criticality;
        self.negative = part.negative;
        self.residuals.extend(&part.residuals);
    }

    /// These, with those of the way that led to balance.
    pub(crate) fn with(mut self, last: Self) -> Self {
        self.add(&last);
        self.undetermined = last.undetermined;
        self
    }

    /// Whether the last step has left about as much out of balance as the one before.
    pub(crate) fn no_longer_improves(&self) -> bool {
        match self.residuals.as_slice() {
            [.., before, now] => *now >= 0.25 * before,
            _ => false,
        }
    }
}
