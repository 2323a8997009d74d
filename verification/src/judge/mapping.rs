//! Columns of files mapped to quantities: `[curves]` of `submission.toml`.

use super::QUANTITIES;
use crate::output::foreign;
use crate::scene::fields::{Fields, Item};
use crate::scene::units::{self, Dimension};
use crate::scene::{Location, Value};

/// Where a column stands.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnName {
    /// By its name in the header.
    Named(String),
    /// By its number, from 1.
    Numbered(usize),
    /// By the first of these names that is in the header, if one is.
    AnyOf(&'static [&'static str]),
}

/// A column mapped to a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// Key path, for messages.
    pub key: String,
    /// Where it stands in the file, for messages.
    pub location: Option<Location>,
    /// File, relative to the folder.
    pub file: String,
    /// Column of the file, by name or by number.
    pub column: ColumnName,
    /// SI over the unit of the column, with the factor and the thickness.
    pub scale: f64,
    /// Added after scaling, SI.
    pub offset: f64,
    /// Factor alone, as declared.
    pub factor: f64,
    /// The value that stands for none.
    pub missing: Option<f64>,
    /// Whether the fracture energy is said to be an increment.
    pub increment: bool,
}

/// Column of the time, and columns by quantity.
type Curves = (Option<Mapping>, [Option<Mapping>; 6]);

/// Names of energies in files of postprocessors of MOOSE: those of its users, raccoon among them.
const OF_MOOSE: [(&str, &[&str]); 4] = [
    ("kinetic", &["kinetic_energy", "KE"]),
    ("elastic", &["strain_energy", "elastic_energy", "SE"]),
    ("work", &["external_work", "EW"]),
    ("fracture", &["fracture_energy", "FE"]),
];

/// Reads `[curves]`; energies in J are divided by the thickness.
pub(super) fn curves(item: &Item<'_>, thickness: Option<f64>) -> Option<Curves> {
    let quantities = QUANTITIES.iter().map(|q| q.key);
    let known: Vec<&str> =
        ["time", "format", "file", "time_unit", "energy_unit"].into_iter().chain(quantities).collect();
    let fields = item.fields(&known)?;
    if fields.get("format").is_some() {
        return of_moose(&fields, thickness);
    }
    if let Some(given) = ["file", "time_unit", "energy_unit"].iter().find_map(|key| fields.get(key)) {
        return given.fail("this key belongs to a format", "add format = \"moose\", or give it with every curve");
    }
    let time = fields.need("time", "time = { column = \"t\", unit = \"us\" }", |item| mapping(item, "time", None));
    Some((Some(time?), QUANTITIES.map(|q| fields.maybe(q.key, |item| mapping(item, q.key, thickness)))))
}

fn mapping(item: &Item<'_>, key: &str, thickness: Option<f64>) -> Option<Mapping> {
    let mut known = vec!["column", "unit", "factor", "offset"];
    known.extend((key != "time").then_some("file"));
    known.extend(key.starts_with("tip").then_some("missing"));
    known.extend((key == "fracture").then_some("form"));
    let fields = item.fields(&known)?;
    let file =
        if key == "time" { Some(String::new()) } else { fields.need("file", "file = \"energies.csv\"", file_name) };
    let column = fields.need("column", "column = \"name\", or its number from 1", |item| match &item.node.value {
        Value::Integer(_) => item.whole(1, 10_000).map(ColumnName::Numbered),
        _ => item.words().map(ColumnName::Named),
    });
    let unit = fields.need("unit", "unit = \"us\", \"J/m\", \"mJ/mm\", \"mm\", …", |item| unit(item, key, thickness));
    let factor = fields.or("factor", 1.0, |item| item.quantity(Dimension::NONE));
    let offset = fields.or("offset", 0.0, |item| item.quantity(Dimension::NONE));
    let missing = fields.maybe("missing", |item| item.quantity(Dimension::NONE));
    let increment = fields.or("form", false, |item| item.choice(&[("absolute", false), ("increment", true)]));
    let unit = unit?;
    Some(Mapping {
        key: item.path.clone(),
        location: item.node.location.clone(),
        file: file?,
        column: column?,
        scale: unit * factor,
        offset: offset * unit,
        factor,
        missing,
        increment,
    })
}

/// Curves from a file of postprocessors, which has no units; single curves may be given beside it.
fn of_moose(fields: &Fields<'_>, thickness: Option<f64>) -> Option<Curves> {
    fields.need("format", "format = \"moose\"", |item| item.choice(&[("moose", ())]))?;
    let file = fields.need("file", "file = \"out.csv\"", file_name);
    let seconds = fields.need("time_unit", "time_unit = \"us\"", |item| unit(item, "time", None));
    let joules = fields
        .need("energy_unit", "energy_unit = \"N\" (mJ per mm), or \"J/m\"", |item| unit(item, "kinetic", thickness));
    let (file, seconds, joules) = (file?, seconds?, joules?);
    let place = fields.get("file")?;
    let column = |names: &'static [&'static str], scale: f64| Mapping {
        key: place.path.clone(),
        location: place.node.location.clone(),
        file: file.clone(),
        column: ColumnName::AnyOf(names),
        scale,
        offset: 0.0,
        factor: 1.0,
        missing: None,
        increment: false,
    };
    let curve = |q: super::Quantity| {
        let given = fields.maybe(q.key, |item| mapping(item, q.key, thickness));
        let found = OF_MOOSE.iter().find(|(key, _)| *key == q.key);
        given.or_else(|| found.map(|(_, names)| column(names, joules)))
    };
    Some((Some(column(&["time"], seconds)), QUANTITIES.map(curve)))
}

/// A file in the folder of the submission.
fn file_name(item: &Item<'_>) -> Option<String> {
    let name = item.words()?;
    if foreign::is_plain(&name) {
        return Some(name);
    }
    item.fail("it leads out of the folder", "name a file in the folder of submission.toml")
}

/// SI over the unit: an energy per metre of thickness, or an energy over the thickness.
fn unit(item: &Item<'_>, key: &str, thickness: Option<f64>) -> Option<f64> {
    let text = item.words()?;
    let dimension = match key {
        "time" => Dimension::TIME,
        "tip_x" | "tip_y" => Dimension::LENGTH,
        _ => Dimension::FORCE,
    };
    let read = match units::parse(&format!("1 {text}")) {
        Ok(read) => read,
        Err(error) => return item.fail(error.message, error.remedy),
    };
    if read.dimension == dimension {
        return Some(read.value);
    }
    if dimension == Dimension::FORCE && read.dimension == Dimension::ENERGY {
        let Some(thickness) = thickness else {
            let remedy = "add thickness = \"1 m\" to [model], or give the unit \"J/m\" if the energy is per thickness";
            return item.fail("an energy needs the thickness that it belongs to", remedy);
        };
        return Some(read.value / thickness);
    }
    let (found, wanted) = (read.dimension.name(), ["a time such as \"us\"", "a length such as \"mm\""]);
    let wanted = match key {
        "time" => wanted[0],
        "tip_x" | "tip_y" => wanted[1],
        _ => "an energy per thickness such as \"J/m\", or an energy such as \"mJ\"",
    };
    item.fail(format!("{text:?} is {found}"), format!("give {wanted}"))
}
