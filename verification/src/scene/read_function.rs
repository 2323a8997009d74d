//! From the tree of a document to functions: factors over time, and stress fields.

use fisura::scene::StressField;
use fisura::scene::time::{Course, TimeFactor, TimeFormula};

use super::fields::Item;
use super::read::{number, point, time};
use super::read_file::rows_of_file;
use super::units::{self, Dimension};
use crate::arithmetic::Arithmetic;

/// A factor over time: `{ ramp = "1 us", until = "5 us" }`.
pub(super) fn factor(item: &Item<'_>) -> Option<TimeFactor> {
    item.table(|fields| {
        let until = fields.maybe("until", time);
        let course = match fields.one_of(&["ramp", "smooth", "table", "file", "formula"])? {
            None => Some(Course::Constant),
            Some(("ramp", rise)) => time(&rise).map(Course::Ramp),
            Some(("smooth", rise)) => time(&rise).map(Course::Smooth),
            Some(("table", rows)) => rows.each(row).map(Course::Table),
            Some(("file", name)) => {
                let remedy = "give a CSV file beside the scene with rows of time (s) and factor";
                rows_of_file(&name, remedy).map(Course::Table)
            }
            Some((_, text)) => {
                let remedy = "give a formula of t (s), such as \"exp(-t / 100 us)\"";
                let (text, value) = function(&text, ["t"], true, remedy)?;
                Some(Course::Formula(TimeFormula::new(text, move |t| value([t]))))
            }
        };
        Some(TimeFactor { course: course?, until })
    })
}

/// A row of a table: a time and a factor.
fn row(item: &Item<'_>) -> Option<[f64; 2]> {
    let entries = item.list()?;
    let [at, value] = entries.as_slice() else {
        return item.fail("expected a time and a factor", "give rows such as [\"1 us\", 0.5]");
    };
    time(at).zip(number(value)).map(|(time, value)| [time, value])
}

/// A formula of these names, in which numbers may have units of time, and the text of it.
fn function<const N: usize>(
    item: &Item<'_>,
    names: [&'static str; N],
    has_times: bool,
    remedy: &str,
) -> Option<(String, impl Fn([f64; N]) -> f64 + Send + Sync + use<N>)> {
    let text = item.words()?;
    let plain = if has_times { plain_numbers(&text) } else { Ok(text.clone()) };
    let arithmetic = match plain.and_then(|plain| plain.parse::<Arithmetic>()) {
        Ok(arithmetic) => arithmetic,
        Err(message) => return item.fail(message, remedy),
    };
    if let Some(name) = arithmetic.names().iter().find(|name| !names.contains(&name.as_str())) {
        return item.fail(format!("unknown name {name:?} in a formula of {}", names.join(", ")), remedy);
    }
    let used: Vec<usize> = (0..N).filter(|&i| arithmetic.names().iter().any(|name| name == names[i])).collect();
    Some((text, move |values: [f64; N]| arithmetic.value(&used.iter().map(|&i| values[i]).collect::<Vec<f64>>())))
}

/// The stress field of a traction: a name, `"kirsch"`; that with its scales, or its components as formulas of
/// x and y.
pub(super) fn stress_field(item: &Item<'_>) -> Option<StressField> {
    if item.node.as_str().is_some() {
        item.choice(&[("kirsch", ())])?;
        return Some(kirsch(1.0, 1.0, [0.0; 2]));
    }
    let fields = item.fields(&["xx", "yy", "xy", "kirsch"])?;
    let has_components = ["xx", "yy", "xy"].iter().any(|component| fields.get(component).is_some());
    if has_components == fields.get("kirsch").is_some() {
        let message = if has_components { "both kirsch and components are given" } else { "no component is given" };
        return item.fail(message, "give xx, yy or xy, or kirsch = { stress = \"1 MPa\", radius = \"10 mm\" }");
    }
    if let Some(scales) = fields.get("kirsch") {
        return scales.table(|fields| {
            let stress = fields.need("stress", "stress = \"1 MPa\"", |item| item.quantity(Dimension::STRESS));
            let radius = fields.need("radius", "radius = \"10 mm\"", |item| item.positive(Dimension::LENGTH));
            let center = fields.or("center", [0.0; 2], point);
            Some(kirsch(stress?, radius?, center))
        });
    }
    let remedy = "give a formula of x and y (m) for the stress in Pa, such as \"1e6 * (1 - y / 0.02)\"";
    let [xx, yy, xy] = ["xx", "yy", "xy"].map(|component| match fields.get(component) {
        Some(item) => function(&item, ["x", "y"], false, remedy).map(Some),
        None => Some(None),
    });
    let components = [xx?, yy?, xy?];
    let texts: Vec<&str> = components.iter().flatten().map(|(text, _)| text.as_str()).collect();
    let text = texts.join(", ");
    Some(StressField::new(text, move |at| {
        components.each_ref().map(|component| component.as_ref().map_or(0.0, |(_, value)| value(at)))
    }))
}

/// That of an infinite plate with a hole of a radius (m) about a centre (m), which is pulled along x (Pa):
/// Kirsch 1898.
fn kirsch(stress: f64, radius: f64, center: [f64; 2]) -> StressField {
    StressField::new(format!("kirsch({stress}, {radius}, {center:?})"), move |at| {
        let [x, y] = [0, 1].map(|d| (at[d] - center[d]) / radius);
        let (near, angle) = (1.0 / (x * x + y * y), y.atan2(x));
        let ((sin2, cos2), (sin4, cos4)) = ((2.0 * angle).sin_cos(), (4.0 * angle).sin_cos());
        let nearest = 1.5 * near * near;
        let xx = 1.0 - near * (1.5 * cos2 + cos4) + nearest * cos4;
        let yy = -near * (0.5 * cos2 - cos4) - nearest * cos4;
        let xy = -near * (0.5 * sin2 + sin4) + nearest * sin4;
        [xx, yy, xy].map(|component| stress * component)
    })
}

/// A formula without units: numbers that have one are in seconds.
fn plain_numbers(text: &str) -> Result<String, String> {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit() || c == '.') {
        let (before, number) = rest.split_at(start);
        plain.push_str(before);
        let in_a_name = plain.chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_');
        let end = if in_a_name { 1 } else { units::number_end(number).max(1) };
        let after = &number[end..];
        let gap = after.len() - after.trim_start_matches(' ').len();
        let unit = after[gap..].find(|c: char| !c.is_alphabetic()).map_or(&after[gap..], |end| &after[gap..gap + end]);
        if in_a_name || unit.is_empty() {
            plain.push_str(&number[..end]);
            rest = after;
        } else {
            let quantity = format!("{} {unit}", &number[..end]);
            let seconds = units::parse_as(&quantity, Dimension::TIME).map_err(|e| e.message)?;
            plain.push_str(&format!("{seconds:e}"));
            rest = &after[gap + unit.len()..];
        }
    }
    plain.push_str(rest);
    Ok(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_formula_may_have_units_of_time() {
        let seconds = |text: &str| plain_numbers(text).unwrap().parse::<Arithmetic>().unwrap().value(&[2e-6]);
        assert_eq!(seconds("t / 1 us"), 2.0);
        assert_eq!(seconds("min(t / 4e0 us, 1) + 0.5*t/2e-6"), 1.0);
        assert!(plain_numbers("t / 1 mm").is_err());
    }
}
