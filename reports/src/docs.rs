//! Generated parts of README and book: what stands between `<!-- docs: NAME -->` and `<!-- /docs -->`.
//!
//! They come from [`Stored`], which holds the checks of one run as they are printed, with its commit. Nothing
//! between two marks is typed by hand: `cargo xtask report --docs` writes it, and a test fails where it is
//! not what would be written.

use std::collections::BTreeSet;
use std::path::Path;

use fisura_verification::record::{Figure, Record, ResultSet, Status};
use serde::{Deserialize, Serialize};

use crate::error::ReportError;
use crate::markdown::{cell, code};
use crate::number::plain;
use crate::rates::rates;
use crate::text::render_text;
use crate::view::{self, BASES, Basis, Counts};

/// Name of the schema written and read.
pub const DOCS_SCHEMA: &str = "fisura.docs/2";

/// What each suite is about, in the order of the tables.
const SUITES: [(&str, &str); 9] = [
    ("patch", "spline bases, constant stress, bodies halved by symmetry and rigid motion, to round-off"),
    ("convergence", "orders against exact solutions: p + 1 in L2, p in H1; 2 with lumped mass and with moving points"),
    ("manufactured", "the same problems with discrete loads; point layouts that lose order; frequencies of a bar"),
    ("energy", "the energy balance closes; momentum is conserved"),
    ("contact", "impact, sliding, collision, Hertz and a stack, against closed forms"),
    (
        "fracture",
        "closed forms of the phase-field model (AT2), surface energy of cracks, wave speeds, early energies of the plate",
    ),
    (
        "rings",
        "two brittle rings in collision: momentum, balance, symmetry; the geometry is assumed, times of the source paper are shown",
    ),
    ("stability", "critical time step, bodies that end inside a span, extreme input, units, threads, long runs"),
    ("plate", "the cracking plate at h = l0, against finite elements and splines extrapolated to h = 0"),
];

/// Figures of each page of a suite, by their ids in the results.
const FIGURES: [&str; 19] = [
    "patch-linear-field-rational-equilibrium-residual-of-a-linear-field",
    "convergence-elastostatics-random-displacement-error-in-l2",
    "convergence-standing-wave-square-displacement-error-in-l2",
    "convergence-moving-wave-displacement-error-at-the-points",
    "manufactured-bar-eigenfrequencies-frequency-error-of-mode-1",
    "manufactured-limit-uniform-cubics-elastostatics-displacement-error-in-l2",
    "contact-impact-equal-force",
    "contact-hertz-pressure",
    "contact-discs-head-on-energies",
    "fracture-homogeneous-bar",
    "collision-phase-60us",
    "collision-phase-200us",
    "collision-fracture-energy",
    "stability-growth-energy",
    "stability-critical-step-cut",
    "plate-phase-half-p2-h1-80us",
    "plate-elastic-energy",
    "plate-fracture-increment",
    "plate-tip-position",
];

/// The checks of one run as they are printed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    /// [`DOCS_SCHEMA`].
    pub schema: String,
    /// Commit of the program, with a word if there were changes.
    pub commit: String,
    /// Last line that `verify` printed.
    pub verdict: String,
    /// Cases in the order of the plan.
    pub cases: Vec<StoredCase>,
    /// Figures of the pages of the suites, in the order of the results.
    pub figures: Vec<StoredFigure>,
}

/// A figure and what stands below it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredFigure {
    suite: String,
    /// Name of its drawing, without the ending.
    pub id: String,
    title: String,
    caption: String,
    /// Every deviation from the cited source.
    deviations: Vec<String>,
}

/// A case and its checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredCase {
    suite: String,
    case: String,
    claim: String,
    /// Passes by what they were compared with, in the order of [`BASES`].
    passes: [usize; BASES.len()],
    /// Known limits, what fails or broke down, and what is only shown.
    others: [usize; 3],
    /// Name below the case, quantity, value, accepted range and verdict of every record.
    records: Vec<[String; 5]>,
    /// Degree, norm, theory, observed, accepted and error on the finest mesh of every order.
    orders: Vec<[String; 6]>,
}

impl Stored {
    /// What is stored of a result set.
    pub fn of(set: &ResultSet) -> Self {
        let environment = view::environment(set).into_iter().find(|(name, _)| *name == "Commit");
        let verdict = render_text(set).lines().last().unwrap_or_default().to_string();
        let records: Vec<&Record> = set.records.iter().collect();
        let cases = records.chunk_by(|a, b| (&a.suite, &a.case) == (&b.suite, &b.case)).map(stored_case).collect();
        let commit = environment.map_or_else(|| "unknown".to_string(), |(_, commit)| commit);
        let listed = set.figures.iter().filter(|figure| FIGURES.contains(&figure.id.as_str()));
        let figures = listed.map(stored_figure).collect();
        Self { schema: DOCS_SCHEMA.to_string(), commit, verdict, cases, figures }
    }

    /// Reads what a file holds.
    ///
    /// # Errors
    /// The file is missing, malformed or of another schema.
    pub fn read(folder: &Path, name: &str) -> Result<Self, ReportError> {
        crate::read_json(folder, name, DOCS_SCHEMA)
    }

    /// The block of a name; `None` if there is none.
    pub fn block(&self, name: &str) -> Option<String> {
        match name.split_once(' ') {
            None if name == "verdict" => Some(format!("```text\n{}\n```\n", self.verdict)),
            None if name == "suites" => Some(self.suites()),
            Some(("suite", suite)) => self.suite(suite),
            Some(("orders", suite)) => self.orders(suite),
            Some(("figures", suite)) => self.figures(suite),
            _ => None,
        }
    }

    fn of_suite(&self, suite: &str) -> Option<Vec<&StoredCase>> {
        let cases: Vec<&StoredCase> = self.cases.iter().filter(|case| case.suite == suite).collect();
        (!cases.is_empty()).then_some(cases)
    }

    fn suites(&self) -> String {
        let mut out =
            "| suite | what is checked | agree with a reference | hold without one | known limits | fail | shown |\n\
                       |---|---|---|---|---|---|---|\n"
                .to_string();
        for (suite, what) in SUITES {
            let cases = self.of_suite(suite).unwrap_or_default();
            let sum = |count: &dyn Fn(&StoredCase) -> usize| cases.iter().map(|case| count(case)).sum::<usize>();
            let (mut with, mut without) = (Vec::new(), Vec::new());
            for (index, (basis, name)) in BASES.into_iter().enumerate() {
                let count = sum(&|case| case.passes[index]);
                let none = matches!(basis, Basis::Invariant | Basis::Regression);
                let words = if none { &mut without } else { &mut with };
                if count > 0 {
                    words.push(format!("{count} {name}"));
                }
            }
            let [with, without] =
                [with, without].map(|words| if words.is_empty() { "–".into() } else { words.join(", ") });
            let [limits, fails, shown] = [0, 1, 2].map(|index| sum(&|case| case.others[index]));
            out.push_str(&format!("| `{suite}` | {what} | {with} | {without} | {limits} | {fails} | {shown} |\n"));
        }
        format!("{out}\nQuick tier, commit {}.\n", cell(&short(&self.commit)))
    }

    fn suite(&self, suite: &str) -> Option<String> {
        let cases = self.of_suite(suite)?;
        let mut out = format!(
            "Quick tier, commit {}.\n\n| case | claim | pass | known limits |\n|---|---|---|---|\n",
            cell(&short(&self.commit))
        );
        for StoredCase { case, claim, passes, others: [limits, ..], .. } in &cases {
            let pass: usize = passes.iter().sum();
            out.push_str(&format!("| {} | {} | {pass} | {limits} |\n", code(case), cell(claim)));
        }
        for StoredCase { case, records, .. } in &cases {
            let head = "| check | value | accepted | |\n|---|---|---|---|\n";
            out.push_str(&format!("\n<details><summary>{}</summary>\n\n{head}", cell(case)));
            for [name, quantity, value, accepted, status] in records {
                let run = name.rsplit_once('/').map(|(run, _)| format!("{}: ", cell(run))).unwrap_or_default();
                out.push_str(&format!(
                    "| {run}{} | {} | {} | {status} |\n",
                    cell(quantity),
                    cell(value),
                    cell(accepted)
                ));
            }
            out.push_str("\n</details>\n");
        }
        Some(out)
    }

    fn figures(&self, suite: &str) -> Option<String> {
        let figures: Vec<&StoredFigure> = self.figures.iter().filter(|figure| figure.suite == suite).collect();
        let one = |figure: &&StoredFigure| {
            let [title, caption] = [&figure.title, &figure.caption].map(|text| cell(text));
            let below = format!("{title}. {caption}");
            let file = format!("figures/{}.svg", figure.id);
            format!("[![{title}]({file})]({file})\n\n{}\n", below.trim_end())
        };
        let mut parts: Vec<String> = figures.iter().map(one).collect();
        let mut deviations: Vec<String> = figures.iter().flat_map(|f| &f.deviations).map(|text| cell(text)).collect();
        let mut seen = BTreeSet::new();
        deviations.retain(|deviation| seen.insert(deviation.clone()));
        if !deviations.is_empty() {
            parts.push(format!("What differs from the source paper:\n\n- {}\n", deviations.join("\n- ")));
        }
        (!parts.is_empty()).then(|| parts.join("\n"))
    }

    fn orders(&self, suite: &str) -> Option<String> {
        let mut out =
            "| case | degree | error | theory | observed | accepted | finest mesh |\n|---|---|---|---|---|---|---|\n"
                .to_string();
        for StoredCase { case, orders, .. } in self.of_suite(suite)? {
            for order in orders {
                let cells: Vec<String> = order.iter().map(|text| cell(text)).collect();
                out.push_str(&format!("| {} | {} |\n", code(case), cells.join(" | ")));
            }
        }
        Some(format!("{out}\nQuick tier, commit {}.\n", cell(&short(&self.commit))))
    }
}

fn stored_figure(figure: &Figure) -> StoredFigure {
    let [suite, id, title, caption] = [&figure.suite, &figure.id, &figure.title, &figure.caption].map(Clone::clone);
    StoredFigure { suite, id, title, caption, deviations: figure.deviations.clone() }
}

fn short(commit: &str) -> String {
    let (hash, rest) = commit.split_at(commit.find(',').unwrap_or(commit.len()));
    hash.chars().take(12).chain(rest.chars()).collect()
}

fn stored_case(records: &[&Record]) -> StoredCase {
    let first = records[0];
    let counts = Counts::of(records.iter().copied());
    let case = format!("{}/{}/", first.suite, first.case);
    let row = |record: &&Record| {
        let accepted = match record.status {
            Status::Info => String::new(),
            Status::KnownLimit => format!("limit {}", view::limit(record, plain).unwrap_or_default()),
            _ => view::accepted(record, plain),
        };
        let name = record.id.strip_prefix(&case).unwrap_or(&record.id).to_string();
        [name, record.quantity.clone(), view::value(record, plain), accepted, view::word(record.status).to_string()]
    };
    StoredCase {
        suite: first.suite.clone(),
        case: first.case.clone(),
        claim: first.claim.clone(),
        passes: counts.passes,
        others: [counts.known_limit, counts.fail + counts.error, counts.info],
        records: records.iter().map(row).collect(),
        orders: rates(records).iter().map(|rate| rate.cells(plain)).collect(),
    }
}

/// Opening mark of a block, without its name.
const OPEN: &str = "<!-- docs: ";
/// Closing mark.
const CLOSE: &str = "<!-- /docs -->";

/// A document with every block written anew by `block`.
///
/// # Errors
/// In words: a block without a name that is known, or without its end.
pub fn rewritten(document: &str, block: impl Fn(&str) -> Option<String>) -> Result<String, String> {
    let (mut out, mut rest) = (String::new(), document);
    while let Some((before, after)) = rest.split_once(OPEN) {
        let (name, after) = after.split_once(" -->\n").ok_or("a mark of a block has no end")?;
        let (_, after) = after.split_once(CLOSE).ok_or_else(|| format!("the block {name:?} has no {CLOSE}"))?;
        let content = block(name).ok_or_else(|| format!("no block is called {name:?}"))?;
        out.push_str(&format!("{before}{OPEN}{name} -->\n{content}{CLOSE}"));
        rest = after;
    }
    Ok(out + rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::results;

    #[test]
    fn blocks_are_written_between_their_marks_and_nothing_else_changes() {
        let block = |name: &str| (name == "a").then(|| "new\n".to_string());
        let text = "one\n<!-- docs: a -->\nold\n<!-- /docs -->\ntwo\n<!-- docs: a -->\n<!-- /docs -->\n";
        let once = rewritten(text, block).unwrap();
        assert_eq!(once, "one\n<!-- docs: a -->\nnew\n<!-- /docs -->\ntwo\n<!-- docs: a -->\nnew\n<!-- /docs -->\n");
        assert_eq!(rewritten(&once, block).unwrap(), once);
        assert!(rewritten("<!-- docs: b -->\n<!-- /docs -->", block).unwrap_err().contains("\"b\""));
        assert!(rewritten("<!-- docs: a -->\n", block).unwrap_err().contains("has no"));
    }

    #[test]
    fn what_is_stored_says_what_the_records_say() {
        let stored = Stored::of(&results());
        let suites = stored.block("suites").unwrap();
        assert!(suites.contains("| `plate` |") && suites.contains("commit 0123abcd"), "{suites}");
        let plate = stored.block("suite plate").unwrap();
        assert!(plate.contains("38.123") && plate.contains("| fail |"), "{plate}");
        assert!(stored.block("verdict").unwrap().contains("FAIL") || stored.verdict.starts_with("ERROR"));
        assert_eq!((stored.block("suite none"), stored.block("nonsense")), (None, None));
        let text = serde_json::to_string(&stored).unwrap();
        assert_eq!(serde_json::from_str::<Stored>(&text).unwrap(), stored);
    }
}
