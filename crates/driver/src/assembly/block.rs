//! Blocks of cells of one element and one law: forces and stiffness of their cells, and the state
//! of their material; not their assembly.

use crate::assembly::cell_law::{CellLaw, CellOutput, Motion, Stiffness};
use crate::assembly::cells::{Cells, MAX_POINTS};
use crate::assembly::large::Large;
use crate::assembly::small::Small;
use crate::error::LawFault;
use crate::threads::prelude::*;
use moreau_laws::{BulkLaw, FlowPower, Numbers};
use moreau_mandel::{Sym2, from_matrix, to_matrix};
use nalgebra::{Matrix3, Vector3};

/// Forces of a cell and, if asked for, its stiffness.
#[derive(Debug, Clone, Copy)]
pub struct CellResult<'a> {
    /// Index of the cell in its block.
    pub cell: usize,
    /// Its nodes.
    pub nodes: &'a [usize],
    /// ∫ Bᵀ σ₁ dΩ, node by node \[N\].
    pub force: &'a [f64],
    /// The upper triangle of the stiffness asked for \[N/mm\], row by row without the lower one;
    /// empty where that is nothing.
    pub stiffness: &'a [f64],
}

/// Energies and plastic activity of a block at the end of the candidate step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BlockEnergy {
    /// Stored energy \[N·mm\].
    pub stored: f64,
    /// Plastic dissipation of the step \[N·mm\].
    pub dissipated: f64,
    /// Volume in which plastic strain grew in the step \[mm³\].
    pub plastic_volume: f64,
    /// Volume of the block \[mm³\].
    pub volume: f64,
}

/// State of the material at a quadrature point, for output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointState<const D: usize> {
    /// Cell of the mesh.
    pub cell: usize,
    /// Position in the undeformed body \[mm\].
    pub position: [f64; D],
    /// Quadrature weight times Jacobian times measure \[mm³\].
    pub weight: f64,
    /// Cauchy stress \[MPa\]: with `weight` times `jacobian` it is in balance with the forces on the deformed body.
    pub stress: Sym2,
    /// Volume of the deformed body over that of the undeformed one, 1 under small strains: that of the point, or of
    /// its cell where that is what the law is asked with, the mean dilatation.
    pub jacobian: f64,
    /// Equivalent plastic strain p.
    pub plastic_strain: f64,
}

/// A field that laws have of their own, at every quadrature point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointField {
    /// Its name.
    pub name: String,
    /// Components: 1 of a scalar, 3 of a vector, 6 of a symmetric tensor as in [`Sym2`].
    pub components: usize,
    /// The components at every point; NaN at those of a law that has no such field.
    pub values: Vec<f64>,
}

/// A set of cells that are integrated alike. The state at the start of the step changes only in
/// [`Block::commit`]; everything else works on a candidate.
pub trait Block<const D: usize>: Send + Sync {
    /// Cells of the mesh in this block.
    fn cells(&self) -> &[usize];

    /// Nodes of the k-th cell of the block.
    fn nodes(&self, k: usize) -> &[usize];

    /// How many cells it has, each of which must be one of [`Block::cells`].
    fn count(&self) -> usize {
        self.cells().len()
    }

    /// Whether the k-th cell of the block was made of nodes at these positions \[mm\], in the order of [`Block::nodes`].
    fn is_at(&self, _k: usize, _nodes: &[[f64; D]]) -> bool {
        true
    }

    /// Quadrature points of a cell.
    fn points_per_cell(&self) -> usize;

    /// Whether this process holds the k-th cell: the stiffness of the others is handed to nobody here, and their
    /// forces come apart from it.
    fn holds(&self, _k: usize) -> bool {
        true
    }

    /// Forces and stiffness at the end of a step, handed cell by cell, in order, to `sink`. Returns
    /// whether the stiffness is another than the elastic one anywhere.
    fn evaluate(
        &mut self,
        motion: Motion<'_>,
        stiffness: Stiffness,
        sink: &mut dyn FnMut(CellResult<'_>),
    ) -> bool;

    /// What the law could not answer, if it could not in the last evaluation, whose forces are then no numbers. One that
    /// breaks off stays until it is taken, and until then there are no other forces.
    fn take_fault(&mut self) -> Option<LawFault> {
        None
    }

    /// Whether the stiffness is that of the forces, or does for it.
    fn is_symmetric(&self) -> bool;

    /// Whether the forces are those of a potential or, under large strains, hardly differ from such: its slope tells how far
    /// to go along a step.
    fn has_potential(&self) -> bool {
        self.is_symmetric()
    }

    /// Whether the elastic stiffness is the same always, and plastic flow adds to it: displacements are so
    /// small that they do not change it.
    fn keeps_elastic_stiffness(&self) -> bool;

    /// Forces ∫ Bᵀ A B v dΩ of what the tangents at the end of a step lack of being those of the forces, A,
    /// on the displacements `v` (one entry a degree of freedom of the mesh), handed cell by cell, in order,
    /// to `sink`: its nodes, and the forces node by node \[N\].
    fn lacking(&self, motion: Motion<'_>, v: &[f64], sink: &mut dyn FnMut(&[usize], &[f64]));

    /// ∫ ΔV(Δε) + σ₀ : Δε dΩ, the bulk part of ΔΦ \[74\] when total forces are
    /// applied instead of increments \[N·mm\]; `None` of a law without a potential.
    fn potential(&self, motion: Motion<'_>) -> Option<f64>;

    /// Energies of the candidate that the last evaluation left.
    fn energy(&self) -> BlockEnergy;

    /// ∫ D(ε̇) dΩ of the strain rates of the velocities `v` (one entry a degree of freedom of the
    /// mesh), in the committed states; `None` of a law that has none.
    fn flow_power(&self, v: &[f64]) -> Option<FlowPower>;

    /// Makes the candidate the state at the start of the next step.
    fn commit(&mut self);

    /// The committed state at every quadrature point, cell by cell, at these displacements of the degrees of
    /// freedom of the mesh.
    fn points(&self, u: &[f64]) -> Vec<PointState<D>>;

    /// The fields that the law has of its own, in the committed state at every quadrature point, in the
    /// order of [`Block::points`], and those of large strains; `u` has an entry a degree of freedom of the mesh.
    fn fields(&self, _u: &[f64]) -> Vec<PointField> {
        Vec::new()
    }

    /// Hands the committed state at every quadrature point with the displacement gradient there, cell by
    /// cell, to `sink`; `u` has an entry a degree of freedom of the mesh.
    fn gradients(&self, u: &[f64], sink: &mut dyn FnMut(&PointState<D>, &Matrix3<f64>));

    /// Adds to `force` what the stiffness of the committed stresses makes of the displacements `v`:
    /// ∫ (∂v/∂x · σ) : ∂δv/∂x dΩ \[N\], both with an entry a degree of freedom of the mesh, from the means of
    /// gradients and stresses in every cell: modes that the rule of a cell does not see turn its points
    /// without resistance, and not the cell.
    fn add_stress_stiffness(&self, v: &[f64], force: &mut [f64]);

    /// The numbers of all committed states, cell by cell.
    fn state(&self) -> Vec<f64>;

    /// Replaces the committed states by what [`Block::state`] gave; returns how many numbers that
    /// takes, and changes nothing if there are more or fewer.
    fn restore(&mut self, numbers: &[f64]) -> usize;
}

/// Quadrature points of a block.
pub(crate) fn points_of<const D: usize>(block: &dyn Block<D>) -> usize {
    block.cells().len() * block.points_per_cell()
}

/// Numbers of the stiffness of the cells that are evaluated before their results are handed on:
/// bounds the memory of the buffers.
const PANEL: usize = 1 << 19;

/// Quadrature points that are worth a thread: waking one takes as long as some hundred.
const GRAIN: usize = 2048;

/// The block of some cells with a law.
pub struct SolidBlock<C: CellLaw<D>, const D: usize> {
    members: Vec<usize>,
    cells: Box<dyn Cells<D>>,
    of_cell: C,
    old: Vec<C::State>,
    new: Vec<C::State>,
    force: Vec<f64>,
    stiffness: Vec<f64>,
    /// Cells of the panel at hand in which plastic strain grows.
    flows: Vec<bool>,
}

impl<L: BulkLaw, const D: usize> SolidBlock<Small<L>, D> {
    /// The block of `cells`, which are the cells `members` of the mesh, in the initial state of the law and
    /// under small strains.
    pub fn new(members: Vec<usize>, cells: Box<dyn Cells<D>>, law: L) -> Self {
        Self::of(members, cells, Small(law))
    }
}

impl<L: BulkLaw, const D: usize> SolidBlock<Large<L>, D> {
    /// The same under large strains and rotations.
    pub fn large(members: Vec<usize>, cells: Box<dyn Cells<D>>, law: L) -> Self {
        Self::of(members, cells, Large(law))
    }
}

impl<C: CellLaw<D>, const D: usize> SolidBlock<C, D> {
    fn of(members: Vec<usize>, cells: Box<dyn Cells<D>>, of_cell: C) -> Self {
        let start = C::start(of_cell.law().initial());
        let states = vec![start; cells.count() * cells.points_per_cell()];
        Self {
            members,
            cells,
            of_cell,
            old: states.clone(),
            new: states,
            force: Vec::new(),
            stiffness: Vec::new(),
            flows: Vec::new(),
        }
    }

    /// The same block from other states at the start, from the position of a quadrature point in the
    /// undeformed body \[mm\]: under a stress, or with axes that vary.
    pub fn with_states(mut self, state: impl Fn(&[f64; D]) -> <C::Law as BulkLaw>::State) -> Self {
        for (point, old) in self.old.iter_mut().enumerate() {
            *old = C::start(state(&self.cells.position(point)));
        }
        self.new.copy_from_slice(&self.old);
        self
    }

    /// The k-th cell with its committed states.
    fn cell(&self, k: usize) -> ((&dyn Cells<D>, usize), &[C::State]) {
        let count = self.cells.points_per_cell();
        let old = &self.old[k * count..(k + 1) * count];
        ((self.cells.as_ref(), k), old)
    }

    /// The committed state at a quadrature point, with this displacement gradient, as averaged as the law is asked with it.
    fn point(&self, point: usize, gradient: &Matrix3<f64>) -> PointState<D> {
        let state = &self.old[point];
        let law = self.of_cell.law();
        let jacobian = C::jacobian(gradient);
        PointState {
            cell: self.members[point / self.cells.points_per_cell()],
            position: self.cells.position(point),
            weight: self.cells.weight(point),
            stress: self.of_cell.stress(state) / jacobian,
            jacobian,
            plastic_strain: law.equivalent_plastic_strain(C::material(state)),
        }
    }
}

/// What the cells of a panel are evaluated from.
struct Panel<'a, C: CellLaw<D>, const D: usize> {
    cells: &'a dyn Cells<D>,
    of_cell: &'a C,
    old: &'a [C::State],
    kind: Stiffness,
    motion: Motion<'a>,
}

impl<C: CellLaw<D>, const D: usize> Panel<'_, C, D> {
    /// Forces, the upper triangles of the stiffness asked for, of so many entries, the new states,
    /// and whether the stiffness is another than the elastic one, of the cells from `first` on.
    fn evaluate(
        &self,
        first: usize,
        entries: usize,
        (forces, matrices): (&mut [f64], &mut [f64]),
        (new, flows): (&mut [C::State], &mut [bool]),
    ) {
        let count = self.cells.points_per_cell();
        let size = D * self.cells.nodes(first).len();
        let mut room = C::Room::default();
        for (k, force) in forces.chunks_mut(size).enumerate() {
            let cell = first + k;
            let old = &self.old[cell * count..(cell + 1) * count];
            let out = CellOutput {
                new: &mut new[k * count..(k + 1) * count],
                force,
                stiffness: &mut matrices[k * entries..(k + 1) * entries],
            };
            let of = (self.cells, cell);
            flows[k] = (self.of_cell).respond(of, old, self.motion, self.kind, out, &mut room);
        }
    }
}

impl<C: CellLaw<D>, const D: usize> Block<D> for SolidBlock<C, D> {
    fn cells(&self) -> &[usize] {
        &self.members
    }

    fn nodes(&self, k: usize) -> &[usize] {
        self.cells.nodes(k)
    }

    fn count(&self) -> usize {
        self.cells.count()
    }

    fn is_at(&self, k: usize, nodes: &[[f64; D]]) -> bool {
        self.cells.is_at(k, nodes)
    }

    fn evaluate(
        &mut self,
        motion: Motion<'_>,
        stiffness: Stiffness,
        sink: &mut dyn FnMut(CellResult<'_>),
    ) -> bool {
        let all = self.cells.count();
        if all == 0 {
            return false;
        }
        let size = D * self.cells.nodes(0).len();
        let per_cell = self.cells.points_per_cell();
        let entries = match stiffness {
            Stiffness::None => 0,
            Stiffness::Total(_) | Stiffness::Plastic(_) => size * (size + 1) / 2,
        };
        // One entry a cell at least, so that the parallel chunks below stay aligned.
        let room = entries.max(1);
        let cells = PANEL.div_ceil(size * (size + 1) / 2).min(all);
        let grain = GRAIN.div_ceil(per_cell);
        self.force.resize(cells * size, 0.0);
        self.stiffness.resize(cells * room, 0.0);
        self.flows.resize(cells, false);
        let panel = Panel {
            cells: self.cells.as_ref(),
            of_cell: &self.of_cell,
            old: &self.old,
            kind: stiffness,
            motion,
        };
        let mut any = false;
        for start in (0..all).step_by(cells) {
            let count = cells.min(all - start);
            let forces = &mut self.force[..count * size];
            let matrices = &mut self.stiffness[..count * room];
            let new = &mut self.new[start * per_cell..(start + count) * per_cell];
            let flows = &mut self.flows[..count];
            // The order of the cells, and with it every sum, is the same for any number of threads.
            if count < 2 * grain {
                panel.evaluate(start, entries, (forces, matrices), (new, flows));
            } else {
                forces
                    .par_chunks_mut(grain * size)
                    .zip(matrices.par_chunks_mut(grain * room))
                    .zip(new.par_chunks_mut(grain * per_cell))
                    .zip(flows.par_chunks_mut(grain))
                    .enumerate()
                    .for_each(|(k, (((forces, matrices), new), flows))| {
                        let first = start + k * grain;
                        panel.evaluate(first, entries, (forces, matrices), (new, flows));
                    });
            }
            for (k, &flows) in self.flows[..count].iter().enumerate() {
                let entries = match stiffness.is_given(flows) {
                    true => entries,
                    false => 0,
                };
                sink(CellResult {
                    cell: start + k,
                    nodes: self.cells.nodes(start + k),
                    force: &self.force[k * size..(k + 1) * size],
                    stiffness: &self.stiffness[k * room..][..entries],
                });
                any |= flows;
            }
        }
        any
    }

    fn points_per_cell(&self) -> usize {
        self.cells.points_per_cell()
    }

    fn is_symmetric(&self) -> bool {
        self.of_cell.is_symmetric()
    }

    fn has_potential(&self) -> bool {
        self.of_cell.has_potential()
    }

    fn keeps_elastic_stiffness(&self) -> bool {
        self.of_cell.keeps_elastic_stiffness()
    }

    fn lacking(&self, motion: Motion<'_>, v: &[f64], sink: &mut dyn FnMut(&[usize], &[f64])) {
        let all = self.cells.count();
        if all == 0 || self.is_symmetric() {
            return;
        }
        let size = D * self.cells.nodes(0).len();
        let of_a_cell = |(k, force): (usize, &mut [f64])| {
            let (cell, old) = self.cell(k);
            self.of_cell.lacking(cell, old, motion, v, force);
        };
        let mut forces = vec![0.0; all * size];
        let parts = forces.par_chunks_mut(size).enumerate();
        parts
            .with_min_len(GRAIN.div_ceil(self.cells.points_per_cell()))
            .for_each(of_a_cell);
        for (k, force) in forces.chunks_exact(size).enumerate() {
            sink(self.cells.nodes(k), force);
        }
    }

    fn potential(&self, motion: Motion<'_>) -> Option<f64> {
        let of_a_cell = |k: usize| {
            let (cell, old) = self.cell(k);
            self.of_cell.potential(cell, old, motion)
        };
        (0..self.cells.count()).map(of_a_cell).sum()
    }

    fn energy(&self) -> BlockEnergy {
        let (law, mut sum) = (self.of_cell.law(), BlockEnergy::default());
        for (point, (old, new)) in self.old.iter().zip(&self.new).enumerate() {
            let (old, new) = (C::material(old), C::material(new));
            let weight = self.cells.weight(point);
            sum.stored += weight * law.stored_energy(new);
            sum.dissipated += weight * law.dissipation(old, new);
            sum.volume += weight;
            if law.equivalent_plastic_strain(new) > law.equivalent_plastic_strain(old) {
                sum.plastic_volume += weight;
            }
        }
        sum
    }

    fn flow_power(&self, v: &[f64]) -> Option<FlowPower> {
        let mut sum = FlowPower::default();
        for k in 0..self.cells.count() {
            let (cell, old) = self.cell(k);
            sum = sum.with(1.0, self.of_cell.flow_power(cell, old, v)?);
        }
        Some(sum)
    }

    fn commit(&mut self) {
        self.old.copy_from_slice(&self.new);
    }

    fn points(&self, u: &[f64]) -> Vec<PointState<D>> {
        let mut points = Vec::with_capacity(self.old.len());
        self.gradients(u, &mut |point, _| points.push(*point));
        points
    }

    fn fields(&self, u: &[f64]) -> Vec<PointField> {
        let mut fields: Vec<PointField> = Vec::new();
        let count = self.cells.points_per_cell();
        visit_gradients(self.cells.as_ref(), u, &mut |k, gradients| {
            C::average_dilatation((self.cells.as_ref(), k), gradients);
            for (g, gradient) in gradients.iter().enumerate() {
                let state = &self.old[k * count + g];
                let mut index = 0;
                let mut add = |name: &str, values: &[f64]| {
                    if index == fields.len() {
                        fields.push(PointField {
                            name: name.to_owned(),
                            components: values.len(),
                            values: Vec::with_capacity(values.len() * self.old.len()),
                        });
                    }
                    fields[index].values.extend(values);
                    index += 1;
                };
                C::fields(gradient, &mut add);
                let law = self.of_cell.law();
                law.fields(
                    C::material(state),
                    &mut |name, values| match C::frame(state) {
                        Some(frame) => add(name, &turned(&frame, values)),
                        None => add(name, values),
                    },
                );
            }
        });
        fields
    }

    fn gradients(&self, u: &[f64], sink: &mut dyn FnMut(&PointState<D>, &Matrix3<f64>)) {
        let count = self.cells.points_per_cell();
        let mut averaged = [Matrix3::zeros(); MAX_POINTS];
        visit_gradients(self.cells.as_ref(), u, &mut |k, gradients| {
            let averaged = &mut averaged[..count];
            averaged.copy_from_slice(gradients);
            C::average_dilatation((self.cells.as_ref(), k), averaged);
            for (g, (gradient, averaged)) in gradients.iter().zip(averaged).enumerate() {
                sink(&self.point(k * count + g, averaged), gradient);
            }
        });
    }

    fn add_stress_stiffness(&self, v: &[f64], force: &mut [f64]) {
        let stress = |point: usize| self.of_cell.stress(&self.old[point]);
        add_stress_stiffness(self.cells.as_ref(), &stress, v, force);
    }

    fn state(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        for state in &self.old {
            let mut copy = *state;
            copy.visit(&mut |x| numbers.push(*x));
        }
        numbers
    }

    fn restore(&mut self, numbers: &[f64]) -> usize {
        let count = self.state().len();
        if numbers.len() == count {
            let mut next = numbers.iter();
            for state in &mut self.old {
                state.visit(&mut |x| *x = next.next().copied().unwrap_or(*x));
            }
            self.new.copy_from_slice(&self.old);
        }
        count
    }
}

/// Hands every cell on with the displacement gradients at its points.
pub(crate) fn visit_gradients<const D: usize>(
    cells: &dyn Cells<D>,
    u: &[f64],
    sink: &mut dyn FnMut(usize, &mut [Matrix3<f64>]),
) {
    let count = cells.points_per_cell();
    let mut gradients = [Matrix3::zeros(); MAX_POINTS];
    for k in 0..cells.count() {
        cells.gradient(k, u, &mut gradients[..count]);
        sink(k, &mut gradients[..count]);
    }
}

/// [`Block::add_stress_stiffness`] of the stresses at quadrature points.
pub(crate) fn add_stress_stiffness<const D: usize>(
    cells: &dyn Cells<D>,
    stress_at: &dyn Fn(usize) -> Sym2,
    v: &[f64],
    force: &mut [f64],
) {
    let count = cells.points_per_cell();
    let mut gradient = [Matrix3::zeros(); MAX_POINTS];
    let mut of_cell = [0.0; 3 * MAX_POINTS];
    for k in 0..cells.count() {
        cells.gradient(k, v, &mut gradient[..count]);
        let (mut volume, mut mean, mut stress) = (0.0, Matrix3::zeros(), Sym2::zeros());
        for (g, gradient) in gradient[..count].iter().enumerate() {
            let point = k * count + g;
            let weight = cells.weight(point);
            volume += weight;
            mean += gradient * weight;
            stress += stress_at(point) * weight;
        }
        gradient[..count].fill(mean * to_matrix(&stress) / (volume * volume));
        let nodes = cells.nodes(k);
        let own = &mut of_cell[..D * nodes.len()];
        cells.gradient_force(k, &gradient[..count], own);
        for (&a, f) in nodes.iter().zip(own.chunks_exact(D)) {
            let at = force[D * a..D * a + D].iter_mut();
            at.zip(f).for_each(|(sum, f)| *sum += f);
        }
    }
}

/// Components of a scalar, vector or symmetric tensor of a frame, in space.
fn turned(frame: &Matrix3<f64>, values: &[f64]) -> Vec<f64> {
    match *values {
        [x, y, z] => (frame * Vector3::new(x, y, z)).as_slice().to_vec(),
        [_, _, _, _, _, _] => {
            let tensor = to_matrix(&Sym2::from_column_slice(values));
            let tensor = from_matrix(&(frame * tensor * frame.transpose()));
            tensor.as_slice().to_vec()
        }
        _ => values.to_vec(),
    }
}
