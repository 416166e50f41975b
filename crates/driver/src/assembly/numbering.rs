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
}

impl Numbering {
    /// By nested dissection of the nodes, and with those of the interface, the pivot and the tools
    /// last; the tools are nodes after those of the mesh. Nodes are neighbours where they share a cell, or
    /// are in one of the `coupled` lists; which they are is handed on.
    pub(crate) fn new<const D: usize>(
        mesh: &Mesh<D>,
        fixed: impl Fn(usize) -> bool,
        interface_nodes: &[usize],
        pivot: Option<usize>,
        tools: usize,
        coupled: &[Vec<usize>],
    ) -> (Self, Adjacency) {
        let nodes = mesh.nodes().len() + tools;
        let cells = (0..mesh.cell_count()).map(|c| mesh.cell_nodes(c));
        let coupled = coupled.iter().map(Vec::as_slice);
        let adjacency = Adjacency::new(&cells.chain(coupled).collect::<Vec<_>>(), nodes);
        let neighbours = |a: usize| adjacency.of(a);
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
        let numbering = Self {
            position,
            dofs,
            interface,
        };
        (numbering, adjacency)
    }

    /// The same, and which unknowns share a node or nodes that are neighbours.
    pub(crate) fn with_pattern<const D: usize>(
        mesh: &Mesh<D>,
        fixed: impl Fn(usize) -> bool,
        interface_nodes: &[usize],
        pivot: Option<usize>,
        tools: usize,
        coupled: &[Vec<usize>],
    ) -> (Self, Pattern) {
        let (new, adjacency) = Self::new(mesh, fixed, interface_nodes, pivot, tools, coupled);
        let pattern = adjacency.pattern::<D>(&new.position, &new.dofs, new.interface);
        (new, pattern)
    }
}

/// Which unknowns share a node or one of some groups of nodes: their degrees of freedom `dofs`, with the unknown of
/// every degree of freedom at `position`, and so many last ones kept.
pub(crate) fn pattern_of<const D: usize>(
    position: &[u32],
    dofs: &[usize],
    kept: usize,
    groups: &[&[usize]],
) -> Pattern {
    let nodes = position.len() / D;
    Adjacency::new(groups, nodes).pattern::<D>(position, dofs, kept)
}

/// Which nodes are neighbours.
pub(crate) struct Adjacency {
    start: Vec<usize>,
    entries: Vec<usize>,
}

impl Adjacency {
    /// Nodes that share a group with each node, without the node itself, sorted.
    fn new(groups: &[&[usize]], nodes: usize) -> Self {
        // Groups of node a: of[first[a]..first[a + 1]], written from the back.
        let mut first = vec![0u32; nodes + 1];
        let all = || {
            let numbered = groups.iter().enumerate();
            numbered.flat_map(|(k, group)| group.iter().map(move |&a| (k, a)))
        };
        all().for_each(|(_, a)| first[a] += 1);
        let mut sum = 0;
        for first in &mut first {
            sum += *first;
            *first = sum;
        }
        let mut of = vec![0u32; sum as usize];
        for (group, a) in all() {
            first[a] -= 1;
            of[first[a] as usize] = group as u32;
        }
        let mut start = Vec::with_capacity(nodes + 1);
        start.push(0);
        let mut entries = Vec::new();
        let mut row = Vec::new();
        for a in 0..nodes {
            row.clear();
            for &group in &of[first[a] as usize..first[a + 1] as usize] {
                let group = groups[group as usize].iter();
                row.extend(group.copied().filter(|&b| b != a));
            }
            row.sort_unstable();
            row.dedup();
            entries.extend_from_slice(&row);
            start.push(entries.len());
        }
        Self { start, entries }
    }

    fn of(&self, node: usize) -> &[usize] {
        &self.entries[self.start[node]..self.start[node + 1]]
    }

    /// Which unknowns are of the same node or of neighbours.
    fn pattern<const D: usize>(&self, position: &[u32], dofs: &[usize], kept: usize) -> Pattern {
        let mut column_start = Vec::with_capacity(dofs.len() + 1);
        column_start.push(0u32);
        let mut row: Vec<u32> = Vec::new();
        let mut column = Vec::new();
        for (p, &dof) in dofs.iter().enumerate() {
            column.clear();
            let own = dof / D;
            for &b in self.of(own).iter().chain(std::iter::once(&own)) {
                let rows = position[D * b..D * b + D].iter();
                column.extend(rows.copied().filter(|&q| q != FIXED && q as usize >= p));
            }
            column.sort_unstable();
            row.extend_from_slice(&column);
            column_start.push(row.len() as u32);
        }
        // Every column begins with its own row, and goes on with others in order.
        Pattern::new(column_start, row)
            .and_then(|pattern| pattern.keeping(kept))
            .expect("sorted, without repetition")
    }
}
