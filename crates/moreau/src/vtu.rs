//! An unstructured grid as a VTK file and back: appended binary data, compressed; not what the grid is
//! of.

mod pieces;

pub(crate) use pieces::{joined, pieces, whole};

use crate::mesh::{CellKind, FacetKind, Mesh};
use flate2::{Compression, read::ZlibDecoder, write::ZlibEncoder};
use std::fmt::Write as _;
use std::io::{Read as _, Write as _};

/// Bytes that are compressed together.
const BLOCK: usize = 32768;

/// An unstructured grid, as VTK has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Coordinates; z is zero in the plane.
    pub points: Vec<[f64; 3]>,
    /// Points, in the order of VTK, and VTK type of every cell.
    pub cells: Vec<(Vec<i64>, u8)>,
    /// Values at points.
    pub point_data: Vec<Array>,
    /// Values of cells.
    pub cell_data: Vec<Array>,
}

/// Values of points or cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Name.
    pub name: String,
    /// Components: of a tensor xx, yy, zz, xy, yz, xz.
    pub components: usize,
    /// The components of the first point or cell, of the second, and so on.
    pub values: Vec<f64>,
}

/// Fills up with zeros to three components.
pub(crate) fn three(v: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0))
}

/// Nodes of a cell in the order of VTK, and its type there.
pub(crate) fn vtk_cell(kind: CellKind, nodes: &[usize]) -> (Vec<i64>, u8) {
    let (code, order) = cell_type(kind);
    let node = |k: usize| nodes[order.map_or(k, |order| order[k])] as i64;
    ((0..nodes.len()).map(node).collect(), code)
}

/// VTK type of a kind of cell, and which of its nodes comes at each place there, unless as here: VTK
/// lists the edges of hexahedra below, above and upright, and their faces along x, y and z.
fn cell_type(kind: CellKind) -> (u8, Option<&'static [usize]>) {
    const TET10: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
    const HEX27: [usize; 27] = [
        0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20,
        25, 26,
    ];
    match kind {
        CellKind::Tri3 => (5, None),
        CellKind::Tri6 => (22, None),
        CellKind::Quad4 => (9, None),
        CellKind::Quad8 => (23, None),
        CellKind::Quad9 => (28, None),
        CellKind::Tet4 => (10, None),
        CellKind::Tet10 => (24, Some(&TET10)),
        CellKind::Hex8 => (12, None),
        CellKind::Hex20 => (25, Some(&HEX27)),
        CellKind::Hex27 => (29, Some(&HEX27)),
    }
}

/// VTK type of a kind of facet; its nodes come in the same order there.
pub(crate) fn facet_type(kind: FacetKind) -> u8 {
    match kind {
        FacetKind::Line2 => 3,
        FacetKind::Line3 => 21,
        FacetKind::Tri3 => 5,
        FacetKind::Tri6 => 22,
        FacetKind::Quad4 => 9,
        FacetKind::Quad8 => 23,
        FacetKind::Quad9 => 28,
    }
}

/// A mesh without results: its groups as arrays of 0 and 1, of cells for groups of cells and of
/// points for the others.
pub(crate) fn vtu_of_mesh<const D: usize>(mesh: &Mesh<D>) -> Vec<u8> {
    let (mut point_data, mut cell_data) = (Vec::new(), Vec::new());
    let array = |name: &str, members: &[usize], count: usize| {
        let mut values = vec![0.0; count];
        members.iter().for_each(|&m| values[m] = 1.0);
        Array {
            name: String::from(name),
            components: 1,
            values,
        }
    };
    for name in mesh.group_names() {
        match mesh.cell_group(name) {
            Ok(cells) => cell_data.push(array(name, cells, mesh.cell_count())),
            Err(_) => {
                let nodes = mesh.node_group(name).unwrap_or_default();
                point_data.push(array(name, &nodes, mesh.nodes().len()));
            }
        }
    }
    Grid {
        points: mesh.nodes().iter().map(|x| three(x)).collect(),
        cells: cells(mesh),
        point_data,
        cell_data,
    }
    .vtu()
}

/// Nodes and VTK type of all cells.
fn cells<const D: usize>(mesh: &Mesh<D>) -> Vec<(Vec<i64>, u8)> {
    let cell = |c: usize| vtk_cell(mesh.kind(c), mesh.cell_nodes(c));
    (0..mesh.cell_count()).map(cell).collect()
}

impl Grid {
    /// As the content of a VTU file: appended binary data, compressed.
    pub fn vtu(&self) -> Vec<u8> {
        let mut head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
            self.points.len(),
            self.cells.len()
        );
        let connectivity = self.cells.iter().flat_map(|(nodes, _)| nodes.iter());
        let ends = self.cells.iter().scan(0, |end: &mut i64, (nodes, _)| {
            *end += nodes.len() as i64;
            Some(*end)
        });
        let types: Vec<u8> = self.cells.iter().map(|(_, kind)| *kind).collect();
        let given = |arrays: &[Array]| arrays.iter().map(Stored::of).collect::<Vec<_>>();
        let sections = [
            ("PointData", given(&self.point_data)),
            ("CellData", given(&self.cell_data)),
            (
                "Points",
                vec![Stored::new("Points", 3, &self.points.concat())],
            ),
            (
                "Cells",
                vec![
                    Stored::new("connectivity", 1, connectivity),
                    Stored::new("offsets", 1, &ends.collect::<Vec<_>>()),
                    Stored::new("types", 1, &types),
                ],
            ),
        ];
        let all = || sections.iter().flat_map(|(_, arrays)| arrays);
        // The last comes first: meshio 5.3.5 replaces the offsets one after the other by larger ones, and
        // takes the first array of the file that has the one it looks for.
        let mut offset: usize = all().map(|array| array.data.len()).sum();
        for (section, arrays) in &sections {
            // Writing to a string does not fail.
            let _ = writeln!(head, "<{section}>");
            for array in arrays {
                offset -= array.data.len();
                let Stored {
                    name,
                    kind,
                    components,
                    ..
                } = array;
                let _ = writeln!(
                    head,
                    "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                     format=\"appended\" offset=\"{offset}\"/>"
                );
            }
            let _ = writeln!(head, "</{section}>");
        }
        head.push_str("</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
        let mut bytes = head.into_bytes();
        let data: Vec<&Stored> = all().collect();
        data.iter()
            .rev()
            .for_each(|array| bytes.extend(&array.data));
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

/// A number as VTK stores it.
trait Number {
    const KIND: &'static str;
    fn bytes(&self) -> impl IntoIterator<Item = u8>;
}

impl Number for f64 {
    const KIND: &'static str = "Float64";
    fn bytes(&self) -> impl IntoIterator<Item = u8> {
        self.to_le_bytes()
    }
}

impl Number for i64 {
    const KIND: &'static str = "Int64";
    fn bytes(&self) -> impl IntoIterator<Item = u8> {
        self.to_le_bytes()
    }
}

impl Number for u8 {
    const KIND: &'static str = "UInt8";
    fn bytes(&self) -> impl IntoIterator<Item = u8> {
        [*self]
    }
}

/// An array of the file.
struct Stored {
    /// Name, with what has a meaning in XML replaced.
    name: String,
    kind: &'static str,
    components: usize,
    data: Vec<u8>,
}

impl Stored {
    fn new<'a, T: Number + 'a>(
        name: &str,
        components: usize,
        values: impl IntoIterator<Item = &'a T>,
    ) -> Self {
        let bytes: Vec<u8> = values.into_iter().flat_map(T::bytes).collect();
        Self {
            name: Self::named(name),
            kind: T::KIND,
            components,
            data: compressed(&bytes),
        }
    }

    /// A name with what has a meaning in XML replaced.
    fn named(name: &str) -> String {
        let name = name.replace('&', "&amp;").replace('<', "&lt;");
        name.replace('"', "&quot;")
    }

    fn of(array: &Array) -> Self {
        Self::new(&array.name, array.components, &array.values)
    }
}

/// An array as VTK stores it: number of blocks, size of a block, size of the last if it is not
/// full, compressed sizes, and the streams.
fn compressed(bytes: &[u8]) -> Vec<u8> {
    let streams: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(deflated).collect();
    let mut header = vec![streams.len(), BLOCK, bytes.len() % BLOCK];
    header.extend(streams.iter().map(Vec::len));
    let mut out: Vec<u8> = header
        .iter()
        .flat_map(|&n| (n as u64).to_le_bytes())
        .collect();
    out.extend(streams.concat());
    out
}

/// One zlib stream. Writing to memory does not fail.
fn deflated(block: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(block).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}

/// The value of an attribute in a tag.
pub(crate) fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, after) = tag.split_once(&format!(" {name}=\""))?;
    after.split_once('"').map(|(value, _)| value)
}

/// The values at the nodes in a file that a run wrote; `None` if it is not one, or torn.
pub(crate) fn point_data(bytes: &[u8]) -> Option<Vec<Array>> {
    const START: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
    let at = bytes.windows(START.len()).position(|w| w == START)?;
    let head = std::str::from_utf8(&bytes[..at]).ok()?;
    let data = &bytes[at + START.len()..];
    let section = head
        .split("<PointData>")
        .nth(1)?
        .split("</PointData>")
        .next()?;
    let array = |tag: &str| {
        let offset: usize = attribute(tag, "offset")?.parse().ok()?;
        let values = decompressed(data.get(offset..)?)?;
        let number = |b: &[u8]| f64::from_le_bytes(std::array::from_fn(|i| b[i]));
        Some(Array {
            name: attribute(tag, "Name")?.to_owned(),
            components: attribute(tag, "NumberOfComponents")?.parse().ok()?,
            values: values.chunks_exact(8).map(number).collect(),
        })
    };
    section
        .lines()
        .filter(|l| l.starts_with("<DataArray"))
        .map(array)
        .collect()
}

/// The inverse of [`compressed`], from the start of `bytes`.
fn decompressed(bytes: &[u8]) -> Option<Vec<u8>> {
    let word = |k: usize| -> Option<usize> {
        let bytes: [u8; 8] = bytes.get(8 * k..8 * k + 8)?.try_into().ok()?;
        usize::try_from(u64::from_le_bytes(bytes)).ok()
    };
    let blocks = word(0)?;
    let mut at = 8usize.checked_mul(blocks.checked_add(3)?)?;
    let mut out = Vec::new();
    for block in 0..blocks {
        let end = at.checked_add(word(3 + block)?)?;
        let mut stream = ZlibDecoder::new(bytes.get(at..end)?);
        stream.read_to_end(&mut out).ok()?;
        at = end;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_stored_from_the_last_to_the_first_and_read_back() {
        let array = |name: &str, values: &[f64]| Array {
            name: name.to_owned(),
            components: 1,
            values: values.to_owned(),
        };
        let grid = Grid {
            points: vec![[0.0; 3], [1.0, 2.0, 3.0]],
            cells: vec![(vec![0], 1), (vec![1], 1)],
            point_data: vec![array("a", &[1.0, -2.0]), array("b", &[0.0, 0.0])],
            cell_data: vec![array("b", &[3.0, 4.0])],
        };
        let bytes = grid.vtu();
        let text = String::from_utf8_lossy(&bytes);
        let tags = text.lines().filter(|l| l.starts_with("<DataArray"));
        let offset = |tag: &str| {
            attribute(tag, "offset")
                .expect("one")
                .parse()
                .expect("a number")
        };
        let offsets: Vec<usize> = tags.map(offset).collect();
        assert_eq!(offsets.len(), 7);
        assert!(offsets.windows(2).all(|o| o[0] > o[1]), "{offsets:?}");
        assert_eq!(offsets[6], 0);
        assert_eq!(point_data(&bytes), Some(grid.point_data));
    }

    /// VTK's own lists: the corners of the edge or face that each node after the corners halves.
    #[test]
    fn nodes_come_in_the_order_of_vtk() {
        let hexahedron: &[&[usize]] = &[
            &[0, 1],
            &[1, 2],
            &[2, 3],
            &[3, 0],
            &[4, 5],
            &[5, 6],
            &[6, 7],
            &[7, 4],
            &[0, 4],
            &[1, 5],
            &[2, 6],
            &[3, 7],
            &[0, 3, 4, 7],
            &[1, 2, 5, 6],
            &[0, 1, 4, 5],
            &[2, 3, 6, 7],
            &[0, 1, 2, 3],
            &[4, 5, 6, 7],
            &[0, 1, 2, 3, 4, 5, 6, 7],
        ];
        let tetrahedron: &[&[usize]] = &[&[0, 1], &[1, 2], &[2, 0], &[0, 3], &[1, 3], &[2, 3]];
        for (kind, between) in [
            (CellKind::Tet10, tetrahedron),
            (CellKind::Hex20, &hexahedron[..12]),
            (CellKind::Hex27, hexahedron),
        ] {
            let nodes: Vec<&[f64]> = kind.reference_nodes().collect();
            let (_, order) = cell_type(kind);
            let order = order.expect("an order of its own");
            for (k, corners) in between.iter().enumerate() {
                let node = nodes[order[kind.corner_count() + k]];
                for i in 0..3 {
                    let sum: f64 = corners.iter().map(|&c| nodes[c][i]).sum();
                    assert_eq!(node[i], sum / corners.len() as f64, "{kind} {k}");
                }
            }
        }
    }
}
