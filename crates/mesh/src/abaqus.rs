//! Meshes from input files of Abaqus and CalculiX; neither their materials nor their steps.

mod cells;
mod keyword;
mod sections;
mod sets;

use crate::read::{Cell, Draft, Loss, Place, ReadError, Side};
use crate::{CellKind, Facet, GroupKind, Mesh};
use keyword::{Block, blocks, fields, number, unexpected};
use sets::Sets;
use std::collections::{BTreeMap, BTreeSet};

/// A mesh of dimension D from the text of an Abaqus or CalculiX input file (`.inp`).
///
/// | keyword | what is read |
/// |---|---|
/// | `*NODE` | nodes; `NSET=` |
/// | `*ELEMENT` | cells: in the plane `CPE`, `CPS` or `CAX` with 3, 4, 6 or 8 nodes, in space `C3D` with 4, 8, 10 or 20 nodes; `ELSET=` |
/// | `*NSET`, `*ELSET` | groups of nodes and cells: numbers, names of earlier sets, `GENERATE`; `*NSET, ELSET=` |
/// | `*SURFACE` | groups of facets: an element or a set and `S1` … `S6`, or no side for all that belong to one cell only; with `TYPE=NODE` groups of nodes |
///
/// Other keywords are passed over with their data, and [`read_abaqus_noting`] tells which, unless they would
/// change the mesh (`*INCLUDE`, generated or copied nodes and elements, local systems, a part placed by an
/// instance): those are errors. Integration and formulation, the letters R, H, I and M after the number of nodes,
/// are no matter of a mesh and dropped: the hypothesis is chosen elsewhere, and cells of plane stress are noted.
///
/// Keywords and names may be in any case; groups are called as first written. A mesh has one set
/// of names: a surface called like an element set becomes `"name.boundary"`, a node set called
/// like either becomes `"name.nodes"`. Sets marked `INTERNAL` are no groups. Without any element
/// set all cells are one group `"mesh"`. Nodes and cells come by increasing number; nodes of no
/// cell are left out, and so are groups of which nothing is left. Cells of negative orientation
/// are turned round: their first node stays, the others run the other way; the sides of surfaces
/// are meant as the file numbers them.
///
/// # Errors
///
/// Whatever is not as described, with its line; in particular [`ReadError::UnsupportedElement`],
/// [`ReadError::Unsupported`], [`ReadError::UnknownSet`], [`ReadError::UnknownMember`],
/// [`ReadError::NotPlanar`], and [`ReadError::Mesh`] for what [`Mesh::new`] refuses.
///
/// # Examples
///
/// ```
/// use moreau_mesh::{ReadError, read_abaqus};
///
/// # fn main() -> Result<(), ReadError> {
/// let text = "
/// *NODE
/// 1, 0., 0.
/// 2, 3., 0.
/// 3, 0., 4.
/// *ELEMENT, TYPE=CPE3, ELSET=steel
/// 1, 1, 2, 3
/// *SURFACE, NAME=bottom
/// steel, S1
/// ";
/// let mesh = read_abaqus::<2>(text)?;
/// assert!(mesh.group_names().eq(["bottom", "steel"]));
/// # Ok(())
/// # }
/// ```
pub fn read_abaqus<const D: usize>(text: &str) -> Result<Mesh<D>, ReadError> {
    Ok(read_abaqus_noting(text)?.0)
}

/// [`read_abaqus`], with what the file says and the mesh does not have.
///
/// # Errors
/// Those of [`read_abaqus`].
pub fn read_abaqus_noting<const D: usize>(text: &str) -> Result<(Mesh<D>, Vec<Loss>), ReadError> {
    const { assert!(D == 2 || D == 3) };
    let blocks = blocks(text)?;
    let mut file = File::new();
    let mut placed = false;
    for block in &blocks {
        match &*block.keyword {
            "NODE" => file.nodes(block)?,
            "ELEMENT" => file.elements::<D>(block)?,
            "INSTANCE" => {
                if placed || !block.data.is_empty() {
                    return Err(refused(block, "write all bodies into one part, in place"));
                }
                placed = true;
            }
            _ => {
                if let Some((_, remedy)) = REFUSED.iter().find(|(name, _)| *name == block.keyword) {
                    return Err(refused(block, remedy));
                }
            }
        }
    }
    file.losses = sections::losses(&blocks);
    file.check_numbers()?;
    for block in &blocks {
        match &*block.keyword {
            "NSET" => file.node_set(block)?,
            "ELSET" => file.element_set(block)?,
            "SURFACE" => file.surface(block)?,
            _ => {}
        }
    }
    file.draft::<D>()?.finish()
}

const LISTED: &str = "write all nodes and elements out";

/// Keywords that would change the mesh, and what to do instead.
const REFUSED: [(&str, &str); 8] = [
    ("INCLUDE", "put the file's text in its place"),
    ("NGEN", LISTED),
    ("NFILL", LISTED),
    ("NCOPY", LISTED),
    ("NMAP", LISTED),
    ("ELGEN", LISTED),
    ("ELCOPY", LISTED),
    ("SYSTEM", "write the nodes in global coordinates"),
];

fn refused(block: &Block<'_>, remedy: &'static str) -> ReadError {
    ReadError::Unsupported {
        place: block.place(),
        what: format!("*{}", block.keyword),
        remedy,
    }
}

/// What a file says.
#[derive(Debug)]
struct File {
    nodes: Vec<(u64, [f64; 3])>,
    cells: Vec<Cell>,
    node_numbers: BTreeSet<u64>,
    element_numbers: BTreeSet<u64>,
    node_sets: Sets,
    element_sets: Sets,
    /// Surfaces by name in upper case; the name as first written, and the sides.
    surfaces: BTreeMap<String, (String, BTreeSet<Side>)>,
    /// Surfaces of nodes, likewise.
    node_surfaces: BTreeMap<String, (String, BTreeSet<u64>)>,
    losses: Vec<Loss>,
}

impl File {
    fn new() -> Self {
        Self {
            nodes: Vec::new(),
            cells: Vec::new(),
            node_numbers: BTreeSet::new(),
            element_numbers: BTreeSet::new(),
            node_sets: Sets::new(GroupKind::Nodes),
            element_sets: Sets::new(GroupKind::Cells),
            surfaces: BTreeMap::new(),
            node_surfaces: BTreeMap::new(),
            losses: Vec::new(),
        }
    }

    fn nodes(&mut self, block: &Block<'_>) -> Result<(), ReadError> {
        let cartesian = |system: &str| system.eq_ignore_ascii_case("R");
        if block.has("INPUT") || !block.value("SYSTEM").is_none_or(cartesian) {
            return Err(refused(
                block,
                "write the nodes here, in Cartesian coordinates, without INPUT= or SYSTEM=",
            ));
        }
        let first = self.nodes.len();
        for &(line, text) in &block.data {
            let mut fields = fields(text);
            let node = number(line, fields.next().unwrap_or_default())?;
            let mut x = [0.0; 3];
            for (x, field) in x.iter_mut().zip(fields) {
                *x = coordinate(line, field)?;
            }
            self.nodes.push((node, x));
        }
        if let Some(name) = block.value("NSET") {
            let members = self.nodes[first..].iter().map(|&(node, _)| node);
            self.node_sets.extend(name, false, members);
        }
        Ok(())
    }

    fn elements<const D: usize>(&mut self, block: &Block<'_>) -> Result<(), ReadError> {
        if block.has("INPUT") {
            return Err(refused(block, "write the elements here, without INPUT="));
        }
        let name = block.needed("TYPE")?;
        let kind = cells::kind(name).filter(|kind| kind.dimension() == D);
        let kind = kind.ok_or_else(|| ReadError::UnsupportedElement {
            place: block.place(),
            element: name.chars().take(40).collect(),
            supported: cells::supported(D),
        })?;
        let first = self.cells.len();
        let mut numbers: Vec<u64> = Vec::with_capacity(1 + kind.nodes());
        let mut continued = None;
        for &(line, text) in &block.data {
            for field in fields(text) {
                numbers.push(number(line, field)?);
            }
            if numbers.len() <= kind.nodes() && text.ends_with(',') {
                continued = Some(line);
                continue;
            }
            continued = None;
            let [element, ref nodes @ ..] = numbers[..] else {
                continue;
            };
            if nodes.len() != kind.nodes() {
                let found = format!("element {element} with {} nodes", nodes.len());
                let expected = format!("a {name} with {} nodes", kind.nodes());
                return Err(unexpected(line, &found, &expected));
            }
            let nodes = match cells::places(kind) {
                Some(places) => places.iter().map(|&k| nodes[k]).collect(),
                None => nodes.to_vec(),
            };
            self.cells.push(Cell {
                element,
                kind,
                nodes,
            });
            numbers.clear();
        }
        if let Some(line) = continued {
            let found = format!("the end of *ELEMENT after {} numbers", numbers.len());
            let expected = format!("a {name} with {} nodes", kind.nodes());
            return Err(unexpected(line, &found, &expected));
        }
        if let Some(name) = block.value("ELSET") {
            let members = self.cells[first..].iter().map(|cell| cell.element);
            self.element_sets.extend(name, false, members);
        }
        Ok(())
    }

    /// Notes which numbers there are, and sorts the elements; both must be without repetition.
    fn check_numbers(&mut self) -> Result<(), ReadError> {
        self.node_numbers = self.nodes.iter().map(|&(node, _)| node).collect();
        self.cells.sort_by_key(|cell| cell.element);
        let twice = |pair: &&[Cell]| pair[0].element == pair[1].element;
        if let Some(pair) = self.cells.windows(2).find(twice) {
            let element = pair[0].element;
            return Err(ReadError::DuplicateElement { element });
        }
        self.element_numbers = self.cells.iter().map(|cell| cell.element).collect();
        Ok(())
    }

    /// Position of an element that exists.
    fn position(&self, element: u64) -> Option<usize> {
        self.cells
            .binary_search_by_key(&element, |cell| cell.element)
            .ok()
    }

    fn node_set(&mut self, block: &Block<'_>) -> Result<(), ReadError> {
        let name = block.needed("NSET")?;
        let members = if let Some(elements) = block.value("ELSET") {
            let elements = self.element_sets.members(block.line, elements)?;
            elements
                .iter()
                .filter_map(|&element| self.position(element))
                .flat_map(|cell| self.cells[cell].nodes.iter().copied())
                .collect()
        } else {
            self.node_sets.listed(block, &self.node_numbers)?
        };
        let internal = block.has("INTERNAL");
        self.node_sets.extend(name, internal, members);
        Ok(())
    }

    fn element_set(&mut self, block: &Block<'_>) -> Result<(), ReadError> {
        let name = block.needed("ELSET")?;
        let members = self.element_sets.listed(block, &self.element_numbers)?;
        let internal = block.has("INTERNAL");
        self.element_sets.extend(name, internal, members);
        Ok(())
    }

    fn surface(&mut self, block: &Block<'_>) -> Result<(), ReadError> {
        let name = block.needed("NAME")?;
        let (upper, named) = (name.to_uppercase(), name.to_owned());
        match &*block.value("TYPE").unwrap_or("ELEMENT").to_uppercase() {
            "ELEMENT" => {
                let mut sides = BTreeSet::new();
                for &(line, text) in &block.data {
                    self.sides(line, text, &mut sides)?;
                }
                let surface = self.surfaces.entry(upper);
                surface.or_insert((named, BTreeSet::new())).1.extend(sides);
            }
            "NODE" => {
                let mut members = BTreeSet::new();
                for &(line, text) in &block.data {
                    // What follows the set is a tributary area.
                    let field = fields(text).next().unwrap_or_default();
                    if field.starts_with(|c: char| c.is_ascii_digit()) {
                        let node = number(line, field)?;
                        members.insert(self.node_sets.member(line, node, &self.node_numbers)?);
                    } else {
                        members.extend(self.node_sets.members(line, field)?);
                    }
                }
                let surface = self.node_surfaces.entry(upper);
                surface
                    .or_insert((named, BTreeSet::new()))
                    .1
                    .extend(members);
            }
            _ => self.losses.push(Loss::Group {
                name: named,
                reason: "its type is neither ELEMENT nor NODE",
            }),
        }
        Ok(())
    }

    /// The sides that a data line of `*SURFACE` names: an element or a set, and a side.
    fn sides(&self, line: usize, text: &str, sides: &mut BTreeSet<Side>) -> Result<(), ReadError> {
        let mut fields = fields(text);
        let owner = fields.next().unwrap_or_default();
        let side = fields.next().unwrap_or_default();
        let elements = if owner.starts_with(|c: char| c.is_ascii_digit()) {
            let element = number(line, owner)?;
            let sets = &self.element_sets;
            vec![sets.member(line, element, &self.element_numbers)?]
        } else {
            let members = self.element_sets.members(line, owner)?;
            members.iter().copied().collect()
        };
        for element in elements {
            let Some(cell) = self.position(element) else {
                continue;
            };
            let kind: CellKind = self.cells[cell].kind;
            if side.is_empty() {
                sides.insert(Side::Free { cell });
                continue;
            }
            let facet = cells::facet(kind, side).ok_or_else(|| ReadError::NoSuchSide {
                place: Place::Line(line),
                element,
                kind,
                side: side.chars().take(40).collect(),
            })?;
            sides.insert(Side::Of(Facet { cell, facet }));
        }
        Ok(())
    }

    fn draft<const D: usize>(self) -> Result<Draft, ReadError> {
        if self.cells.is_empty() {
            return Err(ReadError::NoCells {
                dimension: D,
                elements: 0,
            });
        }
        let mut draft = Draft::default();
        for (name, members) in self.element_sets.groups() {
            let cells = members.iter().filter_map(|&element| self.position(element));
            draft.cell_groups.insert(name.into(), cells.collect());
        }
        if draft.cell_groups.values().all(Vec::is_empty) {
            let all = (0..self.cells.len()).collect();
            draft.cell_groups.insert("mesh".into(), all);
        }
        for (name, members) in self.node_sets.groups() {
            let nodes = members.iter().copied().collect();
            draft.node_groups.insert(name.into(), nodes);
        }
        for (name, nodes) in self.node_surfaces.into_values() {
            draft.node_groups.entry(name).or_default().extend(nodes);
        }
        let surfaces = self.surfaces.into_values();
        draft.facet_groups = surfaces
            .map(|(name, sides)| (name, sides.into_iter().collect()))
            .collect();
        draft.losses = self.losses;
        draft.nodes = self.nodes;
        draft.cells = self.cells;
        Ok(draft)
    }
}

/// A coordinate \[mm\]; blank is zero, and the exponent may be a Fortran D.
fn coordinate(line: usize, field: &str) -> Result<f64, ReadError> {
    if field.is_empty() {
        return Ok(0.0);
    }
    let value: Option<f64> = field.replace(['d', 'D'], "e").parse().ok();
    value
        .filter(|value| value.is_finite())
        .ok_or_else(|| unexpected(line, field, "a finite coordinate"))
}
