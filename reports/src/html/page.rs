//! What the template of the page is filled with.

use fisura_verification::record::Status;
use serde::Serialize;

use crate::judge::StoredBoard;
use crate::view;

#[derive(Serialize)]
pub(super) struct Verdict {
    word: &'static str,
    /// The word as the name of a class.
    class: String,
    symbol: &'static str,
}

impl Verdict {
    pub(super) fn of(status: Status) -> Self {
        let word = view::word(status);
        Self { word, class: word.replace(' ', "-"), symbol: view::symbol(status) }
    }
}

#[derive(Serialize)]
pub(super) struct Row {
    pub anchor: String,
    pub name: String,
    pub verdict: Verdict,
    pub quantity: String,
    pub value: String,
    pub reference: Option<ReferenceCell>,
    pub bounds: String,
    pub why: String,
    pub limit: Option<LimitCell>,
    pub message: String,
}

#[derive(Serialize)]
pub(super) struct LimitCell {
    pub range: String,
    pub why: String,
}

#[derive(Serialize)]
pub(super) struct ReferenceCell {
    pub value: String,
    pub kind: &'static str,
    pub source: String,
    pub comparison: String,
}

/// A file beside the page.
#[derive(Serialize)]
pub(super) struct Link {
    /// Relative address; empty if there is none to follow.
    pub address: String,
    pub text: String,
}

#[derive(Serialize)]
pub(super) struct Parameters {
    pub run: String,
    pub text: String,
}

#[derive(Serialize)]
pub(super) struct Case {
    pub anchor: String,
    pub id: String,
    pub verdict: Verdict,
    pub claim: String,
    pub holding: String,
    pub tier: String,
    pub models: String,
    pub parameters: Vec<Parameters>,
    pub deviations: Vec<String>,
    pub series: Vec<Link>,
    pub time: String,
    pub open: bool,
    pub rows: Vec<Row>,
}

/// Orders of one case.
#[derive(Serialize)]
pub(super) struct Orders {
    pub id: String,
    pub claim: String,
    pub rows: Vec<Order>,
}

#[derive(Serialize)]
pub(super) struct Order {
    pub anchor: String,
    pub verdict: Verdict,
    pub cells: [String; 6],
}

#[derive(Serialize)]
pub(super) struct Picture {
    pub anchor: String,
    pub kind: &'static str,
    pub title: String,
    pub caption: String,
    pub deviations: Vec<String>,
    pub svg: String,
    /// Not on the page because of its size.
    pub left_out: bool,
    pub error: String,
    pub file: Link,
    pub series: Vec<Link>,
}

#[derive(Serialize)]
pub(super) struct Suite {
    pub anchor: String,
    pub name: String,
    pub counts: String,
    pub verdict: Verdict,
    pub orders: Vec<Orders>,
    pub cases: Vec<Case>,
    pub figures: Vec<Picture>,
}

#[derive(Serialize)]
pub(super) struct Source {
    pub text: String,
    pub kind: &'static str,
    pub checks: usize,
}

#[derive(Serialize)]
pub(super) struct Deviations {
    pub text: String,
    pub cases: Vec<(String, String)>,
}

#[derive(Serialize)]
pub(super) struct Page {
    pub style: String,
    pub verdict: Verdict,
    pub sentence: String,
    pub counts: String,
    pub remarks: String,
    /// What is not on the page because of its size.
    pub missing: String,
    pub environment: Vec<(&'static str, String)>,
    pub broken: Vec<Row>,
    pub limited: Vec<Row>,
    /// What a reader came for.
    pub opening: Vec<Picture>,
    pub suites: Vec<Suite>,
    pub timing: Vec<Picture>,
    /// Errors of other codes, as stored.
    pub boards: Vec<StoredBoard>,
    pub sources: Vec<Source>,
    pub deviations: Vec<Deviations>,
}
