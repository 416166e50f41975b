//! Which crate declares which items, and in what; a rough index by name, not name resolution.

use std::collections::BTreeSet;

use super::lexer::{Kind, Token};
use super::source::Source;

/// Words after which an item is named.
const KEYWORDS: [&str; 10] = [
    "fn",
    "struct",
    "enum",
    "trait",
    "type",
    "const",
    "static",
    "mod",
    "union",
    "macro_rules",
];

/// Items of the sources, tests excluded.
#[derive(Debug, Default)]
pub struct Items {
    /// Crate, owner and name. An owner is a type or trait named in the head of the block that holds
    /// the item, or a module; the owner of all items of a crate is the crate.
    members: BTreeSet<(String, String, String)>,
}

impl Items {
    /// Collects the items.
    pub fn of(sources: &[Source]) -> Self {
        let mut items = Self::default();
        for source in sources {
            if let Some((package, modules)) = place(&source.path) {
                items.add(&package, &modules, source);
            }
        }
        items
    }

    /// Whether a path such as `moreau_laws::Coulomb::project` leads to an item: the crate declares the
    /// last segment in what the segment before it names. The facade `moreau` has what the others have.
    pub fn has(&self, path: &str) -> bool {
        let segments: Vec<&str> = path.split("::").collect();
        let [package, .., owner, name] = segments[..] else {
            return self.has_in_crate(&segments);
        };
        self.declares(package, owner, name) && self.declares(package, package, owner)
    }

    fn has_in_crate(&self, segments: &[&str]) -> bool {
        matches!(segments, [package, name] if self.declares(package, package, name))
    }

    fn declares(&self, package: &str, owner: &str, name: &str) -> bool {
        self.members.iter().any(|(p, o, n)| {
            let same = n == name && (p == package || package == "moreau");
            same && (o == owner || (owner == package && o == p))
        })
    }

    fn add(&mut self, package: &str, modules: &[String], source: &Source) {
        let tokens: Vec<&Token> = source.shipped().collect();
        let mut enter = |owners: &[String], name: &str| {
            for owner in owners.iter().chain(modules).chain([&package.to_owned()]) {
                self.members
                    .insert((package.to_owned(), owner.clone(), name.to_owned()));
            }
        };
        for module in modules {
            enter(&[], module);
        }
        // Heads of the blocks around the current token, and the words since the last block or item.
        let mut blocks: Vec<Vec<String>> = Vec::new();
        let mut head: Vec<String> = Vec::new();
        let mut parentheses = 0_usize;
        for (at, token) in tokens.iter().enumerate() {
            match token.text.as_str() {
                "{" => blocks.push(std::mem::take(&mut head)),
                "}" => {
                    blocks.pop();
                    head.clear();
                }
                ";" => head.clear(),
                "(" | "[" => parentheses += 1,
                ")" | "]" => parentheses = parentheses.saturating_sub(1),
                _ => {}
            }
            if token.kind != Kind::Word {
                continue;
            }
            let owners = blocks.last().map_or(&[][..], Vec::as_slice);
            let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
            let previous = at.checked_sub(1).map_or("", text);
            let named = match previous {
                "!" => at > 1 && text(at - 2) == "macro_rules",
                _ => KEYWORDS.contains(&previous) && !KEYWORDS.contains(&token.text.as_str()),
            };
            let has = |word: &str| owners.iter().any(|owner| owner == word);
            let variant = has("enum") && ["{", ",", "]"].contains(&previous) && parentheses == 0;
            let field = has("struct") && text(at + 1) == ":" && parentheses == 0;
            if named || variant || field {
                enter(owners, &token.text);
            }
            head.push(token.text.clone());
        }
    }
}

/// Crate and modules of a source: `crates/laws/src/a/b.rs` is `moreau_laws`, `a`, `b`.
fn place(path: &str) -> Option<(String, Vec<String>)> {
    let (folder, file) = path.split_once("/src/")?;
    let package = match folder.strip_prefix("crates/") {
        Some("moreau") => "moreau".to_owned(),
        Some(name) => format!("moreau_{name}"),
        None if folder == "tests" => "verification".to_owned(),
        None => folder.to_owned(),
    };
    let stems = file.trim_end_matches(".rs").split('/').map(str::to_owned);
    let module = |stem: &String| !["lib", "main", "mod"].contains(&stem.as_str());
    Some((package, stems.filter(module).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items() -> Items {
        let coulomb = "pub struct Coulomb { pub friction: f64 }\n\
            impl Coulomb { pub fn project(&self) {} }\n\
            impl<const D: usize> Bipotential<Local<D>> for Coulomb { fn b(&self) {} }\n\
            pub enum Status { Open, #[default] Stick, Slip(f64) }\n\
            #[cfg(test)] mod tests { fn check() {} }";
        let tresca = "pub struct Tresca;\nimpl Tresca { fn slide(&self) {} }\npub fn gap() {}";
        Items::of(&[
            Source::new("crates/laws/src/coulomb.rs", coulomb),
            Source::new("crates/laws/src/tresca.rs", tresca),
            Source::new("crates/moreau/src/lib.rs", "pub use moreau_laws as laws;"),
        ])
    }

    #[test]
    fn items_are_found_where_they_are_declared() {
        for path in [
            "moreau_laws::Coulomb",
            "moreau_laws::Coulomb::project",
            "moreau_laws::coulomb::Coulomb::b",
            "moreau_laws::Coulomb::friction",
            "moreau_laws::Status::Open",
            "moreau_laws::Status::Slip",
            "moreau_laws::coulomb",
            "moreau_laws::gap",
            "moreau_laws::tresca::gap",
            "moreau::laws::Coulomb::project",
        ] {
            assert!(items().has(path), "{path}");
        }
    }

    #[test]
    fn items_are_not_found_elsewhere() {
        for path in [
            "project",
            "moreau_mesh::Coulomb",
            "moreau_laws::Coulomb::slide",
            "moreau_laws::Coulomb::missing",
            "moreau_laws::Missing::project",
            "moreau_laws::coulomb::gap",
            "moreau_laws::check",
            "moreau_laws::Status::f64",
        ] {
            assert!(!items().has(path), "{path}");
        }
    }
}
