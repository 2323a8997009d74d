//! The nearest known word to a mistyped one.

/// The candidate with the smallest edit distance to `word`, if it is close enough to be meant; letters of the
/// wrong case count nothing, two neighbours swapped count one.
pub fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let word: String = word.chars().take(64).flat_map(char::to_lowercase).collect();
    let limit = word.chars().count().max(3) / 3;
    let near = candidates.iter().map(|known| (strsim::osa_distance(&word, &known.to_lowercase()), *known));
    near.filter(|(distance, _)| *distance <= limit).min_by_key(|(distance, _)| *distance).map(|(_, known)| known)
}

/// `did you mean "density"? `, or nothing.
pub fn hint(word: &str, candidates: &[&str]) -> String {
    nearest(word, candidates).map_or(String::new(), |near| format!("did you mean {near:?}? "))
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_slip_of_the_finger_finds_its_word() {
        let words = ["density", "poisson_ratio", "young_modulus"];
        assert_eq!(nearest("densty", &words), Some("density"));
        assert_eq!(nearest("Density", &words), Some("density"));
        assert_eq!(nearest("youngs_modulus", &words), Some("young_modulus"));
        assert_eq!(nearest("colour", &words), None);
        assert_eq!(nearest("", &words), None);
    }
}
