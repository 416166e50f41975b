//! Cells of one element under one hypothesis with their quadrature points: strains, nodal forces
//! and stiffness; no law.

use moreau_mandel::{Sym2, Sym4};
use moreau_mesh::{Element, Hypothesis, Integration, Mesh};
use nalgebra::{SMatrix, SVector};
use std::marker::PhantomData;

/// Largest number of quadrature points of a cell.
pub(crate) const MAX_POINTS: usize = 27;

/// Cells that are integrated alike; their quadrature points are numbered cell by cell.
pub trait Cells<const D: usize>: Send + Sync {
    /// Number of cells.
    fn count(&self) -> usize;

    /// Nodes of the k-th cell.
    fn nodes(&self, k: usize) -> &[usize];

    /// Quadrature points of a cell, at most 27.
    fn points_per_cell(&self) -> usize;

    /// Position of a quadrature point in the undeformed body \[mm\].
    fn position(&self, point: usize) -> [f64; D];

    /// Quadrature weight times Jacobian times measure of a point \[mm³\].
    fn weight(&self, point: usize) -> f64;

    /// Strain increments Δε = Σ_a B_a ΔU_a, \[77\], at the points of the k-th cell, from the
    /// displacement increments at every degree of freedom of the mesh \[mm\].
    fn strain(&self, k: usize, d_u: &[f64], d_eps: &mut [Sym2]);

    /// Adds ∫ Bᵀ σ dΩ, node by node \[N\], from the stresses at the points of the k-th cell.
    fn add_force(&self, k: usize, stress: &[Sym2], force: &mut [f64]);

    /// Adds the upper triangle of ∫ Bᵀ C B dΩ, row by row \[N/mm\], from the tangents at the points
    /// of the k-th cell.
    fn add_stiffness(&self, k: usize, tangent: &[Sym4], stiffness: &mut [f64]);
}

/// A quadrature point of a cell.
#[derive(Debug, Clone)]
struct Point<const D: usize, const N: usize> {
    gradient: [[f64; D]; N],
    position: [f64; D],
    weight: f64,
}

/// Cells of element E under hypothesis H.
pub(crate) struct ElementCells<E, H, const D: usize, const N: usize> {
    nodes: Vec<[usize; N]>,
    /// Shape functions at the points of the reference cell.
    shapes: Vec<[f64; N]>,
    points: Vec<Point<D, N>>,
    /// Trace b̄_a of the operators B_a, averaged over each cell; none where it is not.
    dilatation: Vec<[[f64; D]; N]>,
    kind: PhantomData<fn() -> (E, H)>,
}

impl<E, H, const D: usize, const N: usize> ElementCells<E, H, D, N>
where
    E: Element<D, N>,
    H: Hypothesis<D>,
{
    /// The given cells, all of element E, of a mesh.
    pub(crate) fn new(
        mesh: &Mesh<D>,
        cells: &[usize],
        hypothesis: &H,
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
        let mut new = Self {
            nodes,
            shapes,
            points,
            dilatation: Vec::new(),
            kind: PhantomData,
        };
        if integration == Integration::BBar {
            new.dilatation = (0..new.count()).map(|k| new.mean_dilatation(k)).collect();
        }
        new
    }

    /// ∫ b_a dΩ / ∫ dΩ over a cell, with b_a the trace of B_a.
    fn mean_dilatation(&self, k: usize) -> [[f64; D]; N] {
        let mut sum = [[0.0; D]; N];
        let mut volume = 0.0;
        for (point, operator) in self.operators(k) {
            volume += point.weight;
            for a in 0..N {
                for i in 0..D {
                    sum[a][i] += point.weight * dilatation(&operator[a], i);
                }
            }
        }
        sum.map(|row| row.map(|b| b / volume))
    }

    /// Points of a cell, and their operators B_a of \[77\], or B̄_a with the mean dilatation.
    fn operators(&self, k: usize) -> impl Iterator<Item = (&Point<D, N>, [SMatrix<f64, 6, D>; N])> {
        let count = self.shapes.len();
        let points = &self.points[k * count..(k + 1) * count];
        let mean = self.dilatation.get(k);
        points.iter().zip(&self.shapes).map(move |(point, shape)| {
            let operator = std::array::from_fn(|a| {
                let mut b = H::strain_operator(shape[a], &point.gradient[a], &point.position);
                if let Some(mean) = mean {
                    for i in 0..D {
                        let third = (mean[a][i] - dilatation(&b, i)) / 3.0;
                        (0..3).for_each(|j| b[(j, i)] += third);
                    }
                }
                b
            });
            (point, operator)
        })
    }
}

/// Trace of the strain by a unit displacement along axis i.
fn dilatation<const D: usize>(b: &SMatrix<f64, 6, D>, i: usize) -> f64 {
    b[(0, i)] + b[(1, i)] + b[(2, i)]
}

impl<E, H, const D: usize, const N: usize> Cells<D> for ElementCells<E, H, D, N>
where
    E: Element<D, N>,
    H: Hypothesis<D>,
{
    fn count(&self) -> usize {
        self.nodes.len()
    }

    fn nodes(&self, k: usize) -> &[usize] {
        &self.nodes[k]
    }

    fn points_per_cell(&self) -> usize {
        self.shapes.len()
    }

    fn position(&self, point: usize) -> [f64; D] {
        self.points[point].position
    }

    fn weight(&self, point: usize) -> f64 {
        self.points[point].weight
    }

    fn strain(&self, k: usize, d_u: &[f64], d_eps: &mut [Sym2]) {
        let d_u = self.nodes[k].map(|a| SVector::<f64, D>::from_column_slice(&d_u[D * a..][..D]));
        for ((_, operator), d_eps) in self.operators(k).zip(d_eps) {
            *d_eps = Sym2::zeros();
            for a in 0..N {
                *d_eps += operator[a] * d_u[a];
            }
        }
    }

    fn add_force(&self, k: usize, stress: &[Sym2], force: &mut [f64]) {
        for ((point, operator), stress) in self.operators(k).zip(stress) {
            let stress = stress * point.weight;
            for a in 0..N {
                let f = operator[a].tr_mul(&stress);
                for i in 0..D {
                    force[D * a + i] += f[i];
                }
            }
        }
    }

    fn add_stiffness(&self, k: usize, tangent: &[Sym4], stiffness: &mut [f64]) {
        let size = N * D;
        for ((point, operator), tangent) in self.operators(k).zip(tangent) {
            let tangent = tangent * point.weight;
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
    }
}
