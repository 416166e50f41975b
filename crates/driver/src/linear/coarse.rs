//! The coarse space of a system whose own factor would be too large, by its mesh: linear cells with the
//! same corners, far from the interface; not its matrix, nor the iteration that uses it.

use crate::assembly::numbering::Numbering;
use crate::assembly::scatter::FIXED;
use crate::vector::directions::Directions;
use moreau_algebra::{CoarseSpace, Pattern};
use moreau_mesh::Mesh;

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
    /// With the same interface last.
    pub(crate) space: CoarseSpace,
    /// Degree of freedom of an unknown.
    pub(crate) dofs: Vec<usize>,
}

impl Coarse {
    /// Of the free degrees of freedom `dofs` of a mesh, whose stiffness has a pattern; `None` if no node is
    /// between others.
    pub(crate) fn new<const D: usize>(
        mesh: &Mesh<D>,
        (fixed, directions): (impl Fn(usize) -> bool, &Directions),
        (interface, pivot, tools): (&[usize], Option<usize>, usize),
        (dofs, pattern): (&[usize], &Pattern),
    ) -> Option<Self> {
        let kept = kept(mesh, interface.iter().chain(&pivot).copied(), tools);
        if kept.iter().all(|&kept| kept) {
            return None;
        }
        let fixed = |dof: usize| fixed(dof) || !kept[dof / D];
        let (coarse, _) = Numbering::new(mesh, fixed, interface, pivot, tools, &[]);
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
        let row = |&dof: &usize| {
            let (node, axis) = (dof / D, dof % D);
            let own = [(node, 1.0)];
            let of: &[(usize, f64)] = if kept[node] { &own } else { &followed[node] };
            // What a component of a node beside makes of this one.
            let along =
                |other: usize| match directions.is_turned(dof) || directions.is_turned(other) {
                    _ if other == dof => 1.0,
                    _ if kept[node] => 0.0,
                    false => f64::from(u8::from(other % D == axis)),
                    true => directions.along::<D>(dof).dot(&directions.along(other)),
                };
            let all =
                |&(a, part): &(usize, f64)| (D * a..D * a + D).map(move |other| (other, part));
            let unknowns = of.iter().flat_map(all);
            let unknowns =
                unknowns.map(|(other, part)| (coarse.position[other], part * along(other)));
            let unknowns = unknowns.filter(|&(unknown, part)| unknown != FIXED && part != 0.0);
            unknowns.collect::<Vec<(u32, f64)>>()
        };
        // Positions are those of its own unknowns, and the interface is among them.
        let space = CoarseSpace::new(pattern, coarse.dofs.len(), dofs.iter().map(row)).ok()?;
        Some(Self {
            space,
            dofs: coarse.dofs,
        })
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
