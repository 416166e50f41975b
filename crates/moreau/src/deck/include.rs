//! Files that a deck includes: found, read, and joined with it into one table; no other key is known here.

use super::finding::{At, Class};
use super::reader::Log;
use super::source::{Included, text_at};
use crate::files::nearest_file;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf, absolute};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const KEY: &str = "include";
/// The table whose keys in a deck replace those in what it includes.
const PARAMETERS: &str = "parameters";

/// A file among those read, with what it includes.
pub(super) struct Node {
    file: usize,
    includes: Vec<Node>,
}

/// Reads what a deck includes, each file once; what cannot be read is noted.
pub(super) fn read(text: &str, folder: &Path, log: &Log) -> (Vec<Node>, Vec<Included>) {
    let mut reading = Reading {
        log,
        files: Vec::new(),
        known: Vec::new(),
        open: Vec::new(),
        end: text.len() + 1,
        turn: 0,
    };
    let nodes = reading.inside(text, 0, folder);
    (nodes, reading.files)
}

struct Reading<'a> {
    log: &'a Log,
    files: Vec<Included>,
    /// Whole paths of the files, in their order.
    known: Vec<PathBuf>,
    /// Files that include each other, down to the one being read.
    open: Vec<usize>,
    /// Place behind all texts.
    end: usize,
    turn: usize,
}

impl Reading<'_> {
    /// What a text includes that begins at a place.
    fn inside(&mut self, text: &str, start: usize, folder: &Path) -> Vec<Node> {
        let (document, _) = DeTable::parse_recoverable(text);
        let Some(value) = document.into_inner().remove(KEY) else {
            return Vec::new();
        };
        let value = shifted(value, start);
        let paths = match value.get_ref() {
            DeValue::Array(items) => items.iter().collect(),
            _ => vec![&value],
        };
        let mut nodes = Vec::new();
        for path in paths {
            match path.get_ref().as_str() {
                Some(path_text) => {
                    let path = At::new(path_text.to_owned(), path.span());
                    nodes.extend(self.include(&path, folder));
                }
                None => self.error(
                    &path.span(),
                    "include is no path, expected \"FILE.toml\" or a list of such".into(),
                    "expected a text in quotes",
                ),
            }
        }
        nodes
    }

    fn include(&mut self, path: &At<String>, folder: &Path) -> Option<Node> {
        let file = folder.join(&path.value);
        let whole = fs::canonicalize(&file).or_else(|_| absolute(&file));
        let whole = whole.unwrap_or_else(|_| file.clone());
        if let Some(known) = self.known.iter().position(|known| *known == whole) {
            if let Some(from) = self.open.iter().position(|&open| open == known) {
                self.circle(path, &self.open[from..]);
            }
            return None;
        }
        let text = match fs::read_to_string(&file) {
            Ok(text) => text,
            Err(error) => {
                let missing = error.kind() == std::io::ErrorKind::NotFound;
                let near = missing.then(|| nearest_file(&file, &["toml"])).flatten();
                let near = near.map_or_else(String::new, |n| format!("; beside it is \"{n}\""));
                let shown = file.display();
                let message = format!("cannot read the included file {shown}: {error}{near}");
                self.error(&path.span, message, "this file");
                return None;
            }
        };
        let (start, at) = (self.end, self.files.len());
        self.end += text.len() + 1;
        self.known.push(whole);
        self.files.push(Included {
            file,
            text: text.clone(),
            start,
            turn: 0,
        });
        self.open.push(at);
        let folder = self.files[at].folder().to_owned();
        let includes = self.inside(&text, start, &folder);
        self.open.pop();
        self.files[at].turn = self.turn;
        self.turn += 1;
        Some(Node { file: at, includes })
    }

    fn circle(&self, path: &At<String>, open: &[usize]) {
        let name = |&k: &usize| self.files[k].file.display().to_string();
        let names: Vec<String> = open.iter().chain(&open[..1]).map(name).collect();
        let message = format!(
            "{} includes itself: {}",
            self.files[open[0]].file.display(),
            names.join(" includes ")
        );
        self.error(&path.span, message, "closes the circle");
    }

    fn error(&self, span: &Range<usize>, message: String, label: &str) {
        let help = "a path is relative to the folder of the file that it stands in";
        let mut findings = self.log.borrow_mut();
        findings
            .error_with(span, message, label, help)
            .about(Class::Includes);
    }
}

/// A value whose places begin later.
fn shifted(value: Spanned<DeValue<'_>>, by: usize) -> Spanned<DeValue<'_>> {
    let span = value.span();
    let inner = match value.into_inner() {
        DeValue::Array(items) => {
            DeValue::Array(items.into_iter().map(|item| shifted(item, by)).collect())
        }
        DeValue::Table(table) => DeValue::Table(shifted_table(table, by)),
        other => other,
    };
    Spanned::new(span.start + by..span.end + by, inner)
}

/// A table whose places begin later.
pub(super) fn shifted_table(table: DeTable<'_>, by: usize) -> DeTable<'_> {
    let entry = |(key, value): (Spanned<_>, _)| {
        let span = key.span();
        let key = Spanned::new(span.start + by..span.end + by, key.into_inner());
        (key, shifted(value, by))
    };
    table.into_iter().map(entry).collect()
}

/// The tables of a deck and of all that it includes, as one.
pub(super) struct Joining<'t, 'l> {
    /// Text of the deck.
    pub(super) own: &'t str,
    /// The files.
    pub(super) files: &'t [Included],
    /// Reads a text that begins at a place.
    pub(super) parse: fn(&'t str, usize, &Log) -> DeTable<'t>,
    pub(super) log: &'l Log,
}

impl<'t> Joining<'t, '_> {
    /// A table behind those that it includes.
    pub(super) fn with(&self, nodes: &[Node], mut own: DeTable<'t>) -> DeTable<'t> {
        let mut all = DeTable::new();
        for node in nodes {
            let file = &self.files[node.file];
            let table = (self.parse)(&file.text, file.start, self.log);
            self.add(&mut all, self.with(&node.includes, table), None, false);
        }
        own.remove(KEY);
        self.add(&mut all, own, None, true);
        all
    }

    /// Adds keys to the root, or to a table in it. Arrays of tables follow each other, keys of one table stand side by
    /// side, and parameters of the file that includes replace those before them.
    fn add(&self, all: &mut DeTable<'t>, more: DeTable<'t>, table: Option<&str>, includes: bool) {
        for (key, value) in more {
            let Some((before, mut given)) = all.remove_entry(&**key.get_ref()) else {
                all.insert(key, value);
                continue;
            };
            let span = value.span();
            match (given.get_mut(), value.into_inner()) {
                // In the place of what it replaces: other formulas use it.
                (_, value) if includes && table == Some(PARAMETERS) => {
                    given = Spanned::new(span, value);
                }
                (DeValue::Array(list), DeValue::Array(more)) if are_tables(list, &more) => {
                    more.into_iter().for_each(|item| list.push(item));
                }
                (DeValue::Table(given), DeValue::Table(more)) if table.is_none() => {
                    self.add(given, more, Some(before.get_ref()), includes);
                }
                _ => self.compare((&before, &given.span()), (&key, &span)),
            }
            all.insert(before, given);
        }
    }

    /// A key may be given again with the same value, and no other.
    fn compare<K: AsRef<str>>(
        &self,
        (before, given): (&Spanned<K>, &Range<usize>),
        (key, again): (&Spanned<K>, &Range<usize>),
    ) {
        let piece = |span: &Range<usize>| {
            let (text, at) = text_at(self.own, self.files, span);
            text.get(at).map(str::trim)
        };
        if piece(given) == piece(again) {
            return;
        }
        let name = key.get_ref().as_ref();
        let message = format!("the key \"{name}\" is given here and in another file, not alike");
        let help = "give it in one of them; only [parameters] replace those of an included file";
        let mut findings = self.log.borrow_mut();
        let finding = findings.error_with(&key.span(), message, "here", help);
        finding.and_at(&before.span(), "and here");
        finding.about(Class::Includes);
    }
}

fn are_tables<'t>(list: &[Spanned<DeValue<'t>>], more: &[Spanned<DeValue<'t>>]) -> bool {
    let mut all = list.iter().chain(more);
    all.all(|item| item.get_ref().is_table())
}
