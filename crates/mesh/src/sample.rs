//! Shape functions tabulated by run-time kind, for what a mesh computes on its own geometry; not
//! for assembling, which knows its element at compile time.

use crate::geometry::{basis, cofactors, dot, interpolate};
use crate::quadrature::{Integration, Point, Rule};
use crate::{
    CellKind, Element, FacetKind, Hex8, Hex20, Hex27, Line2, Line3, Quad4, Quad8, Quad9, Tet4,
    Tet10, Tri3, Tri6,
};

/// Shape functions at one point of a reference cell or facet.
pub(crate) struct Sample<const D: usize> {
    pub(crate) weight: f64,
    pub(crate) shape: Vec<f64>,
    /// Derivatives along the last coordinates of D; a facet has none along the first.
    gradient: Vec<[f64; D]>,
}

impl<const D: usize> Sample<D> {
    pub(crate) fn position(&self, nodes: &[[f64; D]]) -> [f64; D] {
        interpolate(&self.shape, nodes)
    }

    /// The change of reference coordinates that the map of a cell, linearised here, makes of a way \[mm\]; not finite
    /// where the cell has no volume.
    pub(crate) fn pulled_back(&self, way: &[f64; D], nodes: &[[f64; D]]) -> [f64; D] {
        let g = basis(&self.gradient, nodes);
        let c = cofactors(&g);
        let det = dot(&g[0], &c[0]);
        std::array::from_fn(|j| dot(&c[j], way) / det)
    }

    /// Jacobian determinant of a cell.
    pub(crate) fn det(&self, nodes: &[[f64; D]]) -> f64 {
        let g = basis(&self.gradient, nodes);
        dot(&g[0], &cofactors(&g)[0])
    }

    /// D det(M)^(2/D) / |M|² of the map M from the regular cell of the same kind, a square or an equilateral triangle, to
    /// a cell: 1 if it is similar to that, and 0 or less where it has no volume.
    pub(crate) fn regularity(&self, nodes: &[[f64; D]], simplex: bool) -> f64 {
        let g = basis(&self.gradient, nodes);
        // Of the regular simplex with unit edges the metric is ½ (1 + δ), whose inverse is 2 (δ − 1 / (D + 1)).
        let d = D as f64;
        let metric = |i: usize, j: usize| match (simplex, i == j) {
            (true, same) => 2.0 * (f64::from(u8::from(same)) - 1.0 / (d + 1.0)),
            (false, same) => f64::from(u8::from(same)),
        };
        let volume = match (simplex, D) {
            (true, 2) => 0.75f64.sqrt(),
            (true, _) => 0.5f64.sqrt(),
            (false, _) => 1.0,
        };
        let squared: f64 = (0..D)
            .flat_map(|i| (0..D).map(move |j| (i, j)))
            .map(|(i, j)| metric(i, j) * dot(&g[i], &g[j]))
            .sum();
        // A ratio first: other units of length are then the same to the bit.
        let cube = if D == 2 {
            squared
        } else {
            squared * squared.sqrt()
        };
        let det = dot(&g[0], &cofactors(&g)[0]) / (volume * cube);
        d * det.signum() * det.abs().powf(2.0 / d)
    }

    /// Area vector of a facet, outwards: its length is the factor from reference to physical area.
    pub(crate) fn area_vector(&self, nodes: &[[f64; D]]) -> [f64; D] {
        cofactors(&basis(&self.gradient, nodes))[0]
    }

    /// Derivatives of [`Self::area_vector`] by the coordinates of one of the nodes.
    pub(crate) fn area_vector_by(&self, nodes: &[[f64; D]], node: usize) -> [[f64; D]; D] {
        let tangents = basis(&self.gradient, nodes);
        std::array::from_fn(|i| {
            let mut sum = [0.0; D];
            // Linear in each of the tangents.
            for k in 1..D {
                let mut varied = tangents;
                varied[k] = [0.0; D];
                varied[k][i] = self.gradient[node][k];
                let part = cofactors(&varied)[0];
                sum.iter_mut()
                    .zip(part)
                    .for_each(|(sum, part)| *sum += part);
            }
            sum
        })
    }
}

fn sample<const D: usize, const M: usize, const N: usize, E: Element<M, N>>(
    p: Point<M>,
) -> Sample<D> {
    Sample {
        weight: p.weight,
        shape: E::shape(p.xi).to_vec(),
        gradient: E::shape_gradient(p.xi)
            .iter()
            .map(|g| std::array::from_fn(|i| if i < D - M { 0.0 } else { g[i + M - D] }))
            .collect(),
    }
}

fn tabulate<const D: usize, const M: usize, const N: usize, E: Element<M, N>>(
    points: impl IntoIterator<Item = Point<M>>,
) -> Vec<Sample<D>> {
    points.into_iter().map(sample::<D, M, N, E>).collect()
}

fn tabulate_facet<const D: usize, const M: usize, const N: usize, E: Element<M, N>>()
-> Vec<Sample<D>> {
    tabulate::<D, M, N, E>(E::rule(Integration::Full).points)
}

/// The points of the full rule of a kind of facet.
pub(crate) fn facet_samples<const D: usize>(kind: FacetKind) -> Vec<Sample<D>> {
    match kind {
        FacetKind::Line2 => tabulate_facet::<D, 1, 2, Line2>(),
        FacetKind::Line3 => tabulate_facet::<D, 1, 3, Line3>(),
        FacetKind::Tri3 => tabulate_facet::<D, 2, 3, Tri3>(),
        FacetKind::Tri6 => tabulate_facet::<D, 2, 6, Tri6>(),
        FacetKind::Quad4 => tabulate_facet::<D, 2, 4, Quad4>(),
        FacetKind::Quad8 => tabulate_facet::<D, 2, 8, Quad8>(),
        FacetKind::Quad9 => tabulate_facet::<D, 2, 9, Quad9>(),
    }
}

/// Where a kind of cell is sampled.
pub(crate) struct CellSamples<const D: usize> {
    /// A rule exact for N_a 2πr on straight-sided cells.
    pub(crate) rule: Vec<Sample<D>>,
    /// The nodes, with weight 0.
    pub(crate) nodes: Vec<Sample<D>>,
}

fn tabulate_cell<const D: usize, const N: usize, const M: usize, E: Element<M, N>>(
    rule: Rule<M>,
) -> CellSamples<D> {
    CellSamples {
        rule: tabulate::<D, M, N, E>(rule.points),
        nodes: tabulate::<D, M, N, E>(E::NODES.map(|xi| Point { xi, weight: 0.0 })),
    }
}

/// The samples of a kind of cell of dimension D.
pub(crate) fn cell_samples<const D: usize>(kind: CellKind) -> CellSamples<D> {
    let full = Integration::Full;
    match kind {
        // One point, enough for a constant strain, would miss the product of N_a and r.
        CellKind::Tri3 => tabulate_cell::<D, 3, 2, Tri3>(Rule::triangle(2)),
        CellKind::Tri6 => tabulate_cell::<D, 6, 2, Tri6>(Tri6::rule(full)),
        CellKind::Quad4 => tabulate_cell::<D, 4, 2, Quad4>(Quad4::rule(full)),
        CellKind::Quad8 => tabulate_cell::<D, 8, 2, Quad8>(Quad8::rule(full)),
        CellKind::Quad9 => tabulate_cell::<D, 9, 2, Quad9>(Quad9::rule(full)),
        CellKind::Tet4 => tabulate_cell::<D, 4, 3, Tet4>(Tet4::rule(full)),
        CellKind::Tet10 => tabulate_cell::<D, 10, 3, Tet10>(Tet10::rule(full)),
        CellKind::Hex8 => tabulate_cell::<D, 8, 3, Hex8>(Hex8::rule(full)),
        CellKind::Hex20 => tabulate_cell::<D, 20, 3, Hex20>(Hex20::rule(full)),
        CellKind::Hex27 => tabulate_cell::<D, 27, 3, Hex27>(Hex27::rule(full)),
    }
}

/// The sample of a kind of cell of dimension D at one point of the reference cell, with weight 0.
pub(crate) fn cell_sample<const D: usize>(kind: CellKind, xi: &[f64; D]) -> Sample<D> {
    fn at<const D: usize, const N: usize, const M: usize, E: Element<M, N>>(
        xi: &[f64; D],
    ) -> Sample<D> {
        let xi = std::array::from_fn(|i| xi[i]);
        sample::<D, M, N, E>(Point { xi, weight: 0.0 })
    }
    match kind {
        CellKind::Tri3 => at::<D, 3, 2, Tri3>(xi),
        CellKind::Tri6 => at::<D, 6, 2, Tri6>(xi),
        CellKind::Quad4 => at::<D, 4, 2, Quad4>(xi),
        CellKind::Quad8 => at::<D, 8, 2, Quad8>(xi),
        CellKind::Quad9 => at::<D, 9, 2, Quad9>(xi),
        CellKind::Tet4 => at::<D, 4, 3, Tet4>(xi),
        CellKind::Tet10 => at::<D, 10, 3, Tet10>(xi),
        CellKind::Hex8 => at::<D, 8, 3, Hex8>(xi),
        CellKind::Hex20 => at::<D, 20, 3, Hex20>(xi),
        CellKind::Hex27 => at::<D, 27, 3, Hex27>(xi),
    }
}

impl CellKind {
    /// Shape functions of the nodes at the points of the rule that has so many, point by point in the
    /// order of [`Element::rule`]; `None` if neither rule does. The number tells the rule: where both
    /// have as many points, they are the same.
    pub fn shapes_at_points(self, count: usize) -> Option<Vec<Vec<f64>>> {
        fn shapes<const D: usize, const N: usize, E: Element<D, N>>(
            count: usize,
        ) -> Option<Vec<Vec<f64>>> {
            let mut rules = [Integration::Reduced, Integration::Full]
                .map(E::rule)
                .into_iter();
            let rule = rules.find(|r| r.points.len() == count)?;
            let shape = |p: &Point<D>| E::shape(p.xi).to_vec();
            Some(rule.points.iter().map(shape).collect())
        }
        match self {
            Self::Tri3 => shapes::<2, 3, Tri3>(count),
            Self::Tri6 => shapes::<2, 6, Tri6>(count),
            Self::Quad4 => shapes::<2, 4, Quad4>(count),
            Self::Quad8 => shapes::<2, 8, Quad8>(count),
            Self::Quad9 => shapes::<2, 9, Quad9>(count),
            Self::Tet4 => shapes::<3, 4, Tet4>(count),
            Self::Tet10 => shapes::<3, 10, Tet10>(count),
            Self::Hex8 => shapes::<3, 8, Hex8>(count),
            Self::Hex20 => shapes::<3, 20, Hex20>(count),
            Self::Hex27 => shapes::<3, 27, Hex27>(count),
        }
    }
}

impl FacetKind {
    /// Reference coordinates of the nodes, corners first; an edge has the first coordinate alone.
    pub fn places(self) -> Vec<[f64; 2]> {
        let along = |nodes: &[[f64; 1]]| nodes.iter().map(|&[xi]| [xi, 0.0]).collect();
        match self {
            Self::Line2 => along(&Line2::NODES),
            Self::Line3 => along(&Line3::NODES),
            Self::Tri3 => Tri3::NODES.to_vec(),
            Self::Tri6 => Tri6::NODES.to_vec(),
            Self::Quad4 => Quad4::NODES.to_vec(),
            Self::Quad8 => Quad8::NODES.to_vec(),
            Self::Quad9 => Quad9::NODES.to_vec(),
        }
    }

    /// Shape functions N_a(ξ) \[–\]; those of nodes that a facet of this kind does not have are zero.
    pub fn shape(self, xi: [f64; 2]) -> [f64; 9] {
        fn filled<const N: usize>(values: [f64; N]) -> [f64; 9] {
            std::array::from_fn(|a| values.get(a).copied().unwrap_or(0.0))
        }
        match self {
            Self::Line2 => filled(Line2::shape([xi[0]])),
            Self::Line3 => filled(Line3::shape([xi[0]])),
            Self::Tri3 => filled(Tri3::shape(xi)),
            Self::Tri6 => filled(Tri6::shape(xi)),
            Self::Quad4 => filled(Quad4::shape(xi)),
            Self::Quad8 => filled(Quad8::shape(xi)),
            Self::Quad9 => filled(Quad9::shape(xi)),
        }
    }
}
