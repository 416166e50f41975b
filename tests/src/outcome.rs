//! What a verification case hands to whoever ran it: checks, tables and figures; not how they are
//! written to files.

use serde::Serialize;

/// How a value is compared with its reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// |value − reference| ≤ tolerance · |reference|.
    Relative,
    /// |value − reference| ≤ tolerance.
    Absolute,
    /// value ≤ reference; the tolerance is not used.
    AtMost,
    /// value ≥ reference; the tolerance is not used.
    AtLeast,
}

/// One number that was computed, beside the one that was expected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What it is.
    pub name: String,
    /// The number computed.
    pub value: f64,
    /// Its unit; "1" for a pure number.
    pub unit: String,
    /// The number expected, or the bound.
    pub reference: f64,
    /// Tolerance, see [`Kind`].
    pub tolerance: f64,
    /// How the two are compared.
    pub kind: Kind,
    /// Where the expected number comes from.
    pub source: String,
    /// Whether the comparison holds; false for NaN.
    pub pass: bool,
    /// Whether the number is a time or made of times, and another in the next run.
    #[serde(skip)]
    pub timed: bool,
}

impl Check {
    /// Compares a value with its reference.
    pub fn new(
        name: impl Into<String>,
        (value, unit): (f64, &str),
        kind: Kind,
        (reference, tolerance): (f64, f64),
        source: &str,
    ) -> Self {
        let pass = match kind {
            Kind::Relative => (value - reference).abs() <= tolerance * reference.abs(),
            Kind::Absolute => (value - reference).abs() <= tolerance,
            Kind::AtMost => value <= reference,
            Kind::AtLeast => value >= reference,
        };
        let (name, unit, source) = (name.into(), unit.into(), source.into());
        Self {
            name,
            value,
            unit,
            reference,
            tolerance,
            kind,
            source,
            pass,
            timed: false,
        }
    }

    /// The same of a number that is made of times.
    #[must_use]
    pub fn timed(self) -> Self {
        Self {
            timed: true,
            ..self
        }
    }

    /// A value that is its reference but for a part of it, [`Kind::Relative`].
    pub fn relative(
        name: impl Into<String>,
        value: (f64, &str),
        reference: (f64, f64),
        source: &str,
    ) -> Self {
        Self::new(name, value, Kind::Relative, reference, source)
    }

    /// A value that is its reference but for a tolerance in its unit, [`Kind::Absolute`].
    pub fn absolute(
        name: impl Into<String>,
        value: (f64, &str),
        reference: (f64, f64),
        source: &str,
    ) -> Self {
        Self::new(name, value, Kind::Absolute, reference, source)
    }

    /// A value that does not exceed a bound, [`Kind::AtMost`].
    pub fn at_most(name: impl Into<String>, value: (f64, &str), bound: f64, source: &str) -> Self {
        Self::new(name, value, Kind::AtMost, (bound, 0.0), source)
    }

    /// A value that reaches a bound, [`Kind::AtLeast`].
    pub fn at_least(name: impl Into<String>, value: (f64, &str), bound: f64, source: &str) -> Self {
        Self::new(name, value, Kind::AtLeast, (bound, 0.0), source)
    }
}

/// A table of the report, and a CSV file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Stem of the file name.
    pub name: String,
    /// What the table shows.
    pub title: String,
    /// Names of the columns, with units.
    pub header: Vec<String>,
    /// The rows, as text.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table whose rows have a cell for every column.
    pub fn new<const N: usize>(
        name: &str,
        title: impl Into<String>,
        header: [&str; N],
        rows: impl IntoIterator<Item = [String; N]>,
    ) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            header: header.map(String::from).to_vec(),
            rows: rows.into_iter().map(Vec::from).collect(),
        }
    }
}

/// A figure of the report, and an SVG file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Stem of the file name.
    pub name: String,
    /// What the figure shows, and which figure of the paper it stands for.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

impl Figure {
    /// A picture and what it shows.
    pub fn new(name: &str, caption: impl Into<String>, svg: String) -> Self {
        Self {
            name: name.into(),
            caption: caption.into(),
            svg,
        }
    }
}

/// All that a case has to show.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// The numbers that decide.
    pub checks: Vec<Check>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Paragraphs of plain text: what was seen, and what was not run.
    pub notes: Vec<String>,
}

/// How thoroughly a case is run, and to whom it tells where it is.
pub struct Options<'a> {
    /// Coarse meshes and few variants only.
    pub quick: bool,
    /// Receives a short line whenever the case begins something that takes time.
    pub progress: &'a dyn Fn(&str),
}

/// Part of the report that a case belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chapter {
    /// The numerical examples of the paper, its figures and tables.
    Paper,
    /// What the paper's theory is written for and its examples leave out.
    Beyond,
    /// What the paper names as its next step.
    Large,
}

impl Chapter {
    /// Heading in the report.
    pub fn title(self) -> &'static str {
        match self {
            Self::Paper => "The paper",
            Self::Beyond => "Beyond the paper",
            Self::Large => "Large strains",
        }
    }
}

/// A verification case.
pub struct Case {
    /// Name on the command line.
    pub name: &'static str,
    /// Whether it takes too long for a quick run, unless it is asked for by name.
    pub long: bool,
    /// Whether it compares times, so that nothing may run beside it.
    pub alone: bool,
    /// Where it stands in the report; the cases of a chapter follow one another.
    pub chapter: Chapter,
    /// Title in the report.
    pub title: &'static str,
    /// What is computed and why: one paragraph.
    pub description: &'static str,
    /// Decks and notebooks of this problem or near it, as paths in `docs`.
    pub decks: &'static [&'static str],
    /// Runs the case. An error is a failure of the case: the solver did not do what it should.
    pub run: fn(&Options<'_>) -> Result<Outcome, Box<dyn std::error::Error>>,
}
