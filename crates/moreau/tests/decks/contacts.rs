//! Bodies in contact with each other: rings whose facets do not match, and a surface against itself.

use super::flat;
use moreau::deck::{Class, Given, Meshes, Problem, open, open_with};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;
use std::path::Path;

const RADIUS: f64 = 20.0;

/// Two quarters of rings of quad4, the inner one from half of the radius to that, the outer one from it to three halves, each of
/// so many cells.
fn rings(cells: [usize; 2]) -> String {
    let (mut nodes, mut elements) = (String::new(), String::new());
    let (mut node, mut element) = (0, 0);
    for (body, count) in cells.into_iter().enumerate() {
        let radii = [0.5, 1.0, 1.5].map(|part| part * RADIUS);
        let at = node + 1;
        for k in 0..=count {
            let (sine, cosine) = (FRAC_PI_2 * k as f64 / count as f64).sin_cos();
            for r in &radii[body..body + 2] {
                node += 1;
                writeln!(nodes, "{node} {:?} {:?} 0", r * cosine, r * sine).expect("room");
            }
        }
        let mut add = |kind: usize, group: usize, at: &[usize]| {
            element += 1;
            let at: Vec<String> = at.iter().map(usize::to_string).collect();
            writeln!(
                elements,
                "{element} {kind} 2 {group} {group} {}",
                at.join(" ")
            )
            .expect("room");
        };
        for k in 0..count {
            let a = at + 2 * k;
            add(3, 1 + body, &[a, a + 1, a + 3, a + 2]);
            // The outside of the inner ring, and the inside of the outer one.
            add(1, 3 + body, &[a + 1 - body, a + 3 - body]);
        }
        let b = at + 2 * count;
        add(1, 5, &[at, at + 1]);
        add(1, 6, &[b, b + 1]);
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n2 1 \"inner\"\n2 2 \"outer\"\n1 3 \"out\"\n1 4 \"in\"\n\
         1 5 \"flat\"\n1 6 \"tall\"\n$EndPhysicalNames\n$Nodes\n{node}\n{nodes}$EndNodes\n\
         $Elements\n{element}\n{elements}$EndElements\n"
    )
}

/// What is said of such rings that press on each other, the least gap, and whether a contact was found there.
fn fit(cells: [usize; 2], [surface, against]: [&str; 2]) -> (String, f64, bool) {
    let given = Given {
        meshes: Meshes::from([("rings.msh".into(), rings(cells).into_bytes())]),
        ..Given::default()
    };
    let text = format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = {{ file = "rings.msh" }}
material = [{{ on = ["inner", "outer"], young = 200e3, poisson = 0.3 }}]
contact = [{{ surface = "{surface}", against = "{against}", friction = 0.2 }}]
[[step]]
name = "fit"
increments = 1
fix = [{{ on = "flat", u = ["y"] }}, {{ on = "tall", u = ["x"] }}]
"#
    );
    let (_, problem, findings) = open_with(&text, Path::new(""), &given);
    let said = flat(&findings.render("deck", &text, false));
    let Some(Problem::Plane(setup)) = problem else {
        panic!("{said}")
    };
    (said, setup.gaps[0].gap, setup.gaps[0].met)
}

/// A chord of a circle is inside of it by 2/3 of its sagitta in the mean. Where the facets of the outer ring are the shorter ones
/// its nodes are outside of the inner one and those of the inner one within the outer one, by its sagitta of 0.126 mm, and the
/// rings are apart in the mean: nothing overlaps, whichever is the surface.
#[test]
fn rings_whose_chords_are_apart_do_not_overlap() {
    let sagitta = |count: usize| RADIUS * (1.0 - (0.5 * FRAC_PI_2 / count as f64).cos());
    let mean = |cells: [usize; 2]| (sagitta(cells[0]) - sagitta(cells[1])) * 2.0 / 3.0;
    for sides in [["out", "in"], ["in", "out"]] {
        let (said, gap, met) = fit([6, 7], sides);
        assert!(!said.contains("overlap"), "{said}");
        assert!(met && 0.0 < gap && gap < mean([6, 7]), "{sides:?}: {gap}");
        let (said, gap, met) = fit([7, 6], sides);
        assert!(
            said.contains("overlap") && said.contains("pushes apart"),
            "{said}"
        );
        assert!(met && gap < mean([7, 6]), "{sides:?}: {gap}");
    }
}

/// A strip that is bent small does not touch itself.
#[test]
fn a_surface_touches_itself_under_large_strains_alone() {
    let deck = |strain: &str| {
        format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
mesh.block = [{{ name = "s", element = "quad4", x = [0, 20], y = [0, 1], cells = [10, 1] }}]
material = [{{ on = "s", young = 2000.0, poisson = 0.3 }}]
contact = [{{ surface = "s.top", against = "s.top", friction = 0.2 }}]
[[step]]
name = "press"
increments = 1
fix = [{{ on = "s.left", u = ["x", "y"] }}]
load = [{{ on = "s.right", force = [0, 0.1] }}]
"#
        )
    };
    let (_, problem, findings) = open(&deck("small"));
    let said = flat(&findings.render("deck", &deck("small"), false));
    assert!(problem.is_none() && findings.errors() == 1, "{said}");
    for words in [
        "\"s.top\" against itself under small strains",
        "strain = \"finite\"",
        "deck:6:43",
    ] {
        assert!(said.contains(words), "{words:?} in {said}");
    }
    assert!(!said.contains("nodes of their own"), "{said}");
    let (_, problem, findings) = open(&deck("finite"));
    assert!(problem.is_some() && findings.iter().all(|f| f.class == Class::Warnings));
}
