//! Small Gmsh files by hand, for what Gmsh does not write here: the other byte order, names of several
//! dimensions, cells written twice, and mistakes.

use crate::ROUND_OFF;
use crate::gmsh::surface;
use approx::assert_abs_diff_eq;
use moreau_mesh::{GroupKind, MeshError, Place, PlaneStrain, ReadError, read_gmsh};

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
