//! The tangent at an iterate, made definite where it is that of a mechanism; not the step that it gives.

use crate::assembly::cell_law::Stiffness;
use crate::driver::Driver;
use crate::error::{IncrementError, ModelError};
use crate::linear::system::System;
use crate::model::load::{Loading, axis_letter};
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{Kinematics, in_space};
use crate::newton::iterate::Iterate;
use crate::vector::SparseVector;
use moreau_laws::Local;
use nalgebra::{SMatrix, SVector};

/// Parts of what flow adds to the stiffness that are tried in turn where the tangent is a mechanism.
const BLENDS: [f64; 4] = [1.0 - 1e-4, 0.99, 0.8, 0.0];

/// The same where stresses of large strains make it indefinite far from the solution: a twentieth of the elastic
/// stiffness is more than they take.
pub(crate) const STIFFENED: [f64; 3] = [0.95, 0.8, 0.0];

/// The stiffness of contact forces that turn, as entries of a matrix that are to be summed \[N/mm\].
#[derive(Default)]
pub(crate) struct Turning(Vec<(usize, usize, f64)>);

impl<const D: usize> Driver<D> {
    /// Makes the system that of the tangent at an iterate, under a loading with displacements that are missing
    /// and contact forces that turn: factorised, where contacts are not tied in its factor.
    pub(crate) fn linearise(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        given: (&Loading<D>, &SparseVector),
        turning: &Turning,
        far: bool,
    ) -> Result<(), IncrementError> {
        let (end, missing) = given;
        if !now.assembly.stiffness && (self.has_large_strains() || system.is_tied()) {
            let tangent = Stiffness::Plastic(1.0);
            now.assembly = self.assemble(system, end, (&now.d_u, missing), tangent);
        }
        system.add(turning.entries());
        match system.is_tied() {
            true => Ok(()),
            false => self.factorise(system, now, given, far),
        }
    }

    /// The stiffness of contact forces that turn with the normal of their tool, W = ∂n/∂x: the force n t_n + τ
    /// changes by t_n W v − n (τ · W v) with the relative displacement v. Where n is held, as in contact, its symmetric
    /// part is as good: −t_n W + n ⊗ W τ + W τ ⊗ n. With a tool that a moment turns, see [`Turning::add_spin`].
    /// Under small strains nothing turns.
    pub(crate) fn turning(
        &self,
        end: &Loading<D>,
        kinematics: &[Kinematics<D>],
        force: &[Local<D>],
    ) -> Turning {
        let mut turning = Turning::default();
        if !self.has_large_strains() {
            return turning;
        }
        let rows = self.points.iter().zip(&self.footing.rows);
        for (((point, motion_row), k), t) in rows.zip(kinematics).zip(force) {
            if t.norm() == 0.0 || k.curvature.amax() == 0.0 && k.lever.is_none() {
                continue;
            }
            let n = k.axes.column(0);
            let along = k.curvature * (k.force(t) - n * t[0]);
            let own = n * along.transpose();
            let stiffness = own + own.transpose() - k.curvature * t[0];
            for (a, w) in motion_row.weights() {
                for (b, v) in motion_row.weights() {
                    let entry = |ij: usize| {
                        let (i, j) = (ij / D, ij % D);
                        (D * a + i, D * b + j, w * v * stiffness[(i, j)])
                    };
                    turning.0.extend((0..D * D).map(entry));
                }
            }
            if let Some(axle) = point.tool.and_then(|tool| end.axle_of(tool)) {
                let spin = axle.cross(&in_space(&k.force(t))) / self.mesh.size();
                let spin = SVector::from_fn(|i, _| spin[i]);
                turning.add_spin(motion_row, k.lever.as_ref(), &stiffness, &spin);
            }
        }
        turning
    }

    /// Factorises a stiffness at an iterate with this part of what flow adds to it.
    ///
    /// # Errors
    /// [`System::factorise`].
    pub(crate) fn blend(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        (end, missing): (&Loading<D>, &SparseVector),
        part: f64,
    ) -> Result<(), usize> {
        let blended = Stiffness::Plastic(part);
        now.assembly = self.assemble(system, end, (&now.d_u, missing), blended);
        system.factorise(false)
    }

    /// Factorises the tangent at an iterate. Where that is a mechanism, as a plastic tangent may be
    /// far from the solution, more and more of the elastic stiffness is blended in: the step is
    /// then shorter and still downhill.
    pub(crate) fn factorise(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        (end, missing): (&Loading<D>, &SparseVector),
        far: bool,
    ) -> Result<(), IncrementError> {
        let elastic = !now.assembly.flows;
        if !(now.assembly.stiffness || elastic && system.holds_elastic_factor()) {
            let tangent = Stiffness::Plastic(1.0);
            now.assembly = self.assemble(system, end, (&now.d_u, missing), tangent);
        }
        let mut outcome = system.factorise(elastic);
        let leads_nowhere = |system: &System| far && system.is_indefinite();
        let blends: &[f64] = match leads_nowhere(system) {
            true => &STIFFENED,
            false => &BLENDS,
        };
        for &part in blends {
            if outcome.is_ok() && !leads_nowhere(system) || system.gave_up().is_some() {
                break;
            }
            outcome = self.blend(system, now, (end, missing), part);
        }
        if let (Err(_), Some(error)) = (outcome, system.gave_up()) {
            let problem = error.to_string();
            return Err(IncrementError::Solver { problem });
        }
        if let Err(dof) = outcome
            && let Some(tool) = (dof / D).checked_sub(self.mesh.nodes().len())
        {
            let tool = self.tools[tool].name.clone();
            let motion = format!("translation along {}", axis_letter(dof % D));
            return Err(ModelError::FreeTool { tool, motion }.into());
        }
        outcome.map_err(|dof| IncrementError::Mechanism {
            node: dof / D,
            axis: axis_letter(dof % D),
            position: self.mesh.nodes()[dof / D].to_vec(),
        })
    }
}

impl Turning {
    /// The entries, by rows and columns.
    fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.0.iter().copied()
    }

    /// How the forces change along a step \[N\].
    pub(crate) fn change(&self, step: &[f64]) -> SparseVector {
        let mut change = SparseVector::default();
        for (i, j, k) in self.entries() {
            change.add(i, -k * step[j]);
        }
        change
    }

    /// Adds what the turn w of a tool adds to the stiffness S of contact forces f that turn: the relative displacement is
    /// v − l w with the lever l, f turns with the tool by s w, s = e × f, and its moment changes by f · (e × v). All of
    /// that is −(v − l w) · s w and its transpose, of which the square of w is taken once.
    fn add_spin<const D: usize>(
        &mut self,
        motion_row: &RelativeMotionRow<D>,
        lever: Option<&(usize, SVector<f64, D>)>,
        stiffness: &SMatrix<f64, D, D>,
        spin: &SVector<f64, D>,
    ) {
        let Some((turn, lever)) = lever else { return };
        let along = stiffness * lever;
        let across = -along - spin;
        for (a, w) in motion_row.weights() {
            let entry = |i: usize| (D * a + i, w * across[i]);
            self.0
                .extend((0..D).map(entry).map(|(dof, k)| (dof, *turn, k)));
            self.0
                .extend((0..D).map(entry).map(|(dof, k)| (*turn, dof, k)));
        }
        let own = lever.dot(&along) + lever.dot(spin);
        self.0.push((*turn, *turn, own));
    }
}
