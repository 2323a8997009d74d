//! The verdict for a terminal.

use fisura_verification::record::ResultSet;

use crate::template::{filled, summary};

/// A plain-text table: what does not hold with value, bounds and reason, one line per suite with known
/// limits, counts per suite, the status of the whole in the last line.
pub fn render_text(set: &ResultSet) -> String {
    filled("text.txt", include_str!("../templates/text.txt"), summary(set))
}
