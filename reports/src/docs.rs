//! Generated parts of README and book: what stands between `<!-- docs: NAME -->` and `<!-- /docs -->`.
//!
//! Nothing between two marks is typed by hand: `cargo xtask report --docs` writes it.

use std::sync::LazyLock;

use fisura_verification::record::ResultSet;
use serde::Deserialize;

use crate::text::render_text;
use crate::view::{BASES, Basis, Counts, limited};

/// The suites, in the order of the tables.
#[derive(Deserialize)]
struct Suites {
    suite: Vec<Suite>,
}

#[derive(Deserialize)]
struct Suite {
    name: String,
    about: String,
}

static SUITES: LazyLock<Suites> = LazyLock::new(|| {
    toml::from_str(include_str!("docs/suites.toml")).expect("suites.toml lists suites; tests read it")
});

/// The block of a name that shows results; `None` if there is none.
pub fn block(set: &ResultSet, name: &str) -> Option<String> {
    match name {
        "verdict" => Some(format!("```text\n{}\n```\n", render_text(set).lines().last().unwrap_or_default())),
        "suites" => Some(suites(set)),
        _ => None,
    }
}

/// Whether a block shows results.
pub fn shows_results(name: &str) -> bool {
    ["verdict", "suites"].contains(&name)
}

/// Whether results are those of all suites.
pub fn holds_all_suites(set: &ResultSet) -> bool {
    SUITES.suite.iter().all(|suite| set.records.iter().any(|record| record.suite == suite.name))
}

fn suites(set: &ResultSet) -> String {
    let mut out =
        "| suite | what is checked | agree with a reference | hold without one | known limits | fail | info |\n\
                   |---|---|---|---|---|---|---|\n"
            .to_string();
    for Suite { name: suite, about } in &SUITES.suite {
        let counts = Counts::of(set.records.iter().filter(|record| record.suite == *suite));
        let (mut with, mut without) = (Vec::new(), Vec::new());
        for ((basis, name), count) in BASES.into_iter().zip(counts.passes) {
            let words = if matches!(basis, Basis::Invariant | Basis::Regression) { &mut without } else { &mut with };
            if count > 0 {
                words.push(format!("{count} {name}"));
            }
        }
        let [with, without] = [with, without].map(|words| if words.is_empty() { "–".into() } else { words.join(", ") });
        let of_suite = limited(set).into_iter().filter(|record| record.suite == *suite);
        let late = of_suite.filter(|record| record.limit.as_ref().is_some_and(|limit| limit.regression)).count();
        let late = if late > 0 { format!(" ({late} chosen after the result)") } else { String::new() };
        let limits = format!("{}{late}", counts.known_limit);
        let (fails, shown) = (counts.fail + counts.error, counts.info);
        out.push_str(&format!("| `{suite}` | {about} | {with} | {without} | {limits} | {fails} | {shown} |\n"));
    }
    out
}

/// Opening mark of a block, without its name.
const OPEN: &str = "<!-- docs: ";
/// Closing mark of a block.
const CLOSE: &str = "<!-- /docs -->";

/// A document with every block written again by `block`, which is given its name and what stands in it.
///
/// # Errors
/// In words: a block without a name that is known, or without its end.
pub fn rewritten(document: &str, block: impl Fn(&str, &str) -> Option<String>) -> Result<String, String> {
    let (mut out, mut rest) = (String::new(), document);
    while let Some((before, after)) = rest.split_once(OPEN) {
        let (name, after) = after.split_once(" -->\n").ok_or("a mark of a block has no end")?;
        let (old, after) = after.split_once(CLOSE).ok_or_else(|| format!("the block {name:?} has no {CLOSE}"))?;
        let content = block(name, old).ok_or_else(|| format!("no block is called {name:?}"))?;
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
        let block = |name: &str, _: &str| (name == "a").then(|| "new\n".to_string());
        let text = "one\n<!-- docs: a -->\nold\n<!-- /docs -->\ntwo\n<!-- docs: a -->\n<!-- /docs -->\n";
        let once = rewritten(text, block).unwrap();
        assert_eq!(once, "one\n<!-- docs: a -->\nnew\n<!-- /docs -->\ntwo\n<!-- docs: a -->\nnew\n<!-- /docs -->\n");
        assert_eq!(rewritten(&once, block).unwrap(), once);
        assert!(rewritten("<!-- docs: b -->\n<!-- /docs -->", block).unwrap_err().contains("\"b\""));
        assert!(rewritten("<!-- docs: a -->\n", block).unwrap_err().contains("has no"));
    }

    #[test]
    fn blocks_of_results_say_what_the_records_say() {
        let set = results();
        let suites = block(&set, "suites").unwrap();
        assert!(suites.contains("| `plate` |") && suites.lines().count() == 2 + SUITES.suite.len(), "{suites}");
        assert!(block(&set, "verdict").unwrap().contains("(6 pass"), "{:?}", block(&set, "verdict"));
        assert!(block(&set, "nonsense").is_none() && !shows_results("nonsense"));
        assert!(!holds_all_suites(&set), "the example has one suite");
    }
}
