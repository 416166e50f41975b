//! Decks and mesh files with mistakes at random: a diagnosis each, never a panic.

use super::{DECK, folder};
use moreau::deck::open_in;
use std::fs;

/// Numbers from a seed: Knuth's linear congruence.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// Words, numbers, blanks and signs of a text, each by itself.
fn tokens(text: &str) -> Vec<String> {
    let word = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let mut list: Vec<String> = Vec::new();
    for c in text.chars() {
        match list.last_mut() {
            Some(last) if word(c) && last.chars().all(word) => last.push(c),
            _ => list.push(c.into()),
        }
    }
    list
}

/// A text with up to four of its tokens dropped, doubled, exchanged or copied elsewhere.
fn shuffled(text: &str, dice: &mut Dice) -> String {
    let mut list = tokens(text);
    for _ in 0..=dice.below(3) {
        let (a, b) = (dice.below(list.len()), dice.below(list.len()));
        match dice.below(4) {
            0 => drop(list.remove(a)),
            1 => list.insert(a, list[a].clone()),
            2 => list.swap(a, b),
            _ => list[a] = list[b].clone(),
        }
    }
    list.concat()
}

/// Bytes with up to four of them changed, or cut short.
fn damaged(bytes: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=dice.below(3) {
        let at = dice.below(bytes.len());
        match dice.below(8) {
            0 if at > 0 => bytes.truncate(at),
            1 => bytes[at] ^= 1 << dice.below(8),
            _ => bytes[at] = b"0123456789-.,=[]{}\"#e \n"[dice.below(23)],
        }
    }
    bytes
}

/// Whether a deck can be run; if not, what is said has a place, and if it can, so can the deck
/// written out again.
fn diagnosed(text: &str) -> bool {
    let examples = folder("docs/examples");
    let (deck, problem, findings) = open_in(text, &examples);
    let shown = findings.render("deck.toml", text, false);
    match problem {
        None => assert!(
            findings.errors() > 0 && shown.contains("deck.toml:"),
            "{text}\n{shown}"
        ),
        Some(_) => {
            let again = open_in(&deck.resolved(), &examples);
            assert!(again.1.is_some(), "{text}\n{}", deck.resolved());
            return true;
        }
    }
    false
}

#[test]
fn mutated_decks_never_panic() {
    let mut examples: Vec<_> = fs::read_dir(folder("docs/examples"))
        .expect("examples")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    examples.sort();
    assert!(examples.len() >= 6);
    let mut dice = Dice(7);
    let (mut right, mut count) = (0, 0);
    for path in examples {
        let text = fs::read_to_string(path).expect("a deck");
        for _ in 0..12 {
            right += usize::from(diagnosed(&shuffled(&text, &mut dice)));
            let bytes = damaged(text.as_bytes(), &mut dice);
            right += usize::from(diagnosed(&String::from_utf8_lossy(&bytes)));
            count += 2;
        }
    }
    assert!(
        count >= 500 && (count / 10..count).contains(&right),
        "{right} of {count}"
    );
}

/// A deck on a mesh file with mistakes: the file is said to be wrong, or it can be run.
#[test]
fn mutated_meshes_never_panic() {
    let mesh = fs::read(folder("docs/examples/punch-on-gmsh-mesh.msh")).expect("a mesh");
    let deck = fs::read_to_string(folder("docs/examples/punch-on-gmsh-mesh.toml")).expect("a deck");
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("mutant.msh");
    let text = deck.replace("punch-on-gmsh-mesh.msh", &file.to_string_lossy());
    let mut dice = Dice(11);
    let mut right = 0;
    for _ in 0..120 {
        fs::write(&file, damaged(&mesh, &mut dice)).expect("a file");
        right += usize::from(diagnosed(&text));
    }
    assert!((5..115).contains(&right), "{right}");
}

/// A mesh that no memory holds is refused before it is made.
#[test]
fn huge_meshes_are_refused() {
    for (from, to) in [
        ("cells = [10, 2]", "cells = [1000000, 1000]"),
        ("cells = [10, 2]", "cells = [1000000, 1000000]"),
        ("cells = [10, 2]", "cells = [99999999999999999999, 1]"),
        ("increments = 20", "increments = 1000000000"),
        (
            "increments = 20",
            "increments = { start = 1e-12, min = 1e-13, max = 1 }",
        ),
    ] {
        assert!(DECK.contains(from));
        assert!(!diagnosed(&DECK.replace(from, to)), "{to}");
    }
    let announced = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1000000000\n1 0 0 0\n";
    assert!(moreau::mesh::read_gmsh::<2>(announced).is_err());
}
