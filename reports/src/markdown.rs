//! `summary.md`: what a step summary of a CI run shows first.

use fisura_verification::output::foreign::line;
use fisura_verification::record::ResultSet;

use crate::template::{filled, summary};

/// The summary, one screen if nothing fails: verdict, environment, what does not hold, counts of every suite.
pub fn render_markdown(set: &ResultSet) -> String {
    filled("summary.md", include_str!("../templates/summary.md"), summary(set))
}

/// Text as itself: one line, nothing that Markdown or HTML would take for its own.
pub(crate) fn cell(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in line(text).split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '|' | '\\' | '`' | '*' | '_' | '[' | ']' | '~' | '$' | '#' | '!' => out.extend(['\\', c]),
            c => out.push(c),
        }
    }
    out
}

/// An id as code in a table, where a bar needs a backslash and nothing else can be escaped.
pub(crate) fn code(id: &str) -> String {
    format!("`{}`", line(id).replace('`', "'").replace('\\', "/").replace('|', "\\|"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stay_cells() {
        assert_eq!(cell("a | b\n<c>"), "a \\| b &lt;c>");
        assert_eq!(cell("![x](javascript:y) **z** `q` $e$"), r"\!\[x\](javascript:y) \*\*z\*\* \`q\` \$e\$");
        assert_eq!(code("a|b`c\u{1b}"), "`a\\|b'c\u{fffd}`");
    }
}
