//! No fold in the workspace drops what is not a number: `f64::max` and `f64::min` do,
//! `fisura::linear_algebra::extremes` does not. Nor does a loop that keeps an extreme in a variable.
//!
//! `f64::max(a, b)` as a call, where one side is a constant, is another matter and stays allowed.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};

/// Lines on which a fold may lose what is not a number: `f64::max` handed on as a function, or a method of
/// that name on floats inside a fold.
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

/// Lines on which an extreme of floats is kept in a variable by a method that may lose what is not a number.
fn kept(source: TokenStream) -> Vec<usize> {
    let mut floats = HashSet::new();
    let statements = statements(source);
    for Statement { left, right, .. } in &statements {
        if right.iter().cloned().flat_map(tokens).any(|t| is_any(Some(&t), &["f64", "f32"]) || is_float(&t)) {
            floats.extend(names(left));
        }
    }
    let loses = |statement: &&Statement| {
        let names: HashSet<String> = names(&statement.left).filter(|name| floats.contains(name)).collect();
        statement.assigns && takes_extreme(&statement.right, &names)
    };
    statements.iter().filter(loses).map(|statement| statement.line).collect()
}

/// `left = right`, a binding, or `left: right`, the type of a field or an argument.
struct Statement {
    left: Vec<TokenTree>,
    right: Vec<TokenTree>,
    line: usize,
    /// Neither a binding nor a type.
    assigns: bool,
}

fn statements(source: TokenStream) -> Vec<Statement> {
    let all: Vec<TokenTree> = source.into_iter().collect();
    let is = |token: &TokenTree, signs: &[char]| matches!(token, TokenTree::Punct(p) if signs.contains(&p.as_char()));
    let is_block = |token: &TokenTree| matches!(token, TokenTree::Group(g) if g.delimiter() == Delimiter::Brace);
    let ends = |token: &TokenTree| is(token, &[';', ',', '|']);
    let mut found = Vec::new();
    for (i, token) in all.iter().enumerate() {
        if let TokenTree::Group(group) = token {
            found.extend(statements(group.stream()));
        }
        let alone = matches!(token, TokenTree::Punct(p) if p.spacing() == Spacing::Alone);
        let beside = i > 0 && matches!(&all[i - 1], TokenTree::Punct(p) if p.spacing() == Spacing::Joint);
        if alone && !beside && is(token, &['=', ':']) {
            let first = all[..i].iter().rposition(|t| ends(t) || is_block(t)).map_or(0, |at| at + 1);
            let last = all[i..].iter().position(ends).map_or(all.len(), |at| i + at);
            let left = all[first..i].to_vec();
            let assigns = is(token, &['=']) && !left.iter().any(|token| is_any(Some(token), &["let", "const"]));
            found.push(Statement { left, right: all[i + 1..last].to_vec(), line: token.span().start().line, assigns });
        }
    }
    found
}

fn tokens(token: TokenTree) -> Vec<TokenTree> {
    flat(TokenStream::from(token))
}

/// The names in some tokens, but for that of the present object.
fn names(left: &[TokenTree]) -> impl Iterator<Item = String> {
    let idents = left.iter().cloned().flat_map(tokens).filter(|token| matches!(token, TokenTree::Ident(_)));
    idents.map(|ident| ident.to_string()).filter(|name| name != "self" && name != "mut")
}

/// Whether `name.max(…)` or `name[…].min(…)` stands somewhere, with one of the names.
fn takes_extreme(right: &[TokenTree], names: &HashSet<String>) -> bool {
    let is_index = |token: &TokenTree| matches!(token, TokenTree::Group(g) if g.delimiter() == Delimiter::Bracket);
    right.iter().enumerate().any(|(i, token)| match token {
        TokenTree::Group(group) => takes_extreme(&group.stream().into_iter().collect::<Vec<_>>(), names),
        TokenTree::Ident(ident) if names.contains(&ident.to_string()) => {
            let after = if right.get(i + 1).is_some_and(is_index) { i + 2 } else { i + 1 };
            right.get(after).is_some_and(|token| token.to_string() == ".")
                && is_any(right.get(after + 1), &["max", "min"])
        }
        _ => false,
    })
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

pub fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
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
        let tokens: TokenStream = text.parse().unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let lines = findings(tokens).into_iter().chain(kept(text.parse().unwrap()));
        found.extend(lines.map(|line| format!("{}:{line}", file.display())));
    }
    assert!(
        found.is_empty(),
        "use larger, smaller, largest or smallest of fisura::linear_algebra::extremes in\n{}",
        found.join("\n")
    );
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

#[test]
fn such_variables_are_found() {
    let lines = |text: &str| kept(text.parse().unwrap());
    for text in [
        "let mut worst = 0.0; for x in all { worst = worst.max(x); }",
        "let (mut a, mut b) = (0.0_f64, 1); loop { (a, b) = (a.max(x), b.max(y)); }",
        "struct S { largest: f64 } impl S { fn f(&mut self, x: f64) { self.largest = self.largest.max(x) } }",
        "let mut a = [0.0; 4]; if c { a = [0, 1].map(|i| a[i].max(b[i])); }",
        "fn cut(mut low: [f64; 2]) { for d in 0..2 { low[d] = low[d].min(max[d]); } }",
    ] {
        assert_eq!(lines(text).len(), 1, "{text}");
    }
    for text in [
        "let mut most = 0; for n in all { most = most.max(n); }",
        "let x: f64 = 1.0; let x = x.max(0.0);",
        "let mut worst = 0.0; worst = larger(worst, x); let most = a.max(b);",
    ] {
        assert_eq!(lines(text), [], "{text}");
    }
}
