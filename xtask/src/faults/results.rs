//! What catches each fault, and the files that say so.

use fisura_reports::template::filled;
use fisura_verification::output::{OutputError, OutputFolder};
use minijinja::value::Serde;
use serde::Serialize;

use super::cells::Store;
use super::matrix::Matrix;
use super::table::Fault;

/// All that was found.
#[derive(Debug, Serialize)]
pub struct Results {
    /// One entry per fault.
    pub faults: Vec<Caught>,
    /// Cases that do not hold without a fault: nothing can be learnt from them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unsound: Vec<String>,
}

/// What caught a fault.
#[derive(Debug, Serialize)]
pub struct Caught {
    #[serde(flatten)]
    fault: &'static Fault,
    /// Records that fail, or are errors, with the fault alone.
    caught_by: Vec<String>,
    /// Checks that pass, or lie within a known limit, without it.
    checks: usize,
    /// How cases ended that have no records.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ended: Vec<String>,
}

impl Caught {
    fn new(fault: &'static Fault, cases: &[String], store: &Store, all: bool) -> Self {
        let mut caught = Self { fault, caught_by: Vec::new(), checks: 0, ended: Vec::new() };
        let others = cases.iter().filter(|case| all && !fault.cases.contains(case));
        for case in fault.cases.iter().chain(others) {
            let (Some(sound), Some(cell)) = (store.get(None, case), store.get(Some(&fault.id), case)) else { continue };
            caught.checks += sound.green.len() + sound.limited.len();
            caught.caught_by.extend(cell.red);
            caught.ended.extend(cell.ended.map(|why| format!("{case}: {why}")));
        }
        caught
    }
}

impl Results {
    /// From what is known: of the cases named for each fault, or of all.
    pub fn new(faults: &[&'static Fault], cases: &[String], store: &Store, all: bool) -> Self {
        let unsound = cases.iter().filter(|case| store.get(None, case).is_some_and(|cell| !cell.holds()));
        Self {
            faults: faults.iter().map(|fault| Caught::new(fault, cases, store, all)).collect(),
            unsound: unsound.cloned().collect(),
        }
    }

    /// Faults that no check caught.
    fn survivors(&self) -> impl Iterator<Item = &Caught> {
        self.faults.iter().filter(|fault| fault.caught_by.is_empty())
    }

    /// Whether a fault survives, or a case does not hold without one.
    pub fn lacking(&self) -> bool {
        self.survivors().next().is_some() || !self.unsound.is_empty()
    }

    /// Writes `faults.json` and `faults.md`, and `matrix.json` if there is a matrix.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &OutputFolder, matrix: Option<&Matrix>) -> Result<(), OutputError> {
        folder.write_json("faults.json", self)?;
        if let Some(matrix) = matrix {
            folder.write_json("matrix.json", matrix)?;
        }
        folder.write("faults.md", self.markdown() + &matrix.map_or(String::new(), Matrix::markdown))?;
        folder.finish()
    }

    /// One line per fault.
    pub fn text(&self) -> String {
        filled("faults.txt", include_str!("../texts/faults.txt"), Serde(self))
    }

    /// The table of faults and checks.
    fn markdown(&self) -> String {
        filled("faults.md", include_str!("../texts/faults.md"), Serde(self))
    }
}
