//! Decks in several files: what is joined, what replaces what, and where what is wrong is said to be.

use super::{DECK, flat, folder, temporary};
use moreau::deck::{Class, Given, open, open_in, open_with};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of its own with these files.
fn with(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let at = temporary("includes").join(name);
    for (file, text) in files {
        let path = at.join(file);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    at
}

/// What is said of a deck in a folder.
fn said(deck: &str, at: &Path) -> String {
    let (_, problem, findings) = open_in(deck, at);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    findings.render("deck.toml", deck, false)
}

/// The example without a part of it, which begins at one text and ends before another.
fn cut(from: &str, to: &str) -> (String, String) {
    let start = DECK.find(from).expect("a beginning");
    let end = start + DECK[start..].find(to).expect("an end");
    let rest = format!("{}{}", &DECK[..start], &DECK[end..]);
    (DECK[start..end].to_owned(), rest)
}

fn including(what: &str, deck: &str) -> String {
    format!("include = {what}\n{deck}")
}

/// A deck in pieces is the deck, whichever piece is where.
#[test]
fn pieces_are_the_whole() {
    let whole = open(DECK).0.resolved();
    for (k, (from, to)) in [
        ("[[material]]", "[[tool]]"),
        ("[[tool]]", "[[step]]"),
        ("[[step]]", "[expect]"),
    ]
    .into_iter()
    .enumerate()
    {
        let (piece, rest) = cut(from, to);
        let at = with(&format!("piece-{k}"), &[("parts/piece.toml", &piece)]);
        for what in ["\"parts/piece.toml\"", "[\"parts/piece.toml\"]"] {
            let deck = including(what, &rest);
            let (joined, problem, findings) = open_in(&deck, &at);
            assert!(
                problem.is_some() && findings.warnings() == 0,
                "{}",
                said(&deck, &at)
            );
            assert_eq!(joined.resolved(), whole, "{from}");
        }
    }
    // All of it, by way of another file; the same file twice is there once.
    let at = with(
        "nested",
        &[
            ("a/all.toml", "include = [\"../b/deck.toml\"]"),
            ("b/deck.toml", DECK),
        ],
    );
    let (joined, ..) = open_in("include = [\"a/all.toml\", \"b/deck.toml\"]", &at);
    assert_eq!(joined.resolved(), whole);
}

/// Arrays of tables follow each other, those of the included file first; keys of a table stand side by side.
#[test]
fn tables_are_joined() {
    let more = "[[mesh.group]]\nname = \"corner\"\non = \"block.top\"\nx = [0, 0]\n[solver]\nthreads = 1\n";
    let at = with("joined", &[("more.toml", more)]);
    let deck = format!(
        "{}\n[solver]\ntolerance = 1e-8\n[output]\nprobes = [\"corner\"]\n",
        including("\"more.toml\"", DECK)
    );
    let (joined, problem, _) = open_in(&deck, &at);
    assert!(problem.is_some(), "{}", said(&deck, &at));
    let names: Vec<&str> = joined
        .groups
        .iter()
        .map(|g| g.name.value.as_str())
        .collect();
    assert_eq!(names, ["corner", "punch"]);
    assert_eq!((joined.solver.threads, joined.solver.tolerance), (1, 1e-8));
}

/// Parameters of a deck replace those of what it includes, wherever these are used, and the command replaces both.
#[test]
fn parameters_are_replaced() {
    let common = "[parameters]\nmu = 0.3\nhalf = \"= mu / 2\"\nidle = 1\n";
    let at = with("parameters", &[("common.toml", common)]);
    let friction = |parameters: &str, set: Option<f64>| {
        let deck = DECK.replace("friction = 0.1", "friction = \"= half\"");
        let deck = including("\"common.toml\"", &format!("{deck}{parameters}"));
        let given = Given {
            parameters: set.into_iter().map(|mu| ("mu".to_owned(), mu)).collect(),
            ..Given::default()
        };
        let (read, problem, findings) = open_with(&deck, &at, &given);
        assert!(
            problem.is_some(),
            "{}",
            findings.render("deck", &deck, false)
        );
        // What is included may be for other decks as well.
        assert_eq!(findings.warnings(), 0);
        let friction = read.contacts[0].friction.to_string();
        friction.parse::<f64>().expect("a number")
    };
    assert_eq!(friction("", None), 0.15);
    assert_eq!(friction("\n[parameters]\nmu = 0.2\n", None), 0.1);
    assert_eq!(friction("\n[parameters]\nmu = 0.2\n", Some(0.4)), 0.2);
    // A parameter of the deck may use those that it includes.
    let own = "\n[parameters]\nown = \"= half\"\n";
    let deck = DECK.replace("friction = 0.1", "friction = \"= own\"") + own;
    let (read, ..) = open_in(&including("\"common.toml\"", &deck), &at);
    assert_eq!(read.contacts[0].friction.to_string(), "0.15");
}

/// What is wrong in an included file is shown in that file, by its line, with a caret.
#[test]
fn errors_are_shown_where_they_are() {
    let (material, rest) = cut("[[material]]", "[[tool]]");
    let deck = including("\"steel.toml\"", &rest);
    let shown = |from: &str, to: &str| {
        assert!(material.contains(from), "{from}");
        let text = format!("# é: steel\n\n{}", material.replace(from, to));
        let at = with(&format!("where-{}", to.len()), &[("steel.toml", &text)]);
        let (_, _, findings) = open_in(&deck, &at);
        let line = text.lines().position(|l| l.contains(to)).expect("a line") + 1;
        let out = findings.render("deck.toml", &deck, false);
        let place = format!("{}:{line}:", at.join("steel.toml").display());
        assert!(
            out.contains(&place) && !out.contains("deck.toml:"),
            "{place} in {out}"
        );
        let mut places = findings.places(&deck);
        let found = places.find(|(_, found, _)| *found == line);
        let (finding, _, column) = found.expect("a finding");
        assert_eq!(findings.file(&finding.span), Some(&*at.join("steel.toml")));
        let own = text.lines().nth(line - 1).expect("a line");
        let from: String = own.chars().skip(column - 1).collect();
        assert!(from.starts_with(to) || to.ends_with(&from), "{from}");
        out
    };
    assert!(shown("0.3", "0.75").contains("Poisson"));
    assert!(shown("poisson", "poison").contains("did you mean \"poisson\"?"));
    assert!(shown("\"block\"", "\"blok\"").contains("did you mean \"block\"?"));
    assert!(shown("poisson = 0.3", "poisson = 0,3").contains("a comma within a number"));
}

#[test]
fn the_same_key_with_two_values_is_shown_at_both_places() {
    let at = with(
        "twice",
        &[
            ("units.toml", "title = \"x\"\nunits = \"m-N-Pa\"\n"),
            ("same.toml", "units = \"mm-N-MPa\"\n[solver]\nthreads = 2\n"),
            (
                "other.toml",
                "[solver]\nthreads = 3\n[parameters]\nmu = 1\n",
            ),
            ("third.toml", "[parameters]\nmu = 2\n"),
        ],
    );
    let out = said(&including("\"units.toml\"", DECK), &at);
    let line = 2 + DECK
        .lines()
        .position(|l| l.starts_with("units"))
        .expect("units");
    for place in [
        format!("deck.toml:{line}:1"),
        format!("{}:2:1", at.join("units.toml").display()),
    ] {
        assert!(out.contains(&place), "{place} in {out}");
    }
    assert!(
        out.contains("the key \"units\"") && out.contains("the key \"title\""),
        "{out}"
    );
    // The same value again is none.
    let (_, problem, _) = open_in(&including("\"same.toml\"", DECK), &at);
    assert!(problem.is_some());
    let out = said(&including("[\"same.toml\", \"other.toml\"]", DECK), &at);
    assert!(
        out.contains("the key \"threads\"") && out.contains("other.toml:2:1"),
        "{out}"
    );
    // Of two files side by side neither replaces the other.
    let out = said(&including("[\"other.toml\", \"third.toml\"]", DECK), &at);
    assert!(out.contains("the key \"mu\""), "{out}");
    let (_, _, findings) = open_in(&including("\"units.toml\"", DECK), &at);
    assert!(
        findings
            .iter()
            .all(|f| f.class == Class::Includes && f.also.is_some())
    );
}

#[test]
fn what_cannot_be_included_is_the_only_error() {
    let at = with(
        "broken",
        &[
            ("steel.toml", ""),
            ("a.toml", "include = \"sub/b.toml\""),
            ("sub/b.toml", "\ninclude = \"../a.toml\""),
            ("own.toml", "include = \"own.toml\""),
            ("number.toml", "include = 1"),
        ],
    );
    for (what, place, words) in [
        (
            "\"stel.toml\"",
            "deck.toml:1:11",
            &[
                "cannot read the included file",
                "beside it is \"steel.toml\"",
                "relative to the folder",
            ][..],
        ),
        (
            "\"a.toml\"",
            "sub/b.toml:2:11",
            &["a.toml includes itself", "sub/b.toml includes"],
        ),
        (
            "\"own.toml\"",
            "own.toml:1:11",
            &["own.toml includes itself"],
        ),
        (
            "\"number.toml\"",
            "number.toml:1:11",
            &["include is no path"],
        ),
        (
            "[\"steel.toml\", 3]",
            "deck.toml:1:26",
            &["include is no path"],
        ),
        (
            "{ file = \"steel.toml\" }",
            "deck.toml:1:11",
            &["include is no path"],
        ),
    ] {
        // Without a body: nothing is said of that.
        let deck = including(what, "units = \"mm-N-MPa\"\n");
        let (_, problem, findings) = open_in(&deck, &at);
        let out = findings.render("deck.toml", &deck, false);
        assert!(problem.is_none() && findings.errors() == 1, "{out}");
        assert!(out.contains(place), "{place} in {out}");
        for word in words {
            assert!(flat(&out).contains(word), "{word:?} in {out}");
        }
        assert!(out.contains("docs/errors.md#includes"), "{out}");
    }
    assert!(said("include = []\n", &at).contains("has no key \"units\""));
}

/// Paths in a file are relative to its folder.
#[test]
fn paths_are_relative_to_the_file_that_they_stand_in() {
    let examples = folder("docs/examples");
    let deck = fs::read_to_string(examples.join("punch-on-gmsh-mesh.toml")).expect("a deck");
    let mesh = "[mesh]\nfile = \"punch-on-gmsh-mesh.msh\"\n";
    let at = with("paths", &[("meshes/mesh.toml", mesh)]);
    fs::copy(
        examples.join("punch-on-gmsh-mesh.msh"),
        at.join("meshes/punch-on-gmsh-mesh.msh"),
    )
    .expect("a mesh");
    let own = deck.replace("file = \"punch-on-gmsh-mesh.msh\"", "");
    assert_ne!(own, deck);
    let (read, problem, findings) = open_in(&including("\"meshes/mesh.toml\"", &own), &at);
    assert!(
        problem.is_some(),
        "{}",
        findings.render("deck", &own, false)
    );
    let file = read.mesh_files.first().map(|part| part.file.value.clone());
    assert_eq!(file, Some(at.join("meshes/punch-on-gmsh-mesh.msh")));
}
