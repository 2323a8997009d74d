//! Convergence studies: from errors on a sequence of meshes to observed orders, tables, figures and findings.
//!
//! A study fills a [`Convergence`]: the norms it measures, and one [`Curve`] per degree (or other variant)
//! with its [`Level`]s. From it follow
//!
//! - [`Convergence::measurements`]: per curve and norm `order of the <quantity>`, held against theory, and
//!   `<quantity> on the finest mesh`;
//! - [`Convergence::series`]: per curve a table `h_m, unknowns, <error>, <error>_pairwise_order, …`, and one
//!   below `timing/` with the measured seconds;
//! - [`Convergence::figures`]: per norm the error against h, against unknowns and, if times were measured,
//!   against cost.
//!
//! [`Convergence::add_to`] hands all three over. Nothing here runs a solver.
//!
//! **Observed order.** The slope of log e against log h, fitted by least squares to the finest [`FITTED`]
//! levels whose errors stand above the round-off floor. Levels count from the coarsest on and end with the
//! first one at or below the floor, since round-off grows again on finer meshes. Fewer than three levels give
//! no order, and so does an error that is not a number: a diverged mesh must not hide behind coarser ones.
//! For a constant ratio of meshes the slope is the mean of the last two pairwise orders
//! `log(e_coarse/e_fine)/log(h_coarse/h_fine)`.

mod charts;

use fisura::fault;

use crate::output::history::Table;
use crate::record::{Figure, Reference, ReferenceKind};
use crate::study::{Case, Findings, Measurement};

/// Levels that the observed order is fitted to: two refinements.
pub const FITTED: usize = 3;

/// What one mesh gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Span length, m; the time step, s, where that is refined.
    pub h: f64,
    /// Unknowns of the discrete problem.
    pub unknowns: usize,
    /// Measured wall time, s; zero if it was not measured.
    pub seconds: f64,
    /// Errors, one per norm of the study.
    pub errors: Vec<f64>,
}

/// A sequence of meshes of one degree or other variant.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Variant of the records, and legend: `p=2`.
    pub name: String,
    /// Levels in any order; they are sorted from the coarsest to the finest.
    pub levels: Vec<Level>,
    /// Order of theory per norm; `None` where there is none.
    pub orders: Vec<Option<f64>>,
}

/// What is measured on every mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Norm {
    /// In words: `displacement error in L2`.
    pub quantity: String,
    /// Unit: `1` for a relative error.
    pub unit: String,
    /// Errors at or below this are round-off; zero if there is no such floor.
    pub floor: f64,
}

/// What becomes finer from level to level: the mesh or the time step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Refined {
    /// The mesh in this many dimensions; unknowns grow as `h^-dimensions`.
    Mesh {
        /// Dimensions of space that are refined together.
        dimensions: usize,
    },
    /// The time step on one mesh; there is no figure against unknowns.
    #[default]
    TimeStep,
}

/// A convergence study of one problem. Every curve has one order and every level one error per norm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Convergence {
    /// Suite of the figures.
    pub suite: String,
    /// Beginning of all ids and file names: `manufactured-elastostatics`.
    pub stem: String,
    /// The problem, for titles: `Elastostatics on an annulus`.
    pub title: String,
    /// Caption of the figures.
    pub caption: String,
    /// What differs from the cited source.
    pub deviations: Vec<String>,
    /// Where the orders of theory come from.
    pub theory: String,
    /// Whether the levels differ in the mesh or in the time step.
    pub refined: Refined,
    /// Norms, in the order of [`Level::errors`].
    pub norms: Vec<Norm>,
    /// Curves, in the order of the legend.
    pub curves: Vec<Curve>,
}

/// Orders between successive meshes `(h, error)` from coarse to fine; not-a-number for the first, and where
/// an error is not positive.
pub fn pairwise_orders(levels: &[(f64, f64)]) -> Vec<f64> {
    let order = |a: (f64, f64), b: (f64, f64)| {
        let order = (a.1 / b.1).ln() / (a.0 / b.0).ln();
        if a.1 > 0.0 && b.1 > 0.0 { order } else { f64::NAN }
    };
    let pairs = levels.windows(2).map(|pair| order(pair[0], pair[1]));
    std::iter::once(f64::NAN).chain(pairs).take(levels.len()).collect()
}

/// Levels `(h, error)`, from coarse to fine, before the first whose error is not above `floor`.
pub fn above_floor(levels: &[(f64, f64)], floor: f64) -> &[(f64, f64)] {
    let end = levels.iter().position(|level| level.1 <= floor).unwrap_or(levels.len());
    &levels[..end]
}

/// The observed order of levels `(h, error)`, from coarse to fine, as defined at the top of this module.
pub fn observed_order(levels: &[(f64, f64)], floor: f64) -> Option<f64> {
    if levels.iter().any(|(h, error)| !(error.is_finite() && h.is_finite() && *h > 0.0)) {
        return None;
    }
    let usable = above_floor(levels, floor.max(0.0));
    let fitted = &usable[usable.len().checked_sub(FITTED)?..];
    let logarithms: Vec<(f64, f64)> = fitted.iter().map(|(h, error)| (h.ln(), error.ln())).collect();
    let mean = |part: fn(&(f64, f64)) -> f64| logarithms.iter().map(part).sum::<f64>() / FITTED as f64;
    let (h, e) = (mean(|l| l.0), mean(|l| l.1));
    let rise: f64 = logarithms.iter().map(|l| (l.0 - h) * (l.1 - e)).sum();
    let run: f64 = logarithms.iter().map(|l| (l.0 - h) * (l.0 - h)).sum();
    (run > 0.0).then(|| fault!("order-with-the-wrong-sign", rise / run => -rise / run))
}

impl Curve {
    /// Levels `(h, error)` in one norm, from the coarsest to the finest.
    pub fn errors(&self, norm: usize) -> Vec<(f64, f64)> {
        self.sorted().into_iter().map(|level| (level.h, level.errors[norm])).collect()
    }

    fn sorted(&self) -> Vec<&Level> {
        let mut levels: Vec<&Level> = self.levels.iter().collect();
        levels.sort_by(|a, b| b.h.total_cmp(&a.h));
        levels
    }
}

impl Convergence {
    /// Nothing yet, of a case.
    pub(super) fn of(case: &Case) -> Self {
        let (suite, stem) = (case.suite.clone(), format!("{}-{}", case.suite, case.name));
        Self { suite, stem, deviations: case.deviations.clone(), ..Self::default() }
    }

    /// Hands measurements, series and figures over to the findings of a study; measurements alone to a plan.
    pub fn add_to(&self, findings: &mut Findings) {
        findings.measurements.extend(self.measurements());
        if !findings.plan {
            findings.series.extend(self.series());
            findings.figures.extend(self.figures());
        }
    }

    /// Per curve and norm: `order of the <quantity>`, with theory as its reference, and
    /// `<quantity> on the finest mesh` (`with the smallest step` where that is refined).
    pub fn measurements(&self) -> Vec<Measurement> {
        let mut measurements = Vec::new();
        let [_, _, finest] = self.refined.words();
        for curve in &self.curves {
            for (index, norm) in self.norms.iter().enumerate() {
                let levels = curve.errors(index);
                let theory = |value| Reference::at_least(value, ReferenceKind::Theory, &self.theory);
                let words = [curve.name.as_str(), &format!("order of the {}", norm.quantity), "1"];
                let order = observed_order(&levels, norm.floor);
                measurements.push(Measurement::new(words, order, curve.orders[index].map(theory)));
                let words = [curve.name.as_str(), &format!("{} {finest}", norm.quantity), &norm.unit];
                measurements.push(Measurement::new(words, levels.last().map(|level| level.1), None));
            }
        }
        measurements
    }

    /// One table per curve, and one with measured times per curve that has them: file names without ending,
    /// the latter below `timing/`.
    pub fn series(&self) -> Vec<(String, Table)> {
        let plain = self.curves.iter().map(|curve| (self.series_stem(curve), self.table(curve)));
        let timed = self.curves.iter().filter(|c| has_times(c)).map(|c| (self.timing_stem(c), self.timing_table(c)));
        plain.chain(timed).collect()
    }

    /// Per norm: error against h with the orders of theory, against unknowns, and against measured cost (id
    /// below `timing/`). A norm in which no error is positive has none.
    pub fn figures(&self) -> Vec<Figure> {
        charts::figures(self)
    }

    fn series_stem(&self, curve: &Curve) -> String {
        format!("{}-{}", self.stem, words(&curve.name, "-"))
    }

    fn timing_stem(&self, curve: &Curve) -> String {
        format!("timing/{}", self.series_stem(curve))
    }

    /// Columns h, unknowns, and per norm the error and its pairwise order.
    fn table(&self, curve: &Curve) -> Table {
        let (mut names, mut columns) = self.sizes(curve);
        for (index, norm) in self.norms.iter().enumerate() {
            let levels = curve.errors(index);
            names.extend([norm.column(), format!("{}_pairwise_order", norm.column())]);
            columns.extend([levels.iter().map(|l| l.1).collect(), pairwise_orders(&levels)]);
        }
        Table { names, columns }
    }

    /// Columns h, unknowns, seconds, and the error per norm.
    fn timing_table(&self, curve: &Curve) -> Table {
        let (mut names, mut columns) = self.sizes(curve);
        names.push(charts::SECONDS.to_string());
        columns.push(curve.sorted().iter().map(|l| l.seconds).collect());
        for (index, norm) in self.norms.iter().enumerate() {
            names.push(norm.column());
            columns.push(curve.errors(index).iter().map(|l| l.1).collect());
        }
        Table { names, columns }
    }

    /// Columns h and unknowns.
    fn sizes(&self, curve: &Curve) -> (Vec<String>, Vec<Vec<f64>>) {
        let levels = curve.sorted();
        let [size, ..] = self.refined.words();
        let names = [size, charts::UNKNOWNS].map(String::from).to_vec();
        (names, vec![levels.iter().map(|l| l.h).collect(), levels.iter().map(|l| l.unknowns as f64).collect()])
    }
}

impl Norm {
    /// Column of the error in series: `displacement_error_in_l2`.
    pub fn column(&self) -> String {
        words(&self.quantity, "_")
    }
}

impl Refined {
    /// Column and axis of its size, and where its last error stands.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::Mesh { .. } => ["h_m", "span length h (m)", "on the finest mesh"],
            Self::TimeStep => ["dt_s", "time step (s)", "with the smallest step"],
        }
    }
}

fn has_times(curve: &Curve) -> bool {
    curve.levels.iter().any(|level| level.seconds > 0.0)
}

/// Lower-case words and numbers joined by `joint`, for names of columns and files; `p=2` gives `p2`.
fn words(text: &str, joint: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { ' ' };
    let mapped: String = text.replace(['=', '\''], "").to_lowercase().chars().map(plain).collect();
    mapped.split_whitespace().collect::<Vec<_>>().join(joint)
}

#[cfg(test)]
mod tests;
