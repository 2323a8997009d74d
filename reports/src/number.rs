//! Numbers as they are printed: a few significant digits, no trailing zeros, no `9.999999e-6`.

/// Significant digits of a value in a table.
pub const DIGITS: usize = 5;

/// `value` with at most `digits` significant digits in ASCII: `4.02`, `0.0001`, `1.25e-7`, `nan`.
pub fn plain(value: f64, digits: usize) -> String {
    match Decimal::new(value, digits) {
        Ok(d) if d.is_fixed() => d.fixed(),
        Ok(d) => format!("{}e{}", d.mantissa, d.exponent),
        Err(word) => word.to_string(),
    }
}

/// The same for a reader of text: a true minus sign and powers of ten, `−1.25×10⁻⁷`.
pub fn pretty(value: f64, digits: usize) -> String {
    match Decimal::new(value, digits) {
        Ok(d) if d.is_fixed() => d.fixed().replace('-', "−"),
        Ok(d) if d.mantissa == "1" => power_of_ten(d.exponent),
        Ok(d) => format!("{}×{}", d.mantissa.replace('-', "−"), power_of_ten(d.exponent)),
        Err(word) => word.replace('-', "−"),
    }
}

/// Power of ten with a raised exponent: `10⁻⁶` for −6.
pub fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]);
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

/// A duration in seconds for a reader: `0.42 ms`, `12.3 s`, `2 min 5 s`, `1 h 3 min`.
pub fn duration(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 0.0 {
        return "unknown".to_string();
    }
    let whole = seconds.round() as u64;
    if seconds < 1.0 {
        format!("{} ms", plain(seconds * 1e3, 3))
    } else if seconds < 99.95 {
        format!("{} s", plain(seconds, 3))
    } else if whole < 3600 {
        format!("{} min {} s", whole / 60, whole % 60)
    } else {
        format!("{} h {} min", whole / 3600, whole % 3600 / 60)
    }
}

/// `1234567` as `1 234 567`, with narrow no-break spaces.
pub fn grouped(count: u64) -> String {
    let digits: Vec<char> = count.to_string().chars().collect();
    let groups: Vec<String> = digits.rchunks(3).rev().map(|group| group.iter().collect()).collect();
    groups.join("\u{202f}")
}

/// A number rounded to some digits, split into mantissa and power of ten.
struct Decimal {
    value: f64,
    mantissa: String,
    exponent: i32,
    digits: usize,
}

impl Decimal {
    fn new(value: f64, digits: usize) -> Result<Self, &'static str> {
        match value {
            v if v.is_nan() => return Err("nan"),
            f64::INFINITY => return Err("inf"),
            f64::NEG_INFINITY => return Err("-inf"),
            _ => {}
        }
        let value = if value == 0.0 { 0.0 } else { value };
        let digits = digits.max(1);
        let text = format!("{:.*e}", digits - 1, value);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        Ok(Self { value, mantissa: trim_zeros(mantissa), exponent: exponent.parse().unwrap_or(0), digits })
    }

    /// Whether it reads best without a power of ten.
    fn is_fixed(&self) -> bool {
        (-4..6).contains(&self.exponent)
    }

    fn fixed(&self) -> String {
        let decimals = (self.digits as i32 - 1 - self.exponent).max(0) as usize;
        trim_zeros(&format!("{:.decimals$}", self.value))
    }
}

fn trim_zeros(text: &str) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_few_and_clean() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (4.0, "4"),
            (4.02, "4.02"),
            (123456.7, "123457"),
            (9.999999e-6, "1e-5"),
            (0.00012345678, "0.00012346"),
            (-1.25e-7, "-1.25e-7"),
            (6.02214e23, "6.0221e23"),
            (f64::NAN, "nan"),
            (f64::NEG_INFINITY, "-inf"),
        ];
        for (value, text) in cases {
            assert_eq!(plain(value, DIGITS), text);
        }
        assert_eq!(pretty(-1.25e-7, 4), "−1.25×10⁻⁷");
        assert_eq!(pretty(9.9999999e-6, 4), "10⁻⁵");
    }

    #[test]
    fn durations_and_counts_read_well() {
        assert_eq!(duration(0.00042), "0.42 ms");
        assert_eq!(duration(12.34), "12.3 s");
        assert_eq!(duration(125.2), "2 min 5 s");
        assert_eq!(duration(3800.0), "1 h 3 min");
        assert_eq!(duration(f64::NAN), "unknown");
        assert_eq!(grouped(1234567), "1\u{202f}234\u{202f}567");
    }
}
