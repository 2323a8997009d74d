//! `list`: suites and cases.

use std::collections::BTreeSet;

use fisura_reports::number::duration;
use fisura_reports::template::filled;
use fisura_verification::output::foreign::line;
use fisura_verification::scene::SceneFileError;
use fisura_verification::scene::document::Node;
use fisura_verification::suite::prepare::{Prepared, prepare};
use fisura_verification::suite::{Case, Selection, Tier, read_cases, select};
use minijinja::value::Serde;
use serde_json::{Value, json};

use crate::cli::Common;
use crate::console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::verify::{cases_folder, checked_glob, library};

/// Arguments of `list`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only cases whose id matches, such as plate/*, with the records of each
    #[arg(long, value_name = "GLOB")]
    case: Option<String>,
}

/// Prints every case of every suite, or those that match with their records.
///
/// # Errors
/// No folder of cases, a bad pattern, and case files that are wrong: they are shown after what is sound.
pub fn list(args: &Args, common: &Common) -> Result<Exit, Failure> {
    console::no_files(common, "list");
    let selection = Selection { suites: Vec::new(), case_glob: checked_glob(args.case.as_deref())?, tier: Tier::Full };
    let (cases, malformed) = read_cases(&cases_folder()?, &[]);
    let library = library()?;
    let meant = malformed.into_iter().filter(|file| selection.names(&file.suite, &file.id));
    let mut wrong: Vec<SceneFileError> = meant.map(|file| file.error).collect();
    let mut sound = Vec::new();
    for case in select(cases, &selection) {
        match prepare(&case, &library) {
            Ok(prepared) => sound.push((case, prepared)),
            Err(error) => wrong.push(error),
        }
    }
    if sound.is_empty() && wrong.is_empty() {
        return Err(Failure::new(Exit::NothingSelected, "no case matches").help("`cargo xtask list` lists all cases"));
    }
    let entries: Vec<Value> = sound.iter().map(|(case, prepared)| entry(case, prepared)).collect();
    let suites: BTreeSet<&str> = sound.iter().map(|(case, _)| case.suite.as_str()).collect();
    let shown = json!({ "suites": suites, "tiers": ["quick", "full"], "cases": entries });
    console::show(common, &shown, || match args.case {
        Some(_) => sound.iter().map(expanded).collect(),
        None => filled("list.txt", include_str!("texts/list.txt"), Serde(&shown)),
    });
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
        "checks": case.document.root.get("check").map(Node::to_json),
    })
}

/// A case and its records, each with the check behind it as if it stood in the file alone.
fn expanded((case, prepared): &(Case, Prepared)) -> String {
    let checks = case.document.root.get("check").and_then(Node::as_array).unwrap_or_default();
    let said = |index: usize| {
        let table = checks.get(index).and_then(Node::as_table).into_iter().flatten();
        let others = table.filter(|(key, _)| !["id", "quantity", "variant"].contains(&key.as_str()));
        others.map(|(key, node)| format!("    {key} = {}\n", line(&node.to_json().to_string()))).collect::<String>()
    };
    let records = prepared.records.iter().map(|planned| {
        let check = &case.checks[planned.check];
        format!("  {}: {}\n{}", line(&planned.id(case)), line(&check.quantity), said(planned.check))
    });
    let (seconds, models) = (duration(case.seconds), case.models.join(", "));
    let head = format!("{}: {} [{models}], {}, {seconds}\n", line(&case.id()), line(&case.claim), case.tier);
    head + &records.collect::<String>()
}
