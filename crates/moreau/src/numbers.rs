//! Numbers as text: for people, and to be read back; no units.

/// A number for people, with so many significant digits at most: 322.114523, 40, 1.5e-17.
pub fn shown(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits.saturating_sub(1)).parse();
    let rounded: f64 = rounded.unwrap_or(value);
    match rounded == 0.0 || (1e-4..1e9).contains(&rounded.abs()) {
        true => format!("{}", rounded + 0.0),
        false => format!("{rounded:e}"),
    }
}

/// Coordinates for people, with so many significant digits at most: [0.5, 100]. What is rounding beside the
/// others is zero.
pub fn place(position: &[f64], digits: usize) -> String {
    let largest = position.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let clean = |x: &f64| if x.abs() < 1e-9 * largest { 0.0 } else { *x };
    let list: Vec<String> = position.iter().map(|x| shown(clean(x), digits)).collect();
    format!("[{}]", list.join(", "))
}

/// A number as text that is read back exactly.
pub(crate) fn number(value: f64) -> String {
    // Adding zero turns −0 into 0.
    match value.fract() == 0.0 && value.abs() < 1e15 {
        true => format!("{:.0}", value + 0.0),
        false => format!("{value:?}"),
    }
}
