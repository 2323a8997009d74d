//! `judge --new BENCHMARK`: a commented `submission.toml`.

use super::numbers::{elements, values};

const HEAD: &str = r##"# A result to be judged by `cargo xtask judge FOLDER`. Everything that is commented out is optional.
benchmark = "@"

[code]
name = "my-code"
# version = "1.0"
# commit  = "abcdef0"
# url     = "https://…"            # or a DOI
# run_by  = "A. Name"
# notes   = ["what else there is to know"]

[discretisation]
# method    = "bilinear finite elements"
spacing     = "0.25 mm"             # of elements or points at the crack; without it no mesh error is allowed for
# degree    = 1
# unknowns  = 100000
# steps     = 5000
# time_step = "16 ns"

[cost]                              # each may be left out, and is then said to be unknown
# cpu       = "100 s"               # processor time of all cores
# wall      = "100 s"
# cores     = 1
# processor = "…"
# memory_mb = 100
# kernel_ns = 114                   # time of a kernel of `cargo xtask bench` on that machine, ns per point and step
"##;

const PLATE: &str = r##"
[model]
plane    = "strain"                 # "stress", "unknown"
traction = "1 MPa"                  # on each loaded edge, held from t = 0; or "unknown"
crack    = "seeded"                 # by a history field; "phase-field" (prescribed), "slit" (free faces), "unknown"
split    = "spectral"               # "none", "volumetric-deviatoric", "star-convex", "rankine", "other", "unknown"
# phase_field        = "AT2"        # "AT1", "PF-CZM", "none", "other", "unknown"
# tensile_strength   = "3 MPa"      # of PF-CZM; and softening = "linear", "exponential", "cornelissen", "other"
# length_scale       = "0.25 mm"
# convention         = "l0"         # Borden; "l" if your model has Gc/2 (d²/l + l |grad d|²), where l = 2 l0
# residual_stiffness = 0.0
# part               = "half"       # if only the upper half was computed; then give factor = 2 below
# thickness          = "1 m"        # needed if energies are given in J instead of J/m
# differences        = ["what else differs from the benchmark"]
"##;

const KALTHOFF: &str = r##"
[model]
plane       = "strain"              # "stress", "unknown"
phase_field = "AT1"                 # "AT2", or "none" for the elastic test; others have no reference
# split        = "spectral"
# length_scale = "0.75 mm"          # of Borden et al.: half of b = 1.5 mm
# thickness    = "1 m"              # needed if energies are given in J instead of J/m
# differences  = ["what else differs from the benchmark"]
# Energies are of the half plate: give factor = 0.5 below if you computed the whole one.
"##;

const AT1: &str = r##"
[model]
plane       = "stress"
phase_field = "AT1"
split       = "@split"
# length_scale = "@l0 mm"           # of Borden et al.: half of b
# differences  = ["what else differs from the benchmark"]

# [uncertainty]                     # numerical uncertainty of each number below, from your own mesh study
"##;

const CURVES: &str = r##"
# [uncertainty]                     # numerical uncertainty from your own mesh study: relative rms over the run
# kinetic  = 0.02
# elastic  = 0.05
# work     = 0.02
# fracture = 0.03
# tip      = "0.8 mm"

# [files]
# separator = "comma"               # "semicolon", "tab", "space"; found out unless given
# comment   = "#"                   # characters with which comment lines start

[curves]                            # a column by its name in the header, or by its number from 1
time     = { column = "time_us", unit = "us" }
kinetic  = { file = "history.csv", column = "kinetic", unit = "J/m" }
elastic  = { file = "history.csv", column = "elastic", unit = "J/m" }
work     = { file = "history.csv", column = "external_work", unit = "J/m" }
fracture = { file = "history.csv", column = "fracture", unit = "J/m" } # form = "increment" if the first row is subtracted
tip_x    = { file = "history.csv", column = "tip_x", unit = "mm" }     # missing = -1000 for a value that stands for none
tip_y    = { file = "history.csv", column = "tip_y", unit = "mm" }
# each also takes factor = 2 and offset = 50 (in its unit, added after the factor)
"##;

/// The template for a benchmark.
pub fn template(benchmark: &str) -> String {
    let head = HEAD.replace('@', benchmark);
    match benchmark {
        "plate" => return head + PLATE + CURVES,
        "kalthoff" => return head + KALTHOFF + CURVES,
        _ => {}
    }
    let rows = values(benchmark).into_iter().map(|a| {
        let example = if a.unit == "1" { "0.0".to_string() } else { format!("\"0.0 {}\"", a.unit) };
        format!("{} = {example} # {}\n", a.name, a.what)
    });
    let model = elements(benchmark).map(|elements| {
        let l0 = (1e3 * elements.length_scale).to_string();
        AT1.replace("@split", elements.split).replace("@l0", &l0)
    });
    head + &model.unwrap_or_default() + "\n[values]\n" + &rows.collect::<String>()
}
