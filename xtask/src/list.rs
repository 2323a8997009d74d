//! `list`: suites and cases.

use std::collections::BTreeSet;

use fisura_reports::number::duration;
use fisura_verification::foreign::line;
use fisura_verification::scene_file::SceneFileError;
use fisura_verification::suite::prepare::{Prepared, prepare};
use fisura_verification::suite::{Case, read_cases};
use serde_json::{Value, json};

use crate::cli::{Common, Format};
use crate::console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::verify::{cases_folder, library};

/// Prints every case of every suite.
///
/// # Errors
/// No folder of cases, and case files that are wrong: they are shown after what is sound.
pub fn list(common: &Common) -> Result<Exit, Failure> {
    console::no_files(common, "list");
    let (cases, malformed) = read_cases(&cases_folder()?, &[]);
    let library = library()?;
    let mut wrong: Vec<SceneFileError> = malformed.into_iter().map(|file| file.error).collect();
    let mut sound = Vec::new();
    for case in cases {
        match prepare(&case, &library) {
            Ok(prepared) => sound.push((case, prepared)),
            Err(error) => wrong.push(error),
        }
    }
    let cases: Vec<&Case> = sound.iter().map(|(case, _)| case).collect();
    match common.format {
        Format::Json => {
            let entries: Vec<Value> = sound.iter().map(|(case, prepared)| entry(case, prepared)).collect();
            let suites: BTreeSet<&str> = cases.iter().map(|case| case.suite.as_str()).collect();
            console::json(&json!({ "suites": suites, "tiers": ["quick", "full"], "cases": entries }));
        }
        Format::Text => console::result(&text(&cases)),
    }
    Ok(wrong.into_iter().fold(Exit::Done, |_, error| Failure::from(error).show()))
}

fn entry(case: &Case, prepared: &Prepared) -> Value {
    let records: Vec<String> = prepared.records.iter().map(|planned| planned.id(case)).collect();
    json!({
        "id": case.id(),
        "suite": case.suite,
        "case": case.name,
        "tier": case.tier.to_string(),
        "claim": case.claim,
        "models": case.models,
        "seconds": case.seconds,
        "records": records,
    })
}

fn text(cases: &[&Case]) -> String {
    let ids: Vec<String> = cases.iter().map(|case| line(&case.id()).into_owned()).collect();
    let width = ids.iter().map(|id| id.chars().count()).max().unwrap_or(0);
    let mut out = String::new();
    for (case, id) in cases.iter().zip(&ids) {
        let (tier, seconds) = (case.tier.to_string(), duration(case.seconds));
        let models = case.models.join(", ");
        out.push_str(&format!("{id:width$}  {tier:5}  {seconds:>10}  {} [{models}]\n", line(&case.claim)));
    }
    for tier in ["quick", "full"] {
        let of_tier = cases.iter().filter(|case| case.tier.to_string() == tier);
        let (count, seconds) = of_tier.fold((0, 0.0), |(n, s), case| (n + 1, s + case.seconds));
        out.push_str(&format!("{tier}: {count} cases, about {}\n", duration(seconds)));
    }
    out
}
