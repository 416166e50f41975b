//! `report.html`: what the template is given, as text and numbers already formatted; how it looks is
//! in the template.

use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, context};
use serde::Serialize;
use verification::{Check, Figure, Table};

use super::Setting;
use super::comparison::{deviation, kind, relation, tolerance};
use super::execute::Run;
use super::groups::groups;
use super::number::typeset;
use super::svg;
use super::terminal::count;
use super::verdict::Verdict;

/// Tables longer than this are folded.
const LONG: usize = 16;

#[derive(Serialize)]
struct Section<'a> {
    /// Heading of a chapter that begins with this case.
    chapter: Option<&'static str>,
    name: &'a str,
    title: &'a str,
    description: &'a str,
    seconds: String,
    pass: bool,
    passed: usize,
    total: usize,
    error: Option<&'a str>,
    notes: &'a [String],
    checks: Vec<Block<'a>>,
    figures: Vec<Picture<'a>>,
    tables: Vec<Grid<'a>>,
}

#[derive(Serialize)]
struct Block<'a> {
    heading: Option<&'a str>,
    rows: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    value: String,
    unit: &'a str,
    relation: &'static str,
    reference: String,
    deviation: String,
    tolerance: String,
    kind: &'static str,
    source: &'a str,
    pass: bool,
}

#[derive(Serialize)]
struct Picture<'a> {
    caption: &'a str,
    /// Nothing if the case made no picture of it.
    svg: Option<String>,
}

#[derive(Serialize)]
struct Grid<'a> {
    title: &'a str,
    header: Vec<Cell<'a>>,
    rows: Vec<Vec<Cell<'a>>>,
    /// The number of its rows, where it is folded.
    folded: Option<usize>,
}

#[derive(Serialize)]
struct Cell<'a> {
    text: &'a str,
    numeric: bool,
}

/// The page.
pub fn html(
    runs: &[Run<'_>],
    setting: Setting,
    verdict: &Verdict,
) -> Result<String, minijinja::Error> {
    let mut sections: Vec<Section<'_>> = runs.iter().map(section).collect();
    for chapter in sections.chunk_by_mut(|a, b| a.chapter == b.chapter) {
        chapter.iter_mut().skip(1).for_each(|s| s.chapter = None);
    }
    let mut environment = Environment::new();
    let syntax = SyntaxConfig::builder()
        .trim_blocks(true)
        .lstrip_blocks(true)
        .build()?;
    environment.set_syntax(syntax);
    environment.add_template("report.html", include_str!("../report.html"))?;
    environment.get_template("report.html")?.render(context! {
        cases => Serde(&sections),
        pass => verdict.pass(),
        verdict => verdict.words(),
        seconds => seconds(verdict.seconds),
        threads => count(setting.threads, "thread"),
        quick => setting.quick,
    })
}

fn section<'a>(run: &'a Run<'_>) -> Section<'a> {
    let name = run.case.name;
    Section {
        chapter: Some(run.case.chapter.title()),
        name,
        title: run.case.title,
        description: run.case.description,
        seconds: seconds(run.seconds),
        pass: run.pass(),
        passed: run.passed(),
        total: run.checks().len(),
        error: run.error(),
        notes: run.notes(),
        checks: groups(run.checks())
            .into_iter()
            .map(|group| Block {
                heading: group.heading,
                rows: group.checks.into_iter().map(row).collect(),
            })
            .collect(),
        figures: run
            .figures()
            .iter()
            .enumerate()
            .map(|(i, f)| picture(name, i, f))
            .collect(),
        tables: run.tables().iter().map(grid).collect(),
    }
}

fn row<'a>((name, check): (&'a str, &'a Check)) -> Row<'a> {
    Row {
        name,
        value: typeset(check.value, 8),
        unit: if check.unit == "1" { "" } else { &check.unit },
        relation: relation(check.kind),
        reference: typeset(check.reference, 8),
        deviation: deviation(check, typeset),
        tolerance: tolerance(check, typeset),
        kind: kind(check.kind),
        source: &check.source,
        pass: check.pass,
    }
}

fn picture<'a>(case: &str, index: usize, figure: &'a Figure) -> Picture<'a> {
    let prefix = format!("{case}-{index}");
    Picture {
        caption: &figure.caption,
        svg: svg::inline(&figure.svg, &prefix),
    }
}

fn grid(table: &Table) -> Grid<'_> {
    let width = table
        .rows
        .iter()
        .map(Vec::len)
        .max()
        .unwrap_or(0)
        .max(table.header.len());
    let numeric: Vec<bool> = (0..width).map(|column| is_numeric(table, column)).collect();
    let dressed = |row| dress(row, &numeric);
    Grid {
        title: &table.title,
        header: dressed(&table.header),
        rows: table.rows.iter().map(|row| dressed(row)).collect(),
        folded: Some(table.rows.len()).filter(|&rows| rows > LONG),
    }
}

fn dress<'a>(row: &'a [String], numeric: &[bool]) -> Vec<Cell<'a>> {
    row.iter()
        .zip(numeric)
        .map(|(text, &numeric)| Cell { text, numeric })
        .collect()
}

/// Whether all that is written in a column is numbers.
fn is_numeric(table: &Table, column: usize) -> bool {
    let mut cells = table
        .rows
        .iter()
        .filter_map(|row| row.get(column))
        .filter(|cell| !blank(cell))
        .peekable();
    cells.peek().is_some() && cells.all(|cell| is_number(cell))
}

fn blank(cell: &str) -> bool {
    matches!(cell.trim(), "" | "-" | "–" | "—")
}

fn is_number(cell: &str) -> bool {
    cell.trim()
        .trim_end_matches('%')
        .trim_end()
        .replace('−', "-")
        .parse::<f64>()
        .is_ok()
}

/// A time as a person says it.
fn seconds(t: f64) -> String {
    if t < 100.0 {
        return format!("{t:.1} s");
    }
    let whole = t.round() as u64;
    format!("{} min {:02} s", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::execute::execute;
    use crate::verify::progress::Progress;
    use crate::verify::samples;

    fn page() -> String {
        let cases = samples::cases();
        let runs: Vec<_> = cases
            .iter()
            .map(|case| execute(case, true, Progress::Silent))
            .collect();
        html(
            &runs,
            Setting {
                quick: true,
                threads: 2,
            },
            &Verdict::of(&runs, 3.25),
        )
        .unwrap()
    }

    #[test]
    fn the_page_shows_what_the_cases_have() {
        let page = page();
        for text in [
            "A made-up &lt;case&gt;",
            "Why &amp; how.",
            "The load is &lt; 1 kN.",
            "2.5·10⁻¹³",
            "closed form [12]",
            "<svg ",
            "Force against displacement",
            "(17 rows)",
            "12 iterations were not enough",
            "4 checks passed, 2 failed, 2 cases erred",
            "2 threads",
        ] {
            assert!(page.contains(text), "{text}");
        }
    }

    #[test]
    fn the_page_needs_no_network_and_no_script() {
        let page = page().replace("http://www.w3.org/2000/svg", "");
        assert!(!page.contains("http") && !page.contains("<script"));
    }

    #[test]
    fn columns_of_numbers_are_known() {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        let table = Table {
            name: "a".into(),
            title: "b".into(),
            header: row(["u", "state", "rate"]),
            rows: vec![row(["−1.5e-3", "slip", "—"]), row(["2", "3", "12 %"])],
        };
        let numeric: Vec<bool> = grid(&table)
            .header
            .iter()
            .map(|cell| cell.numeric)
            .collect();
        assert_eq!(numeric, [true, false, true]);
    }

    #[test]
    fn times() {
        assert_eq!(seconds(3.25), "3.2 s");
        assert_eq!(seconds(119.7), "2 min 00 s");
    }
}
