//! Results that may come from anywhere: what is opened, linked, written and drawn of them, and with how much
//! work.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use fisura_reports::compare::{compare, render_markdown};
use fisura_reports::text::render_text;
use fisura_reports::{ReportError, bundle, read_results};
use fisura_verification::output::OutputFolder;
use fisura_verification::output::foreign::steers;
use fisura_verification::record::{Figure, FigureBody};

use crate::support::{changed, curves, folder, read, render};

const ELSEWHERE: [&str; 6] =
    ["javascript:alert(1)", "/etc/passwd", "../secret.csv", "//host/x.csv", "C:\\secret.csv", "a/../../secret.csv"];

#[test]
fn names_that_lead_elsewhere_are_neither_read_nor_linked() {
    for name in ELSEWHERE {
        let folder = changed(|results| {
            results.records[0].series = Some(name.to_string());
            curves(&mut results.figures[0])[0].series = name.to_string();
            results.figures[2].id = name.to_string();
        });
        let error = render(folder.path()).unwrap_err().to_string();
        assert!(error.contains("2 figure(s)") && error.contains("joined by single slashes"), "{error}");
        let page = read(folder.path(), "report.html");
        let links = page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap().replace("&#x2f;", "/"));
        for link in links {
            assert!(!link.contains("secret") && !link.contains("passwd") && !link.contains("host"), "{link}");
            assert!(!link.contains(':') && !link.starts_with('/'), "{link}");
        }
    }
}

#[cfg(unix)]
#[test]
fn links_devices_and_pipes_are_not_read() {
    use std::os::unix::fs::symlink;
    let elsewhere = tempfile::tempdir().unwrap();
    let secret = elsewhere.path().join("secret.csv");
    fs::write(&secret, "time_s,elastic_j\n0,1\n1,2\n").unwrap();
    type Place = Box<dyn Fn(&Path)>;
    let pipe = |path: &Path| assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    let places: [(Place, &str); 4] = [
        (Box::new(move |path| symlink(&secret, path).unwrap()), "symbolic link"),
        (Box::new(|path| symlink("/dev/zero", path).unwrap()), "symbolic link"),
        (Box::new(pipe), "not a regular file"),
        (Box::new(|path| fs::create_dir(path).unwrap()), "not a regular file"),
    ];
    for (place, words) in places {
        let folder = folder();
        let path = folder.path().join("series/plate.csv");
        fs::remove_file(&path).unwrap();
        place(&path);
        let error = render(folder.path()).unwrap_err().to_string();
        assert!(error.contains("1 figure(s)") && error.contains(words), "{error}");
        place(&folder.path().join("other"));
        fs::remove_file(folder.path().join("results.json")).unwrap();
        fs::rename(folder.path().join("other"), folder.path().join("results.json")).unwrap();
        let error = render(folder.path()).unwrap_err();
        assert!(matches!(&error, ReportError::File { .. }) && error.to_string().contains(words), "{error}");
    }
}

/// Sets the title of a terminal, clears it, hides text, turns the direction of reading.
const STEERING: &str = "\u{1b}]0;owned\u{7}\u{9b}2J\u{7f}\u{202e}\nPASS: all 12 checks hold\r";

#[test]
fn no_file_or_text_made_of_results_steers_a_terminal() {
    let folder = changed(|results| {
        for record in &mut results.records {
            for text in [&mut record.id, &mut record.suite, &mut record.claim, &mut record.quantity, &mut record.unit] {
                text.push_str(STEERING);
            }
            record.accept.why = STEERING.into();
            record.message = Some(STEERING.into());
            record.parameters.insert(STEERING.into(), STEERING.into());
        }
        results.environment.cpu = STEERING.into();
        for figure in &mut results.figures {
            [&mut figure.title, &mut figure.caption].into_iter().for_each(|text| *text = STEERING.into());
        }
        curves(&mut results.figures[0])[0].label = STEERING.into();
    });
    let rendered = render(folder.path()).unwrap();
    let check = |name: &str, text: &str| {
        let found = text.chars().find(|c| *c != '\n' && steers(*c));
        assert_eq!(found, None, "{name}");
        assert!(!text.lines().any(|line| line.starts_with("PASS")), "{name}: {text}");
    };
    for file in &rendered.files {
        check(&file.display().to_string(), &read(folder.path(), file.to_str().unwrap()));
    }
    assert_eq!(rendered.files.len(), 12);
    check("text", &render_text(&rendered.results));
    check("comparison", &render_markdown(&compare(&rendered.results, &crate::fixture::results())));
}

#[test]
fn text_is_bounded_as_figures_are() {
    let folder = changed(|results| {
        let template = results.records[2].clone();
        results.records[0].claim = "x".repeat(1 << 20);
        for i in 0..4000 {
            let mut record = template.clone();
            record.id = format!("energy/many-{i}/closure");
            record.case = format!("many-{i}");
            record.claim = format!("{i}: {}", "long ".repeat(500));
            results.records.push(record);
        }
    });
    assert!(fs::metadata(folder.path().join("results.json")).unwrap().len() > 10_000_000);
    render(folder.path()).unwrap();
    let page = read(folder.path(), "report.html");
    assert!(page.len() < 5_000_000 && page.len() > 1_000_000, "{} bytes", page.len());
    assert!(page.contains("Omitted because this page is limited to 5 MB:"), "the rest is named");
    for id in ["plate/impact/p2/branching-time", "energy/disks/momentum"] {
        assert!(page.replace("&#x2f;", "/").contains(id), "{id} does not hold, and is left out last");
    }
    assert!(read(folder.path(), "summary.md").len() < 1 << 20);
}

#[test]
fn more_than_a_report_can_show_is_refused() {
    let folder = changed(|results| results.records = vec![results.records[0].clone(); 50_001]);
    let error = read_results(folder.path()).unwrap_err().to_string();
    assert!(error.contains("50001 records") && error.contains("results.json"), "{error}");
}

#[test]
fn a_saw_tooth_of_two_million_rows_is_drawn_in_bounded_work() {
    let folder = folder();
    let rows: String = (0..2_000_000).map(|i| format!("{}e-9,{}\n", i, i % 2)).collect();
    fs::write(folder.path().join("series/plate.csv"), format!("time_s,elastic_j\n{rows}")).unwrap();
    let start = Instant::now();
    render(folder.path()).unwrap();
    assert!(start.elapsed() < Duration::from_secs(600), "{:?}", start.elapsed());
    let size = fs::metadata(folder.path().join("figures/plate-elastic-energy.svg")).unwrap().len();
    assert!(size < 500_000, "{size} bytes");

    fs::write(folder.path().join("series/order.csv"), format!("error,h_m\n{}", rows.replace(",0\n", ",1e-3\n")))
        .unwrap();
    let error = render(folder.path()).unwrap_err().to_string();
    assert!(error.contains("figure timing/order") && error.contains("at most"), "markers for all rows: {error}");
}

#[test]
fn ranges_without_digits_are_drawn_or_refused() {
    for range in [[0.0, 5e-324], [1.0, 1.0 + 1e-15], [-1e308, 1e308], [1e308, -1e308]] {
        let folder = changed(|results| {
            if let FigureBody::Chart { x, y, .. } = &mut results.figures[0].body {
                (x.range, y.range) = (Some(range), Some(range));
            }
            if let FigureBody::Field { range: bar, pixels, .. } = &mut results.figures[1].body {
                (*bar, *pixels) = (range, [20, 8]);
            }
        });
        let error = render(folder.path()).unwrap_err().to_string();
        assert!(error.contains("1 figure(s)") && error.contains("colour bar"), "{error}");
        let svg = read(folder.path(), "figures/plate-elastic-energy.svg");
        assert!(svg.len() < 100_000 && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    let folder = changed(|results| {
        if let FigureBody::Field { pixels, .. } = &mut results.figures[1].body {
            *pixels = [usize::MAX, 3];
        }
    });
    assert!(render(folder.path()).unwrap_err().to_string().contains("pixels are declared"));
}

#[test]
fn a_picture_whose_pixels_are_not_those_of_its_series_is_an_error_and_no_panic() {
    let write = |folder: &Path, figure: &Figure| {
        let out = tempfile::tempdir().unwrap();
        let out = OutputFolder::open(&out.path().join("out"), "figures").unwrap();
        bundle::write((folder, figure), (&out, "drawn"), &Default::default(), Default::default())
    };
    let folder = folder();
    let figure = crate::fixture::results().figures.remove(1);
    assert!(write(folder.path(), &figure).is_ok());
    for size in [[0, 8], [20, 0], [usize::MAX; 2]] {
        let mut figure = figure.clone();
        let FigureBody::Field { pixels, .. } = &mut figure.body else { panic!("a picture") };
        *pixels = size;
        assert!(write(folder.path(), &figure).unwrap_err().to_string().contains("pixels are declared"));
    }
    let FigureBody::Field { series, .. } = &figure.body else { panic!("a picture") };
    let path = folder.path().join(series);
    fs::write(&path, read(folder.path(), series).replacen("x_m", "z_m", 1)).unwrap();
    assert!(write(folder.path(), &figure).unwrap_err().to_string().contains("x_m"));
}
