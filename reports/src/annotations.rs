//! Workflow commands of GitHub that mark the case files of failed checks.

use fisura_verification::record::{Record, ResultSet};

use crate::number::plain;
use crate::view::{bounds, broken, reason, value};

/// How many annotations of one step are shown.
const SHOWN: usize = 10;

/// One `::error` command per record that does not hold; beyond ten the last one counts the rest.
pub fn render_annotations(set: &ResultSet) -> String {
    let broken = broken(set);
    let (named, rest) = if broken.len() > SHOWN { broken.split_at(SHOWN - 1) } else { (&broken[..], &[][..]) };
    let mut out: String = named.iter().map(|record| annotation(record)).collect();
    if !rest.is_empty() {
        out.push_str(&format!(
            "::error title=verification::{} more checks do not hold; the report names them\n",
            rest.len()
        ));
    }
    out
}

fn annotation(record: &Record) -> String {
    let found = format!("{}: {}, accepted {}", record.quantity, value(record, plain), bounds(&record.accept, plain));
    let text = format!("{}. {found} ({})", record.claim.trim_end_matches('.'), reason(record));
    let file = format!("verification/cases/{}/{}.toml", record.suite, record.case);
    format!("::error file={},title={}::{}\n", property(&file), property(&record.id), data(&text))
}

/// Text after the colons.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// Text of a property.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::results;

    #[test]
    fn failed_checks_are_marked_in_their_case_files() {
        let text = render_annotations(&results());
        let first = "::error file=verification/cases/plate/impact.toml,title=plate/impact/p2/branching-time::";
        assert!(text.starts_with(first) && text.lines().next().unwrap().contains("accepted 30.5 to 31.5 ("), "{text}");
        assert!(text.lines().all(|line| line.starts_with("::error ")), "{text}");
    }

    #[test]
    fn what_would_break_a_command_is_escaped_and_the_rest_is_counted() {
        let mut set = results();
        let mut failed = set.records[1].clone();
        failed.id = "plate/impact/p=2,h:1/time".into();
        failed.claim = "100 %\nof it".into();
        set.records = vec![failed; 12];
        let text = render_annotations(&set);
        assert_eq!(text.lines().count(), 10);
        assert!(text.contains("title=plate/impact/p=2%2Ch%3A1/time::100 %25%0Aof it"), "{text}");
        assert!(text.ends_with("3 more checks do not hold; the report names them\n"), "{text}");
    }
}
