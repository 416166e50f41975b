//! Parameters of a deck and the formulas that use them; what is wrong with either.

use super::schema::{fits, read, schema};
use super::{DECK, flat, folder};
use moreau::deck::{Given, open, open_with};

/// The example with a friction, a travel and cells by formulas.
fn deck(parameters: &str) -> String {
    format!(
        "{}\n[parameters]\n{parameters}",
        DECK.replace("friction = 0.1", "friction = \"= mu\"")
            .replace("cells = [10, 2]", "cells = [\"= 5 * n\", \"= n\"]")
            .replace("y = -0.2", "y = \"= -travel / 5\"")
    )
}

const PARAMETERS: &str = "mu = 0.1\nn = 2\nlength = 50\ntravel = \"= length / 50\"\n";

fn message(text: &str, given: &[(&str, f64)]) -> String {
    let parameters = given.iter().map(|(name, v)| ((*name).to_owned(), *v));
    let given = Given {
        parameters: parameters.collect(),
        ..Given::default()
    };
    let (_, _, findings) = open_with(text, &folder("docs/examples"), &given);
    flat(&findings.render("deck.toml", text, false))
}

#[test]
fn a_deck_by_formulas_is_that_of_their_values() {
    let resolved = open(DECK).0.resolved();
    let text = deck(PARAMETERS);
    let (deck, problem, findings) = open(&text);
    assert_eq!((findings.errors(), findings.warnings()), (0, 0));
    assert!(problem.is_some());
    assert_eq!(deck.resolved(), resolved);
    let root = schema();
    assert_eq!(fits(&read(&text), &root, &root), Ok(()));
}

/// Also where others follow from it.
#[test]
fn a_parameter_can_be_given_another_value() {
    let given = Given {
        parameters: [("mu".to_owned(), 0.3), ("length".to_owned(), 100.0)].into(),
        ..Given::default()
    };
    let text = deck(PARAMETERS);
    let (other, problem, _) = open_with(&text, &folder("docs/examples"), &given);
    assert!(problem.is_some());
    let expected = DECK
        .replace("friction = 0.1", "friction = 0.3")
        .replace("y = -0.2", "y = -0.4");
    assert_eq!(other.resolved(), open(&expected).0.resolved());
}

#[test]
fn what_is_wrong_with_formulas_is_told() {
    for (parameters, given, words) in [
        (
            "mu = 0.1\nn = 2\ntravell = 1\n",
            &[][..],
            "no parameter is called \"travel\"; did you mean \"travell\"?",
        ),
        (
            "travel = 1\nmu = \"= nu\"\nnu = 0.1\nn = 2\n",
            &[],
            "no parameter is called \"nu\"",
        ),
        (
            "travel = 1\nmu = 0.1\nn = 0.3\n",
            &[],
            "expected an integer from 0 to",
        ),
        (
            "travel = 1\nmu = \"= 1 / 0\"\nn = 2\n",
            &[],
            "whose value is inf",
        ),
        (
            "travel = 1\nmu = \"= (0.1\"\nn = 2\n",
            &[],
            "with the end, where a closing parenthesis was expected",
        ),
        (
            "travel = 1\nmu = \"= sqr(0.01)\"\nn = 2\n",
            &[],
            "no function is called \"sqr\"; did you mean \"sqrt\"?",
        ),
        (
            "travel = 1\nmu = \"= min(0.1)\"\nn = 2\n",
            &[],
            "min is given 1 numbers, expected 2",
        ),
        (
            "travel = 1\nmu = \"= sqrt(-1)\"\nn = 2\n",
            &[],
            "whose value is NaN",
        ),
        (
            "travel = 1\nmu = 0.1\nn = 2\nmax = 3\n",
            &[],
            "\"max\" is what formulas have already",
        ),
        (
            "travel = 1\nmu = 0.1\nn = 2\nspare = 3\n",
            &[],
            "no formula uses the parameter \"spare\"",
        ),
        (
            "travel = 1\nmu = 0.1\nn = 2\nf-0 = 3\n",
            &[],
            "expected letters, digits and '_'",
        ),
        (
            PARAMETERS,
            &[("mü", 0.2)],
            "the deck has no parameter \"mü\"; did you mean \"mu\"?",
        ),
        (PARAMETERS, &[("mu", -0.2)], "non-negative"),
    ] {
        let found = message(&deck(parameters), given);
        assert!(found.contains(words), "{words:?} in {found}");
    }
}
