//! `demo`: the cracking plate in less than a minute, its energies as text, and what to try next.

use std::path::{Path, PathBuf};

use fisura::linear_algebra::extremes::larger;
use fisura_reports::template::filled;
use fisura_verification::output::history::Table;
use minijinja::context;

use crate::cli::{Common, Format, SceneArgs};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::run::{self, Interval};
use crate::{console, folders};

const SCENE: &str = "verification/scenes/plate.toml";

/// Letters and columns of the energies that are shown.
const ENERGIES: [(char, &str); 2] = [('e', "elastic_j"), ('f', "fracture_j")];
/// Columns and rows of the plot.
const SIZE: [usize; 2] = [72, 16];

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the plate and shows what it did.
///
/// # Errors
/// Without the workspace; otherwise as `run`.
pub fn demo(common: &Common) -> Result<Exit, Failure> {
    let scene = folders::workspace().join(SCENE);
    if !scene.is_file() {
        let failure = Failure::input(format!("the file {} does not exist", scene.display()));
        return Err(failure.help("start it with `cargo xtask` or in the root of the workspace"));
    }
    console::note(
        common,
        "running a glass plate with a crack under tension: half of the plate, 100 mm × 20 mm, for 80 µs",
    );
    let args = run::Args {
        scene: SceneArgs { scene, set: Vec::new() },
        vtk: false,
        animate: false,
        resume: false,
        checkpoint: Interval::NONE,
    };
    let mut path = PathBuf::new();
    let open = || folders::output(common, "demo").inspect(|folder| path = folder.path().to_path_buf());
    let exit = run::run_into(&args, open, common)?;
    if common.format == Format::Text {
        console::result(&shown(&path)?);
    }
    Ok(exit)
}

/// The energies over time, and the next commands.
fn shown(folder: &Path) -> Result<String, Failure> {
    let history = Table::read(&folder.join("history.csv")).map_err(|error| Failure::input(error.to_string()))?;
    let column = |name: &str| history.column(name).unwrap_or_default();
    let series = ENERGIES.map(|(letter, name)| (letter, column(name)));
    let (plot, picture) = (plot(column("time_s"), &series), folder.join("phase-80us.svg").display().to_string());
    Ok(filled("demo.txt", include_str!("texts/demo.txt"), context! { plot, picture, scene => SCENE }))
}

/// Series as letters in a frame; where two meet, the later one is seen.
fn plot(times: &[f64], series: &[(char, &[f64])]) -> String {
    let [columns, rows] = SIZE;
    let most = |values: &[f64]| values.iter().copied().filter(|value| value.is_finite()).fold(0.0, larger);
    let (end, top) = (most(times), series.iter().map(|(_, values)| most(values)).fold(0.0, larger));
    let cell =
        |value: f64, most: f64, cells: usize| ((value / most).clamp(0.0, 1.0) * (cells - 1) as f64).round() as usize;
    let mut page = vec![vec![' '; columns]; rows];
    for (letter, values) in series {
        for (time, value) in times.iter().zip(*values).filter(|(_, value)| value.is_finite()) {
            page[rows - 1 - cell(*value, top, rows)][cell(*time, end, columns)] = *letter;
        }
    }
    let label = |row: usize| if row == 0 { format!("{top:8.4}") } else { " ".repeat(8) };
    let lines =
        page.iter().enumerate().map(|(row, line)| format!("{} │{}\n", label(row), line.iter().collect::<String>()));
    format!("{}       0 └{}\n", lines.collect::<String>(), "─".repeat(columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rising_line_goes_from_corner_to_corner_and_nothing_is_drawn_of_what_is_no_number() {
        let times = [0.0, 0.5, 1.0];
        let text = plot(&times, &[('r', &[0.0, 0.5, 1.0]), ('n', &[f64::NAN; 3])]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), SIZE[1] + 1);
        assert!(lines[0].ends_with('r') && lines[0].contains("1.0000"), "{text}");
        assert!(lines[SIZE[1] - 1].contains("│r") && !text.contains('n'), "{text}");
        assert_eq!(plot(&[], &[]).lines().count(), SIZE[1] + 1);
    }
}
