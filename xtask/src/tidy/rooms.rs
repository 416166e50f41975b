//! Files and folders side by side in the sources of a package, and what they import of each other; not
//! what packages import, see `arrows`.

use std::collections::{BTreeMap, BTreeSet};

use super::Violation;
use super::lexer::{Kind, Token};
use super::source::Source;

/// How many files and folders may lie side by side: what a reader takes in at once.
const ROOMS: usize = 16;

/// How many may stand on top of each other, each importing the one below.
const LAYERS: usize = 9;

/// A module or an item: the names on the way from the root of its package.
type Path = Vec<String>;

/// The modules of a package.
struct Package<'a> {
    /// Its source folder, with `/` at the end.
    root: &'a str,
    modules: BTreeMap<Path, &'a Source>,
    /// Items that a module passes on, and where they come from.
    passed_on: BTreeMap<Path, Path>,
}

/// What is wrong with the order of the sources.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let roots: BTreeSet<&str> = sources
        .iter()
        .filter_map(|s| Some(place(&s.path)?.0))
        .collect();
    let packages = roots.into_iter().map(|root| Package::new(root, sources));
    packages.flat_map(|package| package.violations()).collect()
}

/// The source folder of a file and the names of its module there; `None` for what is not shipped.
fn place(path: &str) -> Option<(&str, Path)> {
    let at = path.find("src/")? + "src/".len();
    let (root, file) = path.split_at(at);
    let mut names: Path = file
        .strip_suffix(".rs")?
        .split('/')
        .map(str::to_owned)
        .collect();
    if names.iter().any(|name| name == "tests" || name == "bin") {
        return None;
    }
    names.pop_if(|name| ["lib", "main", "mod"].contains(&name.as_str()));
    Some((root, names))
}

impl<'a> Package<'a> {
    fn new(root: &'a str, sources: &'a [Source]) -> Self {
        let own = |source: &'a Source| {
            let (folder, names) = place(&source.path)?;
            (folder == root).then_some((names, source))
        };
        let mut package = Self {
            root,
            modules: sources.iter().filter_map(own).collect(),
            passed_on: BTreeMap::new(),
        };
        for (module, source) in &package.modules {
            for import in imports(source).into_iter().filter(|import| import.public) {
                if let (Some(from), Some(name)) =
                    (package.absolute(module, &import.path), import.path.last())
                {
                    let mut item = module.clone();
                    item.push(name.clone());
                    package.passed_on.insert(item, from);
                }
            }
        }
        package
    }

    /// A path from the root of the package, as it is written in a module; `None` where it leads elsewhere.
    fn absolute(&self, module: &Path, written: &[String]) -> Option<Path> {
        let mut path = module.clone();
        let (first, mut rest) = written.split_first()?;
        match first.as_str() {
            "crate" => path.clear(),
            "self" => {}
            "super" => {
                path.pop()?;
                while let Some((_, after)) = rest.split_first().filter(|(n, _)| *n == "super") {
                    path.pop()?;
                    rest = after;
                }
            }
            name => {
                path.push(name.to_owned());
                self.modules.get(&path)?;
            }
        }
        path.extend(rest.iter().cloned());
        Some(path)
    }

    /// The module that holds an item, wherever it is passed on.
    fn holder(&self, mut item: Path) -> Path {
        // Names are passed on a few times at most.
        for _ in 0..LAYERS {
            let passed = (1..=item.len()).find_map(|n| Some((n, self.passed_on.get(&item[..n])?)));
            let Some((n, from)) = passed else {
                break;
            };
            item = from.iter().chain(&item[n..]).cloned().collect();
        }
        while !self.modules.contains_key(&item) && item.pop().is_some() {}
        item
    }

    fn violations(&self) -> Vec<Violation> {
        let folders: BTreeSet<&[String]> = self
            .modules
            .keys()
            .filter_map(|module| Some(module.split_last()?.1))
            .collect();
        folders
            .into_iter()
            .flat_map(|folder| self.in_folder(folder))
            .collect()
    }

    fn in_folder(&self, folder: &[String]) -> Vec<Violation> {
        let imports = self.rooms(folder);
        let place = format!("{}{}", self.root, folder.join("/"));
        let mut violations = Vec::new();
        if imports.len() > ROOMS {
            let what = format!("{} files and folders side by side", imports.len());
            violations.push(Violation::new(&place, 1, what, format!("at most {ROOMS}")));
        }
        match layers(&imports) {
            Err(circle) => {
                let what = format!("a circle of imports: {}", circle.join(" → "));
                violations.push(Violation::new(&place, 1, what, "none"));
            }
            Ok(layers) if layers > LAYERS => {
                let what = format!("{layers} layers of imports");
                violations.push(Violation::new(&place, 1, what, format!("at most {LAYERS}")));
            }
            Ok(_) => {}
        }
        violations
    }

    /// The files and folders of a folder, a file and the folder of its name as one, and which import
    /// which.
    fn rooms(&self, folder: &[String]) -> BTreeMap<&str, BTreeSet<String>> {
        let depth = folder.len();
        let mut rooms: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
        let inside = |module: &Path| module.len() > depth && module.starts_with(folder);
        for (module, source) in self.modules.iter().filter(|(module, _)| inside(module)) {
            let own = rooms.entry(&module[depth]).or_default();
            for import in imports(source) {
                let item = self.absolute(module, &import.path);
                let holder = item.map(|item| self.holder(item)).unwrap_or_default();
                if inside(&holder) && holder[depth] != module[depth] {
                    own.insert(holder[depth].clone());
                }
            }
        }
        rooms
    }
}

/// The longest way down, in rooms, or a circle.
fn layers<'a>(imports: &BTreeMap<&'a str, BTreeSet<String>>) -> Result<usize, Vec<&'a str>> {
    /// Height of a room above the ground; the way down to it is on `way`.
    fn height<'a>(
        room: &'a str,
        imports: &BTreeMap<&'a str, BTreeSet<String>>,
        way: &mut Vec<&'a str>,
        known: &mut BTreeMap<&'a str, usize>,
    ) -> Result<usize, Vec<&'a str>> {
        if let Some(at) = way.iter().position(|r| *r == room) {
            let mut circle = way[at..].to_vec();
            circle.push(room);
            return Err(circle);
        }
        if let Some(height) = known.get(room) {
            return Ok(*height);
        }
        way.push(room);
        let mut most = 0;
        for name in imports.get(room).into_iter().flatten() {
            if let Some((below, _)) = imports.get_key_value(name.as_str()) {
                most = most.max(height(below, imports, way, known)?);
            }
        }
        way.pop();
        known.insert(room, most + 1);
        Ok(most + 1)
    }
    let mut known = BTreeMap::new();
    let mut heights = imports
        .keys()
        .map(|room| height(room, imports, &mut Vec::new(), &mut known));
    heights.try_fold(0, |most, height| Ok(most.max(height?)))
}

/// A path that a source writes.
struct Import {
    path: Path,
    /// Whether it is passed on.
    public: bool,
}

/// The paths that begin with `crate`, `self` or `super`, wherever they are, and all that are passed on.
fn imports(source: &Source) -> Vec<Import> {
    let tokens: Vec<&Token> = source.shipped().collect();
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let public = text(at) == "use" && at > 0 && ["pub", ")"].contains(&text(at - 1));
        let begins = ["crate", "self", "super"].contains(&text(at)) && text(at + 1) == "::";
        let follows = at > 0 && text(at - 1) == "::";
        if public || begins && !follows {
            let mut paths = Vec::new();
            let first = if public { at + 1 } else { at };
            at = tree(&tokens, first, &[], &mut paths);
            found.extend(paths.into_iter().map(|path| Import { path, public }));
        } else {
            at += 1;
        }
    }
    found
}

/// Reads a tree of paths such as `a::{b, c::d}` that begins at a token; returns where it ends.
fn tree(tokens: &[&Token], mut at: usize, before: &[String], paths: &mut Vec<Path>) -> usize {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut path = before.to_vec();
    loop {
        if text(at) == "{" {
            at += 1;
            while at < tokens.len() && text(at) != "}" {
                let begin = at;
                at = tree(tokens, at, &path, paths);
                // Commas, and what is no path.
                at += usize::from(at == begin || text(at) == ",");
            }
            return at + 1;
        }
        let Some(token) = tokens.get(at).filter(|t| t.kind == Kind::Word) else {
            break;
        };
        path.push(token.text.clone());
        at += 1;
        if text(at) != "::" {
            break;
        }
        at += 1;
    }
    paths.push(path);
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let source =
            |(path, text): &(&str, &str)| Source::new(&format!("crates/x/src/{path}"), text);
        let sources: Vec<Source> = files.iter().map(source).collect();
        let list = violations(&sources);
        list.iter().map(Violation::to_string).collect()
    }

    #[test]
    fn imports_that_point_one_way_pass() {
        let files = [
            (
                "lib.rs",
                "mod a; mod b; pub use a::{Top, c::Deep}; pub use b::Low;",
            ),
            ("a.rs", "pub mod c; use crate::b::Low; pub use c::Deep;"),
            ("a/c.rs", "use super::Top; use crate::Low;"),
            ("b.rs", "fn f() { self::g(); }"),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn circles_are_found_by_any_path() {
        for back in [
            "use crate::a::Top;",
            "use super::a::{c::Deep, Top};",
            "use crate::Top;",
            "fn f() -> usize { crate::a::size() }",
        ] {
            let files = [
                ("lib.rs", "mod a; mod b; pub use a::Top;"),
                ("a.rs", "mod c; use crate::b::Low;"),
                ("a/c.rs", ""),
                ("b.rs", back),
            ];
            let list = found(&files);
            let circle = "crates/x/src/:1: a circle of imports: a → b → a, expected none";
            assert_eq!(list, [circle], "{back}");
        }
        // What only tests import is no circle.
        let tested = "#[cfg(test)] mod tests { use crate::a::Top; }";
        let files = [("a.rs", "use crate::b::Low;"), ("b.rs", tested)];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn circles_within_a_folder_are_found() {
        let files = [
            ("a.rs", ""),
            ("a/b.rs", "use super::c::X;"),
            ("a/c.rs", "use crate::a::b::Y;"),
        ];
        assert_eq!(found(&files).len(), 1);
    }

    #[test]
    fn many_rooms_and_high_houses_are_found() {
        let name = |k: usize| format!("r{k}.rs");
        let many: Vec<(String, String)> = (0..=ROOMS).map(|k| (name(k), String::new())).collect();
        let high = (0..=LAYERS).map(|k| (name(k), format!("use crate::r{}::X;", k + 1)));
        let high: Vec<(String, String)> = high.collect();
        for (files, what) in [(many, "17 files and folders"), (high, "10 layers")] {
            let files: Vec<(&str, &str)> = files
                .iter()
                .map(|(a, b)| (a.as_str(), b.as_str()))
                .collect();
            let list = found(&files);
            assert_eq!(list.len(), 1);
            assert!(list[0].contains(what), "{list:?}");
            assert_eq!(found(&files[1..]), [""; 0]);
        }
    }
}
