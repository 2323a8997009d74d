//! Readers of scenes, cases and tables under mutated input: no panic, no hang, no flood of memory.
//!
//! Inputs are files of `tests/corpus` and of the project, changed by a few mutations of their tokens, lines,
//! nesting and bytes. `FISURA_FUZZ=1000000 cargo test -p fisura-verification --test fuzz` takes a million of
//! them, new ones every time; otherwise 10⁴, always the same. What fails is shrunk to the fewest mutations
//! and printed; it goes to the corpus.

mod harness;
mod mutation;

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Instant;

use fisura::Simulation;
use fisura::scene::Scene;
use fisura_verification::case::Case;
use fisura_verification::judge::judge;
use fisura_verification::judge::submission::Submission;
use fisura_verification::output::history::Table;
use fisura_verification::reference::Library;
use fisura_verification::scene::SceneFile;
use fisura_verification::suite::prepare::prepare;
use harness::{LONGEST, files, fuzz, watched};

/// A case that is taken has a record for each of its checks, no two of one id; one that is refused is told
/// why.
fn look_at_plan(case: &Case, library: &Library) {
    match prepare(case, library) {
        Ok(prepared) => {
            let ids: BTreeSet<String> = prepared.records.iter().map(|planned| planned.id(case)).collect();
            assert_eq!(ids.len(), prepared.records.len(), "two records of one id");
            let planned: BTreeSet<usize> = prepared.records.iter().map(|planned| planned.check).collect();
            assert!(planned.into_iter().eq(0..case.checks.len()), "a check without a record");
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// What validation let through starts, if it is small, and its first steps pass or break down in words.
fn begin(scene: &Scene) {
    let spans = scene.mesh.knots.each_ref().map(Vec::len).into_iter().product::<usize>();
    let points = scene.bodies.iter().map(|b| b.particles_per_cell[0] * b.particles_per_cell[1]).sum::<usize>();
    if spans * points > 20_000 {
        return;
    }
    if let Ok(mut simulation) = Simulation::new(scene) {
        for _ in 0..2 {
            if simulation.finished() || simulation.step().is_err() {
                break;
            }
        }
        simulation.inspect();
    }
}

#[test]
fn readers_survive_any_input() {
    let scenes = files(&["tests/corpus/scene", "scenes"], "toml");
    fuzz(0.5, &scenes, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        match SceneFile::parse("scene.toml", &text, &[]) {
            Ok(file) => begin(&file.scene),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
    let overrides = [b"body.0.crack.0.half_width=0.25 mm\nmesh.cells=[8, 4]\noutput.frames=[]".to_vec()];
    let scene = String::from_utf8(scenes[3].clone()).expect("UTF-8");
    fuzz(0.05, &overrides, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        let overrides: Vec<String> = text.lines().map(String::from).collect();
        let _ = SceneFile::parse("scene.toml", &scene, &overrides);
    });
    let library = Library::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data")).expect("references");
    fuzz(0.3, &files(&["tests/corpus/case", "cases"], "toml"), |bytes| {
        let text = String::from_utf8_lossy(bytes);
        if let Ok(case) = Case::parse(Path::new("suite/case.toml"), &text, &[]) {
            look_at_plan(&case, &library);
        }
    });
    fuzz(0.15, &files(&["tests/corpus/csv", "../reference-data"], "csv"), |bytes| {
        if let Ok(table) = Table::parse("table.csv", bytes) {
            assert!(table.columns.iter().all(|column| column.len() == table.rows()));
        }
    });
}

/// Submissions and their tables: a verdict, or an error in words.
#[test]
fn submissions_survive_any_input() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data");
    fuzz(0.1, &files(&["../reference-data/submissions"], "toml"), |bytes| {
        if let Err(error) = Submission::parse("submission.toml", &String::from_utf8_lossy(bytes)) {
            assert!(!error.to_string().is_empty());
        }
    });
    let (library, folder) = (Library::load(&data).expect("references"), tempfile::tempdir().expect("a folder"));
    let sound = data.join("submissions/fisura-p2-h1");
    std::fs::copy(sound.join("submission.toml"), folder.path().join("submission.toml")).expect("a copy");
    fuzz(0.03, &files(&["../reference-data/submissions/fisura-p2-h1", "tests/corpus/csv"], "csv"), |bytes| {
        std::fs::write(folder.path().join("history.csv"), bytes).expect("a table");
        match judge(folder.path(), &library, &data, None) {
            Ok(judged) => assert!(judged.verdict.comparisons().all(|c| c.u_val.is_none_or(f64::is_finite))),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
}

/// Inputs made to be slow or large: counts at their limits, times counts.
#[test]
fn readers_survive_what_is_made_to_hurt_them() {
    let scene = |mesh: &str, frame: &str, rest: &str| {
        let head = "[material.a]\nyoung_modulus = 1e9\npoisson_ratio = 0.3\ndensity = 1000\n[material.a.fracture]\n\
                    critical_energy_release_rate = 1\nlength_scale = 1e-3\n";
        format!("[mesh]\n{mesh}\n[analysis]\nend_time = 1e-6\nframe = {frame:?}\n{head}{rest}")
    };
    let body =
        |name: usize, rest: &str| format!("[[body]]\nname=\"{name}\"\nmaterial=\"a\"\nparticles_per_cell=3\n{rest}\n");
    let whole = body(0, "shape = \"patch\"");
    let many = |n: usize, f: &dyn Fn(usize) -> String| (0..n).map(f).collect::<String>();
    let uniform = |cells: &str| format!("degree = 2\norigin = [0, 0]\nsize = [1, 1]\ncells = {cells}");
    let corners = many(3000, &|i| format!("[{:.3},{}],", 0.5 + 0.4 * (i as f64 / 477.0).sin(), i % 3));
    let crack = "[[body.crack]]\nfrom=[0.2,0.2]\nto=[0.8,0.8]\n";
    let polygon = body(0, &format!("shape = {{ polygon = {{ points = [{corners}] }} }}\n{}", crack.repeat(500)));
    let curved = |degree: usize, parts: usize| {
        let knots = format!("{}{}", "0, ".repeat(degree + 1), "1, ".repeat(degree + 1));
        let points = many((degree + 1) * (degree + 1), &|i| format!("[{}, {}],", i % (degree + 1), i / (degree + 1)));
        format!("degree = {degree}\nknots = [[{knots}], [{knots}]]\ncontrol_points = [{points}]\nsubdivide = {parts}")
    };
    let discs = many(600, &|i| body(i, "shape={disk={center=[0.5,0.5],radius=0.4}}"));
    let rigid = body(1, "rigid = true\nshape = { rectangle = { min = [-1e9, -1e9], max = [1e9, -1] } }");
    let cases = [
        scene(&uniform("[100000, 490]"), "total", &whole),
        scene(&uniform("[100000, 1]"), "total", &whole),
        scene(&uniform("[7000, 7000]"), "updated", &(discs.clone() + "[contact]\nfriction = 0.1\n")),
        scene(&uniform("[10, 10]"), "updated", &(discs + "[contact]\nfriction = 0.1\n")),
        scene(&uniform("[10, 10]"), "updated", &(whole.clone() + &rigid + "[contact]\nfriction = 0.1\n")),
        scene(&uniform("[100, 100]"), "total", &polygon),
        scene(&curved(2, 527), "total", &whole),
        scene(&curved(4, 316), "total", &(whole + &crack.repeat(500))),
        scene(&curved(1, 500), "total", &polygon),
        format!("a = {}{}", "[".repeat(30_000), "]".repeat(30_000)),
        format!("{}a = 1", "a.".repeat(30_000)),
        many(6000, &|i| format!("a{i} = 1\n")),
        format!("output = {{ frames = [{}] }}", "\"x\", ".repeat(10_000)),
    ];
    for text in &cases {
        assert!(text.len() < LONGEST, "{} bytes", text.len());
        let start = Instant::now();
        let outcome = watched(text.as_bytes(), &|bytes: &[u8]| {
            let _ = SceneFile::parse("scene.toml", &String::from_utf8_lossy(bytes), &[]);
        });
        let name = text.lines().take(8).collect::<String>();
        eprintln!("{:.3} s: {}", start.elapsed().as_secs_f64(), &name[..name.len().min(100)]);
        outcome.unwrap_or_else(|what| panic!("{what}: {}", &name[..name.len().min(200)]));
    }
    let list = |n: usize| (1..=n).map(|i| format!("{i}, ")).collect::<String>();
    let head = "claim = \"c\"\nseconds = 1\n[[check]]\nid = \"q\"\nquantity = \"q\"\n";
    let rings = format!(
        "{head}[rings]\nouter_radius = [{0}]\ninner_over_outer = [{1}]\nlength_scale = [{0}]\npoints = [{2}]",
        list(2000),
        "0.5, ".repeat(2000),
        "2, ".repeat(2000)
    );
    let axes = format!("{head}[scene]\n{}", many(100, &|i| format!("a{i} = [{}]\n", list(100))));
    for text in [rings, axes] {
        watched(text.as_bytes(), &|bytes: &[u8]| {
            let case = Case::parse(Path::new("suite/case.toml"), &String::from_utf8_lossy(bytes), &[]);
            assert!(case.and_then(|case| case.scenes().map(|_| ())).is_err());
        })
        .unwrap_or_else(|what| panic!("{what}: {}", &text[..200]));
    }
    let deep = format!("{}a=1", "a.".repeat(30_000));
    assert!(SceneFile::parse("scene.toml", &cases[0], &[deep]).is_err());
}
