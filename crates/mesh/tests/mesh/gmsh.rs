//! Files that Gmsh wrote (`tests/data/make.py`) are the meshes they were made to be, in every
//! encoding; small files by hand for what Gmsh does not write here.

use crate::ROUND_OFF;
use approx::assert_abs_diff_eq;
use moreau_mesh::{
    CellKind, Element, GroupKind, Hex8, Hypothesis, Mesh, MeshError, Place, PlaneStrain, ReadError,
    Solid, Tet4, read_gmsh,
};
use std::f64::consts::PI;

/// What is left of coordinates to compare \[mm\].
const DIGITS: f64 = 1e-9;
/// Gmsh places nodes on curves by arc length, to about 1e-11 mm here.
const PLACING: f64 = 1e-7;
/// Length of an arc of 15° by a quadratic edge \[mm\].
const CURVED: f64 = 1e-3;

/// The encodings of a model.
macro_rules! files {
    ($model:literal, $($encoding:literal),+) => {
        [$(&include_bytes!(concat!("../data/", $model, ".", $encoding, ".msh"))[..]),+]
    };
}

/// The mesh of a model, the same in all its encodings but for the 16 digits of Gmsh's text.
fn mesh<const D: usize>(files: &[&[u8]]) -> Mesh<D> {
    let mut meshes = files.iter().map(|file| {
        let mesh = read_gmsh::<D>(file).expect("readable");
        let rounded = |x: f64| (x / DIGITS).round() * DIGITS;
        mesh.map(|x| x.map(rounded)).expect("hardly moved")
    });
    let first = meshes.next().expect("a file");
    for (mesh, i) in meshes.zip(1..) {
        assert!(mesh == first, "file {i} is another mesh than file 0");
    }
    first
}

fn measure<const D: usize, H: Hypothesis<D>>(mesh: &Mesh<D>, group: &str, hypothesis: &H) -> f64 {
    mesh.measure(mesh.cell_group(group).expect("named"), hypothesis)
}

/// Area and ∫ n dS of a facet group.
fn surface<const D: usize, H: Hypothesis<D>>(
    mesh: &Mesh<D>,
    group: &str,
    hypothesis: &H,
) -> (f64, [f64; D]) {
    let shares = mesh.facet_shares(mesh.facet_group(group).expect("named"), hypothesis);
    let area = shares.iter().map(|share| share.area).sum();
    let normal = std::array::from_fn(|i| shares.iter().map(|share| share.normal[i]).sum());
    (area, normal)
}

/// A quarter of a plate of 10 mm with a hole of radius 4 mm, thickness 1 mm.
fn is_the_plate(mesh: &Mesh<2>, hole: f64, arc: f64, tolerance: f64) {
    let plane = PlaneStrain::default();
    assert!(mesh.group_names().eq([
        "bottom",
        "corner",
        "cut",
        "hole",
        "left",
        "left half",
        "plate",
        "right",
        "right half",
        "top"
    ]));
    assert_eq!(
        mesh.cell_group("plate").expect("named").len(),
        mesh.cell_count()
    );
    assert_eq!(mesh.bodies().len(), 1);
    for (group, part) in [("plate", 1.0), ("left half", 0.5), ("right half", 0.5)] {
        let area = measure(mesh, group, &plane);
        assert_abs_diff_eq!(area, part * (100.0 - hole), epsilon = PLACING);
    }
    for (group, exact) in [
        ("bottom", [0.0, -6.0_f64]),
        ("right", [10.0, 0.0]),
        ("top", [0.0, 10.0]),
        ("left", [-6.0, 0.0]),
    ] {
        let (length, normal) = surface(mesh, group, &plane);
        assert_abs_diff_eq!(length, exact[0].abs() + exact[1].abs(), epsilon = PLACING);
        assert_abs_diff_eq!(normal[..], exact[..], epsilon = PLACING);
    }
    let (length, normal) = surface(mesh, "hole", &plane);
    assert_abs_diff_eq!(length, arc, epsilon = tolerance);
    assert_abs_diff_eq!(normal[..], [-4.0, -4.0][..], epsilon = PLACING);
    // Inside the plate, the first of both cells has the facet.
    let (length, _) = surface(mesh, "cut", &plane);
    assert_abs_diff_eq!(length, 200.0f64.sqrt() - 4.0, epsilon = PLACING);
    let boundary = mesh.boundary_facets();
    let inside = |facet| boundary.binary_search(facet).is_err();
    assert!(mesh.facet_group("cut").expect("named").iter().all(inside));
    // The centre of the hole is named as well, but in no cell.
    let corner = mesh.node_group("corner").expect("named");
    assert_eq!(corner.len(), 1);
    assert_eq!(mesh.nodes()[corner[0]], [10.0, 10.0]);
}

/// Area of the quarter of the hole with six quadratic edges: triangles of 15°, and parabolas over
/// their chords.
fn quadratic_hole() -> f64 {
    let (chord, height) = (8.0 * (PI / 24.0).sin(), 4.0 * (1.0 - (PI / 24.0).cos()));
    48.0 * (PI / 12.0).sin() + 6.0 * 2.0 / 3.0 * chord * height
}

#[test]
fn plates_of_quadratic_cells() {
    for (files, kinds) in [
        (files!("tri6", "2a", "2b", "4a", "4b"), [CellKind::Tri6; 2]),
        (
            files!("quad8", "2a", "2b", "4a", "4b"),
            [CellKind::Quad8; 2],
        ),
        // The surfaces of this one are turned round.
        (
            files!("quad9", "2a", "2b", "4a", "4b"),
            [CellKind::Quad9; 2],
        ),
    ] {
        let mesh = mesh(&files);
        assert!((0..mesh.cell_count()).all(|cell| kinds.contains(&mesh.kind(cell))));
        if kinds[0] != CellKind::Tri6 {
            // 3 × 3 cells on either side of the cut.
            assert_eq!(mesh.cell_count(), 18);
            let inner = if kinds[0] == CellKind::Quad9 { 18 } else { 0 };
            assert_eq!(mesh.nodes().len(), 4 * 7 + 4 * 6 + 3 * 7 + inner);
        }
        is_the_plate(&mesh, quadratic_hole(), 2.0 * PI, CURVED);
    }
}

#[test]
fn a_plate_of_mixed_linear_cells() {
    let mesh = mesh(&files!("mixed", "2a", "2b", "4a", "4b"));
    let count = |kind| {
        (0..mesh.cell_count())
            .filter(|&cell| mesh.kind(cell) == kind)
            .count()
    };
    assert_eq!(count(CellKind::Quad4), 9);
    assert_eq!(count(CellKind::Quad4) + count(CellKind::Tri3), 31);
    // Six chords of 15°.
    let half = (PI / 24.0).sin();
    let hole = 48.0 * (PI / 12.0).sin();
    is_the_plate(&mesh, hole, 48.0 * half, PLACING);
}

#[test]
fn parameters_and_partitions_change_nothing() {
    let plain = mesh::<2>(&files!("tri6", "4a"));
    assert!(mesh(&files!("parametric", "4a", "4b")) == plain);
    assert!(mesh(&files!("partitioned", "4a", "4b")) == plain);
    // Here Gmsh numbers the nodes anew.
    let mesh = mesh::<2>(&files!("partitioned", "2a"));
    assert_eq!(mesh.cell_count(), plain.cell_count());
    is_the_plate(&mesh, quadratic_hole(), 2.0 * PI, CURVED);
}

#[test]
fn lines_may_end_as_on_windows() {
    for file in files!("mixed", "2a", "4a") {
        let text = String::from_utf8_lossy(file).replace('\n', "\r\n");
        assert!(read_gmsh::<2>(text.as_bytes()) == read_gmsh::<2>(file));
    }
}

#[test]
fn without_physical_groups_all_is_one() {
    let mesh = mesh::<2>(&files!("periodic", "2a", "2b", "4a", "4b"));
    assert!(mesh.group_names().eq(["mesh"]));
    assert_abs_diff_eq!(
        measure(&mesh, "mesh", &PlaneStrain::default()),
        1.0,
        epsilon = PLACING
    );
    assert_eq!(
        mesh.bounds(),
        ([0.0; 2], [1.0; 2]),
        "its plane is z = 3: {:?}",
        mesh.nodes()
    );
}

/// The box of 2 × 3 × 5 mm, cut at z = 2, with so many nodes on its edge below the cut.
fn is_the_box(mesh: &Mesh<3>, on_edge: usize) {
    assert!(mesh.group_names().eq([
        "base",
        "box",
        "box.boundary",
        "edge",
        "interface",
        "lower",
        "tip",
        "upper"
    ]));
    for (group, volume) in [("box", 30.0), ("lower", 12.0), ("upper", 18.0)] {
        assert_abs_diff_eq!(measure(mesh, group, &Solid), volume, epsilon = PLACING);
    }
    let (area, normal) = surface(mesh, "base", &Solid);
    assert_abs_diff_eq!(area, 6.0, epsilon = PLACING);
    assert_abs_diff_eq!(normal[..], [0.0, 0.0, -6.0][..], epsilon = PLACING);
    let (area, _) = surface(mesh, "interface", &Solid);
    assert_abs_diff_eq!(area, 6.0, epsilon = PLACING);
    // All but the base.
    let (area, normal) = surface(mesh, "box.boundary", &Solid);
    assert_abs_diff_eq!(area, 56.0, epsilon = PLACING);
    assert_abs_diff_eq!(normal[..], [0.0, 0.0, 6.0][..], epsilon = PLACING);
    let nodes = |group| {
        let nodes = mesh.node_group(group).expect("named");
        nodes
            .into_iter()
            .map(|node| mesh.nodes()[node])
            .collect::<Vec<_>>()
    };
    assert_eq!(nodes("tip"), [[2.0, 3.0, 5.0]]);
    let edge = nodes("edge");
    assert_eq!(edge.len(), on_edge);
    assert!(
        edge.iter()
            .all(|&[x, y, z]| x == 0.0 && y == 0.0 && z <= 2.0)
    );
}

#[test]
fn boxes_of_tetrahedra_and_hexahedra() {
    let tets = mesh(&files!("tet4", "2a", "2b", "4a", "4b"));
    assert!((0..tets.cell_count()).all(|cell| tets.kind(cell) == CellKind::Tet4));
    is_the_box(&tets, 3);
    let hexes = mesh(&files!("hex8", "2a", "2b", "4a", "4b"));
    assert!((0..hexes.cell_count()).all(|cell| hexes.kind(cell) == CellKind::Hex8));
    assert_eq!((hexes.cell_count(), hexes.nodes().len()), (16, 45));
    is_the_box(&hexes, 3);
}

/// The order of the nodes is that of Gmsh: in another one cells of straight sides are inverted, or
/// their facets are no facets.
#[test]
fn boxes_of_quadratic_tetrahedra_and_hexahedra() {
    for (files, kind, nodes) in [
        (files!("tet10", "2a", "4b"), CellKind::Tet10, None),
        (files!("hex20", "2a", "4b"), CellKind::Hex20, Some(141)),
        (files!("hex27", "2a", "4b"), CellKind::Hex27, Some(225)),
    ] {
        let mesh = mesh(&files);
        assert!((0..mesh.cell_count()).all(|cell| mesh.kind(cell) == kind));
        assert!(
            nodes.is_none_or(|count| count == mesh.nodes().len()),
            "{kind}"
        );
        is_the_box(&mesh, 5);
        // Straight: every node is the image of its reference by the cell's trilinear map.
        for cell in 0..mesh.cell_count() {
            let x: Vec<[f64; 3]> = mesh
                .cell_nodes(cell)
                .iter()
                .map(|&a| mesh.nodes()[a])
                .collect();
            for (x_a, xi) in x.iter().zip(kind.reference_nodes()) {
                let xi = [xi[0], xi[1], xi[2]];
                let corners = match kind {
                    CellKind::Tet10 => Tet4::shape(xi).to_vec(),
                    _ => Hex8::shape(xi).to_vec(),
                };
                for i in 0..3 {
                    let straight: f64 = corners.iter().zip(&x).map(|(n, x)| n * x[i]).sum();
                    assert_abs_diff_eq!(x_a[i], straight, epsilon = PLACING);
                }
            }
        }
    }
}

#[test]
fn a_file_is_read_in_its_dimension_only() {
    let [hex] = files!("hex8", "2a");
    assert!(matches!(
        read_gmsh::<2>(hex),
        Err(ReadError::Dimension {
            found: 3,
            expected: 2,
            ..
        })
    ));
    let [plate] = files!("tri6", "4b");
    assert_eq!(
        read_gmsh::<3>(plate),
        Err(ReadError::NoCells {
            dimension: 3,
            elements: 65
        })
    );
}

/// Bytes of a binary file, of either order.
struct Binary {
    bytes: Vec<u8>,
    big_endian: bool,
}

impl Binary {
    fn new(version: &str, big_endian: bool) -> Self {
        let bytes = format!("$MeshFormat\n{version} 1 8\n").into_bytes();
        let mut binary = Self { bytes, big_endian };
        binary.int(1);
        binary.text("\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"steel\"\n$EndPhysicalNames\n");
        binary
    }

    fn text(&mut self, text: &str) {
        self.bytes.extend(text.bytes());
    }

    fn put<const N: usize>(&mut self, mut little_endian: [u8; N]) {
        if self.big_endian {
            little_endian.reverse();
        }
        self.bytes.extend(little_endian);
    }

    fn int(&mut self, value: i32) {
        self.put(value.to_le_bytes());
    }

    fn ints(&mut self, values: &[i32]) {
        values.iter().for_each(|&value| self.int(value));
    }

    fn sizes(&mut self, values: &[u64]) {
        values
            .iter()
            .for_each(|&value| self.put(value.to_le_bytes()));
    }

    fn reals(&mut self, values: &[f64]) {
        values
            .iter()
            .for_each(|&value| self.put(value.to_le_bytes()));
    }

    /// A triangle of nodes 10, 20 and 4000000 in the group "steel", in version 2.2.
    fn triangle2(big_endian: bool) -> Vec<u8> {
        let mut file = Self::new("2.2", big_endian);
        file.text("$Nodes\n3\n");
        for (number, x) in TRIANGLE {
            file.int(number as i32);
            file.reals(&x);
        }
        file.text("\n$EndNodes\n$Elements\n1\n");
        file.ints(&[2, 1, 2, 5, 7, 1, 10, 20, 4_000_000]);
        file.text("\n$EndElements\n");
        file.bytes
    }

    /// The same in version 4.1.
    fn triangle4(big_endian: bool) -> Vec<u8> {
        let mut file = Self::new("4.1", big_endian);
        file.text("$Elements\n");
        file.sizes(&[1, 1, 5, 5]);
        file.ints(&[2, 1, 2]);
        file.sizes(&[1, 5, 10, 20, 4_000_000]);
        file.text("\n$EndElements\n$Entities\n");
        file.sizes(&[0, 0, 1, 0]);
        file.int(1);
        file.reals(&[0.0; 6]);
        file.sizes(&[1]);
        file.int(-7);
        file.sizes(&[0]);
        file.text("\n$EndEntities\n$Nodes\n");
        file.sizes(&[1, 3, 10, 4_000_000]);
        file.ints(&[2, 1, 0]);
        file.sizes(&[3]);
        file.sizes(&TRIANGLE.map(|node| node.0));
        TRIANGLE.iter().for_each(|node| file.reals(&node.1));
        file.text("\n$EndNodes\n");
        file.bytes
    }
}

const TRIANGLE: [(u64, [f64; 3]); 3] = [
    (4_000_000, [0.0, 4.0, 1.0]),
    (10, [0.0, 0.0, 1.0]),
    (20, [3.0, 0.0, 1.0]),
];

#[test]
fn both_byte_orders_and_sections_in_any_order() {
    for big_endian in [false, true] {
        let meshes =
            [Binary::triangle2, Binary::triangle4].map(|file| read_gmsh::<2>(&file(big_endian)));
        for mesh in meshes {
            let mesh = mesh.expect("readable");
            assert_eq!(mesh.nodes(), [[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]]);
            assert_eq!(mesh.cell_group("steel"), Ok(&[0][..]));
        }
    }
}

/// A file of version 2.2 in text: two unit squares side by side, the right one clockwise, the
/// names and elements given, and a comment.
fn squares(names: &str, elements: &[&str]) -> String {
    let count = names.lines().count();
    let mut file = format!(
        "$Comments\n$Nodes is not here\n$EndComments\n$MeshFormat\n2.2 0 8\n$EndMeshFormat\n\
         $PhysicalNames\n{count}\n{names}\n$EndPhysicalNames\n$Nodes\n7\n\
         1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 5 5 5\n$EndNodes\n\
         $Elements\n{}\n",
        elements.len()
    );
    for (number, element) in (1..).zip(elements) {
        file.push_str(&format!("{number} {element}\n"));
    }
    file + "$EndElements\n"
}

const LEFT: &str = "3 2 1 1 1 2 5 4";
const RIGHT: &str = "3 2 1 1 2 5 6 3";

#[test]
fn one_name_for_all_dimensions_becomes_three() {
    let names = "0 1 \"a\"\n1 1 \"a\"\n2 1 \"a\"\n1 2 \"a.boundary\"";
    let elements = [
        LEFT,
        RIGHT,
        "1 2 1 1 1 2",
        "1 2 2 1 5 4",
        "15 2 1 1 6",
        "1 2 9 1 3 6",
    ];
    let mesh = read_gmsh::<2>(squares(names, &elements).as_bytes()).expect("readable");
    let names = ["9", "a", "a.boundary", "a.boundary.boundary", "a.nodes"];
    assert!(mesh.group_names().eq(names));
    assert_eq!(mesh.cell_group("a"), Ok(&[0, 1][..]));
    assert_eq!(mesh.node_group("a.boundary"), Ok(vec![3, 4]));
    assert_eq!(mesh.node_group("a.boundary.boundary"), Ok(vec![0, 1]));
    assert_eq!(mesh.node_group("a.nodes"), Ok(vec![5]));
    // Nodes 3 and 6 of the file: a side of the cell that was clockwise.
    let (_, normal) = surface(&mesh, "9", &PlaneStrain::default());
    assert_abs_diff_eq!(normal[..], [1.0, 0.0][..], epsilon = ROUND_OFF);
    assert_eq!(mesh.cell_nodes(1), [1, 2, 5, 4]);
}

#[test]
fn a_cell_turned_round_and_written_twice_is_one() {
    let names = "2 1 \"all\"\n2 2 \"left\"";
    let elements = [LEFT, RIGHT, "3 2 -2 1 1 4 5 2", "3 2 0 1 1 2 5 4"];
    let mesh = read_gmsh::<2>(squares(names, &elements).as_bytes()).expect("readable");
    assert_eq!(mesh.cell_count(), 2);
    assert_eq!(mesh.cell_group("all"), Ok(&[0, 1][..]));
    assert_eq!(mesh.cell_group("left"), Ok(&[0][..]));
}

#[test]
fn cells_without_group_are_left_out_where_others_have_one() {
    let elements = ["3 2 0 1 1 2 5 4", RIGHT];
    let mesh = read_gmsh::<2>(squares("2 1 \"right\"", &elements).as_bytes()).expect("readable");
    assert_eq!(mesh.nodes().len(), 4);
    assert_eq!(mesh.cell_group("right"), Ok(&[0][..]));
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let read = |elements: &[&str]| read_gmsh::<2>(squares("1 3 \"top\"", elements).as_bytes());
    let edge = read(&[LEFT, "1 2 3 1 5 6"]);
    assert_eq!(
        edge,
        Err(ReadError::FacetWithoutCell {
            group: "top".into(),
            element: 2,
            nodes: vec![5, 6],
        })
    );
    assert_eq!(
        read(&["18 2 1 1 1 2 3 4 5 6 7 1 2 3"])
            .unwrap_err()
            .to_string(),
        "line 23: the element type 18 (prism of 15 nodes) is not read here: use points (15), \
         lines of 2 (1) and 3 nodes (8), triangles of 3 (2) and 6 nodes (9), quadrangles of 4 (3), \
         8 (16) and 9 nodes (10), tetrahedra of 4 (4) and 10 nodes (11), hexahedra of 8 (5), 20 \
         (17) and 27 nodes (12)"
    );
    assert_eq!(
        read(&["2 2 1 1 1 2 7"]),
        Err(ReadError::NotPlanar {
            node: 7,
            z: 5.0,
            plane: 0.0
        })
    );
    assert_eq!(
        read(&["2 2 1 1 1 2 8"]),
        Err(ReadError::UnknownNode {
            element: 1,
            node: 8
        })
    );
    assert!(matches!(
        read(&[RIGHT, "2 2 1 1 1 2 3"]),
        Err(ReadError::Mesh {
            element: Some(2),
            source: MeshError::DegenerateCell { cell: 0, .. }
        })
    ));
    assert_eq!(
        read(&["2 2 1 1 1 2 five"]),
        Err(ReadError::Unexpected {
            place: Place::Line(23),
            found: "five".into(),
            expected: "the number of a node".into()
        })
    );
    let two = squares("1 3 \"top\"", &[LEFT]).replace("2 1 0 0\n", "1 1 0 0\n");
    assert_eq!(
        read_gmsh::<2>(two.as_bytes()),
        Err(ReadError::DuplicateNode { node: 1 })
    );
    let far = squares("1 3 \"top\"", &[LEFT]).replace("2 1 0 0\n", "2 inf 0 0\n");
    assert!(matches!(
        read_gmsh::<2>(far.as_bytes()),
        Err(ReadError::Unexpected { .. })
    ));
    let mesh = read(&[LEFT]).expect("readable");
    assert!(matches!(
        mesh.facet_group("1"),
        Err(MeshError::WrongGroup {
            found: GroupKind::Cells,
            ..
        })
    ));
}

#[test]
fn other_versions_are_refused_by_number() {
    for version in ["1.0", "2.1", "4", "4.0", "5"] {
        let file = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        assert_eq!(
            read_gmsh::<2>(file.as_bytes()).unwrap_err().to_string(),
            format!("line 2: MSH version {version} is not read: save the mesh as MSH 2.2 or 4.1")
        );
    }
    for file in [
        "",
        "mesh",
        "$Nodes\n",
        "$NOD\n1\n$ENDNOD\n",
        "$MeshFormat\n2.2 2 8\n",
    ] {
        assert!(read_gmsh::<2>(file.as_bytes()).is_err(), "{file:?}");
    }
}

#[test]
fn an_absurd_count_reserves_no_memory() {
    let file = squares("1 3 \"top\"", &[LEFT]).replace("$Nodes\n7\n", "$Nodes\n2000000000\n");
    assert!(matches!(
        read_gmsh::<2>(file.as_bytes()),
        Err(ReadError::TooMany {
            place: Place::Line(13),
            what: "nodes",
            count: 2_000_000_000,
            ..
        })
    ));
    let mut file = Binary::new("4.1", false);
    file.text("$Elements\n");
    file.sizes(&[1, 1, 5, 5]);
    file.ints(&[2, 1, 2]);
    file.sizes(&[u64::MAX]);
    let place = Place::Byte(file.bytes.len());
    assert_eq!(
        read_gmsh::<2>(&file.bytes),
        Err(ReadError::TooMany {
            place,
            what: "elements",
            count: u64::MAX,
            remaining: 0
        })
    );
}
