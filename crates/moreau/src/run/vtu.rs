//! Results as VTK files: bodies and contact surfaces of an increment, and the list of all; appended
//! binary data, compressed. No file is read back.

use super::view::{NodalField, View};
use super::{OutputError, write_file};
use crate::driver::{ContactRecord, Driver};
use crate::laws::Status;
use crate::mesh::{CellKind, Facet, FacetKind, Mesh};
use flate2::{Compression, write::ZlibEncoder};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

/// Bytes that are compressed together.
const BLOCK: usize = 32768;

/// The files written so far, listed in `result.pvd`.
pub(super) struct Collection {
    pub(super) directory: PathBuf,
    entries: Vec<(f64, usize, String)>,
}

impl Collection {
    pub(super) fn new(directory: PathBuf) -> Self {
        Self {
            directory,
            entries: Vec::new(),
        }
    }

    /// Writes the state of a driver, and the list anew.
    pub(super) fn add<const D: usize>(
        &mut self,
        driver: &Driver<D>,
        time: f64,
    ) -> Result<(), OutputError>
    where
        Driver<D>: View,
    {
        let number = driver.increments();
        let mut files = vec![(0, format!("body_{number:05}.vtu"), body(driver))];
        if let Some(contact) = surface(driver) {
            files.push((1, format!("contact_{number:05}.vtu"), contact));
        }
        for (part, name, file) in files {
            write_file(&self.directory.join(&name), &file.bytes())?;
            self.entries.push((time, part, name));
        }
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
             byte_order=\"LittleEndian\">\n<Collection>\n",
        );
        for (time, part, name) in &self.entries {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{name}\"/>"
            );
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        write_file(&self.directory.join("result.pvd"), text.as_bytes())
    }
}

/// An unstructured grid.
struct Grid<'a> {
    points: Vec<[f64; 3]>,
    /// Nodes and VTK type of every cell.
    cells: Vec<(Vec<i64>, u8)>,
    point_data: Vec<Array<'a>>,
    cell_data: Vec<Array<'a>>,
}

/// Values of points or cells.
struct Array<'a> {
    name: &'a str,
    components: usize,
    values: Vec<f64>,
}

/// Fills up with zeros to three components.
fn three(v: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0))
}

/// A mesh without results: its groups as arrays of 0 and 1, of cells for groups of cells and of
/// points for the others.
pub(crate) fn vtu_of_mesh<const D: usize>(mesh: &Mesh<D>) -> Vec<u8> {
    let (mut point_data, mut cell_data) = (Vec::new(), Vec::new());
    let array = |name, members: &[usize], count: usize| {
        let mut values = vec![0.0; count];
        members.iter().for_each(|&m| values[m] = 1.0);
        Array {
            name,
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
    let cell = |c: usize| {
        let nodes = mesh.cell_nodes(c).iter().map(|&n| n as i64).collect();
        (nodes, cell_type(mesh.kind(c)))
    };
    (0..mesh.cell_count()).map(cell).collect()
}

fn body<const D: usize>(driver: &Driver<D>) -> Grid<'static>
where
    Driver<D>: View,
{
    let mesh = driver.mesh();
    let nodes = 0..mesh.nodes().len();
    let scalar = |name, field| Array {
        name,
        components: 1,
        values: driver.nodal(field),
    };
    let displacement = nodes.flat_map(|n| three(driver.displacement(n).as_slice()));
    Grid {
        points: mesh.nodes().iter().map(|x| three(x)).collect(),
        cells: cells(mesh),
        point_data: vec![
            Array {
                name: "displacement",
                components: 3,
                values: displacement.collect(),
            },
            scalar("von_mises", NodalField::VonMises),
            scalar("equivalent_plastic_strain", NodalField::PlasticStrain),
        ],
        cell_data: vec![Array {
            name: "cell",
            components: 1,
            values: (0..mesh.cell_count()).map(|c| c as f64).collect(),
        }],
    }
}

/// All contact surfaces; none without contacts.
fn surface<const D: usize>(driver: &Driver<D>) -> Option<Grid<'static>> {
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
                FacetKind::Quad4 => 9,
            };
            cells.push((nodes.collect(), kind));
            contact.push(k as f64);
        }
    }
    let array = |name, value: &dyn Fn(&ContactRecord<D>) -> Vec<f64>| {
        let values: Vec<Vec<f64>> = records.iter().map(value).collect();
        Array {
            name,
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
            name: "contact",
            components: 1,
            values: contact,
        }],
    })
}

fn cell_type(kind: CellKind) -> u8 {
    match kind.name() {
        "tri3" => 5,
        "tri6" => 22,
        "quad4" => 9,
        "quad8" => 23,
        "quad9" => 28,
        "tet4" => 10,
        "hex8" => 12,
        // A polyvertex shows the nodes of a cell that this list does not know.
        _ => 2,
    }
}

impl Grid<'_> {
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
                add(&mut head, array.name, "Float64", array.components, &bytes);
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
