//! What is found wrong or doubtful in a deck, and where; not the decision to go on or to stop.

use super::source::{Included, file_at, text_at};
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::ops::Range;
use std::path::Path;

/// A value of a deck and the bytes of the file that it was read from.
#[derive(Debug, Clone, PartialEq)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Where it stands in the text of the deck.
    pub span: Range<usize>,
}

impl<T> At<T> {
    /// A value and its place.
    pub fn new(value: T, span: Range<usize>) -> Self {
        Self { value, span }
    }
}

/// Whether a deck with a finding can be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// It cannot.
    Error,
    /// It can, but perhaps is not what was meant.
    Warning,
}

/// What a finding is about: the section of `docs/errors.md` with its cause and remedy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// The file is no TOML.
    Syntax,
    /// A file that cannot be included, or that says otherwise than what includes it.
    Includes,
    /// A key that does not exist, or one that is missing.
    Keys,
    /// A value of the wrong type or out of its range.
    Values,
    /// A name that does not exist, or that is given twice.
    Names,
    /// A group that is empty or cannot be made.
    Groups,
    /// A mesh that cannot be read or made.
    Meshes,
    /// A body without material, or free to move.
    Bodies,
    /// Conditions of a step that contradict each other.
    Steps,
    /// What can be run, but perhaps is not what was meant.
    Warnings,
}

impl Class {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Syntax,
        Self::Includes,
        Self::Keys,
        Self::Values,
        Self::Names,
        Self::Groups,
        Self::Meshes,
        Self::Bodies,
        Self::Steps,
        Self::Warnings,
    ];

    /// Name of the section.
    pub fn name(self) -> &'static str {
        [
            "syntax", "includes", "keys", "values", "names", "groups", "meshes", "bodies", "steps",
            "warnings",
        ][self as usize]
    }
}

/// One finding.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Error or warning.
    pub severity: Severity,
    /// What it is about.
    pub class: Class,
    /// What was found and what was expected.
    pub message: String,
    /// What stands at the place.
    pub label: String,
    /// The place in the text.
    pub span: Range<usize>,
    /// Another place that it is about, with what stands there.
    pub also: Option<(Range<usize>, String)>,
    /// What to do, if there is more to say.
    pub help: Option<String>,
}

impl Finding {
    /// Says what it is about; by default an error is about a value.
    pub(super) fn about(&mut self, class: Class) {
        self.class = class;
    }

    /// Says of another place that it is about.
    pub(super) fn and_at(&mut self, span: &Range<usize>, label: impl Into<String>) {
        self.also = Some((span.clone(), label.into()));
    }

    /// What to do, and where to read more.
    fn advice(&self) -> String {
        let class = self.class.name();
        let help = self.help.as_ref();
        let help = help.map_or_else(String::new, |help| format!("{help}; "));
        format!("{help}see docs/errors.md#{class}")
    }
}

/// The part of a place on its first line, which is enough, and within the text.
fn shown(span: &Range<usize>, text: &str) -> Range<usize> {
    let start = (0..=span.start.min(text.len())).rfind(|&k| text.is_char_boundary(k));
    let start = start.unwrap_or_default();
    let piece = text.get(start..span.end.clamp(start, text.len()));
    let line = piece.and_then(|piece| piece.lines().next());
    start..start + line.map_or(0, str::len)
}

/// All findings of a deck, in the order in which they were made.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    list: Vec<Finding>,
    /// Files that the deck includes.
    files: Vec<Included>,
}

impl Findings {
    /// Adds an error: the message, and the label at the place.
    pub fn error(
        &mut self,
        span: &Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
    ) -> &mut Finding {
        self.add(Severity::Error, span, message.into(), label.into(), None)
    }

    /// Adds an error with an advice.
    pub fn error_with(
        &mut self,
        span: &Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> &mut Finding {
        let help = Some(help.into());
        self.add(Severity::Error, span, message.into(), label.into(), help)
    }

    /// Adds a warning.
    pub fn warning(
        &mut self,
        span: &Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
    ) {
        self.add(Severity::Warning, span, message.into(), label.into(), None);
    }

    fn add(
        &mut self,
        severity: Severity,
        span: &Range<usize>,
        message: String,
        label: String,
        help: Option<String>,
    ) -> &mut Finding {
        let same = |f: &Finding| {
            f.severity == severity && f.span == *span && f.message == message && f.label == label
        };
        let at = match self.list.iter().position(same) {
            Some(at) => at,
            None => {
                self.list.push(Finding {
                    severity,
                    class: match severity {
                        Severity::Error => Class::Values,
                        Severity::Warning => Class::Warnings,
                    },
                    message,
                    label,
                    span: span.clone(),
                    also: None,
                    help,
                });
                self.list.len() - 1
            }
        };
        &mut self.list[at]
    }

    /// Takes back what was found at a place, by its message.
    pub(super) fn take_back(&mut self, span: &Range<usize>, message: &str) -> Option<Finding> {
        let this = |f: &Finding| f.span == *span && f.message == message;
        let at = self.list.iter().position(this)?;
        Some(self.list.remove(at))
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.list.iter()
    }

    /// Tells which files the deck includes.
    pub(super) fn include(&mut self, files: Vec<Included>) {
        self.files = files;
    }

    /// The file that a place is in, of those that the deck includes; `None` for its own.
    pub fn file(&self, place: &Range<usize>) -> Option<&Path> {
        Some(&file_at(&self.files, place.start)?.file)
    }

    /// The turn in which the file of a place is joined with the others, the deck last.
    pub(super) fn turn(&self, place: &Range<usize>) -> usize {
        file_at(&self.files, place.start).map_or(usize::MAX, |file| file.turn)
    }

    /// The folder that a path at a place is relative to, of those files; `None` for the deck itself.
    pub(super) fn folder(&self, place: &Range<usize>) -> Option<&Path> {
        Some(file_at(&self.files, place.start)?.folder())
    }

    /// All of them, with line and column of their places in the text of the deck or of the [file](Findings::file) that
    /// they are in, from 1.
    pub fn places(&self, text: &str) -> impl Iterator<Item = (&Finding, usize, usize)> {
        self.list.iter().map(move |finding| {
            let (text, span) = text_at(text, &self.files, &finding.span);
            let before = &text[..shown(&span, text).start];
            let (line, column) = match before.rsplit_once('\n') {
                Some((above, own)) => (2 + above.matches('\n').count(), own),
                None => (1, before),
            };
            (finding, line, 1 + column.chars().count())
        })
    }

    /// Number of errors.
    pub fn errors(&self) -> usize {
        self.count(Severity::Error)
    }

    /// Number of warnings.
    pub fn warnings(&self) -> usize {
        self.count(Severity::Warning)
    }

    fn count(&self, severity: Severity) -> usize {
        self.list.iter().filter(|f| f.severity == severity).count()
    }

    /// The findings as text for a terminal, in the order of the file: file, line and column, the
    /// line itself, and what is wrong with it.
    pub fn render(&self, file: &str, text: &str, colour: bool) -> String {
        let renderer = match colour {
            true => Renderer::styled(),
            false => Renderer::plain(),
        };
        let renderer = renderer.decor_style(DecorStyle::Unicode);
        let mut sorted: Vec<&Finding> = self.list.iter().collect();
        sorted.sort_by_key(|f| f.span.start);
        let mut out = String::new();
        for finding in sorted {
            let level = match finding.severity {
                Severity::Error => Level::ERROR,
                Severity::Warning => Level::WARNING,
            };
            let (own, place) = text_at(text, &self.files, &finding.span);
            let at = |span: &Range<usize>| self.file(span).map(|file| file.display().to_string());
            let path = |span: &Range<usize>| at(span).unwrap_or_else(|| file.to_owned());
            let primary = AnnotationKind::Primary.span(shown(&place, own));
            let source = Snippet::source(own).path(path(&finding.span));
            let mut snippets = vec![source.annotation(primary.label(finding.label.as_str()))];
            if let Some((span, label)) = &finding.also {
                let (other, place) = text_at(text, &self.files, span);
                let context = AnnotationKind::Context.span(shown(&place, other));
                let context = context.label(label.as_str());
                match at(span) == at(&finding.span) {
                    true => {
                        snippets = snippets
                            .into_iter()
                            .map(|s| s.annotation(context.clone()))
                            .collect()
                    }
                    false => {
                        snippets.push(Snippet::source(other).path(path(span)).annotation(context))
                    }
                }
            }
            let shown = level
                .primary_title(finding.message.as_str())
                .elements(snippets)
                .element(Level::HELP.message(finding.advice()));
            out.push_str(&renderer.render(&[shown]));
            out.push_str("\n\n");
        }
        out
    }
}

/// The candidate that is near to a name. One that has no letter of it is not.
pub(super) fn near<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let near = crate::mesh::nearest(name, candidates);
    let lower = name.to_lowercase();
    near.filter(|n| lower.chars().any(|c| n.to_lowercase().contains(c)))
}

/// `"; did you mean \"…\"?"`, if there is anything near.
pub(super) fn did_you_mean<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> String {
    near(name, candidates).map_or_else(String::new, |n| format!("; did you mean \"{n}\"?"))
}

/// `"a", "b" or "c"`.
pub(super) fn one_of(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|n| format!("\"{n}\"")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.join(""),
    }
}
