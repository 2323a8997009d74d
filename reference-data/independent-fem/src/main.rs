//! `independent-fem --h-mm 0.125 --graded --fine-mm 16 --out plate.csv`: the plate, sampled into a CSV file.

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use independent_fem::crack;
use independent_fem::kalthoff::{self, Kalthoff};
use independent_fem::mapped::{Mapped, Problem};
use independent_fem::material::{Material, Surface};
use independent_fem::mesh::{Grading, Mesh};
use independent_fem::plate::{Plate, Sample};

/// Columns at which branches are counted, mm.
const COUNTED: [u32; 8] = [60, 65, 70, 75, 80, 85, 90, 95];

/// Bilinear finite elements for the impact-loaded plate.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
struct Options {
    /// Element size at the crack, mm
    #[arg(long, value_name = "MM", default_value_t = 0.125)]
    h_mm: f64,
    /// Elements twice and four times as large away from the crack
    #[arg(long)]
    graded: bool,
    /// With --graded: columns of width h begin here, mm from the left edge
    #[arg(long, value_name = "MM", default_value_t = 46.0)]
    fine_from_mm: f64,
    /// With --graded: rows of height h end here, mm from the crack
    #[arg(long, value_name = "MM", default_value_t = 16.0)]
    fine_mm: f64,
    /// The whole plate instead of its upper half
    #[arg(long)]
    whole: bool,
    /// A notch with free faces instead of a seeded crack (half plate)
    #[arg(long, conflicts_with = "whole")]
    slit: bool,
    /// No phase field
    #[arg(long)]
    frozen: bool,
    /// AT1 instead of AT2
    #[arg(long, conflicts_with = "every")]
    at1: bool,
    /// Length scale l0 of Borden et al., mm; half of the length b of the AT1 literature
    #[arg(long, value_name = "MM", default_value_t = 0.25)]
    length_scale_mm: f64,
    /// Plane stress instead of plane strain
    #[arg(long)]
    plane_stress: bool,
    /// Traction, MPa
    #[arg(long, value_name = "MPA", default_value_t = 1.0)]
    traction_mpa: f64,
    /// Critical energy release rate Gc, J/m²; a crack on a mesh costs more than Gc, and a value divided by
    /// that factor makes up for it
    #[arg(long, value_name = "J_PER_M2", default_value_t = 3.0)]
    toughness: f64,
    /// Residual of the phase field over its right-hand side
    #[arg(long, default_value_t = 1e-6)]
    tolerance: f64,
    /// Conjugate gradients on all nodes, whatever their residual
    #[arg(long)]
    all_tiles: bool,
    /// Divide the time step by this
    #[arg(long, value_name = "N", default_value_t = 1)]
    divide: usize,
    /// Most of the critical step of an element that a step may take
    #[arg(long, value_name = "PART", default_value_t = 0.853)]
    fraction: f64,
    /// Solve for the phase field in every N-th step; in between it goes on linearly
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// End, us
    #[arg(long, value_name = "US", default_value_t = 80.0)]
    end_us: f64,
    /// Time between samples, us
    #[arg(long, value_name = "US", default_value_t = 0.25)]
    interval_us: f64,
    /// The test of Kalthoff and Winkler, with elements of --h-mm; elastic with --frozen
    #[arg(long)]
    kalthoff: bool,
    /// With --kalthoff: elements by which the node at the tip of the slit lies ahead of it
    #[arg(long, value_name = "PART", requires = "kalthoff", default_value_t = 0.0)]
    tip_ahead: f64,
    /// A problem on quadrilaterals with AT1; elastic with --frozen
    #[arg(long, conflicts_with = "kalthoff")]
    problem: Option<Problem>,
    /// With --problem: Gc divided by what a crack costs on elements of size h
    #[arg(long, requires = "problem")]
    mesh_toughness: bool,
    /// With --problem ring: seed of the random toughness
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of threads
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// CSV file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The material with what the options say of its cracks.
fn cracking(options: &Options, material: Material) -> Material {
    let surface = if options.at1 { Surface::At1 } else { Surface::At2 };
    Material { toughness: options.toughness, length_scale: options.length_scale_mm * 1e-3, surface, ..material }
}

/// The test of Kalthoff and Winkler.
fn run_kalthoff(options: &Options) -> Result<(), Box<dyn Error>> {
    let run = Kalthoff {
        h: options.h_mm * 1e-3,
        graded: options.graded,
        tip_ahead: options.tip_ahead,
        material: cracking(options, kalthoff::steel(options.plane_stress)),
        tolerance: (!options.frozen).then_some(options.tolerance),
        fraction: options.fraction,
        end: options.end_us * 1e-6,
        interval: options.interval_us * 1e-6,
        threads: options.threads,
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let mut file = csv::Writer::from_path(&options.out)?;
    let energies = ["external_work_j_per_m", "kinetic_j_per_m", "elastic_j_per_m", "fracture_j_per_m"];
    file.write_record(["time_us"].iter().chain(&energies).chain(&["reaction_n_per_m", "tip_x_mm", "tip_y_mm"]))?;
    for [time, rest @ .., tip_x, tip_y] in pool.install(|| run.run()) {
        let mut row = vec![format!("{:.4}", time * 1e6)];
        row.extend(rest.map(|value| format!("{value:.9e}")));
        row.extend([tip_x, tip_y].map(|x| if x.is_finite() { format!("{:.5}", x * 1e3) } else { "nan".to_string() }));
        file.write_record(row)?;
    }
    Ok(file.flush()?)
}

/// A problem on quadrilaterals.
fn run_mapped(options: &Options, problem: Problem) -> Result<(), Box<dyn Error>> {
    let run = Mapped {
        problem,
        h: options.h_mm * 1e-3,
        b: 2e-3 * options.length_scale_mm,
        cracks: !options.frozen,
        mesh_toughness: options.mesh_toughness,
        seed: options.seed,
        end: options.end_us * 1e-6,
        interval: options.interval_us * 1e-6,
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let mut file = csv::Writer::from_path(&options.out)?;
    let energies = ["external_work_j_per_m", "kinetic_j_per_m", "elastic_j_per_m", "fracture_j_per_m"];
    file.write_record(["time_us"].iter().chain(&energies).chain(&["tip_x_mm", "tip_y_mm"]))?;
    let mut written = Ok(());
    pool.install(|| {
        run.run(|[time, rest @ .., tip_x, tip_y]| {
            let mut row = vec![format!("{:.4}", time * 1e6)];
            row.extend(rest.map(|value| format!("{value:.9e}")));
            row.extend(
                [tip_x, tip_y].map(|x| if x.is_finite() { format!("{:.5}", x * 1e3) } else { "nan".to_string() }),
            );
            if written.is_ok() {
                written = file.write_record(row).and_then(|()| Ok(file.flush()?));
            }
        });
    });
    Ok(written?)
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    if options.kalthoff {
        return run_kalthoff(options);
    }
    if let Some(problem) = options.problem {
        return run_mapped(options, problem);
    }
    let material = cracking(options, Material::new(32e9, 0.2, options.plane_stress));
    let grading = Grading { fine_from: options.fine_from_mm * 1e-3, fine_to: options.fine_mm * 1e-3 };
    let plate = Plate {
        h: options.h_mm * 1e-3,
        grading: options.graded.then_some(grading),
        whole: options.whole,
        slit: options.slit,
        frozen: options.frozen,
        material,
        traction: options.traction_mpa * 1e6,
        tolerance: options.tolerance,
        tiles: !options.all_tiles,
        divide: options.divide,
        fraction: options.fraction,
        every: options.every as usize,
        end: options.end_us * 1e-6,
        interval: options.interval_us * 1e-6,
        threads: options.threads,
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let mut file = csv::Writer::from_path(&options.out)?;
    file.write_record(header())?;
    let mut first_fracture = None;
    let mut written = Ok(());
    let start = Instant::now();
    let totals = pool.install(|| {
        plate.run(|mesh, c, sample| {
            let initial = *first_fracture.get_or_insert(sample.energies.fracture);
            let row = row(mesh, c, &sample, initial, options.whole);
            if written.is_ok() {
                written = file.write_record(row).and_then(|()| Ok(file.flush()?));
            }
        })
    })?;
    written?;
    println!(
        "{} elements, {} steps of {:.4e} s, {:.2} iterations a step, {:.2} s of wall time",
        totals.elements,
        totals.steps,
        totals.step,
        totals.iterations as f64 / totals.steps.max(1) as f64,
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

fn header() -> Vec<String> {
    let fixed = [
        "time_us",
        "kinetic_j_per_m",
        "elastic_j_per_m",
        "fracture_j_per_m",
        "fracture_increment_j_per_m",
        "external_work_j_per_m",
        "balance_j_per_m",
        "tip_x_mm",
        "tip_y_mm",
        "axis_end_x_mm",
        "first_two_x_mm",
        "iterations",
        "least_c",
        "largest_c",
    ];
    fixed.into_iter().map(String::from).chain(COUNTED.map(|x| format!("branches_{x}_mm"))).collect()
}

fn row(mesh: &Mesh, c: &[f64], sample: &Sample, initial: f64, whole: bool) -> Vec<String> {
    let e = &sample.energies;
    let increment = e.fracture - initial;
    let energy = |value: f64| format!("{value:.9e}");
    let length = |value: Option<f64>| value.map_or_else(|| "nan".to_string(), |x| format!("{:.5}", x * 1e3));
    let mut row = vec![format!("{:.4}", sample.time * 1e6)];
    row.extend([e.kinetic, e.elastic, e.fracture, increment, e.work].map(energy));
    row.push(energy(e.work - e.kinetic - e.elastic - increment));
    let tip = sample.crack.tip;
    row.extend(
        [tip.map(|t| t[0]), tip.map(|t| 0.02 + t[1]), sample.crack.axis_end, sample.crack.first_two].map(length),
    );
    row.extend([format!("{:.2}", sample.iterations), energy(sample.range[0]), energy(sample.range[1])]);
    row.extend(COUNTED.map(|x| {
        let distance = |i: &usize| (mesh.x[*i] - f64::from(x) * 1e-3).abs();
        let column = (0..mesh.x.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        crack::branches(mesh, c, column, whole).to_string()
    }));
    row
}
