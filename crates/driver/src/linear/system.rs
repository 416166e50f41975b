//! The linear system of a mesh, and what it holds: its numbering, its stiffness and its factor; not the iteration
//! that uses it.

use crate::assembly::scatter::{FIXED, Scatter};
use crate::linear::coarse::Coarse;
use crate::linear::others::Others;
use crate::settings::Seam;
use crate::timings::Timings;
use crate::vector::prescribed::Prescribed;
use crate::vector::subspace::Subspace;
pub(crate) use assembled::Assembly;
pub(crate) use choice::Contacts;
use moreau_algebra::{Engine, EngineError, Matrix};

mod assembled;
mod choice;
mod condense;
mod factor;
mod solve;

/// K of the free degrees of freedom, ordered so that those of the interface come last.
///
/// K + σE is what is factorised, with E the identity on the interface: it is positive definite as
/// soon as holding the interface holds the bodies, and the Schur complement of K itself is
/// L_cc L_ccᵀ − σ 1 exactly, even where only contact holds a body and K is singular.
///
/// Where that factor has no room, or would take longer than conjugate gradients, the stiffness of a
/// coarse space takes its place: S is then that of the coarse space, and so are the condensed loads,
/// and what they give is brought to the solution of K itself by conjugate gradients.
#[derive(Debug)]
pub(crate) struct System {
    /// Position of a degree of freedom in the system, or [`FIXED`].
    position: Vec<u32>,
    /// Degree of freedom at a position.
    dofs: Vec<usize>,
    /// The degrees of freedom without one.
    prescribed: Prescribed,
    /// Number of interface unknowns: the last of the system.
    interface: usize,
    /// A node of the interface that no contact point needs.
    pub(crate) pivot: Option<usize>,
    /// Where the cells of every block go.
    scatter: Vec<Scatter>,
    /// Entries of the elastic K that is kept between an unknown and a prescribed displacement: their
    /// degrees of freedom.
    prescribed_columns: Vec<(usize, usize, f64)>,
    /// Whether the elastic stiffness is kept, so that only what flow adds to it is assembled anew.
    keeps_elastic: bool,
    /// K.
    matrix: Matrix,
    /// What is factorised instead where the factor of K is too large.
    coarse: Option<Coarse>,
    /// Where contacts are tied in the factor instead of condensed: the values of K that went into the factor at
    /// hand; empty where there is none.
    tied: Option<Vec<f64>>,
    shift: f64,
    stiffest: f64,
    engine: Box<dyn Engine>,
    /// What other processes hold of K.
    others: Option<Others>,
    /// Whether these have numbered their entries for another system since.
    has_lost_others: bool,
    /// Why the engine has no factor, where that is no fault of the matrix.
    gave_up: Option<EngineError>,
    /// Whether the factor held is that of the elastic stiffness.
    elastic_factor: bool,
    /// Whether the values are those that the factor was made of.
    current: bool,
    /// Negative eigenvalues of the matrix that the factor was made of, where its engine tells.
    negative: usize,
    /// Whether that of some factor of the increment had any.
    unstable: bool,
    /// Factorisations done since the system was set up.
    pub(crate) factorisations: usize,
    /// Iterations of conjugate gradients since then.
    pub(crate) conjugate: usize,
    pub(crate) timings: Timings,
    /// Whether only contact holds some rigid motion.
    pub(crate) floats: bool,
    /// The nodes that each contact point between bodies couples, where contacts are tied.
    pub(crate) paired: Vec<Vec<usize>>,
}

impl System {
    /// Number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.dofs.len()
    }

    /// Entries stored of the factor.
    pub(crate) fn factor_entries(&self) -> usize {
        self.engine.cost().entries as usize
    }

    /// Whether a displacement is unknown.
    pub(crate) fn is_free(&self, dof: usize) -> bool {
        self.position[dof] != FIXED
    }

    /// Directions in which a node is free.
    pub(crate) fn free_at<const D: usize>(&self, node: usize) -> Subspace<D> {
        Subspace::of_node(node, &self.prescribed.directions, |dof| self.is_free(dof))
    }

    /// Index of a degree of freedom among the interface unknowns; `None` if it is prescribed.
    pub(crate) fn interface_index(&self, dof: usize) -> Option<usize> {
        let first = self.size() - self.interface;
        self.is_free(dof)
            .then(|| self.position[dof] as usize - first)
    }

    /// The degrees of freedom that are prescribed, with the directions of all.
    pub(crate) fn prescribed(&self) -> &Prescribed {
        &self.prescribed
    }

    /// σ \[N/mm\]: of the size of the elastic stiffness of an interface node.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// What a vector has along the unknowns, by its entries at degrees of freedom.
    pub(crate) fn at_unknowns(&self, at: impl Fn(usize) -> f64) -> Vec<f64> {
        let directions = &self.prescribed.directions;
        let own = self.dofs.iter();
        own.map(|&dof| directions.component(dof, &at)).collect()
    }

    /// Position of a degree of freedom among the unknowns; `None` if it is prescribed.
    pub(crate) fn unknown(&self, dof: usize) -> Option<u32> {
        Some(self.position[dof]).filter(|&p| p != FIXED)
    }

    /// Entry of K on the diagonal of an unknown \[N/mm\].
    pub(crate) fn diagonal(&self, unknown: u32) -> f64 {
        let others = self
            .others
            .as_ref()
            .map_or(0.0, |o| o.diagonal(unknown as usize));
        self.matrix.diagonal(unknown as usize) + others
    }

    /// Largest diagonal of the elastic stiffness \[N/mm\].
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffest
    }

    /// How contacts are seen.
    pub(crate) fn seam(&self) -> Seam {
        match self.is_tied() {
            true => Seam::Tied,
            false => Seam::Condensed,
        }
    }

    /// Another system has been made: other processes, which keep one numbering at a time, have the entries of that one.
    pub(crate) fn lose_others(&mut self) {
        self.has_lost_others = self.others.is_some();
    }

    /// Whether nothing can be asked of other processes any more, so that the system is to be made anew.
    pub(crate) fn has_lost_others(&self) -> bool {
        self.has_lost_others
    }

    /// Whether the factor is one of K itself.
    pub(crate) fn is_direct(&self) -> bool {
        self.coarse.is_none()
    }
}

#[cfg(test)]
mod tests;
