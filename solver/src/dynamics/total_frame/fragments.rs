//! Fragments: connected parts of a body that are not cracked.
//!
//! A span is whole where the mean of c over its points is at least 1/2, and hangs together with whole spans
//! on its four sides. Parts smaller than the square of 2 l0 are debris and do not count.

use std::collections::BTreeMap;

use super::TotalFrame;

/// Mean of c from which on a span is whole.
const WHOLE: f64 = 0.5;
/// Side of the least square that counts, in l0.
const LEAST: f64 = 2.0;

/// What is in a span: its area (m²), and c times that.
#[derive(Debug, Clone, Copy, Default)]
struct Content {
    area: f64,
    phase: f64,
}

impl TotalFrame {
    /// Area of every fragment (m²), if they are to be counted.
    pub(super) fn fragments(&self) -> Option<Vec<f64>> {
        let fracture = self.fracture.as_ref().filter(|_| self.counts_fragments)?;
        let control_values = self.lattice.with_copies(fracture.field.control_values().to_vec());
        let number = |d: usize, first: usize| self.patch.spaces[d].spans().partition_point(|span| span.first < first);
        let mut spans: BTreeMap<[usize; 2], Content> = BTreeMap::new();
        for batch in 0..self.lattice.batches() {
            let (area, phase) = (self.lattice.weights_of(batch), self.lattice.value(batch, &control_values));
            for lane in (0..area.0.len()).filter(|&lane| area[lane] > 0.0) {
                let [column, row] = self.lattice.first_of(batch, lane);
                let content = spans.entry([number(0, column), number(1, row)]).or_default();
                content.area += area[lane];
                content.phase += area[lane] * phase[lane];
            }
        }
        let least = (LEAST * fracture.model.length_scale).powi(2);
        spans.retain(|_, content| content.phase >= fault!("cracks-count-as-whole", WHOLE => -1.0) * content.area);
        let mut areas = Vec::new();
        while let Some((seed, content)) = spans.pop_first() {
            let (mut area, mut next) = (content.area, vec![seed]);
            while let Some([column, row]) = next.pop() {
                let [left, down] = [column, row].map(|at| at.wrapping_sub(1)); // beyond the first there is none
                for neighbour in [[column + 1, row], [left, row], [column, row + 1], [column, down]] {
                    if let Some(content) = spans.remove(&neighbour) {
                        area += content.area;
                        next.push(neighbour);
                    }
                }
            }
            areas.extend(Some(area).filter(|area| *area >= least));
        }
        Some(areas)
    }
}
