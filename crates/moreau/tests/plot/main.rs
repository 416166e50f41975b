//! Charts, pictures and nodal averages: well-formed, repeatable, exact where they should be, and
//! errors where nothing can be drawn; not their looks.

mod averages;
mod bodies;
mod charts;
#[cfg(feature = "png")]
mod png;
mod recovery;

use moreau::mesh::{CellKind, Mesh, block2, uniform};
use moreau::plot::{Chart, Style};

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
