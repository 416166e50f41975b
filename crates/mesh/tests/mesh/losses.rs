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

/// Materials, conditions and steps are no mesh, and cells of plane stress none of plane strain: all are noted
/// with their lines.
#[test]
fn of_abaqus_what_is_no_mesh() {
    let text = "*HEADING
*NODE
1, 0., 0.
2, 3., 0.
3, 0., 4.
4, 3., 4.
*ELEMENT, TYPE=CPS3, ELSET=steel
1, 1, 2, 3
2, 2, 4, 3
*SOLID SECTION, ELSET=steel, MATERIAL=st
1.,
*MATERIAL, NAME=st
*ELASTIC
210000., 0.3
*MATERIAL, NAME=al
*ELASTIC
70000., 0.3
*BOUNDARY
1, 1, 2
*STEP
*STATIC
*BOUNDARY
4, 1, 1, 0.1
*NODE PRINT, NSET=all
U
*END STEP
";
    let (mesh, losses) = read_abaqus_noting::<2>(text).expect("a mesh");
    assert_eq!(mesh.cell_count(), 2);
    let sections = |about, line, keywords: &[(&str, usize)]| Loss::Sections {
        about,
        keywords: keywords.iter().map(|&(k, n)| (k.to_owned(), n)).collect(),
        line,
    };
    let expected = [
        Loss::PlaneStress {
            element: "CPS3".into(),
            elements: 2,
            line: 7,
        },
        sections("sections of cells", 10, &[("SOLID SECTION", 1)]),
        sections("materials", 12, &[("ELASTIC", 2), ("MATERIAL", 2)]),
        sections("conditions and loads", 18, &[("BOUNDARY", 1)]),
        sections(
            "steps and all that is in them",
            20,
            &[
                ("BOUNDARY", 1),
                ("END STEP", 1),
                ("NODE PRINT", 1),
                ("STATIC", 1),
                ("STEP", 1),
            ],
        ),
    ];
    assert_eq!(losses, expected);
    assert_eq!(
        losses[2].to_string(),
        "materials are not read, from line 12 on: 2 *ELASTIC, 2 *MATERIAL"
    );
    assert!(
        losses[0]
            .to_string()
            .starts_with("2 elements of type CPS3, from line 7 on,")
    );
}
