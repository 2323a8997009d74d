//! Speed against error: the benchmarks of `cargo xtask bench`.
//!
//! A benchmark is data: a [`BenchRecord`] with what was run, the error of its answer, and samples of time. An
//! answer is verified before its time is believed: a record says how, and whether it held. Each family is one
//! file; what it measures is timed in round robin ([`timing`]), so that a disturbance meets all of its
//! contestants. Nothing here draws or judges: ratios, fronts and readings are made from the records in
//! `fisura-reports`.
//!
//! | family | question |
//! |---|---|
//! | `work-precision` | what an error costs: degrees, mass, layouts and frames, one problem ([`wave`]) |
//! | `scoreboard` | what an error of other benchmarks costs, for fisura and for elements ([`scoreboard`]) |
//! | `plate` | what an error of the plate costs, for fisura and for finite elements ([`plate`]) |
//! | `stages` | where the time of a step goes, beside a plain kernel ([`stages`], [`minimal`]) |
//! | `solves` | the phase-field solver against plain ones ([`solves`]) |
//! | `threads` | what another thread brings ([`threads`]) |
//! | `ceilings` | bandwidth and arithmetic of this machine, and the distance to them ([`ceilings`]) |
//! | `scenes` | what the physics that a scene declares costs ([`scenes`]) |
//! | `contact` | what an error of a collision costs ([`contact`]) |
//! | `motion` | what an error costs where points cross spans ([`motion`]) |
//! | `scale` | time and memory per point from 10⁴ to 1.6·10⁷ points ([`scale`]) |
//! | `baseline` | another checkout of this workspace on the same scenes ([`baseline`]) |
//! | `peer` | a program of the user on the same block of points ([`peer`]) |

pub mod baseline;
pub mod block;
pub mod ceilings;
pub mod contact;
pub mod elements;
pub mod minimal;
pub mod motion;
pub mod moving_block;
pub mod peer;
pub mod plate;
pub mod plate_error;
mod plate_scene;
mod plate_share;
pub mod record;
pub mod scale;
pub mod scenes;
pub mod scoreboard;
pub mod solves;
pub mod stages;
pub mod threads;
pub mod timing;
pub mod wave;

use std::path::PathBuf;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

use fisura::Simulation;
use fisura::simulation::breakdown::Breakdown;
use thiserror::Error;

use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::output::{OutputError, OutputFolder};
use crate::record::Environment;
use crate::reference::{Library, ReferenceError, ReferenceValue};
use crate::scene::SceneFileError;
use crate::study::StudyError;
use baseline::Baseline;
use record::{BenchRecord, BenchSet, NamedPeer, SCHEMA};

/// What is to be measured, and where the files are.
#[derive(Debug, Clone)]
pub struct Settings<'a> {
    /// Few meshes and repetitions.
    pub quick: bool,
    /// Largest number of threads that a benchmark may use.
    pub threads: usize,
    /// Folder with `verification/cases` and `reference-data`.
    pub workspace: PathBuf,
    /// Folder for what a peer reads.
    pub out: &'a OutputFolder,
    /// Another checkout, if there is one; it is then run whatever families are asked for.
    pub baseline: Option<Baseline>,
    /// Command of a peer, if there is one; it is then run whatever families are asked for.
    pub peer: Option<String>,
    /// Time that one run of the peer may take.
    pub peer_timeout: Duration,
    /// Families to run; empty: all.
    pub families: Vec<String>,
    /// The program of the finite elements, or why there is none, once it was asked for.
    pub elements: OnceLock<Result<PathBuf, String>>,
}

impl Settings<'_> {
    /// Times a contestant is run.
    pub fn rounds(&self) -> usize {
        if self.quick { 3 } else { 7 }
    }

    /// Seconds after which a contestant is not run once more.
    pub fn budget(&self) -> f64 {
        if self.quick { 1.5 } else { 20.0 }
    }

    /// A case below `verification/cases`, with changes of its scene.
    ///
    /// # Errors
    /// If it is missing or wrong.
    pub fn case(&self, name: &str, set: &[String]) -> Result<Case, SceneFileError> {
        Case::load(&self.workspace.join("verification/cases").join(name).with_extension("toml"), set)
    }

    /// The first scene of such a case.
    ///
    /// # Errors
    /// As [`Self::case`], or if it has no scene.
    pub fn scene(&self, name: &str, set: &[String]) -> Result<CaseScene, BenchError> {
        let first = self.case(name, set)?.scenes()?.into_iter().next();
        first.ok_or_else(|| BenchError::input(format!("the case {name} has no scene")))
    }

    /// All reference data.
    ///
    /// # Errors
    /// As [`Library::load`].
    pub fn library(&self) -> Result<Library, BenchError> {
        Ok(Library::load(&self.workspace.join("reference-data"))?)
    }
}

/// A benchmark that could not be carried out.
#[derive(Debug, Error)]
pub enum BenchError {
    /// A study or a run failed: it broke down, was stopped, or could not be carried out.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A case file is wrong.
    #[error(transparent)]
    Case(#[from] SceneFileError),
    /// Reference data are wrong.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// What is asked for, or a file it needs, is wrong.
    #[error("{0}")]
    Input(String),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] OutputError),
    /// The program of a peer did not do its part.
    #[error("peer {command}: {message}")]
    Peer {
        /// Command line of the peer, as one string.
        command: String,
        /// Reason in words, for example that the program cannot be started or takes too long.
        message: String,
    },
}

impl BenchError {
    /// Something missing or impossible in what was given.
    pub fn input(message: impl Into<String>) -> Self {
        Self::Input(message.into())
    }

    /// A run that went wrong in its own words.
    pub fn other(message: impl Into<String>) -> Self {
        Self::Study(StudyError::Other(message.into()))
    }
}

impl From<Breakdown> for BenchError {
    fn from(breakdown: Breakdown) -> Self {
        Self::Study(breakdown.into())
    }
}

/// Measures one family.
type Family = fn(&Settings<'_>) -> Result<Vec<BenchRecord>, BenchError>;

/// All families, in the order of the report.
pub const FAMILIES: [(&str, Family); 13] = [
    ("work-precision", wave::family),
    ("plate", plate::family),
    ("scoreboard", scoreboard::family),
    ("stages", stages::family),
    ("solves", solves::family),
    ("threads", threads::family),
    ("ceilings", ceilings::family),
    ("scenes", scenes::family),
    ("contact", contact::family),
    ("motion", motion::family),
    ("scale", scale::family),
    ("baseline", baseline::family),
    ("peer", peer::family),
];

/// Benchmarks under way: which families are measured, and at any moment the set that they give.
#[derive(Debug)]
pub struct Session<'a> {
    settings: &'a Settings<'a>,
    environment: Environment,
    peers: Vec<NamedPeer>,
    families: Vec<(&'static str, Family)>,
    measured: Mutex<(usize, Vec<BenchRecord>)>,
}

impl<'a> Session<'a> {
    /// Nothing is measured yet.
    ///
    /// # Errors
    /// Wrong reference data.
    pub fn new(settings: &'a Settings<'a>, environment: Environment) -> Result<Self, BenchError> {
        let library = settings.library()?;
        let wanted = |name: &str| match name {
            "baseline" => settings.baseline.is_some(),
            "peer" => settings.peer.is_some(),
            _ => settings.families.is_empty() || settings.families.iter().any(|f| f == name),
        };
        Ok(Self {
            settings,
            environment,
            peers: named_peers(&library)?,
            families: FAMILIES.into_iter().filter(|(name, _)| wanted(name)).collect(),
            measured: Mutex::default(),
        })
    }

    /// Measures every family that is asked for; `tell` hears the name of each before it begins.
    ///
    /// # Errors
    /// The first family that could not be measured; an answer that does not hold is no error but an
    /// unverified record.
    pub fn run(&self, tell: &dyn Fn(&str)) -> Result<(), BenchError> {
        for (name, family) in &self.families {
            tell(name);
            let records = family(self.settings)?;
            let mut measured = self.measured.lock().unwrap_or_else(PoisonError::into_inner);
            measured.0 += 1;
            measured.1.extend(records);
        }
        Ok(())
    }

    /// What is measured so far. As long as families are to come, a record whose answer does not hold says so.
    pub fn set(&self) -> BenchSet {
        let (finished, mut records) = self.measured.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let all = self.families.len();
        if finished < all {
            let mut record = BenchRecord::new("unfinished/run", "families", all as f64, "family");
            let answer = format!("{finished} of {all} families are measured: the run is in progress or was stopped");
            record.verify(false, answer);
            records.push(record);
        }
        let (environment, peers) = (self.environment.clone(), self.peers.clone());
        let unbuilt = self.settings.elements.get().and_then(|built| built.as_ref().err().cloned());
        let quick = self.settings.quick;
        BenchSet { schema: SCHEMA.into(), environment, quick, records, peers, fem_unbuilt: unbuilt }
    }
}

/// Takes `steps` steps.
fn advance(simulation: &mut Simulation, steps: usize) -> Result<(), Breakdown> {
    (0..steps).try_for_each(|_| simulation.step())
}

/// Folder of the reference data with ratios to other codes.
const PEERS: &str = "peers-2026";

/// The ratios of the reference data to other codes: names are `code/pN/quantity`.
fn named_peers(library: &Library) -> Result<Vec<NamedPeer>, BenchError> {
    let Some(source) = library.source(PEERS) else { return Ok(Vec::new()) };
    let of_peers = library.values().iter().filter(|value| value.id == PEERS);
    let peer = |value: &ReferenceValue| {
        let (code, degree, quantity) = parts_of_name(&value.name).ok_or_else(|| {
            BenchError::input(format!(
                "reference-data: {PEERS}: name = {:?} does not have the form code/pN/quantity",
                value.name
            ))
        })?;
        Ok(NamedPeer {
            code: code.into(),
            degree,
            quantity: quantity.into(),
            value: value.value,
            remark: value.note.clone(),
            conditions: source.resolution.clone(),
        })
    };
    of_peers.map(peer).collect()
}

fn parts_of_name(name: &str) -> Option<(&str, usize, &str)> {
    let (code, rest) = name.split_once('/')?;
    let (degree, quantity) = rest.strip_prefix('p')?.split_once('/')?;
    Some((code, degree.parse().ok()?, quantity))
}

/// The workspace this crate was built in, for tests.
#[cfg(test)]
pub(crate) fn own_workspace() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_peers_have_three_parts() {
        assert_eq!(parts_of_name("Warp 1.15/p2/step"), Some(("Warp 1.15", 2, "step")));
        for name in ["Warp/2/step", "Warp/p2", "p2/step", "Warp/pp/step"] {
            assert_eq!(parts_of_name(name), None, "{name}");
        }
    }

    #[test]
    fn named_peers_come_from_the_reference_data_with_their_conditions() {
        let library = Library::load(&own_workspace().join("reference-data")).unwrap();
        let peers = named_peers(&library).unwrap();
        let warp = peers.iter().find(|p| p.code.starts_with("Warp") && p.quantity == "over-tuned-kernel").unwrap();
        assert_eq!((warp.degree, warp.value), (2, 3.2));
        assert!(warp.conditions.contains("2026") && warp.conditions.contains("2.5 GHz"), "{}", warp.conditions);
    }
}
