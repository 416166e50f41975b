//! Units, and sizes and stiffnesses of bodies.

use super::*;
use rayon::prelude::*;

/// Factors of lengths and stresses from a deck in mm, N and MPa: to other units, and to bodies much
/// smaller, larger and softer.
const UNITS: [(&str, f64, f64); 4] = [
    ("m-N-Pa", 1e-3, 1e6),
    // An inch is 25.4 mm, a pound-force 4.4482216152605 N.
    ("in-lbf-psi", 1.0 / 25.4, 25.4 * 25.4 / 4.448_221_615_260_5),
    ("mm-N-MPa", 1e3, 1.0),
    ("mm-N-MPa", 1.0, 1e-6),
];

/// Factors that only add to the exponents of all numbers, and to those of their roots.
const EXACT: [(&str, f64, f64); 2] = [
    ("mm-N-MPa", 1.0 / 4096.0, 16_777_216.0),
    ("mm-N-MPa", 4096.0, 1.0 / 16_777_216.0),
];

/// The power of lengths and stresses that a number of a deck is, by the keys on the way to it.
fn powers(keys: &str) -> (i32, i32) {
    let is = |names: &[&str]| keys.split('.').any(|k| names.contains(&k));
    match keys {
        _ if is(&["tresca", "tau-max", "cohesion", "modulus"]) => (0, 1),
        _ if is(&["recall", "friction-angle", "dilatancy-angle"]) => (0, 0),
        // A kelvin is one everywhere.
        _ if is(&["temperature", "expansion", "p"]) => (0, 0),
        _ if is(&["stress"]) => (0, 1),
        _ if keys.ends_with("voce.1") => (0, 0),
        _ if is(&[
            "normal", "axis", "axes", "hill", "friction", "poisson", "turn",
        ]) =>
        {
            (0, 0)
        }
        _ if keys.ends_with("swift.1") || keys.ends_with("swift.2") => (0, 0),
        _ if is(&["young", "yield-stress", "hardening", "pressure", "traction"]) => (0, 1),
        _ if is(&["body-force"]) => (-1, 1),
        _ if is(&["force"]) => (2, 1),
        _ if is(&["moment"]) => (3, 1),
        _ if is(&[
            "x",
            "y",
            "z",
            "scale",
            "position",
            "gap-offset",
            "point",
            "nearest",
            "reference",
            "center",
            "radius",
            "polyline",
            "points",
            "radii",
            "move",
            "u",
            "thickness",
        ]) =>
        {
            (1, 0)
        }
        other => panic!("what is {other} measured in?"),
    }
}

/// A history to be multiplied by these factors of its columns, of a deck in other units.
fn in_units(
    name: &str,
    deck: &Table,
    (units, length, stress): (&str, f64, f64),
) -> (History, impl Fn(&str, &str) -> f64) {
    let mut deck = deck.clone();
    deck.insert("units".into(), units.into());
    let change = |keys: &str, v: f64| {
        let (l, s) = powers(keys);
        v * length.powi(l) * stress.powi(s)
    };
    numbers(&mut deck, &change);
    // Of stresses, at positions.
    formulas(&mut deck, &|text| {
        let text = AXES.iter().fold(text.to_owned(), |text, axis| {
            text.replace(axis, &format!("({axis} / {length:?})"))
        });
        format!("{stress:?} * ({text})")
    });
    let name = format!("{name}-{units}");
    let found = history(&deck, &folder("docs/examples"), &name, false);
    let factor = move |_: &str, unit: &str| match unit {
        "mm" | "m" | "in" => 1.0 / length,
        "N" | "lbf" => 1.0 / (stress * length * length),
        "N·mm" | "N·m" | "in·lbf" | "lbf·in" => 1.0 / (stress * length.powi(3)),
        "MPa" | "Pa" | "psi" => 1.0 / stress,
        "" | "°" => 1.0,
        other => panic!("the unit {other}"),
    };
    (found, factor)
}

/// Examples whose contacts are tied in the factor of the stiffness: their last digits are not those of other units.
const TIED: [&str; 2] = ["hook-springs-free", "strip-rolled"];

#[test]
fn units_change_nothing() {
    let decks = examples();
    // The coordinates of a file are its own.
    let decks = decks.into_par_iter().enumerate();
    let decks = decks.filter(|(_, (_, deck))| deck["mesh"].get("file").is_none());
    decks.for_each(|(k, (name, deck))| units_change_nothing_of(&name, deck, k % 2));
}

/// One half of the units or the other: every deck would take in all of them twice the time.
fn units_change_nothing_of(name: &str, mut deck: Table, half: usize) {
    if deck["analysis"].as_str() == Some("plane-strain") {
        deck.insert("thickness".into(), 1.0.into());
    }
    let (decks, own) = (folder("docs/examples"), format!("{name}-mm"));
    let base = history(&deck, &decks, &own, false);
    for units in UNITS.into_iter().skip(half).step_by(2) {
        let (found, factor) = in_units(name, &deck, units);
        same(&base, &found, &format!("{name} in {units:?}"), factor);
    }
    // Where no number rounds otherwise nothing differs, unless something is measured in itself.
    for units in EXACT.into_iter().skip(half).step_by(2) {
        let (found, factor) = in_units(name, &deck, units);
        if TIED.contains(&name) {
            same(&base, &found, &format!("{name} times {units:?}"), factor);
            continue;
        }
        for (a, b) in base.rows.iter().zip(&found.rows) {
            for (k, column) in base.names.iter().enumerate() {
                let b = b[k] * factor(column, &found.units[k]);
                assert!(
                    a[k] == b,
                    "{name} times {units:?}, {column}: {} and {b}",
                    a[k]
                );
            }
        }
    }
}
