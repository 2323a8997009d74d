//! The figures of Estrada (2024) among the figures of a result set: which is which, and which cases they
//! need.

use std::fmt;
use std::str::FromStr;

use fisura_verification::record::{CurveStyle, Figure, FigureBody, ResultSet};

use crate::series::names;

/// Runs at the point counts of the paper; their cases begin with this.
const PAPER_RUN: &str = "series/plate-paper-";
/// Cases whose pictures are figure 4: both degrees with 2 × 2 points per span.
const PICTURED: [&str; 2] = ["paper-p2-262144", "paper-p3-147456-192"];
const PLATE: [&str; 3] = ["plate/paper-p2-262144", "plate/paper-p3-147456-192", "plate/paper-p3-147456-128"];
const RINGS: [&str; 1] = ["rings/collision"];

/// A figure of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PaperFigure {
    /// 3a: elastic energy of the plate.
    ElasticEnergy,
    /// 3b: fracture energy of the plate.
    FractureEnergy,
    /// 4: phase field of the plate.
    PlatePictures,
    /// 5b: fracture energy of the rings.
    RingsEnergy,
    /// 6: phase field of the rings.
    RingsPictures,
}

impl PaperFigure {
    /// All figures of the paper that are reproduced, in its order.
    pub const ALL: [Self; 5] =
        [Self::ElasticEnergy, Self::FractureEnergy, Self::PlatePictures, Self::RingsEnergy, Self::RingsPictures];

    /// Number in the paper.
    pub fn number(self) -> &'static str {
        match self {
            Self::ElasticEnergy => "3a",
            Self::FractureEnergy => "3b",
            Self::PlatePictures => "4",
            Self::RingsEnergy => "5b",
            Self::RingsPictures => "6",
        }
    }

    /// Cases that give it.
    pub fn cases(self) -> &'static [&'static str] {
        match self {
            Self::ElasticEnergy | Self::FractureEnergy => &PLATE,
            Self::PlatePictures => &PLATE[..2],
            Self::RingsEnergy | Self::RingsPictures => &RINGS,
        }
    }

    /// Its parts in a result set: file name without ending, and figure. Empty if the set does not have it.
    pub fn find(self, set: &ResultSet) -> Vec<(String, Figure)> {
        let number = self.number();
        let chart = |id: &str, choose: fn(&ResultSet, &Figure) -> Option<Figure>| {
            let found = set.figures.iter().find(|f| f.id == id).and_then(|f| choose(set, f));
            found.map(|figure| (format!("figure-{number}"), figure)).into_iter().collect()
        };
        match self {
            Self::ElasticEnergy => chart("plate-elastic-energy", paper_runs),
            Self::FractureEnergy => chart("plate-fracture-increment", paper_runs),
            Self::RingsEnergy => chart("collision-fracture-energy", |_, figure| Some(figure.clone())),
            Self::PlatePictures => {
                let prefixes = PICTURED.map(|case| format!("plate-phase-{case}-"));
                pictures(set, number, &prefixes.each_ref().map(String::as_str), "plate-phase-paper-")
            }
            Self::RingsPictures => pictures(set, number, &["collision-phase-"], "collision-phase-"),
        }
    }
}

impl fmt::Display for PaperFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.number())
    }
}

impl FromStr for PaperFigure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = || Self::ALL.map(Self::number).join(", ");
        Self::ALL.into_iter().find(|f| f.number() == text).ok_or_else(|| format!("the paper's figures are {}", known()))
    }
}

/// Pictures whose ids begin with one of `prefixes`; `cut` is left out of their names.
fn pictures(set: &ResultSet, number: &str, prefixes: &[&str], cut: &str) -> Vec<(String, Figure)> {
    let wanted = set.figures.iter().filter(|f| prefixes.iter().any(|prefix| f.id.starts_with(prefix)));
    wanted.map(|f| (format!("figure-{number}-{}", f.id.trim_start_matches(cut)), f.clone())).collect()
}

/// A chart of the plate with the references and the runs at the point counts of the paper; `None` without
/// any.
fn paper_runs(set: &ResultSet, figure: &Figure) -> Option<Figure> {
    let mut figure = figure.clone();
    let FigureBody::Chart { curves, .. } = &mut figure.body else { return None };
    let reference = |style| matches!(style, CurveStyle::Reference | CurveStyle::Points);
    curves.retain(|c| reference(c.style) || c.series.starts_with(PAPER_RUN));
    let labels: Vec<String> = curves.iter().filter(|c| !reference(c.style)).map(|c| c.label.clone()).collect();
    if labels.is_empty() {
        return None;
    }
    // the caption has one part per run, which begins with its label
    let parts = figure.caption.trim_end_matches('.').split("; ");
    let kept: Vec<&str> = parts.filter(|p| labels.iter().any(|l| p.starts_with(&format!("{l}: ")))).collect();
    figure.caption = format!("{}.", kept.join("; "));
    figure.deviations.retain(|d| deviates(set, d));
    Some(figure)
}

/// Whether a run at the point counts of the paper has this deviation.
fn deviates(set: &ResultSet, deviation: &str) -> bool {
    let paper = |series: &Option<String>| series.as_ref().is_some_and(|s| s.starts_with(PAPER_RUN));
    set.records.iter().any(|r| paper(&r.series) && r.deviations.iter().any(|d| d == deviation))
}

/// Ids of the cases behind a figure.
pub fn cases_of(set: &ResultSet, figure: &Figure) -> Vec<String> {
    let series = names(figure);
    let mut cases: Vec<String> = Vec::new();
    for record in set.records.iter().filter(|r| r.suite == figure.suite) {
        let id = format!("{}/{}", record.suite, record.case);
        let stem = format!("series/{}-{}", record.suite, record.case);
        let owns = |name: &String| {
            let rest = name.strip_prefix(stem.as_str());
            record.series.as_ref() == Some(name) || rest.is_some_and(|rest| rest.starts_with(['-', '.']))
        };
        if series.iter().any(owns) && !cases.contains(&id) {
            cases.push(id);
        }
    }
    cases
}
