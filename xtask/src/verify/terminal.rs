//! What a person reads on the terminal when a case is done; not the progress of a running case.

use verification::Check;

use super::Setting;
use super::comparison::{deviation, relation, tolerance, with_unit};
use super::execute::Run;
use super::groups::groups;
use super::number::plain;
use super::paint::Paint;

/// What is going to be run.
pub fn preamble(cases: usize, setting: Setting) -> String {
    let kind = if setting.quick { ", quick" } else { "" };
    format!(
        "verification: {}{kind}, {}",
        count(cases, "case"),
        count(setting.threads, "thread")
    )
}

/// `1 case`, `2 cases`.
pub fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// A case and its checks, or its error; ends with an empty line.
pub fn case(run: &Run<'_>, paint: Paint) -> String {
    let mut text = format!(
        "{} {}  {}  {}\n",
        paint.mark(run.pass()),
        paint.bold(run.case.name),
        run.case.title,
        paint.faint(&format!("{:.1} s", run.seconds)),
    );
    if let Some(error) = run.error() {
        for (i, line) in error.lines().enumerate() {
            let line = if i == 0 {
                format!("error: {line}")
            } else {
                line.to_owned()
            };
            text += &format!("  {}\n", paint.good_or_bad(false, &line));
        }
    }
    text + &checks(run, paint)
}

/// One line per check, in columns, under the headings of their groups.
fn checks(run: &Run<'_>, paint: Paint) -> String {
    let mut lines = vec![(String::new(), HEADER.map(str::to_owned), None)];
    for group in groups(run.checks()) {
        if let Some(heading) = group.heading {
            lines.push((
                format!("    {heading}"),
                HEADER.map(|_| String::new()),
                None,
            ));
        }
        let indent = if group.heading.is_some() { "  " } else { "" };
        for (name, check) in group.checks {
            lines.push((format!("{indent}{name}"), cells(check), Some(check.pass)));
        }
    }
    if lines.len() == 1 {
        return String::new();
    }
    let length = |text: &String| text.chars().count();
    let checks = || lines.iter().filter(|(_, _, pass)| pass.is_some());
    let first = checks().map(|(name, ..)| length(name)).max().unwrap_or(0);
    let widths: [usize; 5] = std::array::from_fn(|i| {
        lines
            .iter()
            .map(|(_, cells, _)| length(&cells[i]))
            .max()
            .unwrap_or(0)
    });
    let mut text = String::new();
    for (name, cells, pass) in &lines {
        let [a, b, c, d, e] = std::array::from_fn(|i| format!("{:>1$}", cells[i], widths[i]));
        let line = format!("{name:<first$}  {a} {b} {c}  {d}  {e}");
        let line = line.trim_end();
        text += &match pass {
            None if name.is_empty() => format!("    {}\n", paint.faint(line)),
            None => format!("{}\n", paint.bold(line)),
            Some(true) => format!("  {} {line}\n", paint.mark(true)),
            Some(false) => {
                format!(
                    "  {} {}\n",
                    paint.mark(false),
                    paint.good_or_bad(false, line)
                )
            }
        };
    }
    text
}

const HEADER: [&str; 5] = ["value", "", "reference", "deviation", "allowed"];

/// The numbers of a check.
fn cells(check: &Check) -> [String; 5] {
    [
        with_unit(plain(check.value, 7), &check.unit),
        relation(check.kind).to_owned(),
        with_unit(plain(check.reference, 7), &check.unit),
        deviation(check, plain),
        tolerance(check, plain),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::execute::execute;
    use crate::verify::progress::Progress;
    use crate::verify::samples;

    fn shown(name: &str) -> String {
        let cases = samples::cases();
        let sample = cases.iter().find(|case| case.name == name).unwrap();
        case(&execute(sample, true, Progress::Silent), Paint::plain())
    }

    #[test]
    fn checks_stand_in_columns() {
        let text = shown("sound");
        let lines: Vec<&str> = text.lines().skip(1).collect();
        let expected = "\
                     value    reference      deviation     allowed
  ✓ force        100.004 N =      100 N       +0.004 %      ±0.1 %
  ✓ penetration 2.5e-13 mm ≤    1e-9 mm       × 0.00025
  ✓ moment      -3e-9 N·mm =     0 N·mm    -3e-9 N·mm  ±1e-6 N·mm";
        let words = |line: &str| {
            line.split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(lines.len(), 4);
        for (line, expected) in lines.iter().zip(expected.lines()) {
            assert_eq!(words(line), words(expected));
        }
        let column = |line: &str| line.chars().position(|c| "=≤".contains(c));
        assert!(
            lines[1..]
                .iter()
                .all(|line| column(line) == column(lines[1])),
            "{text}"
        );
    }

    #[test]
    fn failures_are_marked() {
        let text = shown("flawed");
        assert!(
            text.contains("✗ energy") && text.contains("✓ iterations"),
            "{text}"
        );
        assert!(shown("erring").contains("error: the step failed"));
    }
}
