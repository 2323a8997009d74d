//! Ids of records: `suite/case[/variant]/check`, of `[a-z0-9./=-]` and at most [`LONGEST`] characters.

/// Characters that an id has at most.
pub const LONGEST: usize = 100;

/// An id in its normal form: lower case, with a dash for every run of other characters. Earlier versions
/// wrote ids with blanks, commas and capitals; those have the normal form of the present id.
pub fn normal_id(id: &str) -> String {
    let mut out = String::new();
    for c in id.chars().flat_map(char::to_lowercase) {
        match c {
            '²' => out.push('2'),
            '°' => out.push_str("deg"),
            '%' => out.push_str("percent"),
            'a'..='z' | '0'..='9' | '.' | '/' | '=' => out.push(c),
            _ if out.is_empty() || out.ends_with(['-', '/']) => {}
            _ if c != '-' && out.ends_with('=') => {} // a sign after it is one of a number
            _ => out.push('-'),
        }
        if matches!(c, '/' | '=') && out[..out.len() - 1].ends_with('-') {
            out.remove(out.len() - 2);
        }
    }
    out.trim_end_matches('-').to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_of_earlier_versions_have_the_normal_form_of_the_present_ones() {
        let ids = [
            ("contact/hertz/h=R/48/half-width-over-r", "contact/hertz/h=r/48/half-width-over-r"),
            ("contact/incline/rolls, mu = 0.5/slip", "contact/incline/rolls-mu=0.5/slip"),
            ("contact/slope/across the mesh, 70°/loss", "contact/slope/across-the-mesh-70deg/loss"),
            ("stability/fast-impact/5 % of c/velocity", "stability/fast-impact/5-percent-of-c/velocity"),
            ("patch/a/particles_per_cell=2x2,degree=1/b", "patch/a/particles-per-cell=2x2-degree=1/b"),
            ("contact/onset/origin=-0.017x-0.023/gap", "contact/onset/origin=-0.017x-0.023/gap"),
            ("patch/a/p=2, half (fine)/b", "patch/a/p=2-half-fine/b"),
        ];
        for (old, present) in ids {
            assert_eq!(normal_id(old), present);
            assert_eq!(normal_id(present), present);
        }
    }
}
