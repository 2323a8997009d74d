//! A folder of results is rendered as a whole: structure, bytes, and what happens when something is missing.

use std::fs;

use fisura_reports::ReportError;
use fisura_verification::record::CurveStyle;
use insta::assert_snapshot;

use crate::support::{changed, curves, folder, read, render};

/// Tags of a page that carry its structure, one per line.
fn skeleton(html: &str) -> String {
    let keep = |tag: &&str| {
        let name = tag.split([' ', '>']).next().unwrap_or_default();
        matches!(name, "title" | "h1" | "h2" | "h3" | "nav" | "section" | "figure" | "thead" | "svg" | "details")
            || tag.contains(" id=\"check-")
            || tag.starts_with("a ")
    };
    let short = |tag: &str| match tag.split_once("viewBox") {
        Some((_, rest)) => format!("svg viewBox{}", rest.split(" font").next().unwrap_or_default()),
        None => tag.split('\n').next().unwrap_or_default().to_string(),
    };
    html.split('<').filter(keep).map(short).collect::<Vec<_>>().join("\n")
}

#[test]
fn reports_keep_their_form_and_the_page_its_structure() {
    let folder = folder();
    render(folder.path()).unwrap();
    assert_snapshot!("summary", read(folder.path(), "summary.md"));
    assert_snapshot!("junit", read(folder.path(), "junit.xml"));
    assert_snapshot!("metrics", read(folder.path(), "metrics.json"));
    assert_snapshot!("text", fisura_reports::text::render_text(&crate::fixture::results()));
    let page = read(folder.path(), "report.html");
    assert_snapshot!("report", skeleton(&page));
    for mark in ["src=", "url(", "@import", "<link", "<script", "href=\"http"] {
        assert!(!page.contains(mark), "{mark}: the page needs nothing else");
    }
    assert!(page.len() < 5_000_000);
    assert!(page.contains("prefers-color-scheme: dark"));
    assert!(page.contains("h → 0 &lt;extrapolated&gt;"), "text of records is escaped");
    let rates = page.split("<table class=\"rates\">").nth(1).and_then(|t| t.split("</table>").next()).unwrap();
    assert_eq!(rates.matches("<td><a href=\"#check-manufactured-bar-").count(), 4, "one row per order: {rates}");
    assert_eq!(rates.matches("A manufactured bar").count(), 1, "the claim stands once per case");
    for cells in [
        "p = 1</td>\n<td>displacement error in L2</td>\n<td>2</td>\n<td>1.998</td>\n<td>≥ 1.9</td>\n<td>0.000489<",
        "p = 2</td>\n<td>displacement error in H1</td>\n<td>2</td>\n<td><i>none</i></td>\n<td>≥ 1.9</td>\n<td><i>none<",
    ] {
        assert!(
            rates.contains(cells),
            "{cells:?} is missing: without a record there is neither order nor error: {rates}"
        );
    }
    for target in page.split("href=\"#").skip(1).map(|t| t.split('"').next().unwrap_or_default()) {
        assert!(page.contains(&format!("id=\"{target}\"")), "#{target} leads nowhere");
    }
}

#[test]
fn two_renderings_are_the_same_bytes() {
    let (first, second) = (folder(), folder());
    let files = render(first.path()).unwrap().files;
    assert_eq!(render(second.path()).unwrap().files, files);
    render(second.path()).unwrap();
    for file in &files {
        assert_eq!(fs::read(first.path().join(file)).unwrap(), fs::read(second.path().join(file)).unwrap(), "{file:?}");
    }
    assert!(files.iter().any(|f| f.ends_with("timing/order.svg")));
    let left =
        fs::read_dir(first.path()).unwrap().filter(|e| e.as_ref().unwrap().path().extension() == Some("part".as_ref()));
    assert_eq!(left.count(), 0, "no temporary file stays behind");
}

#[test]
fn a_chart_of_orders_has_clean_labels_slopes_of_theory_and_floors() {
    let folder = folder();
    render(folder.path()).unwrap();
    let svg = read(folder.path(), "figures/timing/order.svg");
    for label in ["10⁻⁶", "10⁻⁷", "0.05", "0.1", "round-off", "3"] {
        assert!(svg.contains(&format!(">{label}</text>")), "{label} is missing in {svg}");
    }
    assert!(!svg.contains("99999"), "{svg}");
    assert!(svg.contains("Slopes of theory: 3."), "told to those who cannot see it");
    assert_eq!(
        svg.matches("h0").count(),
        2 * 5 + 1,
        "four markers and the sample have a rim, the one below the floor a hole"
    );
}

#[test]
fn a_gap_in_the_numbers_is_a_gap_in_the_line() {
    let folder = folder();
    render(folder.path()).unwrap();
    let svg = read(folder.path(), "figures/plate-elastic-energy.svg");
    assert!(!svg.contains("NaN") && !svg.contains("nan"));
    let solid = svg.split("stroke=\"#0072B2\"").skip(1).map(|rest| rest.split("/>").next().unwrap());
    let pieces: usize = solid.map(|path| path.matches('m').count()).sum();
    assert_eq!(pieces, 3, "two pieces and the sample in the legend");
    let field = read(folder.path(), "figures/plate-phase-80us.svg");
    assert!(field.contains("h9v1h-9z"), "the lower left pixel is outside the body: {field}");
}

#[test]
fn an_added_reference_is_drawn_without_further_ado() {
    let folder = changed(|results| {
        let curves = curves(&mut results.figures[0]);
        let mut points = curves[1].clone();
        points.label = "digitized points".to_string();
        points.style = CurveStyle::Points;
        curves.push(points);
    });
    render(folder.path()).unwrap();
    assert!(read(folder.path(), "figures/plate-elastic-energy.svg").contains("digitized points"));
}

#[test]
fn all_broken_figures_are_named_and_the_rest_is_written() {
    let folder = changed(|results| {
        curves(&mut results.figures[0])[0].y = "plastic_j".to_string();
        results.figures[1].id = "../outside".to_string();
        curves(&mut results.figures[2])[0].series = "series/none.csv".to_string();
    });
    let error = render(folder.path()).unwrap_err().to_string();
    for part in ["plastic_j", "time_s, elastic_j", "../outside", "series/none.csv", "3 figure(s)"] {
        assert!(error.contains(part), "{part} is missing in {error}");
    }
    assert!(read(folder.path(), "report.html").contains("could not be drawn"));
    assert!(folder.path().join("junit.xml").exists());
}

#[test]
fn curves_without_a_drawable_row_and_ragged_rasters_are_errors() {
    let folder = folder();
    fs::write(folder.path().join("series/order.csv"), "h_m,error\n0.1,-1\n0.2,nan\n").unwrap();
    fs::write(folder.path().join("series/phase.csv"), "x_m,y_m,value\n0,0,1\n").unwrap();
    let error = render(folder.path()).unwrap_err();
    let ReportError::Figures(broken) = &error else { panic!("{error}") };
    assert_eq!(broken.len(), 2, "{error}");
    assert!(error.to_string().contains("20 x 8") && error.to_string().contains("no drawable row"), "{error}");
}

#[test]
fn another_schema_is_refused() {
    let folder = changed(|results| results.schema = "fisura.results/7".to_string());
    let error = render(folder.path()).unwrap_err();
    assert!(error.to_string().contains("schema \"fisura.results/7\" is not \"fisura.results/1\""), "{error}");
    fs::write(folder.path().join("results.json"), "{\"schema\": ").unwrap();
    assert!(render(folder.path()).unwrap_err().to_string().contains("line 1 column"));
    fs::remove_file(folder.path().join("results.json")).unwrap();
    assert!(matches!(render(folder.path()).unwrap_err(), ReportError::File { .. }));
}

#[test]
fn an_empty_result_set_is_no_success() {
    let folder = changed(|results| {
        results.records.clear();
        results.figures.clear();
    });
    let rendered = render(folder.path()).unwrap();
    assert_eq!(
        fisura_reports::text::render_text(&rendered.results).trim(),
        "INFO: no check has a verdict (0 pass, 0 known limits, 0 fail, 0 errors, 0 info)"
    );
    assert!(read(folder.path(), "report.html").contains("No check has a verdict"));
}
