//! Cases with made-up results for the tests of this task; not verification of anything.

use std::error::Error;
use std::fmt;

use verification::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};

/// A case that passes, one whose checks fail, one that errs and one that panics.
pub fn cases() -> Vec<Case> {
    let case = |name, run| Case {
        long: false,
        alone: false,
        name,
        chapter: Chapter::Paper,
        title: "A made-up <case>",
        description: "Why & how.",
        decks: &["examples/a-case.toml", "gallery/a-case.py"],
        run,
    };
    vec![
        case("sound", sound),
        case("flawed", flawed),
        case("erring", erring),
        case("panicking", |_| panic!("index {}", 7)),
    ]
}

fn sound(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    (options.progress)("a mesh of 4 cells");
    Ok(Outcome {
        checks: vec![
            Check::new(
                "force",
                (100.004, "N"),
                Kind::Relative,
                (100.0, 1e-3),
                "closed form [12]",
            ),
            Check::new(
                "penetration",
                (2.5e-13, "mm"),
                Kind::AtMost,
                (1e-9, 0.0),
                "exact contact",
            ),
            Check::new(
                "moment",
                (-3e-9, "N·mm"),
                Kind::Absolute,
                (0.0, 1e-6),
                "equilibrium",
            ),
        ],
        tables: vec![
            Table {
                name: "curve".into(),
                title: "Force against displacement".into(),
                header: vec!["u [mm]".into(), "state, \"local\"".into()],
                rows: vec![
                    vec!["0.1".into(), "stick".into()],
                    vec!["-2e-3".into(), "slip, a".into()],
                ],
            },
            Table {
                name: "long".into(),
                title: "Forces of all nodes".into(),
                header: vec!["node".into()],
                rows: (0..17).map(|k| vec![k.to_string()]).collect(),
            },
        ],
        figures: vec![Figure {
            name: "curve".into(),
            caption: "Force against displacement".into(),
            svg: SVG.into(),
        }],
        notes: vec!["The load is < 1 kN.".into()],
    })
}

fn flawed(_: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    Ok(Outcome {
        checks: vec![
            Check::new(
                "energy",
                (f64::NAN, "N·mm"),
                Kind::Relative,
                (1.0, 1e-3),
                "balance",
            ),
            Check::new(
                "rate",
                (1.2, "1"),
                Kind::AtLeast,
                (1.9, 0.0),
                "a priori estimate",
            ),
            Check::new(
                "iterations",
                (5.0, "1"),
                Kind::AtMost,
                (8.0, 0.0),
                "quadratic rate",
            ),
        ],
        ..Outcome::default()
    })
}

fn erring(_: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    Err(Box::new(StepFailed))
}

/// An error of a solver.
#[derive(Debug)]
struct StepFailed;

impl fmt::Display for StepFailed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the step failed: 12 iterations were not enough")
    }
}

impl Error for StepFailed {}

/// A picture with an identifier, a reference to it and no view box.
pub const SVG: &str = concat!(
    r#"<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="600" height="400">"#,
    r#"<defs><clipPath id="clip"><rect width="9" height="9"/></clipPath></defs>"#,
    r##"<g clip-path="url(#clip)"><path d="M0 400L600 0" stroke="#b33"/></g></svg>"##
);
