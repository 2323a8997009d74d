//! A verdict as a result of PFHub's schema (BenchmarkResult), as far as it applies: PFHub has no such
//! benchmark.

use fisura_verification::judge::Judged;

/// The YAML document. Texts are written as JSON strings, which YAML reads.
pub fn pfhub(judged: &Judged) -> String {
    let (verdict, text) = (&judged.verdict, |t: &str| serde_json::Value::from(t).to_string());
    let code = &verdict.code;
    let link = code.url.as_deref().filter(|url| url.starts_with("http"));
    let mut out = format!(
        "# {} of fisura, in the form of PFHub's BenchmarkResult; PFHub itself has no such problem\n---\nid: {}\n\
         benchmark_problem: {}\nbenchmark_version: \"1\"\nsummary: {}\n",
        verdict.benchmark,
        text(link.unwrap_or("urn:fisura:submission")), // the schema wants an identifier
        text(&format!("fisura/{}", verdict.benchmark)),
        text(&format!("{}: {}, {}", code.name, verdict.outcome.word(), verdict.sentence))
    );
    if let Some(person) = &code.run_by {
        out += &format!("contributors:\n  - name: {}\n", text(person));
    }
    out += &format!("framework:\n  - name: {}\n", text(&code.name));
    if let Some(version) = &code.version {
        out += &format!("    version: {}\n", text(version));
    }
    out += &link.map_or(String::new(), |url| format!("    url: {}\n", text(url)));
    if let Some(commit) = &code.commit {
        out += &format!("implementation:\n  commit: {}\n", text(commit));
        out += &link.map_or(String::new(), |url| format!("  url: {}\n", text(url)));
    }
    out += "results:\n";
    let cost = &verdict.cost;
    if cost.processor.is_some() || cost.cores.is_some() {
        let architecture = cost.processor.as_deref().unwrap_or("cpu");
        out += &format!("  hardware:\n    - architecture: {}\n", text(architecture));
        out += &cost.cores.map_or(String::new(), |n| format!("      cores: {n}\n"));
    }
    out += &cost.memory_mb.map_or(String::new(), |mb| format!("  memory_in_kb: {}\n", (mb * 1e3).round()));
    out + &cost.wall_s.or(cost.cpu_s).map_or(String::new(), |s| format!("  time_in_s: {}\n", s.round()))
}
