//! Stresses and plastic strains that bodies start with, in decks.

use super::{DECK, flat, open};
use moreau::deck::Problem;

fn with(initial: &str) -> String {
    DECK.replace("[[contact]]", &format!("{initial}\n[[contact]]"))
}

fn said(text: &str) -> String {
    let (_, problem, findings) = open(text);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    flat(&findings.render("deck.toml", text, false))
}

/// At the tip of its cone a soil bears a mean stress alone, and what is left of von Mises' is rounding.
#[test]
fn a_start_beyond_the_apex_of_a_soil_is_told() {
    let start = |stress: &str| {
        let initial = format!("[[initial]]\non = \"block\"\nstress = {{ {stress} }}");
        let soil = "cohesion = 0.5\nfriction-angle = 30";
        said(&with(&initial).replace("yield-stress = 300.0", soil))
    };
    let beyond = start("xx = 10, yy = 10.1, zz = 10");
    for words in [
        "outside of its yield surface, beyond the apex of its cone: von Mises' stress is 0.1 and the mean stress 10.0333",
        "of which the law bears 0.0 and 0.866025",
    ] {
        assert!(beyond.contains(words), "{words:?} in {beyond}");
    }
    for stress in [
        "xx = 10, yy = 10, zz = 12, xy = 1.3",
        "xx = 7.7, yy = 3.1, zz = 9.3, xy = 0.7",
        "xx = 101, yy = 97, zz = 99.9, xy = 0.3",
    ] {
        let beyond = start(stress);
        assert!(
            beyond.contains("the law bears 0.0 and 0.866025"),
            "{beyond}"
        );
    }
    let beside = start("xx = -10");
    assert!(
        beside.contains("outside of its yield surface: von Mises"),
        "{beside}"
    );
}

/// A part of a body starts otherwise than the rest, and the deck that is written out says the same.
#[test]
fn a_part_of_a_body_starts_under_a_stress() {
    let text = with(
        "[[mesh.group]]\nname = \"skin\"\non = \"block\"\ny = [10, 20]\n\
         [[initial]]\non = \"skin\"\nstress = { xx = -100, zz = \"= -4 * x\", xy = 5 }\np = 0.02",
    );
    let (deck, problem, findings) = open(&text);
    assert_eq!(
        (findings.errors(), findings.warnings()),
        (0, 0),
        "{}",
        said(&text)
    );
    let Some(Problem::Plane(setup)) = problem else {
        panic!("a plane problem")
    };
    let mut skin = 0;
    for point in setup.driver.points() {
        let [x, y] = point.position;
        let (expected, p) = match y > 10.0 {
            true => ([-100.0, 0.0, -4.0 * x, 0.0, 0.0, 5.0 * 2f64.sqrt()], 0.02),
            false => ([0.0; 6], 0.0),
        };
        skin += usize::from(y > 10.0);
        for (found, expected) in point.stress.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10, "{point:?}");
        }
        assert_eq!(point.plastic_strain, p);
    }
    assert_eq!(2 * skin, setup.driver.points().len());
    let resolved = deck.resolved();
    assert_eq!(open(&resolved).0.resolved(), resolved);
    assert!(resolved.contains("zz = \"= -4 * x\""), "{resolved}");
    // Groups that are made for it are nobody's.
    assert!(setup.groups.iter().all(|g| !g.name.contains("start")));
}

#[test]
fn what_is_wrong_with_starts_is_told() {
    let stress = |text: &str| {
        with(&format!(
            "[[initial]]\non = \"block\"\nstress = {{ {text} }}"
        ))
    };
    for (text, words) in [
        (
            stress("xx = -400"),
            [
                "cell 0 starts at",
                "von Mises' stress is 400",
                "the law bears 300",
            ]
            .as_slice(),
        ),
        (
            stress("xx = \"= 1 / (y - y)\""),
            &["stress at the start of cell 0"],
        ),
        (stress("yz = 1"), &["yz", "xx, yy, zz, xy"]),
        (
            with("[[initial]]\non = \"block\"\np = \"= -x\""),
            &[
                "equivalent plastic strain at the start of cell 0",
                "0 or more",
            ],
        ),
        (
            with("[[initial]]\non = \"block\"\np = 0\n[[initial]]\non = \"block\"\np = 0"),
            &["start as \"block\" does already"],
        ),
        (with("[[initial]]\non = \"blok\"\np = 0"), &["\"block\""]),
        (with("[[initial]]\non = \"block.top\"\np = 0"), &["cells"]),
        (
            stress("zz = 1").replace("plane-strain", "plane-stress"),
            &["in plane stress there is none"],
        ),
        (
            with("[[initial]]\non = \"block\"\np = 0.1").replace("yield-stress = 300.0", ""),
            &["does not yield"],
        ),
    ] {
        let out = said(&text);
        for word in words {
            assert!(out.contains(word), "{word:?} in {out}");
        }
    }
    // On the yield surface, but for rounding, is not outside.
    assert!(!said(&stress("xx = -300")).contains("yield surface"));
}
