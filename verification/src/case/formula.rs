//! Formulas of case files: `"(left_x_m + right_x_m)/gap"` in a column, `"= 2*length/speed"` for a number.
//!
//! Names are columns of the history, or values of the `[values]` table; `{initial …}`, `{final …}` and
//! `{largest …}` stand for a number that is found from a formula of columns, and `{material.glass.density}`
//! for a key of the scene.

use std::str::FromStr;

use crate::arithmetic::Arithmetic;
use crate::scene::document::Node;
use crate::scene::units;

/// A formula over names.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula(Arithmetic);

impl FromStr for Formula {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse().map(Self)
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
    /// The value in the first row.
    Initial,
    /// The value in the last row.
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
        self.0.names().iter().map(|name| {
            let reduced = name.split_once(' ').and_then(|(word, of)| {
                let (_, reduction) = Reduction::WORDS.into_iter().find(|(known, _)| *known == word)?;
                Some(Name::Of(reduction, of))
            });
            reduced.unwrap_or(if name.contains('.') { Name::Key(name) } else { Name::Plain(name) })
        })
    }

    /// Its value where the names have these.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.0.value(values)
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
    /// A number that the file gives, in SI units.
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
