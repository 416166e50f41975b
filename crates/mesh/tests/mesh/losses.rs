//! What a mesh file says and the mesh does not have is noted; what it has is not.

use moreau_mesh::{Loss, read_abaqus_noting, read_gmsh_noting};

/// Two triangles, of which the second is in no group; a point and a name that lead nowhere.
const GMSH: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
0 7 \"far\"
0 8 \"both\"
1 1 \"bottom\"
2 9 \"ghost\"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 3 0 0
3 0 4 0
4 3 4 0
5 9 9 0
$EndNodes
$Elements
6
1 1 2 1 1 1 2
2 2 2 2 1 1 2 3
3 2 2 0 1 2 4 3
4 15 2 7 1 5
5 15 2 8 1 1
6 15 2 8 1 4
$EndElements
";

fn group(name: &str, reason: &'static str) -> Loss {
    Loss::Group {
        name: name.into(),
        reason,
    }
}

#[test]
fn of_gmsh() {
    let (mesh, losses) = read_gmsh_noting::<2>(GMSH.as_bytes()).expect("a mesh");
    assert!(mesh.group_names().eq(["2", "both", "bottom"]));
    let expected = [
        Loss::Ungrouped {
            elements: 1,
            first: 3,
        },
        group("ghost", "no element of the file is in it"),
        Loss::Nodes {
            name: "both".into(),
            lost: 1,
            of: 2,
        },
        group("far", "none of its nodes belongs to a cell"),
    ];
    assert_eq!(losses, expected);
    // With the second triangle in the group, and the point on it, nothing is lost but the name.
    let whole = GMSH
        .replace("3 2 2 0 1 2 4 3", "3 2 2 2 1 2 4 3")
        .replace("4 15 2 7 1 5", "4 15 2 7 1 4");
    let (_, losses) = read_gmsh_noting::<2>(whole.as_bytes()).expect("a mesh");
    assert_eq!(losses, [group("ghost", "no element of the file is in it")]);
}

#[test]
fn of_abaqus() {
    let text = "
*NODE
1, 0., 0.
2, 3., 0.
3, 0., 4.
4, 9., 9.
*ELEMENT, TYPE=CPE3, ELSET=steel
1, 1, 2, 3
*NSET, NSET=some
1, 4
*NSET, NSET=none
4
*SURFACE, NAME=roll, TYPE=CYLINDER
*SURFACE, NAME=bottom
steel, S1
";
    let (mesh, losses) = read_abaqus_noting::<2>(text).expect("a mesh");
    assert!(mesh.group_names().eq(["bottom", "some", "steel"]));
    let expected = [
        group("roll", "its type is neither ELEMENT nor NODE"),
        Loss::Nodes {
            name: "some".into(),
            lost: 1,
            of: 2,
        },
        group("none", "none of its nodes belongs to a cell"),
    ];
    assert_eq!(losses, expected);
    let said: Vec<String> = losses.iter().map(Loss::to_string).collect();
    assert_eq!(
        said[1],
        "1 of the 2 nodes of the group \"some\" belong to no cell and are left out"
    );
}
