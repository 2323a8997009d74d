//! What the judge says of planted errors: `judged.json`, `judged.md`, and the same on the terminal.

use std::collections::BTreeSet;
use std::fmt::Write;

use fisura_reports::number::plain;
use fisura_verification::judge::effect::Effect;
use fisura_verification::judge::verdict::Outcome;
use fisura_verification::output::{OutputError, OutputFolder};
use serde::Serialize;

use super::Row;

const HEAD: &str = "# Planted errors judged from CSV alone

`cargo xtask faults --judge` runs the plate with each planted error whose sites it passes, writes the history as CSV and judges it
like a result of anybody. The effect of an error is the distance of a curve from that of the sound run on the same mesh, in the norm
of the judge; the table shows the quantity and phase where it is largest in terms of the validation uncertainty U_val. *Visible* is an
effect above U_val. Above 2 U_val, no sound result can be moved and still be accepted; in between, it depends on the direction.
";

/// All rows.
#[derive(Debug, Default, Serialize)]
pub struct Report {
    /// Plate, its case, and the verdict on it without an error.
    pub sound: Vec<(&'static str, &'static str, Outcome)>,
    /// Errors in plates.
    pub rows: Vec<Row>,
    /// Errors whose sites a plate passes.
    #[serde(skip)]
    pub passed: BTreeSet<String>,
}

impl Report {
    /// Whether an error changed the curves of a plate and none rejected it.
    pub fn is_accepted(&self, fault: &str) -> bool {
        let mut rows = self.rows.iter().filter(|row| row.fault == fault && row.changed).peekable();
        rows.peek().is_some() && rows.all(|row| !row.rejected)
    }

    /// Visible errors that are accepted on every plate they were tried on.
    fn lacking(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.visible && self.is_accepted(row.fault))
    }

    /// Whether a visible error is accepted, or a sound plate is not.
    pub fn lacks(&self) -> bool {
        self.lacking().next().is_some() || self.sound.iter().any(|sound| sound.2 != Outcome::Pass)
    }

    /// Writes `judged.json` and `judged.md`.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &OutputFolder) -> Result<(), OutputError> {
        folder.write_json("judged.json", self)?;
        folder.write("judged.md", self.markdown())?;
        folder.finish()
    }

    /// One line per error, and the counts.
    pub fn text(&self) -> String {
        let width = self.rows.iter().map(|row| row.fault.len()).max().unwrap_or(0);
        let mut out = String::new();
        for row in self.rows.iter().filter(|row| row.changed || !row.verdict.is_empty()) {
            let seen = if row.visible { "visible" } else { "" };
            let _ = writeln!(out, "{:width$}  {seen:7}  {}  {}", row.fault, row.word(), row.effect_words());
        }
        for (plate, _, outcome) in &self.sound {
            let _ = writeln!(out, "{plate}, no fault: {}", outcome.word());
        }
        out + &self.count() + "\n"
    }

    fn count(&self) -> String {
        let faults = |is: &dyn Fn(&Row) -> bool| {
            self.rows.iter().filter(|row| is(row)).map(|row| row.fault).collect::<BTreeSet<_>>()
        };
        let (all, changed) = (faults(&|_| true), faults(&|row| row.changed));
        let (visible, rejected) = (faults(&|row| row.visible), faults(&|row| row.rejected));
        format!(
            "{} errors have sites that a plate passes; {} change the curves, {} visibly; {} of these and {} others are rejected",
            all.len(),
            changed.len(),
            visible.len(),
            visible.intersection(&rejected).count(),
            rejected.difference(&visible).count()
        )
    }

    fn markdown(&self) -> String {
        let mut out = String::from(HEAD);
        let _ = writeln!(out, "\n{}.", self.count());
        for (plate, case, outcome) in &self.sound {
            let _ = writeln!(
                out,
                "\n## {plate}\n\nCase `{case}`; without an error: {}.\n\n\
                 | error | what is wrong | largest effect | U_val | visible | verdict |\n|---|---|---|---|---|---|",
                outcome.word()
            );
            let here = || self.rows.iter().filter(|row| row.plate == *plate);
            for row in here().filter(|row| row.changed || row.verdict.starts_with("no result")) {
                let (size, u_val) = row.effect.as_ref().map_or_else(Default::default, figures);
                let size = row.effect.as_ref().map_or(size.clone(), |effect| format!("{size}, {}", effect.what));
                let seen = if row.visible { "yes" } else { "no" };
                let _ = writeln!(out, "| {} | {} | {size} | {u_val} | {seen} | {} |", row.fault, row.what, row.word());
            }
            let same: Vec<&str> = here()
                .filter(|row| !row.changed && row.effect.is_none() && !row.verdict.starts_with("no result"))
                .map(|row| row.fault)
                .collect();
            if !same.is_empty() {
                let _ = writeln!(out, "\nThe curves do not change at all with: {}.", same.join(", "));
            }
        }
        for row in self.lacking() {
            let _ = writeln!(out, "\n**{} is visible ({}) and is not rejected.**", row.fault, row.plate);
        }
        out
    }
}

impl Row {
    /// The verdict, with what was recognised.
    fn word(&self) -> String {
        let known: Vec<String> =
            self.findings.iter().filter(|f| *f != "unexplained").map(|f| format!("`{f}`")).collect();
        let accepted = self.visible && !self.rejected;
        let verdict = if accepted { format!("**{}**", self.verdict) } else { self.verdict.clone() };
        if known.is_empty() { verdict } else { format!("{verdict}, {}", known.join(", ")) }
    }

    fn effect_words(&self) -> String {
        self.effect.as_ref().map_or_else(String::new, |effect| {
            let (size, u_val) = figures(effect);
            format!("{}: {size}, U_val {u_val}", effect.what)
        })
    }
}

/// Effect and uncertainty in units of people.
fn figures(effect: &Effect) -> (String, String) {
    let (scale, unit) = match effect.unit.as_str() {
        "1" => (100.0, "%"),
        "s" => (1e6, "µs"),
        "m" => (1e3, "mm"),
        other => (1.0, other),
    };
    let show = |value: f64| format!("{} {unit}", plain(scale * value, 3));
    (effect.size.map_or_else(|| "ends early, or does not happen".to_string(), show), show(effect.u_val))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(plate: &'static str, size: f64, rejected: bool) -> Row {
        let effect = Effect { what: "elastic energy, whole".into(), unit: "1".into(), size: Some(size), u_val: 0.1 };
        Row {
            plate,
            fault: "sign",
            what: "a sign",
            changed: true,
            visible: effect.is_visible(),
            effect: Some(effect),
            verdict: if rejected { "fail" } else { "pass" }.into(),
            rejected,
            findings: vec!["unexplained".into()],
        }
    }

    #[test]
    fn an_error_that_is_visible_has_to_be_rejected_on_some_plate() {
        let sound = vec![("coarse", "plate/a", Outcome::Pass), ("fine", "plate/b", Outcome::Pass)];
        let report = |rows| Report { sound: sound.clone(), rows, passed: BTreeSet::new() };
        let accepted = report(vec![row("coarse", 0.15, false)]);
        assert!(accepted.lacks() && accepted.is_accepted("sign"));
        let markdown = accepted.markdown();
        assert!(
            markdown.contains("| sign | a sign | 15 %, elastic energy, whole | 10 % | yes | **pass** |"),
            "{markdown}"
        );
        assert!(markdown.contains("**sign is visible (coarse) and is not rejected.**"), "{markdown}");
        let rejected = report(vec![row("coarse", 0.15, false), row("fine", 0.3, true)]);
        assert!(!rejected.lacks() && rejected.text().contains("1 change the curves, 1 visibly; 1 of these"));
        assert!(!report(vec![row("coarse", 0.05, false)]).lacks(), "what cannot be seen need not be rejected");
    }
}
