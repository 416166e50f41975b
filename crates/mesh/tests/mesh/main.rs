//! Contracts and properties of elements, quadrature, hypotheses, meshes, blocks and readers; no
//! mechanics.

mod abaqus;
mod blocks;
mod damaged;
mod elements;
mod gmsh;
mod gmsh_by_hand;
mod groups;
mod hypotheses;
mod inside;
mod integrals;
mod losses;
mod pairing;
mod pairing_space;
mod pressures;
mod quadrature;
mod validity;
mod write;

use moreau_mesh::{CellKind, Facet, Mesh};

/// Rounding, relative to numbers of the order of 1.
const ROUND_OFF: f64 = 1e-13;

/// Reference nodes of a kind, as coordinates of R^D.
fn reference_cell<const D: usize>(kind: CellKind) -> Vec<[f64; D]> {
    kind.reference_nodes()
        .map(|x| std::array::from_fn(|i| x[i]))
        .collect()
}

/// A mesh of one cell, on its reference nodes moved by at most 0.1 in each direction.
fn distorted_cell<const D: usize>(kind: CellKind) -> Mesh<D> {
    let mut nodes = reference_cell::<D>(kind);
    for (a, x) in nodes.iter_mut().enumerate() {
        for (i, v) in x.iter_mut().enumerate() {
            *v += 0.1 * (2.3 * (a * D + i) as f64 + 0.4).sin();
        }
    }
    let all = (0..nodes.len()).collect();
    Mesh::new(nodes, vec![(kind, all)]).expect("a mildly distorted cell is valid")
}

/// The kinds of cells of dimension D.
fn kinds(dimension: usize) -> impl Iterator<Item = CellKind> {
    CellKind::ALL
        .into_iter()
        .filter(move |kind| kind.dimension() == dimension)
}

/// Σ w f(a) over weighted nodes.
fn sum(weights: &[(usize, f64)], f: impl Fn(usize) -> f64) -> f64 {
    weights.iter().map(|&(a, w)| w * f(a)).sum()
}

/// The facets of two groups.
fn facets<const D: usize>(mesh: &Mesh<D>, names: [&str; 2]) -> Vec<Facet> {
    let groups = names.map(|name| mesh.facet_group(name).expect("named"));
    groups.concat()
}
