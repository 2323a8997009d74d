//! Quantities with units: `"32 GPa"`, `"0.25 mm"`, `"2450 kg/m^3"` to SI.
//!
//! A quantity is a number and a unit: a product, quotient or power of symbols, each with an optional SI
//! prefix. The dimension is the vector of exponents of mass, length, time and cycles; angles have none. A
//! frequency in Hz counts cycles, so it is no angular velocity, which is 2 pi times as large. Powers of ten
//! of prefixes are added to the decimal exponent before the number is read, so that `"80 us"` is exactly the
//! double `80e-6`.

mod expression;

use std::fmt;

use expression::{Factor, unit_factor};

/// Exponents of mass, length, time and cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    /// Exponent of mass (kg).
    pub mass: i32,
    /// Exponent of length (m).
    pub length: i32,
    /// Exponent of time (s).
    pub time: i32,
    /// Exponent of cycles: 1 for a frequency in Hz.
    pub cycles: i32,
}

/// Name and example of the dimensions that scene files use.
const NAMED: [(Dimension, &str, &str); 15] = [
    (Dimension::NONE, "a plain number", "0.2"),
    (Dimension::LENGTH, "a length", "\"0.25 mm\""),
    (Dimension::TIME, "a time", "\"80 us\""),
    (Dimension::MASS, "a mass", "\"2 g\""),
    (Dimension::VELOCITY, "a velocity", "\"10 m/s\""),
    (Dimension::ACCELERATION, "an acceleration", "\"9.81 m/s^2\""),
    (Dimension::RATE, "an angular velocity or rate", "\"60 rpm\""),
    (Dimension::FREQUENCY, "a frequency", "\"50 Hz\""),
    (Dimension::STRESS, "a stress", "\"32 GPa\""),
    (Dimension::DENSITY, "a density", "\"2450 kg/m^3\""),
    (Dimension::ENERGY_PER_AREA, "an energy per area", "\"3 J/m^2\""),
    (Dimension::FORCE, "a force", "\"5 kN\""),
    (Dimension::ENERGY, "an energy", "\"2 J\""),
    (Dimension::new(0, 2, 0), "an area", "\"4 mm^2\""),
    (Dimension::new(0, 3, 0), "a volume", "\"4 mm^3\""),
];

impl Dimension {
    /// Plain number; angles too.
    pub const NONE: Self = Self::new(0, 0, 0);
    /// Length, in m.
    pub const LENGTH: Self = Self::new(0, 1, 0);
    /// Time, in s.
    pub const TIME: Self = Self::new(0, 0, 1);
    /// Mass, in kg.
    pub const MASS: Self = Self::new(1, 0, 0);
    /// Velocity, in m/s.
    pub const VELOCITY: Self = Self::new(0, 1, -1);
    /// Acceleration, in m/s².
    pub const ACCELERATION: Self = Self::new(0, 1, -2);
    /// Angular velocity in rad/s, or rate in 1/s.
    pub const RATE: Self = Self::new(0, 0, -1);
    /// Cycles per time, in Hz.
    pub const FREQUENCY: Self = Self { cycles: 1, ..Self::RATE };
    /// Force per area, in Pa.
    pub const STRESS: Self = Self::new(1, -1, -2);
    /// Mass per volume, in kg/m³.
    pub const DENSITY: Self = Self::new(1, -3, 0);
    /// Energy per area, in J/m² = N/m.
    pub const ENERGY_PER_AREA: Self = Self::new(1, 0, -2);
    /// Force, in N.
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Energy, in J.
    pub const ENERGY: Self = Self::new(1, 2, -2);

    /// The dimension with these exponents and no cycles.
    pub const fn new(mass: i32, length: i32, time: i32) -> Self {
        Self { mass, length, time, cycles: 0 }
    }

    /// In words with an article: `a length`.
    pub fn name(self) -> String {
        NAMED.iter().find(|n| n.0 == self).map_or_else(|| format!("a quantity in {self}"), |n| n.1.to_string())
    }

    /// What a value of this dimension looks like in a file: `a length such as "0.25 mm"`.
    pub fn example(self) -> String {
        match NAMED.iter().find(|n| n.0 == self) {
            Some((_, name, example)) => format!("{name} such as {example}"),
            None => format!("a quantity in {self}"),
        }
    }

    /// `self · other^power`.
    fn times(self, other: Self, power: i32) -> Self {
        let sum = |own: i32, other: i32| own + power * other;
        Self {
            mass: sum(self.mass, other.mass),
            length: sum(self.length, other.length),
            time: sum(self.time, other.time),
            cycles: sum(self.cycles, other.cycles),
        }
    }
}

/// SI base units and cycles with exponents: `kg m^-1 s^-2`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = [("kg", self.mass), ("m", self.length), ("s", self.time), ("cycle", self.cycles)]
            .iter()
            .filter(|(_, n)| *n != 0)
            .map(|(s, n)| if *n == 1 { s.to_string() } else { format!("{s}^{n}") })
            .collect();
        f.write_str(if parts.is_empty() { "1" } else { "" })?;
        f.write_str(&parts.join(" "))
    }
}

/// A number in SI units with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Value in SI base units (angles in rad).
    pub value: f64,
    /// Powers of the base units.
    pub dimension: Dimension,
}

/// A string that is not a quantity of the expected dimension.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}; {remedy}")]
pub struct UnitError {
    /// What is wrong with the text, in words.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

impl UnitError {
    fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { message: message.into(), remedy: remedy.into() }
    }
}

/// Reads a quantity and checks its dimension; the value in SI units.
///
/// # Errors
/// Text that is no quantity, an unknown unit, a number too large for a double, or another dimension.
pub fn parse_as(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let quantity = parse(text).map_err(|e| {
        let end = if e.remedy.ends_with('?') { "" } else { ";" };
        UnitError::new(e.message, format!("{}{end} give {}", e.remedy, expected.example()))
    })?;
    if quantity.dimension == expected {
        return Ok(quantity.value);
    }
    let message = format!("{text:?} is {}, expected {}", quantity.dimension.name(), expected.name());
    let remedy = if expected == Dimension::RATE && quantity.dimension == Dimension::FREQUENCY {
        let angular = std::f64::consts::TAU * quantity.value;
        format!("a cycle is 2 pi rad: a frequency of {} Hz is \"{angular} rad/s\"", quantity.value)
    } else if quantity.dimension == Dimension::NONE {
        format!("give {}, or a bare number (SI) without quotes", expected.example())
    } else {
        format!("give {}", expected.example())
    };
    Err(UnitError::new(message, remedy))
}

/// Reads a quantity of any dimension.
///
/// # Errors
/// Text that is no quantity, an unknown unit, or a number too large for a double.
pub fn parse(text: &str) -> Result<Quantity, UnitError> {
    let trimmed = text.trim();
    let split = number_end(trimmed);
    let (number, unit) = (trimmed[..split].replace('_', ""), trimmed[split..].trim());
    if number.is_empty() {
        return Err(UnitError::new(format!("{text:?} does not start with a number"), "a number, a space and a unit"));
    }
    let unit = if unit.is_empty() { Factor::ONE } else { unit_factor(unit)? };
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((&number, "0"));
    let exponent = exponent.parse::<i64>().unwrap_or(i64::MAX).saturating_add(i64::from(unit.ten));
    let value = format!("{mantissa}e{exponent}").parse::<f64>().map_or(f64::NAN, |v| v * unit.factor);
    if !value.is_finite() {
        return Err(UnitError::new(format!("{text:?} is not a finite number"), "a finite number"));
    }
    Ok(Quantity { value, dimension: unit.dimension })
}

/// Byte length of the decimal number at the start of `text`, 0 if there is none.
pub(super) fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut i: usize| {
        while bytes.get(i).is_some_and(|b| b.is_ascii_digit() || *b == b'_') {
            i += 1;
        }
        i
    };
    let sign = |i: usize| i + usize::from(matches!(bytes.get(i), Some(b'+' | b'-')));
    let start = sign(0);
    let mut end = digits(start);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if !bytes[start..end].iter().any(u8::is_ascii_digit) {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) && bytes.get(sign(end + 1)).is_some_and(u8::is_ascii_digit) {
        end = digits(sign(end + 1));
    }
    end
}
