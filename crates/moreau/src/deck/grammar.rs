//! The keys of a deck and what they mean: from text to entries; names are not looked up here.

mod axes;
mod initial;
mod material;
mod mesh;
mod solver;
mod step;
mod tool;

use super::entries::{Analysis, Deck};
use super::finding::{At, Class, Findings, did_you_mean};
use super::formula;
use super::include::{self, Joining};
use super::reader::{self, Log, Table, Value};
use super::units::Units;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::de::DeTable;

/// Reads a deck whose paths are relative to a folder. What was not understood is left out, and
/// noted.
pub(super) fn read(text: &str, folder: &Path, given: &BTreeMap<String, f64>) -> (Deck, Findings) {
    let log = Log::new(folder);
    let (includes, files) = include::read(text, folder, &log);
    log.borrow_mut().include(files.clone());
    let joining = Joining {
        own: text,
        files: &files,
        parse,
        log: &log,
    };
    let document = joining.with(&includes, parse(text, 0, &log));
    let root = Table::new(&document, 0..0, "the deck", &log);
    if includes_fail(&log.borrow()) {
        // What else would be said is mostly that what is not there is missing.
        let silent = Log::new(folder);
        let deck = deck(&Table::new(&document, 0..0, "the deck", &silent));
        return (deck, log.into_inner());
    }
    let parameters = parameters(&root, given);
    let deck = deck(&root);
    // For editors, and joined already.
    root.get("include");
    root.finish();
    for name in parameters.iter().filter(|name| !log.uses(&name.value)) {
        // What is included may be for several decks.
        if log.borrow().file(&name.span).is_none() {
            let message = format!("no formula uses the parameter \"{}\"", name.value);
            log.borrow_mut()
                .warning(&name.span, message, "as in friction = \"= mu\"");
        }
    }
    (deck, log.into_inner())
}

/// Whether a deck is not whole because of what it includes.
pub(super) fn includes_fail(findings: &Findings) -> bool {
    findings.iter().any(|f| f.class == Class::Includes)
}

/// The table of a text whose places begin at one; what is no TOML in it is noted.
fn parse<'t>(text: &'t str, start: usize, log: &Log) -> DeTable<'t> {
    let (document, errors) = DeTable::parse_recoverable(text);
    let mut told: Option<Range<usize>> = None;
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        // What is said of a place again follows from what was said first.
        if told
            .as_ref()
            .is_some_and(|t| (t.start..=t.end).contains(&span.start))
        {
            continue;
        }
        told = Some(span.clone());
        let message = not_toml(text, &span, error.message());
        log.borrow_mut()
            .error(&(span.start + start..span.end + start), message, "here")
            .about(Class::Syntax);
    }
    include::shifted_table(document.into_inner(), start)
}

/// Defines the parameters of a deck, in the order of the file; those that are given have other values. Their names.
fn parameters(root: &Table<'_>, given: &BTreeMap<String, f64>) -> Vec<At<String>> {
    let log = root.log();
    let table = root
        .get("parameters")
        .and_then(|value| reader::table(value, "parameters", "[parameters]", log));
    let mut names: Vec<At<String>> = Vec::new();
    for (name, value) in table.iter().flat_map(Table::entries) {
        let plain = name.value.starts_with(char::is_alphabetic);
        if !(plain && name.value.chars().all(formula::is_of_name)) {
            let message = format!(
                "the parameter is called \"{}\", expected letters, digits and '_', a letter first",
                name.value
            );
            let mut findings = log.borrow_mut();
            findings.error(&name.span, message, "no name for formulas");
            continue;
        }
        if formula::reserved().any(|known| known == name.value) {
            let message = format!("\"{}\" is what formulas have already", name.value);
            let mut findings = log.borrow_mut();
            findings.error(&name.span, message, "call the parameter something else");
            continue;
        }
        let other = given.get(&name.value).copied();
        let value = reader::number(value, &name.value, log).map(|v| v.value);
        if let Some(value) = other.or(value) {
            log.define(&name.value, value);
        }
        names.push(name);
    }
    for unknown in given.keys() {
        if !names.iter().any(|name| name.value == *unknown) {
            let near = did_you_mean(unknown, names.iter().map(|n| n.value.as_str()));
            let message = format!("the deck has no parameter \"{unknown}\"{near}");
            let mut findings = log.borrow_mut();
            findings
                .error(&(0..0), message, "[parameters] names them")
                .about(Class::Names);
        }
    }
    names
}

/// What is wrong at a place where the text is no TOML: in the words of a deck where the mistake is a
/// usual one.
fn not_toml(text: &str, span: &Range<usize>, said: &str) -> String {
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let (before, from) = text.split_at_checked(span.start).unwrap_or((text, ""));
    let here = text.get(span.clone()).unwrap_or_default();
    let unsigned = from.strip_prefix(['+', '-']).unwrap_or(from);
    let sign = &from[..from.len() - unsigned.len()];
    let (last, begun) = (before.chars().last(), before.strip_suffix('.'));
    let has_begun = digit(begun.and_then(|b| b.chars().last()));
    if said == "duplicate key" {
        format!("the key \"{here}\" stands twice in one table")
    } else if from.starts_with(',') && digit(last) && digit(from.chars().nth(1)) {
        "a comma within a number: decimals have a point, as in 0.3".into()
    } else if has_begun && !digit(from.chars().next()) {
        "a number ends with a digit, as in 5.0".into()
    } else if unsigned.starts_with('.') && digit(unsigned.chars().nth(1)) && !digit(last) {
        format!("a number begins with a digit, as in {sign}0.3")
    } else {
        format!("not TOML: {}", said.replace('\n', ", "))
    }
}

fn deck(root: &Table<'_>) -> Deck {
    let log = root.log();
    let title = root
        .get("title")
        .and_then(|v| reader::text(v, "title", log));
    let units = root.choice("units", &Units::NAMES);
    let units = units.and_then(|u| Units::named(u.value));
    let analysis = root.choice("analysis", &Analysis::NAMES);
    let analysis = match analysis.as_ref().map(|a| a.value) {
        Some("plane-stress") => Analysis::PlaneStress,
        Some("axisymmetric") => Analysis::Axisymmetric,
        Some("solid") => Analysis::Solid,
        _ => Analysis::PlaneStrain,
    };
    let dimension = analysis.dimension();
    let strain = root.choice_if("strain", &["small", "finite"]);
    let finite = strain.map(|s| At::new(s.value == "finite", s.span));
    let thickness = root.number_if("thickness");
    if let (Some(t), true) = (&thickness, !analysis.has_thickness()) {
        log.borrow_mut().error(
            &t.span,
            format!(
                "a thickness has no meaning for analysis = \"{}\"",
                analysis.name()
            ),
            "remove this key, or use analysis = \"plane-strain\" or \"plane-stress\"",
        );
    }
    let checksum = root.get("checksum");
    let checksum = checksum.and_then(|v| reader::text(v, "checksum", log));
    let before = log.borrow().errors();
    let mesh = mesh::read(root, dimension);
    let mesh_understood = log.borrow().errors() == before;
    let materials = root
        .tables("material", "[[material]]")
        .into_iter()
        .flat_map(|t| material::read(t, dimension))
        .collect();
    let initial = root.tables("initial", "[[initial]]").into_iter();
    let initial = initial.filter_map(|t| initial::read(t, analysis)).collect();
    if root.get("material").is_none() {
        missing(root, "[[material]]", "on, young and poisson");
    }
    let (tools, tool_names) = tool::read_tools(root, analysis);
    let contacts = tool::read_contacts(root, dimension);
    let ties = tool::read_ties(root);
    let steps = root
        .tables("step", "[[step]]")
        .into_iter()
        .filter_map(|t| step::read(t, dimension))
        .collect();
    let empty = |v: Value<'_>| v.get_ref().as_array().is_some_and(|a| a.is_empty());
    if root.get("step").is_none_or(empty) {
        missing(root, "[[step]]", "name, increments, fix, move and load");
    }
    let solver = solver::read_solver(root);
    let output = solver::read_output(root);
    Deck {
        title: title.map_or_else(String::new, |t| t.value),
        units: units.unwrap_or(Units::MmNMpa),
        analysis,
        finite: finite.filter(|f| f.value),
        thickness: thickness.unwrap_or(At::new(1.0, 0..0)),
        mesh_files: mesh.files,
        checksum,
        found_checksum: None,
        blocks: mesh.blocks,
        groups: mesh.groups,
        mesh_understood,
        materials,
        initial,
        tools,
        tool_names,
        contacts,
        ties,
        steps,
        solver,
        directory: output.directory,
        vtu: output.vtu,
        points: output.points,
        checkpoint: output.checkpoint,
        probes: output.probes,
        expectations: solver::read_expectations(root),
    }
}

fn missing(root: &Table<'_>, what: &str, keys: &str) {
    root.log()
        .borrow_mut()
        .error(
            &root.span,
            format!("the deck has no {what}, expected at least one with {keys}"),
            format!("{what} is missing"),
        )
        .about(Class::Keys);
}
