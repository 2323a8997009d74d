//! Files that may come from anywhere: which names are followed, what is opened, how much is read, and which
//! characters reach a terminal or a page.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

use serde_json::Value;

/// Longest series file that is read, bytes.
pub const SERIES_BYTES: u64 = 64 << 20;
/// Longest document (`results.json`, `part.json`) that is read, bytes.
pub const DOCUMENT_BYTES: u64 = 256 << 20;
/// Longest text of a result, characters.
pub const TEXT_LENGTH: usize = 4000;
/// Longest name, bytes.
const NAME_LENGTH: usize = 1000;
/// Deepest folder below `series/`.
const DEPTH: usize = 8;
/// Most files and folders below `series/`.
const MOST_ENTRIES: usize = 100_000;

/// Whether a name is a path that stays below its folder on every system: names joined by single slashes,
/// without drives, schemes, parents or characters that cannot be seen.
pub fn is_plain(name: &str) -> bool {
    let plain = |part: &str| !matches!(part, "" | "." | "..");
    name.len() <= NAME_LENGTH && name.split('/').all(plain) && !name.contains(['\\', ':']) && !name.contains(steers)
}

/// Reads a regular file below `folder`, of at most `most` bytes. Symbolic links below the folder are not
/// followed.
///
/// # Errors
/// A name that is not plain, a link, a device, a pipe or a folder in its place, more bytes, or what the
/// system says.
pub fn read(folder: &Path, name: &str, most: u64) -> Result<Vec<u8>, Error> {
    let refused = |why: &str| Err(Error::new(ErrorKind::InvalidInput, why.to_string()));
    if !is_plain(name) {
        return refused("the path of a file must consist of plain names joined by single slashes");
    }
    let mut path = folder.to_path_buf();
    let mut kind = fs::metadata(folder)?.file_type();
    for part in name.split('/') {
        path.push(part);
        kind = fs::symlink_metadata(&path)?.file_type();
        if kind.is_symlink() {
            return refused("its path contains a symbolic link; symbolic links are not followed");
        }
    }
    // known before it is opened: opening a pipe waits for its writer
    if !kind.is_file() {
        return refused("it is not a regular file");
    }
    let mut bytes = Vec::new();
    File::open(&path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return refused(&format!("it is longer than {} MiB", most >> 20));
    }
    Ok(bytes)
}

/// Names, relative to `folder`, of all CSV files in its `series/`, sorted.
///
/// # Errors
/// A link or a file that is none in their place, a name that is not plain, too many of them, or a folder that
/// cannot be read.
pub fn series_files(folder: &Path) -> Result<Vec<String>, Error> {
    let refused = |name: &str, why: &str| Err(Error::new(ErrorKind::InvalidInput, format!("{}: {why}", line(name))));
    let (mut names, mut seen) = (Vec::new(), 0);
    let mut folders = match fs::symlink_metadata(folder.join("series")) {
        Ok(metadata) if metadata.is_dir() => vec!["series".to_string()],
        Ok(_) => return refused("series", "it is a symbolic link or not a folder"),
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(error),
    };
    while let Some(below) = folders.pop() {
        for entry in fs::read_dir(folder.join(&below))? {
            let entry = entry?;
            let name = format!("{below}/{}", entry.file_name().to_string_lossy());
            let kind = entry.file_type()?;
            seen += 1;
            if seen > MOST_ENTRIES {
                return refused("series", &format!("it contains more than {MOST_ENTRIES} files"));
            }
            if kind.is_dir() && below.matches('/').count() < DEPTH {
                folders.push(name);
            } else if kind.is_file() && (!name.ends_with(".csv") || is_plain(&name)) {
                names.extend(name.ends_with(".csv").then_some(name));
            } else {
                return refused(&name, "only folders and regular files with plain names are accepted");
            }
        }
    }
    names.sort();
    Ok(names)
}

/// Whether a character steers a terminal, hides, or turns the direction of what follows.
pub fn steers(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}')
}

/// A text of several lines for a terminal: characters that steer it are replaced, but for ends of lines and
/// tabs.
pub fn text(text: &str) -> Cow<'_, str> {
    let bad = |c: char| steers(c) && !matches!(c, '\n' | '\t');
    if text.contains(bad) { text.replace("\r\n", "\n").replace(bad, "\u{fffd}").into() } else { text.into() }
}

/// A text for one line: ends of lines and tabs become spaces, other characters that steer a terminal are
/// replaced.
pub fn line(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return text.into();
    }
    let one = |c: char| match c {
        '\n' | '\t' | '\r' => ' ',
        c if steers(c) => char::REPLACEMENT_CHARACTER,
        c => c,
    };
    text.chars().map(one).collect::<String>().into()
}

/// Every text of a document as one line of bounded length.
pub fn clean(value: &mut Value) {
    match value {
        Value::String(text) => *text = bounded(text),
        Value::Array(values) => values.iter_mut().for_each(clean),
        Value::Object(map) => {
            let taken = std::mem::take(map);
            map.extend(taken.into_iter().map(|(key, mut value)| {
                clean(&mut value);
                (bounded(&key), value)
            }));
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

fn bounded(text: &str) -> String {
    let line = line(text);
    match line.char_indices().nth(TEXT_LENGTH) {
        Some((end, _)) => format!("{} …", &line[..end]),
        None => line.into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_leave_their_folder_are_not_plain() {
        for name in ["a.csv", "series/a b=2,c.csv", "series/timing/µ.csv", "..a"] {
            assert!(is_plain(name), "{name}");
        }
        let bad =
            ["", "/etc/passwd", "../a", "a/../b", "a//b", "./a", "C:/a", "a\\b", "javascript:alert(1)", "a\u{1b}b"];
        for name in bad.iter().copied().chain([&"a".repeat(2000)[..]]) {
            assert!(!is_plain(name), "{name:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn only_regular_files_below_the_folder_are_read() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let (root, words) = (folder.path().join("results"), |error: Error| error.to_string());
        fs::create_dir_all(root.join("series")).unwrap();
        fs::write(root.join("series/a.csv"), "x\n1\n").unwrap();
        fs::write(folder.path().join("secret.csv"), "x\n2\n").unwrap();
        symlink(folder.path().join("secret.csv"), root.join("series/link.csv")).unwrap();
        symlink(folder.path(), root.join("out")).unwrap();
        symlink("/dev/zero", root.join("series/zero.csv")).unwrap();
        assert_eq!(read(&root, "series/a.csv", 4).unwrap(), b"x\n1\n");
        assert!(words(read(&root, "series/a.csv", 3).unwrap_err()).contains("longer"));
        for name in ["series/link.csv", "series/zero.csv", "out/secret.csv"] {
            assert!(words(read(&root, name, 1 << 20).unwrap_err()).contains("symbolic link"), "{name}");
        }
        assert!(words(read(&root, "series", 9).unwrap_err()).contains("not a regular file"));
        assert!(words(read(&root, "../secret.csv", 9).unwrap_err()).contains("plain names"));
        assert!(words(read(Path::new("/dev"), "null", 9).unwrap_err()).contains("not a regular file"));
        assert!(words(series_files(&root).unwrap_err()).contains("regular files"));
        fs::remove_file(root.join("series/link.csv")).unwrap();
        fs::remove_file(root.join("series/zero.csv")).unwrap();
        assert_eq!(series_files(&root).unwrap(), ["series/a.csv"]);
        assert_eq!(series_files(folder.path()).unwrap(), [""; 0]);
        symlink(root.join("series"), folder.path().join("series")).unwrap();
        assert!(words(series_files(folder.path()).unwrap_err()).contains("series: it is a symbolic link"));
    }

    #[test]
    fn characters_that_steer_a_terminal_are_replaced() {
        assert_eq!(text("a\r\nb\tc\u{1b}]0;title\u{7}"), "a\nb\tc\u{fffd}]0;title\u{fffd}");
        assert_eq!(line("a\nb\u{9b}2J\u{202e}"), "a b\u{fffd}2J\u{fffd}");
        assert!(matches!(text("µ² → 0\n"), Cow::Borrowed(_)));
        let mut value = serde_json::json!({"a\u{1b}": ["x\ny", "z".repeat(TEXT_LENGTH + 7)], "n": 1.5});
        clean(&mut value);
        assert_eq!(value["a\u{fffd}"][0], "x y");
        assert_eq!(value["a\u{fffd}"][1].as_str().unwrap().chars().count(), TEXT_LENGTH + 2);
        assert_eq!(value["n"], 1.5);
    }
}
