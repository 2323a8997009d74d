//! Exchanged columns, other origins of the times and units are named, and nothing else is taken for them.

use super::*;

/// The ids of what is found.
fn ids(folder: &Path) -> Vec<String> {
    judged(folder, None).verdict.findings.into_iter().map(|f| f.id).collect()
}

/// Line of `[curves]` of a quantity with the columns of others: `(quantity, column)`.
fn with_columns(text: String, columns: &[(&str, &str)]) -> String {
    let line = |line: &str| {
        let given = columns.iter().find(|(quantity, _)| line.starts_with(&format!("{quantity} = {{")));
        let Some((_, column)) = given else { return format!("{line}\n") };
        let (head, rest) = line.split_once("column = \"").unwrap();
        format!("{head}column = \"{column}\"{}\n", rest.split_once('"').unwrap().1)
    };
    text.lines().map(line).collect()
}

/// Columns of fisura and of the independent finite elements: kinetic, elastic, work, fracture.
const OF_FISURA: [&str; 4] = ["kinetic_j", "elastic_j", "external_work_j", "fracture_j"];
const OF_ELEMENTS: [&str; 4] = ["kinetic_j_per_m", "elastic_j_per_m", "external_work_j_per_m", "fracture_j_per_m"];

#[test]
fn exchanged_columns_are_named() {
    let keys = ["kinetic", "elastic", "work", "fracture"];
    for (name, columns) in [(SOUND, OF_FISURA), ("fisura-p2-h1", OF_FISURA), ("independent-fem-h1", OF_ELEMENTS)] {
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let exchange = [(keys[a], columns[b]), (keys[b], columns[a])];
            let folder = changed(name, |t| with_columns(t, &exchange));
            assert_eq!(ids(folder.path()), ["exchanged-columns"], "{name}: {exchange:?}");
        }
        let round = [(keys[0], columns[1]), (keys[1], columns[2]), (keys[2], columns[0])];
        assert_eq!(ids(changed(name, |t| with_columns(t, &round)).path()), ["exchanged-columns"], "{name}: three");
        for (key, column) in [(0, 1), (1, 0), (2, 0), (1, 3), (3, 1)] {
            let twice = [(keys[key], columns[column])];
            assert_eq!(ids(changed(name, |t| with_columns(t, &twice)).path()), ["wrong-column"], "{name}: {twice:?}");
        }
    }
    let text = recognised(
        changed(SOUND, |t| with_columns(t, &[("kinetic", "elastic_j"), ("elastic", "kinetic_j")])).path(),
        "exchanged-columns",
    );
    assert!(text.text.contains("what is given as kinetic energy is the elastic energy (4."), "{text:?}");
    let [x, y] = ["crack_tip_x_m", "crack_tip_y_m"];
    let tips: [(&[(&str, &str)], &str); 3] = [
        (&[("tip_x", y), ("tip_y", x)], "exchanged-columns"),
        (&[("tip_x", y)], "wrong-column"),
        (&[("tip_y", x)], "wrong-column"),
    ];
    for (columns, id) in tips {
        assert_eq!(ids(changed(SOUND, |t| with_columns(t, columns)).path()), [id], "{columns:?}");
    }
}

/// A submission with a constant in its times, in the unit of its column: rows before 0 are left out, and rows
/// at rest stand before a run that is late if it is `padded`.
fn shifted(name: &str, by: f64, interval: f64, padded: bool) -> TempDir {
    let folder = changed(name, |t| t);
    let text = fs::read_to_string(of(name).join("history.csv")).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let rows: Vec<(f64, &str)> = rows
        .lines()
        .map(|line| line.split_once(',').unwrap())
        .map(|(t, rest)| (t.parse::<f64>().unwrap() + by, rest))
        .collect();
    let rest = (0..).map(|i| f64::from(i) * interval).take_while(|t| padded && *t < by - 0.5 * interval);
    let before = rest.map(|t| (t, rows[0].1)).collect::<Vec<_>>();
    let all = before.iter().chain(&rows).filter(|row| row.0 > -0.5 * interval);
    let all: String = all.map(|(t, rest)| format!("{t:e},{rest}\n")).collect();
    fs::write(folder.path().join("history.csv"), format!("{head}\n{all}")).unwrap();
    folder
}

#[test]
fn another_origin_of_the_times_is_named_and_its_remedy_is_right() {
    // nothing of the coarse mesh shows agreement, and nothing of it fails
    for (name, unit, passes) in [(SOUND, 1e-6, true), ("fisura-p2-h1", 1e-6, false), ("independent-fem-h3", 1.0, true)]
    {
        for by in [1.0, 3.0, 10.0, 2.37, -1.0, -3.0, -10.0] {
            for padded in [false, true] {
                let folder = shifted(name, by * unit, 0.5 * unit, padded && by > 0.0);
                assert_eq!(ids(folder.path()), ["time-origin"], "{name}: {by} us, {padded}");
                let text = recognised(folder.path(), "time-origin").text;
                let offset = text.split("offset = ").nth(1).unwrap().split(' ').next().unwrap();
                let difference = offset.parse::<f64>().unwrap() / unit + by;
                assert!(difference.abs() <= 0.051, "{name}: {by} us, {text}");
                let path = folder.path().join("submission.toml");
                let time = |line: &str| match line.strip_prefix("time =") {
                    Some(rest) => format!("time ={}, offset = {offset} }}\n", rest.trim_end_matches([' ', '}'])),
                    None => format!("{line}\n"),
                };
                let text: String = fs::read_to_string(&path).unwrap().lines().map(time).collect();
                fs::write(&path, text).unwrap();
                let verdict = judged(folder.path(), None).verdict;
                assert_ne!(verdict.outcome, Outcome::Fail, "{name}: {by} us, {:?}", verdict.sentence);
                assert_eq!(verdict.outcome == Outcome::Pass, passes, "{name}: {by} us, {:?}", verdict.sentence);
            }
        }
    }
}

#[test]
fn what_fails_for_another_reason_is_no_exchange_and_no_other_origin() {
    let factor = |key: &'static str, factor: f64| {
        move |t: String| {
            let line = |line: &str| match line.starts_with(&format!("{key} =")) {
                true => line.replace("factor = 2", &format!("factor = {}", 2.0 * factor)) + "\n",
                false => format!("{line}\n"),
            };
            t.lines().map(line).collect::<String>()
        }
    };
    for (key, by) in
        [("kinetic", 0.9), ("kinetic", 1.1), ("elastic", 0.8), ("elastic", 1.2), ("work", 0.97), ("fracture", 1.3)]
    {
        assert_eq!(ids(changed(SOUND, factor(key, by)).path()), ["unexplained"], "{key} times {by}");
    }
    let load = |t: String| t.replace("factor = 2", "factor = 1.8");
    assert_eq!(ids(changed(SOUND, load).path()), ["load"]);
    let rows = |change: &dyn Fn(f64) -> Option<f64>| {
        let folder = changed(SOUND, factor("kinetic", 1.1));
        let text = fs::read_to_string(of(SOUND).join("history.csv")).unwrap();
        let (head, rows) = text.split_once('\n').unwrap();
        let row = |line: &str| {
            let (t, rest) = line.split_once(',').unwrap();
            Some(format!("{:e},{rest}\n", change(t.parse().unwrap())?))
        };
        fs::write(
            folder.path().join("history.csv"),
            format!("{head}\n{}", rows.lines().filter_map(row).collect::<String>()),
        )
        .unwrap();
        folder
    };
    for start in [2e-6, 4e-6, 8e-6, 11e-6, 15e-6] {
        let cut = rows(&|t| (t >= start - 1e-9).then_some(t));
        assert_eq!(ids(cut.path()), ["unexplained"], "rows from {start} s on");
    }
    for stretch in [0.95, 1.02] {
        let found = ids(rows(&|t| Some(t * stretch)).path());
        assert!(!found.contains(&"time-origin".to_string()), "{stretch}: {found:?}");
    }
    let late_crack = rows(&|t| Some(t + 0.1 * (t - 12e-6).max(0.0)));
    assert_eq!(ids(late_crack.path()), ["unexplained"], "a crack that runs late");
}

#[test]
fn units_of_energies_are_recognised_beside_a_half_and_by_the_declared_thickness() {
    let all = |unit: &'static str| move |t: String| t.replace("unit = \"J/m\"", &format!("unit = {unit:?}"));
    for (unit, id) in [("kJ/m", "thickness"), ("mJ/m", "thickness"), ("J/mm", "thickness"), ("MJ/m", "unit")] {
        assert_eq!(ids(changed(SOUND, all(unit)).path()), [id], "{unit}");
        let one = |t: String| t.replacen("unit = \"J/m\"", &format!("unit = {unit:?}"), 1);
        assert_eq!(ids(changed(SOUND, one).path()), ["unit"], "{unit} for one");
        let half = |t: String| all(unit)(t).replace(", factor = 2", "");
        assert_eq!(ids(changed(SOUND, half).path()), ["half-model-factor", id], "{unit} for a half");
    }
    for unit in ["mJ/mm", "N", "kJ/km"] {
        assert_eq!(judged(changed(SOUND, all(unit)).path(), None).verdict.outcome, Outcome::Pass, "{unit} is J/m");
    }
    for thickness in ["1 mm", "2 mm", "3 mm", "10 mm"] {
        let folder = changed(SOUND, |t| all("J")(t).replace("[model]", &format!("[model]\nthickness = {thickness:?}")));
        let text = recognised(folder.path(), "thickness").text;
        assert!(text.contains("declared thickness of 0.0") && ids(folder.path()).len() == 1, "{thickness}: {text}");
    }
}
