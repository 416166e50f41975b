//! Where a body lies that nothing holds: as near as it can be to where it was; not whether anything holds it.

use crate::assembly::cell_law::Stiffness;
use crate::checks::rigid::{RigidModes, Stopper, null_space};
use crate::checks::supports::resists;
use crate::driver::Driver;
use crate::error::{IncrementError, ModelError};
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::newton::iterate::Candidate;
use crate::report::Iteration;
use crate::vector::SparseVector;
use nalgebra::{DMatrix, DVector, SVector};
use std::ops::ControlFlow;

/// Motion over the size of the mesh that is none.
const STILL: f64 = 1e-9;

/// Part of what the bodies have moved that makes another equilibrium the nearer one.
const LESS: f64 = 0.999;

impl<const D: usize> Driver<D> {
    /// Of the equilibria that differ by rigid motions which nothing resists, the one in which the bodies have moved least:
    /// where iterates, or what an increment like the last one lets expect, have taken them is no property of the model. From
    /// one of these the motions are taken back, as far as surfaces let that happen.
    ///
    /// # Errors
    /// [`IncrementError::Interrupted`]; [`Driver::follow_surfaces`].
    pub(crate) fn nearest(
        &mut self,
        system: &mut System,
        (start, end): (&Loading<D>, &Loading<D>),
        found: Candidate<D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Candidate<D>, IncrementError> {
        let Some(d_u) = self.moved_back(end, &found) else {
            return Ok(found);
        };
        let dofs = self.mesh_dofs();
        let moved = |of: &Candidate<D>| {
            let squares = of.d_u[..dofs].iter().map(|u| u * u);
            squares.sum::<f64>().sqrt()
        };
        let far = moved(&found);
        let mut increment = self.begin_increment(system, (start, end), d_u, None);
        increment.loose = true;
        match self.balance(system, increment, watch) {
            Ok(mut nearer) if moved(&nearer) < LESS * far => {
                self.spent.add(&found.counts);
                nearer.counts.undetermined = true;
                Ok(nearer)
            }
            Err(error) if error.is_broken_off() => Err(error),
            _ => {
                self.evaluate(system, end, &found.d_u)?;
                Ok(found)
            }
        }
    }

    /// Evaluates bodies and surfaces at displacement increments, as what is committed has to be the last that was.
    ///
    /// # Errors
    /// [`Driver::follow_surfaces`].
    pub(crate) fn evaluate(
        &mut self,
        system: &mut System,
        end: &Loading<D>,
        d_u: &[f64],
    ) -> Result<(), ModelError> {
        let none = SparseVector::default();
        self.assemble(system, end, (d_u, &none), Stiffness::None);
        self.follow_surfaces(end, d_u)
    }

    /// The displacement increments of an equilibrium without the rigid motions that nothing resists there; `None` if it has
    /// none.
    fn moved_back(&self, end: &Loading<D>, found: &Candidate<D>) -> Option<Vec<f64>> {
        let solution = &found.solution;
        let rounding = self.settings.tolerance * self.state.largest_force;
        let rows = self.resisted(end, |driver, k| {
            let bears = driver.points[k].law.is_tie() || solution.force[k].norm() > rounding;
            if bears {
                resists::<D>(solution.status[k])
            } else {
                0
            }
        });
        let free = null_space(&rows.up_to(Stopper::Friction));
        if free.ncols() == 0 {
            return None;
        }
        let modes = RigidModes::new(self, end);
        // The motions c of least squares Σ |d_u − M F c|² over the nodes, M the modes and F those that are free.
        let size = free.ncols();
        let (mut gram, mut moment) = (DMatrix::<f64>::zeros(size, size), DVector::zeros(size));
        for a in 0..self.mesh.nodes().len() {
            let own: Vec<SVector<f64, D>> = modes.of_node(a, &free);
            let moved = SVector::<f64, D>::from_column_slice(&found.d_u[D * a..D * a + D]);
            for (i, own_i) in own.iter().enumerate() {
                moment[i] += own_i.dot(&moved);
                own.iter()
                    .enumerate()
                    .for_each(|(j, own_j)| gram[(i, j)] += own_i.dot(own_j));
            }
        }
        // Tools that are free move no node.
        let rounding = 1e-12 * gram.amax();
        let motion: DVector<f64> = &free * -gram.svd(true, true).solve(&moment, rounding).ok()?;
        let mut d_u = found.d_u.clone();
        let mut farthest = 0.0f64;
        for a in 0..self.mesh.nodes().len() {
            let reached = SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
            let back = match self.has_large_strains() {
                true => modes.way(a, &(self.position(a) + reached), &motion),
                false => modes.of_node(a, &DMatrix::from_columns(std::slice::from_ref(&motion)))[0],
            };
            farthest = farthest.max(back.norm());
            (0..D).for_each(|i| d_u[D * a + i] += back[i]);
        }
        (farthest > STILL * self.mesh.size()).then_some(d_u)
    }
}
