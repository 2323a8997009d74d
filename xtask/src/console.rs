//! What goes to which stream: results to standard output, everything else to standard error.
//!
//! Names, titles and messages may come from files of others. Characters that steer a terminal are replaced
//! here, on the way out; only the pictures of diagnostics, which have colours of their own, are cleaned where
//! they are made.

use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::process::exit;

use fisura_verification::output::foreign;
use serde::Serialize;

use crate::cli::{Common, Format};
use crate::exit::Exit;

/// Writes a result to standard output. A reader that went away is no error.
pub fn result(text: &str) {
    let text = foreign::text(text);
    let mut out = stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush())
        && error.kind() != ErrorKind::BrokenPipe
    {
        error_text(&format!("error: standard output cannot be written: {error}\n"));
        exit(Exit::BadInput as i32);
    }
}

/// Writes a result to standard output in the form that is asked for.
pub fn show(common: &Common, value: &impl Serialize, text: impl FnOnce() -> String) {
    match common.format {
        Format::Json => json(value),
        Format::Text => result(&text()),
    }
}

/// Writes a result to standard output as JSON.
pub fn json(value: &impl Serialize) {
    match serde_json::to_string_pretty(value) {
        Ok(text) => result(&(escaped(&text) + "\n")),
        Err(error) => error_text(&format!("error: the result cannot be written as JSON: {error}\n")),
    }
}

/// JSON, in which characters that steer a terminal can stand in texts only, with these as escapes.
fn escaped(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        if c != '\n' && foreign::steers(c) {
            out.push_str(&format!("\\u{:04x}", c as u32));
        } else {
            out.push(c);
        }
    }
    out
}

/// Writes to standard error.
pub fn error_text(text: &str) {
    picture(&foreign::text(text));
}

/// Writes what has colours of its own to standard error; texts of others in it are clean already.
pub fn picture(text: &str) {
    let _ = stderr().lock().write_all(text.as_bytes()); // there is no other place left to complain
}

/// Tells people something on standard error, unless they asked for quiet.
pub fn note(common: &Common, text: &str) {
    if !common.quiet {
        error_text(&format!("{text}\n"));
    }
}

/// Says that `--out` has no effect on a command that writes no files.
pub fn no_files(common: &Common, command: &str) {
    if common.out.is_some() {
        note(common, &format!("warning: {command} writes no files, so --out has no effect"));
    }
}

/// Whether standard error is a terminal that may show progress bars.
pub fn interactive(common: &Common) -> bool {
    !common.quiet && stderr().is_terminal()
}

/// Whether errors are shown with excerpts and colours: on a terminal, unless `NO_COLOR` is set.
pub fn graphical() -> bool {
    stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// Rows of name and value, the values aligned.
pub fn table(rows: &[(String, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("{name:width$}  {}\n", foreign::line(value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_others_keep_to_their_row_and_json_stays_the_same() {
        let title = "a\u{1b}]0;owned\u{7}\u{9b}2J\nclosure  0".to_string();
        assert_eq!(table(&[("title".into(), title.clone())]).lines().count(), 1);
        let json = serde_json::to_string_pretty(&[&title]).unwrap_or_default();
        let shown = escaped(&json);
        assert!(!shown.contains('\u{9b}') && shown.contains("\\u009b"), "{shown}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&shown).ok(), Some(vec![title]));
    }
}
