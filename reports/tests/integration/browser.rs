//! The page in a headless browser, where one is installed: nothing is wider than the window, everything is on
//! the page.

use std::path::Path;
use std::process::Command;

use crate::support::{folder, read, render};

/// Added to a copy of the page, as the page itself has no script: what the browser made of it.
const PROBE: &str = "<script>document.title = [document.documentElement.scrollWidth, innerWidth, \
                     document.querySelectorAll('figure svg').length, \
                     getComputedStyle(document.body).backgroundColor].join(';')</script></body>";

fn browser() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))
}

/// Scroll width, window width, number of drawings, background.
fn probe(browser: &str, page: &Path, width: u32, scheme: u32) -> Vec<String> {
    let output = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom"])
        .arg(format!("--window-size={width},900"))
        .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
        .arg(format!("--user-data-dir={}", page.with_extension("profile").display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .expect("the browser starts");
    let dom = String::from_utf8_lossy(&output.stdout);
    let title = dom.split("<title>").nth(1).and_then(|t| t.split("</title>").next()).unwrap_or_default();
    title.split(';').map(String::from).collect()
}

#[test]
fn the_page_fits_wide_and_narrow_windows_in_light_and_dark() {
    let Some(browser) = browser() else {
        eprintln!("no browser is installed: the page is not opened");
        return;
    };
    let folder = folder();
    render(folder.path()).unwrap();
    let page = read(folder.path(), "report.html");
    let copy = folder.path().join("probe.html");
    std::fs::write(&copy, page.replace("</body>", PROBE)).unwrap();
    let mut backgrounds = Vec::new();
    for (width, scheme) in [(1400, 1), (500, 0)] {
        let found = probe(browser, &copy, width, scheme);
        let numbers: Vec<u32> = found.iter().take(3).filter_map(|n| n.parse().ok()).collect();
        let [scroll, window, drawings] = numbers[..] else { panic!("the browser says {found:?}") };
        assert!(scroll <= window, "{width} px: the page is {scroll} wide in a window of {window}");
        assert_eq!(drawings, 3 + 3, "all figures and the board are on the page");
        backgrounds.push(found[3].clone());
    }
    assert_ne!(backgrounds[0], backgrounds[1], "light and dark");
}
