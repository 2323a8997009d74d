//! Quantities that reference curves describe, and units on their way to SI.

use crate::scene::units::{self, Dimension, UnitError};

/// Energy per metre of thickness; the same dimension as a force.
const ENERGY_PER_THICKNESS: Dimension = Dimension::FORCE;

/// Quantities of curves: name, dimension of the abscissa, dimension of the ordinate.
const QUANTITIES: [(&str, Dimension, Dimension); 15] = [
    ("plate/elastic-energy", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate/fracture-increment", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate/kinetic-energy", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate/external-work", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate/tip-x", Dimension::TIME, Dimension::LENGTH),
    ("plate/tip-y", Dimension::TIME, Dimension::LENGTH),
    ("plate-family/elastic-energy", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate-family/fracture-increment", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate-family/kinetic-energy", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate-family/external-work", Dimension::TIME, ENERGY_PER_THICKNESS),
    ("plate-family/tip-x", Dimension::TIME, Dimension::LENGTH),
    ("plate-family/tip-y", Dimension::TIME, Dimension::LENGTH),
    ("rings/fracture-energy", Dimension::TIME, Dimension::ENERGY),
    ("manufactured-bar/displacement-error-small", Dimension::NONE, Dimension::NONE),
    ("manufactured-bar/displacement-error-large", Dimension::NONE, Dimension::NONE),
];

/// SI unit of the dimensions that reference data have.
const SI: [(Dimension, &str); 11] = [
    (Dimension::NONE, "1"),
    (Dimension::TIME, "s"),
    (Dimension::LENGTH, "m"),
    (Dimension::VELOCITY, "m/s"),
    (Dimension::STRESS, "Pa"),
    (Dimension::DENSITY, "kg/m^3"),
    (Dimension::ENERGY_PER_AREA, "J/m^2"),
    (ENERGY_PER_THICKNESS, "J/m"),
    (Dimension::ENERGY, "J"),
    (Dimension::RATE, "1/s"),
    (Dimension::FREQUENCY, "Hz"),
];

/// Names of all quantities that curves can have.
pub fn quantities() -> impl Iterator<Item = &'static str> {
    QUANTITIES.iter().map(|q| q.0)
}

/// Dimensions of abscissa and ordinate of a quantity.
pub(super) fn dimensions(quantity: &str) -> Option<[Dimension; 2]> {
    QUANTITIES.iter().find(|q| q.0 == quantity).map(|q| [q.1, q.2])
}

/// A unit as written in a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit<'a> {
    text: &'a str,
    /// SI unit of the same dimension, such as `J/m`.
    pub(super) si: &'static str,
}

impl<'a> Unit<'a> {
    /// Reads a unit, of a given dimension if one is expected.
    pub(super) fn read(text: &'a str, expected: Option<Dimension>) -> Result<Self, UnitError> {
        let dimension = units::parse(&format!("1 {text}"))?.dimension;
        if let Some(expected) = expected {
            units::parse_as(&format!("1 {text}"), expected)?;
        }
        match SI.iter().find(|s| s.0 == dimension) {
            Some((_, si)) => Ok(Self { text, si }),
            None => Err(UnitError {
                message: format!("{text:?} is {}, which is not a dimension of reference quantities", dimension.name()),
                remedy: format!("use a multiple of one of {}", SI.map(|s| s.1).join(", ")),
            }),
        }
    }

    /// A number in this unit, in SI: the decimal exponents are added, so `35 us` is exactly the double
    /// `35e-6`.
    ///
    /// # Errors
    /// Not-a-number and infinities.
    pub(super) fn to_si(self, value: f64) -> Result<f64, UnitError> {
        units::parse(&format!("{value:e} {}", self.text)).map(|q| q.value)
    }
}
