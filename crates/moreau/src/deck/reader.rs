//! Reading tables and values of a deck, noting what is not as expected; it knows no key.

use super::entries::FieldEntry;
use super::finding::{At, Class, Findings, did_you_mean, near, one_of};
use super::formula::{self, Mistake};
use std::cell::{Cell, Ref, RefCell, RefMut};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value with its place.
pub(super) type Value<'a> = &'a Spanned<DeValue<'a>>;

/// Where findings are collected while a deck is read, with the parameters that formulas may use, and what paths are
/// relative to.
pub(super) struct Log {
    folder: PathBuf,
    findings: RefCell<Findings>,
    parameters: RefCell<BTreeMap<String, f64>>,
    used: RefCell<BTreeSet<String>>,
}

impl Log {
    /// Of a deck whose paths are relative to a folder.
    pub(super) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            findings: RefCell::default(),
            parameters: RefCell::default(),
            used: RefCell::default(),
        }
    }

    /// A path that is relative to the folder of the file in which it stands.
    pub(super) fn path(&self, given: &At<String>) -> PathBuf {
        let findings = self.findings.borrow();
        let folder = findings.folder(&given.span).unwrap_or(&self.folder);
        folder.join(&given.value)
    }

    pub(super) fn borrow(&self) -> Ref<'_, Findings> {
        self.findings.borrow()
    }

    pub(super) fn borrow_mut(&self) -> RefMut<'_, Findings> {
        self.findings.borrow_mut()
    }

    pub(super) fn into_inner(self) -> Findings {
        self.findings.into_inner()
    }

    /// Whether something within a place, or at its end, is no TOML.
    fn is_no_toml(&self, place: &Range<usize>) -> bool {
        let within = |at: &Range<usize>| at.start <= place.end && place.start <= at.end;
        let findings = self.borrow();
        let mut all = findings.iter();
        all.any(|f| f.class == Class::Syntax && within(&f.span))
    }

    /// Lets formulas from here on use a parameter.
    pub(super) fn define(&self, name: &str, value: f64) {
        self.parameters.borrow_mut().insert(name.to_owned(), value);
    }

    /// Whether a formula used a parameter.
    pub(super) fn uses(&self, name: &str) -> bool {
        self.used.borrow().contains(name)
    }

    fn parameter(&self, name: &str) -> Option<f64> {
        let value = self.parameters.borrow().get(name).copied()?;
        self.used.borrow_mut().insert(name.to_owned());
        Some(value)
    }

    /// The value of a formula; what is wrong with it is noted.
    fn formula(&self, text: &str, what: &str, span: &Range<usize>) -> Option<f64> {
        match formula::value(text, &|name| self.parameter(name)) {
            Ok(value) if value.is_finite() => Some(value),
            other => self.mistaken((text, what), other, span),
        }
    }

    /// A formula of the position with the values of parameters in their place; what is wrong with it is noted.
    fn field(
        &self,
        text: &str,
        what: &str,
        axes: &'static [&'static str],
        span: &Range<usize>,
    ) -> Option<FieldEntry> {
        let twice = axes.iter().find(|axis| self.parameter(axis).is_some());
        if let Some(axis) = twice {
            let message = format!(
                "{what} is a formula of the position, and a parameter is called \"{axis}\""
            );
            let label = "call the parameter something else";
            self.borrow_mut().error(span, message, label);
            return None;
        }
        let place = |name: &str| axes.iter().position(|axis| *axis == name);
        let depends = Cell::new(false);
        let named = |name: &str| {
            let here = place(name).map(|_| 1.0);
            depends.set(depends.get() || here.is_some());
            here.or_else(|| self.parameter(name))
        };
        match formula::value(text, &named) {
            Ok(_) if depends.get() => {
                let text = formula::with_values(text, &|name| self.parameter(name));
                Some(FieldEntry::Formula(text))
            }
            Ok(value) if value.is_finite() => Some(FieldEntry::Constant(value)),
            other => self.mistaken((text, what), other, span),
        }
    }

    /// Notes what is wrong with a formula.
    fn mistaken<T>(
        &self,
        (text, what): (&str, &str),
        value: Result<f64, Mistake>,
        span: &Range<usize>,
    ) -> Option<T> {
        let parameters = self.parameters.borrow();
        let (message, label) = match value {
            Ok(value) => (
                format!("{what} is the formula \"={text}\", whose value is {value}"),
                "expected a finite number",
            ),
            Err(Mistake::Unknown(name)) if formula::reserved().any(|known| known == name) => (
                format!("the function \"{name}\" stands without its argument"),
                "as in sqrt(2)",
            ),
            Err(Mistake::Unknown(name)) => {
                let names = parameters.keys().map(String::as_str);
                let near = did_you_mean(&name, names.chain(["pi"]));
                (
                    format!("no parameter is called \"{name}\"{near}"),
                    "not in [parameters]",
                )
            }
            Err(Mistake::NoFunction(name)) => {
                let near = did_you_mean(&name, formula::reserved());
                (
                    format!("no function is called \"{name}\"{near}"),
                    "sqrt, exp, log, log10, sin, cos, tan, asin, acos, atan, tanh, abs, min, max",
                )
            }
            Err(Mistake::Arguments(name, found, expected)) => (
                format!("{name} is given {found} numbers, expected {expected}"),
                "with commas between them",
            ),
            Err(Mistake::Expected(expected, found)) => (
                format!("{what} is a formula with {found}, where {expected} was expected"),
                "numbers, parameters, + - * / ^, functions and ( )",
            ),
        };
        let mut findings = self.findings.borrow_mut();
        findings.error(span, message, label).about(Class::Values);
        None
    }
}

/// A table of the deck, of which keys are asked for; those never asked for are unknown.
pub(super) struct Table<'a> {
    table: &'a DeTable<'a>,
    /// Where it stands.
    pub(super) span: Range<usize>,
    /// What it is called in messages.
    name: String,
    known: RefCell<Vec<&'static str>>,
    /// Keys that must be there and are not, with what was said of them.
    missing: RefCell<Vec<(&'static str, String)>>,
    log: &'a Log,
}

impl<'a> Table<'a> {
    pub(super) fn new(
        table: &'a DeTable<'a>,
        span: Range<usize>,
        name: impl Into<String>,
        log: &'a Log,
    ) -> Self {
        Self {
            table,
            span,
            name: name.into(),
            known: RefCell::default(),
            missing: RefCell::default(),
            log,
        }
    }

    /// The log of the table.
    pub(super) fn log(&self) -> &'a Log {
        self.log
    }

    /// The value of a key, if it is there.
    pub(super) fn get(&self, key: &'static str) -> Option<Value<'a>> {
        let mut known = self.known.borrow_mut();
        if !known.contains(&key) {
            known.push(key);
        }
        self.table.get(key)
    }

    /// The values of those among some keys that are there.
    pub(super) fn given(&self, keys: &[&'static str]) -> Vec<(&'static str, Value<'a>)> {
        let value = |&key| Some((key, self.get(key)?));
        keys.iter().filter_map(value).collect()
    }

    /// The value of a key that must be there.
    pub(super) fn need(&self, key: &'static str, expected: &str) -> Option<Value<'a>> {
        let value = self.get(key);
        if value.is_none() {
            let name = &self.name;
            let message = format!("{name} has no key \"{key}\", expected {key} = {expected}");
            let label = format!("\"{key}\" is missing here");
            let mut findings = self.log.borrow_mut();
            findings
                .error(&self.span, &message, label)
                .about(Class::Keys);
            self.missing.borrow_mut().push((key, message));
        }
        value
    }

    /// Keys and values, in the order of the files, for tables whose keys are names of the user.
    pub(super) fn entries(&self) -> Vec<(At<String>, Value<'a>)> {
        let mut list: Vec<_> = self
            .table
            .iter()
            .map(|(k, v)| (At::new(k.get_ref().to_string(), k.span()), v))
            .collect();
        let findings = self.log.borrow();
        list.sort_by_key(|(key, _)| (findings.turn(&key.span), key.span.start));
        list
    }

    /// Reports the keys that were never asked for, and with one of them a missing one that it is near to.
    pub(super) fn finish(self) {
        let (known, missing) = (self.known.borrow(), self.missing.borrow());
        for (key, _) in self.entries() {
            if known.contains(&key.value.as_str()) {
                continue;
            }
            let symbol = |s: &&(&str, &str)| s.0 == key.value && known.contains(&s.1);
            let given = SYMBOLS.iter().find(symbol).map_or(&*key.value, |s| s.1);
            let near = near(given, known.iter().copied());
            let mut findings = self.log.borrow_mut();
            let wanted = missing.iter().find(|m| Some(m.0) == near);
            let wanted = wanted.and_then(|m| findings.take_back(&self.span, &m.1));
            let meant = did_you_mean(given, known.iter().copied());
            let unknown = findings.error_with(
                &key.span,
                format!("unknown key \"{}\" in {}{meant}", key.value, self.name),
                "not a key here",
                format!("{} has the keys {}", self.name, known.join(", ")),
            );
            unknown.about(Class::Keys);
            if let Some(wanted) = wanted {
                unknown.and_at(&wanted.span, wanted.label);
            }
        }
    }

    pub(super) fn text(&self, key: &'static str) -> Option<At<String>> {
        text(self.need(key, "\"…\"")?, key, self.log)
    }

    /// A text, or several.
    pub(super) fn texts(&self, key: &'static str, expected: &str) -> Option<Vec<At<String>>> {
        let value = self.need(key, expected)?;
        let items = match value.get_ref().is_array() {
            true => items(value, key, expected, self.log)?,
            false => vec![value],
        };
        if items.is_empty() {
            return wrong(value, key, "at least one", self.log);
        }
        let each = items.into_iter().map(|item| text(item, key, self.log));
        each.collect()
    }

    /// A name: letters, digits, `-`, `_` and `.`.
    pub(super) fn name(&self, key: &'static str) -> Option<At<String>> {
        let name = self.text(key)?;
        let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        if name.value.is_empty() || !name.value.chars().all(plain) {
            self.log.borrow_mut().error(
                &name.span,
                format!(
                    "{key} is {:?}, expected letters, digits, '-', '_' and '.'",
                    name.value
                ),
                "not a name",
            );
            return None;
        }
        Some(name)
    }

    pub(super) fn number(&self, key: &'static str) -> Option<At<f64>> {
        number(self.need(key, "a number")?, key, self.log)
    }

    pub(super) fn number_if(&self, key: &'static str) -> Option<At<f64>> {
        number(self.get(key)?, key, self.log)
    }

    pub(super) fn boolean_if(&self, key: &'static str) -> Option<At<bool>> {
        let value = self.get(key)?;
        match value.get_ref().as_bool() {
            Some(b) => Some(At::new(b, value.span())),
            None => wrong(value, key, "true or false", self.log),
        }
    }

    pub(super) fn choice(
        &self,
        key: &'static str,
        choices: &[&'static str],
    ) -> Option<At<&'static str>> {
        let value = self.need(key, &one_of(choices))?;
        choice(value, key, choices, self.log)
    }

    pub(super) fn choice_if(
        &self,
        key: &'static str,
        choices: &[&'static str],
    ) -> Option<At<&'static str>> {
        choice(self.get(key)?, key, choices, self.log)
    }

    /// The tables of an array under a key; none if it is not there.
    pub(super) fn tables(&self, key: &'static str, shown: &str) -> Vec<Table<'a>> {
        match self.get(key) {
            Some(value) => tables(value, key, shown, self.log),
            None => Vec::new(),
        }
    }
}

/// Notes that a value is of the wrong type.
pub(super) fn wrong<T>(value: Value<'_>, what: &str, expected: &str, log: &Log) -> Option<T> {
    // What is no TOML is told as that.
    if log.is_no_toml(&value.span()) {
        return None;
    }
    let found = match value.get_ref() {
        DeValue::String(s) => format!("the text {:?}", s.as_ref()),
        DeValue::Integer(n) => format!("the integer {}", n.as_str()),
        DeValue::Float(n) => format!("the number {}", n.as_str()),
        DeValue::Boolean(b) => format!("{b}"),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(a) => format!("an array of {}", a.len()),
        DeValue::Table(_) => "a table".into(),
    };
    log.borrow_mut().error(
        &value.span(),
        format!("{what} is {found}, expected {expected}"),
        format!("expected {expected}"),
    );
    None
}

pub(super) fn text(value: Value<'_>, what: &str, log: &Log) -> Option<At<String>> {
    match value.get_ref().as_str() {
        Some(text) => Some(At::new(text.to_owned(), value.span())),
        None => wrong(value, what, "a text in quotes", log),
    }
}

/// A finite number; integers are numbers.
pub(super) fn number(value: Value<'_>, what: &str, log: &Log) -> Option<At<f64>> {
    let span = value.span();
    let parsed = match value.get_ref() {
        DeValue::Float(f) => f.as_str().replace('_', "").parse::<f64>().ok(),
        DeValue::Integer(i) => i64::from_str_radix(&i.as_str().replace('_', ""), i.radix())
            .ok()
            .map(|n| n as f64),
        DeValue::String(text) if text.starts_with('=') => {
            let value = log.formula(&text[1..], what, &value.span())?;
            return Some(At::new(value, span));
        }
        DeValue::String(text)
            if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) =>
        {
            let expected = "a number: without quotes, and in the units of the deck";
            return wrong(value, what, expected, log);
        }
        _ => return wrong(value, what, "a number", log),
    };
    match parsed.filter(|n| n.is_finite()) {
        Some(n) => Some(At::new(n, value.span())),
        None => wrong(value, what, "a finite number", log),
    }
}

/// A number, or a formula of the position by its coordinates.
pub(super) fn field(
    value: Value<'_>,
    what: &str,
    dimension: usize,
    log: &Log,
) -> Option<FieldEntry> {
    const AXES: &[&str] = &["x", "y", "z"];
    match value.get_ref() {
        DeValue::String(text) if text.starts_with('=') => {
            log.field(&text[1..], what, &AXES[..dimension.min(3)], &value.span())
        }
        _ => Some(FieldEntry::Constant(number(value, what, log)?.value)),
    }
}

/// An integer in a range.
pub(super) fn integer(
    value: Value<'_>,
    what: &str,
    range: std::ops::RangeInclusive<usize>,
    log: &Log,
) -> Option<At<usize>> {
    let parsed = match value.get_ref() {
        DeValue::Integer(i) => usize::from_str_radix(&i.as_str().replace('_', ""), i.radix()).ok(),
        DeValue::String(text) if text.starts_with('=') => {
            let value = log.formula(&text[1..], what, &value.span())?;
            let whole = value.fract() == 0.0 && (0.0..1e15).contains(&value);
            whole.then_some(value as usize)
        }
        _ => return wrong(value, what, "an integer", log),
    };
    match parsed.filter(|n| range.contains(n)) {
        Some(n) => Some(At::new(n, value.span())),
        None => {
            let expected = format!("an integer from {} to {}", range.start(), range.end());
            wrong(value, what, &expected, log)
        }
    }
}

pub(super) fn choice(
    value: Value<'_>,
    what: &str,
    choices: &[&'static str],
    log: &Log,
) -> Option<At<&'static str>> {
    let given = text(value, what, log)?;
    if let Some(found) = choices.iter().find(|c| **c == given.value) {
        return Some(At::new(found, given.span));
    }
    let near = did_you_mean(&given.value, choices.iter().copied());
    log.borrow_mut().error(
        &given.span,
        format!(
            "{what} is \"{}\", expected {}{near}",
            given.value,
            one_of(choices)
        ),
        "not one of these",
    );
    None
}

/// The items of an array.
pub(super) fn items<'a>(
    value: Value<'a>,
    what: &str,
    expected: &str,
    log: &Log,
) -> Option<Vec<Value<'a>>> {
    match value.get_ref().as_array() {
        Some(array) => Some(array.iter().collect()),
        None => wrong(value, what, expected, log),
    }
}

/// An array of numbers.
pub(super) fn numbers(value: Value<'_>, what: &str, log: &Log) -> Option<At<Vec<f64>>> {
    let list: Vec<Option<At<f64>>> = items(value, what, "an array of numbers", log)?
        .into_iter()
        .map(|v| number(v, what, log))
        .collect();
    let list: Option<Vec<f64>> = list.into_iter().map(|n| Some(n?.value)).collect();
    Some(At::new(list?, value.span()))
}

/// An array of as many numbers as there are dimensions.
pub(super) fn vector(
    value: Value<'_>,
    what: &str,
    dimension: usize,
    log: &Log,
) -> Option<At<Vec<f64>>> {
    let expected = match dimension {
        2 => "2 numbers, [ …, … ]",
        _ => "3 numbers, [ …, …, … ]",
    };
    let fits = |value: Value<'_>| Some(value.get_ref().as_array()?.len() == dimension);
    match fits(value) {
        Some(true) => numbers(value, what, log),
        _ => wrong(value, what, expected, log),
    }
}

/// Symbols of formulas, and words that belong one table further in, with the keys that stand for them.
const SYMBOLS: [(&str, &str); 17] = [
    ("E", "young"),
    ("nu", "poisson"),
    ("sigma_y", "yield-stress"),
    ("sigma-y", "yield-stress"),
    ("H", "hardening"),
    ("c", "cohesion"),
    ("phi", "friction-angle"),
    ("psi", "dilatancy-angle"),
    ("mu", "coulomb"),
    ("mu", "friction"),
    ("pressure", "load"),
    ("traction", "load"),
    ("force", "load"),
    ("body-force", "load"),
    ("displacement", "move"),
    ("turn", "tools"),
    ("moment", "tools"),
];

/// A table, as an inline one or under a header.
pub(super) fn table<'a>(
    value: Value<'a>,
    what: &str,
    shown: impl Into<String>,
    log: &'a Log,
) -> Option<Table<'a>> {
    let shown = shown.into();
    match value.get_ref().as_table() {
        Some(table) => Some(Table::new(table, value.span(), shown, log)),
        None => wrong(value, what, "a table { … }", log),
    }
}

/// The tables of an array.
pub(super) fn tables<'a>(
    value: Value<'a>,
    what: &str,
    shown: &str,
    log: &'a Log,
) -> Vec<Table<'a>> {
    if let Some(one) = value.get_ref().as_table() {
        // Read all the same: what refers to it is not wrong as well.
        let how = match shown.starts_with("[[") {
            true => format!("{shown} with two brackets, once for each"),
            false => "[ { … } ], one table for each".into(),
        };
        let message = format!("{what} is one table, expected a list: {how}");
        log.borrow_mut()
            .error(&value.span(), message, "expected a list");
        return vec![Table::new(one, value.span(), shown, log)];
    }
    items(value, what, "an array of tables", log)
        .unwrap_or_default()
        .into_iter()
        .filter_map(|v| table(v, what, shown, log))
        .collect()
}
