//! Numbers as text with a given count of significant digits; not units, nor alignment.

/// A number for the terminal, `1.234e-5` where fixed notation would be long.
pub fn plain(x: f64, digits: usize) -> String {
    match parts(x, digits) {
        Parts::Word(word) => word.to_owned(),
        Parts::Fixed(text) => text,
        Parts::Scientific(mantissa, exponent) => format!("{mantissa}e{exponent}"),
    }
}

/// A number for a page, with a minus sign and powers of ten: `−1.234·10⁻⁵`.
pub fn typeset(x: f64, digits: usize) -> String {
    let text = match parts(x, digits) {
        Parts::Word(word) => word.to_owned(),
        Parts::Fixed(text) => text,
        Parts::Scientific(mantissa, exponent) if mantissa == "1" => power_of_ten(exponent),
        Parts::Scientific(mantissa, exponent) => format!("{mantissa}·{}", power_of_ten(exponent)),
    };
    text.replace('-', "−")
}

/// The two notations, and what is no number.
enum Parts {
    Word(&'static str),
    Fixed(String),
    Scientific(String, i32),
}

fn parts(x: f64, digits: usize) -> Parts {
    if x.is_nan() {
        return Parts::Word("NaN");
    }
    if x.is_infinite() {
        return Parts::Word(if x > 0.0 { "∞" } else { "-∞" });
    }
    if x == 0.0 {
        return Parts::Word("0");
    }
    // Rounding first: 9999999.96 has the exponent 7 when eight digits are kept.
    let rounded = format!("{x:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return Parts::Fixed(trimmed(&format!("{x:.decimals$}")).to_owned());
    }
    Parts::Scientific(trimmed(mantissa).to_owned(), exponent)
}

/// Without the zeros that end a fraction.
fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

fn power_of_ten(exponent: i32) -> String {
    let superscript = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4'..='9' => char::from_u32('⁴' as u32 + (c as u32 - '4' as u32)).unwrap_or(c),
        _ => '⁰',
    };
    format!(
        "10{}",
        exponent
            .to_string()
            .chars()
            .map(superscript)
            .collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_notation_for_numbers_of_daily_life() {
        assert_eq!(plain(12.345_678_9, 6), "12.3457");
        assert_eq!(plain(-0.000_123_456_7, 6), "-0.000123457");
        assert_eq!(plain(210_000.0, 6), "210000");
        assert_eq!(plain(0.0, 6), "0");
        assert_eq!(plain(-0.0, 6), "0");
        assert_eq!(plain(1_234_567.0, 4), "1234567");
    }

    #[test]
    fn scientific_notation_for_the_others() {
        assert_eq!(plain(1.5e-9, 6), "1.5e-9");
        assert_eq!(plain(-2.0e12, 6), "-2e12");
        assert_eq!(plain(9_999_999.96, 8), "1e7");
        assert_eq!(plain(0.000_099_999_999, 6), "0.0001");
    }

    #[test]
    fn typeset_numbers() {
        assert_eq!(typeset(-1.5e-10, 8), "−1.5·10⁻¹⁰");
        assert_eq!(typeset(1e-8, 8), "10⁻⁸");
        assert_eq!(typeset(2.0e45, 8), "2·10⁴⁵");
        assert_eq!(typeset(-0.25, 8), "−0.25");
    }

    #[test]
    fn what_is_no_number() {
        assert_eq!(plain(f64::NAN, 6), "NaN");
        assert_eq!(plain(f64::INFINITY, 6), "∞");
        assert_eq!(typeset(f64::NEG_INFINITY, 6), "−∞");
    }
}
