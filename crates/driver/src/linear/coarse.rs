//! The coarse space of a system whose own factor would be too large: linear cells with the same
//! corners, far from the interface; not the iteration that uses it.

use crate::assembly::block::{Block, CellResult};
use crate::assembly::numbering::Numbering;
use crate::assembly::scatter::FIXED;
use moreau_algebra::Matrix;
use moreau_mesh::Mesh;
use std::collections::BTreeMap;

/// Layers of cells at the interface that keep all of their nodes.
///
/// The contact problem is condensed from the coarse space. Its stiffness S_c is never below S, and the
/// nearer the more of the cells at the interface are as they are: on a punch in space S is at least
/// 0.1 S_c without a layer, 0.67 S_c with one and 0.86 S_c with two, in plastic flow.
const LAYERS: usize = 2;

/// The displacements v = P w of a mesh in which the nodes between corners follow the corners, as in
/// linear cells; those near the interface stay as they are. The stiffness there is Pᵀ K P.
#[derive(Debug)]
pub(crate) struct Coarse {
    /// Pᵀ K P, with the same interface last.
    pub(crate) matrix: Matrix,
    /// Degree of freedom of an unknown.
    pub(crate) dofs: Vec<usize>,
    /// Rows of P: unknowns of `parts[start[k]..start[k + 1]]` and how far unknown k follows them.
    start: Vec<u32>,
    parts: Vec<(u32, f64)>,
    /// Of every block.
    restrictions: Vec<Restriction>,
}

impl Coarse {
    /// Of the free degrees of freedom `dofs` of a mesh; `None` if no node is between others.
    pub(crate) fn new<const D: usize>(
        mesh: &Mesh<D>,
        blocks: &[Box<dyn Block<D>>],
        fixed: impl Fn(usize) -> bool,
        (interface, pivot, tools): (&[usize], Option<usize>, usize),
        dofs: &[usize],
    ) -> Option<Self> {
        let kept = kept(mesh, interface.iter().chain(&pivot).copied(), tools);
        if kept.iter().all(|&kept| kept) {
            return None;
        }
        let fixed = |dof: usize| fixed(dof) || !kept[dof / D];
        let coarse = Numbering::new(mesh, fixed, interface, pivot, tools, &[]);
        let mut followed = vec![Vec::new(); kept.len()];
        for cell in 0..mesh.cell_count() {
            let nodes = mesh.cell_nodes(cell);
            for (k, &a) in nodes.iter().enumerate() {
                if !kept[a] && followed[a].is_empty() {
                    let shape = mesh.kind(cell).corner_shape(k).into_iter();
                    let pairs = nodes.iter().copied().zip(shape);
                    followed[a] = pairs.filter(|&(_, part)| part != 0.0).collect();
                }
            }
        }
        let (mut start, mut parts) = (vec![0], Vec::new());
        for &dof in dofs {
            let (node, axis) = (dof / D, dof % D);
            let own = [(node, 1.0)];
            let of: &[(usize, f64)] = if kept[node] { &own } else { &followed[node] };
            let unknowns = of
                .iter()
                .map(|&(a, part)| (coarse.position[D * a + axis], part));
            parts.extend(unknowns.filter(|&(unknown, _)| unknown != FIXED));
            start.push(parts.len() as u32);
        }
        Some(Self {
            restrictions: blocks
                .iter()
                .map(|b| Restriction::new(b.as_ref(), mesh, &kept, &coarse))
                .collect(),
            start,
            parts,
            dofs: coarse.dofs,
            matrix: Matrix::new(coarse.pattern),
        })
    }

    fn parts(&self, unknown: usize) -> &[(u32, f64)] {
        &self.parts[self.start[unknown] as usize..self.start[unknown + 1] as usize]
    }

    /// Pᵀ f.
    pub(crate) fn restrict(&self, f: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.dofs.len()];
        for (k, f) in f.iter().enumerate() {
            for &(unknown, part) in self.parts(k) {
                out[unknown as usize] += part * f;
            }
        }
        out
    }

    /// v ← v + P w.
    pub(crate) fn prolong(&self, w: &[f64], v: &mut [f64]) {
        for (k, v) in v.iter_mut().enumerate() {
            let parts = self.parts(k).iter();
            *v += parts.map(|&(c, part)| part * w[c as usize]).sum::<f64>();
        }
    }

    /// Adds the stiffness of a cell.
    pub(crate) fn add(&mut self, block: usize, cell: &CellResult<'_>) {
        let (_, to) = self.matrix.values_mut();
        self.restrictions[block].add(cell, to);
    }
}

/// Which nodes of a mesh and its tools have unknowns of their own: corners, and all near the interface.
fn kept<const D: usize>(
    mesh: &Mesh<D>,
    interface: impl Iterator<Item = usize>,
    tools: usize,
) -> Vec<bool> {
    let cells = || (0..mesh.cell_count()).map(|c| (c, mesh.cell_nodes(c)));
    let mut near = vec![false; mesh.nodes().len() + tools];
    interface.for_each(|a| near[a] = true);
    for _ in 0..LAYERS {
        let touching = cells().filter(|(_, nodes)| nodes.iter().any(|&a| near[a]));
        let touching: Vec<&[usize]> = touching.map(|(_, nodes)| nodes).collect();
        touching.concat().into_iter().for_each(|a| near[a] = true);
    }
    // Tools, and nodes of no cell, are between no others.
    let mut kept = vec![true; near.len()];
    for (c, nodes) in cells() {
        let between = &nodes[mesh.kind(c).corner_count()..];
        between.iter().for_each(|&a| kept[a] = near[a]);
    }
    for (c, nodes) in cells() {
        let corners = &nodes[..mesh.kind(c).corner_count()];
        corners.iter().for_each(|&a| kept[a] = true);
    }
    kept
}

/// The stiffness of the cells of a block on the nodes that they keep.
#[derive(Debug)]
struct Restriction {
    /// Components of a node.
    components: usize,
    /// The ways in which the cells keep their nodes.
    ways: Vec<Way>,
    /// That of every cell.
    way: Vec<u32>,
    /// Where the slots of every cell begin.
    start: Vec<usize>,
    /// Slots of the upper triangles among the values of the coarse matrix; [`FIXED`] of what no
    /// unknown sees.
    slots: Vec<u32>,
    /// Rᵀ U R of the cell at hand, and a row of U R.
    product: Vec<f64>,
    row: Vec<f64>,
}

/// Which nodes of a cell are kept, and how the nodes of the cell follow them: the matrix R.
#[derive(Debug)]
struct Way {
    kept: usize,
    follows: Vec<Vec<(usize, f64)>>,
}

impl Restriction {
    fn new<const D: usize>(
        block: &dyn Block<D>,
        mesh: &Mesh<D>,
        kept: &[bool],
        coarse: &Numbering,
    ) -> Self {
        let mut all = Self {
            components: D,
            ways: Vec::new(),
            way: Vec::new(),
            start: Vec::new(),
            slots: Vec::new(),
            product: Vec::new(),
            row: Vec::new(),
        };
        let mut known = BTreeMap::new();
        for (k, &cell) in block.cells().iter().enumerate() {
            let nodes = block.nodes(k);
            let which: Vec<bool> = nodes.iter().map(|&a| kept[a]).collect();
            let own: Vec<usize> = (0..nodes.len()).filter(|&a| which[a]).collect();
            let way = *known.entry(which.clone()).or_insert_with(|| {
                let place = |a: usize| own.iter().position(|&b| a == b);
                let follows = |a: usize| match place(a) {
                    Some(own) => vec![(own, 1.0)],
                    None => {
                        let shape = mesh.kind(cell).corner_shape(a).into_iter().enumerate();
                        let shape = shape.filter(|&(_, part)| part != 0.0);
                        let pair = |(corner, part)| Some((place(corner)?, part));
                        shape.filter_map(pair).collect()
                    }
                };
                all.ways.push(Way {
                    kept: own.len(),
                    follows: (0..nodes.len()).map(follows).collect(),
                });
                all.ways.len() - 1
            });
            all.way.push(way as u32);
            all.start.push(all.slots.len());
            let unknowns: Vec<u32> = own
                .iter()
                .flat_map(|&a| (D * nodes[a]..D * nodes[a] + D).map(|dof| coarse.position[dof]))
                .collect();
            for (i, &p) in unknowns.iter().enumerate() {
                for &q in &unknowns[i..] {
                    let free = p != FIXED && q != FIXED;
                    let slot = free.then(|| coarse.pattern.slot(p.max(q), p.min(q)));
                    all.slots.push(slot.flatten().unwrap_or(FIXED));
                }
            }
        }
        all
    }

    /// Adds Rᵀ K R = M + Mᵀ with M = Rᵀ U R, where U is the upper triangle of K with half of the
    /// diagonal.
    fn add(&mut self, cell: &CellResult<'_>, to: &mut [f64]) {
        if cell.stiffness.is_empty() {
            return;
        }
        let d = self.components;
        let way = &self.ways[self.way[cell.cell] as usize];
        let (size, kept) = (d * way.follows.len(), d * way.kept);
        let (product, row) = (&mut self.product, &mut self.row);
        product.clear();
        product.resize(kept * kept, 0.0);
        row.resize(kept, 0.0);
        let mut entries = cell.stiffness.iter();
        for p in 0..size {
            row.fill(0.0);
            for q in p..size {
                let entry = entries.next().copied().unwrap_or(0.0);
                let u = if p == q { 0.5 * entry } else { entry };
                for &(b, part) in &way.follows[q / d] {
                    row[d * b + q % d] += part * u;
                }
            }
            for &(a, part) in &way.follows[p / d] {
                let to = &mut product[(d * a + p % d) * kept..][..kept];
                to.iter_mut().zip(&*row).for_each(|(m, u)| *m += part * u);
            }
        }
        let mut slots = self.slots[self.start[cell.cell]..].iter();
        for i in 0..kept {
            for j in i..kept {
                let Some(&slot) = slots.next() else { return };
                if slot != FIXED {
                    to[slot as usize] += product[i * kept + j] + product[j * kept + i];
                }
            }
        }
    }
}
