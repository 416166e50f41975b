//! `docs/validation`: a page for each case and the index, from what the cases tell of themselves and what
//! they computed; no times, no dates, and no digits that another machine would not find.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use verification::{Case, Check, Figure, Kind};

use super::Setting;
use super::comparison::{relation, tolerance, with_unit};
use super::execute::Run;
use super::files::{self, Folder};
use super::groups::groups;
use super::number::typeset;
use super::terminal::count;
use crate::markdown::{cell, code};

/// Digits of a number.
const DIGITS: usize = 6;

/// Bounds below this are on what arithmetic leaves over, which differs between machines.
const ROUNDOFF: f64 = 1e-6;

/// A figure of more bytes is left to the report.
const LARGE: usize = 120_000;

/// Writes the pages of the cases that were run below `docs`, and the index of all that have one.
pub fn write(
    docs: &Path,
    known: &[Case],
    runs: &[Run<'_>],
    setting: Setting,
) -> Result<(), Box<dyn Error>> {
    let folder = docs.join("validation");
    files::prepare(&folder)?;
    for run in runs {
        let name = run.case.name;
        let mut pictures = Folder::open(&folder, name, "svg")?;
        let small = run.figures().iter().find(|f| f.svg.len() <= LARGE);
        if let Some(figure) = small {
            pictures.write(&figure.name, name, &figure.svg)?;
        }
        pictures.prune()?;
        if small.is_none() {
            fs::remove_dir(folder.join(name))?;
        }
        let page = page(run, small, setting);
        files::write(&folder.join(format!("{name}.md")), &page)?;
    }
    let paged = |case: &&Case| folder.join(format!("{}.md", case.name)).is_file();
    let index = index(known.iter().filter(paged));
    Ok(files::write(&docs.join("validation.md"), &index)?)
}

/// The index: a row for each case.
fn index<'a>(cases: impl Iterator<Item = &'a Case>) -> String {
    let mut page = String::from(
        "# Validation\n\nProblems with known answers, and what is computed beside them. Every page is written by \
         `cargo xtask verify --pages` from the case itself, with the numbers of the run that wrote it.\n\n\
         | case | problem | chapter |\n|---|---|---|\n",
    );
    for case in cases {
        let name = case.name;
        let (title, chapter) = (cell(case.title), case.chapter.title());
        let _ = writeln!(
            page,
            "| [{name}](validation/{name}.md) | {title} | {chapter} |"
        );
    }
    page
}

/// The page of a case, with one of its figures.
fn page(run: &Run<'_>, figure: Option<&Figure>, setting: Setting) -> String {
    let case = run.case;
    let quick = if setting.quick { " --quick" } else { "" };
    let command = code(&format!("cargo xtask verify {}{quick} --pages", case.name));
    let mut page = format!(
        "# {}\n\n{}\n\n{}, written by {command}. All cases: [validation](../validation.md).\n",
        cell(case.title),
        cell(case.description),
        match setting.quick {
            true => "Coarse meshes and few variants",
            false => "All meshes and variants",
        },
    );
    let decks = case.decks.iter().map(|path| {
        let name = Path::new(path).file_stem().unwrap_or_default();
        format!("[{}](../{path})", name.display())
    });
    let decks = decks.collect::<Vec<_>>().join(", ");
    if !decks.is_empty() {
        let _ = write!(
            page,
            "\nTo begin with, of this problem or near it: {decks}.\n"
        );
    }
    if let Some(error) = run.error() {
        let _ = write!(page, "\nNo outcome: {}\n", cell(error));
    }
    if let Some(figure) = figure {
        let file = format!("{}/{}.svg", case.name, files::file_name(&figure.name));
        let caption = cell(&figure.caption);
        let _ = write!(page, "\n![{caption}]({file})\n\n{caption}\n");
    }
    page + &checks(run)
}

/// All checks but those of times, as tables below their headings.
fn checks(run: &Run<'_>) -> String {
    let lasting = run.checks().iter().filter(|check| !check.timed);
    let checks: Vec<Check> = lasting.cloned().collect();
    if checks.is_empty() {
        return String::new();
    }
    let held = checks.iter().filter(|check| check.pass).count();
    let all = count(checks.len(), "check");
    let mut text = format!(
        "\n## Computed and expected\n\n{held} of {all} hold. Numbers have {DIGITS} digits at most and none beyond a \
         hundredth of the tolerance; what rounding leaves over is shown by its bound. A tolerance without a unit is a \
         part of the number expected. Times are left to the report.\n"
    );
    for group in groups(&checks) {
        if let Some(heading) = group.heading {
            let _ = write!(text, "\n### {}\n", cell(heading));
        }
        text.push_str("\n| what | computed | | expected | tolerance | expected from | |\n");
        text.push_str("|---|--:|:-:|--:|--:|---|:-:|\n");
        for (name, check) in group.checks {
            let _ = writeln!(text, "{}", row(name, check));
        }
    }
    text
}

fn row(name: &str, check: &Check) -> String {
    let cells = [
        cell(name),
        with_unit(computed(check), &check.unit),
        relation(check.kind).to_owned(),
        with_unit(typeset(check.reference, DIGITS), &check.unit),
        tolerance(check, typeset),
        cell(&check.source),
        if check.pass { "✓" } else { "✗" }.to_owned(),
    ];
    format!("| {} |", cells.join(" | "))
}

/// The number of a check as far as it is the same on all machines; one beyond its bound as it is.
fn computed(check: &Check) -> String {
    let within = match check.kind {
        _ if !check.pass => return typeset(check.value, DIGITS),
        Kind::Relative => check.tolerance * check.reference.abs(),
        Kind::Absolute => check.tolerance,
        Kind::AtMost if check.reference > 0.0 && check.reference < ROUNDOFF => {
            return format!("≤ {}", typeset(check.reference, DIGITS));
        }
        Kind::AtMost | Kind::AtLeast => check.reference.abs(),
    };
    // A little more, so that the logarithm of a power of ten ends at it everywhere.
    let place = ((within / 100.0).log10() + 1e-9).floor();
    if !place.is_finite() {
        return typeset(check.value, DIGITS);
    }
    // In the power of ten that is a whole number: 10⁻³ is none.
    let shift = 10f64.powf(place.abs());
    let rounded = match place < 0.0 {
        true => (check.value * shift).round() / shift,
        false => (check.value / shift).round() * shift,
    };
    typeset(rounded, DIGITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::execute::execute;
    use crate::verify::progress::Progress;
    use crate::verify::samples;
    use verification::scratch::Scratch;

    const QUICK: Setting = Setting {
        quick: true,
        threads: 2,
    };

    fn written(name: &str) -> (Scratch, String) {
        let (cases, docs) = (samples::cases(), Scratch::new().unwrap());
        let case = cases.iter().find(|case| case.name == name).unwrap();
        let run = execute(case, true, Progress::Silent);
        write(docs.path(), &cases, &[run], QUICK).unwrap();
        let page = docs.path().join(format!("validation/{name}.md"));
        let page = fs::read_to_string(page).unwrap();
        (docs, page)
    }

    #[test]
    fn a_page_has_problem_picture_and_checks() {
        let (docs, page) = written("sound");
        for text in [
            "# A made-up &lt;case&gt;",
            "Why & how.",
            "near it: [a-case](../examples/a-case.toml), [a-case](../gallery/a-case.py).",
            "](sound/curve.svg)",
            "3 of 3 checks hold",
            "| force | 100.004 N | = | 100 N | ±0.1 % | closed form [12] | ✓ |",
            "| penetration | ≤ 10⁻⁹ mm | ≤ | 10⁻⁹ mm |  | exact contact | ✓ |",
            "| moment | 0 N·mm | = | 0 N·mm |",
        ] {
            assert!(page.contains(text), "{text}: {page}");
        }
        assert!(docs.path().join("validation/sound/curve.svg").is_file());
        let index = fs::read_to_string(docs.path().join("validation.md")).unwrap();
        assert!(
            index.contains("| [sound](validation/sound.md) | A made-up &lt;case&gt; | The paper |")
        );
        assert!(!index.contains("flawed"), "it has no page: {index}");
    }

    #[test]
    fn what_failed_is_shown_as_it_is() {
        let page = written("flawed").1;
        assert!(page.contains("1 of 3 checks hold"), "{page}");
        assert!(page.contains("| energy | NaN N·mm | = |"), "{page}");
        assert!(written("erring").1.contains("No outcome: the step failed"));
    }

    #[test]
    fn digits_end_before_those_of_a_machine() {
        let shown =
            |value, kind, reference| computed(&Check::new("a", (value, "1"), kind, reference, "b"));
        assert_eq!(shown(1.234_567_89, Kind::Absolute, (1.2, 0.1)), "1.235");
        assert_eq!(shown(1234.56, Kind::Relative, (1230.0, 0.5)), "1235");
        assert_eq!(shown(123_456.0, Kind::AtMost, (1e6, 0.0)), "120000");
        assert_eq!(shown(3e-15, Kind::AtMost, (1e-3, 0.0)), "0");
        assert_eq!(shown(0.0, Kind::AtMost, (0.0, 0.0)), "0");
    }
}
