//! Decks: one TOML file describes one problem; neither how it is solved nor what is written.
//!
//! A deck is read into typed [`entries`](Deck), every value with its place in the file, and built
//! into a [`Problem`], a driver with its steps. What is wrong or doubtful is collected as
//! [`Findings`], each with its place and what was expected; nothing is printed.
//!
//! ```
//! let text = r#"
//! units = "mm-N-MPa"
//! analysis = "plane-strain"
//! [[mesh.block]]
//! name = "block"
//! element = "quad8"
//! x = [0, 50]
//! y = [0, 20]
//! cells = [10, 2]
//! [[material]]
//! on = "blok"
//! young = 210000.0
//! poisson = 0.3
//! [[step]]
//! name = "pull"
//! increments = 1
//! fix = [{ on = "block.left", u = ["x", "y"] }]
//! move = [{ on = "block.right", u = { x = 0.1 } }]
//! "#;
//! let (_, problem, findings) = moreau::deck::open(text);
//! assert!(problem.is_none());
//! let shown = findings.render("bar.toml", text, false);
//! assert!(shown.contains("bar.toml:11:6") && shown.contains("did you mean \"block\"?"));
//!
//! let (_, problem, findings) = moreau::deck::open(&text.replace("blok", "block"));
//! assert!(problem.is_some() && findings.errors() == 0);
//! ```

mod build;
mod columns;
mod described;
mod echo;
mod entries;
mod finding;
mod formula;
mod grammar;
mod include;
mod reader;
mod source;
mod units;

pub use build::{Body, GroupFacts, Problem, Setup, Stage};
pub use entries::{
    Action, Adjust, Analysis, AxesEntry, BlockEntry, ConditionEntry, ContactEntry, Deck,
    DirectionsEntry, Expectation, FieldEntry, FileEntry, FrictionEntry, Grid, GroupEntry,
    Hardening, HillEntry, InitialEntry, MaterialEntry, Method, Part, Shape, SoilEntry, SolverEntry,
    StepEntry, ToolEntry, Vtu,
};
pub use finding::{At, Class, Finding, Findings, Severity};
pub use units::Units;

use crate::algebra::SharedTeam;
use crate::files::read_bytes;
use crate::laws::PanelLaw;
pub(crate) use columns::{columns, history_columns};
pub(crate) use described::{Described, Unit};
use flate2::Crc;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf, absolute};
use std::sync::Arc;

/// Mesh files that are not on disk: their contents, by the paths that decks give.
pub type Meshes = BTreeMap<PathBuf, Vec<u8>>;

/// Laws that stand in place of those of the materials of a deck, by the group of cells that a material is on.
pub type Laws = BTreeMap<String, Arc<dyn PanelLaw>>;

/// What a deck is given beside its text.
#[derive(Debug, Clone, Default)]
pub struct Given {
    /// Mesh files that are not on disk.
    pub meshes: Meshes,
    /// Values of parameters, in place of those of the deck.
    pub parameters: BTreeMap<String, f64>,
    /// Laws in place of those of its materials, under small strains.
    pub laws: Laws,
    /// The processes of a team, each of which opens the same deck; without one this process is alone.
    pub team: Option<SharedTeam>,
}

impl Given {
    /// Whether this process is another than the first of a team: it does what that one asks.
    fn serves(&self) -> bool {
        self.team.as_ref().is_some_and(|team| team.rank() > 0)
    }
}

/// JSON schema of decks, for editors: `docs/deck.schema.json`.
pub const SCHEMA: &str = include_str!("../deck.schema.json");

/// Reads a deck and builds its problem, if it has no error. The findings are errors and warnings.
/// Paths in it are relative to the current folder: see [`open_in`].
pub fn open(text: &str) -> (Deck, Option<Problem>, Findings) {
    open_in(text, Path::new(""))
}

/// As [`open`], with the paths in the deck relative to a folder: that of the deck's file.
pub fn open_in(text: &str, folder: &Path) -> (Deck, Option<Problem>, Findings) {
    open_with(text, folder, &Given::default())
}

/// As [`open_in`], with what is given beside the text.
pub fn open_with(text: &str, folder: &Path, given: &Given) -> (Deck, Option<Problem>, Findings) {
    let (mut deck, mut findings) = grammar::read(text, folder, &given.parameters);
    if grammar::includes_fail(&findings) {
        return (deck, None, findings);
    }
    let files = at_hand(&deck, folder, &given.meshes);
    deck.found_checksum = checksum(&deck, &files);
    check_checksum(&deck, &mut findings);
    let mut problem = build::build(&mut deck, &files, given, &mut findings);
    if given.serves() {
        // The first tells what else is wrong, and needs this one until then.
        return (deck, problem, findings);
    }
    expected(&deck, problem.as_ref(), &mut findings);
    let doubts = findings.iter().filter(|f| f.severity == Severity::Warning);
    let doubts = doubts.map(|f| f.message.clone()).collect();
    match &mut problem {
        Some(Problem::Plane(setup)) => setup.warnings = doubts,
        Some(Problem::Solid(setup)) => setup.warnings = doubts,
        None => {}
    }
    (deck, problem.filter(|_| findings.errors() == 0), findings)
}

/// Notes what cannot be expected of a problem: without a tolerance, or of no column. That keeps no problem from being built, so
/// that all of it is told at once.
fn expected(deck: &Deck, problem: Option<&Problem>, findings: &mut Findings) {
    let columns = problem.map(|problem| match problem {
        Problem::Plane(setup) => columns(setup),
        Problem::Solid(setup) => columns(setup),
    });
    for Expectation {
        column,
        relative,
        absolute,
        ..
    } in &deck.expectations
    {
        let is_it = |(name, _): &(String, Unit)| *name == column.value;
        if let Some(columns) = columns.as_ref().filter(|all| !all.iter().any(is_it)) {
            let names = columns.iter().map(|(name, _)| name.as_str());
            let near = finding::did_you_mean(&column.value, names);
            let message = format!("no result is called \"{}\"{near}", column.value);
            let unknown = findings.error(&column.span, message, "not a column of history.csv");
            unknown.about(Class::Names);
        }
        if relative.is_none() && absolute.is_none() {
            let message = format!("\"{}\" has no tolerance ≥ 0", column.value);
            findings.error(
                &column.span,
                message,
                "expected relative = … or absolute = …",
            );
        }
    }
}

/// The checksum of the files that a deck reads, as its key `checksum` has it, with some meshes that are not on disk; none
/// without files, or where one cannot be read.
pub fn checksum_of(text: &str, folder: &Path, meshes: &Meshes) -> Option<String> {
    let (deck, _) = grammar::read(text, folder, &BTreeMap::new());
    checksum(&deck, &at_hand(&deck, folder, meshes))
}

/// Checksums of what this process reads: the text of a deck with all that it includes, and the files that it names; empty
/// for those without files, or where one cannot be read.
#[cfg(feature = "distributed")]
pub(crate) fn sums(text: &str, folder: &Path, meshes: &Meshes) -> [String; 2] {
    let (_, included) = include::read(text, folder, &reader::Log::new(folder));
    let mut crc = Crc::new();
    crc.update(text.as_bytes());
    included.iter().for_each(|i| crc.update(i.text.as_bytes()));
    let files = checksum_of(text, folder, meshes);
    [format!("{:08x}", crc.sum()), files.unwrap_or_default()]
}

/// Of each mesh file of a deck its content, if that is not on disk.
fn at_hand<'a>(deck: &Deck, folder: &Path, meshes: &'a Meshes) -> Vec<Option<&'a [u8]>> {
    let content = |entry: &FileEntry| {
        let wanted = absolute(&entry.file.value).ok()?;
        let is_wanted = |path: &Path| absolute(folder.join(path)).is_ok_and(|at| at == wanted);
        let found = meshes.iter().find(|(path, _)| is_wanted(path));
        found.map(|(_, bytes)| bytes.as_slice())
    };
    deck.mesh_files.iter().map(content).collect()
}

/// The checksum of the files that a deck reads, of which some are at hand; none without files, or where one cannot be read.
fn checksum(deck: &Deck, at_hand: &[Option<&[u8]>]) -> Option<String> {
    let mut crc = Crc::new();
    for (entry, bytes) in deck.mesh_files.iter().zip(at_hand) {
        match bytes {
            Some(bytes) => crc.update(bytes),
            None => crc.update(&read_bytes(&entry.file.value).ok()?),
        }
    }
    let surfaces = deck
        .tools
        .iter()
        .filter_map(|tool| match &tool.shape.value {
            Shape::Triangles(entry) => Some(&entry.file),
            _ => None,
        });
    for file in surfaces {
        crc.update(&read_bytes(file).ok()?);
    }
    (crc.amount() > 0).then(|| format!("{:08x}", crc.sum()))
}

/// The files of a deck that tells their checksum must have it.
fn check_checksum(deck: &Deck, findings: &mut Findings) {
    let tools = deck.tools.iter().map(|t| &t.shape.value);
    let reads =
        !deck.mesh_files.is_empty() || tools.into_iter().any(|t| matches!(t, Shape::Triangles(_)));
    if let (Some(told), false) = (&deck.checksum, reads) {
        let message = "checksum of a deck that reads no file: it is that of its meshes and of surfaces of tools";
        findings.warning(&told.span, message, "of nothing");
    }
    if let (Some(told), Some(found)) = (&deck.checksum, &deck.found_checksum)
        && told.value != *found
    {
        let message = format!(
            "the checksum of the files that the deck reads is \"{found}\", expected \"{}\": a mesh or the surface of a tool \
             has changed",
            told.value
        );
        let help =
            "a run goes on with the files that it began with; run the deck anew with the others";
        let finding = findings.error_with(&told.span, message, "what they were", help);
        finding.about(Class::Meshes);
    }
}
