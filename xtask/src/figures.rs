//! `figures`: the figures of the paper, run or drawn from stored results.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fisura_reports::animation::render_animation;
use fisura_reports::field::Raster;
use fisura_reports::paper::{PaperFigure, cases_of};
use fisura_reports::{FigureError, SeriesSet, bundle, read_results};
use fisura_verification::output::OutputFolder;
use fisura_verification::record::{Figure, FigureBody, ResultSet};
use fisura_verification::reference::{Library, Source};
use fisura_verification::suite::{Case, read_cases};
use serde_json::json;

use crate::cli::Common;
use crate::environment::environment;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::unreadable;
use crate::verify::{carry_out, cases_folder, estimate, verdict};
use crate::{console, folders};

/// Arguments of `figures`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The paper; only Estrada (2024) is available
    #[arg(long, value_name = "PAPER", default_value = "estrada2024", value_parser = ["estrada2024"])]
    paper: String,
    /// Only these figures, separated by commas: 3a, 3b, 4, 5b, 6; or ids of figures in the results of --from
    #[arg(long, value_name = "FIGURE,…", value_delimiter = ',')]
    figure: Vec<String>,
    /// Draw from this results folder instead of running anything
    #[arg(long, value_name = "DIR")]
    from: Option<PathBuf>,
    /// Also write an animation of each series of pictures in the results
    #[arg(long)]
    animate: bool,
}

/// Writes each figure as SVG with its numbers, caption and provenance. Where the cases were run for it, a
/// check that does not hold or a run that broke down decides the exit status as in `verify`.
///
/// # Errors
/// Unknown figures, results that do not hold them, files that cannot be read or written.
pub fn figures(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let wanted = Wanted::of(args)?;
    let folder = folders::output(common, "figures")?;
    let Some(from) = &args.from else {
        let source = folder.path().join("results");
        no_link(&source)?;
        folder.begin(|_| false)?; // the list of what belongs here comes before results/
        let (results, rendered) = run(&wanted.paper, &source, common)?;
        let exit = verdict(&results.records);
        if exit != Exit::Done {
            console::note(common, &format!("warning: some checks do not hold: see {}", source.display()));
        }
        let drawn = draw(args, &wanted, (&source, &results), &folder, common);
        return Failure::beside(exit, rendered.and(drawn));
    };
    let results = read_results(from).map_err(|error| unreadable(error, from))?;
    draw(args, &wanted, (from, &results), &folder, common)?;
    Ok(Exit::Done)
}

/// No link leads out of the output folder, also not to results.
fn no_link(folder: &Path) -> Result<(), Failure> {
    if fs::symlink_metadata(folder).is_ok_and(|metadata| !metadata.is_dir()) {
        let message = format!("{} is a symbolic link or not a folder; nothing is written to it", folder.display());
        return Err(Failure::input(message).help("remove it, or give another folder with --out"));
    }
    Ok(())
}

/// Writes what is wanted from results and names the files.
fn draw(
    args: &Args,
    wanted: &Wanted,
    (source, results): (&Path, &ResultSet),
    folder: &OutputFolder,
    common: &Common,
) -> Result<(), Failure> {
    let mut found = wanted.find(results, source, args.from.is_none())?;
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let library = crate::verify::library()?;
    folder.begin(|_| false)?;
    let mut files = Vec::new();
    for (name, figure) in &found {
        let inputs = inputs(results, figure);
        let written = bundle::write((source, figure), (folder, name), &results.environment, inputs)?;
        files.extend(written.into_iter().map(|file| folder.path().join(file).display().to_string()));
        let bibtex = bibtex(&library, figure);
        if !bibtex.is_empty() {
            folder.write(&format!("{name}.bib"), bibtex)?;
            files.push(folder.path().join(format!("{name}.bib")).display().to_string());
        }
    }
    if args.animate {
        for (name, svg) in animated(source, &found)? {
            folder.write(&name, svg)?;
            files.push(folder.path().join(name).display().to_string());
        }
    }
    folder.finish()?;
    console::show(common, &json!({ "paper": args.paper, "files": files }), || files.join("\n") + "\n");
    Ok(())
}

/// The entries of the sources whose curves a figure draws.
fn bibtex(library: &Library, figure: &Figure) -> String {
    let FigureBody::Chart { curves, .. } = &figure.body else { return String::new() };
    let drawn = |source: &&Source| {
        let series = format!("reference-{}-", source.id.replace('/', "-"));
        curves.iter().any(|curve| curve.series.contains(&series))
    };
    library.sources().iter().filter(drawn).filter_map(|source| source.bibtex.clone()).collect()
}

/// A moving picture of all pictures whose names differ in the time at their end alone: name and SVG.
fn animated(source: &Path, found: &[(String, Figure)]) -> Result<Vec<(String, String)>, Failure> {
    let mut series: BTreeMap<&str, Vec<(f64, &Figure)>> = BTreeMap::new();
    for (name, figure) in found.iter().filter(|(_, figure)| matches!(figure.body, FigureBody::Field { .. })) {
        if let Some((stem, time)) = name.rsplit_once('-').and_then(|(stem, word)| Some((stem, time_of(word)?))) {
            series.entry(stem).or_default().push((time, figure));
        }
    }
    let mut drawn = Vec::new();
    for (stem, mut pictures) in series.into_iter().filter(|(_, pictures)| pictures.len() > 1) {
        pictures.sort_by(|a, b| a.0.total_cmp(&b.0));
        let title = pictures[0].1.title.clone();
        let title = title.rsplit_once(" at ").map_or(title.as_str(), |(title, _)| title);
        let name = format!("{stem}-animated");
        drawn.push((format!("{name}.svg"), animate(&name, title, source, &pictures)?));
    }
    Ok(drawn)
}

/// Seconds of the end of a name, such as 45us.
fn time_of(word: &str) -> Option<f64> {
    let units = [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("s", 1.0)];
    units.iter().find_map(|(unit, factor)| Some(word.strip_suffix(unit)?.parse::<f64>().ok()? * factor))
}

fn animate(name: &str, title: &str, source: &Path, pictures: &[(f64, &Figure)]) -> Result<String, Failure> {
    let fail = |error: FigureError| Failure::input(error.to_string());
    let set = SeriesSet::load(source, pictures.iter().map(|(_, figure)| *figure));
    let (mut moments, mut bar) = (Vec::new(), (String::new(), [0.0, 1.0]));
    for (time, figure) in pictures {
        if let FigureBody::Field { series, pixels, label, range } = &figure.body {
            moments.push((*time, Raster::read(&figure.id, series, *pixels, &set).map_err(fail)?));
            bar = (label.clone(), *range);
        }
    }
    render_animation(name, title, &moments, (&bar.0, bar.1)).map_err(fail)
}

/// Figures that the user asks for: those of the paper, and others by their ids.
struct Wanted {
    paper: Vec<PaperFigure>,
    others: Vec<String>,
}

impl Wanted {
    fn of(args: &Args) -> Result<Self, Failure> {
        let (mut paper, mut others) = (Vec::new(), Vec::new());
        for word in &args.figure {
            match word.parse::<PaperFigure>() {
                Ok(figure) => paper.push(figure),
                Err(_) if args.from.is_some() => others.push(word.clone()),
                Err(known) => {
                    let help = format!("{known}; other figures are drawn from results with --from");
                    return Err(Failure::input(format!("unknown figure {word}")).help(help));
                }
            }
        }
        if args.figure.is_empty() {
            paper = PaperFigure::ALL.to_vec();
        }
        Ok(Self { paper, others })
    }

    /// Name and figure of all that is wanted.
    fn find(&self, set: &ResultSet, source: &Path, fresh: bool) -> Result<Vec<(String, Figure)>, Failure> {
        let missing = |what: String, help: String| {
            let message = format!("the results in {} contain no figure {what}", source.display());
            Failure::input(message).help(help)
        };
        let mut found = Vec::new();
        for figure in &self.paper {
            let parts = figure.find(set);
            if parts.is_empty() {
                let cases = figure.cases().join(", ");
                let help = if fresh {
                    format!("it is drawn from {cases}, which did not finish")
                } else {
                    format!("it needs {cases}; omit --from to run these cases")
                };
                return Err(missing(figure.to_string(), help));
            }
            found.extend(parts);
        }
        for id in &self.others {
            let figure = set.figures.iter().find(|f| f.id == *id);
            let known = || set.figures.iter().map(|f| f.id.as_str()).collect::<Vec<_>>().join(", ");
            let figure = figure.ok_or_else(|| missing(id.clone(), format!("the results contain {}", known())))?;
            found.push((id.replace('/', "-"), figure.clone()));
        }
        Ok(found)
    }
}

/// Runs the cases that the figures need, which may take long: that is said first. Beside the results: whether
/// their report could be written.
fn run(wanted: &[PaperFigure], out: &Path, common: &Common) -> Result<(ResultSet, Result<(), Failure>), Failure> {
    let needed = |id: &str| wanted.iter().any(|figure| figure.cases().contains(&id));
    let (cases, malformed) = read_cases(&cases_folder()?, &[]);
    if let Some(file) = malformed.into_iter().find(|file| needed(&file.id)) {
        return Err(file.error.into());
    }
    let cases: Vec<Case> = cases.into_iter().filter(|case| needed(&case.id())).collect();
    console::note(common, &estimate(&cases, "cases to run"));
    let out = Arc::new(OutputFolder::open(out, "verify")?);
    let environment = environment(&folders::workspace());
    let results = carry_out(&cases, None, (&out, environment), (true, None), common)?;
    let rendered = fisura_reports::render(out.path(), &out).map(drop).map_err(Failure::from);
    Ok((results, rendered.and(out.finish().map_err(Failure::from))))
}

/// Fingerprints of what the cases behind a figure simulated.
fn inputs(set: &ResultSet, figure: &Figure) -> BTreeMap<String, String> {
    let of = |id: String| Some((id.clone(), set.inputs.get(&id)?.clone()));
    cases_of(set, figure).into_iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use fisura_verification::record::{Axis, Curve};

    use super::*;

    #[test]
    fn a_figure_names_the_sources_of_its_curves() {
        let library = Library::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data")).unwrap();
        let curve = |series| Curve::line("", series, ["x", "y"]);
        let curves = vec![curve("series/reference-mandal-2020-at1-plate-elastic-energy.csv"), curve("ours.csv")];
        let [x, y] = ["x", "y"].map(Axis::logarithmic);
        let body = FigureBody::Chart { x, y, curves, regions: Vec::new(), slopes: Vec::new(), floors: Vec::new() };
        let entries = bibtex(&library, &Figure::new("plate", ["id", "title", "caption"], body));
        assert!(entries.starts_with("@article{mandal-2020,") && entries.matches('@').count() == 1, "{entries}");
    }
}
