//! Quantities with units: values to the last bit, and what is refused.

use fisura_verification::scene::units::{Dimension, parse, parse_as};

#[test]
fn units_give_the_double_of_the_si_value() {
    let (speed, density) = (Dimension::VELOCITY, Dimension::DENSITY);
    for (text, dimension, value) in [
        ("32 GPa", Dimension::STRESS, 32e9),
        ("32GPa", Dimension::STRESS, 32e9),
        ("1.5 MPa", Dimension::STRESS, 1.5e6),
        ("5 N/mm^2", Dimension::STRESS, 5e6),
        ("2 bar", Dimension::STRESS, 2e5),
        ("0.25 mm", Dimension::LENGTH, 0.25e-3),
        ("-1 um", Dimension::LENGTH, -1e-6),
        ("1e-3 km", Dimension::LENGTH, 1.0),
        ("80 us", Dimension::TIME, 80e-6),
        ("80 \u{b5}s", Dimension::TIME, 80e-6),
        ("80 \u{3bc}s", Dimension::TIME, 80e-6),
        ("2 min", Dimension::TIME, 120.0),
        ("2450 kg/m^3", density, 2450.0),
        ("2.45 g/cm^3", density, 2450.0),
        ("2450e-12 t/mm^3", density, 2450.0),
        ("2450 kg/m³", density, 2450.0),
        ("2450 kg m^-3", density, 2450.0),
        ("2450 kg*m**-3", density, 2450.0),
        ("3 J/m^2", Dimension::ENERGY_PER_AREA, 3.0),
        ("3 N/m", Dimension::ENERGY_PER_AREA, 3.0),
        ("3e-3 N/mm", Dimension::ENERGY_PER_AREA, 3.0),
        ("3 kg/s^2", Dimension::ENERGY_PER_AREA, 3.0),
        ("10 m/s", speed, 10.0),
        ("10 mm/ms", speed, 10.0),
        ("9.81 m/s^2", Dimension::ACCELERATION, 9.81),
        ("9.81 m/s/s", Dimension::ACCELERATION, 9.81),
        ("1 kg/(m s^2)", Dimension::STRESS, 1.0),
        ("180 deg", Dimension::NONE, std::f64::consts::PI),
        ("2 rad/s", Dimension::RATE, 2.0),
        ("60 rpm", Dimension::RATE, std::f64::consts::TAU),
        ("50 1/s", Dimension::RATE, 50.0),
        ("1 kHz", Dimension::FREQUENCY, 1e3),
        ("20 %", Dimension::NONE, 0.2),
        ("0.2", Dimension::NONE, 0.2),
        (" +.5 m ", Dimension::LENGTH, 0.5),
        ("1_000 m", Dimension::LENGTH, 1000.0),
        ("1 N m", Dimension::ENERGY, 1.0),
        ("1 kN", Dimension::FORCE, 1e3),
        ("2 g", Dimension::MASS, 2e-3),
    ] {
        let found = parse_as(text, dimension).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert!((found - value).abs() <= 1e-15 * value.abs(), "{text}: {found:e} instead of {value:e}");
        if !text.contains(['d', 'r', '%']) && !text.contains("min") {
            assert_eq!(found.to_bits(), value.to_bits(), "{text}: {found:e} instead of {value:e}");
        }
    }
}

#[test]
fn what_is_no_quantity_is_refused_with_a_remedy() {
    for (text, expected) in [
        ("", "does not start with a number"),
        ("mm", "does not start with a number"),
        ("- mm", "does not start with a number"),
        ("nan m", "does not start with a number"),
        ("1e999 m", "not a finite number"),
        ("1e99999999999999999999 m", "not a finite number"),
        ("1 furlong", "unknown unit \"furlong\""),
        ("1 MM", "did you mean \"mm\""),
        ("1 Km", "did you mean \"km\""),
        ("1 m^", "power"),
        ("1 m^99", "between -9 and 9"),
        ("1 m^1.5", "missing unit symbol"),
        ("1 m/", "missing unit symbol"),
        ("1 (m", "missing ')'"),
        ("1 m)", "unexpected ')'"),
        ("1 kg/m s", "ambiguous: product or divisor"),
        ("1 ((((((m))))))", "too many parentheses"),
        ("1 s", "is a time, expected a length"),
        ("1", "is a plain number, expected a length"),
        ("1 m^2 s", "is a quantity in m^2 s, expected a length"),
        ("1, m", "missing unit symbol"),
        ("1 🦀", "missing unit symbol"),
    ] {
        let error = parse_as(text, Dimension::LENGTH).expect_err(text).to_string();
        assert!(error.contains(expected) && error.contains("a length such as \"0.25 mm\""), "{text}: {error}");
    }
    assert!(parse(&format!("1 {}", "m ".repeat(1000))).is_err());
    assert!(parse("1 ((((Tm^9)^9)^9)^9)^9").is_err());
    assert_eq!(parse("0 m").unwrap().value, 0.0);
}

/// 159.15 Hz are 1000 rad/s, and not 159.15.
#[test]
fn a_frequency_is_no_angular_velocity() {
    for text in ["159.15 Hz", "0.15915 kHz", "159.15 Hz m/m", "2 J Hz/J"] {
        let error = parse_as(text, Dimension::RATE).expect_err(text).to_string();
        assert!(error.contains("is a frequency, expected an angular velocity") && error.contains("2 pi"), "{error}");
    }
    let error = parse_as("159.15 Hz", Dimension::RATE).unwrap_err().to_string();
    assert!(error.contains("\"999.96"), "the angular velocity it is: {error}");
    for text in ["1 1/Hz", "1 Hz^-1"] {
        let error = parse_as(text, Dimension::TIME).expect_err(text).to_string();
        assert!(error.contains("cycle^-1"), "{error}");
    }
    let full_turn = parse_as("360 deg/s", Dimension::RATE).unwrap();
    assert!((full_turn - std::f64::consts::TAU).abs() < 1e-14);
}
