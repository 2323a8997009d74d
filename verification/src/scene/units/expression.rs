//! Unit expressions: symbols with SI prefixes, their products, quotients and powers.

use std::f64::consts::PI;

use super::{Dimension, UnitError};
use crate::scene::suggest::nearest;

/// The unit that `text` names.
pub(super) fn unit_factor(text: &str) -> Result<Factor, UnitError> {
    UnitParser::new(text).whole()
}

/// A unit in SI: `10^ten · factor`, of a dimension.
#[derive(Debug, Clone, Copy)]
pub(super) struct Factor {
    pub(super) ten: i32,
    pub(super) factor: f64,
    pub(super) dimension: Dimension,
}

impl Factor {
    pub(super) const ONE: Self = Self { ten: 0, factor: 1.0, dimension: Dimension::NONE };

    fn times(self, other: Self, power: i32) -> Self {
        Self {
            ten: self.ten + power * other.ten,
            factor: self.factor * other.factor.powi(power),
            dimension: self.dimension.times(other.dimension, power),
        }
    }
}

/// Unit symbols: symbol, takes prefixes, power of ten, factor, dimension.
const SYMBOLS: [(&str, bool, i32, f64, Dimension); 16] = [
    ("m", true, 0, 1.0, Dimension::LENGTH),
    ("s", true, 0, 1.0, Dimension::TIME),
    ("g", true, -3, 1.0, Dimension::MASS),
    ("t", false, 3, 1.0, Dimension::MASS),
    ("N", true, 0, 1.0, Dimension::FORCE),
    ("Pa", true, 0, 1.0, Dimension::STRESS),
    ("bar", true, 5, 1.0, Dimension::STRESS),
    ("J", true, 0, 1.0, Dimension::ENERGY),
    ("W", true, 0, 1.0, Dimension::new(1, 2, -3)),
    ("Hz", true, 0, 1.0, Dimension::FREQUENCY),
    ("rad", true, 0, 1.0, Dimension::NONE),
    ("deg", false, 0, PI / 180.0, Dimension::NONE),
    ("°", false, 0, PI / 180.0, Dimension::NONE),
    ("rpm", false, 0, PI / 30.0, Dimension::RATE),
    ("min", false, 0, 60.0, Dimension::TIME),
    ("%", false, -2, 1.0, Dimension::NONE),
];

/// SI prefixes: both code points of the micro sign, and `u`.
const PREFIXES: [(&str, i32); 13] = [
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("n", -9),
    ("p", -12),
];

/// Units offered when a symbol is not known.
const COMMON: [&str; 24] = [
    "m", "mm", "um", "cm", "km", "s", "ms", "us", "ns", "kg", "g", "t", "N", "kN", "MN", "Pa", "kPa", "MPa", "GPa",
    "J", "kJ", "rad", "deg", "rpm",
];

fn symbol(text: &str) -> Result<Factor, UnitError> {
    let find = |name: &str| SYMBOLS.iter().find(|s| s.0 == name);
    if let Some(&(_, _, ten, factor, dimension)) = find(text) {
        return Ok(Factor { ten, factor, dimension });
    }
    for (prefix, power) in PREFIXES {
        let base = text.strip_prefix(prefix).and_then(find);
        if let Some(&(_, true, ten, factor, dimension)) = base {
            return Ok(Factor { ten: ten + power, factor, dimension });
        }
    }
    let remedy = match nearest(text, &COMMON) {
        Some(unit) => format!("did you mean {unit:?}?"),
        None => format!("units are m, s, g, t, N, Pa, J, W, Hz, rad, deg, rpm with SI prefixes, such as {:?}", "mm"),
    };
    Err(UnitError::new(format!("unknown unit {text:?}"), remedy))
}

/// Deepest nesting of parentheses in a unit; keeps every exponent far inside `i32`.
const DEPTH: usize = 4;

/// Recursive descent over `kg/m^3`, `N m`, `1/s`, `kg/(m s^2)`.
struct UnitParser<'a> {
    text: &'a str,
    rest: &'a str,
    depth: usize,
}

impl<'a> UnitParser<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, rest: text, depth: 0 }
    }

    fn fail<T>(&self, what: &str) -> Result<T, UnitError> {
        let message = format!("{what} in the unit {:?}", self.text);
        Err(UnitError::new(message, "write units like kg/m^3, m/s, N*m or kg/(m*s^2)"))
    }

    fn eat(&mut self, tokens: &[&str]) -> bool {
        let found = tokens.iter().find_map(|t| self.rest.strip_prefix(t));
        self.rest = found.unwrap_or(self.rest);
        found.is_some()
    }

    fn skip(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn whole(&mut self) -> Result<Factor, UnitError> {
        if self.text.len() > 100 {
            return Err(UnitError::new("a unit of more than 100 characters", "write units like kg/m^3"));
        }
        let unit = self.product()?;
        if self.rest.is_empty() { Ok(unit) } else { self.fail("unexpected ')'") }
    }

    fn product(&mut self) -> Result<Factor, UnitError> {
        let mut result = self.power()?;
        let mut divided = false;
        loop {
            let goes_on_with_a_digit = self.rest.starts_with(|c: char| c.is_ascii_digit());
            self.skip();
            if self.rest.is_empty() || self.rest.starts_with(')') {
                return Ok(result);
            }
            if self.eat(&["/"]) {
                divided = true;
                result = result.times(self.power()?, -1);
            } else if self.eat(&["*", "\u{b7}", "\u{22c5}"]) {
                result = result.times(self.power()?, 1);
            } else if goes_on_with_a_digit {
                return self.fail("a power without \"^\"");
            } else if divided {
                return self.fail("a blank after a quotient is ambiguous: product or divisor");
            } else {
                result = result.times(self.power()?, 1);
            }
        }
    }

    fn power(&mut self) -> Result<Factor, UnitError> {
        let base = self.primary()?;
        let superscripts = [("\u{b2}", 2), ("\u{b3}", 3)];
        for (sign, power) in superscripts {
            if self.eat(&[sign]) {
                return Ok(Factor::ONE.times(base, power));
            }
        }
        if !self.eat(&["^", "**"]) {
            return Ok(base);
        }
        let length = self.rest.char_indices().find(|(i, c)| !(c.is_ascii_digit() || (*i == 0 && *c == '-')));
        let (digits, rest) = self.rest.split_at(length.map_or(self.rest.len(), |l| l.0));
        match digits.parse::<i32>() {
            Ok(power) if power.abs() <= 9 => {
                self.rest = rest;
                Ok(Factor::ONE.times(base, power))
            }
            _ => self.fail("a power must be a whole number between -9 and 9"),
        }
    }

    fn primary(&mut self) -> Result<Factor, UnitError> {
        self.skip();
        if self.eat(&["("]) {
            self.depth += 1;
            if self.depth > DEPTH {
                return self.fail("too many parentheses");
            }
            let inner = self.product()?;
            self.depth -= 1;
            return if self.eat(&[")"]) { Ok(inner) } else { self.fail("a missing ')'") };
        }
        if self.rest.starts_with('1') && !self.rest[1..].starts_with(|c: char| c.is_ascii_digit()) {
            self.rest = &self.rest[1..];
            return Ok(Factor::ONE);
        }
        let letter = |c: char| c.is_alphabetic() || c == '°' || c == '%';
        let length = self.rest.find(|c| !letter(c)).unwrap_or(self.rest.len());
        if length == 0 {
            return self.fail("a missing unit symbol");
        }
        let (name, rest) = self.rest.split_at(length);
        self.rest = rest;
        symbol(name)
    }
}
