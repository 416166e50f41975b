//! Which package may depend on which; not which version.

use std::error::Error;
use std::path::Path;
use std::process::Command;

use serde::Deserialize;

use super::Violation;
use super::tree::Tree;

/// Each package of the workspace, and those it may import.
const ALLOWED: [(&str, &[&str]); 11] = [
    ("moreau-algebra", &[]),
    ("moreau-mandel", &[]),
    ("moreau-mumps", &["moreau-algebra"]),
    ("moreau-mesh", &["moreau-mandel"]),
    ("moreau-laws", &["moreau-mandel"]),
    (
        "moreau-contact",
        &["moreau-algebra", "moreau-laws", "moreau-mandel"],
    ),
    (
        "moreau-driver",
        &[
            "moreau-algebra",
            "moreau-contact",
            "moreau-laws",
            "moreau-mandel",
            "moreau-mesh",
        ],
    ),
    (
        "moreau",
        &[
            "moreau-algebra",
            "moreau-contact",
            "moreau-driver",
            "moreau-laws",
            "moreau-mandel",
            "moreau-mesh",
            "moreau-mumps",
        ],
    ),
    ("verification", &["moreau"]),
    ("benchmarks", &["moreau", "verification"]),
    ("xtask", &["verification"]),
];

/// Foreign packages that some packages only may import.
const CONFINED: [(&str, &[&str]); 1] = [("faer", &["moreau-algebra"])];

/// A package of the workspace, as cargo tells it.
#[derive(Debug, Deserialize)]
pub struct Package {
    name: String,
    manifest_path: String,
    dependencies: Vec<Dependency>,
}

#[derive(Debug, Deserialize)]
struct Dependency {
    name: String,
}

#[derive(Debug, Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

/// The packages of the workspace at a root, with manifest paths relative to it.
pub fn packages(root: &Path) -> Result<Vec<Package>, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args([
            "metadata",
            "--no-deps",
            "--format-version",
            "1",
            "--offline",
        ])
        .current_dir(root)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().into());
    }
    let mut metadata: Metadata = serde_json::from_slice(&output.stdout)?;
    for package in &mut metadata.packages {
        let path = Path::new(&package.manifest_path);
        let relative = path.strip_prefix(root).unwrap_or(path);
        package.manifest_path = relative.to_string_lossy().replace('\\', "/");
    }
    Ok(metadata.packages)
}

/// Dependencies, of any kind, that point the wrong way.
pub fn violations(packages: &[Package], tree: &Tree) -> Vec<Violation> {
    let ours = |name: &str| ALLOWED.iter().any(|(package, _)| *package == name);
    let mut violations = Vec::new();
    for package in packages {
        let manifest = package.manifest_path.as_str();
        let Some((_, allowed)) = ALLOWED.iter().find(|(name, _)| *name == package.name) else {
            let expected = "a place for it in the layers of xtask/src/tidy/arrows.rs";
            violations.push(Violation::new(
                manifest,
                1,
                format!("new package {}", package.name),
                expected,
            ));
            continue;
        };
        for Dependency { name } in &package.dependencies {
            let line = line_of(name, tree.text(manifest).unwrap_or_default());
            let what = format!("{} depends on {name}", package.name);
            if ours(name) && !allowed.contains(&name.as_str()) {
                let expected = if allowed.is_empty() {
                    "no package of the workspace".to_owned()
                } else {
                    format!("none but {}", allowed.join(", "))
                };
                violations.push(Violation::new(manifest, line, what, expected));
            } else if let Some((_, owners)) = CONFINED.iter().find(|(foreign, _)| foreign == name)
                && !owners.contains(&package.name.as_str())
            {
                violations.push(Violation::new(
                    manifest,
                    line,
                    what,
                    format!("only {} to", owners.join(" and ")),
                ));
            }
        }
    }
    violations
}

/// The line of a manifest that names a package as a dependency.
fn line_of(name: &str, manifest: &str) -> usize {
    let names = |line: &str| {
        let begins = line
            .strip_prefix(name)
            .is_some_and(|rest| rest.starts_with([' ', '.', '=']));
        begins || line.contains(&format!("\"{name}\"")) || line.ends_with(&format!(".{name}]"))
    };
    let in_dependencies = manifest
        .lines()
        .enumerate()
        .skip_while(|(_, line)| !(line.starts_with('[') && line.contains("dependencies")));
    let found = in_dependencies
        .into_iter()
        .find(|(_, line)| names(line.trim()));
    found.map_or(1, |(at, _)| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, dependencies: &[&str]) -> Vec<String> {
        let dependencies = dependencies
            .iter()
            .map(|name| Dependency {
                name: (*name).to_owned(),
            })
            .collect();
        let package = Package {
            name: name.to_owned(),
            manifest_path: "x/Cargo.toml".into(),
            dependencies,
        };
        let list = violations(&[package], &Tree::default());
        list.iter().map(Violation::to_string).collect()
    }

    #[test]
    fn arrows_that_point_down_pass() {
        assert!(
            found(
                "moreau-driver",
                &["moreau-contact", "moreau-mesh", "moreau-algebra"]
            )
            .is_empty()
        );
        assert!(found("moreau-algebra", &["faer"]).is_empty());
        assert!(found("verification", &["moreau", "nalgebra"]).is_empty());
    }

    #[test]
    fn arrows_that_point_up_or_aside_are_found() {
        for (package, dependency) in [
            ("moreau-laws", "moreau-mesh"),
            ("moreau-mesh", "moreau-laws"),
            ("moreau-contact", "moreau-mesh"),
            ("moreau-algebra", "moreau-mesh"),
            ("moreau-mandel", "moreau-laws"),
            ("moreau", "verification"),
            ("verification", "moreau-driver"),
        ] {
            let list = found(package, &["nalgebra", dependency]);
            assert_eq!(list.len(), 1, "{package} ▸ {dependency}");
            assert!(list[0].starts_with(&format!(
                "x/Cargo.toml:1: {package} depends on {dependency}, expected"
            )));
        }
    }

    #[test]
    fn foreign_packages_are_confined() {
        assert_eq!(found("moreau-laws", &["faer"]).len(), 1);
        assert_eq!(found("moreau-driver", &["faer"]).len(), 1);
    }

    #[test]
    fn a_package_without_a_place_is_found() {
        assert_eq!(found("moreau-gui", &[]).len(), 1);
    }

    #[test]
    fn the_line_is_that_of_the_dependency() {
        let manifest = "[package]\nname = \"moreau-laws\"\n[dependencies]\nmoreau-mesh-x = 1\n\
                        moreau-mesh.workspace = true\n[dev-dependencies]\na = { package = \"b\" }\n";
        assert_eq!(line_of("moreau-mesh", manifest), 5);
        assert_eq!(line_of("b", manifest), 7);
        assert_eq!(line_of("missing", manifest), 1);
    }

    #[test]
    fn cargo_tells_the_packages_of_this_workspace() {
        let packages = packages(&verification::workspace::root()).unwrap();
        let this = packages
            .iter()
            .find(|package| package.name == "xtask")
            .unwrap();
        assert_eq!(this.manifest_path, "xtask/Cargo.toml");
        assert!(
            this.dependencies
                .iter()
                .any(|dependency| dependency.name == "verification")
        );
    }
}
