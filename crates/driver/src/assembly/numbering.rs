//! Which displacement is which unknown, and which unknowns share a cell; no values.

use crate::assembly::scatter::FIXED;
use moreau_algebra::Pattern;
use moreau_algebra::nested_dissection;
use moreau_mesh::Mesh;

/// The unknowns of a mesh, in the order of their elimination.
pub(crate) struct Numbering {
    /// Position of a degree of freedom among the unknowns, or [`FIXED`].
    pub(crate) position: Vec<u32>,
    /// Degree of freedom at a position.
    pub(crate) dofs: Vec<usize>,
    /// Number of interface unknowns: the last.
    pub(crate) interface: usize,
    /// Which unknowns share a cell.
    pub(crate) pattern: Pattern,
}

impl Numbering {
    /// By nested dissection of the nodes, and with those of the interface, the pivot and the tools
    /// last; the tools are nodes after those of the mesh. Nodes are neighbours where they share a cell, or
    /// are in one of the `coupled` lists.
    pub(crate) fn new<const D: usize>(
        mesh: &Mesh<D>,
        fixed: impl Fn(usize) -> bool,
        interface_nodes: &[usize],
        pivot: Option<usize>,
        tools: usize,
        coupled: &[Vec<usize>],
    ) -> Self {
        let nodes = mesh.nodes().len() + tools;
        let adjacency = adjacency(mesh, nodes, coupled);
        let neighbours = |a: usize| &adjacency.entries[adjacency.start[a]..adjacency.start[a + 1]];
        let mut is_interface = vec![false; nodes];
        for &a in interface_nodes.iter().chain(&pivot) {
            is_interface[a] = true;
        }
        is_interface[mesh.nodes().len()..].fill(true);
        let free = |a: usize| (D * a..D * a + D).any(|dof| !fixed(dof));
        let interior = (0..nodes).filter(|&a| !is_interface[a] && free(a));
        let interior: Vec<usize> = interior.collect();
        let of_the_mesh = |a: usize| {
            let all = neighbours(a);
            &all[..all.partition_point(|&b| b < mesh.nodes().len())]
        };
        let mut order = nested_dissection(&interior, mesh.nodes(), of_the_mesh);
        order.extend((0..nodes).filter(|&a| is_interface[a]));
        let mut position = vec![FIXED; D * nodes];
        let mut dofs = Vec::new();
        let mut interface = 0;
        for &a in &order {
            for dof in D * a..D * a + D {
                if !fixed(dof) {
                    position[dof] = dofs.len() as u32;
                    dofs.push(dof);
                    interface += usize::from(is_interface[a]);
                }
            }
        }
        let mut column_start = Vec::with_capacity(dofs.len() + 1);
        column_start.push(0u32);
        let mut row: Vec<u32> = Vec::new();
        let mut column = Vec::new();
        for (p, &dof) in dofs.iter().enumerate() {
            column.clear();
            let own = dof / D;
            for &b in neighbours(own).iter().chain(std::iter::once(&own)) {
                let rows = position[D * b..D * b + D].iter();
                column.extend(rows.copied().filter(|&q| q != FIXED && q as usize >= p));
            }
            column.sort_unstable();
            row.extend_from_slice(&column);
            column_start.push(row.len() as u32);
        }
        Self {
            position,
            dofs,
            interface,
            // Every column begins with its own row, and goes on with others in order.
            pattern: Pattern::new(column_start, row)
                .and_then(|pattern| pattern.keeping(interface))
                .expect("sorted, without repetition"),
        }
    }
}

struct Adjacency {
    start: Vec<usize>,
    entries: Vec<usize>,
}

/// Nodes that share a cell or a coupling with each node, without the node itself, sorted.
fn adjacency<const D: usize>(mesh: &Mesh<D>, nodes: usize, coupled: &[Vec<usize>]) -> Adjacency {
    // Cells of node a: of[first[a]..first[a + 1]], written from the back.
    let mut first = vec![0u32; nodes + 1];
    let group = |c: usize| match c.checked_sub(mesh.cell_count()) {
        None => mesh.cell_nodes(c),
        Some(k) => &coupled[k],
    };
    let all = || {
        (0..mesh.cell_count() + coupled.len()).flat_map(|c| group(c).iter().map(move |&a| (c, a)))
    };
    all().for_each(|(_, a)| first[a] += 1);
    let mut sum = 0;
    for first in &mut first {
        sum += *first;
        *first = sum;
    }
    let mut of = vec![0u32; sum as usize];
    for (cell, a) in all() {
        first[a] -= 1;
        of[first[a] as usize] = cell as u32;
    }
    let mut start = Vec::with_capacity(nodes + 1);
    start.push(0);
    let mut entries = Vec::new();
    let mut row = Vec::new();
    for a in 0..nodes {
        row.clear();
        for &cell in &of[first[a] as usize..first[a + 1] as usize] {
            let cell = group(cell as usize).iter();
            row.extend(cell.copied().filter(|&b| b != a));
        }
        row.sort_unstable();
        row.dedup();
        entries.extend_from_slice(&row);
        start.push(entries.len());
    }
    Adjacency { start, entries }
}
