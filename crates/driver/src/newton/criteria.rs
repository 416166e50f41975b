//! When an increment is in balance, and what is told of one that is not.

use crate::driver::Driver;
use crate::error::{Imbalance, IncrementError};
use crate::linear::system::{Assembly, System};
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_contact::ContactSolution;

/// How far an increment may move anything, in sizes of the mesh, of what it prescribes and of the
/// widest gap.
const FARTHEST: f64 = 10.0;

/// What an increment may be off by, over the residual of its contact solution: that weighs
/// displacements with a somewhat smaller α.
pub(crate) const CONTACT_SLACK: f64 = 10.0;

/// Most that a contact solution excuses, over the size of the forces in play: where its rounding is more the problem was as
/// good as singular.
const EXCUSED: f64 = 1e-5;

impl<const D: usize> Driver<D> {
    /// Size of the forces in play at the nodes, against which imbalance is judged \[N\]. What a tool
    /// carries is a sum of them.
    pub(crate) fn force_scale(
        &self,
        (assembly, heated): (&Assembly, f64),
        end: &Loading<D>,
        contact: &SparseVector,
    ) -> f64 {
        let nodes = self.mesh_dofs();
        let given = end.force.iter().chain(contact.iter());
        let given = given.filter(|&(dof, _)| dof < nodes).map(|(_, f)| f);
        let internal = assembly.internal[..nodes].iter().copied();
        largest(given.chain(internal).chain([assembly.pressed, heated])).max(f64::MIN_POSITIVE)
    }

    /// Out-of-balance force at which an increment is accepted \[N\]: the tolerance, or the rounding of
    /// internal forces.
    pub(crate) fn accepted_residual(&self, system: &System, scale: f64, d_u: &[f64]) -> f64 {
        let least = (self.settings.tolerance * scale).max(self.rounding(system, d_u));
        // What touches without pressing presses by the rounding of its gaps.
        let rounded = self.law_rounding(system);
        match scale <= rounded && !self.points.is_empty() {
            true => least.max(rounded),
            false => least,
        }
    }

    /// Rounding of internal forces \[N\], which counts where the body moves almost rigidly, or is let go: a stress that has
    /// vanished is what rounding left of the largest so far.
    pub(crate) fn rounding(&self, system: &System, d_u: &[f64]) -> f64 {
        // Of the size of the mesh, no position has a smaller part.
        let (size, moved) = (self.mesh.size(), &d_u[..self.mesh_dofs()]);
        let motion = largest(moved.iter().copied()).max(self.state.farthest);
        let motion = motion.clamp(f64::EPSILON * size, size);
        64.0 * f64::EPSILON * system.stiffest() * motion
    }

    /// What the force of a node may be by rounding, as far as the body has been moved \[N\]; zero before the first step.
    pub fn rounding_of_forces(&self) -> f64 {
        let moved = &self.state.displacement;
        let rounding = |system| self.rounding(system, moved);
        self.system.as_ref().map_or(0.0, rounding)
    }

    /// Whether nothing has gone so far that forces are rounding, in all of the increment or in its last step: what
    /// slides away is in balance with anything there. What falls may go as far as to what stops it.
    pub(crate) fn is_near(
        &self,
        system: &System,
        (d_u, solution): (&[f64], Option<&ContactSolution<D>>),
        (start, end): (&Loading<D>, &Loading<D>),
    ) -> bool {
        let mesh = d_u[..self.mesh_dofs()].iter().copied();
        let turns = (0..self.tools.len()).map(|tool| d_u[self.turn_dof(tool)]);
        let step = solution.iter().flat_map(|s| &s.motion).map(|u| u.amax());
        let moved = largest(mesh.chain(turns).chain(step));
        let prescribed = end.displacement.iter();
        let told = largest(prescribed.map(|(dof, u)| u - start.displacement.get(dof).unwrap_or(u)));
        let reach = self.mesh.size() + told;
        moved <= FARTHEST * reach || {
            let before = self.kinematics(system, start, &vec![0.0; d_u.len()]);
            let gap = largest(before.iter().map(|k| k.u[0]));
            moved <= FARTHEST * (reach + gap)
        }
    }

    /// Whether gaps and slips of the displacements themselves obey the law with the forces of the
    /// linearised problem: once that is solved exactly, they do on a plane, and on a curved obstacle
    /// where the step is small.
    pub(crate) fn law_holds(
        &self,
        system: &System,
        kinematics: &[Kinematics<D>],
        solution: &ContactSolution<D>,
        scale: f64,
    ) -> bool {
        let tolerance = self.law_tolerance(system, solution, scale);
        let holds = |i: usize| {
            let left = self.law_residual_at(i, system, &kinematics[i], solution);
            // In the law the gap is widened by the slip times the coefficient, and so is its rounding.
            let pressure = solution.force[i][0];
            let widened = match pressure > 0.0 {
                true => kinematics[i].law.bound(pressure) / pressure * self.law_rounding(system),
                false => 0.0,
            };
            left <= tolerance + widened + self.inherited_residual(i, system)
        };
        solution.exact && (0..kinematics.len()).all(holds)
    }

    /// What the gap at the start of the increment may keep a point from obeying the law \[N\], as far as the largest forces
    /// so far excused it: where forces have fallen since, the node of a corner that sticks to one tool cannot close what
    /// is left to another.
    fn inherited_residual(&self, i: usize, system: &System) -> f64 {
        let before = &self.state.contacts[i];
        let gap = (before.u[0] + before.spring[0]).abs();
        (system.shift() * gap).min(self.settings.tolerance * self.state.largest_force)
    }

    /// What an increment may be off by for its contact solution, of forces of a size \[N\]. One that is not exact excuses
    /// nothing.
    pub(crate) fn slack(&self, system: &System, solution: &ContactSolution<D>, scale: f64) -> f64 {
        let most = (EXCUSED * scale).max(self.law_rounding(system));
        match solution.exact {
            true => (CONTACT_SLACK * solution.residual).min(most),
            false => 0.0,
        }
    }

    /// The largest [`Driver::law_residual`] with which an increment is accepted \[N\].
    pub(crate) fn law_tolerance(
        &self,
        system: &System,
        solution: &ContactSolution<D>,
        scale: f64,
    ) -> f64 {
        self.settings.tolerance * scale
            + self.slack(system, solution, scale)
            + self.law_rounding(system)
    }

    /// What rounding of positions makes of [`Driver::law_residual`] \[N\].
    pub(crate) fn law_rounding(&self, system: &System) -> f64 {
        // Below this the difference of two positions is rounding.
        let (low, high) = self.mesh.bounds();
        let reach = largest(low.iter().chain(&high).copied());
        let tools = largest(self.tools.iter().map(|tool| tool.obstacle.rounding()));
        (16.0 * f64::EPSILON * reach + tools) * system.shift()
    }

    /// By how much gaps and slips do not obey the law with the forces of a solution \[N\].
    pub(crate) fn law_residual(
        &self,
        system: &System,
        kinematics: &[Kinematics<D>],
        solution: &ContactSolution<D>,
    ) -> f64 {
        let points = kinematics.iter().enumerate();
        largest(points.map(|(i, k)| self.law_residual_at(i, system, k, solution)))
    }

    fn law_residual_at(
        &self,
        i: usize,
        system: &System,
        kinematics: &Kinematics<D>,
        solution: &ContactSolution<D>,
    ) -> f64 {
        let elastic = solution.irreversible[i] - solution.displacement[i];
        let mut u = kinematics.u + elastic;
        let mut t = solution.force[i];
        for j in 0..D {
            if !kinematics.active[j] {
                (u[j], t[j]) = (0.0, 0.0);
            }
        }
        // α of the size of the structure's stiffness, as in the contact problem.
        kinematics.law.natural_map(&u, &t, system.shift()).norm()
    }

    /// The error of an increment that iterations have not brought into balance.
    pub(crate) fn not_converged(
        &self,
        residual: &[f64],
        iterations: usize,
        target: f64,
    ) -> IncrementError {
        IncrementError::NotConverged {
            iterations,
            out_of_balance: largest(residual.iter().copied()),
            tolerance: target,
            worst: self.worst(&residual[..self.mesh_dofs()]),
            plastic_fraction: self.plastic_fraction(),
        }
    }

    /// The five nodes with the largest force that nothing balances, worst first; `residual` has an
    /// entry for every degree of freedom \[N\].
    pub fn worst(&self, residual: &[f64]) -> Vec<Imbalance> {
        let norm = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>().sqrt();
        let force: Vec<f64> = residual.chunks(D).map(norm).collect();
        let mut order: Vec<usize> = (0..force.len()).collect();
        order.sort_by(|&a, &b| force[b].total_cmp(&force[a]));
        let imbalance = |&node: &usize| Imbalance {
            node,
            position: self.mesh.nodes()[node].to_vec(),
            force: force[node],
        };
        order.iter().take(5).map(imbalance).collect()
    }
}
