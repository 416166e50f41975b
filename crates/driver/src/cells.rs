//! Cells of one element under one hypothesis with their quadrature points: strains, nodal forces
//! and stiffness; no law.

use moreau_mandel::{Sym2, Sym4};
use moreau_mesh::{Element, Hypothesis, Integration, Mesh};
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

    /// Writes ∫ Bᵀ σ dΩ, node by node \[N\], from the stresses at the points of the k-th cell.
    fn force(&self, k: usize, stress: &[Sym2], force: &mut [f64]);

    /// Writes the upper triangle of ∫ Bᵀ C B dΩ, row by row without the lower one \[N/mm\], from
    /// the symmetric tangents at the points of the k-th cell.
    fn stiffness(&self, k: usize, tangent: &[Sym4], stiffness: &mut [f64]);
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
                    sum[a][i] += point.weight * dilatation(&operator[i], a);
                }
            }
        }
        sum.map(|row| row.map(|b| b / volume))
    }

    /// Rows of every column of the operators that may be other than zero: the mean dilatation fills
    /// the first three.
    fn rows(&self) -> [&'static [usize]; D] {
        if self.dilatation.is_empty() {
            H::ROWS
        } else {
            [&[0, 1, 2, 3, 4, 5]; D]
        }
    }

    /// Points of a cell, and their operators B of \[77\], or B̄ with the mean dilatation: by column
    /// of B_a, by row, by node. Next to each other are the nodes, which all do the same; rows not
    /// among [`Self::rows`] are zero.
    fn operators(&self, k: usize) -> impl Iterator<Item = (&Point<D, N>, [[[f64; N]; 6]; D])> {
        let count = self.shapes.len();
        let points = &self.points[k * count..(k + 1) * count];
        let mean = self.dilatation.get(k);
        points.iter().zip(&self.shapes).map(move |(point, shape)| {
            let mut operator = [[[0.0; N]; 6]; D];
            for a in 0..N {
                let b = H::strain_operator(shape[a], &point.gradient[a], &point.position);
                for j in 0..D {
                    for &r in H::ROWS[j] {
                        operator[j][r][a] = b[(r, j)];
                    }
                    if let Some(mean) = mean {
                        let third = (mean[a][j] - dilatation(&operator[j], a)) / 3.0;
                        (0..3).for_each(|r| operator[j][r][a] += third);
                    }
                }
            }
            (point, operator)
        })
    }
}

/// Trace of the strain by a unit displacement of node a, from a column of the operators.
fn dilatation<const N: usize>(column: &[[f64; N]; 6], a: usize) -> f64 {
    column[0][a] + column[1][a] + column[2][a]
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
        let (nodes, rows) = (&self.nodes[k], self.rows());
        let d_u: [[f64; N]; D] =
            std::array::from_fn(|j| std::array::from_fn(|a| d_u[D * nodes[a] + j]));
        for ((_, operator), d_eps) in self.operators(k).zip(d_eps) {
            *d_eps = Sym2::zeros();
            for j in 0..D {
                for &r in rows[j] {
                    for a in 0..N {
                        d_eps[r] += operator[j][r][a] * d_u[j][a];
                    }
                }
            }
        }
    }

    fn force(&self, k: usize, stress: &[Sym2], force: &mut [f64]) {
        let rows = self.rows();
        let mut sum = [[0.0; N]; D];
        for ((point, operator), stress) in self.operators(k).zip(stress) {
            for i in 0..D {
                for &r in rows[i] {
                    let stress = point.weight * stress[r];
                    for a in 0..N {
                        sum[i][a] += operator[i][r][a] * stress;
                    }
                }
            }
        }
        for a in 0..N {
            for i in 0..D {
                force[D * a + i] = sum[i][a];
            }
        }
    }

    fn stiffness(&self, k: usize, tangent: &[Sym4], stiffness: &mut [f64]) {
        // Components (i, j), i ≤ j, of the blocks of all pairs of nodes: whole rows of nodes, which
        // a processor does at once. K is symmetric, and the other components are those of (b, a).
        let rows = self.rows();
        let mut sum = [[[[0.0; N]; N]; D]; D];
        for ((point, operator), tangent) in self.operators(k).zip(tangent) {
            for j in 0..D {
                for i in 0..=j {
                    for &r in rows[i] {
                        let mut traction = [0.0; N];
                        for &s in rows[j] {
                            let c = point.weight * tangent[(r, s)];
                            for b in 0..N {
                                traction[b] += c * operator[j][s][b];
                            }
                        }
                        for a in 0..N {
                            let strain = operator[i][r][a];
                            for b in 0..N {
                                sum[i][j][a][b] += strain * traction[b];
                            }
                        }
                    }
                }
            }
        }
        let mut next = stiffness.iter_mut();
        for a in 0..N {
            for i in 0..D {
                for b in a..N {
                    let first = if a == b { i } else { 0 };
                    for (j, entry) in (first..D).zip(next.by_ref()) {
                        *entry = if i <= j {
                            sum[i][j][a][b]
                        } else {
                            sum[j][i][b][a]
                        };
                    }
                }
            }
        }
    }
}
