//! A verdict as a result of PFHub's schema, as far as it applies: class `BenchmarkResult` of
//! `pfhub_schema.yaml`, version 0.1.0 (alpha), in <https://github.com/usnistgov/pfhub-schema>.
//!
//! Names and nesting are those of that schema (a test holds them against its list). What it requires and a
//! submission does not say is left out and listed in a comment. `benchmark_problem` cannot be valid: PFHub's
//! list of problems has none of dynamic fracture.

use fisura_verification::judge::Judged;

const SCHEMA: &str = "https://github.com/usnistgov/pfhub-schema";

/// The YAML document. Texts are written as JSON strings, which YAML reads.
pub fn pfhub(judged: &Judged) -> String {
    let (verdict, text) = (&judged.verdict, |t: &str| serde_json::Value::from(t).to_string());
    let (code, cost) = (&verdict.code, &verdict.cost);
    let link = code.url.as_deref().filter(|url| url.starts_with("http"));
    let mut missing = vec!["date_created"];
    let mut body = format!(
        "id: {}\nbenchmark_problem: {}\nsummary: {}\nschema:\n  url: {}\n",
        text(&format!("urn:fisura:{}:{}", verdict.benchmark, plain(&code.name))),
        text(&format!("fisura/{}", verdict.benchmark)),
        text(&format!("{}: {}, {}", code.name, verdict.outcome.word(), verdict.sentence)),
        text(SCHEMA)
    );
    match &code.run_by {
        Some(person) => {
            let id = format!("urn:fisura:contributor:{}", plain(person));
            body += &format!("contributors:\n  - id: {}\n    name: {}\n", text(&id), text(person));
        }
        None => missing.push("contributors"),
    }
    match link {
        Some(url) => {
            body += &format!("framework:\n  - url: {}\n    name: {}\n", text(url), text(&code.name));
            let version = code.version.as_deref().filter(|v| v.starts_with(|c: char| c.is_ascii_digit()));
            body += &version.map_or(String::new(), |version| format!("    version: {}\n", text(version)));
            body += &format!("implementation:\n  url: {}\n", text(url));
            let commit = code.commit.as_deref().filter(|c| !c.contains(char::is_whitespace));
            body += &commit.map_or(String::new(), |commit| format!("  commit: {}\n", text(commit)));
        }
        None => missing.push("implementation"),
    }
    body += "results:\n  hardware:\n    architecture: cpu\n";
    let mut figure = |indent: &str, key: &'static str, value: Option<String>| match value {
        Some(value) => body += &format!("{indent}{key}: {value}\n"),
        None => missing.push(key),
    };
    figure("    ", "cores", cost.cores.map(|n| n.to_string()));
    figure("    ", "nodes", None);
    let last = judged.curves.iter().flatten().filter_map(|curve| curve.t.last().copied()).max_by(f64::total_cmp);
    figure("  ", "fictive_time", last.map(|t| format!("{t:e}")));
    figure("  ", "memory_in_kb", cost.memory_mb.map(|mb| (mb * 1e3).round().to_string()));
    figure("  ", "time_in_s", cost.wall_s.or(cost.cpu_s).map(|s| s.round().to_string()));
    format!(
        "# {} of fisura, in the form of PFHub's BenchmarkResult (schema 0.1.0); PFHub itself has no such problem.\n\
         # Required by that schema, and not stated in the submission: {}\n---\n{body}",
        verdict.benchmark,
        missing.join(", ")
    )
}

/// A name as a part of an identifier.
fn plain(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_lowercase()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use fisura_verification::judge::judge;
    use fisura_verification::reference::Library;

    use super::*;

    /// Keys of the schema by the indentation and key they stand under.
    const KEYS: [(&str, &[&str]); 7] = [
        (
            "",
            &[
                "id",
                "benchmark_problem",
                "contributors",
                "date_created",
                "framework",
                "implementation",
                "results",
                "schema",
                "summary",
            ],
        ),
        ("contributors", &["id", "name", "handle", "affiliation", "email"]),
        ("framework", &["url", "name", "commit", "download", "version"]),
        ("implementation", &["url", "name", "commit"]),
        ("schema", &["url", "name", "commit"]),
        ("results", &["hardware", "fictive_time", "memory_in_kb", "time_in_s"]),
        ("hardware", &["architecture", "cores", "nodes"]),
    ];

    #[test]
    fn every_key_stands_where_the_schema_has_it() {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data");
        let library = Library::load(&data).unwrap();
        for name in ["solidualsphysics-h2", "fisura-p2-h1", "mandal-2020-at2"] {
            let judged = judge(&data.join("submissions").join(name), &library, &data, None).unwrap();
            let yaml = pfhub(&judged);
            let mut above = [""; 3];
            for line in yaml.lines().filter(|line| !line.starts_with(['#', '-'])) {
                let key = line.trim_start_matches([' ', '-']).split(':').next().unwrap();
                let depth = line.len() - line.trim_start_matches([' ', '-']).len();
                let depth = if line.contains("- ") || depth == 4 && above[1].is_empty() { 1 } else { depth / 2 };
                let parent = if depth == 0 { "" } else { above[depth - 1] };
                let known = KEYS.iter().find(|k| k.0 == parent).unwrap_or_else(|| panic!("{parent}: {yaml}")).1;
                assert!(known.contains(&key), "{key} under {parent:?}: {yaml}");
                above[depth..].fill("");
                if line.ends_with(':') {
                    above[depth] = key;
                }
            }
            assert!(yaml.contains("not stated in the submission: date_created"), "{yaml}");
        }
    }
}
