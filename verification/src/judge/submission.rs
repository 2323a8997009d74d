//! `submission.toml`: what somebody says about a result, and where its numbers stand.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::mapping::{Mapping, curves};
use super::model::{Model, model};
use super::numbers::Asked;
use crate::output::foreign;
use crate::reference::SUBMISSION;
use crate::scene::diagnostic::Sources;
use crate::scene::fields::{Item, Problems};
use crate::scene::units::Dimension;
use crate::scene::{Document, Problem, SceneFileError};

/// Longest `submission.toml`, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Who computed it, with what.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Code {
    /// Name of the code.
    pub name: String,
    /// Version of the code.
    pub version: Option<String>,
    /// Commit of the code.
    pub commit: Option<String>,
    /// URL or DOI.
    pub url: Option<String>,
    /// Who ran it.
    pub run_by: Option<String>,
    /// What else there is to know.
    pub notes: Vec<String>,
}

/// What it cost; each may be unknown.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Cost {
    /// Processor time, s.
    pub cpu_s: Option<f64>,
    /// Wall time, s.
    pub wall_s: Option<f64>,
    /// Number of cores used.
    pub cores: Option<usize>,
    /// Name of the processor.
    pub processor: Option<String>,
    /// Peak memory, MB.
    pub memory_mb: Option<f64>,
    /// Time of a kernel of the bench on the same machine in the same hour, ns per point and step.
    pub kernel_ns: Option<f64>,
}

/// Everything that `submission.toml` says.
#[derive(Debug, Clone)]
pub struct Submission {
    /// Name of the benchmark.
    pub benchmark: String,
    /// Code that computed the results.
    pub code: Code,
    /// Model that it computed with.
    pub model: Model,
    /// Numerical method in words; absent if the submission does not give it.
    pub method: Option<String>,
    /// Spacing at the crack, m.
    pub spacing: Option<f64>,
    /// Further figures of the discretisation, as written.
    pub discretisation: Vec<(String, String)>,
    /// Cost of the run; each part is absent if the submission does not give it.
    pub cost: Cost,
    /// Numerical uncertainty that the submission states, by quantity: relative, of the tip in m.
    pub stated: [Option<f64>; 6],
    /// `comma`, `semicolon`, `tab`, `space`, or absent to be found out.
    pub separator: Option<char>,
    /// Characters with which comment lines start.
    pub comment: String,
    /// Column of the time; its file is unused.
    pub time: Option<Mapping>,
    /// Columns by quantity, in the order of [`QUANTITIES`](super::QUANTITIES).
    pub curves: [Option<Mapping>; 6],
    /// Numbers of closed-form benchmarks, SI, with their place.
    pub values: Vec<(String, f64)>,
    /// Numerical uncertainties of the values, SI; those of curves are in [`Self::stated`].
    pub stated_values: Vec<(String, f64)>,
    document: Document,
}

impl Submission {
    /// Reads `submission.toml` of a folder.
    ///
    /// # Errors
    /// A file that cannot be read or is no TOML, and everything that is wrong with it, each with file,
    /// line, column and remedy.
    pub fn load(folder: &Path) -> Result<Self, SceneFileError> {
        let name = folder.join(SUBMISSION).display().to_string();
        let whole = |message: String, remedy: &str| {
            let problem = Problem { key: String::new(), location: None, message, remedy: remedy.into() };
            Sources::new(&name, "").error(&[problem])
        };
        let remedy = "give a folder with a submission.toml; `judge --new plate` writes one";
        let bytes = foreign::read(folder, SUBMISSION, MOST_BYTES);
        let bytes = bytes.map_err(|e| whole(format!("cannot be read: {e}"), remedy))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| whole("not UTF-8 text".into(), "save the file in the encoding UTF-8"))?;
        Self::parse(&name, text.trim_start_matches('\u{feff}'))
    }

    /// The same from a text; `name` stands for it in messages.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(name: &str, text: &str) -> Result<Self, SceneFileError> {
        if !text.lines().any(|line| !line.trim().is_empty() && !line.trim_start().starts_with('#')) {
            let (message, remedy) = ("the file declares nothing", "`cargo xtask judge --new plate` writes a template");
            let problem =
                Problem { key: String::new(), location: None, message: message.into(), remedy: remedy.into() };
            return Err(Sources::new(name, text).error(&[problem]));
        }
        let document = Document::parse(name, text)?;
        let problems = Problems::default();
        let read = read(&Item::new(&document.root, "", &problems), &document);
        let problems = problems.into_inner();
        match read {
            Some(submission) if problems.is_empty() => Ok(submission),
            _ => Err(document.error(&problems)),
        }
    }

    /// An error at a key of the file.
    pub fn error(&self, mapping: &Mapping, message: impl Into<String>, remedy: impl Into<String>) -> SceneFileError {
        self.document.error(&[Problem {
            key: mapping.key.clone(),
            location: mapping.location.clone(),
            message: message.into(),
            remedy: remedy.into(),
        }])
    }

    /// An error about a key that is missing or wrong.
    pub fn key_error(&self, key: &str, message: impl Into<String>, remedy: impl Into<String>) -> SceneFileError {
        let location = self.document.root.locate(key);
        let (message, remedy) = (message.into(), remedy.into());
        self.document.error(&[Problem { key: key.into(), location, message, remedy }])
    }
}

const TOP: [&str; 9] =
    ["benchmark", "code", "model", "discretisation", "cost", "uncertainty", "files", "curves", "values"];

fn read(root: &Item<'_>, document: &Document) -> Option<Submission> {
    let fields = root.fields(&TOP)?;
    let names: Vec<(&str, &str)> = super::BENCHMARKS.iter().map(|b| (b.name, b.name)).collect();
    let benchmark = fields.need("benchmark", "benchmark = \"plate\"", |item| item.choice(&names));
    let code = fields.need("code", "[code] with a name", code);
    let needed: &[&str] = match benchmark {
        Some("plate") => &["traction", "crack", "split"],
        Some("kalthoff") => &["phase_field"],
        Some("strip" | "ring" | "arrest") => &["phase_field", "split"],
        _ => &[],
    };
    let model = match needed {
        [] => Some(fields.or("model", Model::default(), |item| model(item, needed))),
        _ => fields.need("model", &format!("[model] with plane, {}", needed.join(", ")), |item| model(item, needed)),
    };
    let (method, spacing, discretisation) = fields.or("discretisation", Default::default(), discretisation);
    let cost = fields.or("cost", Cost::default(), cost);
    let asked = benchmark.unwrap_or_default();
    let uncertainty = fields.get("uncertainty");
    let (mut stated_curves, mut stated_values) = (Some([None; 6]), Some(Vec::new()));
    if let Some(item) = &uncertainty {
        if super::numbers::values(asked).is_empty() {
            stated_curves = stated(item);
        } else if super::numbers::elements(asked).is_some() {
            stated_values = values(item, asked, |item, dimension| item.positive(dimension));
        } else {
            let message = "this benchmark has a tolerance of its own, or decides nothing";
            stated_values = item.fail(message, "remove [uncertainty]");
        }
    }
    let (separator, comment) = fields.or("files", (None, "#".into()), files);
    let thickness = model.as_ref().and_then(|m| m.thickness);
    let (time, curves) = fields.or("curves", Default::default(), |item| curves(item, thickness));
    let values =
        fields.or("values", Vec::new(), |item| values(item, asked, |item, dimension| item.quantity(dimension)));
    Some(Submission {
        benchmark: benchmark?.to_string(),
        code: code?,
        model: model?,
        method,
        spacing,
        discretisation,
        cost,
        stated: stated_curves?,
        separator,
        comment,
        time,
        curves,
        values,
        stated_values: stated_values?,
        document: document.clone(),
    })
}

fn code(item: &Item<'_>) -> Option<Code> {
    item.table(|fields| {
        let name = fields.need("name", "name = \"my-code\"", Item::words);
        let [version, commit, url, run_by] =
            ["version", "commit", "url", "run_by"].map(|key| fields.maybe(key, Item::words));
        let notes = fields.or("notes", Vec::new(), |item| item.each(Item::words));
        Some(Code { name: name?, version, commit, url, run_by, notes })
    })
}

type Discretisation = (Option<String>, Option<f64>, Vec<(String, String)>);

fn discretisation(item: &Item<'_>) -> Option<Discretisation> {
    item.table(|fields| {
        let count = |key: &str| {
            let number = fields.maybe(key, |item| item.whole(1, usize::MAX >> 1))?;
            Some((key.to_string(), number.to_string()))
        };
        let mut rest: Vec<(String, String)> = ["degree", "unknowns", "steps"].into_iter().filter_map(count).collect();
        let step = fields.maybe("time_step", |item| item.positive(Dimension::TIME));
        rest.extend(step.map(|step| ("time step".to_string(), format!("{step:e} s"))));
        let method = fields.maybe("method", Item::words);
        Some((method, fields.maybe("spacing", |item| item.positive(Dimension::LENGTH)), rest))
    })
}

fn cost(item: &Item<'_>) -> Option<Cost> {
    item.table(|fields| {
        let time = |key: &str| fields.maybe(key, |item| item.positive(Dimension::TIME));
        let number = |key: &str| fields.maybe(key, |item| item.positive(Dimension::NONE));
        Some(Cost {
            cpu_s: time("cpu"),
            wall_s: time("wall"),
            cores: fields.maybe("cores", |item| item.whole(1, 100_000_000)),
            processor: fields.maybe("processor", Item::words),
            memory_mb: number("memory_mb"),
            kernel_ns: number("kernel_ns"),
        })
    })
}

fn stated(item: &Item<'_>) -> Option<[Option<f64>; 6]> {
    item.table(|fields| {
        let part = |key: &str| fields.maybe(key, |item| item.positive(Dimension::NONE));
        let tip = fields.maybe("tip", |item| item.positive(Dimension::LENGTH));
        Some([part("kinetic"), part("elastic"), part("work"), part("fracture"), tip, tip])
    })
}

fn files(item: &Item<'_>) -> Option<(Option<char>, String)> {
    let separators =
        [("auto", None), ("comma", Some(',')), ("semicolon", Some(';')), ("tab", Some('\t')), ("space", Some(' '))];
    item.table(|fields| {
        let separator = fields.or("separator", None, |item| item.choice(&separators));
        Some((separator, fields.or("comment", "#".to_string(), Item::words)))
    })
}

/// Numbers that the benchmark asks for, each read by `read`.
fn values(
    item: &Item<'_>,
    benchmark: &str,
    read: impl Fn(&Item<'_>, Dimension) -> Option<f64>,
) -> Option<Vec<(String, f64)>> {
    let asked = super::numbers::values(benchmark);
    item.table(|fields| {
        let given = |a: &Asked| Some((a.name.clone(), fields.maybe(&a.name, |item| read(item, a.dimension()))?));
        Some(asked.iter().filter_map(given).collect())
    })
}
