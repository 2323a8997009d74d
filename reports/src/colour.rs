//! The colour map of fields: from dark blue to near white, with lightness linear in the value.
//!
//! It is built in Oklab (Ottosson 2020), where equal steps look equally large, so no step stands out that is
//! not in the data; in a phase field the crack (c = 0) is dark and the intact body light, on paper as on a
//! screen.

/// Colours that a picture is quantised to.
pub const LEVELS: usize = 64;

/// Lightness, chroma and hue (degrees) at values 0, 1/3, 2/3 and 1.
const STOPS: [[f64; 3]; 4] = [[0.20, 0.075, 285.0], [0.455, 0.115, 258.0], [0.71, 0.090, 222.0], [0.965, 0.018, 150.0]];

/// Colour `#rrggbb` of `value` between 0 and 1; outside, that of the nearer end.
pub fn colour(value: f64) -> String {
    let [r, g, b] = rgb(value.clamp(0.0, 1.0));
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Index of the colour of `value` among [`LEVELS`] over `range`.
pub fn level(value: f64, range: [f64; 2]) -> usize {
    let fraction = ((value - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0);
    ((fraction * LEVELS as f64) as usize).min(LEVELS - 1)
}

/// Colour `#rrggbb` of a level, which is less than [`LEVELS`].
pub fn level_colour(level: usize) -> String {
    colour(level as f64 / (LEVELS - 1) as f64)
}

fn rgb(value: f64) -> [u8; 3] {
    let place = value * (STOPS.len() - 1) as f64;
    let i = (place as usize).min(STOPS.len() - 2);
    let t = place - i as f64;
    let mix = |k: usize| STOPS[i][k] + t * (STOPS[i + 1][k] - STOPS[i][k]);
    let (lightness, chroma, hue) = (mix(0), mix(1), mix(2).to_radians());
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
    .map(gamma)
}

/// Linear light to a byte of sRGB.
fn gamma(linear: f64) -> u8 {
    let v = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (v.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_rises_with_the_value_and_ends_with_the_range() {
        let luma = |v: f64| {
            let [r, g, b] = rgb(v).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((1..=100).all(|i| luma(i as f64 / 100.0) > luma((i - 1) as f64 / 100.0)));
        assert!(luma(0.0) < 30.0 && luma(1.0) > 235.0);
        assert_eq!([-3.0, 1.0, 7.0].map(|value| level(value, [0.0, 1.0])), [0, LEVELS - 1, LEVELS - 1]);
    }
}
