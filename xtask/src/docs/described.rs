//! What the library tells of the files of results and of its command: asked of an example of its package, which
//! takes long to compile; not the pages.

use serde::Deserialize;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;

use verification::workspace;

/// All that is told.
#[derive(Debug, Deserialize)]
pub struct Described {
    /// Columns of `history.csv`.
    pub history: Vec<Entry>,
    /// Columns of `contact.csv`.
    pub contact: Vec<Entry>,
    /// Keys of `run.json`, those within others by the way to them.
    pub run: Vec<Entry>,
    /// The command.
    pub command: Program,
}

/// A column or a key.
#[derive(Debug, Deserialize)]
pub struct Entry {
    /// Name, with words in capitals for what is named elsewhere.
    pub name: String,
    /// Unit; empty where there is none.
    pub unit: String,
    /// What it is.
    pub meaning: String,
    /// When it is there; empty for always.
    pub when: String,
}

/// A command or a part of one.
#[derive(Debug, Deserialize)]
pub struct Program {
    /// As it is called.
    pub name: String,
    /// How it is called.
    pub usage: String,
    /// What it does.
    pub about: String,
    /// Arguments.
    pub arguments: Vec<Argument>,
    /// The parts.
    pub commands: Vec<Program>,
}

/// An argument of a command.
#[derive(Debug, Deserialize)]
pub struct Argument {
    /// As it is written, with its value.
    pub name: String,
    /// Whether it must be given.
    pub required: bool,
    /// What is taken where it is not given.
    pub default: String,
    /// Values that there are, if they are few.
    pub values: Vec<String>,
    /// What it does.
    pub help: String,
}

/// Asks the library, unless a file has what the example printed.
pub fn described(printed: Option<&Path>) -> Result<Described, Box<dyn Error>> {
    if let Some(path) = printed {
        return Ok(serde_json::from_slice(&fs::read(path)?)?);
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--quiet", "--package", "moreau"])
        .args(["--example", "reference", "--manifest-path"])
        .arg(workspace::root().join("Cargo.toml"))
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}
