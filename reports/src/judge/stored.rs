//! The board of the gallery: what `judge --board` drew of the submissions of this repository, for the report
//! and the book. A test of the command holds the gallery against the submissions.

use serde::Serialize;

/// One quantity of the stored board.
#[derive(Debug, Clone, Serialize)]
pub struct StoredBoard {
    /// Title of the drawing: the quantity in words.
    pub title: &'static str,
    /// File of the drawing in the gallery.
    pub file: &'static str,
    /// The drawing as the text of an SVG file.
    pub svg: &'static str,
    /// What the numbers say.
    pub sentence: &'static str,
}

const TEXT: &str = include_str!("../../gallery/judge/board.md");
const DRAWINGS: [(&str, &str); 3] = [
    ("board-kinetic.svg", include_str!("../../gallery/judge/board-kinetic.svg")),
    ("board-elastic.svg", include_str!("../../gallery/judge/board-elastic.svg")),
    ("board-fracture.svg", include_str!("../../gallery/judge/board-fracture.svg")),
];

/// The quantities that have a drawing.
pub fn stored_boards() -> Vec<StoredBoard> {
    let sections = TEXT.split("\n## ").skip(1);
    let board = |section: &'static str| {
        let mut lines = section.lines().filter(|line| !line.is_empty());
        let title = lines.next()?;
        let (file, svg) = *DRAWINGS.iter().find(|(file, _)| section.contains(&format!("({file})")))?;
        let sentence = lines.find(|line| !line.starts_with('!'))?;
        Some(StoredBoard { title, file, svg, sentence })
    };
    sections.filter_map(board).collect()
}

/// The same for the book: title, drawing (among the figures of the book) and sentence.
pub fn board_of_the_book() -> String {
    let part = |b: StoredBoard| {
        let (title, file) = (b.title, format!("figures/{}", b.file));
        format!("### {title}\n\n[![{title}]({file})]({file})\n\n{}\n", b.sentence)
    };
    let parts: Vec<String> = stored_boards().into_iter().map(part).collect();
    parts.join("\n") + "\nVerdicts, errors and uncertainties as tables: [gallery](../../gallery/judge/board.md).\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_drawing_has_its_title_and_sentence() {
        let boards = stored_boards();
        assert_eq!(boards.len(), DRAWINGS.len());
        assert!(boards.iter().all(|b| b.svg.contains("<svg") && b.sentence.starts_with("Of ") && !b.title.is_empty()));
    }
}
