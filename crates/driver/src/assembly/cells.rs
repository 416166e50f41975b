//! Cells of one element under one hypothesis with their quadrature points: strains, nodal forces
//! and stiffness; no law.

use crate::ModelError;
use moreau_mandel::{GradientTangent, Sym2, Sym4};
use moreau_mesh::{Element, Entry, Hypothesis, Integration, Mesh};
use nalgebra::{Matrix3, SMatrix};
use pulp::{Arch, Simd, WithSimd};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Largest number of quadrature points of a cell.
pub(crate) const MAX_POINTS: usize = 27;

/// Cells that are integrated alike; their quadrature points are numbered cell by cell.
pub trait Cells<const D: usize>: Send + Sync {
    /// Number of cells.
    fn count(&self) -> usize;

    /// Nodes of the k-th cell.
    fn nodes(&self, k: usize) -> &[usize];

    /// Whether the k-th cell was made of nodes at these positions \[mm\], in its order: another mesh may have the same numbers.
    fn is_at(&self, _k: usize, _nodes: &[[f64; D]]) -> bool {
        true
    }

    /// Quadrature points of a cell, at most 27.
    fn points_per_cell(&self) -> usize;

    /// Position of a quadrature point in the undeformed body \[mm\].
    fn position(&self, point: usize) -> [f64; D];

    /// Quadrature weight times Jacobian times measure of a point \[mm³\].
    fn weight(&self, point: usize) -> f64;

    /// Strain increments Δε = Σ_a B_a ΔU_a, \[77\], at the points of the k-th cell, from the
    /// displacement increments at every degree of freedom of the mesh \[mm\].
    fn strain(&self, k: usize, d_u: &[f64], d_eps: &mut [Sym2]);

    /// Displacement gradients ∂u_i/∂x_j \[–\] at the points of the k-th cell, from the displacements at every
    /// degree of freedom of the mesh \[mm\]; around an axis the third stretch is that of the hoops.
    fn gradient(&self, k: usize, u: &[f64], gradient: &mut [Matrix3<f64>]);

    /// Writes ∫ P : ∂δu/∂x dΩ, node by node \[N\], from P at the points of the k-th cell \[MPa\].
    fn gradient_force(&self, k: usize, flux: &[Matrix3<f64>], force: &mut [f64]);

    /// Writes ∫ Bᵀ σ dΩ, node by node \[N\], from the stresses at the points of the k-th cell.
    fn force(&self, k: usize, stress: &[Sym2], force: &mut [f64]);

    /// Writes the upper triangle of ∫ Bᵀ C B dΩ, row by row without the lower one \[N/mm\], from
    /// the symmetric tangents at the points of the k-th cell.
    fn stiffness(&self, k: usize, tangent: &[Sym4], stiffness: &mut [f64]);

    /// Writes the upper triangle of ∫ ∂δu/∂x : A : ∂u/∂x dΩ, row by row without the lower one \[N/mm\], from
    /// symmetric A = ∂P/∂(∂u/∂x) at the points of the k-th cell \[MPa\]; no dilatation is averaged.
    fn gradient_stiffness(&self, k: usize, tangent: &[GradientTangent], stiffness: &mut [f64]);

    /// Whether the dilatation of a cell is averaged over it.
    fn averages_dilatation(&self) -> bool;
}

/// A number that is another one for other positions.
fn place<const D: usize>(nodes: &[[f64; D]]) -> u64 {
    let mut hasher = DefaultHasher::new();
    // −0 is where 0 is.
    let numbers = nodes.iter().flatten().map(|x| (x + 0.0).to_bits());
    numbers.for_each(|bits| bits.hash(&mut hasher));
    hasher.finish()
}

/// Cells of an element of N nodes: of this crate's or of any other. What strains them is kept field by field with the nodes next to
/// each other, which all do the same.
pub struct ElementCells<const D: usize, const N: usize> {
    nodes: Vec<[usize; N]>,
    /// Of where the nodes of every cell are.
    places: Vec<u64>,
    points_per_cell: usize,
    positions: Vec<[f64; D]>,
    weights: Vec<f64>,
    /// Fields of a point.
    per_point: usize,
    /// Fields of the nodes, point by point.
    fields: Vec<[f64; N]>,
    /// What the operators B_a are made of.
    operator: [&'static [Entry]; D],
    /// What the gradient is made of.
    gradient: [&'static [Entry]; D],
    /// Trace b̄_a of the operators B_a, averaged over each cell; none where it is not.
    dilatation: Vec<[[f64; N]; D]>,
    /// Instructions that the processor has.
    arch: Arch,
}

impl<const D: usize, const N: usize> ElementCells<D, N> {
    /// The given cells of a mesh, interpolated by element E on their nodes, whose order is that of the
    /// kind of the cells.
    ///
    /// # Errors
    /// [`ModelError::WrongElement`] for a cell that has not N nodes, or a rule of none or more than 27
    /// points.
    pub fn new<E: Element<D, N>, H: Hypothesis<D>>(
        mesh: &Mesh<D>,
        cells: &[usize],
        hypothesis: &H,
        integration: Integration,
    ) -> Result<Self, ModelError> {
        let rule = E::rule(integration);
        let fits = |&c: &usize| c < mesh.cell_count() && mesh.cell_nodes(c).len() == N;
        let points = rule.points.len();
        if let Some(&cell) = cells.iter().find(|c| !fits(c)) {
            let problem = format!("has not the {N} nodes of the element");
            return Err(ModelError::WrongElement { cell, problem });
        }
        if let (Some(&cell), false) = (cells.first(), (1..=MAX_POINTS).contains(&points)) {
            let problem = format!("has {points} points of integration, expected 1 to {MAX_POINTS}");
            return Err(ModelError::WrongElement { cell, problem });
        }
        let mut new = Self {
            nodes: Vec::with_capacity(cells.len()),
            places: Vec::with_capacity(cells.len()),
            points_per_cell: rule.points.len(),
            positions: Vec::new(),
            weights: Vec::new(),
            per_point: H::FIELDS,
            fields: Vec::new(),
            operator: H::OPERATOR,
            gradient: H::GRADIENT,
            dilatation: Vec::new(),
            arch: Arch::new(),
        };
        for &c in cells {
            let nodes = mesh.cell_nodes(c);
            let nodes: [usize; N] = std::array::from_fn(|a| nodes[a]);
            let positions = nodes.map(|a| mesh.nodes()[a]);
            for p in &rule.points {
                let at = E::map(&positions, p.xi);
                let of_node: [[f64; 3]; N] =
                    std::array::from_fn(|a| H::fields(at.shape[a], &at.gradient[a], &at.x));
                let field = |f: usize| of_node.map(|fields| fields[f]);
                new.fields.extend((0..H::FIELDS).map(field));
                new.weights
                    .push(p.weight * at.det * hypothesis.measure(&at.x));
                new.positions.push(at.x);
            }
            new.nodes.push(nodes);
            new.places.push(place(&positions));
        }
        if integration == Integration::BBar {
            new.dilatation = (0..new.nodes.len())
                .map(|k| new.mean_dilatation(k))
                .collect();
        }
        Ok(new)
    }

    /// ∫ b_a dΩ / ∫ dΩ over a cell, with b_a the trace of B_a.
    fn mean_dilatation(&self, k: usize) -> [[f64; N]; D] {
        let mut sum = [[0.0; N]; D];
        let mut volume = 0.0;
        for (weight, fields) in self.points(k) {
            volume += weight;
            for (sum, entries) in sum.iter_mut().zip(self.operator) {
                for entry in entries.iter().filter(|e| e.row < 3) {
                    add(sum, weight * entry.factor, &fields[entry.field]);
                }
            }
        }
        sum.map(|row| row.map(|b| b / volume))
    }

    /// Weights and fields of the points of a cell.
    #[inline(always)]
    fn points(&self, k: usize) -> impl Iterator<Item = (f64, &[[f64; N]])> {
        let points = k * self.points_per_cell..(k + 1) * self.points_per_cell;
        let fields = &self.fields[points.start * self.per_point..points.end * self.per_point];
        let weights = self.weights[points].iter().copied();
        weights.zip(fields.chunks_exact(self.per_point))
    }

    #[inline(always)]
    fn strain_of(&self, k: usize, d_u: &[f64], d_eps: &mut [Sym2]) {
        let nodes = &self.nodes[k];
        let d_u: [[f64; N]; D] =
            std::array::from_fn(|j| std::array::from_fn(|a| d_u[D * nodes[a] + j]));
        let mean: Option<f64> = self.dilatation.get(k).map(|mean| {
            let by_axis = mean.iter().zip(&d_u).map(|(b, u)| dot(b, u));
            by_axis.sum()
        });
        for ((_, fields), d_eps) in self.points(k).zip(d_eps) {
            *d_eps = Sym2::zeros();
            for (entries, u) in self.operator.iter().zip(&d_u) {
                for entry in *entries {
                    d_eps[entry.row] += entry.factor * dot(&fields[entry.field], u);
                }
            }
            if let Some(mean) = mean {
                let missing = (mean - trace(d_eps)) / 3.0;
                (0..3).for_each(|r| d_eps[r] += missing);
            }
        }
    }

    #[inline(always)]
    fn gradient_of(&self, k: usize, u: &[f64], gradient: &mut [Matrix3<f64>]) {
        let nodes = &self.nodes[k];
        let u: [[f64; N]; D] = std::array::from_fn(|i| nodes.map(|a| u[D * a + i]));
        for ((_, fields), gradient) in self.points(k).zip(gradient) {
            *gradient = Matrix3::zeros();
            for (entries, u) in self.gradient.iter().zip(&u) {
                for entry in *entries {
                    gradient[(entry.row / 3, entry.row % 3)] += dot(&fields[entry.field], u);
                }
            }
        }
    }

    #[inline(always)]
    fn gradient_force_of(&self, k: usize, flux: &[Matrix3<f64>], force: &mut [f64]) {
        let mut sum = [[0.0; N]; D];
        for ((weight, fields), flux) in self.points(k).zip(flux) {
            for (sum, entries) in sum.iter_mut().zip(self.gradient) {
                for entry in entries {
                    let part = weight * flux[(entry.row / 3, entry.row % 3)];
                    add(sum, part, &fields[entry.field]);
                }
            }
        }
        for a in 0..N {
            for i in 0..D {
                force[D * a + i] = sum[i][a];
            }
        }
    }

    #[inline(always)]
    fn force_of(&self, k: usize, stress: &[Sym2], force: &mut [f64]) {
        let mean = self.dilatation.get(k);
        let mut sum = [[0.0; N]; D];
        let mut pressure = 0.0;
        for ((weight, fields), stress) in self.points(k).zip(stress) {
            let mut stress = *stress;
            if mean.is_some() {
                let hydrostatic = trace(&stress) / 3.0;
                (0..3).for_each(|r| stress[r] -= hydrostatic);
                pressure += weight * hydrostatic;
            }
            for (sum, entries) in sum.iter_mut().zip(self.operator) {
                for entry in entries {
                    let part = weight * entry.factor * stress[entry.row];
                    add(sum, part, &fields[entry.field]);
                }
            }
        }
        if let Some(mean) = mean {
            for (sum, mean) in sum.iter_mut().zip(mean) {
                add(sum, pressure, mean);
            }
        }
        for a in 0..N {
            for i in 0..D {
                force[D * a + i] = sum[i][a];
            }
        }
    }

    #[inline(always)]
    fn stiffness_of(&self, k: usize, tangents: &[Sym4], stiffness: &mut [f64]) {
        let mean = self
            .dilatation
            .get(k)
            .map(|mean| self.mean_stiffness(k, mean, tangents));
        let deviatoric: [Sym4; MAX_POINTS];
        let tangents = if mean.is_some() {
            deviatoric =
                std::array::from_fn(|g| tangents.get(g).map_or_else(Sym4::zeros, without_trace));
            &deviatoric[..tangents.len()]
        } else {
            tangents
        };
        self.triangle(k, self.operator, tangents, mean, stiffness);
    }

    /// The upper triangle of Σ w Bᵀ C B with an operator B, and what the mean dilatation adds.
    #[inline(always)]
    fn triangle<const R: usize>(
        &self,
        k: usize,
        operator: [&'static [Entry]; D],
        tangents: &[SMatrix<f64, R, R>],
        mean: Option<MeanStiffness<'_, D, N>>,
        stiffness: &mut [f64],
    ) {
        // First entry of a row of the triangle, were it a square.
        let row = |unknown: usize| unknown * (2 * D * N + 1 - unknown) / 2 - unknown;
        let fields = &self.fields[k * self.points_per_cell * self.per_point..];
        let weights = &self.weights[k * self.points_per_cell..];
        // Components (i, j), i ≤ j, of the blocks of all pairs of nodes. K is symmetric, and the
        // other components are those of (b, a).
        for j in 0..D {
            for i in 0..=j {
                let mut sum = [[0.0; N]; N];
                if let Some((coupling, mean, bulk)) = &mean {
                    for a in 0..N {
                        add(&mut sum[a], coupling[i][a] + bulk * mean[i][a], &mean[j]);
                        add(&mut sum[a], mean[i][a], &coupling[j]);
                    }
                }
                // A row of the sum stays in registers for all terms of some points.
                for first in (0..tangents.len()).step_by(POINTS) {
                    let mut strains = [&fields[0]; POINTS * ENTRIES];
                    let mut tractions = [[0.0; N]; POINTS * ENTRIES];
                    let mut count = 0;
                    for g in first..tangents.len().min(first + POINTS) {
                        let fields = &fields[g * self.per_point..(g + 1) * self.per_point];
                        for left in operator[i] {
                            let mut traction = [0.0; N];
                            for right in operator[j] {
                                let c = weights[g] * tangents[g][(left.row, right.row)];
                                let c = c * (left.factor * right.factor);
                                add(&mut traction, c, &fields[right.field]);
                            }
                            tractions[count] = traction;
                            strains[count] = &fields[left.field];
                            count += 1;
                        }
                    }
                    for a in 0..N {
                        let mut row = sum[a];
                        for (strain, traction) in strains[..count].iter().zip(&tractions) {
                            add(&mut row, strain[a], traction);
                        }
                        sum[a] = row;
                    }
                }
                for a in 0..N {
                    let first = D * a + i;
                    for b in 0..N {
                        let second = D * b + j;
                        if b >= a {
                            stiffness[row(first) + second] = sum[a][b];
                        } else if i < j {
                            stiffness[row(second) + first] = sum[a][b];
                        }
                    }
                }
            }
        }
    }

    /// What the mean dilatation adds to the stiffness: B̄ᵀ C B̄ is that of the tangents without
    /// traces, and v b̄ᵀ + b̄ vᵀ + κ b̄ b̄ᵀ with v = ∫ Bᵀ P C 1/3 dΩ and κ = ∫ 1·C 1/9 dΩ.
    #[inline(always)]
    fn mean_stiffness<'a>(
        &self,
        k: usize,
        mean: &'a [[f64; N]; D],
        tangents: &[Sym4],
    ) -> MeanStiffness<'a, D, N> {
        let mut coupling = [[0.0; N]; D];
        let mut bulk = 0.0;
        for ((weight, fields), tangent) in self.points(k).zip(tangents) {
            let mut stress = Sym2::zeros();
            (0..3).for_each(|s| stress += tangent.column(s));
            stress /= 3.0;
            let hydrostatic = trace(&stress) / 3.0;
            bulk += weight * hydrostatic;
            (0..3).for_each(|r| stress[r] -= hydrostatic);
            for (sum, entries) in coupling.iter_mut().zip(self.operator) {
                for entry in entries {
                    let part = weight * entry.factor * stress[entry.row];
                    add(sum, part, &fields[entry.field]);
                }
            }
        }
        (coupling, mean, bulk)
    }
}

/// v, b̄ and κ of [`ElementCells::mean_stiffness`].
type MeanStiffness<'a, const D: usize, const N: usize> = ([[f64; N]; D], &'a [[f64; N]; D], f64);

/// Points whose terms of the stiffness are summed together.
const POINTS: usize = 4;

/// Most entries of a column of an operator.
const ENTRIES: usize = 3;

fn trace(tensor: &Sym2) -> f64 {
    tensor[0] + tensor[1] + tensor[2]
}

/// P C P with P the projection on tensors without a trace.
#[inline(always)]
fn without_trace(tangent: &Sym4) -> Sym4 {
    let mut c = *tangent;
    for s in 0..6 {
        let mean = (c[(0, s)] + c[(1, s)] + c[(2, s)]) / 3.0;
        (0..3).for_each(|r| c[(r, s)] -= mean);
    }
    for r in 0..6 {
        let mean = (c[(r, 0)] + c[(r, 1)] + c[(r, 2)]) / 3.0;
        (0..3).for_each(|s| c[(r, s)] -= mean);
    }
    c
}

/// a ← a + s b.
#[inline(always)]
fn add<const N: usize>(a: &mut [f64; N], s: f64, b: &[f64; N]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += s * b;
    }
}

/// Σ a b, four terms at once.
#[inline(always)]
fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sums = [0.0; 4];
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        sums[k % 4] += a * b;
    }
    sums[0] + sums[1] + (sums[2] + sums[3])
}

/// A kernel of a cell, compiled for every set of instructions that a processor may have. None of
/// them adds in another order, and none rounds once where another rounds twice.
enum Kernel<'a> {
    Strain(&'a [f64], &'a mut [Sym2]),
    Force(&'a [Sym2], &'a mut [f64]),
    Stiffness(&'a [Sym4], &'a mut [f64]),
    Gradient(&'a [f64], &'a mut [Matrix3<f64>]),
    GradientForce(&'a [Matrix3<f64>], &'a mut [f64]),
    GradientStiffness(&'a [GradientTangent], &'a mut [f64]),
}

struct OfCell<'a, const D: usize, const N: usize> {
    cells: &'a ElementCells<D, N>,
    cell: usize,
    kernel: Kernel<'a>,
}

impl<const D: usize, const N: usize> WithSimd for OfCell<'_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (cells, k) = (self.cells, self.cell);
        match self.kernel {
            Kernel::Strain(d_u, d_eps) => cells.strain_of(k, d_u, d_eps),
            Kernel::Force(stress, force) => cells.force_of(k, stress, force),
            Kernel::Stiffness(tangent, stiffness) => cells.stiffness_of(k, tangent, stiffness),
            Kernel::Gradient(u, gradient) => cells.gradient_of(k, u, gradient),
            Kernel::GradientForce(flux, force) => cells.gradient_force_of(k, flux, force),
            Kernel::GradientStiffness(tangent, stiffness) => {
                cells.triangle(k, cells.gradient, tangent, None, stiffness);
            }
        }
    }
}

impl<const D: usize, const N: usize> ElementCells<D, N> {
    fn dispatch(&self, cell: usize, kernel: Kernel<'_>) {
        let cells = self;
        self.arch.dispatch(OfCell {
            cells,
            cell,
            kernel,
        });
    }
}

impl<const D: usize, const N: usize> Cells<D> for ElementCells<D, N> {
    fn count(&self) -> usize {
        self.nodes.len()
    }

    fn nodes(&self, k: usize) -> &[usize] {
        &self.nodes[k]
    }

    fn is_at(&self, k: usize, nodes: &[[f64; D]]) -> bool {
        self.places[k] == place(nodes)
    }

    fn points_per_cell(&self) -> usize {
        self.points_per_cell
    }

    fn position(&self, point: usize) -> [f64; D] {
        self.positions[point]
    }

    fn weight(&self, point: usize) -> f64 {
        self.weights[point]
    }

    fn gradient(&self, k: usize, u: &[f64], gradient: &mut [Matrix3<f64>]) {
        self.dispatch(k, Kernel::Gradient(u, gradient));
    }

    fn gradient_force(&self, k: usize, flux: &[Matrix3<f64>], force: &mut [f64]) {
        self.dispatch(k, Kernel::GradientForce(flux, force));
    }

    fn gradient_stiffness(&self, k: usize, tangent: &[GradientTangent], stiffness: &mut [f64]) {
        self.dispatch(k, Kernel::GradientStiffness(tangent, stiffness));
    }

    fn averages_dilatation(&self) -> bool {
        !self.dilatation.is_empty()
    }

    fn strain(&self, k: usize, d_u: &[f64], d_eps: &mut [Sym2]) {
        self.dispatch(k, Kernel::Strain(d_u, d_eps));
    }

    fn force(&self, k: usize, stress: &[Sym2], force: &mut [f64]) {
        self.dispatch(k, Kernel::Force(stress, force));
    }

    fn stiffness(&self, k: usize, tangent: &[Sym4], stiffness: &mut [f64]) {
        self.dispatch(k, Kernel::Stiffness(tangent, stiffness));
    }
}
