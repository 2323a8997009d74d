//! Everything about a case that can be judged before it runs: what its study reads and yields, which records
//! it will have.
//!
//! A check that no run could ever judge is an error here, with its place and a remedy, and so is a key that
//! nobody reads.

mod scene_checks;

use std::collections::BTreeMap;

use crate::case::expand::CaseScene;
use crate::case::{Case, Check};
use crate::measure::grid_convergence;
use crate::record::{LONGEST, normal_id};
use crate::reference::{Library, ReferenceBand};
use crate::scene::suggest::hint;
use crate::scene::{Problem, SceneFileError};
use crate::study::scene::concerned;
use crate::study::{INPUTS, Measurement, STUDIES, Study, find};

/// Keys of a check that every measure reads, and no study that measures itself.
const MEASURED: [&str; 7] = ["measure", "scale", "band", "reference", "meshes", "order", "discretisation"];
/// Those that only some measures read.
const BY_SOME: [&str; 5] = ["column", "from", "to", "at", "against"];

/// A case that can run.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// All scenes of the case, one for each combination of axis values and variant.
    pub scenes: Vec<CaseScene>,
    /// Its records, in order.
    pub records: Vec<Planned>,
}

/// A record that a case will have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Planned {
    /// Number of the check.
    pub check: usize,
    /// Variant in its id, or empty.
    pub variant: String,
    /// Number of the scene whose run is measured, in a scene study.
    pub scene: Option<usize>,
}

impl Planned {
    /// Id of the record: `suite/case[/variant]/check`, in its normal form.
    pub fn id(&self, case: &Case) -> String {
        self.with(case, &case.checks[self.check].id)
    }

    /// Ids that the record had before.
    pub fn formerly(&self, case: &Case) -> Vec<String> {
        case.checks[self.check].formerly.iter().map(|id| self.with(case, id)).collect()
    }

    fn with(&self, case: &Case, check: &str) -> String {
        let middle = if self.variant.is_empty() { String::new() } else { format!("{}/", self.variant) };
        normal_id(&format!("{}/{}/{middle}{check}", case.suite, case.name))
    }
}

/// Finds everything that is wrong with a case, and plans its records.
///
/// # Errors
/// All problems, each with file, line, key and remedy.
pub fn prepare(case: &Case, library: &Library) -> Result<Prepared, SceneFileError> {
    let study = find(&case.study);
    let mut wrong = Wrong { case, problems: Vec::new() };
    if study.is_none() && case.study != "scene" {
        let known: Vec<&str> = std::iter::once("scene").chain(STUDIES.iter().map(|study| study.name)).collect();
        let remedy = format!("{}known: {}", hint(&case.study, &known), known.join(", "));
        wrong.note("study", format!("unknown study {:?}", case.study), remedy);
        return Err(wrong.error());
    }
    wrong.look_at_inputs(study);
    if !wrong.problems.is_empty() {
        return Err(wrong.error());
    }
    let scenes = case.scenes()?;
    if study.is_some() && scenes.iter().any(|of| of.scene.contact.as_ref().is_some_and(|contact| contact.fragments)) {
        let message = format!("the study {:?} supports only bodies without fragments", case.study);
        wrong.note("scene.contact.fragments", message, "remove it, or remove the study");
        return Err(wrong.error());
    }
    let mut records = Vec::new();
    match study {
        None => {
            for (index, check) in case.checks.iter().enumerate() {
                scene_checks::look(&mut wrong, index, check, &scenes, library);
                records.extend(of_runs(index, check, &scenes));
            }
            scene_checks::look_at_charts(&mut wrong, &scenes);
        }
        Some(study) => {
            let plan = study.plan(case, &scenes).map_err(|error| {
                case.error("study", &error.to_string(), "see the cases of this study in verification/cases")
            })?;
            for (index, check) in case.checks.iter().enumerate() {
                records.extend(wrong.look_at_plan(index, check, &plan));
            }
        }
    }
    wrong.look_for_twins(&records);
    wrong.look_for_copies();
    if wrong.problems.is_empty() { Ok(Prepared { scenes, records }) } else { Err(wrong.error()) }
}

/// Records of a check of a scene study.
fn of_runs(index: usize, check: &Check, scenes: &[CaseScene]) -> Vec<Planned> {
    let name = |scene: usize| if check.meshes.is_some() { String::new() } else { scenes[scene].name.clone() };
    let planned = |scene| Planned { check: index, variant: name(scene), scene: Some(scene) };
    concerned(check, scenes).into_iter().map(planned).collect()
}

/// What is wrong with a case.
struct Wrong<'a> {
    case: &'a Case,
    problems: Vec<Problem>,
}

impl Wrong<'_> {
    fn note(&mut self, key: impl Into<String>, message: impl Into<String>, remedy: impl Into<String>) {
        let key = key.into();
        let location = self.case.document.root.locate(&key);
        self.problems.push(Problem { key, location, message: message.into(), remedy: remedy.into() });
    }

    fn error(&self) -> SceneFileError {
        self.case.document.error(&self.problems)
    }

    /// Tables and keys that the study does not read, or misses.
    fn look_at_inputs(&mut self, study: Option<&Study>) {
        let reads = study.map_or(&["scene", "values", "variant", "energy_factor", "chart"][..], |study| study.reads);
        let root = &self.case.document.root;
        let name = &self.case.study;
        for key in INPUTS.into_iter().filter(|key| !reads.contains(key) && root.get(key).is_some()) {
            let message = format!("the study {name:?} does not read {key}");
            self.note(key, message, "remove it, or use a study that reads it");
        }
        if let Some(needed) = reads.first().filter(|key| root.get(key).is_none()) {
            self.note(*needed, "missing", format!("the study {name:?} needs a [{needed}] table"));
        }
        let factor = |index: &usize| self.case.variants[*index].energy_factor.is_some();
        let factors: Vec<usize> = (0..self.case.variants.len()).filter(factor).collect();
        for index in factors.into_iter().filter(|_| !reads.contains(&"energy_factor")) {
            let key = format!("variant.{index}.energy_factor");
            self.note(key, format!("the study {name:?} does not read energy_factor"), "remove it");
        }
    }

    /// Notes every key of measures that a check has and that is not among those that are read.
    fn look_at_keys(&mut self, index: usize, what: &str, reads: &[&str]) {
        let path = |key: &str| format!("check.{index}.{key}");
        for key in MEASURED.iter().chain(&BY_SOME).filter(|key| !reads.contains(key)) {
            if self.case.document.root.at(&path(key)).is_some() {
                self.note(path(key), format!("{what} does not read {key:?}"), "remove it");
            }
        }
    }

    /// A check of a study that says itself what it measures.
    fn look_at_plan(&mut self, index: usize, check: &Check, plan: &[Measurement]) -> Vec<Planned> {
        self.look_at_keys(index, &format!("the study {:?}", self.case.study), &[]);
        let key = |name: &str| format!("check.{index}.{name}");
        let found: Vec<&Measurement> = plan.iter().filter(|planned| planned.quantity == check.quantity).collect();
        if found.is_empty() {
            let known = distinct(plan.iter().map(|planned| planned.quantity.as_str()));
            let remedy = format!("{}it measures: {}", hint(&check.quantity, &known), known.join("; "));
            self.note(key("quantity"), "the study does not measure this", remedy);
            return Vec::new();
        }
        let named = |planned: &&&Measurement| check.is_about(&planned.variant);
        let meant: Vec<&&Measurement> = found.iter().filter(named).collect();
        if meant.is_empty() {
            let known = distinct(found.iter().map(|planned| planned.variant.as_str()));
            self.note(key("variant"), "no run of this case matches", format!("known variants: {}", known.join("; ")));
        }
        if check.around_reference.is_some()
            && check.expect.is_none()
            && !meant.iter().all(|planned| planned.reference.is_some())
        {
            let remedy = "give min and max, or the value with expect";
            self.note(key("below"), "below and above need a reference value", remedy);
        }
        if check.expect.is_some()
            && check.expect_source.is_empty()
            && meant.iter().any(|planned| planned.reference.is_some())
        {
            let remedy = "remove expect, or state in expect_source why the value differs";
            self.note(key("expect"), "the study has its own reference value", remedy);
        }
        let given = self.case.document.root.at(&key("unit")).is_some();
        if let Some(planned) = meant.iter().find(|planned| given && planned.unit != check.unit) {
            let message = format!("the study gives this in {:?}", planned.unit);
            self.note(key("unit"), message, format!("unit = {:?}, or remove it", planned.unit));
        }
        meant.iter().map(|planned| Planned { check: index, variant: planned.variant.clone(), scene: None }).collect()
    }

    /// Records with one id would hide each other, and a former id that is one of today leads astray.
    fn look_for_twins(&mut self, records: &[Planned]) {
        let case = self.case;
        let mut seen: BTreeMap<String, usize> = BTreeMap::new();
        for planned in records {
            let id = planned.id(case);
            if let Some(first) = seen.insert(id.clone(), planned.check) {
                let remedy = match first == planned.check {
                    true => "give each variant its own name, and each axis different values",
                    false => "give each check its own id, or remove the duplicate",
                };
                self.note(format!("check.{}.id", planned.check), format!("two records with the id {id}"), remedy);
            }
            if id.len() > LONGEST {
                let message = format!("the id {id} has {} characters; at most {LONGEST} are allowed", id.len());
                self.note(format!("check.{}.id", planned.check), message, "shorten it, or the name of the variant");
            }
        }
        for planned in records {
            if let Some(id) = planned.formerly(case).into_iter().find(|id| seen.contains_key(id)) {
                let message = format!("the former id {id} is ambiguous: it is the id of a current record");
                let key = format!("check.{}.formerly", planned.check);
                self.note(key, message, "name in formerly only ids that are no longer in use");
            }
        }
    }

    /// Checks that differ in nothing but words count one finding twice.
    fn look_for_copies(&mut self) {
        let case = self.case;
        let tables =
            (0..case.checks.len()).filter_map(|index| case.document.root.at(&format!("check.{index}"))?.as_table());
        let mut seen = BTreeMap::new();
        for (index, table) in tables.enumerate() {
            let said = table.iter().filter(|(key, _)| !["id", "formerly", "why"].contains(&key.as_str()));
            let said: Vec<String> = said.map(|(key, node)| format!("{key} = {}", node.canonical())).collect();
            if let Some(first) = seen.insert(said, index) {
                let message = format!("this check is a duplicate of check.{first}");
                self.note(format!("check.{index}"), message, "remove one of the two");
            }
        }
    }
}

fn distinct<'a>(words: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all: Vec<&str> = words.collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The band at a path `folder/name`.
pub(super) fn find_band<'a>(library: &'a Library, path: &str) -> Option<&'a ReferenceBand> {
    let (folder, name) = path.split_once('/')?;
    library.band(folder, name)
}
