//! `judge --new BENCHMARK`: a commented `submission.toml`.

use super::numbers::{elements, values};

const HEAD: &str = include_str!("../../templates/head.toml");
const PLATE: &str = include_str!("../../templates/plate.toml");
const KALTHOFF: &str = include_str!("../../templates/kalthoff.toml");
const AT1: &str = include_str!("../../templates/at1.toml");
const CURVES: &str = include_str!("../../templates/curves.toml");

/// The template for a benchmark.
pub fn template(benchmark: &str) -> String {
    let head = HEAD.replace('@', benchmark);
    match benchmark {
        "plate" => return head + PLATE + CURVES,
        "kalthoff" => return head + KALTHOFF + CURVES,
        _ => {}
    }
    let rows = values(benchmark).iter().map(|a| {
        let example = if a.unit == "1" { "0.0".to_string() } else { format!("\"0.0 {}\"", a.unit) };
        format!("{} = {example} # {}\n", a.name, a.what)
    });
    let model = elements(benchmark).map(|elements| {
        let l0 = (1e3 * elements.length_scale).to_string();
        AT1.replace("@split", &elements.split).replace("@l0", &l0)
    });
    head + &model.unwrap_or_default() + "\n[values]\n" + &rows.collect::<String>()
}
