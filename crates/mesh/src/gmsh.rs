//! Meshes from files of Gmsh, MSH 2.2 and 4.1; neither its geometries nor its results.

mod input;
mod kind;
mod v2;
mod v4;
mod write;

pub use write::write_gmsh;

use crate::read::{Cell, Draft, Loss, ReadError, Side};
use crate::skin::Skin;
use crate::{CellKind, Mesh, nearest};
use input::{Coding, Input};
use kind::Kind;
use std::collections::{BTreeMap, HashMap, HashSet};

/// A mesh of dimension D from the bytes of an MSH file, version 2.2 or 4.1, in text or binary of
/// either byte order.
///
/// **Cells** are the elements of dimension D: triangles of 3 and 6 nodes, quadrangles of 4, 8 and 9,
/// tetrahedra of 4, hexahedra of 8. Those in no physical group are left out, unless none is in
/// any: then all are read, as one group `"mesh"`. Elements with the same nodes are one cell, which
/// is how MSH 2.2 writes a cell of several groups. Cells of negative orientation are turned round:
/// their node 0 stays, the others run the other way. Nodes come by increasing number and cells by
/// the numbers of their nodes, so that one mesh saved in any version is the same mesh here (unless
/// Gmsh numbers its nodes anew); nodes of no cell are left out. A plane mesh lies in some plane z = constant.
///
/// **Groups** are the physical groups by name, or by number where they have none:
///
/// | physical group of dimension | becomes a group of |
/// |---|---|
/// | D | cells |
/// | D − 1 | facets: sides of the cells with the same nodes, inside a body of the cell that goes round them in their order |
/// | less | nodes |
///
/// A mesh has one set of names. Where a group of facets is called like one of cells, it becomes
/// `"name.boundary"`; a group of nodes called like either becomes `"name.nodes"`. A group of nodes
/// none of which belongs to a cell is left out.
///
/// # Errors
///
/// Whatever is not as described, with its place; in particular [`ReadError::Version`],
/// [`ReadError::UnsupportedElement`], [`ReadError::FacetWithoutCell`], [`ReadError::NotPlanar`],
/// and [`ReadError::Mesh`] for what [`Mesh::new`] refuses.
///
/// # Examples
///
/// ```
/// use moreau_mesh::{ReadError, read_gmsh};
///
/// # fn main() -> Result<(), ReadError> {
/// let file = b"$MeshFormat
/// 2.2 0 8
/// $EndMeshFormat
/// $PhysicalNames
/// 2
/// 1 1 \"bottom\"
/// 2 2 \"steel\"
/// $EndPhysicalNames
/// $Nodes
/// 3
/// 1 0 0 0
/// 2 3 0 0
/// 3 0 4 0
/// $EndNodes
/// $Elements
/// 2
/// 1 1 2 1 1 1 2
/// 2 2 2 2 1 1 2 3
/// $EndElements
/// ";
/// let mesh = read_gmsh::<2>(file)?;
/// assert!(mesh.group_names().eq(["bottom", "steel"]));
/// # Ok(())
/// # }
/// ```
pub fn read_gmsh<const D: usize>(bytes: &[u8]) -> Result<Mesh<D>, ReadError> {
    Ok(read_gmsh_noting(bytes)?.0)
}

/// [`read_gmsh`], with what the file says and the mesh does not have.
///
/// # Errors
/// Those of [`read_gmsh`].
pub fn read_gmsh_noting<const D: usize>(bytes: &[u8]) -> Result<(Mesh<D>, Vec<Loss>), ReadError> {
    const { assert!(D == 2 || D == 3) };
    read(bytes)?.draft::<D>()?.finish()
}

/// The triangles of a physical group of surfaces of a file of Gmsh, or of all its surfaces; quadrangles are halved, and
/// triangles of six nodes quartered.
///
/// # Errors
/// Those of [`read_gmsh`]; [`ReadError::NoGroup`] for a name that no group of surfaces has, with the nearest one that
/// does; [`ReadError::NoTriangles`].
pub fn read_gmsh_skin(bytes: &[u8], group: Option<&str>) -> Result<Skin, ReadError> {
    read(bytes)?.skin(group)
}

/// What a file says.
#[derive(Debug, Default)]
struct File {
    /// Names of the physical groups, by dimension and tag.
    names: HashMap<(usize, u32), String>,
    /// Physical groups of the entities, by dimension and tag.
    entities: HashMap<(i32, i32), Vec<u32>>,
    nodes: Vec<(u64, [f64; 3])>,
    elements: Vec<Element>,
}

#[derive(Debug)]
struct Element {
    number: u64,
    kind: Kind,
    owner: Owner,
    nodes: Vec<u64>,
}

/// What an element belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Owner {
    /// A physical group of its own dimension; 0 for none.
    Physical(u32),
    /// An entity, by dimension and tag.
    Entity(i32, i32),
}

/// Versions of the format that are read.
#[derive(Debug, Clone, Copy)]
enum Version {
    V2,
    V4,
}

fn read(bytes: &[u8]) -> Result<File, ReadError> {
    let mut input = Input::new(bytes);
    let mut file = File::default();
    let mut version = None;
    let mut at = input.at();
    while let Some(section) = input.section()? {
        match (section, version) {
            (b"MeshFormat", None) => version = Some(format(&mut input)?),
            (b"PhysicalNames", _) => names(&mut input, &mut file)?,
            (b"Nodes", Some(Version::V2)) => v2::nodes(&mut input, &mut file)?,
            (b"Nodes", Some(Version::V4)) => v4::nodes(&mut input, &mut file)?,
            (b"Elements", Some(Version::V2)) => v2::elements(&mut input, &mut file)?,
            (b"Elements", Some(Version::V4)) => v4::elements(&mut input, &mut file)?,
            (b"Entities", Some(Version::V4)) => v4::entities(&mut input, &mut file, false)?,
            (b"PartitionedEntities", Some(Version::V4)) => {
                v4::entities(&mut input, &mut file, true)?;
            }
            (b"ParametricNodes", _) => {
                return Err(ReadError::Unsupported {
                    place: input.place_of(at),
                    what: "$ParametricNodes".into(),
                    remedy: "save the mesh without parametric coordinates, or as MSH 4.1",
                });
            }
            (b"Nodes" | b"Elements" | b"Entities", None) => {
                return Err(input.unexpected(at, section, "$MeshFormat"));
            }
            (other, _) => {
                input.skip(other)?;
                at = input.at();
                continue;
            }
        }
        input.end(section)?;
        at = input.at();
    }
    match version {
        Some(_) => Ok(file),
        None => Err(input.truncated("$MeshFormat")),
    }
}

/// `$MeshFormat`: version, coding and size of a number.
fn format(input: &mut Input<'_>) -> Result<Version, ReadError> {
    let (at, word) = input.word("the version")?;
    let version = match word {
        b"2.2" => Version::V2,
        b"4.1" => Version::V4,
        _ if word.iter().all(|b| b.is_ascii_digit() || *b == b'.') => {
            return Err(ReadError::Version {
                place: input.place_of(at),
                found: String::from_utf8_lossy(word).chars().take(40).collect(),
            });
        }
        _ => return Err(input.unexpected(at, word, "the version")),
    };
    let at = input.at();
    let coding = input.text_int("0 for text or 1 for binary")?;
    let size_at = input.at();
    let size = input.text_int("the size of a number")?;
    if size != 8 {
        return Err(input.wrong(size_at, size, "8, the size of a number,"));
    }
    match coding {
        0 => {}
        1 => {
            input.end_of_header()?;
            let at = input.at();
            input.coding = Coding::Binary { big_endian: false };
            let one = input.int("the integer 1")?;
            let big_endian = one == i32::swap_bytes(1);
            if one != 1 && !big_endian {
                return Err(input.wrong(at, one, "the integer 1"));
            }
            input.coding = Coding::Binary { big_endian };
        }
        _ => return Err(input.wrong(at, coding, "0 for text or 1 for binary")),
    }
    Ok(version)
}

/// `$PhysicalNames`, in text whatever the coding: dimension, tag and name in quotes.
fn names(input: &mut Input<'_>, file: &mut File) -> Result<(), ReadError> {
    let count = input.text_int("the number of names")?;
    for _ in 0..count {
        let at = input.at();
        let dimension = input.text_int("the dimension of a physical group")?;
        let tag = input.text_int("the tag of a physical group")?;
        let line = input.line();
        let name = line
            .strip_prefix(b"\"")
            .and_then(|name| name.strip_suffix(b"\""))
            .ok_or_else(|| input.unexpected(at, line, "a name in quotes"))?;
        if let Ok(dimension) = usize::try_from(dimension)
            && !name.is_empty()
        {
            let name = String::from_utf8_lossy(name).into_owned();
            file.names.insert((dimension, tag.unsigned_abs()), name);
        }
    }
    Ok(())
}

/// The type of an element, by its number.
fn element_kind(input: &mut Input<'_>) -> Result<Kind, ReadError> {
    let at = input.at();
    let number = input.int("the type of an element")?;
    kind::kind(number).ok_or_else(|| ReadError::UnsupportedElement {
        place: input.place_of(at),
        element: kind::name(number),
        supported: kind::SUPPORTED,
    })
}

impl File {
    fn physicals<'a>(&'a self, element: &'a Element) -> &'a [u32] {
        match &element.owner {
            Owner::Physical(0) => &[],
            Owner::Physical(tag) => std::slice::from_ref(tag),
            Owner::Entity(dimension, tag) => self
                .entities
                .get(&(*dimension, *tag))
                .map_or(&[], Vec::as_slice),
        }
    }

    /// Name of a physical group.
    fn name(&self, dimension: usize, tag: u32) -> String {
        let name = self.names.get(&(dimension, tag));
        name.map_or_else(|| tag.to_string(), Clone::clone)
    }

    fn skin(&self, group: Option<&str>) -> Result<Skin, ReadError> {
        let surfaces = || self.elements.iter().filter(|e| e.kind.dimension == 2);
        let names = |e: &Element| -> Vec<String> {
            let tags = self.physicals(e).iter();
            tags.map(|&tag| self.name(2, tag)).collect()
        };
        let is_of = |e: &Element| group.is_none_or(|group| names(e).iter().any(|n| n == group));
        if let Some(group) = group
            && !surfaces().any(is_of)
        {
            let names: Vec<String> = surfaces().flat_map(names).collect();
            let near = nearest(group, names.iter().map(String::as_str));
            return Err(ReadError::NoGroup {
                group: group.into(),
                nearest: near.map(Into::into),
            });
        }
        let places: HashMap<u64, [f64; 3]> = self.nodes.iter().copied().collect();
        let mut triangles = Vec::new();
        for element in surfaces().filter(|e| is_of(e)) {
            let parts: &[[usize; 3]] = match element.kind.cell {
                Some(CellKind::Tri3) => &[[0, 1, 2]],
                Some(CellKind::Tri6) => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
                _ => &[[0, 1, 2], [0, 2, 3]],
            };
            for part in parts {
                let mut corners = [[0.0; 3]; 3];
                for (corner, &k) in corners.iter_mut().zip(part) {
                    let (element, node) = (element.number, element.nodes[k]);
                    let place = places.get(&node);
                    *corner = *place.ok_or(ReadError::UnknownNode { element, node })?;
                }
                triangles.push(corners);
            }
        }
        Skin::of(triangles.into_iter())
    }

    fn draft<const D: usize>(mut self) -> Result<Draft, ReadError> {
        if let Some(element) = self.elements.iter().find(|e| e.kind.dimension > D) {
            return Err(ReadError::Dimension {
                element: element.number,
                found: element.kind.dimension,
                expected: D,
            });
        }
        let mut draft = Draft {
            nodes: std::mem::take(&mut self.nodes),
            ..Draft::default()
        };
        for element in self.elements.iter().filter(|e| e.kind.dimension < D) {
            for &tag in self.physicals(element) {
                let name = self.name(element.kind.dimension, tag);
                if element.kind.dimension + 1 == D {
                    let side = Side::Element {
                        element: element.number,
                        nodes: element.nodes.clone(),
                    };
                    draft.facet_groups.entry(name).or_default().push(side);
                } else {
                    let nodes = draft.node_groups.entry(name).or_default();
                    nodes.extend_from_slice(&element.nodes);
                }
            }
        }
        self.cells::<D>(&mut draft)?;
        self.unused_names(&mut draft);
        Ok(draft)
    }

    /// Notes names of physical groups that no element has.
    fn unused_names(&self, draft: &mut Draft) {
        let used: HashSet<(usize, u32)> = self
            .elements
            .iter()
            .flat_map(|e| self.physicals(e).iter().map(|&tag| (e.kind.dimension, tag)))
            .collect();
        let unused = self.names.iter().filter(|(key, _)| !used.contains(key));
        let mut names: Vec<&String> = unused.map(|(_, name)| name).collect();
        names.sort_unstable();
        draft
            .losses
            .extend(names.into_iter().map(|name| Loss::Group {
                name: name.clone(),
                reason: "no element of the file is in it",
            }));
    }

    /// The cells and their groups.
    fn cells<const D: usize>(&self, draft: &mut Draft) -> Result<(), ReadError> {
        let all = || self.elements.iter().filter(|e| e.kind.dimension == D);
        let grouped = all().any(|element| !self.physicals(element).is_empty());
        let mut kept: Vec<(Vec<u64>, &Element)> = all()
            .filter(|element| !grouped || !self.physicals(element).is_empty())
            .map(|element| {
                let mut key = element.nodes.clone();
                key.sort_unstable();
                (key, element)
            })
            .collect();
        if kept.is_empty() {
            return Err(ReadError::NoCells {
                dimension: D,
                elements: self.elements.len(),
            });
        }
        let mut left = all().filter(|e| grouped && self.physicals(e).is_empty());
        if let Some(first) = left.next() {
            draft.losses.push(Loss::Ungrouped {
                elements: 1 + left.count(),
                first: first.number,
            });
        }
        // Stable: of elements with the same nodes, the first one gives the cell.
        kept.sort_by(|a, b| a.0.cmp(&b.0));
        let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for same in kept.chunk_by(|a, b| a.0 == b.0 && a.1.kind == b.1.kind) {
            let (_, first) = &same[0];
            let Some(kind) = first.kind.cell else {
                continue;
            };
            let cell = draft.cells.len();
            draft.cells.push(Cell {
                element: first.number,
                kind,
                nodes: first.nodes.clone(),
            });
            for &tag in same.iter().flat_map(|(_, e)| self.physicals(e)) {
                groups.entry(tag).or_default().push(cell);
            }
        }
        for (tag, cells) in groups {
            let group = draft.cell_groups.entry(self.name(D, tag)).or_default();
            group.extend(cells);
        }
        if !grouped {
            let all = (0..draft.cells.len()).collect();
            draft.cell_groups.insert("mesh".into(), all);
        }
        Ok(())
    }
}
