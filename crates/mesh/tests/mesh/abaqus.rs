//! Input files of Abaqus and CalculiX, written by hand: cells, sets, and the sides of surfaces.

use crate::{ROUND_OFF, reference_cell};
use approx::assert_abs_diff_eq;
use moreau_mesh::{
    Axisymmetric, CellKind, GroupKind, Mesh, MeshError, Place, PlaneStrain, ReadError, Solid,
    read_abaqus,
};
use std::f64::consts::PI;

/// A punch of one quadratic cell on a block of two linear ones, and what else is in such a file.
pub(crate) const DECK: &str = "*HEADING
 A punch on a block, * of two parts, 1, 2, 3
** the block
*Node, NSET=Nall
    1,  0.,    0.
    2,  1.0D0, 0., 0.
    3,  2.,    ,
    4,  0., 1.
    5,  1., 1.
    6,  2., 1.
*NODE,
 nset=\"nPunch\"
 11, 0.5, 1.
 12, 1.5, 1.
 13, 1.5, 2.
 14, 0.5, 2.
 15, 1., 1.
 16, 1.5, 1.5
 17, 1., 2.0e0
 18, .5, 1.5
 99, 7., 7.
*Element, type=CPE4R, elset=Block
 1, 1, 2, 5, 4
** clockwise: S1 is still 2-5, S2 is 5-6
 2, 2, 5, 6, 3
*ELEMENT, TYPE=CPE8, ELSET=punch
 7, 11, 12, 13, 14,
 15, 16, 17, 18
*NSET, NSET=bottom, GENERATE
 1, 3
*NSET, NSET=sides
 1, 4
 3, 6,
*NSET, NSET=odd, GENERATE
 1, 17, 2
*NSET, NSET=Bottom
 NPUNCH
*NSET, NSET=reference
 99
*NSET, NSET=of block, ELSET=block
*ELSET, ELSET=all
 BLOCK, 7
*ELSET, ELSET=_top_S3, INTERNAL, INSTANCE=part-1
 1
*SURFACE, NAME=punch, TYPE=ELEMENT
 punch, S1
*Surface, name=top
 _top_S3, S3
 2, s2
*SURFACE, NAME=free
 BLOCK,
*SURFACE, NAME=slave, TYPE=NODE
 nPunch, 1.
 4
*MATERIAL, NAME=steel
*ELASTIC
 210000., 0.3
*STEP
*STATIC
 0.1, 1.
*NODE PRINT, NSET=sides
 U
*ELEMENT OUTPUT, ELSET=all
 S
*END STEP
";

#[test]
fn a_deck_of_two_bodies() {
    let mesh = read_abaqus::<2>(DECK).expect("readable");
    assert_eq!(read_abaqus(&DECK.replace('\n', "\r\n")), Ok(mesh.clone()));
    assert_eq!((mesh.cell_count(), mesh.nodes().len()), (3, 14));
    assert_eq!(mesh.kind(2), CellKind::Quad8);
    assert_eq!(mesh.bodies(), [vec![0, 1], vec![2]]);
    let plane = PlaneStrain::default();
    assert!(mesh.group_names().eq([
        "Block",
        "Nall",
        "all",
        "bottom",
        "free",
        "nPunch",
        "odd",
        "of block",
        "punch",
        "punch.boundary",
        "sides",
        "slave",
        "top",
    ]));
    for (group, area) in [("Block", 2.0), ("punch", 1.0), ("all", 3.0)] {
        let cells = mesh.cell_group(group).expect("named");
        assert_abs_diff_eq!(mesh.measure(cells, &plane), area, epsilon = ROUND_OFF);
    }
    for (group, length, normal) in [
        ("punch.boundary", 1.0, [0.0, -1.0]),
        ("top", 2.0, [0.0, 2.0]),
        ("free", 6.0, [0.0, 0.0]),
    ] {
        let facets = mesh.facet_group(group).expect("named");
        let shares = mesh.facet_shares(facets, &plane);
        let area: f64 = shares.iter().map(|share| share.area).sum();
        let sum: [f64; 2] =
            std::array::from_fn(|i| shares.iter().map(|share| share.normal[i]).sum());
        assert_abs_diff_eq!(area, length, epsilon = ROUND_OFF);
        assert_abs_diff_eq!(sum[..], normal[..], epsilon = ROUND_OFF);
    }
    assert_eq!(mesh.node_group("sides"), Ok(vec![0, 2, 3, 5]));
    assert_eq!(mesh.node_group("odd"), Ok(vec![0, 2, 4, 6, 8, 10, 12]));
    assert_eq!(mesh.node_group("of block"), Ok((0..6).collect()));
    // The set is added to, and called as first written.
    let bottom = [0, 1, 2].into_iter().chain(6..14).collect();
    assert_eq!(mesh.node_group("bottom"), Ok(bottom));
    assert_eq!(mesh.nodes()[2], [2.0, 0.0]);
}

/// Reference nodes in the order of the manual: corners as here, then the middles of the edges.
fn listed<const D: usize>(kind: CellKind) -> Vec<[f64; D]> {
    let edges: &[[usize; 2]] = match kind {
        CellKind::Tet10 => &[[1, 2], [2, 3], [3, 1], [1, 4], [2, 4], [3, 4]],
        CellKind::Hex20 => &[
            [1, 2],
            [2, 3],
            [3, 4],
            [4, 1],
            [5, 6],
            [6, 7],
            [7, 8],
            [8, 5],
            [1, 5],
            [2, 6],
            [3, 7],
            [4, 8],
        ],
        _ => return reference_cell(kind),
    };
    let mut nodes = reference_cell::<D>(kind);
    nodes.truncate(kind.corner_count());
    for [a, b] in edges {
        nodes.push(std::array::from_fn(|i| {
            0.5 * (nodes[a - 1][i] + nodes[b - 1][i])
        }));
    }
    nodes
}

/// One cell on its reference nodes, of a given type, in either orientation.
fn single<const D: usize>(kind: CellKind, element: &str, mirror: bool) -> String {
    let mut text = "*NODE\n".to_owned();
    for (number, x) in (1..).zip(listed::<D>(kind)) {
        let sign = if mirror { -1.0 } else { 1.0 };
        let x: Vec<String> = (0..D)
            .map(|i| (if i == 0 { sign * x[0] } else { x[i] }).to_string())
            .collect();
        text += &format!("{number}, {}\n", x.join(", "));
    }
    let nodes: Vec<String> = (1..=kind.nodes()).map(|node| node.to_string()).collect();
    text += &format!("*ELEMENT, TYPE={element}\n1, {}\n", nodes.join(", "));
    for (side, _) in kind.facets().iter().enumerate() {
        let side = side + 1;
        text += &format!("*SURFACE, NAME=S{side}\n1, S{side}\n");
    }
    text
}

/// The sides of a cell have the corners that the manual of the element gives them, whatever the
/// orientation of the cell.
fn has_sides<const D: usize>(kind: CellKind, element: &str, sides: &[&[usize]]) {
    assert_eq!(sides.len(), kind.facets().len());
    for mirror in [false, true] {
        let mesh: Mesh<D> = read_abaqus(&single::<D>(kind, element, mirror)).expect("readable");
        assert_eq!(mesh.kind(0), kind);
        assert!(mesh.group_names().any(|name| name == "mesh"));
        for (i, corners) in sides.iter().enumerate() {
            let facets = mesh.facet_group(&format!("S{}", i + 1)).expect("named");
            let [facet] = facets[..] else {
                panic!("one side, not {facets:?}");
            };
            let count = mesh.facet_kind(facet).corner_count();
            let mut found: Vec<usize> = mesh.facet_nodes(facet).take(count).collect();
            found.sort_unstable();
            let mut expected: Vec<usize> = corners.iter().map(|corner| corner - 1).collect();
            expected.sort_unstable();
            assert_eq!(found, expected, "{element} S{}", i + 1);
        }
    }
}

#[test]
fn sides_are_numbered_as_in_the_manual() {
    let triangle: &[&[usize]] = &[&[1, 2], &[2, 3], &[3, 1]];
    let quadrangle: &[&[usize]] = &[&[1, 2], &[2, 3], &[3, 4], &[4, 1]];
    for family in ["CPE", "cps", "CAX"] {
        has_sides::<2>(CellKind::Tri3, &format!("{family}3"), triangle);
        has_sides::<2>(CellKind::Tri6, &format!("{family}6M"), triangle);
        has_sides::<2>(CellKind::Quad4, &format!("{family}4RH"), quadrangle);
        has_sides::<2>(CellKind::Quad8, &format!("{family}8R"), quadrangle);
    }
    let tetrahedron: &[&[usize]] = &[&[1, 2, 3], &[1, 4, 2], &[2, 4, 3], &[3, 4, 1]];
    has_sides::<3>(CellKind::Tet4, "C3D4", tetrahedron);
    has_sides::<3>(CellKind::Tet10, "C3D10M", tetrahedron);
    let hexahedron: &[&[usize]] = &[
        &[1, 2, 3, 4],
        &[5, 8, 7, 6],
        &[1, 5, 6, 2],
        &[2, 6, 7, 3],
        &[3, 7, 8, 4],
        &[4, 8, 5, 1],
    ];
    has_sides::<3>(CellKind::Hex8, "C3D8R", hexahedron);
    has_sides::<3>(CellKind::Hex20, "C3D20RH", hexahedron);
}

#[test]
fn volumes_in_space_and_of_revolution() {
    let mesh = read_abaqus::<3>(&single::<3>(CellKind::Hex8, "C3D8", true)).expect("readable");
    assert_abs_diff_eq!(mesh.measure(&[0], &Solid), 8.0, epsilon = ROUND_OFF);
    let text = "*NODE\n1, 1, 0\n2, 3, 0\n3, 3, 5\n4, 1, 5\n*ELEMENT, TYPE=CAX4\n1, 1, 2, 3, 4\n";
    let mesh = read_abaqus::<2>(text).expect("readable");
    let volume = mesh.measure(&[0], &Axisymmetric);
    assert_abs_diff_eq!(volume, 40.0 * PI, epsilon = 1e2 * ROUND_OFF);
}

/// The deck of this file with lines behind it, and the number of the first of them.
fn with_tail(tail: &str) -> Result<Mesh<2>, ReadError> {
    read_abaqus::<2>(&format!("{DECK}{tail}\n"))
}

fn first_line_of_tail() -> usize {
    DECK.lines().count() + 1
}

#[test]
fn what_is_not_read_is_said_with_its_line_and_a_way_out() {
    let line = first_line_of_tail();
    for (text, expected) in [
        ("*INCLUDE, INPUT=a.inp", "put the file's text in its place"),
        ("*NGEN", "write all nodes and elements out"),
        (
            "*INSTANCE, NAME=a\n1., 0.",
            "write all bodies into one part, in place",
        ),
    ] {
        let error = with_tail(text).unwrap_err().to_string();
        assert!(error.starts_with(&format!("line {line}: *")), "{error}");
        assert!(error.ends_with(expected), "{error}");
    }
    assert_eq!(
        with_tail("*ELEMENT, TYPE=C3D15").unwrap_err().to_string(),
        format!(
            "line {line}: the element type C3D15 is not read here: use CPE3, CPE4, CPE6, CPE8, or \
             CAX or CPS instead of CPE,"
        )
    );
}

#[test]
fn what_does_not_exist_is_said_with_its_line() {
    let next = Place::Line(first_line_of_tail() + 1);
    assert_eq!(
        with_tail("*ELSET, ELSET=x\nblok"),
        Err(ReadError::UnknownSet {
            place: next,
            kind: GroupKind::Cells,
            name: "blok".into(),
            nearest: Some("Block".into())
        })
    );
    assert_eq!(
        with_tail("*NSET, NSET=x\n1, 77"),
        Err(ReadError::UnknownMember {
            place: next,
            kind: GroupKind::Nodes,
            number: 77
        })
    );
    assert_eq!(
        with_tail("*SURFACE, NAME=x\nall, S5"),
        Err(ReadError::NoSuchSide {
            place: next,
            element: 1,
            kind: CellKind::Quad4,
            side: "S5".into()
        })
    );
}

#[test]
fn nodes_and_elements_that_do_not_fit_are_said_by_number() {
    assert_eq!(
        with_tail("*ELEMENT, TYPE=CPE3\n1, 1, 2, 6"),
        Err(ReadError::DuplicateElement { element: 1 })
    );
    assert_eq!(
        with_tail("*NODE\n1, 8, 8"),
        Err(ReadError::DuplicateNode { node: 1 })
    );
    assert_eq!(
        with_tail("*ELEMENT, TYPE=CPE3\n31, 1, 2, 66"),
        Err(ReadError::UnknownNode {
            element: 31,
            node: 66
        })
    );
    assert!(matches!(
        with_tail("*ELEMENT, TYPE=CPE3\n31, 1, 2, 3"),
        Err(ReadError::Mesh {
            element: Some(31),
            source: MeshError::DegenerateCell { .. }
        })
    ));
}

#[test]
fn lines_that_are_not_of_the_format_are_refused() {
    for text in [
        "*ELEMENT",
        "*ELEMENT, TYPE=CPE3\n31, 1, 2",
        "*ELEMENT, TYPE=CPE3\n31, 1, 2, 4, 5",
        "*ELEMENT, TYPE=CPE3\n31, 1, 2,",
        "*NODE\n31, one",
        "*NODE\n31, nan",
        "*NODE\n-31, 1.",
        "*NSET",
        "*NSET, NSET=x, GENERATE\n1, 5, 0",
        "*NSET, NSET=x, GENERATE\n5, 1",
    ] {
        assert!(
            matches!(with_tail(text), Err(ReadError::Unexpected { .. })),
            "{text}: {:?}",
            with_tail(text)
        );
    }
    assert!(matches!(
        with_tail("*NODE, SYSTEM=C\n31, 1., 0."),
        Err(ReadError::Unsupported { .. })
    ));
    assert!(matches!(
        read_abaqus::<2>("1, 2\n*NODE"),
        Err(ReadError::Unexpected { .. })
    ));
    assert!(matches!(
        read_abaqus::<2>(""),
        Err(ReadError::NoCells { .. })
    ));
    // A range over more numbers than there could ever be nodes.
    assert!(with_tail("*NSET, NSET=x, GENERATE\n1, 18000000000000000000").is_ok());
}
