//! An unstructured grid as a VTK file and back: appended binary data, compressed; not what the grid is
//! of.

use crate::mesh::{CellKind, FacetKind, Mesh};
use flate2::{Compression, read::ZlibDecoder, write::ZlibEncoder};
use std::fmt::Write as _;
use std::io::{Read as _, Write as _};

/// Bytes that are compressed together.
const BLOCK: usize = 32768;

/// An unstructured grid.
pub(super) struct Grid {
    pub(super) points: Vec<[f64; 3]>,
    /// Nodes and VTK type of every cell.
    pub(super) cells: Vec<(Vec<i64>, u8)>,
    pub(super) point_data: Vec<Array>,
    pub(super) cell_data: Vec<Array>,
}

/// Values of points or cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub(super) name: String,
    pub(super) components: usize,
    pub(super) values: Vec<f64>,
}

/// Fills up with zeros to three components.
pub(super) fn three(v: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0))
}

/// Nodes of a cell in the order of VTK, and its type there.
pub(super) fn vtk_cell(kind: CellKind, nodes: &[usize]) -> (Vec<i64>, u8) {
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
pub(super) fn facet_type(kind: FacetKind) -> u8 {
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
    .bytes()
}

/// Nodes and VTK type of all cells.
fn cells<const D: usize>(mesh: &Mesh<D>) -> Vec<(Vec<i64>, u8)> {
    let cell = |c: usize| vtk_cell(mesh.kind(c), mesh.cell_nodes(c));
    (0..mesh.cell_count()).map(cell).collect()
}

impl Grid {
    /// The file.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
            self.points.len(),
            self.cells.len()
        );
        let mut data = Vec::new();
        let mut add = |head: &mut String, name: &str, kind: &str, components, bytes: &[u8]| {
            let offset = data.len();
            // Writing to a string does not fail.
            let name = name
                .replace('&', "&amp;")
                .replace('<', "&lt;")
                .replace('"', "&quot;");
            let _ = writeln!(
                head,
                "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                 format=\"appended\" offset=\"{offset}\"/>"
            );
            data.extend(compressed(bytes));
        };
        let floats =
            |values: &[f64]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
        let integers =
            |values: Vec<i64>| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
        for (tag, arrays) in [
            ("PointData", &self.point_data),
            ("CellData", &self.cell_data),
        ] {
            head.push_str(&format!("<{tag}>\n"));
            for array in arrays {
                let bytes = floats(&array.values);
                add(&mut head, &array.name, "Float64", array.components, &bytes);
            }
            head.push_str(&format!("</{tag}>\n"));
        }
        head.push_str("<Points>\n");
        add(
            &mut head,
            "Points",
            "Float64",
            3,
            &floats(&self.points.concat()),
        );
        head.push_str("</Points>\n<Cells>\n");
        let connectivity = self.cells.iter().flat_map(|(nodes, _)| nodes).copied();
        add(
            &mut head,
            "connectivity",
            "Int64",
            1,
            &integers(connectivity.collect()),
        );
        let ends = self.cells.iter().scan(0, |end, (nodes, _)| {
            *end += nodes.len() as i64;
            Some(*end)
        });
        add(&mut head, "offsets", "Int64", 1, &integers(ends.collect()));
        let types: Vec<u8> = self.cells.iter().map(|(_, kind)| *kind).collect();
        add(&mut head, "types", "UInt8", 1, &types);
        head.push_str(
            "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
        );
        let mut bytes = head.into_bytes();
        bytes.extend(data);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
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
pub(super) fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, after) = tag.split_once(&format!(" {name}=\""))?;
    after.split_once('"').map(|(value, _)| value)
}

/// The values at the nodes in a file that a run wrote; `None` if it is not one, or torn.
pub(super) fn point_data(bytes: &[u8]) -> Option<Vec<Array>> {
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
