//! Pictures of bodies: well-formed for every cell, curved where edges are, small, and errors for data
//! that do not fit.

use super::{block, texts};
use moreau::mesh::{CellKind, block2, block3, uniform};
use moreau::plot::{Mark, MeshPicture, PlotError};

const PLANE: [CellKind; 5] = [
    CellKind::Tri3,
    CellKind::Tri6,
    CellKind::Quad4,
    CellKind::Quad8,
    CellKind::Quad9,
];

#[test]
fn pictures_are_well_formed_for_every_plane_cell() {
    for kind in PLANE {
        let mesh = block(kind);
        let value = mesh.nodes().iter().map(|x| x[0] * x[1]).collect();
        let bend: Vec<[f64; 2]> = mesh
            .nodes()
            .iter()
            .map(|x| [0.0, 0.01 * x[0] * x[0]])
            .collect();
        let picture = MeshPicture::new(&mesh, "bent")
            .deformed(bend, 5.0)
            .field("xy [mm²]", value)
            .outline()
            .polyline(vec![[-1e9, 0.0], [1e9, 0.0], [f64::NAN, 1.0], [2.0, 2.5]]);
        let svg = picture.to_svg().expect("a picture");
        let texts = texts(&svg);
        for text in [
            "bent",
            "xy [mm²]",
            "0",
            "10.0",
            "displacement × 5",
            "0.5 mm",
        ] {
            assert!(texts.iter().any(|t| t == text), "{text} in {texts:?}");
        }
        assert_eq!(Ok(svg), picture.to_svg());
        let inches = self::texts(&picture.unit("in").to_svg().expect("a picture"));
        assert!(inches.iter().any(|t| t == "0.5 in"), "{inches:?}");
        self::texts(&MeshPicture::new(&mesh, "").to_svg().expect("a picture"));
    }
}

#[test]
fn curved_edges_are_curves() {
    let ring = block(CellKind::Quad8)
        .map(|x| {
            [
                (3.0 + x[1]) * (0.3 * x[0]).sin(),
                (3.0 + x[1]) * (0.3 * x[0]).cos(),
            ]
        })
        .expect("a mesh");
    let svg = MeshPicture::new(&ring, "").to_svg().expect("a picture");
    assert!(svg.contains('q'));
    let straight = MeshPicture::new(&block(CellKind::Quad8), "")
        .to_svg()
        .expect("a picture");
    let paths: Vec<&str> = straight.split(" d=\"").skip(1).collect();
    assert!(
        paths
            .iter()
            .all(|d| !d.split('"').next().unwrap_or("").contains('q'))
    );
}

#[test]
fn large_meshes_make_small_pictures() {
    let mesh = block2(
        "b",
        CellKind::Quad8,
        &uniform(0.0, 50.0, 112),
        &uniform(0.0, 20.0, 32),
    )
    .expect("a mesh");
    let wave = mesh
        .nodes()
        .iter()
        .map(|x| (3.0 * x[0]).sin() * (2.0 * x[1]).cos())
        .collect();
    let svg = MeshPicture::new(&mesh, "wave")
        .field("w", wave)
        .to_svg()
        .expect("a picture");
    assert!(svg.len() < 3_000_000, "{} bytes", svg.len());
    texts(&svg);
}

/// Both ends of a colour bar, and round values between that do not touch them.
#[test]
fn colour_bars_have_round_ticks_and_both_ends() {
    let mesh = block(CellKind::Quad8);
    let field: Vec<f64> = mesh.nodes().iter().map(|x| 0.3 + 4.54 * x[0]).collect();
    let picture = MeshPicture::new(&mesh, "").field("s [MPa]", field);
    let texts = texts(&picture.to_svg().expect("a picture"));
    let ticks: Vec<&str> = texts.iter().map(String::as_str).collect();
    for tick in ["0.3", "5", "10", "15", "20", "23.0"] {
        assert!(ticks.contains(&tick), "{tick} in {ticks:?}");
    }
    assert!(!ticks.contains(&"0") && !ticks.contains(&"25"));
}

#[test]
fn flattened_bodies_and_constant_fields_are_drawn() {
    let mesh = block(CellKind::Quad8);
    let flat: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| [0.0, -x[1]]).collect();
    texts(
        &MeshPicture::new(&mesh, "")
            .deformed(flat, 1.0)
            .to_svg()
            .expect("a picture"),
    );
    let point: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| [-x[0], -x[1]]).collect();
    texts(
        &MeshPicture::new(&mesh, "")
            .deformed(point, 1.0)
            .to_svg()
            .expect("a picture"),
    );
    for value in [0.0, 300.0, -1e-12] {
        let mut values = vec![value; mesh.nodes().len()];
        values[0] = f64::NAN;
        let picture = MeshPicture::new(&mesh, "").field("c", values);
        texts(&picture.to_svg().expect("a picture"));
    }
}

#[test]
fn data_that_do_not_fit_the_mesh_are_errors() {
    let mesh = block(CellKind::Quad4);
    let nodes = mesh.nodes().len();
    let picture = || MeshPicture::new(&mesh, "");
    let error = picture().field("f", vec![0.0; 3]).to_svg().unwrap_err();
    assert_eq!(
        error,
        PlotError::Length {
            what: "the field \"f\"".into(),
            found: 3,
            nodes
        }
    );
    let error = picture()
        .deformed(vec![[0.0; 2]; 2], 1.0)
        .to_svg()
        .unwrap_err();
    assert!(
        matches!(error, PlotError::Length { found: 2, .. }),
        "{error}"
    );
    let error = picture()
        .deformed(vec![[0.0, f64::NAN]; nodes], 1.0)
        .to_svg()
        .unwrap_err();
    assert!(
        matches!(error, PlotError::Displacement { node: 0, .. }),
        "{error}"
    );
    let error = picture()
        .deformed(vec![[1.0; 2]; nodes], f64::INFINITY)
        .to_svg()
        .unwrap_err();
    assert!(
        matches!(error, PlotError::Displacement { node: 0, .. }),
        "{error}"
    );
    for values in [
        vec![f64::NAN; nodes],
        (0..nodes).map(|k| [-1e308, 1e308][k % 2]).collect(),
    ] {
        let error = picture().field("f", values).to_svg().unwrap_err();
        assert_eq!(error, PlotError::NoValues { label: "f".into() });
    }
}

/// Of a block three sides are seen, whatever its cells: as many fills in the colours of the bar as sides have faces, and
/// none of the inner value.
#[test]
fn a_solid_is_drawn_by_what_is_seen_of_it() {
    for kind in [
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
    ] {
        let axis = || uniform(0.0, 2.0, 2);
        let mesh = block3("b", kind, &axis(), &axis(), &axis()).expect("a mesh");
        // 1 on what the eye sees, 0 on the sides behind.
        let front = |x: &[f64; 3]| f64::from(u8::from(x.iter().any(|v| *v > 1.99)));
        let values: Vec<f64> = mesh.nodes().iter().map(front).collect();
        let seen = |x: [f64; 3]| Mark::Support {
            at: x,
            from: [0.0, 1.0, 0.0],
        };
        let picture = MeshPicture::new(&mesh, "block")
            .field("seen [–]", values)
            .marks(vec![seen([1.0, 2.0, 1.0]), seen([1.0, 0.0, 1.0])])
            .veil(vec![
                [-1.0, 2.0, -1.0],
                [-1.0, 2.0, 1e9],
                [1e9, 2.0, 1e9],
                [1e9, 2.0, -1.0],
            ]);
        let svg = picture.to_svg().expect("a picture");
        let texts = texts(&svg);
        for text in ["block", "seen [–]", "x", "y", "z"] {
            assert!(texts.iter().any(|t| t == text), "{text} in {texts:?}");
        }
        // The support below is hidden.
        assert_eq!(svg.matches("<g opacity").count(), 1, "{kind}");
        assert_eq!(svg.matches("fill-opacity").count(), 1, "{kind}");
        assert_eq!(Ok(svg), picture.to_svg());
        // Seen from below against its normal: nothing of the marks on top.
        let below = mesh.facet_group("b.bottom").expect("a group").to_vec();
        let svg = MeshPicture::new(&mesh, "")
            .surface(below)
            .to_svg()
            .expect("a picture");
        let ticks = self::texts(&svg);
        assert!(
            ticks.contains(&"x".into())
                && ticks.contains(&"z".into())
                && !ticks.contains(&"y".into())
        );
    }
}

/// Where a text is written.
fn height(svg: &str, text: &str) -> f64 {
    let before = svg.split(&format!(">{text}<")).next().expect("a text");
    let y = before
        .rsplit(" y=\"")
        .next()
        .and_then(|y| y.split('"').next());
    y.and_then(|y| y.parse().ok()).expect("a place")
}

/// Labels at one place are beside each other.
#[test]
fn labels_do_not_cover_each_other() {
    let mesh = block(CellKind::Quad4);
    let label = |text: &str| Mark::Label {
        at: [1.0, 1.0],
        towards: [0.0, 1.0],
        text: text.into(),
        colour: "#333333",
    };
    let marks = vec![
        label("one of them"),
        label("two of them"),
        label("three of them"),
    ];
    let svg = MeshPicture::new(&mesh, "")
        .marks(marks)
        .to_svg()
        .expect("a picture");
    let height = |text: &str| height(&svg, text);
    let at = ["one of them", "two of them", "three of them"].map(height);
    for (i, a) in at.iter().enumerate() {
        assert!(at[..i].iter().all(|b| (a - b).abs() > 12.0), "{at:?}");
    }
}

/// A label that would be on supports is beside them.
#[test]
fn labels_do_not_cover_supports() {
    let mesh = block(CellKind::Quad4);
    let label = Mark::Label {
        at: [1.0, 1.0],
        towards: [0.0, 1.0],
        text: "a contact".into(),
        colour: "#333333",
    };
    // The sheet is the same for all.
    let highest = Mark::Dot {
        at: [1.0, 2.0],
        colour: "#333333",
    };
    let drawn = |support: Option<Mark>| {
        let marks = [label.clone(), highest.clone()].into_iter();
        let picture = MeshPicture::new(&mesh, "").marks(marks.chain(support).collect());
        height(&picture.to_svg().expect("a picture"), "a contact")
    };
    let alone = drawn(None);
    // Of supports up to there, some are where the text would be.
    let support = |y: f64| Mark::Support {
        at: [1.0, y],
        from: [0.0, 1.0],
    };
    let heights = (0..20).map(|k| drawn(Some(support(1.0 + 0.05 * f64::from(k)))));
    let moved = heights.filter(|y| (y - alone).abs() > 12.0).count();
    assert!(moved > 0 && moved < 20, "{moved}");
}
