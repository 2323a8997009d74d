//! Documents from templates of minijinja. What a value must not do in a document depends on its kind, which
//! the ending of its name tells.

use fisura_verification::output::foreign::line;
use fisura_verification::record::{Record, ResultSet, Status};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, UndefinedBehavior, Value, context, escape_formatter};

use crate::markdown::{cell, code};
use crate::number::{duration, plain};
use crate::rates::Show;
use crate::style::wrap_columns;
use crate::svg::slug;
use crate::view::{self, Counts};

/// Fills the template of a document. Values of `.html` are escaped, those of `.md` are text of a cell, and
/// those of `.txt` stay on their line and do not steer a terminal; a value that is marked as safe stays as it
/// is. Filters beside those of minijinja: `plain(digits, scale)`, `duration`, `pad(width)`, `wrap(columns)`
/// and `code`.
///
/// # Errors
/// A template that is not valid, or that asks for a value that it is not given.
pub fn fill(name: &str, template: &str, values: impl Into<Value>) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    let mut syntax = SyntaxConfig::builder();
    syntax.trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(!name.ends_with(".html"));
    environment.set_syntax(syntax.build()?);
    environment.set_undefined_behavior(UndefinedBehavior::SemiStrict);
    environment.set_auto_escape_callback(|name| match name.rsplit_once('.') {
        Some((_, "html")) => AutoEscape::Html,
        Some((_, "md")) => AutoEscape::Custom("md".into()),
        _ => AutoEscape::Custom("txt".into()),
    });
    environment.set_formatter(|out, state, value| match (state.auto_escape(), value.as_str()) {
        (AutoEscape::Custom(_), Some(text)) if value.is_safe() => Ok(out.write_str(text)?),
        (AutoEscape::Custom(kind), Some(text)) if kind == "md" => Ok(out.write_str(&cell(text))?),
        (AutoEscape::Custom(_), Some(text)) => Ok(out.write_str(&line(text))?),
        (AutoEscape::Custom(_), None) => Ok(write!(out, "{value}")?),
        _ => escape_formatter(out, state, value),
    });
    environment.add_filter("plain", |value: f64, digits: usize, scale: Option<f64>| {
        plain(value * scale.unwrap_or(1.0), digits)
    });
    environment.add_filter("duration", duration);
    environment.add_filter("pad", |text: String, width: usize| format!("{text:width$}"));
    environment.add_filter("wrap", |text: String, columns: usize| wrap_columns(&text, columns));
    environment.add_filter("code", |id: String| Value::from_safe_string(code(&id)));
    environment.render_named_str(name, template, values)
}

/// Fills a template that is given all it asks for, as a test of its document shows.
///
/// # Panics
/// If it is not.
pub fn filled(name: &str, template: &str, values: impl Into<Value>) -> String {
    fill(name, template, values).unwrap_or_else(|error| panic!("{error:#}"))
}

/// Results as all reports tell them: verdict, where they were run, what does not hold, counts by suite.
pub(crate) fn summary(set: &ResultSet) -> Value {
    let counts = Counts::of(&set.records);
    let suite = |(name, records): (&str, Vec<&Record>)| {
        context! { name, records => records.len(), counts => Serde(Counts::of(records)) }
    };
    context! {
        verdict => verdict(counts.verdict()),
        sentence => counts.sentence(),
        counts => counts.list(),
        remarks => counts.remarks(),
        environment => Serde(view::environment(set)),
        broken => view::broken(set).into_iter().map(|r| row(r, &r.id, plain)).collect::<Value>(),
        suites => view::by_suite(set).into_iter().map(suite).collect::<Value>(),
    }
}

/// A status: its word, also as the name of a class, and its symbol.
pub(crate) fn verdict(status: Status) -> Value {
    let word = view::word(status);
    context! { word, class => word.replace(' ', "-"), symbol => view::symbol(status) }
}

/// A record under a name, its numbers as `show` writes them.
pub(crate) fn row(record: &Record, name: &str, show: Show) -> Value {
    let reference = record.reference.as_ref().map(|r| {
        context! {
            value => view::reference_value(r, &record.unit, show),
            kind => view::kind(r),
            source => &r.source,
            comparison => view::comparison(record, show).unwrap_or_default(),
        }
    });
    let limit = view::limit(record, show).zip(record.limit.as_ref());
    let reason = view::reason(record);
    context! {
        anchor => format!("check-{}", slug(&record.id)),
        id => &record.id,
        name,
        verdict => verdict(record.status),
        claim => &record.claim,
        quantity => &record.quantity,
        value => view::value(record, show),
        reference,
        bounds => view::accepted(record, show),
        why => &record.accept.why,
        limit => limit.map(|(range, limit)| context! { range, why => &limit.why }),
        message => record.message.as_deref().unwrap_or_default(),
        explained => format!("{}. {reason}", record.claim.trim_end_matches('.')),
        reason,
    }
}
