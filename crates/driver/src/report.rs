//! What a step tells about itself; not how it is shown.

pub(crate) mod collapse;
pub(crate) mod counts;

use moreau_contact::Certificate;
use moreau_laws::{Local, Status};
use moreau_mesh::NodeKind;
use nalgebra::SVector;

/// Energies since the virgin state \[N·mm\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// Work of applied forces, prescribed displacements and tools, by the trapezoidal rule; across a gap that
    /// closes or opens within an increment none is done: a pressure is there only once nothing moves
    /// along it any more. Of heat what it does against the stresses, and of stresses at the start what they store.
    pub external_work: f64,
    /// Stored in the bulk.
    pub stored: f64,
    /// Dissipated by plastic flow.
    pub plastic_dissipation: f64,
    /// Dissipated by friction, Σ μ t_n ‖Δu_t‖, with t_n the last pressure of an increment; under large strains the mean of
    /// the first and the last.
    pub friction_dissipation: f64,
    /// Held by the springs of the penalty method; zero for the exact methods.
    pub penalty: f64,
}

impl Energies {
    /// External work − stored − dissipated − held by springs of a penalty: of the order of the step for implicit Euler.
    pub fn imbalance(&self) -> f64 {
        self.external_work
            - self.stored
            - self.plastic_dissipation
            - self.friction_dissipation
            - self.penalty
    }

    /// What is stored, dissipated, or held by springs of a penalty \[N·mm\]: what the work went into.
    pub fn taken(&self) -> f64 {
        self.stored + self.plastic_dissipation + self.friction_dissipation + self.penalty
    }
}

/// An iterate on the way to an increment, whether that converges or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration<'a> {
    /// Number of the increment that is tried, from 1.
    pub increment: usize,
    /// Times that it has been halved.
    pub cuts: usize,
    /// Newton iterations done, 0 for the predictor; under the paper's nesting those of all
    /// nonlinear solves.
    pub newton: usize,
    /// Iterations of the contact solver in the last of them.
    pub contact_iterations: usize,
    /// Largest nodal force that nothing balances \[N\]; under the paper's nesting, largest residual
    /// of the contact law.
    pub out_of_balance: f64,
    /// Largest nodal force in play \[N\].
    pub scale: f64,
    /// Displacement increments of the candidate, at every degree of freedom \[mm\].
    pub d_u: &'a [f64],
    /// Force that nothing balances, at every degree of freedom \[N\].
    pub residual: &'a [f64],
    /// Status of every contact point; empty before the first solution.
    pub status: &'a [Status],
}

/// Report of a converged increment.
#[derive(Debug, Clone, PartialEq)]
pub struct IncrementReport {
    /// Number of the increment since the virgin state, from 1.
    pub increment: usize,
    /// Part of the step that has been done, in (0, 1].
    pub fraction: f64,
    /// Newton iterations on the bulk, those on ways within the increment that led to no balance among them; for the
    /// paper's nesting, of all nonlinear solves.
    pub newton_iterations: usize,
    /// Of these, those on ways that led to no balance: of the increment at once, and of parts along its loading.
    pub astray_iterations: usize,
    /// Nonlinear solves: 1, or the outer iterations of the paper's nesting.
    pub nonlinear_solves: usize,
    /// Iterations of the contact solver, summed.
    pub contact_iterations: usize,
    /// Sparse factorisations.
    pub factorisations: usize,
    /// Iterations of conjugate gradients and, where the tangent is not symmetric or surfaces of two bodies move under
    /// large strains, steps beyond the first of each Newton iteration; else none where the stiffness itself is
    /// factorised.
    pub linear_iterations: usize,
    /// Solves with a factor for contacts that are tied in it, see [`Seam`](crate::Seam).
    pub contact_solves: usize,
    /// Newton steps that the line search shortened.
    pub shortened_steps: usize,
    /// Times the increment was halved before it converged.
    pub cuts: usize,
    /// Contact points that are open, stick and slip; points held by a displacement condition
    /// along the surface are not counted as sticking or slipping, and what bears no more than rounding is open, see
    /// [`Driver::count`](crate::Driver::count).
    pub open: usize,
    /// See `open`.
    pub stick: usize,
    /// See `open`.
    pub slip: usize,
    /// Part of the volume in which plastic strain grew.
    pub plastic_fraction: f64,
    /// Energies at the end of the increment.
    pub energies: Energies,
    /// The bipotential gap of the increment and what it cannot see.
    pub certificate: Certificate,
    /// Largest coefficient of friction over its critical value among the contact points that are closed
    /// or were at the start, with its index in [`Driver::contacts`](crate::Driver::contacts): from 1 on there may be other solutions,
    /// and the path may break off, see
    /// [`CondensedProblem::criticality`](moreau_contact::CondensedProblem::criticality). Of the stiffness of
    /// the last iteration; `None` where nothing touches, where contacts are tied in the factor, on a path of unknown load factor, and under
    /// the paper's nesting.
    pub criticality: Option<(usize, f64)>,
    /// Negative eigenvalues of the last tangent under large strains on the displacements that the statuses leave free:
    /// what is open moves as it will, what slips along its surface, what sticks not at all; a penalty is a spring. Of
    /// slip under friction, whose tangent is not symmetric, shears are taken for forces that stay what they are. The
    /// equilibrium is unstable, and since it was not a limit point or a bifurcation has been passed.
    pub negative_eigenvalues: usize,
    /// How the body gives way, by `D·node + axis`, of size 1 at the node that moves most: in the first of the increments
    /// with negative eigenvalues the eigenvector of that nearest to zero, and at a limit of the load the direction of the
    /// path. `None` in all others.
    pub mode: Option<Vec<f64>>,
    /// The load factor before this increment, if a limit has been passed in it along the path of equilibria: loads that rose
    /// until then fall. It is the largest that was in balance; where the increments are long, the limit is above it.
    pub limit: Option<f64>,
    /// The node that moves most, and how far \[mm\], where tools or supports move the body and it comes to rest far from
    /// where it was, in as short an increment as there may be: between the two is no path of equilibria that was found.
    pub leap: Option<(usize, f64)>,
    /// Rigid motions that nothing resists in the state that was found, in words, if the statuses left
    /// some free on the way: forces are what they are, and positions are those nearest to the ones before.
    pub free_motions: Vec<String>,
    /// Closed contact points at a sharp corner of their tool, as indices of
    /// [`Driver::contacts`](crate::Driver::contacts): their normal is any of a cone, see
    /// [`Obstacle::corner`](moreau_contact::Obstacle::corner).
    pub corners: Vec<usize>,
    /// Contact points that press without the shear that their law gives where nothing presses, as Tresca's, as indices of
    /// [`Driver::contacts`](crate::Driver::contacts): under it they open, and neither is in balance.
    pub shearless: Vec<usize>,
    /// Largest nodal force that nothing balances \[N\].
    pub out_of_balance: f64,
    /// Out-of-balance force of every Newton iteration \[N\].
    pub residuals: Vec<f64>,
}

impl IncrementReport {
    /// The bipotential gap in parts of the external work done so far, or of what is stored and dissipated where
    /// that is less: work that an energy balance does not find again makes nothing look smaller.
    pub fn relative_gap(&self) -> f64 {
        let work = self.energies.external_work.abs();
        let work = work.min(self.energies.taken().abs());
        if work > 0.0 {
            self.certificate.bipotential_gap / work
        } else {
            0.0
        }
    }
}

/// A contact point at the end of an increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRecord<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The node.
    pub node: usize,
    /// Its position in the undeformed body \[mm\].
    pub position: [f64; D],
    /// Place of the node on the facets of the surface.
    pub kind: NodeKind,
    /// Gap and slip of the increment \[mm\]; where no surface is opposite the gap is the size of
    /// the mesh.
    pub u: Local<D>,
    /// Force on the body, normal and tangential \[N\].
    pub t: Local<D>,
    /// Force on the body in space \[N\].
    pub force: SVector<f64, D>,
    /// Consistent share of the surface \[mm²\], between bodies that of the overlap; none at a node
    /// that is held, whose neighbours have it. On faces of serendipity
    /// hexahedra and quadratic tetrahedra, and on quadratic edges with an end on the axis, shares,
    /// forces, gaps and slips are those of a basis with positive integrals, not of the nodes: see
    /// [`PositiveShare`](moreau_mesh::PositiveShare).
    pub area: f64,
    /// Status; for a point held along the surface, `Open` or `Stick`.
    pub status: Status,
    /// Whether a displacement condition holds the point along the surface; one that such conditions drag along it slips.
    pub held: bool,
    /// Displacement in the springs of the penalty method \[mm\]: total across the gap, of the
    /// increment along the surface; zero for the exact methods.
    pub spring: Local<D>,
}

impl<const D: usize> ContactRecord<D> {
    /// Traction on the body, normal and tangential \[MPa\]: t over the share of the surface, zero
    /// without one.
    pub fn traction(&self) -> Local<D> {
        match self.area > 0.0 {
            true => self.t / self.area,
            false => Local::zeros(),
        }
    }
}
