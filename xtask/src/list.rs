//! `list`: suites and cases.

use std::collections::BTreeSet;

use fisura_reports::number::duration;
use fisura_verification::suite::{Case, load_cases};
use serde_json::{Value, json};

use crate::cli::{Common, Format};
use crate::console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::verify::cases_folder;

/// Prints every case of every suite.
///
/// # Errors
/// A case file that is wrong.
pub fn list(common: &Common) -> Result<Exit, Failure> {
    console::no_files(common, "list");
    let cases = load_cases(&cases_folder()?, &[])?;
    match common.format {
        Format::Json => {
            let entries: Vec<Value> = cases.iter().map(entry).collect();
            let suites: BTreeSet<&str> = cases.iter().map(|case| case.suite.as_str()).collect();
            console::json(&json!({ "suites": suites, "tiers": ["quick", "full"], "cases": entries }));
        }
        Format::Text => console::result(&text(&cases)),
    }
    Ok(Exit::Done)
}

fn entry(case: &Case) -> Value {
    json!({
        "id": case.id(),
        "suite": case.suite,
        "case": case.name,
        "tier": case.tier.to_string(),
        "claim": case.claim,
        "models": case.models,
        "seconds": case.seconds,
    })
}

fn text(cases: &[Case]) -> String {
    let ids: Vec<String> = cases.iter().map(Case::id).collect();
    let width = ids.iter().map(|id| id.chars().count()).max().unwrap_or(0);
    let mut out = String::new();
    for (case, id) in cases.iter().zip(&ids) {
        let (tier, seconds) = (case.tier.to_string(), duration(case.seconds));
        let models = case.models.join(", ");
        out.push_str(&format!("{id:width$}  {tier:5}  {seconds:>10}  {} [{models}]\n", case.claim));
    }
    for tier in ["quick", "full"] {
        let of_tier = cases.iter().filter(|case| case.tier.to_string() == tier);
        let (count, seconds) = of_tier.fold((0, 0.0), |(n, s), case| (n + 1, s + case.seconds));
        out.push_str(&format!("{tier}: {count} cases, about {}\n", duration(seconds)));
    }
    out
}
