//! Files that Gmsh wrote (`tests/data/make.py`) are the meshes they were made to be, in every encoding.

use approx::assert_abs_diff_eq;
use moreau_mesh::{
    CellKind, Element, Hex8, Hypothesis, Mesh, PlaneStrain, ReadError, Solid, Tet4, read_gmsh,
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
pub(super) fn surface<const D: usize, H: Hypothesis<D>>(
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
