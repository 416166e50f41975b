//! Stresses at nodes from those at quadrature points, by superconvergent patches; an estimate that
//! is smoother and closer than what it is made of, not a stress in equilibrium.
//!
//! O. C. Zienkiewicz and J. Z. Zhu, *The superconvergent patch recovery and a posteriori error
//! estimates*, Int. J. Numer. Methods Eng. 33 (1992): about every corner a polynomial is fitted to
//! the values of the cells around it. A patch never crosses from one material to another, nor from
//! body to body; at a boundary the polynomials of the corners inside are continued.

use crate::assembly::block::{PointField, PointState};
use moreau_mandel::{Sym2, deviator, von_mises};
use moreau_mesh::Mesh;
use nalgebra::{DMatrix, DVector, SVector};
use std::collections::{BTreeMap, BTreeSet};

/// Least squared pivot of the moments of a patch, in the size of the patch: below it what lies
/// between the samples says nothing about some term.
const POSED: f64 = 1e-3;

/// Six components of stress, the equivalent plastic strain, and the components of the fields that laws
/// have of their own.
type Values = DVector<f64>;

/// Values that every law has.
const COMMON: usize = 7;

/// Recovered fields at the nodes of each material: a node where materials meet has a point for each
/// of them, as stresses jump there.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// The node of every point: first all nodes in their order, with the first of their materials,
    /// then the others.
    pub nodes: Vec<usize>,
    /// Points of every cell, in the order of its nodes.
    pub cells: Vec<Vec<usize>>,
    /// Stress \[MPa\] of every point.
    pub stress: Vec<Sym2>,
    /// Equivalent plastic strain of every point.
    pub plastic_strain: Vec<f64>,
    /// The fields that laws have of their own; NaN at the points of a law that has no such field.
    pub fields: Vec<PointField>,
}

/// Recovers stresses, plastic strains and the fields of [`Driver::fields`](crate::driver::Driver::fields)
/// from quadrature points, with the material of every cell.
///
/// A stress that is linear in each material is met exactly; a smooth one at a higher order than by
/// the points. Where a patch flows plastically no recovered von Mises stress exceeds the largest of
/// its points: the deviator is scaled back to it. Plastic strains and other scalars stay between the
/// least and the largest of their patch. A point none of whose cells has samples is NaN.
pub fn recover<const D: usize>(
    mesh: &Mesh<D>,
    materials: &[usize],
    points: &[PointState<D>],
    fields: &[PointField],
) -> Recovered {
    let samples = samples(mesh, points, fields);
    let scalars = scalars(fields);
    let rows = COMMON + fields.iter().map(|f| f.components).sum::<usize>();
    let (nodes, cells) = points_by_material(mesh, materials);
    let mut around = vec![Vec::new(); nodes.len()];
    for (cell, own) in cells.iter().enumerate() {
        own.iter().for_each(|&p| around[p].push(cell));
    }
    let mut corners = BTreeSet::new();
    for (cell, own) in cells.iter().enumerate() {
        corners.extend(&own[..mesh.kind(cell).corner_count()]);
    }
    let at = |p: usize| SVector::<f64, D>::from(mesh.nodes()[nodes[p]]);
    let patch =
        |p: usize| -> Vec<&Sample<D>> { around[p].iter().flat_map(|&c| &samples[c]).collect() };
    let degree = |p: usize| {
        let quadratic = |&c: &usize| mesh.kind(c).nodes() > mesh.kind(c).corner_count();
        1 + usize::from(around[p].iter().all(quadratic))
    };
    let fits: BTreeMap<usize, Fit<D>> = corners
        .iter()
        .filter_map(|&p| Some((p, Fit::new(at(p), &patch(p), degree(p))?)))
        .collect();
    // Corners without a polynomial of their own, at boundaries: those of the corners around.
    let mut borrowed = BTreeMap::new();
    for &p in corners.iter().filter(|p| !fits.contains_key(p)) {
        let near = around[p].iter().flat_map(|&c| &cells[c]);
        let near: BTreeSet<usize> = near.copied().filter(|q| fits.contains_key(q)).collect();
        borrowed.insert(p, near);
    }
    let value_of = |corner: usize, x: SVector<f64, D>| -> Values {
        if let Some(fit) = fits.get(&corner) {
            return fit.at(&x);
        }
        let near = &borrowed[&corner];
        if !near.is_empty() {
            return mean(rows, near.iter().map(|q| fits[q].at(&x)));
        }
        let own = patch(corner);
        match Fit::new(at(corner), &own, 1) {
            Some(fit) => fit.at(&x),
            None => mean(rows, own.iter().map(|s| s.value.clone())),
        }
    };
    let value = |p: usize| {
        let x = at(p);
        let value = match corners.contains(&p) {
            true => value_of(p, x),
            false => mean(
                rows,
                ends(mesh, &cells, &around[p], p)
                    .into_iter()
                    .map(|q| value_of(q, x)),
            ),
        };
        limited(value, &patch(p), &scalars)
    };
    let values: Vec<Values> = (0..nodes.len()).map(value).collect();
    Recovered {
        stress: values.iter().map(|v| v.fixed_rows::<6>(0).into()).collect(),
        plastic_strain: values.iter().map(|v| v[6]).collect(),
        fields: own_fields(fields, &values),
        nodes,
        cells,
    }
}

/// Rows of the values that are scalars.
fn scalars(fields: &[PointField]) -> Vec<usize> {
    let mut rows = vec![COMMON - 1];
    let mut row = COMMON;
    for field in fields {
        if field.components == 1 {
            rows.push(row);
        }
        row += field.components;
    }
    rows
}

/// The rows of the values that are fields of laws.
fn own_fields(fields: &[PointField], values: &[Values]) -> Vec<PointField> {
    let mut row = COMMON;
    let field = |field: &PointField| {
        let rows = row..row + field.components;
        row = rows.end;
        PointField {
            values: values
                .iter()
                .flat_map(|v| v.as_slice()[rows.clone()].to_vec())
                .collect(),
            ..field.clone()
        }
    };
    fields.iter().map(field).collect()
}

/// Where values are known well.
#[derive(Debug, Clone)]
struct Sample<const D: usize> {
    position: SVector<f64, D>,
    value: Values,
    /// Largest von Mises stress of its points, if one of them has flowed.
    bound: Option<f64>,
}

/// Samples of every cell: the points of quadratic cells, and the middle of linear ones, within
/// which only the mean is of a higher order.
fn samples<const D: usize>(
    mesh: &Mesh<D>,
    points: &[PointState<D>],
    fields: &[PointField],
) -> Vec<Vec<Sample<D>>> {
    let mut samples: Vec<Vec<Sample<D>>> = vec![Vec::new(); mesh.cell_count()];
    for (k, point) in points.iter().enumerate() {
        let common = point.stress.iter().chain([&point.plastic_strain]);
        let of_law = |f: &PointField| f.values[k * f.components..(k + 1) * f.components].to_vec();
        let own = fields.iter().flat_map(of_law);
        let value = Values::from_vec(common.copied().chain(own).collect());
        samples[point.cell].push(Sample {
            position: SVector::from(point.position),
            value,
            bound: (point.plastic_strain > 0.0).then(|| von_mises(&point.stress)),
        });
    }
    for (cell, own) in samples.iter_mut().enumerate() {
        if mesh.kind(cell).nodes() == mesh.kind(cell).corner_count() && own.len() > 1 {
            let count = own.len() as f64;
            *own = vec![Sample {
                position: own.iter().map(|s| s.position).sum::<SVector<f64, D>>() / count,
                value: mean(own[0].value.len(), own.iter().map(|s| s.value.clone())),
                bound: own.iter().filter_map(|s| s.bound).reduce(f64::max),
            }];
        }
    }
    samples
}

fn mean(rows: usize, values: impl Iterator<Item = Values>) -> Values {
    let start = (Values::zeros(rows), 0.0);
    let (sum, count) = values.fold(start, |(s, n), v| (s + v, n + 1.0));
    sum / count
}

/// The nodes of points, one for every node and every material of its cells; and the points of every
/// cell.
pub fn points_by_material<const D: usize>(
    mesh: &Mesh<D>,
    materials: &[usize],
) -> (Vec<usize>, Vec<Vec<usize>>) {
    let mut of_node = vec![BTreeMap::new(); mesh.nodes().len()];
    for (cell, &material) in materials.iter().enumerate() {
        for &node in mesh.cell_nodes(cell) {
            of_node[node].insert(material, node);
        }
    }
    let mut nodes: Vec<usize> = (0..of_node.len()).collect();
    for (node, own) in of_node.iter_mut().enumerate() {
        for point in own.values_mut().skip(1) {
            *point = nodes.len();
            nodes.push(node);
        }
    }
    let points = |(cell, material): (usize, &usize)| {
        let own = mesh.cell_nodes(cell).iter();
        own.map(|&node| of_node[node][material]).collect()
    };
    (nodes, materials.iter().enumerate().map(points).collect())
}

/// The corners between which a point lies that is none: of its edge, its face or its cell.
fn ends<const D: usize>(
    mesh: &Mesh<D>,
    cells: &[Vec<usize>],
    around: &[usize],
    point: usize,
) -> BTreeSet<usize> {
    let mut ends = BTreeSet::new();
    for &cell in around {
        let (own, kind) = (&cells[cell], mesh.kind(cell));
        let corner = |k: &usize| *k < kind.corner_count();
        let mut between: BTreeSet<usize> = (0..kind.corner_count()).collect();
        for facet in kind.facets() {
            if facet.iter().any(|&k| own[k] == point) {
                between.retain(|k| facet.contains(k));
            }
        }
        ends.extend(between.into_iter().filter(corner).map(|k| own[k]));
    }
    ends
}

/// A value within what the samples of a patch allow.
fn limited<const D: usize>(mut value: Values, patch: &[&Sample<D>], scalars: &[usize]) -> Values {
    for &row in scalars {
        let own = patch.iter().map(|s| s.value[row]);
        let (low, high) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
            (l.min(p), h.max(p))
        });
        if !value[row].is_nan() {
            value[row] = value[row].max(low).min(high);
        }
    }
    if let Some(bound) = patch.iter().filter_map(|s| s.bound).reduce(f64::max) {
        let stress: Sym2 = value.fixed_rows::<6>(0).into();
        let found = von_mises(&stress);
        if found > bound {
            let s = deviator(&stress);
            let back = stress - s * (1.0 - bound / found);
            value.fixed_rows_mut::<6>(0).copy_from(&back);
        }
    }
    value
}

/// A polynomial about a point, in the size of its patch.
struct Fit<const D: usize> {
    origin: SVector<f64, D>,
    size: f64,
    degree: usize,
    /// Of every term, all values.
    coefficients: DMatrix<f64>,
}

impl<const D: usize> Fit<D> {
    /// The least-squares fit of a degree; `None` if the samples do not determine it.
    fn new(origin: SVector<f64, D>, patch: &[&Sample<D>], degree: usize) -> Option<Self> {
        let distance = |s: &&Sample<D>| (s.position - origin).norm();
        let size = patch.iter().map(distance).fold(0.0, f64::max);
        let terms = terms(&SVector::<f64, D>::zeros(), degree).len();
        if patch.len() < terms || size <= 0.0 {
            return None;
        }
        let values = patch[0].value.len();
        let mut moments = DMatrix::zeros(terms, terms);
        let mut right = DMatrix::zeros(terms, values);
        let share = 1.0 / patch.len() as f64;
        for sample in patch {
            let row = self::terms(&((sample.position - origin) / size), degree);
            moments.ger(share, &row, &row, 1.0);
            right.ger(share, &row, &sample.value, 1.0);
        }
        let factor = moments.cholesky()?;
        let least = factor.l_dirty().diagonal().min();
        (least * least > POSED).then(|| Self {
            origin,
            size,
            degree,
            coefficients: factor.solve(&right),
        })
    }

    fn at(&self, x: &SVector<f64, D>) -> Values {
        let row = terms(&((x - self.origin) / self.size), self.degree);
        self.coefficients.tr_mul(&row)
    }
}

/// All monomials up to a degree of 1 or 2.
fn terms<const D: usize>(x: &SVector<f64, D>, degree: usize) -> DVector<f64> {
    let mut terms = vec![1.0];
    terms.extend(x);
    if degree == 2 {
        for i in 0..D {
            terms.extend((i..D).map(|j| x[i] * x[j]));
        }
    }
    DVector::from_vec(terms)
}
