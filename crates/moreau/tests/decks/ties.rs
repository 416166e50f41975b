//! Ties that cannot be, and those that hold less than they seem to.

use super::flat;
use moreau::deck::open;

const COATED: &str = include_str!("../../../../docs/examples/coated-block.toml");
const TIE: &str = "surface = \"layer.bottom\"\nto = \"block.top\"";

/// What is shown for the deck with a piece of its text replaced, and whether it can be run.
fn shown(from: &str, to: &str) -> (bool, String) {
    assert!(COATED.contains(from), "{from:?} is not in the deck");
    let text = COATED.replacen(from, to, 1);
    let (_, problem, findings) = open(&text);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    (
        problem.is_some(),
        findings.render("deck.toml", &text, false),
    )
}

/// Asserts that what is shown is at a line of the deck, with a line under a text of it and these words.
fn points_at(out: &str, line: usize, marked: &str, words: &[&str]) {
    let place = format!("deck.toml:{line}:");
    assert!(out.contains(&place), "{place} in {out}");
    let mark = "━".repeat(marked.len());
    let mut lines = out.lines().skip_while(|l| !l.contains(&place));
    let shown = lines.find(|l| l.contains(marked)).unwrap_or_default();
    let below = lines.next().unwrap_or_default();
    let column = |text: &str, of: &str| text.find(of).map(|at| text[..at].chars().count());
    assert_eq!(column(shown, marked), column(below, &mark), "{out}");
    assert_eq!(below.matches('━').count(), marked.len(), "{out}");
    for word in words {
        assert!(flat(out).contains(word), "{word:?} in {out}");
    }
}

fn line_of(text: &str) -> usize {
    let line = COATED.lines().position(|l| l == text);
    1 + line.expect("a line of the deck")
}

#[test]
fn what_cannot_be_tied_is_pointed_at() {
    let surface = line_of("surface = \"layer.bottom\"");
    let again = surface + 4;
    let two = |surface: &str, to: &str| {
        format!("{TIE}\n\n[[tie]]\nsurface = \"{surface}\"\nto = \"{to}\"")
    };
    for (from, to, line, marked, words) in [
        (
            TIE,
            "surface = \"layer.botom\"\nto = \"block.top\"".to_owned(),
            surface,
            "\"layer.botom\"",
            &["layer.botom", "did you mean \"layer.bottom\"?"][..],
        ),
        (
            TIE,
            "surface = \"layer.bottom\"\nto = \"blok.top\"".to_owned(),
            surface + 1,
            "\"blok.top\"",
            &["did you mean \"block.top\"?"],
        ),
        (
            TIE,
            "surface = \"layer.bottom\"\nto = \"block\"".to_owned(),
            surface + 1,
            "\"block\"",
            &["facets"],
        ),
        (
            TIE,
            "surface = \"layer.bottom\"\nto = \"layer.left\"".to_owned(),
            surface,
            "\"layer.bottom\"",
            &["[0.0, 5.0]", "layer.left"],
        ),
        (
            "y = [5, 5.5]",
            "y = [5.3, 5.8]".to_owned(),
            surface,
            "\"layer.bottom\"",
            &[
                "\"layer.bottom\" and \"block.top\" are",
                "apart",
                "a quarter of a facet",
            ],
        ),
        (
            TIE,
            two("layer.bottom", "block.top"),
            again,
            "\"layer.bottom\"",
            &["\"layer.bottom\" is tied already"],
        ),
        (
            TIE,
            two("block.top", "layer.bottom"),
            again,
            "\"block.top\"",
            &[
                "\"block.top\" is tied already",
                "tie of \"layer.bottom\" to \"block.top\"",
            ],
        ),
        (
            TIE,
            two("layer.top", "layer.bottom"),
            again + 1,
            "\"layer.bottom\"",
            &["\"layer.bottom\" is tied already"],
        ),
    ] {
        let (runs, out) = shown(from, &to);
        assert!(!runs, "{out}");
        points_at(&out, line, marked, words);
    }
}

/// Of a layer that reaches beyond its block: the nodes there are free. A facet that meets the block in part is tied.
#[test]
fn nodes_with_nothing_opposite_are_counted() {
    let surface = line_of("surface = \"layer.bottom\"");
    let (runs, out) = shown(TIE, TIE);
    assert!(runs && !out.contains("opposite"), "{out}");
    let block = "x = [0, 10]\ny = [0, 5]";
    for (end, count) in [("8", "16 of the 81 nodes"), ("8.2", "14 of the 81 nodes")] {
        let (runs, out) = shown(block, &format!("x = [0, {end}]\ny = [0, 5]"));
        assert!(runs, "{out}");
        let words = [count, "\"block.top\"", "they are free"];
        points_at(&out, surface, "\"layer.bottom\"", &words);
    }
}
