//! Blocks of cells of one element, one hypothesis and one law: forces and stiffness of their
//! cells; not their assembly.

use moreau_laws::BulkLaw;
use moreau_mandel::{Sym2, Sym4};
use moreau_mesh::{Element, Hypothesis, Integration, Mesh};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use std::marker::PhantomData;

/// Which stiffness an evaluation computes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// None: forces only.
    None,
    /// The consistent tangent ∂σ₁/∂Δε.
    Consistent,
    /// This part of the elastic stiffness, in [0, 1], and the rest of the consistent tangent.
    Blended(f64),
}

/// Forces of a cell and, if asked for, its stiffness.
#[derive(Debug, Clone, Copy)]
pub struct CellResult<'a> {
    /// Index of the cell in its block.
    pub cell: usize,
    /// ∫ Bᵀ σ₁ dΩ, node by node \[N\].
    pub force: &'a [f64],
    /// ∫ Bᵀ C B dΩ \[N/mm\], row by row, upper triangle only; empty if not asked for.
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
    /// Cauchy stress \[MPa\].
    pub stress: Sym2,
    /// Equivalent plastic strain p.
    pub plastic_strain: f64,
}

/// A set of cells that are integrated alike. The state at the start of the step changes only in
/// [`Block::commit`]; everything else works on a candidate.
pub trait Block<const D: usize>: Send + Sync {
    /// Cells of the mesh in this block.
    fn cells(&self) -> &[usize];

    /// Nodes of the k-th cell of the block.
    fn nodes(&self, k: usize) -> &[usize];

    /// Forces and stiffness under the displacement increments `d_u` of the whole step (one entry
    /// a degree of freedom of the mesh), handed cell by cell, in order, to `sink`. Returns whether
    /// plastic strain grows anywhere.
    fn evaluate(
        &mut self,
        d_u: &[f64],
        stiffness: Stiffness,
        sink: &mut dyn FnMut(CellResult<'_>),
    ) -> bool;

    /// ∫ ΔV(Δε) + σ₀ : Δε dΩ, the bulk part of ΔΦ \[74\] when total forces are
    /// applied instead of increments \[N·mm\]; `None` of a law without a potential.
    fn potential(&self, d_u: &[f64]) -> Option<f64>;

    /// Energies of the candidate that the last evaluation left.
    fn energy(&self) -> BlockEnergy;

    /// Makes the candidate the state at the start of the next step.
    fn commit(&mut self);

    /// The committed state at every quadrature point, cell by cell.
    fn points(&self) -> Vec<PointState<D>>;
}

/// Cells evaluated before their results are handed on: bounds the memory of the buffers.
const PANEL: usize = 2048;

/// Cells that are worth a thread.
const GRAIN: usize = 64;

/// A quadrature point of a cell.
#[derive(Debug, Clone)]
struct Point<const D: usize, const N: usize> {
    gradient: [[f64; D]; N],
    position: [f64; D],
    weight: f64,
}

/// The block of element E under hypothesis H with law L.
#[derive(Debug, Clone)]
pub struct SolidBlock<E, H, L: BulkLaw, const D: usize, const N: usize> {
    cells: Vec<usize>,
    nodes: Vec<[usize; N]>,
    /// Shape functions at the points of the reference cell.
    shapes: Vec<[f64; N]>,
    points: Vec<Point<D, N>>,
    law: L,
    old: Vec<L::State>,
    new: Vec<L::State>,
    force: Vec<f64>,
    stiffness: Vec<f64>,
    kind: PhantomData<(E, H)>,
}

impl<E, H, L, const D: usize, const N: usize> SolidBlock<E, H, L, D, N>
where
    E: Element<D, N>,
    H: Hypothesis<D>,
    L: BulkLaw,
{
    /// The block of `cells`, all of element E, of a mesh.
    pub fn new(
        mesh: &Mesh<D>,
        cells: Vec<usize>,
        hypothesis: &H,
        law: L,
        integration: Integration,
    ) -> Self {
        let rule = E::rule(integration);
        let shapes: Vec<[f64; N]> = rule.points.iter().map(|p| E::shape(p.xi)).collect();
        let nodes: Vec<[usize; N]> = cells
            .iter()
            .map(|&c| {
                let nodes = mesh.cell_nodes(c);
                std::array::from_fn(|a| nodes[a])
            })
            .collect();
        let mut points = Vec::with_capacity(cells.len() * shapes.len());
        for cell in &nodes {
            let positions = cell.map(|a| mesh.nodes()[a]);
            for p in &rule.points {
                let at = E::map(&positions, p.xi);
                let weight = p.weight * at.det * hypothesis.measure(&at.x);
                points.push(Point {
                    gradient: at.gradient,
                    position: at.x,
                    weight,
                });
            }
        }
        let states = vec![L::State::default(); points.len()];
        Self {
            cells,
            nodes,
            shapes,
            points,
            law,
            old: states.clone(),
            new: states,
            force: Vec::new(),
            stiffness: Vec::new(),
            kind: PhantomData,
        }
    }
}

/// What a cell is evaluated from.
struct CellView<'a, S, const D: usize, const N: usize> {
    shapes: &'a [[f64; N]],
    points: &'a [Point<D, N>],
    old: &'a [S],
    nodes: &'a [usize; N],
}

impl<S: Copy, const D: usize, const N: usize> CellView<'_, S, D, N> {
    /// Operators B_a of \[77\] at a point of the rule, and the strain increment there.
    #[inline]
    fn strain<H: Hypothesis<D>>(&self, g: usize, d_u: &[f64]) -> ([SMatrix<f64, 6, D>; N], Sym2) {
        let (shape, point) = (&self.shapes[g], &self.points[g]);
        let operator = std::array::from_fn(|a| {
            H::strain_operator(shape[a], &point.gradient[a], &point.position)
        });
        let mut d_eps = Sym2::zeros();
        for a in 0..N {
            let first = D * self.nodes[a];
            d_eps += operator[a] * SVector::<f64, D>::from_column_slice(&d_u[first..first + D]);
        }
        (operator, d_eps)
    }

    /// Forces, the upper triangle of the stiffness unless its slice is empty, and new states.
    /// Returns whether plastic strain grows.
    #[inline]
    fn evaluate<H: Hypothesis<D>, L: BulkLaw<State = S>>(
        &self,
        law: &L,
        blend: Option<&(f64, Sym4)>,
        d_u: &[f64],
        (force, stiffness, new): (&mut [f64], &mut [f64], &mut [S]),
    ) -> bool {
        let size = N * D;
        let mut flows = false;
        force.fill(0.0);
        stiffness.fill(0.0);
        for g in 0..self.points.len() {
            let weight = self.points[g].weight;
            let (operator, d_eps) = self.strain::<H>(g, d_u);
            let response = law.respond(&self.old[g], &d_eps);
            new[g] = response.state;
            flows |= law.equivalent_plastic_strain(&new[g])
                > law.equivalent_plastic_strain(&self.old[g]);
            let stress = response.stress * weight;
            for a in 0..N {
                let f = operator[a].tr_mul(&stress);
                for i in 0..D {
                    force[D * a + i] += f[i];
                }
            }
            if stiffness.is_empty() {
                continue;
            }
            let tangent = match blend {
                None => response.tangent * weight,
                Some((part, elastic)) => {
                    elastic * (part * weight) + response.tangent * ((1.0 - part) * weight)
                }
            };
            for b in 0..N {
                let column = tangent * operator[b];
                for a in 0..=b {
                    let k_ab = operator[a].tr_mul(&column);
                    for i in 0..D {
                        for j in 0..D {
                            stiffness[(D * a + i) * size + D * b + j] += k_ab[(i, j)];
                        }
                    }
                }
            }
        }
        flows
    }
}

impl<E, H, L, const D: usize, const N: usize> Block<D> for SolidBlock<E, H, L, D, N>
where
    E: Element<D, N>,
    H: Hypothesis<D>,
    L: BulkLaw,
{
    fn cells(&self) -> &[usize] {
        &self.cells
    }

    fn nodes(&self, k: usize) -> &[usize] {
        &self.nodes[k]
    }

    fn evaluate(
        &mut self,
        d_u: &[f64],
        stiffness: Stiffness,
        sink: &mut dyn FnMut(CellResult<'_>),
    ) -> bool {
        let size = N * D;
        let per_cell = self.shapes.len();
        let panel = PANEL.min(self.cells.len());
        let entries = if stiffness == Stiffness::None {
            0
        } else {
            size * size
        };
        self.force.resize(panel * size, 0.0);
        // One entry a cell at least, so that the parallel chunks below stay aligned.
        self.stiffness.resize(panel * entries.max(1), 0.0);
        let blend = match stiffness {
            Stiffness::Blended(part) => Some((part, self.law.elastic_tangent())),
            Stiffness::None | Stiffness::Consistent => None,
        };
        let law = &self.law;
        let mut flows = false;
        for start in (0..self.cells.len()).step_by(PANEL) {
            let count = PANEL.min(self.cells.len() - start);
            let range = start * per_cell..(start + count) * per_cell;
            let (points, old) = (&self.points[range.clone()], &self.old[range.clone()]);
            let nodes = &self.nodes[start..start + count];
            let at = |k: usize| CellView {
                shapes: &self.shapes,
                points: &points[k * per_cell..(k + 1) * per_cell],
                old: &old[k * per_cell..(k + 1) * per_cell],
                nodes: &nodes[k],
            };
            let forces = &mut self.force[..count * size];
            let matrices = &mut self.stiffness[..count * entries.max(1)];
            let new = &mut self.new[range];
            // The order of the cells, and with it every sum, is the same for any number of threads.
            flows |= if count < 2 * GRAIN {
                forces
                    .chunks_mut(size)
                    .zip(matrices.chunks_mut(entries.max(1)))
                    .zip(new.chunks_mut(per_cell))
                    .enumerate()
                    .map(|(k, ((force, matrix), new))| {
                        let matrix = &mut matrix[..entries];
                        at(k).evaluate::<H, L>(law, blend.as_ref(), d_u, (force, matrix, new))
                    })
                    .fold(false, |a, b| a | b)
            } else {
                forces
                    .par_chunks_mut(size)
                    .zip(matrices.par_chunks_mut(entries.max(1)))
                    .zip(new.par_chunks_mut(per_cell))
                    .enumerate()
                    .with_min_len(GRAIN)
                    .map(|(k, ((force, matrix), new))| {
                        let matrix = &mut matrix[..entries];
                        at(k).evaluate::<H, L>(law, blend.as_ref(), d_u, (force, matrix, new))
                    })
                    .reduce(|| false, |a, b| a | b)
            };
            for k in 0..count {
                sink(CellResult {
                    cell: start + k,
                    force: &self.force[k * size..(k + 1) * size],
                    stiffness: &self.stiffness[k * entries..(k + 1) * entries],
                });
            }
        }
        flows
    }

    fn potential(&self, d_u: &[f64]) -> Option<f64> {
        let per_cell = self.shapes.len();
        let mut sum = 0.0;
        for (k, nodes) in self.nodes.iter().enumerate() {
            let range = k * per_cell..(k + 1) * per_cell;
            let (points, old) = (&self.points[range.clone()], &self.old[range]);
            let view = CellView {
                shapes: &self.shapes,
                points,
                old,
                nodes,
            };
            for g in 0..per_cell {
                let (_, d_eps) = view.strain::<H>(g, d_u);
                // ΔV leaves out the linear part σ₀·Δε, [48]: it is what equilibrium held before.
                let linear = self.law.stress(&old[g]).dot(&d_eps);
                sum += points[g].weight * (self.law.potential(&old[g], &d_eps)? + linear);
            }
        }
        Some(sum)
    }

    fn energy(&self) -> BlockEnergy {
        let mut sum = BlockEnergy::default();
        for ((point, old), new) in self.points.iter().zip(&self.old).zip(&self.new) {
            sum.stored += point.weight * self.law.stored_energy(new);
            sum.dissipated += point.weight * self.law.dissipation(old, new);
            sum.volume += point.weight;
            if self.law.equivalent_plastic_strain(new) > self.law.equivalent_plastic_strain(old) {
                sum.plastic_volume += point.weight;
            }
        }
        sum
    }

    fn commit(&mut self) {
        self.old.copy_from_slice(&self.new);
    }

    fn points(&self) -> Vec<PointState<D>> {
        let per_cell = self.shapes.len();
        let state = |(k, (point, state)): (usize, (&Point<D, N>, &L::State))| PointState {
            cell: self.cells[k / per_cell],
            position: point.position,
            weight: point.weight,
            stress: self.law.stress(state),
            plastic_strain: self.law.equivalent_plastic_strain(state),
        };
        self.points
            .iter()
            .zip(&self.old)
            .enumerate()
            .map(state)
            .collect()
    }
}
