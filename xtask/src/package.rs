//! `cargo xtask package`: every crate is packed, and what was packed is built and run away from the workspace, as whoever
//! takes it from a registry would; nothing is published.

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde::Deserialize;
use verification::scratch::Scratch;
use verification::workspace;

/// The crate with the command.
const COMMAND: &str = "moreau";
/// The deck that the command runs.
const DECK: &str = "docs/examples/punched-block.toml";
/// What must be in a package for its licences to be kept.
const TEXTS: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    target_directory: PathBuf,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: String,
    /// Registries that it may go to: none at all of what stays here.
    publish: Option<Vec<String>>,
    dependencies: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    name: String,
    kind: Option<String>,
}

impl Package {
    fn folder(&self) -> String {
        format!("{}-{}", self.name, self.version)
    }

    /// Whether it needs another to be built.
    fn needs(&self, name: &str) -> bool {
        let built = |d: &Dependency| d.kind.as_deref() != Some("dev") && d.name == name;
        self.dependencies.iter().any(built)
    }
}

/// Packs, unpacks, builds and runs; `Ok(false)` where a step of it fails.
pub fn run() -> Result<bool, Box<dyn Error>> {
    let root = workspace::root();
    let told = cargo(&root)
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .output()?;
    let Metadata {
        packages,
        target_directory: built,
    } = serde_json::from_slice(&told.stdout)?;
    let all = packages.into_iter();
    let packages = ordered(
        all.filter(|p| p.publish.as_ref().is_none_or(|to| !to.is_empty()))
            .collect(),
    )?;
    let mut pack = cargo(&root);
    // What is not committed yet is looked at as well.
    pack.args(["package", "--no-verify", "--quiet", "--allow-dirty"]);
    for package in &packages {
        pack.args(["--package", &package.name]);
    }
    if !pack.status()?.success() {
        return Ok(false);
    }
    let scratch = Scratch::new()?;
    for package in &packages {
        let folder = package.folder();
        let archive = built.join("package").join(format!("{folder}.crate"));
        let size = fs::metadata(&archive)?.len();
        unpacked(&archive, scratch.path())?;
        for text in TEXTS {
            if !scratch.path().join(&folder).join(text).is_file() {
                println!("✗ {folder}: no {text}");
                return Ok(false);
            }
        }
        println!(
            "{:<16} {} {:>6.1} kB",
            package.name,
            package.version,
            size as f64 / 1e3
        );
    }
    // The versions of all that is foreign are those of the workspace.
    fs::copy(root.join("Cargo.lock"), scratch.path().join("Cargo.lock"))?;
    scratch.write("Cargo.toml", &manifest(&packages))?;
    let target = built.join("packed");
    for package in &packages {
        let status = cargo(scratch.path())
            .args(["build", "--release", "--quiet", "--package", &package.name])
            .arg("--target-dir")
            .arg(&target)
            .status()?;
        if !status.success() {
            println!("✗ {} does not build from its package", package.folder());
            return Ok(false);
        }
        println!("✓ {} builds from its package", package.folder());
    }
    let out = scratch.path().join("out");
    let program = target.join("release").join(COMMAND);
    let status = Command::new(program.with_extension(std::env::consts::EXE_EXTENSION))
        .arg("run")
        .arg(root.join(DECK))
        .arg("--out")
        .arg(&out)
        .stderr(Stdio::null())
        .status()?;
    let sign = if status.success() { '✓' } else { '✗' };
    println!("{sign} the packed {COMMAND} runs {DECK}");
    Ok(status.success())
}

fn cargo(folder: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(folder);
    cargo
}

fn unpacked(archive: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    let status = Command::new("tar")
        .arg("-xzf")
        .arg(archive)
        .arg("-C")
        .arg(to)
        .status()?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("{} does not unpack", archive.display()).into()),
    }
}

/// Each after those that it needs.
fn ordered(mut left: Vec<Package>) -> Result<Vec<Package>, String> {
    let mut order = Vec::new();
    while !left.is_empty() {
        let free = |p: &Package| left.iter().all(|other| !p.needs(&other.name));
        match left.iter().position(free) {
            Some(at) => order.push(left.remove(at)),
            None => return Err("packages need each other in a circle".into()),
        }
    }
    Ok(order)
}

/// A workspace of what was unpacked, in which the packages find each other.
fn manifest(packages: &[Package]) -> String {
    let folders: Vec<String> = packages.iter().map(Package::folder).collect();
    let mut text = format!("[workspace]\nresolver = \"3\"\nmembers = {folders:?}\n\n");
    text.push_str("[patch.crates-io]\n");
    for (package, folder) in packages.iter().zip(&folders) {
        // A text takes whatever is written to it.
        let _ = writeln!(text, "{} = {{ path = {folder:?} }}", package.name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, needs: &[(&str, Option<&str>)]) -> Package {
        let dependency = |(name, kind): &(&str, Option<&str>)| Dependency {
            name: (*name).to_owned(),
            kind: kind.map(str::to_owned),
        };
        Package {
            name: name.to_owned(),
            version: "1.0.0".to_owned(),
            publish: None,
            dependencies: needs.iter().map(dependency).collect(),
        }
    }

    #[test]
    fn what_is_needed_comes_first_and_tests_need_nothing() {
        let list = vec![
            package("top", &[("middle", None), ("foreign", None)]),
            package("middle", &[("base", None), ("top", Some("dev"))]),
            package("base", &[]),
        ];
        let order = ordered(list).expect("an order");
        let names: Vec<&str> = order.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["base", "middle", "top"]);
        let circle = vec![package("a", &[("b", None)]), package("b", &[("a", None)])];
        assert!(ordered(circle).is_err());
    }

    #[test]
    fn packages_find_each_other() {
        let text = manifest(&[package("a", &[])]);
        let table: toml::Table = text.parse().expect("a manifest");
        assert_eq!(
            table["patch"]["crates-io"]["a"]["path"].as_str(),
            Some("a-1.0.0")
        );
    }
}
