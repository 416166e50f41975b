//! Charts, pictures and nodal averages: well-formed, repeatable, exact where they should be, and
//! errors where nothing can be drawn; not their looks.

#[cfg(feature = "png")]
mod png;
mod recovery;

use moreau::driver::PointState;
use moreau::mesh::{
    CellKind, Element, Integration, Mesh, PlaneStrain, Quad4, Quad8, Tri3, Tri6, block2, uniform,
};
use moreau::plot::{Chart, MeshPicture, PlotError, Style, nodal_average};

/// Rounding of coordinates and sums.
const ROUND_OFF: f64 = 1e-12;

/// Reads a document without entities of its own, comments apart; returns its texts.
fn texts(svg: &str) -> Vec<String> {
    assert!(
        svg.starts_with("<svg ") && svg.ends_with("</svg>"),
        "one element, no prolog"
    );
    assert!(svg.contains(r#"xmlns="http://www.w3.org/2000/svg""#));
    assert!(
        !svg.contains(" id=") && !svg.contains("url(#"),
        "ids clash in a page"
    );
    assert!(
        !svg.contains("NaN") && !svg.contains("inf\""),
        "a coordinate is not a number"
    );
    let (mut open, mut texts) = (Vec::new(), Vec::new());
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let (text, tag) = rest.split_at(start);
        check_entities(text);
        if open.last() == Some(&"text") && !text.is_empty() {
            texts.push(text.into());
        }
        let end = tag.find('>').expect("a tag ends");
        let inside = &tag[1..end];
        rest = &tag[end + 1..];
        if inside.starts_with("!--") {
            assert!(inside.ends_with("--"));
        } else if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "tags are balanced");
        } else {
            let name = inside.split_whitespace().next().expect("a tag has a name");
            assert!(!inside.contains('<'));
            check_attributes(inside.trim_end_matches('/'), name);
            if !inside.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty() && rest.is_empty());
    texts
}

fn check_entities(text: &str) {
    for (k, _) in text.match_indices('&') {
        let known = ["&amp;", "&lt;", "&gt;", "&quot;", "&apos;", "&#39;"];
        assert!(known.iter().any(|e| text[k..].starts_with(e)), "{text}");
    }
}

fn check_attributes(tag: &str, name: &str) {
    let mut seen = Vec::new();
    let mut rest = tag[name.len()..].trim();
    while !rest.is_empty() {
        let (key, value) = rest
            .split_once("=\"")
            .expect("an attribute has a quoted value");
        let (value, after) = value.split_once('"').expect("the quote ends");
        check_entities(value);
        assert!(!seen.contains(&key), "{key} twice in <{name}>");
        seen.push(key);
        rest = after.trim();
    }
}

fn chart() -> Chart {
    Chart::new("Load", "displacement [mm]", "load [N]")
        .with(
            "coarse",
            Style::Line,
            [[0.0, 0.0], [0.01, 5e3], [0.02, 7e3]],
        )
        .with("fine", Style::Line, [[0.0, 0.0], [0.01, 4e3], [0.02, 6e3]])
        .with("measured", Style::Points, [[0.005, 2.5e3], [0.015, 5e3]])
        .with("both", Style::LinePoints, [[0.0, 1e3], [0.02, 5e3]])
        .with("limit load", Style::Dashed, [[0.0, 6.5e3], [0.02, 6.5e3]])
}

fn block(kind: CellKind) -> Mesh<2> {
    block2("block", kind, &uniform(0.0, 5.0, 5), &uniform(0.0, 2.0, 2)).expect("a mesh")
}

const PLANE: [CellKind; 5] = [
    CellKind::Tri3,
    CellKind::Tri6,
    CellKind::Quad4,
    CellKind::Quad8,
    CellKind::Quad9,
];

#[test]
fn charts_are_well_formed_and_named() {
    let texts = texts(&chart().to_svg().expect("a chart"));
    for text in [
        "Load",
        "displacement [mm]",
        "load [N]",
        "coarse",
        "limit load",
        "0.005",
        "8000",
    ] {
        assert!(texts.iter().any(|t| t == text), "{text} in {texts:?}");
    }
}

#[test]
fn equal_charts_are_equal_text_whatever_was_drawn_between() {
    let first = chart().to_svg();
    let _ = chart().log_y().to_svg();
    assert_eq!(first, chart().to_svg());
}

#[test]
fn text_is_escaped_and_never_mathematics() {
    let name = "a & b < c > \"d\" $\\mu$ \u{1}";
    let svg = Chart::new(name, name, name).with(name, Style::Line, [[0.0, 0.0], [1.0, 1.0]]);
    let texts = texts(&svg.to_svg().expect("a chart"));
    let escaped = "a &amp; b &lt; c &gt; &quot;d&quot; $\\mu$";
    assert_eq!(
        texts.iter().filter(|t| t.trim_end() == escaped).count(),
        4,
        "{texts:?}"
    );

    let mesh = block(CellKind::Quad4);
    let svg =
        MeshPicture::new(&mesh, "σ < 1 & \"p\"").field("<MPa>", vec![1.0; mesh.nodes().len()]);
    let texts = self::texts(&svg.to_svg().expect("a picture"));
    assert!(
        texts.iter().any(|t| t == "σ &lt; 1 &amp; &quot;p&quot;"),
        "{texts:?}"
    );
    assert!(texts.iter().any(|t| t == "&lt;MPa&gt;"), "{texts:?}");
}

#[test]
fn logarithmic_axes_reach_below_what_is_resolvable_in_linear_ones() {
    let residuals = [
        [0.0, 3e3],
        [1.0, 2e1],
        [2.0, 4e-3],
        [3.0, 1e-9],
        [4.0, 2e-13],
    ];
    let chart = Chart::new("Newton", "iteration", "residual [N]").log_y();
    let svg = chart
        .with("", Style::LinePoints, residuals)
        .to_svg()
        .expect("a chart");
    let texts = texts(&svg);
    assert!(
        texts.iter().any(|t| t == "10⁻¹²") && texts.iter().any(|t| t == "10⁴"),
        "{texts:?}"
    );
    // A line and five circles; the legend is empty.
    assert_eq!(svg.matches("<circle").count(), 5);
}

#[test]
fn points_that_cannot_be_drawn_are_left_out() {
    let points = [
        [0.0, 1.0],
        [1.0, f64::NAN],
        [2.0, -1.0],
        [3.0, 0.0],
        [f64::INFINITY, 1.0],
        [4.0, 9.0],
    ];
    let chart = Chart::new("", "x", "y")
        .log_y()
        .with("", Style::Points, points);
    assert_eq!(
        chart.to_svg().expect("a chart").matches("<circle").count(),
        2
    );
    // NaN interrupts a line: two pieces of two points each.
    let line = [
        [0.0, 1.0],
        [1.0, 2.0],
        [2.0, f64::NAN],
        [3.0, 2.0],
        [4.0, 1.0],
    ];
    let svg = Chart::new("", "x", "y")
        .with("", Style::Line, line)
        .to_svg()
        .expect("a chart");
    assert_eq!(svg.matches("<path").count(), 2);
}

#[test]
fn ranges_cut_off_what_is_outside() {
    let line = [[0.0, 0.0], [1.0, 10.0], [2.0, 0.0]];
    let chart = Chart::new("", "x", "y")
        .y_range(0.0, 5.0)
        .with("", Style::LinePoints, line);
    let svg = chart.to_svg().expect("a chart");
    assert_eq!(
        (svg.matches("<path").count(), svg.matches("<circle").count()),
        (2, 2)
    );
}

#[test]
fn constant_tiny_and_huge_data_have_axes() {
    for value in [0.0, 1.0, -3e-9, 1e17, 1e300, -1e300, 1e-300] {
        let chart = Chart::new("", "x", "y").with("c", Style::Line, [[value, value]]);
        texts(&chart.to_svg().expect("a chart"));
        let line = [[0.0, value], [1.0, value], [2.0, 2.0 * value]];
        let chart = Chart::new("", "x", "y").with("c", Style::LinePoints, line);
        texts(&chart.to_svg().expect("a chart"));
        if value > 0.0 {
            let chart = Chart::new("", "x", "y").log_x().log_y();
            texts(
                &chart
                    .with("c", Style::Line, [[value, value]])
                    .to_svg()
                    .expect("a chart"),
            );
        }
    }
    for decades in [1e1, 1e2, 1e3, 1e20, 1e150] {
        let line = [[1.0 / decades, 1.0], [decades, 2.0]];
        let chart = Chart::new("", "x", "y")
            .log_x()
            .log_y()
            .with("c", Style::Line, line);
        texts(&chart.to_svg().expect("a chart"));
    }
}

#[test]
fn many_and_long_names_find_room() {
    let mut chart = Chart::new("words ".repeat(60), "x", "y");
    for k in 0..40 {
        let name = format!("a series with a rather long name, number {k}");
        chart = chart.with(name, Style::LinePoints, [[0.0, f64::from(k)], [1.0, 0.0]]);
    }
    texts(&chart.to_svg().expect("a chart"));
}

#[test]
fn charts_of_nothing_are_errors() {
    let empty = Chart::new("empty", "x", "y");
    let error = empty.to_svg().unwrap_err();
    assert_eq!(
        error,
        PlotError::NoPoints {
            title: "empty".into()
        }
    );
    assert!(empty.clone().with("", Style::Line, []).to_svg().is_err());
    let negative = empty
        .clone()
        .log_x()
        .with("", Style::Line, [[-1.0, 1.0], [0.0, 1.0]]);
    assert!(matches!(negative.to_svg(), Err(PlotError::NoPoints { .. })));
    let infinite = empty.with("", Style::Line, [[f64::NAN, 1.0], [1.0, f64::INFINITY]]);
    assert!(matches!(infinite.to_svg(), Err(PlotError::NoPoints { .. })));
}

#[test]
fn impossible_ranges_are_errors() {
    let range = |low, high| chart().y_range(low, high).to_svg();
    for (low, high) in [
        (1.0, 1.0),
        (2.0, 1.0),
        (f64::NAN, 1.0),
        (0.0, f64::INFINITY),
    ] {
        assert!(
            matches!(range(low, high), Err(PlotError::Range { .. })),
            "{low} {high}"
        );
    }
    assert!(chart().log_y().y_range(0.0, 1.0).to_svg().is_err());
    assert!(chart().log_y().y_range(1.0, 10.0).to_svg().is_ok());
    let wide = Chart::new("", "x", "y").with("", Style::Line, [[-1e308, 0.0], [1e308, 1.0]]);
    assert!(matches!(wide.to_svg(), Err(PlotError::Range { .. })));
}

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

/// The quadrature points of a mesh of cells of element E, with plastic strain f.
fn points<E: Element<2, N>, const N: usize>(
    mesh: &Mesh<2>,
    integration: Integration,
    f: impl Fn([f64; 2]) -> f64,
) -> Vec<PointState<2>> {
    let thickness = PlaneStrain::default();
    let rule = E::rule(integration).points;
    (0..mesh.cell_count())
        .flat_map(|cell| {
            let nodes: [[f64; 2]; N] =
                std::array::from_fn(|a| mesh.nodes()[mesh.cell_nodes(cell)[a]]);
            rule.iter()
                .map(move |p| (cell, p.weight, E::map(&nodes, p.xi)))
        })
        .map(|(cell, weight, at)| PointState {
            cell,
            position: at.x,
            weight: weight * at.det * moreau::mesh::Hypothesis::measure(&thickness, &at.x),
            stress: moreau::mandel::Sym2::zeros(),
            plastic_strain: f(at.x),
        })
        .collect()
}

/// Points, at least three a cell, of a skewed mesh of each element.
fn cases(f: impl Fn([f64; 2]) -> f64 + Copy) -> Vec<(Mesh<2>, Vec<PointState<2>>)> {
    let skewed = |kind| {
        block(kind)
            .map(|x| [x[0] + 0.3 * x[1], x[1] + 0.05 * x[0]])
            .expect("a mesh")
    };
    let [t_3, t_6] = [CellKind::Tri3, CellKind::Tri6].map(skewed);
    let [q_4, q_8] = [CellKind::Quad4, CellKind::Quad8].map(skewed);
    let full = Integration::Full;
    let p_6 = points::<Tri6, 6>(&t_6, full, f);
    let p_4 = points::<Quad4, 4>(&q_4, full, f);
    let p_8 = points::<Quad8, 8>(&q_8, Integration::Reduced, f);
    let p_9 = points::<Quad8, 8>(&q_8, full, f);
    let p_3 = points::<Tri3, 3>(&t_3, full, f);
    vec![
        (t_6, p_6),
        (q_4, p_4),
        (q_8.clone(), p_8),
        (q_8, p_9),
        (t_3, p_3),
    ]
}

fn range(points: &[PointState<2>]) -> [f64; 2] {
    points
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            [low.min(p.plastic_strain), high.max(p.plastic_strain)]
        })
}

#[test]
fn nodal_averages_are_exact_for_linear_fields_within_their_range() {
    let f = |x: [f64; 2]| 0.3 + 2.0 * x[0] - 0.7 * x[1];
    // A linear triangle has one point, from which no slope can be had.
    for (mesh, points) in &cases(f)[..4] {
        let [low, high] = range(points);
        let values = nodal_average(mesh, points, |p| p.plastic_strain);
        for (x, value) in mesh.nodes().iter().zip(values) {
            let exact = f(*x).clamp(low, high);
            assert!(
                (value - exact).abs() < 100.0 * ROUND_OFF,
                "{x:?}: {value} for {exact}"
            );
        }
    }
}

#[test]
fn nodal_averages_stay_in_the_range_of_the_points() {
    let f = |x: [f64; 2]| {
        if x[0] < 2.0 {
            0.0
        } else {
            (7.0 * x[0]).sin().abs() + x[1]
        }
    };
    for (mesh, points) in cases(f) {
        let [low, high] = range(&points);
        for value in nodal_average(&mesh, &points, |p| p.plastic_strain) {
            assert!((low..=high).contains(&value));
        }
    }
}

#[test]
fn nodal_averages_weigh_cells_by_volume() {
    // Cells of lengths 1 and 3 with constants 0 and 4: at the nodes between them, 3.
    let mesh = block2("b", CellKind::Quad4, &[0.0, 1.0, 4.0], &[0.0, 1.0]).expect("a mesh");
    let points = points::<Quad4, 4>(
        &mesh,
        Integration::Full,
        |x| if x[0] < 1.0 { 0.0 } else { 4.0 },
    );
    let values = nodal_average(&mesh, &points, |p| p.plastic_strain);
    for (x, value) in mesh.nodes().iter().zip(values) {
        let exact = if x[0] == 1.0 {
            3.0
        } else if x[0] < 1.0 {
            0.0
        } else {
            4.0
        };
        assert!((value - exact).abs() < ROUND_OFF, "{x:?}: {value}");
    }
}

#[test]
fn nodal_averages_ignore_what_is_not_a_number() {
    let mesh = block(CellKind::Quad4);
    assert!(
        nodal_average(&mesh, &[], |_| 1.0)
            .iter()
            .all(|v| v.is_nan())
    );
    let mut points = points::<Quad4, 4>(&mesh, Integration::Full, |_| 2.0);
    points[0].plastic_strain = f64::NAN;
    points[5].plastic_strain = f64::INFINITY;
    points[9].weight = f64::NAN;
    points[13].cell = 1000;
    let values = nodal_average(&mesh, &points, |p| p.plastic_strain);
    assert!(values.iter().all(|v| (v - 2.0).abs() < ROUND_OFF));
}
