//! No fold in the workspace drops what is not a number: `f64::max` and `f64::min` do, `fisura::extremes` does not.
//!
//! `f64::max(a, b)` as a call, where one side is a constant, is another matter and stays allowed.

use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Lines on which a fold may lose what is not a number: `f64::max` handed on as a function, or a method of that name on floats
/// inside a fold.
fn findings(source: TokenStream) -> Vec<usize> {
    let tokens: Vec<TokenTree> = source.into_iter().collect();
    let mut lines = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        let after = |n: usize| tokens.get(i + n);
        let is_path = [1, 2].into_iter().all(|n| after(n).is_some_and(|token| token.to_string() == ":"));
        let is_handed_on = is_path && arguments(after(4)).is_none();
        if is_handed_on && is_any(Some(token), &["f64", "f32"]) && is_any(after(3), &["max", "min"]) {
            lines.push(token.span().start().line);
        }
        let is_method = i > 0 && tokens[i - 1].to_string() == ".";
        if is_method && is_any(Some(token), &["fold", "try_fold", "reduce", "scan"]) {
            let folded = arguments(after(1)).map(flat).unwrap_or_default();
            let of_floats = folded.iter().any(|t| is_any(Some(t), &["f64", "f32"]) || is_float(t));
            let by_method = folded.windows(2).any(|w| w[0].to_string() == "." && is_any(w.get(1), &["max", "min"]));
            if of_floats && by_method {
                lines.push(token.span().start().line);
            }
        }
        if let TokenTree::Group(group) = token {
            lines.extend(findings(group.stream()));
        }
    }
    lines
}

fn is_any(token: Option<&TokenTree>, words: &[&str]) -> bool {
    matches!(token, Some(TokenTree::Ident(ident)) if words.iter().any(|word| ident == word))
}

fn is_float(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Literal(literal) if literal.to_string().trim_end_matches("_f64").contains('.')
        && literal.to_string().starts_with(|c: char| c.is_ascii_digit()))
}

fn arguments(token: Option<&TokenTree>) -> Option<TokenStream> {
    match token {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis => Some(group.stream()),
        _ => None,
    }
}

/// All tokens, those within groups too.
fn flat(stream: TokenStream) -> Vec<TokenTree> {
    let within = |token: TokenTree| match token {
        TokenTree::Group(group) => flat(group.stream()),
        other => vec![other],
    };
    stream.into_iter().flat_map(within).collect()
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            sources(&entry, found);
        } else if entry.extension().is_some_and(|ending| ending == "rs") {
            found.push(entry);
        }
    }
}

#[test]
fn folds_keep_what_is_not_a_number() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    let rooms = ["solver", "verification", "reports", "xtask"].map(|room| root.join(room));
    let folders = rooms.iter().flat_map(|room| ["src", "tests", "benches"].map(|folder| room.join(folder)));
    folders.filter(|folder| folder.is_dir()).for_each(|folder| sources(&folder, &mut files));
    assert!(files.len() > 200, "{} files", files.len());
    let mut found = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let tokens = text.parse().unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        found.extend(findings(tokens).into_iter().map(|line| format!("{}:{line}", file.display())));
    }
    assert!(found.is_empty(), "use larger, smaller, largest or smallest of fisura::extremes in\n{}", found.join("\n"));
}

#[test]
fn such_folds_are_found() {
    let lines = |text: &str| findings(text.parse().unwrap());
    for text in [
        "let x = values.fold(0.0, f64::max);",
        "fault!(\"name\", values.reduce(f64::min) => 0.0)",
        "let x = values\n.map(f)\n.fold(1.0_f64, |a, x| a.max(x.abs()));",
        "values.fold((f64::INFINITY, 0), |(l, h), x| (l.min(x), h))",
        "values.fold(None, |m: Option<f64>, v| Some(m.unwrap_or(start).max(*v)))",
    ] {
        assert_eq!(lines(text).len(), 1, "{text}");
    }
    for text in [
        "let x = f64::max(a, 0.0);",
        "counts.fold(0, |a, n| a.max(n));",
        "values.fold(0.0, larger) // not fold(0.0, f64::max)",
        "let limit = spans[0..2].len().max(1);",
        "fn bounds(min: Option<f64>, max: Option<f64>) {}",
    ] {
        assert_eq!(lines(text), [], "{text}");
    }
}
