//! Sound results are accepted, planted mistakes are named, hostile folders end in words.

mod kalthoff;
mod mistakes;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::numbers::{Asked, Basis};
use super::submission::Submission;
use super::verdict::{Finding, Outcome};
use super::*;
use crate::case::Case;
use crate::measure::{Run, measure};
use crate::output::history::Table;
use crate::scene::SceneFile;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn data() -> PathBuf {
    root().join("reference-data")
}

fn library() -> Library {
    Library::load(&data()).unwrap()
}

fn of(name: &str) -> PathBuf {
    data().join("submissions").join(name)
}

fn judged(folder: &Path, against: Option<&str>) -> Judged {
    judge(folder, &library(), &data(), against).unwrap_or_else(|e| panic!("{e}"))
}

/// A copy of a submission with its text changed.
fn changed(name: &str, change: impl Fn(String) -> String) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(of(name)).unwrap().flatten() {
        fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    let path = folder.path().join("submission.toml");
    fs::write(&path, change(fs::read_to_string(&path).unwrap())).unwrap();
    folder
}

const SOUND: &str = "fisura-p2-h2";

#[test]
fn a_result_of_fisura_has_the_figures_of_verify() {
    let path = root().join("verification/cases/plate/half-p2-h2.toml");
    let case = Case::load(&path, &[]).unwrap();
    let scene = SceneFile::load(&root().join("verification/scenes/plate.toml"), &[]).unwrap().scene;
    let history = Table::read(&of(SOUND).join("history.csv")).unwrap();
    let values = BTreeMap::new();
    let run = Run { name: "p2", scene: &scene, history: &history, frames: &[], energy_factor: 2.0, values: &values };
    let verdict = judged(&of(SOUND), None).verdict;
    let mut compared = 0;
    for check in &case.checks {
        let Some(quantity) = check.reference.as_deref().and_then(|r| r.strip_prefix("plate-family/plate/")) else {
            continue;
        };
        let value = measure(check, &run, &[run], &library()).unwrap().value.unwrap() / check.scale;
        let index = QUANTITIES.iter().position(|q| q.reference == quantity).unwrap();
        let whole = &verdict.quantities[index].comparisons[0];
        if check.window.iter().zip(whole.window_s.unwrap()).all(|(a, b)| (a - b).abs() < 1e-12) {
            assert!((whole.error.unwrap() / value - 1.0).abs() < 1e-12, "{quantity}: {whole:?}, verify: {value}");
            compared += 1;
        }
    }
    assert_eq!(compared, 5, "kinetic, elastic, work, fracture, tip");
}

#[test]
fn fine_meshes_pass_and_coarse_ones_are_left_open() {
    let (fine, coarse) = (Outcome::Pass, Outcome::Diagnostic);
    for (name, expected) in [
        (SOUND, fine),
        ("fisura-p3-graded-h2", fine),
        ("independent-fem-h3", fine),
        ("fisura-p2-h1", coarse),
        ("fisura-p3-h1", coarse),
        ("independent-fem-h1", coarse),
    ] {
        let verdict = judged(&of(name), None).verdict;
        let shown: Vec<_> = verdict.comparisons().map(|c| (&c.name, c.outcome)).collect();
        assert_eq!(verdict.outcome, expected, "{name}: {shown:?}");
        assert!(verdict.findings.is_empty(), "{:?}", verdict.findings);
    }
}

#[test]
fn another_model_is_judged_by_its_own_reference_and_its_differences_are_named() {
    let verdict = judged(&of("solidualsphysics-h2"), None).verdict;
    assert_eq!(
        (verdict.reference.id.as_str(), verdict.outcome),
        ("plate-family/slit-plane-stress", Outcome::Diagnostic)
    );
    let whole: Vec<f64> = verdict.quantities.iter().map(|q| q.comparisons[0].error.unwrap()).collect();
    let expected = [0.017, 0.062, 0.008, 0.081, 2.6e-3];
    assert!(whole.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 0.05), "{whole:?}");
    assert!(verdict.balance.unwrap().outcome == Outcome::Pass && verdict.differences.len() == 3);
}

/// A mistake is recognised by its name, and the result does not pass.
#[track_caller]
fn recognised(folder: &Path, id: &str) -> Finding {
    let verdict = judged(folder, None).verdict;
    assert_eq!(verdict.outcome, Outcome::Fail, "{id}: {:?}", verdict.findings);
    let found = verdict.findings.iter().find(|f| f.id == id);
    found.unwrap_or_else(|| panic!("{id} is not among {:?}", verdict.findings)).clone()
}

#[test]
fn mistakes_planted_in_a_sound_result_are_named() {
    let planted: [(&str, &dyn Fn(String) -> String); 9] = [
        ("half-model-factor", &|t| t.replace(", factor = 2", "")),
        ("half-model-factor", &|t| t.replace("factor = 2", "factor = 4")),
        ("unit", &|t| t.replacen("unit = \"J/m\"", "unit = \"kJ/m\"", 1)),
        ("thickness", &|t| t.replace("factor = 2", "factor = 0.002")),
        ("time-unit", &|t| t.replace("unit = \"s\"", "unit = \"ms\"")),
        ("time-unit", &|t| t.replace("unit = \"s\"", "unit = \"ks\"")),
        ("absolute-fracture-energy", &|t| t.replace("\"fracture_j\",", "\"fracture_j\", form = \"increment\",")),
        ("tip-unit", &|t| t.replace("\"crack_tip_x_m\", unit = \"m\"", "\"crack_tip_x_m\", unit = \"mm\"")),
        ("sign", &|t| t.replacen("factor = 2", "factor = -2", 1)),
    ];
    for (id, change) in planted {
        let finding = recognised(changed(SOUND, change).path(), id);
        assert!(finding.text.len() > 40, "{finding:?}");
    }
}

/// A reference of the family, submitted as what it is not.
fn variant(name: &str) -> TempDir {
    let folder = changed("independent-fem-h4", |t| {
        t.replace("\"fracture_j_per_m\"", "\"fracture_increment_j_per_m\"").replace(
            "tip_x = { file = \"history.csv\", column = \"tip_x_mm\", unit = \"mm\" }\ntip_y = { file = \"history.csv\", column = \"tip_y_mm\", unit = \"mm\" }\n",
            "",
        )
    });
    fs::copy(data().join(format!("plate-family/{name}.csv")), folder.path().join("history.csv")).unwrap();
    folder
}

#[test]
fn the_result_of_another_problem_is_recognised() {
    let stress = recognised(variant("plane-stress").path(), "plane-state");
    assert!(stress.text.contains("plane stress with a traction of 1.0"), "{stress:?}");
    let half = recognised(variant("low-traction").path(), "load");
    assert!(half.text.contains("a traction of 0.499 MPa"), "{half:?}");
    recognised(variant("low-traction").path(), "another-benchmark");
    recognised(variant("slit").path(), "another-benchmark");
    let twice = root().join("verification/tests/judge/length-scale");
    recognised(&twice, "length-scale-convention");
}

#[test]
fn the_mesh_study_is_what_the_meshes_give() {
    let table = Table::read(&data().join("plate-family/mesh-study.csv")).unwrap();
    for (row, name) in ["h1", "h2", "h3", "h4", "h5"].into_iter().enumerate() {
        let verdict = judged(&of(&format!("independent-fem-{name}")), None).verdict;
        for (quantity, column) in
            ["kinetic", "elastic", "external_work", "fracture_increment", "tip_x"].iter().enumerate()
        {
            let stored = table.column(&format!("{column}_whole")).unwrap()[row];
            let error = verdict.quantities[quantity].comparisons[0].error.unwrap();
            assert!((error / stored - 1.0).abs() < 0.02, "{name} {column}: {error} {stored}");
        }
    }
}

/// The error of a folder whose text or table is changed.
fn refused(change: impl Fn(String) -> String, table: Option<&[u8]>) -> String {
    let folder = changed(SOUND, change);
    if let Some(table) = table {
        fs::write(folder.path().join("history.csv"), table).unwrap();
    }
    judge(folder.path(), &library(), &data(), None).map(|j| j.verdict.sentence).unwrap_err().to_string()
}

/// Asserts that tables in place of the sound one are refused with these words.
#[track_caller]
fn tables_are_refused(tables: &[(String, &[&str])]) {
    for (table, parts) in tables {
        let text = refused(|t| t, Some(table.as_bytes()));
        let start: String = table.chars().take(200).collect();
        assert!(parts.iter().all(|p| text.contains(p)), "{parts:?} in {text} of {start}");
    }
}

#[test]
fn what_cannot_be_read_is_told_with_place_and_remedy() {
    let head = "time_s,kinetic_j,elastic_j,fracture_j,external_work_j,crack_tip_x_m,crack_tip_y_m\n";
    let rows = |rows: &str| format!("{head}{rows}");
    let same = |t: String| t;
    let texts: [(String, &[&str]); 7] = [
        (refused(|t| t.replace("plane =", "plan ="), None), &["submission.toml:", "plan", "did you mean \"plane\"?"]),
        (refused(|t| t.replace("\"strain\"", "\"strian\""), None), &["did you mean \"strain\"?"]),
        (refused(|t| t.replace("\"history.csv\"", "\"../history.csv\""), None), &["leads out of the folder"]),
        (refused(|t| t.replace("\"history.csv\"", "\"/etc/passwd\""), None), &["leads out of the folder"]),
        (refused(|t| t.replace("\"kinetic_j\"", "\"kinetik_j\""), None), &["did you mean \"kinetic_j\"?"]),
        (refused(|t| t.replacen("unit = \"J/m\"", "unit = \"mm\"", 1), None), &["is a length", "energy per thickness"]),
        (refused(|t| t.replacen("unit = \"J/m\"", "unit = \"J\"", 1), None), &["needs the thickness"]),
    ];
    let tables: [(String, &[&str]); 8] = [
        (rows("0,0,0,0,0,0,0\n1e-6,1,NaN,1,1,0,0\n"), &["history.csv:3:8", "no finite number"]),
        (rows("0,0,0,0,0,0,0\n1e-6,1,2,x,1,0,0\n"), &["history.csv:3:10", "\"x\" is not a number"]),
        (rows("0,0,0,0,0,0,0\n2e-6,1,1,1,1,0,0\n1e-6,1,1,1,1,0,0\n"), &["history.csv:4:1", "does not increase"]),
        (rows("0,0,0,0,0,0,0\n1e-6,1,1,1,1,0,0\n1e-6,1,1,1,1,0,0\n"), &["history.csv:4:1", "does not increase"]),
        (rows("0,0,0\n1,1,1\n"), &["history.csv:2:1", "3 fields under 7 names"]),
        (head.to_string(), &["0 rows of numbers"]),
        ("\u{feff}a;b\n1,5;2\n3;4\n".into(), &["no column"]),
        ("\0\0".into(), &["UTF-16 or binary"]),
    ];
    for (text, parts) in texts {
        assert!(parts.iter().all(|p| text.contains(p)), "{parts:?} in {text}");
    }
    tables_are_refused(&tables);
    let long = format!("{head}{}", "0,0,0,0,0,0,0\n".repeat(2_100_000));
    assert!(refused(same, Some(long.as_bytes())).contains("more than 2000000 rows"));
    assert!(refused(same, Some("1\n".repeat(33 << 20).as_bytes())).contains("longer than 64 MiB"));
    let wide: Vec<u8> = head.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(refused(same, Some(&[&[0xff, 0xfe], &wide[..]].concat())).contains("UTF-16"));
}

/// The sound history with every number changed.
fn with_numbers(separator: &str, change: impl Fn(&str) -> String) -> String {
    let text = fs::read_to_string(of(SOUND).join("history.csv")).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let row = |line: &str| line.split(',').map(&change).collect::<Vec<_>>().join(separator) + "\n";
    format!("{}\n{}", head.replace(',', separator), rows.lines().map(row).collect::<String>())
}

#[test]
fn decimal_commas_are_refused_in_every_layout() {
    let same = |t: String| t;
    let comma = |word: &str| word.replace('.', ",");
    let quoted = |word: &str| format!("\"{}\"", word.replace('.', ","));
    let thousands = |word: &str| if word.contains('.') { format!("1.{}", comma(word)) } else { word.to_string() };
    let point = "write the decimal point as a point";
    let cut = "write decimal commas as points";
    let tables: [(String, &[&str]); 6] = [
        (with_numbers(",", comma), &["history.csv:2:", "fields under 7 names", cut]),
        (with_numbers(";", comma), &["history.csv:5:", "is not a number", point]),
        (with_numbers("\t", comma), &["history.csv:5:", "is not a number", point]),
        (with_numbers(" ", comma), &["history.csv:5:", "is not a number", point]),
        (with_numbers(",", quoted), &["history.csv:5:", "is not a number", point]),
        (with_numbers(";", thousands), &["history.csv:5:", "nothing between thousands"]),
    ];
    tables_are_refused(&tables);
    // whole numbers of microseconds, of which some rows have more decimal commas than others
    let few = "time_s,kinetic_j,elastic_j,fracture_j,external_work_j,crack_tip_x_m,crack_tip_y_m\n\
               0,0,0,0,204183,0,50,20\n1,0,0106,0,0107,0,204,0,0213,50,1965,20\n";
    assert!(refused(same, Some(few.as_bytes())).contains(cut));
}

#[test]
fn decimal_commas_without_a_header_are_refused() {
    let numbered = |t: String| {
        let columns =
            ["time_s", "kinetic_j", "elastic_j", "fracture_j", "external_work_j", "crack_tip_x_m", "crack_tip_y_m"];
        columns.iter().zip(1..).fold(t, |t, (name, number)| t.replace(&format!("{name:?}"), &number.to_string()))
    };
    let rows: String = (0..30).map(|i| format!("{i},5,0,0{i},1,00,2,0{i},3,5,50,196{i},20,05\n")).collect();
    let text = refused(numbered, Some(rows.as_bytes()));
    assert!(text.contains("history.csv:1:") && text.contains("cut at their decimal commas"), "{text}");
    let ragged = "0,0,0,0,0,50,20\n1,0,0106,0,0107,0,204,0,0213,50,1965,20\n";
    let text = refused(numbered, Some(ragged.as_bytes()));
    assert!(text.contains("history.csv:2:") && text.contains("write decimal commas as points"), "{text}");
    let text = refused(numbered, Some("0;0;0;0;0,5;50;20\n1;1;1;1;1,5;50;20\n".as_bytes()));
    assert!(text.contains("history.csv:1:9") && text.contains("write the decimal point as a point"), "{text}");
    // step numbers with zeros in front are no decimals
    let text = fs::read_to_string(of(SOUND).join("history.csv")).unwrap();
    let steps: String = text.lines().skip(1).enumerate().map(|(i, line)| format!("{line},{i:05}\n")).collect();
    let folder = changed(SOUND, numbered);
    fs::write(folder.path().join("history.csv"), steps).unwrap();
    assert_eq!(judged(folder.path(), None).verdict.outcome, Outcome::Pass);
}

#[test]
fn rows_of_another_length_than_the_header_are_refused_with_the_likely_cause() {
    let same = |t: String| t;
    let text = fs::read_to_string(of(SOUND).join("history.csv")).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let each = |change: &dyn Fn(usize, &str) -> String| -> String {
        rows.lines().enumerate().map(|(i, line)| change(i, line) + "\n").collect()
    };
    let indexed = each(&|i, line| format!("{i},{line}"));
    let trailing = each(&|_, line| format!("{line},"));
    let spaced = format!(" {head}\n{indexed}").replace(',', " ");
    let refusals: [(String, &[&str]); 7] = [
        (format!("{head}\n{indexed}"), &["history.csv:2:", "8 fields under 7 names", "counts the rows"]),
        (spaced, &["history.csv:2:", "8 fields under 7 names", "counts the rows"]),
        (format!("# {head}\n{indexed}"), &["history.csv:2:", "8 fields under 7 names", "counts the rows"]),
        (format!("{head}\n{trailing}"), &["history.csv:2:", "8 fields under 7 names", "end the header with one"]),
        (format!("{head}\n{rows}0.1,0,0,0,0,0,0,restarted\n"), &["8 fields under 7 names", "start with #"]),
        (format!("{head}\n{rows}0.1,0,0,0,0,0,0,1,2\n"), &["9 fields under 7 names", "every column a name"]),
        (format!("{head}\n{rows}0.1,0,0\n"), &["3 fields under 7 names", "as many numbers"]),
    ];
    tables_are_refused(&refusals);
    let sound = judged(&of(SOUND), None).verdict.quantities;
    for table in [format!(",{head}\n{indexed}"), format!("\"\",{head}\n{indexed}"), format!("{head},\n{trailing}")] {
        let folder = changed(SOUND, same);
        fs::write(folder.path().join("history.csv"), &table).unwrap();
        assert_eq!(judged(folder.path(), None).verdict.quantities, sound, "{}", &table[..120]);
    }
}

#[test]
fn hostile_folders_end_in_words() {
    let wide: Vec<u8> = "benchmark = \"plate\"".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, part) in [([&[0xff, 0xfe], &wide[..]].concat(), "UTF-8"), (vec![b'['; 2 << 20], "cannot be read")] {
        let folder = changed(SOUND, |t| t);
        fs::write(folder.path().join("submission.toml"), bytes).unwrap();
        let text = judge(folder.path(), &library(), &data(), None).map(|_| ()).unwrap_err().to_string();
        assert!(text.contains(part) && text.contains("submission.toml"), "{part} in {text}");
    }
    let same = |t: String| t;
    assert!(refused(same, Some("0 0\n".repeat(10_000_000).as_bytes())).contains("more than 2000000 rows"));
    assert!(refused(|t| t.replace("\"history.csv\"", "\".\""), None).contains("submission.toml:"));
    let markup = "<img src=x onerror=alert(1)>\u{1b}[2J,kinetic\n0,1\n1,2\n";
    let text = refused(same, Some(markup.as_bytes()));
    assert!(text.contains("no column") && !text.contains('\u{1b}'), "{text:?}");
}

#[test]
#[cfg(unix)]
fn a_link_out_of_the_folder_is_not_followed() {
    let folder = changed(SOUND, |t| t);
    let (link, outside) = (folder.path().join("history.csv"), of(SOUND).join("history.csv"));
    fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(outside, &link).unwrap();
    let text = judge(folder.path(), &library(), &data(), None).map(|_| ()).unwrap_err().to_string();
    assert!(text.contains("cannot be read") && text.contains("history.csv"), "{text}");
}

#[test]
fn any_layout_gives_the_same_figures() {
    let sound = judged(&of(SOUND), None).verdict.quantities;
    let text = fs::read_to_string(of(SOUND).join("history.csv")).unwrap();
    let quoted = text.lines().next().unwrap().split(',').map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(",");
    let layouts = [
        text.replace(',', ";"),
        text.replace(',', "\t"),
        format!("# a comment\n#{}", text.replace(',', "  ").replace("time_s", " time_s")),
        text.replace('\n', "\r\n"),
        format!("\u{feff}{}", text.replacen(text.lines().next().unwrap(), &quoted, 1)),
    ];
    for layout in layouts {
        let folder = changed(SOUND, |t| t);
        fs::write(folder.path().join("history.csv"), &layout).unwrap();
        assert_eq!(judged(folder.path(), None).verdict.quantities, sound, "{}", &layout[..120]);
    }
}

#[test]
fn an_end_or_a_quantity_that_is_missing_is_incomplete() {
    let text = fs::read_to_string(of(SOUND).join("history.csv")).unwrap();
    let folder = changed(SOUND, |t| t.lines().filter(|l| !l.starts_with("work")).map(|l| format!("{l}\n")).collect());
    let short: String = text.lines().take(101).map(|l| format!("{l}\n")).collect();
    fs::write(folder.path().join("history.csv"), short).unwrap();
    let verdict = judged(folder.path(), None).verdict;
    assert_eq!(verdict.quantities[WORK].outcome, Outcome::Incomplete);
    let kinetic: Vec<Outcome> = verdict.quantities[KINETIC].comparisons.iter().map(|c| c.outcome).collect();
    assert_eq!(kinetic, [Outcome::Incomplete, Outcome::Pass, Outcome::Pass, Outcome::Incomplete]);
    assert!(verdict.balance.is_none());
}

#[test]
fn the_templates_are_valid_and_numbers_are_judged() {
    let library = library();
    for benchmark in BENCHMARKS {
        Submission::parse("submission.toml", &template::template(benchmark.name)).unwrap_or_else(|e| panic!("{e}"));
        let model = numbers::elements(benchmark.name)
            .map_or("", |_| "[model]\nplane = \"stress\"\nphase_field = \"AT1\"\nsplit = \"unknown\"\n");
        let elements = numbers::elements(benchmark.name);
        let known = |basis: &Basis| match basis {
            Basis::ClosedForm(formula, _) => numbers::closed_form(formula),
            Basis::Below(value) | Basis::Undecided(value, _) => *value,
            Basis::Elements(name) => elements.unwrap().value(&library, benchmark.name, name).unwrap().value,
        };
        let asked = numbers::values(benchmark.name);
        for (factor, outcome) in [(1.0 - 1e-9, Outcome::Pass), (1.1, Outcome::Fail)] {
            let value = |a: &Asked| format!("{} = {:e}\n", a.name, known(&a.basis) * factor);
            let values: String = asked.iter().map(value).collect();
            let folder = tempfile::tempdir().unwrap();
            let text = format!("benchmark = {:?}\n[code]\nname = \"c\"\n{model}[values]\n{values}", benchmark.name);
            fs::write(folder.path().join("submission.toml"), text).unwrap();
            if !asked.is_empty() {
                let shows_no_agreement = benchmark.name == "crack-speed" && factor < 1.0;
                let diagnostic = ["rings", "pmma-strip"].contains(&benchmark.name) || shows_no_agreement;
                let outcome = if diagnostic { Outcome::Diagnostic } else { outcome };
                assert_eq!(judged(folder.path(), None).verdict.outcome, outcome, "{}", benchmark.name);
            }
        }
    }
}

#[test]
fn numbers_have_the_uncertainty_that_is_stated_or_that_of_elements_of_their_spacing() {
    let judged = |lines: &str| {
        let folder = tempfile::tempdir().unwrap();
        let text = "benchmark = \"strip\"\ncode = { name = \"c\" }\nvalues = { speed = \"1380 m/s\" }\n";
        fs::write(folder.path().join("submission.toml"), format!("{text}{lines}\n")).unwrap();
        judge(folder.path(), &library(), &data(), None).map(|judged| judged.verdict)
    };
    let model = "model = { plane = \"stress\", phase_field = \"AT1\", split = \"spectral\" }\n";
    let speed = |lines: &str| judged(&format!("{model}{lines}")).unwrap().quantities[0].comparisons[0].clone();
    let alone = speed("");
    assert!(alone.outcome == Outcome::Fail && alone.u_num.is_none(), "{alone:?}");
    let stated = speed("uncertainty = { speed = \"20 m/s\" }");
    assert!(stated.outcome == Outcome::Pass && stated.u_num == Some(20.0), "{stated:?}");
    let spacing = speed("discretisation = { spacing = \"62.5 um\" }");
    assert!((spacing.u_num.unwrap() / (2.5 * spacing.u_ref.unwrap()) - 1.0).abs() < 1e-12, "{spacing:?}");
    assert_eq!(spacing.outcome, Outcome::Diagnostic, "an uncertainty of 7 % shows no agreement");
    let other = judged("model = { plane = \"strain\", phase_field = \"AT2\", split = \"none\" }").unwrap();
    assert!(other.differences.len() == 3 && other.outcome == Outcome::Incomplete, "{other:?}");
    let refused = [
        ("", "model: missing"),
        ("uncertainty = { sped = \"20 m/s\" }", "uncertainty.sped"),
        ("uncertainty = { speed = \"-20 m/s\" }", "uncertainty.speed"),
    ];
    for (lines, says) in refused {
        let error = judged(lines).unwrap_err().to_string();
        assert!(error.contains(says), "{lines}: {error}");
    }
}
