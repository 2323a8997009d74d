//! Drawings as parts of the page: their looks stand once in the style of the page, and what the caption says
//! stands there alone.
//!
//! A drawing in a file of its own carries every attribute with every element, and a description for those who
//! cannot see it. On a page of hundreds of drawings that is most of its bytes.

use std::collections::HashMap;
use std::fmt::Write;

use super::Drawings;

/// Attributes that a style sheet can say as well.
const LOOKS: [&str; 9] = [
    "fill",
    "stroke",
    "stroke-width",
    "stroke-linecap",
    "stroke-dasharray",
    "paint-order",
    "opacity",
    "font-size",
    "text-anchor",
];

/// Drawings for the page, and the rules that they need in its style.
pub(super) fn embedded(drawings: &Drawings) -> (Drawings, String) {
    let mut classes = Classes::default();
    let mut shorter = |svg: &String| classes.shorten(svg);
    let drawings = drawings.iter();
    let drawings =
        drawings.map(|(id, svg)| (id.clone(), svg.as_ref().map(&mut shorter).map_err(String::clone))).collect();
    (drawings, classes.rules)
}

/// Looks that were met, by the attributes that they stand for.
#[derive(Default)]
struct Classes {
    names: HashMap<String, String>,
    rules: String,
}

impl Classes {
    /// A drawing without what the page says once.
    fn shorten(&mut self, svg: &str) -> String {
        let mut out = String::with_capacity(svg.len());
        let mut rest = svg;
        while let Some((text, tag)) = rest.split_once('<') {
            let Some((tag, after)) = tag.split_once('>') else { break };
            out.push_str(text);
            rest = after;
            if tag.starts_with("desc") {
                rest = after.split_once("</desc>").map_or(after, |(_, after)| after.trim_start_matches('\n'));
            } else {
                self.tag(tag, &mut out);
            }
        }
        out + rest
    }

    fn tag(&mut self, tag: &str, out: &mut String) {
        out.push('<');
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        out.push_str(name);
        let end = if attributes.ends_with('/') { "/>" } else { ">" };
        let mut look = String::new();
        for (key, value) in pairs(attributes) {
            match key {
                "xmlns" | "font-family" | "stroke-linejoin" => {}
                _ if LOOKS.contains(&key) && name != "svg" => {
                    let unit = if key == "font-size" { "px" } else { "" };
                    let _ = write!(look, "{key}:{value}{unit};");
                }
                "aria-labelledby" => {
                    let title = value.split(' ').next().unwrap_or_default();
                    let _ = write!(out, " {key}=\"{title}\"");
                }
                _ => {
                    let _ = write!(out, " {key}=\"{value}\"");
                }
            }
        }
        if !look.is_empty() {
            let _ = write!(out, " class=\"{}\"", self.class(look));
        }
        out.push_str(end);
    }

    fn class(&mut self, look: String) -> &str {
        let next = format!("q{}", self.names.len());
        self.names.entry(look).or_insert_with_key(|look| {
            let _ = writeln!(self.rules, "svg .{next}{{{}}}", look.trim_end_matches(';'));
            next
        })
    }
}

/// Keys and values of attributes `key="value" …`.
fn pairs(attributes: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut rest = attributes;
    std::iter::from_fn(move || {
        let (key, after) = rest.split_once("=\"")?;
        let (value, after) = after.split_once('"')?;
        rest = after;
        Some((key.trim_start(), value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_stand_once_and_what_the_caption_says_goes() {
        let svg = "<svg role=\"img\" aria-labelledby=\"a-title a-desc\" font-size=\"9\">\n<title id=\"a-title\">A</title>\n\
                   <desc id=\"a-desc\">Said &lt;below&gt;</desc>\n<circle cx=\"1\" r=\"2\" fill=\"#fff\" stroke-width=\"1\"/>\
                   <circle cx=\"3\" r=\"2\" fill=\"#fff\" stroke-width=\"1\"/><text font-size=\"12\">B</text></svg>\n";
        let drawings =
            Drawings::from([("a".to_string(), Ok(svg.to_string())), ("b".to_string(), Err("none".to_string()))]);
        let (short, rules) = embedded(&drawings);
        assert_eq!(
            short["a"],
            Ok("<svg role=\"img\" aria-labelledby=\"a-title\" font-size=\"9\">\n<title id=\"a-title\">A</title>\n\
                <circle cx=\"1\" r=\"2\" class=\"q0\"/><circle cx=\"3\" r=\"2\" class=\"q0\"/><text class=\"q1\">B</text></svg>\n"
                .to_string())
        );
        assert_eq!(rules, "svg .q0{fill:#fff;stroke-width:1}\nsvg .q1{font-size:12px}\n");
        assert_eq!(short["b"], Err("none".to_string()));
    }
}
