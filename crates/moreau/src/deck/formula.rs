//! Formulas in place of numbers, `"= 2 * radius"`: arithmetic and elementary functions of the parameters of a deck, and of
//! the position where a number may depend on it; not where they may stand.

/// What is wrong with a formula.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Mistake {
    /// A name that is no parameter.
    Unknown(String),
    /// A name before parentheses that is no function.
    NoFunction(String),
    /// A function, and how many arguments it is given in place of how many.
    Arguments(&'static str, usize, usize),
    /// Something else than was expected: what, and what stands there.
    Expected(&'static str, String),
}

/// What a formula may call; angles in radians.
const FUNCTIONS: [(&str, Function); 14] = [
    ("sqrt", Function::OfOne(f64::sqrt)),
    ("exp", Function::OfOne(f64::exp)),
    ("log", Function::OfOne(f64::ln)),
    ("log10", Function::OfOne(f64::log10)),
    ("sin", Function::OfOne(f64::sin)),
    ("cos", Function::OfOne(f64::cos)),
    ("tan", Function::OfOne(f64::tan)),
    ("asin", Function::OfOne(f64::asin)),
    ("acos", Function::OfOne(f64::acos)),
    ("atan", Function::OfOne(f64::atan)),
    ("tanh", Function::OfOne(f64::tanh)),
    ("abs", Function::OfOne(f64::abs)),
    ("min", Function::OfTwo(f64::min)),
    ("max", Function::OfTwo(f64::max)),
];

/// A function of a formula.
#[derive(Clone, Copy)]
enum Function {
    OfOne(fn(f64) -> f64),
    OfTwo(fn(f64, f64) -> f64),
}

/// Names that are not free for parameters: those of the functions, and pi.
pub(super) fn reserved() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|(name, _)| *name).chain(["pi"])
}

/// The value of a formula: numbers, names, pi, `+ - * / ^`, functions and parentheses.
pub(super) fn value(text: &str, named: &dyn Fn(&str) -> Option<f64>) -> Result<f64, Mistake> {
    let mut formula = Formula {
        rest: text,
        named,
        depth: 0,
    };
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
    /// Signs, powers and parentheses that are open.
    depth: usize,
}

/// How many may be open.
const DEEPEST: usize = 100;

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
        let mut value = self.signed()?;
        while let Some(sign) = self.take(&['*', '/']) {
            let factor = self.signed()?;
            value = if sign == '*' {
                value * factor
            } else {
                value / factor
            };
        }
        Ok(value)
    }

    /// A power binds closer than the sign before it: −2² = −4.
    fn signed(&mut self) -> Result<f64, Mistake> {
        if self.depth == DEEPEST {
            return Err(self.expected("an end of parentheses"));
        }
        self.depth += 1;
        let value = match self.take(&['-']) {
            Some(_) => -self.signed()?,
            None => self.power()?,
        };
        self.depth -= 1;
        Ok(value)
    }

    /// From the right: 2^3^2 = 2⁹.
    fn power(&mut self) -> Result<f64, Mistake> {
        let base = self.factor()?;
        match self.take(&['^']) {
            Some(_) => Ok(base.powf(self.signed()?)),
            None => Ok(base),
        }
    }

    /// What stands in parentheses of which the first has been taken: at least one value, with commas between them.
    fn arguments(&mut self) -> Result<Vec<f64>, Mistake> {
        let mut values = vec![self.sum()?];
        loop {
            match self.take(&[',', ')']) {
                Some(',') => values.push(self.sum()?),
                Some(_) => return Ok(values),
                None => return Err(self.expected("a closing parenthesis")),
            }
        }
    }

    fn call(&mut self, name: &str) -> Result<f64, Mistake> {
        let known = FUNCTIONS.iter().find(|(known, _)| *known == name);
        let (name, function) = known.ok_or_else(|| Mistake::NoFunction(name.to_owned()))?;
        let values = self.arguments()?;
        match (function, values.as_slice()) {
            (Function::OfOne(f), [a]) => Ok(f(*a)),
            (Function::OfTwo(f), [a, b]) => Ok(f(*a, *b)),
            (Function::OfOne(_), other) => Err(Mistake::Arguments(name, other.len(), 1)),
            (Function::OfTwo(_), other) => Err(Mistake::Arguments(name, other.len(), 2)),
        }
    }

    fn factor(&mut self) -> Result<f64, Mistake> {
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
                if self.take(&['(']).is_some() {
                    return self.call(name);
                }
                if name == "pi" {
                    return Ok(std::f64::consts::PI);
                }
                (self.named)(name).ok_or_else(|| Mistake::Unknown(name.to_owned()))
            }
            _ => Err(self.expected("a number, a parameter, a function or a parenthesis")),
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
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2 * 3^-1 * 3", 2.0),
            ("(2^2)^(1/2)", 2.0),
        ] {
            assert_eq!(of(text), Ok(expected), "{text}");
        }
    }

    /// By what they are the inverses of, and by values that everyone knows.
    #[test]
    fn functions_are_what_they_are_called() {
        for (text, expected) in [
            ("sqrt(2)^2", 2.0),
            ("log(exp(mu))", 0.1),
            ("log10(1000)", 3.0),
            ("sin(pi/6)", 0.5),
            ("cos(pi / 3)", 0.5),
            ("tan(pi/4)", 1.0),
            ("asin(1)", std::f64::consts::FRAC_PI_2),
            ("acos(-1)", std::f64::consts::PI),
            ("4 * atan(1)", std::f64::consts::PI),
            ("(exp(2) - 1)/(exp(2) + 1)", 1f64.tanh()),
            ("tanh(1)", 1f64.tanh()),
            ("abs(-3) + min(1, 2) * max(3, l_0 - 60)", 6.0),
            ("sin (mu)^2 + cos(mu)^2", 1.0),
        ] {
            let found = of(text).expect(text);
            assert!((found - expected).abs() < 1e-14, "{text}: {found}");
        }
        assert!(of("sqrt(-1)").expect("a value").is_nan());
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
        assert_eq!(of("sqr(2)"), Err(Mistake::NoFunction("sqr".into())));
        assert_eq!(of("mu(2)"), Err(Mistake::NoFunction("mu".into())));
        assert_eq!(of("sin(1, 2)"), Err(Mistake::Arguments("sin", 2, 1)));
        assert_eq!(of("1 + max(1)"), Err(Mistake::Arguments("max", 1, 2)));
        assert_eq!(of("sin"), Err(Mistake::Unknown("sin".into())));
        for (text, found) in [
            ("2 mu", "\"mu\""),
            ("(1 + 2", "the end"),
            ("1 +", "the end"),
            ("", "the end"),
            ("1.2.3", "\"1.2.3\""),
            ("2 ** 3", "\"* 3\""),
            ("sin()", "\")\""),
            ("sin(1", "the end"),
            ("max(1,)", "\")\""),
            ("2^", "the end"),
            ("2 pi", "\"pi\""),
        ] {
            match of(text) {
                Err(Mistake::Expected(_, there)) => assert_eq!(there, found, "{text}"),
                other => panic!("{text}: {other:?}"),
            }
        }
    }

    #[test]
    fn parentheses_may_not_be_too_deep() {
        let nested = |depth: usize| format!("{}1{}", "(".repeat(depth), ")".repeat(depth));
        assert_eq!(of(&nested(90)), Ok(1.0));
        for text in [nested(100_000), "-".repeat(100_000), "2^".repeat(100_000)] {
            assert!(matches!(of(&text), Err(Mistake::Expected(..))));
        }
    }

    /// Every text of four of these characters is a number or a mistake.
    #[test]
    fn no_text_is_too_odd() {
        let letters = [
            ' ', '1', '.', 'e', 'µ', '(', ')', '+', '-', '*', '/', '^', ',',
        ];
        for k in 0..letters.len().pow(4) {
            let letter = |i: u32| letters[k / letters.len().pow(i) % letters.len()];
            let text: String = (0..4).map(letter).collect();
            let _ = of(&text);
        }
    }
}
