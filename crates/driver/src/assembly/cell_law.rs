//! How a law of the material meets the displacements of a cell; not how cells are put together.

use crate::assembly::cells::Cells;
use moreau_laws::{BulkLaw, FlowPower, Numbers};
use moreau_mandel::Sym2;
use nalgebra::Matrix3;

/// Which stiffness an evaluation computes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// None: forces only.
    None,
    /// The elastic one, ∫ Bᵀ C B dΩ, and this part, in [0, 1], of what flow adds to it.
    Total(f64),
    /// This part, in [0, 1], of what flow adds to the elastic one: ∫ Bᵀ (∂σ₁/∂Δε − C) B dΩ, of the
    /// cells in which plastic strain grows.
    Plastic(f64),
}

impl Stiffness {
    /// Whether a cell has any, in which plastic strain grows or not.
    pub(crate) fn is_given(self, flows: bool) -> bool {
        match self {
            Self::None => false,
            Self::Total(_) => true,
            Self::Plastic(_) => flows,
        }
    }
}

/// Displacements of a step, an entry a degree of freedom of the mesh \[mm\].
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// At its start, since the body was undeformed.
    pub from: &'a [f64],
    /// Increments of the whole step.
    pub by: &'a [f64],
    /// Increments of the strain in every direction that makes no stress, as of heat, at the quadrature points of
    /// the block in the order of [`Block::points`](crate::Block::points); empty where there are none. Under large
    /// strains they are logarithmic.
    pub free: &'a [f64],
}

impl<'a> Motion<'a> {
    /// A motion without free strains.
    pub fn new(from: &'a [f64], by: &'a [f64]) -> Self {
        Self {
            from,
            by,
            free: &[],
        }
    }

    /// Of a motion with the free strains of several blocks that of the first, which has so many points; what is left is
    /// that of the others.
    pub(crate) fn split_off(&mut self, points: usize) -> Self {
        let (own, others) = self.free.split_at(points.min(self.free.len()));
        self.free = others;
        Self { free: own, ..*self }
    }

    /// Takes the free strains off the strains of the k-th cell.
    pub(crate) fn relieve<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        strains: &mut [Sym2],
    ) {
        if self.free.is_empty() {
            return;
        }
        for (g, strain) in strains.iter_mut().enumerate() {
            let free = self.free_at((cells, k), g);
            (0..3).for_each(|i| strain[i] -= free);
        }
    }

    /// The free strain at a point of the k-th cell: its mean over the cell where the dilatation is one.
    pub(crate) fn free_at<const D: usize>(
        &self,
        (cells, k): (&dyn Cells<D>, usize),
        g: usize,
    ) -> f64 {
        let count = cells.points_per_cell();
        let own = self.free.get(k * count..(k + 1) * count).unwrap_or(&[]);
        if !cells.averages_dilatation() {
            return own.get(g).copied().unwrap_or(0.0);
        }
        let (mut sum, mut volume) = (0.0, 0.0);
        for (g, free) in own.iter().enumerate() {
            let weight = cells.weight(k * count + g);
            sum += weight * free;
            volume += weight;
        }
        if volume > 0.0 { sum / volume } else { 0.0 }
    }
}

/// Where a cell leaves what it does.
pub struct CellOutput<'a, S> {
    /// States at the end of the step, point by point.
    pub new: &'a mut [S],
    /// ∫ Bᵀ σ₁ dΩ, node by node \[N\].
    pub force: &'a mut [f64],
    /// The upper triangle of the stiffness asked for \[N/mm\], row by row without the lower one; empty if none
    /// is.
    pub stiffness: &'a mut [f64],
}

/// A law of the material and how displacements strain it: small strains or large ones. A cell is the k-th of
/// some cells, `(cells, k)`, and its states at the start of a step are given point by point.
pub trait CellLaw<const D: usize>: 'static + Send + Sync {
    /// The law.
    type Law: BulkLaw;
    /// What a point remembers.
    type State: Copy + Send + Sync + Numbers;
    /// Room for what a cell needs, used again for the next one.
    type Room: Default;

    /// The law.
    fn law(&self) -> &Self::Law;

    /// State of a point in an undeformed body.
    fn start(material: <Self::Law as BulkLaw>::State) -> Self::State;

    /// State of the material of a point.
    fn material(state: &Self::State) -> &<Self::Law as BulkLaw>::State;

    /// States, forces and stiffness of a cell at the end of a step. Returns whether the stiffness is another
    /// than the elastic one.
    fn respond(
        &self,
        cell: (&dyn Cells<D>, usize),
        old: &[Self::State],
        motion: Motion<'_>,
        kind: Stiffness,
        out: CellOutput<'_, Self::State>,
        room: &mut Self::Room,
    ) -> bool;

    /// Whether the stiffness is that of the forces, or does for it.
    fn is_symmetric(&self) -> bool;

    /// See [`Block::has_potential`](crate::Block::has_potential).
    fn has_potential(&self) -> bool {
        self.is_symmetric()
    }

    /// Whether displacements do not change the elastic stiffness.
    fn keeps_elastic_stiffness(&self) -> bool;

    /// Forces, node by node, of what the stiffness lacks of being that of the forces, on the displacements
    /// `v` \[N\].
    fn lacking(
        &self,
        cell: (&dyn Cells<D>, usize),
        old: &[Self::State],
        motion: Motion<'_>,
        v: &[f64],
        force: &mut [f64],
    );

    /// ∫ ΔV(Δε) + σ₀ : Δε dΩ over a cell \[N·mm\], \[74\]; `None` without a potential.
    fn potential(
        &self,
        cell: (&dyn Cells<D>, usize),
        old: &[Self::State],
        motion: Motion<'_>,
    ) -> Option<f64>;

    /// ∫ D(ε̇) dΩ over a cell of the strain rates of the velocities `v`; `None` of a law that has none.
    fn flow_power(
        &self,
        cell: (&dyn Cells<D>, usize),
        old: &[Self::State],
        v: &[f64],
    ) -> Option<FlowPower>;

    /// Stress of a point, of the volume of the undeformed body \[MPa\].
    fn stress(&self, state: &Self::State) -> Sym2;

    /// Gives displacement gradients at the points of a cell the mean dilatation, where the law is asked with that.
    fn average_dilatation(_cell: (&dyn Cells<D>, usize), _gradients: &mut [Matrix3<f64>]) {}

    /// Volume over that of the undeformed body at a point with this displacement gradient.
    fn jacobian(_gradient: &Matrix3<f64>) -> f64 {
        1.0
    }

    /// Fields of what the displacements do to a point where they have this gradient, by name and components,
    /// beside those of the law.
    fn fields(_gradient: &Matrix3<f64>, _sink: &mut dyn FnMut(&str, &[f64])) {}

    /// The frame in which the tensors of the material are, where that is not space.
    fn frame(state: &Self::State) -> Option<Matrix3<f64>>;
}
