//! The command as a person runs it: exit status, what it says, and the files that it leaves.

mod answers;
mod doubts;
mod files;
mod pictures;
mod processes;
mod resume;
mod same;
mod status;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A ball pressed into a quarter of a block of hexahedra.
const BALL: &str = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "hex8", x = [0, 4], y = [0, 4], z = [0, 4], cells = [4, 4, 4] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "ball", sphere = { center = [0, 14, 0], radius = 10 } }]
contact = [{ surface = "b.top", against = "ball", friction = 0.3 }]
[[step]]
name = "press"
increments = 2
fix = [
  { on = "b.bottom", u = ["y"] },
  { on = "b.left", u = ["x"] },
  { on = "b.back", u = ["z"] },
]
tools = [{ name = "ball", move = [0, -0.2, 0] }]
"#;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples")
}

fn directory(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Nothing may be there yet.
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a directory");
    path
}

/// On one thread where it is not told otherwise: as many programs as there are threads run side by side.
fn moreau(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_moreau"))
        .args(arguments)
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What is told but for the doubts of a run.
fn errors(told: &[u8]) -> String {
    let told = text(told);
    let lines = told.lines().filter(|line| !line.starts_with("warning: "));
    lines.map(|line| format!("{line}\n")).collect()
}

/// Runs a deck, given as text, into a directory; status, stdout and stderr.
fn run(name: &str, deck: &str, more: &[&str]) -> (i32, String, String, PathBuf) {
    let at = directory(name);
    let file = at.join("deck.toml");
    fs::write(&file, deck).expect("a deck");
    let out = at.join("results");
    let mut arguments = vec!["run", file.to_str().expect("a path"), "--out"];
    arguments.push(out.to_str().expect("a path"));
    arguments.extend(more);
    let output = moreau(&arguments);
    let status = output.status.code().expect("a status");
    (status, text(&output.stdout), text(&output.stderr), out)
}

fn punched() -> String {
    fs::read_to_string(examples().join("punched-block.toml")).expect("the example")
}

/// A column of history.csv, by the name before its unit.
fn column(results: &Path, name: &str) -> Vec<f64> {
    let history = fs::read_to_string(results.join("history.csv")).expect("a history");
    let mut lines = history.lines();
    let header = lines.next().expect("a header");
    let at = header
        .split(',')
        .position(|h| h.split(' ').next() == Some(name));
    let at = at.unwrap_or_else(|| panic!("{name} in {header}"));
    let value = |line: &str| line.split(',').nth(at).and_then(|v| v.parse().ok());
    lines.map(|l| value(l).expect("a number")).collect()
}

fn last(results: &Path, name: &str) -> f64 {
    column(results, name).pop().expect("a row")
}
