//! Formulas in place of numbers, `"= 2 * radius"`: arithmetic with the parameters of a deck, and with the position where
//! a number may depend on it; no functions.

/// What is wrong with a formula.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Mistake {
    /// A name that is no parameter.
    Unknown(String),
    /// Something else than was expected: what, and what stands there.
    Expected(&'static str, String),
}

/// The value of a formula: numbers, names, `+ - * /` and parentheses.
pub(super) fn value(text: &str, named: &dyn Fn(&str) -> Option<f64>) -> Result<f64, Mistake> {
    let mut formula = Formula { rest: text, named };
    let value = formula.sum()?;
    match formula.next() {
        None => Ok(value),
        Some(_) => Err(formula.expected("an operator or the end")),
    }
}

/// The text of a formula with the values of names in their place.
pub(super) fn with_values(text: &str, named: &dyn Fn(&str) -> Option<f64>) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let belongs = |c: char| is_of_name(c) || c == '.';
        let end = match belongs(first) {
            true => rest.find(|c| !belongs(c)).unwrap_or(rest.len()),
            false => first.len_utf8(),
        };
        let (word, after) = rest.split_at(end);
        match named(word).filter(|_| first.is_alphabetic()) {
            Some(value) => out.push_str(&format!("({value:?})")),
            None => out.push_str(word),
        }
        rest = after;
    }
    out
}

/// What is left to read.
struct Formula<'a> {
    rest: &'a str,
    named: &'a dyn Fn(&str) -> Option<f64>,
}

impl<'a> Formula<'a> {
    fn next(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    /// Takes one of some characters.
    fn take(&mut self, wanted: &[char]) -> Option<char> {
        let found = self.next().filter(|c| wanted.contains(c))?;
        self.rest = &self.rest[found.len_utf8()..];
        Some(found)
    }

    /// Takes the longest beginning of such characters.
    fn run(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !belongs(c)).unwrap_or(self.rest.len());
        let (run, rest) = self.rest.split_at(end);
        self.rest = rest;
        run
    }

    fn expected(&self, what: &'static str) -> Mistake {
        let found = match self.rest.trim() {
            "" => "the end".to_owned(),
            rest => format!("\"{rest}\""),
        };
        Mistake::Expected(what, found)
    }

    fn sum(&mut self) -> Result<f64, Mistake> {
        let mut value = self.product()?;
        while let Some(sign) = self.take(&['+', '-']) {
            let term = self.product()?;
            value += if sign == '+' { term } else { -term };
        }
        Ok(value)
    }

    fn product(&mut self) -> Result<f64, Mistake> {
        let mut value = self.factor()?;
        while let Some(sign) = self.take(&['*', '/']) {
            let factor = self.factor()?;
            value = if sign == '*' {
                value * factor
            } else {
                value / factor
            };
        }
        Ok(value)
    }

    fn factor(&mut self) -> Result<f64, Mistake> {
        if self.take(&['-']).is_some() {
            return Ok(-self.factor()?);
        }
        if self.take(&['(']).is_some() {
            let value = self.sum()?;
            return match self.take(&[')']) {
                Some(_) => Ok(value),
                None => Err(self.expected("a closing parenthesis")),
            };
        }
        match self.next() {
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() => {
                let name = self.run(is_of_name);
                (self.named)(name).ok_or_else(|| Mistake::Unknown(name.to_owned()))
            }
            _ => Err(self.expected("a number, a parameter or a parenthesis")),
        }
    }

    fn number(&mut self) -> Result<f64, Mistake> {
        let before = self.rest;
        self.run(|c| c.is_ascii_digit() || c == '.');
        if self.rest.starts_with(['e', 'E']) {
            let mantissa = self.rest;
            self.rest = &self.rest[1..];
            if self.rest.starts_with(['+', '-']) {
                self.rest = &self.rest[1..];
            }
            if self.run(|c| c.is_ascii_digit()).is_empty() {
                self.rest = mantissa;
            }
        }
        let number = &before[..before.len() - self.rest.len()];
        number.parse().map_err(|_| {
            self.rest = before;
            self.expected("a number")
        })
    }
}

/// Whether a character may stand in the name of a parameter.
pub(super) fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<f64, Mistake> {
        value(text, &|name| match name {
            "mu" => Some(0.1),
            "l_0" => Some(50.0),
            _ => None,
        })
    }

    #[test]
    fn formulas_are_arithmetic() {
        for (text, expected) in [
            ("mu", 0.1),
            (" 2 * (l_0 - 10)/ 4 ", 20.0),
            ("1 - 2 - 3", -4.0),
            ("8 / 4 / 2", 1.0),
            ("-mu*-1e1", 1.0),
            ("2e3+1.5E-1", 2000.15),
            ("1 + 2 * 3", 7.0),
        ] {
            assert_eq!(of(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn values_take_the_place_of_names() {
        let named = |name: &str| (name == "e").then_some(-2.5e-5);
        let text = with_values("2e-3*e + x.5 / (e)", &named);
        assert_eq!(text, "2e-3*(-2.5e-5) + x.5 / ((-2.5e-5))");
    }

    #[test]
    fn what_is_wrong_is_told() {
        assert_eq!(of("nu"), Err(Mistake::Unknown("nu".into())));
        for (text, found) in [
            ("2 mu", "\"mu\""),
            ("(1 + 2", "the end"),
            ("1 +", "the end"),
            ("", "the end"),
            ("1.2.3", "\"1.2.3\""),
            ("2 ** 3", "\"* 3\""),
        ] {
            match of(text) {
                Err(Mistake::Expected(_, there)) => assert_eq!(there, found, "{text}"),
                other => panic!("{text}: {other:?}"),
            }
        }
    }

    /// Every text of four of these characters is a number or a mistake.
    #[test]
    fn no_text_is_too_odd() {
        let letters = [' ', '1', '.', 'e', 'µ', '(', ')', '+', '-', '*', '/'];
        for k in 0..letters.len().pow(4) {
            let letter = |i: u32| letters[k / letters.len().pow(i) % letters.len()];
            let text: String = (0..4).map(letter).collect();
            let _ = of(&text);
        }
    }
}
