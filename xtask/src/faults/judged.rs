//! `faults --judge`: the history of the plate with every planted error, handed to the judge as a plain CSV.
//!
//! The planted program runs the plate and knows nothing of the judge; the judge is that of the sound program
//! and sees a folder with `submission.toml` and `history.csv`. A run is stored below [`FOLDER`] with the key
//! it was made with and taken up by the next `faults --judge`.

mod report;

use std::path::Path;
use std::time::Duration;

use fisura_verification::judge::effect::{self, Effect};
use fisura_verification::judge::verdict::Outcome;
use fisura_verification::judge::{Judged, judge};
use fisura_verification::output::OutputFolder;
use fisura_verification::output::fingerprint::fingerprint;
use fisura_verification::reference::Library;
use fisura_verification::suite::{Case, VerifyError};
use serde::{Deserialize, Serialize};

use super::campaign::{planted_limit, sound_limit};
use super::runner::{Ending, Job, Runner};
use super::table::Fault;
use crate::cli::Common;
use crate::failure::Failure;
use crate::{console, folders, progress, verify};
pub use report::Report;

/// Below this folder of the output.
pub const FOLDER: &str = "judged/";

/// A plate that errors are planted in.
struct Plate {
    /// Folder.
    key: &'static str,
    words: &'static str,
    case: &'static str,
    set: &'static [&'static str],
    errors: Errors,
    /// Plane state, spacing, and relative uncertainties of K, S, W, F and that of the tip, mm: what the case
    /// accepts in its checks.
    plane: &'static str,
    spacing_mm: f64,
    stated: [f64; 5],
}

/// Which errors are planted in a plate.
#[derive(Clone, Copy, PartialEq)]
enum Errors {
    /// All whose sites it passes.
    Passed,
    /// Those whose sites it passes and no plate before does.
    New,
    /// Those that changed the curves of a plate before and were not rejected there.
    Accepted,
}

const COARSE: [f64; 5] = [0.075, 0.12, 0.055, 0.105, 2.5];
const PLATES: [Plate; 3] = [
    Plate {
        key: "plane-strain-h1",
        words: "plane strain, p = 2, h = l0",
        case: "plate/half-p2-h1",
        set: &[],
        errors: Errors::Passed,
        plane: "strain",
        spacing_mm: 0.25,
        stated: COARSE,
    },
    Plate {
        key: "plane-stress-h1",
        words: "plane stress, p = 2, h = l0",
        case: "plate/half-p2-h1",
        set: &["analysis.plane=\"stress\""],
        errors: Errors::New,
        plane: "stress",
        spacing_mm: 0.25,
        stated: COARSE,
    },
    Plate {
        key: "plane-strain-h2",
        words: "plane strain, p = 2, h = l0/2",
        case: "plate/half-p2-h2",
        set: &[],
        errors: Errors::Accepted,
        plane: "strain",
        spacing_mm: 0.125,
        stated: [0.025, 0.08, 0.025, 0.07, 0.8],
    },
];

/// Some errors make a run slow, and other programs may be running: more time than a case gets.
const PATIENCE: u32 = 4;

/// What became of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Run {
    key: String,
    seconds: f64,
    passed: Vec<String>,
    /// Why there is no history, if there is none.
    ended: Option<String>,
}

/// An error in a plate, and what the judge says of its curves.
#[derive(Debug, Serialize)]
pub struct Row {
    plate: &'static str,
    fault: &'static str,
    what: &'static str,
    /// Largest effect; absent if no curve changes, or there are none.
    #[serde(skip)]
    effect: Option<Effect>,
    /// Whether any of the curves differs from that of the sound run.
    changed: bool,
    visible: bool,
    /// The judge's word, `cannot be read`, or why there is nothing to judge.
    verdict: String,
    rejected: bool,
    findings: Vec<String>,
}

/// Runs and judges.
pub struct Campaign<'a> {
    /// Errors to plant.
    pub faults: &'a [&'static Fault],
    /// Where runs are kept.
    pub folder: &'a OutputFolder,
    /// Runs jobs.
    pub runner: &'a Runner,
    /// Fingerprint of the planted program.
    pub program: String,
    /// Flags.
    pub common: &'a Common,
}

impl Campaign<'_> {
    /// Runs what is not known yet and judges all that is.
    ///
    /// # Errors
    /// A program that cannot be started, a case that is wrong, a file that cannot be read or written.
    pub fn run(&self) -> Result<Report, Failure> {
        let data = folders::workspace().join("reference-data");
        let library = Library::load(&data).map_err(VerifyError::from)?;
        let mut report = Report::default();
        for plate in &PLATES {
            let case = Case::load(&verify::cases_folder()?.join(plate.case).with_extension("toml"), &owned(plate.set))?;
            let key = fingerprint([self.program.clone(), case.fingerprint()]);
            let limit = sound_limit(&case);
            let errors: Vec<&'static Fault> = match plate.errors {
                Errors::Accepted => self.faults.iter().copied().filter(|f| report.is_accepted(f.id)).collect(),
                Errors::Passed | Errors::New => self.faults.to_vec(),
            };
            if errors.is_empty() {
                continue;
            }
            self.fill(plate, &key, vec![(None, limit)])?;
            let Some(sound) = self.stored(plate, &key, None) else { continue };
            let planted_limit = PATIENCE * planted_limit(sound.seconds);
            let passes = |f: &&&Fault| sound.passed.iter().any(|p| p == f.id);
            let new = |f: &&&Fault| plate.errors != Errors::New || !report.passed.contains(f.id);
            let errors: Vec<&'static Fault> = errors.iter().filter(passes).filter(new).copied().collect();
            self.fill(plate, &key, errors.iter().map(|f| (Some(f.id), planted_limit)).collect())?;
            let of = |fault| judge(&self.path(plate, fault), &library, &data, None);
            let right = of(None)?;
            report.sound.push((plate.words, plate.case, right.verdict.outcome));
            for fault in errors {
                let Some(run) = self.stored(plate, &key, Some(fault.id)) else { continue };
                let judged = run.ended.is_none().then(|| of(Some(fault.id)));
                report.rows.push(row(plate, fault, &right, judged.transpose(), run.ended));
            }
            report.passed.extend(sound.passed);
        }
        Ok(report)
    }

    fn path(&self, plate: &Plate, fault: Option<&str>) -> std::path::PathBuf {
        self.folder.path().join(place(plate, fault, ""))
    }

    /// A run that is known and counts.
    fn stored(&self, plate: &Plate, key: &str, fault: Option<&str>) -> Option<Run> {
        let bytes = self.folder.read(&place(plate, fault, "run.json"))?;
        serde_json::from_slice(&bytes).ok().filter(|run: &Run| run.key == key)
    }

    fn fill(&self, plate: &Plate, key: &str, wanted: Vec<(Option<&'static str>, Duration)>) -> Result<(), Failure> {
        // what ended without a history may do better on a machine that is less busy
        let known = |fault| self.stored(plate, key, fault).is_some_and(|run| run.ended.is_none());
        let missing = wanted.into_iter().filter(|(fault, _)| !known(*fault));
        let case = plate.case.to_string();
        let jobs: Vec<Job> =
            missing.map(|(fault, limit)| Job { fault, cases: vec![(case.clone(), limit)], set: plate.set }).collect();
        if jobs.is_empty() || self.runner.expired() {
            return Ok(());
        }
        console::note(self.common, &format!("{}: {} runs", plate.words, jobs.len()));
        let bar = progress::bar(self.common, "{msg} {wide_bar} {pos}/{len}, {elapsed}", jobs.len() as u64);
        let tell = |fault: Option<&'static str>, _: &str, ending: Ending, out: &Path| {
            bar.set_message(fault.unwrap_or("no fault"));
            bar.inc(1);
            self.keep(plate, key, fault, ending, out)
        };
        let run = self.runner.run(jobs, &tell);
        bar.finish_and_clear();
        run
    }

    fn keep(
        &self,
        plate: &Plate,
        key: &str,
        fault: Option<&'static str>,
        ending: Ending,
        out: &Path,
    ) -> Result<(), Failure> {
        let mut run = Run { key: key.into(), seconds: 0.0, passed: Vec::new(), ended: None };
        match ending {
            Ok(report) => (run.seconds, run.passed) = (report.seconds, report.passed),
            Err(message) => run.ended = Some(message),
        }
        let series = out.join(format!("series/{}.csv", plate.case.replace('/', "-")));
        match std::fs::read(&series) {
            Ok(history) => self.folder.write(&place(plate, fault, "history.csv"), history)?,
            Err(_) => drop(run.ended.get_or_insert_with(|| "the run left no history".into())),
        }
        self.folder.write(&place(plate, fault, "submission.toml"), submission(plate, fault))?;
        Ok(self.folder.write_json(&place(plate, fault, "run.json"), &run)?)
    }
}

fn owned(set: &[&str]) -> Vec<String> {
    set.iter().map(|s| s.to_string()).collect()
}

fn place(plate: &Plate, fault: Option<&str>, file: &str) -> String {
    format!("{FOLDER}{}/{}/{file}", plate.key, fault.unwrap_or("none"))
}

/// What somebody would say of this run who knows nothing of an error in it.
fn submission(plate: &Plate, fault: Option<&str>) -> String {
    let Plate { plane, spacing_mm, stated: [k, s, w, f, tip], .. } = plate;
    let energy = |name: &str| format!("{{ file = \"history.csv\", column = \"{name}\", unit = \"J/m\", factor = 2 }}");
    let tip_of = |name: &str| format!("{{ file = \"history.csv\", column = \"{name}\", unit = \"m\" }}");
    format!(
        "benchmark = \"plate\"\n\n[code]\nname = \"fisura, planted error: {}\"\n\n[model]\nplane = \"{plane}\"\n\
         traction = \"1 MPa\"\ncrack = \"seeded\"\nsplit = \"spectral\"\nlength_scale = \"0.25 mm\"\npart = \"half\"\n\n\
         [discretisation]\nspacing = \"{spacing_mm} mm\"\ndegree = 2\n\n[uncertainty]\nkinetic = {k}\nelastic = {s}\n\
         work = {w}\nfracture = {f}\ntip = \"{tip} mm\"\n\n[curves]\ntime = {{ column = \"time_s\", unit = \"s\" }}\n\
         kinetic = {}\nelastic = {}\nwork = {}\nfracture = {}\ntip_x = {}\ntip_y = {}\n",
        fault.unwrap_or("none"),
        energy("kinetic_j"),
        energy("elastic_j"),
        energy("external_work_j"),
        energy("fracture_j"),
        tip_of("crack_tip_x_m"),
        tip_of("crack_tip_y_m")
    )
}

fn row<E: ToString>(
    plate: &Plate,
    fault: &Fault,
    sound: &Judged,
    judged: Result<Option<Judged>, E>,
    ended: Option<String>,
) -> Row {
    let mut row = Row::new(plate, fault);
    match judged {
        Ok(None) => row.verdict = format!("no result: {}", ended.unwrap_or_default()),
        Err(_) => (row.changed, row.verdict, row.rejected) = (true, "breaks down, no curves".into(), true),
        Ok(Some(judged)) => {
            row.changed = judged.curves != sound.curves;
            row.effect = effect::largest(sound, &judged).filter(|_| row.changed);
            row.visible = row.effect.as_ref().is_some_and(Effect::is_visible);
            row.verdict = judged.verdict.outcome.word().into();
            row.rejected = judged.verdict.outcome == Outcome::Fail;
            row.findings = judged.verdict.findings.iter().map(|f| f.id.clone()).collect();
        }
    }
    row
}

impl Row {
    fn new(plate: &Plate, fault: &Fault) -> Self {
        Self {
            plate: plate.words,
            fault: fault.id,
            what: fault.what,
            effect: None,
            changed: false,
            visible: false,
            verdict: String::new(),
            rejected: false,
            findings: Vec::new(),
        }
    }
}
