//! Numbers as labels of ticks: equally many decimals, powers of ten for large ranges; not the
//! places of the ticks.

/// How the ticks of one axis are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Number {
    /// Power of ten that the labels carry, a multiple of 3; 0 for none.
    exponent: i32,
    decimals: usize,
}

impl Number {
    /// For values up to `size` that are `step` apart.
    pub(super) fn new(size: f64, step: f64) -> Self {
        let exponent = if size > 0.0 && !(1e-3..1e5).contains(&size) {
            let thousands = (size.log10() / 3.0 + 1e-9).floor() as i32;
            (3 * thousands).clamp(-300, 300)
        } else {
            0
        };
        let last = (step.log10() + 1e-9).floor() - f64::from(exponent);
        let decimals = if last.is_finite() {
            (-last).clamp(0.0, 12.0) as usize
        } else {
            0
        };
        Self { exponent, decimals }
    }

    /// With a further decimal, for steps that are not round.
    pub(super) fn finer(self) -> Self {
        Self {
            decimals: self.decimals + 1,
            ..self
        }
    }

    /// The label of a value.
    pub(super) fn text(self, value: f64) -> String {
        if value == 0.0 {
            return "0".into();
        }
        let mantissa = format!("{:.*}", self.decimals, value / 10f64.powi(self.exponent));
        if mantissa.chars().all(|c| "-0.".contains(c)) {
            return "0".into();
        }
        let mantissa = mantissa.replace('-', "−");
        match self.exponent {
            0 => mantissa,
            e => format!("{mantissa}×10{}", superscript(e)),
        }
    }
}

/// The least of 1, 2, 5 times a power of ten that divides a length into about so many steps.
pub(super) fn nice_step(length: f64, steps: f64) -> f64 {
    let raw = length / steps;
    let unit = 10f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| raw <= 1.2 * f * unit)
        .unwrap_or(10.0);
    factor * unit
}

/// 10 to the power x, as "10ⁿ" or "m×10ⁿ".
pub(super) fn power(x: f64) -> String {
    let exponent = (x + 1e-6).floor();
    let mantissa = 10f64.powf(x - exponent).round();
    let power = format!("10{}", superscript(exponent as i32));
    if mantissa == 1.0 {
        power
    } else {
        format!("{mantissa}×{power}")
    }
}

fn superscript(number: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // The other superscripts are in one row, in order.
        c => c
            .to_digit(10)
            .and_then(|d| char::from_u32(0x2070 + d))
            .unwrap_or(c),
    };
    number.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::{Number, nice_step, power};

    #[test]
    fn labels_have_as_many_decimals_as_the_step_needs() {
        let label = |size, step, value| Number::new(size, step).text(value);
        assert_eq!(label(10.0, 2.0, 4.0), "4");
        assert_eq!(label(0.02, 0.005, 0.01), "0.010");
        assert_eq!(label(300.0, 100.0, -200.0), "−200");
        assert_eq!(label(210e3, 50e3, 150e3), "150×10³");
        assert_eq!(label(4e-4, 1e-4, -2e-4), "−200×10⁻⁶");
        assert_eq!(label(1e-3, 1e-4, 0.0), "0");
        assert_eq!(Number::new(325.0, 81.25).finer().text(81.25), "81.2");
    }

    #[test]
    fn steps_are_one_two_or_five() {
        for (length, step) in [(10.0, 2.0), (1.0, 0.2), (0.02, 5e-3), (4.5e7, 1e7)] {
            let nice = nice_step(length, 5.0);
            assert!((nice / step - 1.0).abs() < 1e-12, "{nice} for {step}");
        }
    }

    #[test]
    fn powers_of_ten_are_superscripts() {
        assert_eq!(power(-12.0), "10⁻¹²");
        assert_eq!(power(3.0), "10³");
        assert_eq!(power(5.0 + 2f64.log10()), "2×10⁵");
    }
}
