//! Arithmetic in text: numbers, names, operators and functions.

use std::str::FromStr;

use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator};

use crate::extremes::{larger, smaller};

/// Longest formula, in bytes.
const LONGEST: usize = 1000;

/// What [`Operators`] allows.
const KNOWN: &str = "it may have numbers, names, brackets, + - * / < >, pow(a, b), min(a, b), max(a, b), hypot(a, b), \
                     abs, sqrt, sin, cos, exp, ln, and PI";

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

/// An expression; two are equal if their texts are.
#[derive(Debug, Clone)]
pub struct Arithmetic {
    text: String,
    expression: FlatEx<f64, Operators, Numbers>,
}

impl PartialEq for Arithmetic {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl FromStr for Arithmetic {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err(format!("the formula has {} bytes; at most {LONGEST} are allowed", text.len()));
        }
        if text.trim().is_empty() {
            return Err("the formula is blank".to_string());
        }
        if text.contains('^') {
            return Err(format!("{text:?} has a ^; write pow(a, b)"));
        }
        let expression = FlatEx::parse(text).map_err(|_| format!("{text:?} is not a valid formula; {KNOWN}"))?;
        Ok(Self { text: text.to_string(), expression })
    }
}

impl Arithmetic {
    /// Its names, in the order of the values that [`Self::value`] takes.
    pub fn names(&self) -> &[String] {
        self.expression.var_names()
    }

    /// Its value where the names have these.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.expression.eval(values).unwrap_or(f64::NAN)
    }
}
