//! Changes of texts that are likely to hurt a reader.

use std::sync::LazyLock;

use proptest::prelude::*;

/// A change of a text; the numbers choose place and kind.
#[derive(Debug, Clone)]
pub enum Mutation {
    /// A number or string becomes an extreme one.
    Token(usize, usize),
    /// A line is taken away, doubled many times, or goes elsewhere.
    Line(usize, usize, usize),
    /// A token is wrapped in brackets, many times.
    Nest(usize, usize, usize),
    /// A piece of another file is put in.
    Splice(usize, usize, usize, usize),
    /// A byte becomes another.
    Byte(usize, u8),
    /// Bytes go away.
    Cut(usize, usize),
}

/// Any of them, those of tokens most often.
pub fn mutation() -> impl Strategy<Value = Mutation> {
    let n = || any::<usize>();
    prop_oneof![
        6 => (n(), n()).prop_map(|(a, b)| Mutation::Token(a, b)),
        2 => (n(), n(), n()).prop_map(|(a, b, c)| Mutation::Line(a, b, c)),
        1 => (n(), n(), n()).prop_map(|(a, b, c)| Mutation::Nest(a, b, c)),
        1 => (n(), n(), n(), n()).prop_map(|(a, b, c, d)| Mutation::Splice(a, b, c, d)),
        2 => (n(), any::<u8>()).prop_map(|(a, b)| Mutation::Byte(a, b)),
        1 => (n(), n()).prop_map(|(a, b)| Mutation::Cut(a, b)),
    ]
}

/// Values that hurt: counts, magnitudes, what is no number, units, words of the format.
static EXTREMES: LazyLock<Vec<&str>> = LazyLock::new(|| include_str!("extremes.txt").lines().collect());

/// Byte ranges of what stands between separators.
fn tokens(text: &[u8]) -> Vec<(usize, usize)> {
    let is_part = |b: u8| !matches!(b, b' ' | b'\n' | b'\r' | b'\t' | b',' | b'[' | b']' | b'{' | b'}' | b'=');
    let (mut found, mut start, mut quoted) = (Vec::new(), None, false);
    for (at, &byte) in text.iter().enumerate() {
        quoted ^= byte == b'"';
        match (start, quoted || is_part(byte)) {
            (None, true) => start = Some(at),
            (Some(from), false) => {
                found.push((from, at));
                start = None;
            }
            _ => {}
        }
    }
    found.extend(start.map(|from| (from, text.len())));
    found
}

fn lines(text: &[u8]) -> Vec<&[u8]> {
    text.split_inclusive(|b| *b == b'\n').collect()
}

impl Mutation {
    /// The text with this change.
    pub fn apply(&self, text: Vec<u8>, corpus: &[Vec<u8>]) -> Vec<u8> {
        if text.is_empty() {
            return text;
        }
        let replaced = |(from, to): (usize, usize), new: &[u8]| [&text[..from], new, &text[to..]].concat();
        let token = |n: usize| {
            let tokens = tokens(&text);
            (!tokens.is_empty()).then(|| tokens[n % tokens.len()])
        };
        match *self {
            Self::Token(which, what) => {
                token(which).map_or(text.clone(), |at| replaced(at, EXTREMES[what % EXTREMES.len()].as_bytes()))
            }
            Self::Nest(which, kind, times) => {
                let Some((from, to)) = token(which) else { return text };
                let times = [1, 2, 5, 100, 10_000][times % 5];
                let [open, close] =
                    [["[", "]"], ["{a=", "}"], ["(", ")"], ["a.", ""], ["{ difference = { of = ", "}}"]][kind % 5];
                let inner = String::from_utf8_lossy(&text[from..to]).into_owned();
                replaced((from, to), (open.repeat(times) + &inner + &close.repeat(times)).as_bytes())
            }
            Self::Line(which, kind, times) => {
                let mut lines = lines(&text);
                let (at, other) = (which % lines.len(), times % lines.len());
                match kind % 3 {
                    0 => drop(lines.remove(at)),
                    1 => {
                        let line = lines[at];
                        lines.splice(at..at, std::iter::repeat_n(line, [1, 3, 30, 3000][times % 4]));
                    }
                    _ => lines.swap(at, other),
                }
                lines.concat()
            }
            Self::Splice(at, which, from, to) => {
                let other = lines(&corpus[which % corpus.len()]);
                let (from, to) = (from % (other.len() + 1), to % (other.len() + 1));
                let mut lines = lines(&text);
                let at = at % (lines.len() + 1);
                lines.splice(at..at, other[from.min(to)..from.max(to)].iter().copied());
                lines.concat()
            }
            Self::Byte(at, byte) => {
                let at = at % text.len();
                replaced((at, at + 1), &[byte])
            }
            Self::Cut(from, length) => {
                let from = from % text.len();
                replaced((from, (from + length % 64).min(text.len())), b"")
            }
        }
    }
}
