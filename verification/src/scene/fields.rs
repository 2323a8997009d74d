//! A walker over the tree of a document: typed access that collects problems with their key paths.
//!
//! Every accessor returns `None` after it has noted a problem, so that a reader reads all its keys first and
//! assembles its value with `?` at the end; one pass finds everything.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use super::diagnostic::{Location, Problem};
use super::document::{Node, Value, join};
use super::suggest::hint;
use super::units::{self, Dimension};

/// A type whose values are words of a file.
pub trait Words: Copy + 'static {
    /// All words, each with the value that it stands for.
    const WORDS: &'static [(&'static str, Self)];
}

/// Problems found so far.
#[derive(Debug, Default)]
pub struct Problems {
    found: RefCell<Vec<Problem>>,
    folder: PathBuf,
}

impl Problems {
    /// None yet, in a document that names files in a folder.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_path_buf(), ..Self::default() }
    }

    /// Adds a problem to those found.
    pub fn push(&self, problem: Problem) {
        self.found.borrow_mut().push(problem);
    }

    /// All problems found, in the order in which they were noted.
    pub fn into_inner(self) -> Vec<Problem> {
        self.found.into_inner()
    }
}

/// A value with its key path.
#[derive(Debug, Clone)]
pub struct Item<'a> {
    /// The value in the tree of the document, with its place.
    pub node: &'a Node,
    /// Full key path of the value in the document, such as `body.0.shape`.
    pub path: String,
    problems: &'a Problems,
}

impl<'a> Item<'a> {
    /// The value `node` at `path`; problems with it go to `problems`.
    pub fn new(node: &'a Node, path: &str, problems: &'a Problems) -> Self {
        Self { node, path: path.to_string(), problems }
    }

    /// The folder of files that the document names.
    pub fn folder(&self) -> &Path {
        &self.problems.folder
    }

    /// Notes a problem found elsewhere.
    pub fn note(&self, problem: Problem) {
        self.problems.push(problem);
    }

    /// The value at a path below this one.
    pub fn at(&self, path: &str) -> Option<Item<'a>> {
        let keys = path.split('.').fold(self.path.clone(), |path, key| join(&path, key));
        Some(Self { node: self.node.at(path)?, path: keys, problems: self.problems })
    }

    /// Notes a problem with this value; `None`, for use in a return.
    pub fn fail<T>(&self, message: impl Into<String>, remedy: impl Into<String>) -> Option<T> {
        self.fail_at(self.node.location.clone(), &self.path, message.into(), remedy.into())
    }

    fn fail_at<T>(&self, location: Option<Location>, key: &str, message: String, remedy: String) -> Option<T> {
        self.problems.push(Problem { key: key.to_string(), location, message, remedy });
        None
    }

    /// Notes that this table lacks a key; `like` says what to write.
    pub fn missing<T>(&self, key: &str, like: &str) -> Option<T> {
        self.fail_at(self.node.location.clone(), &join(&self.path, key), "missing".into(), format!("add {like}"))
    }

    fn wrong_kind<T>(&self, expected: &str) -> Option<T> {
        self.fail(format!("expected {expected}, found {}", self.node.kind()), format!("give {expected}"))
    }

    /// A number in SI, or a string with a unit of that dimension; finite.
    pub fn quantity(&self, dimension: Dimension) -> Option<f64> {
        let value = match &self.node.value {
            Value::Float(x) => *x,
            Value::Integer(i) => *i as f64,
            Value::String(text) => match units::parse_as(text, dimension) {
                Ok(value) => value,
                Err(e) => return self.fail(e.message, e.remedy),
            },
            _ => return self.wrong_kind(&dimension.example()),
        };
        if value.is_finite() {
            return Some(value);
        }
        self.fail("not a finite number", format!("give {}", dimension.example()))
    }

    /// A quantity above zero.
    pub fn positive(&self, dimension: Dimension) -> Option<f64> {
        let value = self.quantity(dimension)?;
        if value > 0.0 {
            Some(value)
        } else {
            self.fail(format!("{value} is not positive"), "give a number above zero")
        }
    }

    /// A whole number between `min` and `max`.
    pub fn whole(&self, min: usize, max: usize) -> Option<usize> {
        let range = format!("a whole number between {min} and {max}");
        match self.node.value {
            Value::Integer(i) => match usize::try_from(i) {
                Ok(value) if (min..=max).contains(&value) => Some(value),
                _ => self.fail(format!("{i} is out of range"), format!("give {range}")),
            },
            _ => self.wrong_kind(&range),
        }
    }

    /// The value as text; notes a problem if it is no string.
    pub fn text(&self) -> Option<String> {
        self.node.as_str().map(String::from).or_else(|| self.wrong_kind("a string"))
    }

    /// A string that says something.
    pub fn words(&self) -> Option<String> {
        let text = self.text()?;
        if text.trim().is_empty() { self.fail("the text is blank", "write a text") } else { Some(text) }
    }

    /// The value as a Boolean; notes a problem if it is neither `true` nor `false`.
    pub fn flag(&self) -> Option<bool> {
        match self.node.value {
            Value::Boolean(b) => Some(b),
            _ => self.wrong_kind("true or false"),
        }
    }

    /// What the word in the file stands for; notes a problem if it is none of `words`.
    pub fn choice<T: Copy>(&self, words: &[(&str, T)]) -> Option<T> {
        let names: Vec<&str> = words.iter().map(|w| w.0).collect();
        let list = quoted(&names);
        let Some(text) = self.node.as_str() else { return self.wrong_kind(&format!("one of {list}")) };
        if let Some(found) = words.iter().find(|w| w.0 == text) {
            return Some(found.1);
        }
        self.fail(format!("unknown value {text:?}"), format!("{}known: {list}", hint(text, &names)))
    }

    /// One of the words of a type.
    pub fn word<T: Words>(&self) -> Option<T> {
        self.choice(T::WORDS)
    }

    /// The entries of an array.
    pub fn list(&self) -> Option<Vec<Item<'a>>> {
        let entries = match self.node.as_array() {
            Some(entries) => entries,
            None => return self.wrong_kind("an array, such as [0.0, 1.0]"),
        };
        let item = |(i, node)| Item { node, path: format!("{}.{i}", self.path), problems: self.problems };
        Some(entries.iter().enumerate().map(item).collect())
    }

    /// The entries of an array of tables, `[[name]]`.
    pub fn tables(&self) -> Option<Vec<Item<'a>>> {
        if self.node.as_table().is_some() {
            let name = self.path.split('.').filter(|s| s.parse::<usize>().is_err()).collect::<Vec<_>>().join(".");
            let message = "expected an array of tables, found one table";
            return self.fail(message, format!("write [[{name}]] instead of [{name}]"));
        }
        self.list()
    }

    /// Every entry of an array read by `read`.
    pub fn each<T>(&self, read: impl Fn(&Item<'a>) -> Option<T>) -> Option<Vec<T>> {
        all(&self.list()?, read)
    }

    /// Every entry of an array of tables read by `read`.
    pub fn each_table<T>(&self, read: impl Fn(&Item<'a>) -> Option<T>) -> Option<Vec<T>> {
        all(&self.tables()?, read)
    }

    /// An array of two entries, x and y.
    pub fn pair<T>(&self, read: impl Fn(&Item<'a>) -> Option<T>) -> Option<[T; 2]> {
        let items = self.list()?;
        let [x, y] = items.as_slice() else {
            let found = format!("expected two entries, x and y, found {}", items.len());
            return self.fail(found, "give an array of two");
        };
        let (x, y) = (read(x), read(y));
        Some([x?, y?])
    }

    /// Two quantities of that dimension.
    pub fn vector(&self, dimension: Dimension) -> Option<[f64; 2]> {
        self.pair(|item| item.quantity(dimension))
    }

    /// One whole number for both directions, or two.
    pub fn whole_per_direction(&self, min: usize, max: usize) -> Option<[usize; 2]> {
        if self.node.as_array().is_some() {
            return self.pair(|item| item.whole(min, max));
        }
        self.whole(min, max).map(|n| [n, n])
    }

    /// A table with no other keys than `known`; unknown ones are noted, and the rest can still be read.
    pub fn fields(&self, known: &[&str]) -> Option<Fields<'a>> {
        self.table(|fields| {
            fields.asked.borrow_mut().extend(known.iter().map(ToString::to_string));
            Some(fields.clone())
        })
    }

    /// A table read by `read`, which asks for every key that it knows, whatever is wrong with others: keys
    /// that it does not ask for are noted as unknown.
    pub fn table<T>(&self, read: impl FnOnce(&Fields<'a>) -> Option<T>) -> Option<T> {
        let Some(table) = self.node.as_table() else { return self.wrong_kind("a table") };
        let fields = Fields { item: self.clone(), asked: RefCell::default() };
        let value = read(&fields);
        let asked = fields.asked.into_inner();
        let known: Vec<&str> = asked.iter().map(String::as_str).collect();
        for (key, node) in table.iter().filter(|(key, _)| !asked.contains(key)) {
            let location = node.key_location.clone().or_else(|| node.location.clone());
            let remedy = format!("{}known keys: {}", hint(key, &known), known.join(", "));
            self.fail_at::<()>(location, &join(&self.path, key), format!("unknown key {key:?}"), remedy);
        }
        value
    }
}

/// A table of which keys are asked for.
#[derive(Debug, Clone)]
pub struct Fields<'a> {
    item: Item<'a>,
    asked: RefCell<Vec<String>>,
}

impl<'a> Fields<'a> {
    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<Item<'a>> {
        let mut asked = self.asked.borrow_mut();
        if !asked.iter().any(|known| known == key) {
            asked.push(key.to_string());
        }
        let node = self.item.node.as_table()?.get(key)?;
        Some(Item { node, path: join(&self.item.path, key), problems: self.item.problems })
    }

    /// A key that must be there; `like` says what to write.
    pub fn need<T>(&self, key: &str, like: &str, read: impl FnOnce(&Item<'a>) -> Option<T>) -> Option<T> {
        self.get(key).map_or_else(|| self.item.missing(key, like), |item| read(&item))
    }

    /// A key with a default, which stands in for what is wrong as well.
    pub fn or<T>(&self, key: &str, default: T, read: impl FnOnce(&Item<'a>) -> Option<T>) -> T {
        self.maybe(key, read).unwrap_or(default)
    }

    /// A key that may be absent; none if it is wrong, too.
    pub fn maybe<T>(&self, key: &str, read: impl FnOnce(&Item<'a>) -> Option<T>) -> Option<T> {
        self.get(key).and_then(|item| read(&item))
    }

    /// Which one of several keys is there, and its value; two of them are a problem.
    pub fn one_of<'k>(&self, keys: &[&'k str]) -> Option<Option<(&'k str, Item<'a>)>> {
        let given: Vec<_> = keys.iter().filter_map(|key| self.get(key).map(|item| (*key, item))).collect();
        let mut given = given.into_iter();
        match (given.next(), given.next()) {
            (Some((first, _)), Some((second, item))) => {
                item.fail(format!("both {first} and {second} are given"), "remove one of the two")
            }
            (first, _) => Some(first),
        }
    }
}

/// Every item read, so that all their problems are told.
fn all<'a, T>(items: &[Item<'a>], read: impl Fn(&Item<'a>) -> Option<T>) -> Option<Vec<T>> {
    let read: Vec<Option<T>> = items.iter().map(read).collect();
    read.into_iter().collect()
}

fn quoted(words: &[&str]) -> String {
    words.iter().map(|w| format!("{w:?}")).collect::<Vec<_>>().join(", ")
}
