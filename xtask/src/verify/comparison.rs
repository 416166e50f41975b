//! Words for a check: relation, deviation, tolerance; not whether it holds, which the check knows.

use verification::{Check, Kind};

/// Writes a number with so many significant digits.
type Digits = fn(f64, usize) -> String;

/// The relation that value and reference should have.
pub fn relation(kind: Kind) -> &'static str {
    match kind {
        Kind::Relative | Kind::Absolute => "=",
        Kind::AtMost => "≤",
        Kind::AtLeast => "≥",
    }
}

/// The kind in words.
pub fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Relative => "relative",
        Kind::Absolute => "absolute",
        Kind::AtMost => "at most",
        Kind::AtLeast => "at least",
    }
}

/// A number with its unit; a pure number has none.
pub fn with_unit(number: String, unit: &str) -> String {
    if unit == "1" || unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// How far the value is from the reference: as a signed fraction of the reference when that is how the
/// two are compared, as a multiple of a bound, else as a difference in the unit of the check.
pub fn deviation(check: &Check, number: Digits) -> String {
    let difference = check.value - check.reference;
    match check.kind {
        Kind::Relative => fraction(difference / check.reference.abs(), number),
        Kind::AtMost | Kind::AtLeast if check.reference != 0.0 => {
            format!("× {}", number(check.value / check.reference, 3))
        }
        _ => signed(difference, with_unit(number(difference, 2), &check.unit)),
    }
}

/// The deviation that is allowed; nothing for a bound.
pub fn tolerance(check: &Check, number: Digits) -> String {
    match check.kind {
        Kind::Relative => format!(
            "±{}",
            fraction(check.tolerance, number).trim_start_matches('+')
        ),
        Kind::Absolute => format!("±{}", with_unit(number(check.tolerance, 2), &check.unit)),
        Kind::AtMost | Kind::AtLeast => String::new(),
    }
}

/// In percent where that is readable, else as a power of ten.
fn fraction(x: f64, number: Digits) -> String {
    if x.abs() >= 1e-5 {
        signed(x, format!("{} %", number(100.0 * x, 2)))
    } else {
        signed(x, number(x, 2))
    }
}

fn signed(x: f64, text: String) -> String {
    if x > 0.0 { format!("+{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::number::plain;

    fn words(kind: Kind, value: f64, reference: f64, tolerance: f64) -> (String, String) {
        let check = Check::new("a", (value, "N"), kind, (reference, tolerance), "b");
        (deviation(&check, plain), super::tolerance(&check, plain))
    }

    #[test]
    fn deviations_and_tolerances() {
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(
            words(Kind::Relative, 101.0, 100.0, 0.02),
            pair("+1 %", "±2 %")
        );
        assert_eq!(
            words(Kind::Relative, -101.0, -100.0, 0.02),
            pair("-1 %", "±2 %")
        );
        assert_eq!(
            words(Kind::Relative, 1.0 + 1e-7, 1.0, 1e-6),
            pair("+1e-7", "±1e-6")
        );
        assert_eq!(
            words(Kind::Absolute, -0.5, 0.0, 1.0),
            pair("-0.5 N", "±1 N")
        );
        assert_eq!(words(Kind::AtMost, 3.0, 5.0, 0.0), pair("× 0.6", ""));
        assert_eq!(
            words(Kind::Relative, 1.0, 0.0, 1e-3),
            pair("+∞ %", "±0.1 %")
        );
        assert_eq!(
            words(Kind::Absolute, f64::NAN, 0.0, 1.0),
            pair("NaN N", "±1 N")
        );
    }

    #[test]
    fn a_pure_number_has_no_unit() {
        assert_eq!(with_unit("2".into(), "1"), "2");
        assert_eq!(with_unit("2".into(), "MPa"), "2 MPa");
    }
}
