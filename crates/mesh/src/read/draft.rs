//! Nodes, cells and groups by the numbers of a file, made into a mesh; knows no file format.

use crate::geometry::diagonal;
use crate::mesh::facet_key as key;
use crate::read::{Loss, ReadError};
use crate::sample::cell_samples;
use crate::{CellKind, Facet, Mesh, MeshError};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// What a file says, by its own numbers.
#[derive(Debug, Default)]
pub(crate) struct Draft {
    /// Number and place \[mm\] of the nodes, in any order.
    pub(crate) nodes: Vec<(u64, [f64; 3])>,
    /// The cells of the mesh, all of its dimension.
    pub(crate) cells: Vec<Cell>,
    /// Positions in `cells`.
    pub(crate) cell_groups: BTreeMap<String, Vec<usize>>,
    pub(crate) facet_groups: BTreeMap<String, Vec<Side>>,
    /// Numbers of nodes.
    pub(crate) node_groups: BTreeMap<String, Vec<u64>>,
    /// What has been left out already.
    pub(crate) losses: Vec<Loss>,
}

/// A cell, its nodes by number and in the order of its kind, of either orientation.
#[derive(Debug)]
pub(crate) struct Cell {
    pub(crate) element: u64,
    pub(crate) kind: CellKind,
    pub(crate) nodes: Vec<u64>,
}

/// A member of a facet group.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    /// The side, of whatever cell, with the nodes of this element.
    Element { element: u64, nodes: Vec<u64> },
    /// A side of a cell, by its index before the cell is turned round.
    Of(Facet),
    /// All sides of a cell that belong to no other.
    Free { cell: usize },
}

/// Greatest distance from the plane z = constant, relative to the size of a plane mesh.
const PLANAR: f64 = 1e-9;

/// Nodes sorted by number.
struct Numbering(Vec<(u64, [f64; 3])>);

impl Numbering {
    fn new(mut nodes: Vec<(u64, [f64; 3])>) -> Result<Self, ReadError> {
        nodes.sort_unstable_by_key(|&(number, _)| number);
        match nodes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(ReadError::DuplicateNode { node: pair[0].0 }),
            None => Ok(Self(nodes)),
        }
    }

    /// Position of a number, found at once where the numbers have no gap.
    fn position(&self, number: u64) -> Option<usize> {
        let first = self.0.first()?.0;
        let guess = usize::try_from(number.checked_sub(first)?).ok()?;
        match self.0.get(guess) {
            Some(node) if node.0 == number => Some(guess),
            _ => self.0.binary_search_by_key(&number, |node| node.0).ok(),
        }
    }

    fn position_for(&self, element: u64, node: u64) -> Result<usize, ReadError> {
        self.position(node)
            .ok_or(ReadError::UnknownNode { element, node })
    }
}

/// Members of a group of the mesh.
enum Members {
    Cells(Vec<usize>),
    Facets(Vec<Facet>),
    Nodes(Vec<usize>),
}

impl Draft {
    /// The mesh: nodes by increasing number, those of no cell left out, cells in their order here
    /// and turned round where their orientation is negative.
    ///
    /// Groups left without member are left out and noted; a name that also serves cells (or facets) gets
    /// `.boundary` for facets and `.nodes` for nodes.
    pub(crate) fn finish<const D: usize>(self) -> Result<(Mesh<D>, Vec<Loss>), ReadError> {
        let mut losses = self.losses;
        let numbering = Numbering::new(self.nodes)?;
        let mut elements = Vec::with_capacity(self.cells.len());
        let mut cells = Vec::with_capacity(self.cells.len());
        // First by position in the numbering; then by place in the mesh.
        let mut places: Vec<Option<usize>> = vec![None; numbering.0.len()];
        for Cell {
            element,
            kind,
            nodes,
        } in self.cells
        {
            let nodes = nodes
                .into_iter()
                .map(|node| numbering.position_for(element, node))
                .collect::<Result<Vec<usize>, _>>()?;
            for &position in &nodes {
                places[position] = Some(0);
            }
            elements.push(element);
            cells.push((kind, nodes));
        }
        let mut kept = Vec::new();
        for (place, node) in places.iter_mut().zip(&numbering.0) {
            if let Some(place) = place {
                *place = kept.len();
                kept.push(*node);
            }
        }
        for node in cells.iter_mut().flat_map(|(_, nodes)| nodes) {
            *node = places[*node].unwrap_or(*node);
        }
        let positions = flat::<D>(&kept)?;
        let turned = turn(&mut cells, &positions);
        let mut mesh = Mesh::new(positions, cells).map_err(|source| ReadError::Mesh {
            element: culprit(&source).and_then(|cell| elements.get(cell).copied()),
            source,
        })?;

        let place = |number| numbering.position(number).and_then(|at| places[at]);
        let facets = facets(&mesh, self.facet_groups, &turned, |element, node| {
            let position = numbering.position_for(element, node)?;
            Ok(places[position])
        })?;
        let nodes = self.node_groups.into_iter().map(|(name, mut numbers)| {
            numbers.sort_unstable();
            numbers.dedup();
            let of = numbers.len();
            let nodes: Vec<usize> = numbers.into_iter().filter_map(place).collect();
            if !nodes.is_empty() && nodes.len() < of {
                let lost = of - nodes.len();
                let name = name.clone();
                losses.push(Loss::Nodes { name, lost, of });
            }
            (name, Members::Nodes(nodes))
        });
        // Those of nodes are noted before groups that are lost as a whole.
        let nodes: Vec<_> = nodes.collect();
        let cells = self
            .cell_groups
            .into_iter()
            .map(|(name, cells)| (name, Members::Cells(cells)));
        let facets = facets
            .into_iter()
            .map(|(name, facets)| (name, Members::Facets(facets)));
        let groups = cells.chain(facets).chain(nodes);
        add(&mut mesh, groups, &mut losses).map_err(|source| ReadError::Mesh {
            element: None,
            source,
        })?;
        Ok((mesh, losses))
    }
}

/// Coordinates of R^D; in the plane, z must be the same everywhere.
fn flat<const D: usize>(nodes: &[(u64, [f64; 3])]) -> Result<Vec<[f64; D]>, ReadError> {
    let positions: Vec<[f64; D]> = nodes
        .iter()
        .map(|(_, x)| std::array::from_fn(|i| x[i]))
        .collect();
    if D == 2
        && let Some(&(_, [.., plane])) = nodes.first()
    {
        let tolerance = PLANAR * diagonal(&positions);
        let off = |&&(_, [.., z]): &&(u64, [f64; 3])| (z - plane).abs() > tolerance;
        if let Some(&(node, [.., z])) = nodes.iter().find(off) {
            return Err(ReadError::NotPlanar { node, z, plane });
        }
    }
    Ok(positions)
}

/// Where the nodes of a cell turned round come from; a mirror image of the reference cell that
/// keeps node 0, and its own inverse.
const fn mirrored(kind: CellKind) -> &'static [usize] {
    match kind {
        CellKind::Tri3 => &[0, 2, 1],
        CellKind::Tri6 => &[0, 2, 1, 5, 4, 3],
        CellKind::Quad4 => &[0, 3, 2, 1],
        CellKind::Quad8 => &[0, 3, 2, 1, 7, 6, 5, 4],
        CellKind::Quad9 => &[0, 3, 2, 1, 7, 6, 5, 4, 8],
        CellKind::Tet4 => &[0, 2, 1, 3],
        CellKind::Tet10 => &[0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
        CellKind::Hex8 => &[0, 3, 2, 1, 4, 7, 6, 5],
        CellKind::Hex20 => &[
            0, 3, 2, 1, 4, 7, 6, 5, 9, 8, 10, 13, 15, 11, 14, 12, 17, 16, 19, 18,
        ],
        CellKind::Hex27 => &[
            0, 3, 2, 1, 4, 7, 6, 5, 9, 8, 10, 13, 15, 11, 14, 12, 17, 16, 19, 18, 20, 22, 21, 24,
            23, 25, 26,
        ],
    }
}

/// Turns the cells of negative volume round; says which.
fn turn<const D: usize>(cells: &mut [(CellKind, Vec<usize>)], nodes: &[[f64; D]]) -> Vec<bool> {
    let mut samples = BTreeMap::new();
    cells
        .iter_mut()
        .map(|(kind, cell)| {
            let x: Vec<[f64; D]> = cell.iter().map(|&node| nodes[node]).collect();
            let rule = &samples
                .entry(*kind)
                .or_insert_with(|| cell_samples::<D>(*kind))
                .rule;
            let volume: f64 = rule.iter().map(|p| p.weight * p.det(&x)).sum();
            let negative = volume < 0.0;
            if negative {
                *cell = mirrored(*kind).iter().map(|&local| cell[local]).collect();
            }
            negative
        })
        .collect()
}

/// The facets of the groups, in the numbers of the mesh.
fn facets<const D: usize>(
    mesh: &Mesh<D>,
    groups: BTreeMap<String, Vec<Side>>,
    turned: &[bool],
    place: impl Fn(u64, u64) -> Result<Option<usize>, ReadError>,
) -> Result<BTreeMap<String, Vec<Facet>>, ReadError> {
    let sides = || groups.values().flatten();
    let mut wanted = HashMap::new();
    let mut near = vec![false; mesh.nodes().len()];
    for side in sides() {
        if let Side::Element { element, nodes } = side {
            let nodes = placed(*element, nodes, &place)?;
            nodes.iter().flatten().for_each(|&node| near[node] = true);
            if let Some(key) = nodes.and_then(key) {
                wanted.insert(key, Vec::new());
            }
        }
    }
    if !wanted.is_empty() {
        for facet in every_facet(mesh) {
            if mesh.facet_nodes(facet).all(|node| near[node])
                && let Some(key) = key(mesh.facet_nodes(facet))
                && let Some(found) = wanted.get_mut(&key)
            {
                found.push(facet);
            }
        }
    }
    let mut free = Vec::new();
    if sides().any(|side| matches!(side, Side::Free { .. })) {
        free = mesh.boundary_facets();
    }

    let mut result = BTreeMap::new();
    for (name, sides) in &groups {
        let mut facets = Vec::with_capacity(sides.len());
        for side in sides {
            match side {
                Side::Element { element, nodes } => {
                    let own = placed(*element, nodes, &place)?;
                    let found =
                        own.and_then(|own| side_of(mesh, &own, wanted.get(&key(own.clone())?)?));
                    facets.push(found.ok_or_else(|| ReadError::FacetWithoutCell {
                        group: name.clone(),
                        element: *element,
                        nodes: nodes.clone(),
                    })?);
                }
                Side::Of(facet) if turned[facet.cell] => {
                    facets.push(mirrored_facet(mesh.kind(facet.cell), *facet));
                }
                Side::Of(facet) => facets.push(*facet),
                Side::Free { cell } => {
                    let start = free.partition_point(|facet| facet.cell < *cell);
                    let own = free[start..].iter().take_while(|facet| facet.cell == *cell);
                    facets.extend(own);
                }
            }
        }
        result.insert(name.clone(), facets);
    }
    Ok(result)
}

/// Of the facets that have these nodes, of two cells inside a body, the one whose cell goes round them in their sense; the
/// first where none does.
fn side_of<const D: usize>(mesh: &Mesh<D>, nodes: &[usize], found: &[Facet]) -> Option<Facet> {
    let goes_with = |facet: &&Facet| {
        let own: Vec<usize> = mesh.facet_nodes(**facet).collect();
        // Corners come first: two of a line, three or four of a surface.
        let corners = match (D, own.len()) {
            (2, _) => 2,
            (_, 3 | 6) => 3,
            _ => 4,
        };
        match own[..corners].iter().position(|node| *node == nodes[0]) {
            Some(first) if D == 2 => first == 0,
            Some(first) => own[(first + 1) % corners] == nodes[1],
            None => false,
        }
    };
    found.iter().find(goes_with).or(found.first()).copied()
}

fn every_facet<const D: usize>(mesh: &Mesh<D>) -> impl Iterator<Item = Facet> {
    (0..mesh.cell_count()).flat_map(|cell| {
        (0..mesh.kind(cell).facets().len()).map(move |facet| Facet { cell, facet })
    })
}

/// Nodes of an element in the mesh; `None` if no cell has one of them.
fn placed(
    element: u64,
    nodes: &[u64],
    place: impl Fn(u64, u64) -> Result<Option<usize>, ReadError>,
) -> Result<Option<Vec<usize>>, ReadError> {
    nodes.iter().map(|&node| place(element, node)).collect()
}

/// The facet of a cell turned round whose nodes are those of `facet` before.
fn mirrored_facet(kind: CellKind, facet: Facet) -> Facet {
    let mirror = mirrored(kind);
    let wanted = key(kind.facets()[facet.facet]
        .iter()
        .map(|&local| mirror[local]));
    let same = |nodes: &&[usize]| key(nodes.iter().copied()) == wanted;
    Facet {
        cell: facet.cell,
        facet: kind.facets().iter().position(same).unwrap_or(facet.facet),
    }
}

/// Adds groups, those of cells first; a name in use gets a suffix when all others have theirs.
fn add<const D: usize>(
    mesh: &mut Mesh<D>,
    groups: impl Iterator<Item = (String, Members)>,
    losses: &mut Vec<Loss>,
) -> Result<(), MeshError> {
    let mut taken = BTreeSet::new();
    let mut later = Vec::new();
    let mut add = |name: &str, members| match members {
        Members::Cells(cells) => mesh.add_cell_group(name, cells),
        Members::Facets(facets) => mesh.add_facet_group(name, facets),
        Members::Nodes(nodes) => mesh.add_node_group(name, nodes),
    };
    for (name, members) in groups {
        let (empty, reason) = match &members {
            Members::Cells(items) => (items.is_empty(), "it has no cell"),
            Members::Facets(items) => (items.is_empty(), "it has no side of a cell"),
            Members::Nodes(items) => (items.is_empty(), "none of its nodes belongs to a cell"),
        };
        if empty {
            losses.push(Loss::Group { name, reason });
            continue;
        }
        if taken.insert(name.clone()) {
            add(&name, members)?;
        } else {
            later.push((name, members));
        }
    }
    for (mut name, members) in later {
        let suffix = match members {
            Members::Cells(_) => ".cells",
            Members::Facets(_) => ".boundary",
            Members::Nodes(_) => ".nodes",
        };
        while !taken.insert(name.clone()) {
            name.push_str(suffix);
        }
        add(&name, members)?;
    }
    Ok(())
}

/// The cell that an error names.
fn culprit(error: &MeshError) -> Option<usize> {
    match error {
        MeshError::RepeatedNode { cell, .. }
        | MeshError::InvertedCell { cell, .. }
        | MeshError::DegenerateCell { cell, .. } => Some(*cell),
        _ => None,
    }
}
