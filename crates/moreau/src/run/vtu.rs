//! Results as VTK files: bodies and contact surfaces of an increment, and the list of all; appended
//! binary data, compressed.

use super::RunError;
use super::body::body;
use super::files::{Stream, read_text, write_file};
use super::view::View;
use crate::driver::{ContactRecord, Driver};
use crate::laws::Status;
use crate::mesh::{CellKind, Facet, FacetKind, Mesh};
use flate2::{Compression, read::ZlibDecoder, write::ZlibEncoder};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

/// Bytes that are compressed together.
const BLOCK: usize = 32768;

/// Name of the list.
const LIST: &str = "result.pvd";
const LIST_HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
                         byte_order=\"LittleEndian\">\n<Collection>";
const LIST_TAIL: &str = "</Collection>\n</VTKFile>\n";

/// The files written so far, listed in `result.pvd`.
pub(super) struct Collection {
    directory: PathBuf,
    list: Option<Stream>,
}

impl Collection {
    /// The collection as it was when its list had a length; files that came later are
    /// removed. At 0 it is empty; the list begins with the first file.
    pub(super) fn reopen(directory: PathBuf, length: u64) -> Result<Self, RunError> {
        let path = directory.join(LIST);
        let mut kept = String::new();
        let mut list = None;
        if length > 0 {
            let mut stream = Stream::reopen(path.clone(), length)?;
            stream.tail(LIST_TAIL)?;
            list = Some(stream);
            kept = read_text(&path)?;
        } else {
            let _ = std::fs::remove_file(path);
        }
        for entry in std::fs::read_dir(&directory)
            .into_iter()
            .flatten()
            .flatten()
        {
            let name = entry.file_name().to_string_lossy().into_owned();
            let ours = ["body_", "contact_", "failed"]
                .iter()
                .any(|p| name.starts_with(p));
            if ours && name.ends_with(".vtu") && !kept.contains(&format!("\"{name}\"")) {
                // One that stays does no harm.
                let _ = std::fs::remove_file(entry.path());
            }
        }
        Ok(Self { directory, list })
    }

    /// Length of the list without its end.
    pub(super) fn length(&self) -> u64 {
        self.list.as_ref().map_or(0, Stream::length)
    }

    pub(super) fn sync(&mut self) -> Result<(), RunError> {
        self.list.as_mut().map_or(Ok(()), Stream::sync)
    }

    /// Writes the state of a driver, and lists it.
    pub(super) fn add<const D: usize>(
        &mut self,
        driver: &Driver<D>,
        time: f64,
    ) -> Result<(), RunError>
    where
        Driver<D>: View,
    {
        let number = driver.increments();
        let mut files = vec![(0, format!("body_{number:05}.vtu"), body(driver).0)];
        if let Some(contact) = surface(driver) {
            files.push((1, format!("contact_{number:05}.vtu"), contact));
        }
        let mut list = match self.list.take() {
            Some(list) => list,
            None => {
                let mut list = Stream::create(self.directory.join(LIST))?;
                list.line(LIST_HEAD)?;
                list
            }
        };
        for (part, name, file) in files {
            write_file(&self.directory.join(&name), &file.bytes())?;
            list.line(&format!(
                "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{name}\"/>"
            ))?;
        }
        list.tail(LIST_TAIL)?;
        self.list = Some(list);
        Ok(())
    }

    /// Writes a candidate that did not converge: its displacement and what nothing balances.
    pub(super) fn failed<const D: usize>(
        &self,
        driver: &Driver<D>,
        displacement: &[f64],
        residual: &[f64],
    ) -> Result<(), RunError>
    where
        Driver<D>: View,
    {
        let (mut grid, nodes) = body(driver);
        let vector = |name: &str, values: &[f64]| Array {
            name: name.to_owned(),
            components: 3,
            values: nodes
                .iter()
                .flat_map(|n| three(&values[D * n..][..D]))
                .collect(),
        };
        grid.point_data[0] = vector("displacement", displacement);
        grid.point_data.push(vector("out_of_balance", residual));
        write_file(&self.directory.join("failed.vtu"), &grid.bytes())
    }
}

/// Number, time and file of the bodies listed in a directory; none without a list.
pub(super) fn bodies(directory: &Path) -> Vec<(usize, f64, PathBuf)> {
    let text = std::fs::read_to_string(directory.join(LIST)).unwrap_or_default();
    let body = |line: &str| {
        let file = attribute(line, "file")?;
        let number = file.strip_prefix("body_")?.strip_suffix(".vtu")?.parse();
        let time = attribute(line, "timestep")?.parse().ok()?;
        Some((number.ok()?, time, directory.join(file)))
    };
    text.lines().filter_map(body).collect()
}

/// The value of an attribute in a tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, after) = tag.split_once(&format!(" {name}=\""))?;
    after.split_once('"').map(|(value, _)| value)
}

/// The values at the nodes in a file that a run wrote.
pub(super) fn read_point_data(path: &Path) -> Result<Vec<Array>, RunError> {
    let error = |source| RunError::Read {
        path: path.to_owned(),
        source,
    };
    let bytes = std::fs::read(path).map_err(error)?;
    point_data(&bytes)
        .ok_or_else(|| error(std::io::Error::other("it is not a file of a run, or torn")))
}

fn point_data(bytes: &[u8]) -> Option<Vec<Array>> {
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

/// All contact surfaces; none without contacts.
fn surface<const D: usize>(driver: &Driver<D>) -> Option<Grid> {
    let records = driver.contacts();
    let last = records.iter().map(|c| c.contact).max()?;
    let index: BTreeMap<usize, i64> = (0..).zip(records).map(|(k, c)| (c.node, k)).collect();
    let mesh = driver.mesh();
    let mut cells = Vec::new();
    let mut contact = Vec::new();
    for k in 0..=last {
        let facets: &[Facet] = mesh
            .facet_group(driver.contact_name(k).0)
            .unwrap_or_default();
        for &facet in facets {
            let nodes = mesh
                .facet_nodes(facet)
                .filter_map(|n| index.get(&n).copied());
            let kind = match mesh.facet_kind(facet) {
                FacetKind::Line2 => 3,
                FacetKind::Line3 => 21,
                FacetKind::Tri3 => 5,
                FacetKind::Tri6 => 22,
                FacetKind::Quad4 => 9,
                FacetKind::Quad8 => 23,
                FacetKind::Quad9 => 28,
            };
            cells.push((nodes.collect(), kind));
            contact.push(k as f64);
        }
    }
    let array = |name: &str, value: &dyn Fn(&ContactRecord<D>) -> Vec<f64>| {
        let values: Vec<Vec<f64>> = records.iter().map(value).collect();
        Array {
            name: name.to_owned(),
            components: values.first().map_or(1, Vec::len),
            values: values.concat(),
        }
    };
    Some(Grid {
        points: records.iter().map(|c| three(&c.position)).collect(),
        cells,
        point_data: vec![
            array("displacement", &|c| {
                three(driver.displacement(c.node).as_slice()).to_vec()
            }),
            array("gap", &|c| vec![c.u[0]]),
            array("slip", &|c| c.u.iter().skip(1).copied().collect()),
            array("pressure", &|c| vec![c.t[0] / c.area]),
            array("shear", &|c| {
                c.t.iter().skip(1).map(|t| t / c.area).collect()
            }),
            array("force", &|c| three(c.force.as_slice()).to_vec()),
            array("status", &|c| {
                vec![match c.status {
                    Status::Open => 0.0,
                    Status::Stick => 1.0,
                    Status::Slip => 2.0,
                }]
            }),
        ],
        cell_data: vec![Array {
            name: "contact".into(),
            components: 1,
            values: contact,
        }],
    })
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

impl Grid {
    /// The file.
    fn bytes(&self) -> Vec<u8> {
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
