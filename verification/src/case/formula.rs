//! Formulas of case files: `"(left_x_m + right_x_m)/gap"` in a column, `"= 2*length/speed"` for a number.
//!
//! Names are columns of the history, or values of the `[values]` table; `{initial …}`, `{final …}` and
//! `{largest …}` stand for a number that is found from a formula of columns, and `{material.glass.density}`
//! for a key of the scene.

use std::str::FromStr;

use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator};

use crate::extremes::{larger, smaller};
use crate::scene::document::Node;
use crate::scene::units;

/// Longest formula, in bytes.
const LONGEST: usize = 1000;

/// What a formula may use: no `^`, for which the parser takes `-a^2` as `(-a)^2`.
#[derive(Debug, Clone)]
struct Operators;

impl MakeOperators<f64> for Operators {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        let binary = |repr, apply, prio| Operator::make_bin(repr, BinOp { apply, prio, is_commutative: false });
        vec![
            binary("*", |a, b| a * b, 2),
            binary("/", |a, b| a / b, 3),
            Operator::make_bin_unary("+", BinOp { apply: |a, b| a + b, prio: 0, is_commutative: true }, |a| a),
            Operator::make_bin_unary("-", BinOp { apply: |a, b| a - b, prio: 1, is_commutative: false }, |a| -a),
            binary("<", |a, b| f64::from(u8::from(a < b)), -1),
            binary(">", |a, b| f64::from(u8::from(a > b)), -1),
            binary("min", smaller, 4),
            binary("max", larger, 4),
            binary("pow", f64::powf, 4),
            binary("hypot", f64::hypot, 4),
            Operator::make_unary("abs", f64::abs),
            Operator::make_unary("sqrt", f64::sqrt),
            Operator::make_unary("sin", f64::sin),
            Operator::make_unary("cos", f64::cos),
            Operator::make_unary("exp", f64::exp),
            Operator::make_unary("ln", f64::ln),
            Operator::make_constant("PI", std::f64::consts::PI),
        ]
    }
}

exmex::literal_matcher_from_pattern!(Numbers, r"^([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?");

/// A formula over names.
#[derive(Debug, Clone)]
pub struct Formula {
    text: String,
    expression: FlatEx<f64, Operators, Numbers>,
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl FromStr for Formula {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err(format!("the formula has {} bytes; at most {LONGEST} are allowed", text.len()));
        }
        if text.trim().is_empty() {
            return Err("no column is named".to_string());
        }
        if text.contains('^') {
            return Err(format!("{text:?} has a ^; write pow(a, b)"));
        }
        let expression = FlatEx::parse(text).map_err(|e| format!("{text:?} is not a valid formula: {e}"))?;
        Ok(Self { text: text.to_string(), expression })
    }
}

/// A name in a formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Name<'a> {
    /// A column of the history, or a value.
    Plain(&'a str),
    /// A key path of the scene.
    Key(&'a str),
    /// A number found from a formula of columns.
    Of(Reduction, &'a str),
}

/// How a number is found from the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduction {
    /// The first.
    Initial,
    /// The last.
    Final,
    /// The largest magnitude.
    Largest,
}

impl Reduction {
    const WORDS: [(&str, Self); 3] = [("initial", Self::Initial), ("final", Self::Final), ("largest", Self::Largest)];
}

impl Formula {
    /// Its names, in the order of the values that [`Self::value`] takes.
    pub fn names(&self) -> impl Iterator<Item = Name<'_>> {
        self.expression.var_names().iter().map(|name| {
            let reduced = name.split_once(' ').and_then(|(word, of)| {
                let (_, reduction) = Reduction::WORDS.into_iter().find(|(known, _)| *known == word)?;
                Some(Name::Of(reduction, of))
            });
            reduced.unwrap_or(if name.contains('.') { Name::Key(name) } else { Name::Plain(name) })
        })
    }

    /// Its value where the names have these.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.expression.eval(values).unwrap_or(f64::NAN)
    }

    /// Its value where every name is a number.
    ///
    /// # Errors
    /// Whatever a name gives.
    pub fn number(&self, of: &mut dyn FnMut(Name<'_>) -> Result<f64, String>) -> Result<f64, String> {
        let values = self.names().map(of).collect::<Result<Vec<_>, _>>()?;
        Ok(self.value(&values))
    }
}

/// A number of a case file: given, or a formula.
#[derive(Debug, Clone, PartialEq)]
pub enum Amount {
    /// In SI.
    Given(f64),
    /// To be found for every scene.
    Formula(Box<Formula>),
}

/// The value of a key of a scene in SI.
pub(super) fn value_of_key(scene: &Node, path: &str) -> Result<f64, String> {
    use crate::scene::document::Value;
    let node = scene.at(path).ok_or_else(|| format!("the scene has no key {path:?}"))?;
    match &node.value {
        Value::Float(x) => Ok(*x),
        Value::Integer(i) => Ok(*i as f64),
        Value::String(text) => units::parse(text).map(|quantity| quantity.value).map_err(|e| e.message),
        _ => Err(format!("the key {path:?} is {}, not a number", node.kind())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let formula: Formula = text.parse().unwrap();
        formula.number(&mut |name| if name == Name::Plain("a") { Ok(3.0) } else { Err(format!("{name:?}")) }).unwrap()
    }

    #[test]
    fn formulas_are_read_as_they_are_written() {
        assert_eq!(value("2 - a - 1"), -2.0);
        assert_eq!(value("12/a/2*a"), 6.0);
        assert_eq!(value("-a*2 + 1.5e-1*max(a, 10)"), -4.5);
        assert_eq!(value("hypot(a, 4) - pow(2, a)"), -3.0);
        assert_eq!(value("(a > 2)*(a < 3)"), 0.0);
        assert!(value("max(sqrt(-1), 1)").is_nan(), "what is no number does not vanish");
    }

    #[test]
    fn names_are_told_apart() {
        let formula: Formula = "{initial a + b}*c/{material.solid.density}".parse().unwrap();
        let names: Vec<Name> = formula.names().collect();
        assert!(names.contains(&Name::Of(Reduction::Initial, "a + b")));
        assert!(names.contains(&Name::Plain("c")) && names.contains(&Name::Key("material.solid.density")));
    }

    #[test]
    fn what_is_no_formula_is_an_error() {
        for text in ["", "a +", "a b", "a^2", "(a", "max(a, b, c)", &"a+".repeat(600)] {
            assert!(text.parse::<Formula>().is_err(), "{text}");
        }
    }
}
