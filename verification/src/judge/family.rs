//! The plate and its variants: which reference is nearest to what a submission declares, and how it differs.

use std::path::Path;

use super::model::{Crack, Model, Plane};
use super::{FRACTURE, QUANTITIES};
use crate::output::history::{Table, TableError};
use crate::reference::{Library, ReferenceCurve};

/// Folder of the variants in the reference data.
const FOLDER: &str = "plate-family";
/// Loads within this part of that of a reference are judged against it; the energies then differ by twice
/// as much.
const SAME_LOAD: f64 = 0.02;
/// l0 of the benchmark, m.
pub const LENGTH_SCALE: f64 = 0.25e-3;
/// End of the simulated time of the benchmark, s.
pub const END: f64 = 80e-6;
/// Start of what is compared, s: before, the front of the waves is as steep as the mesh.
const START: f64 = 5e-6;
/// Start of the comparison of fracture increments over the whole curve, s.
const FRACTURE_START: f64 = 30e-6;

/// A declared member of the family.
#[derive(Debug, Clone, Copy)]
pub struct Declared {
    /// Variant in the reference data.
    pub name: &'static str,
    /// Plane state, strain or stress.
    pub plane: Plane,
    /// Whether the crack is a slit.
    pub slit: bool,
    /// Traction on each loaded edge, Pa.
    pub traction: f64,
}

/// Members of the family that have a reference.
pub const FAMILY: [Declared; 5] = [
    Declared { name: "plane-strain", plane: Plane::Strain, slit: false, traction: 1e6 },
    Declared { name: "plane-stress", plane: Plane::Stress, slit: false, traction: 1e6 },
    Declared { name: "low-traction", plane: Plane::Strain, slit: false, traction: 0.5e6 },
    Declared { name: "slit", plane: Plane::Strain, slit: true, traction: 1e6 },
    Declared { name: "slit-plane-stress", plane: Plane::Stress, slit: true, traction: 0.98673e6 },
];

/// The reference of a submission.
#[derive(Debug, Clone)]
pub struct Variant<'a> {
    /// Id of the reference curves in the library, such as `plate-family/slit`.
    pub id: String,
    /// Its text in legends.
    pub label: String,
    /// Where its uncertainty comes from.
    pub uncertainty: String,
    /// Model of the reference; that of the first of [`FAMILY`] if the reference is not in the family.
    pub declared: Declared,
    /// Curves by quantity.
    pub curves: [Option<&'a ReferenceCurve>; 6],
    /// Time at which the crack starts, s.
    pub onset: f64,
    /// Time at which the crack branches, s; absent where it does not.
    pub branching: Option<f64>,
    /// What was assumed to find it.
    pub notes: Vec<String>,
}

type Missing = (String, String);

impl<'a> Variant<'a> {
    /// The variant nearest to a model: same plane state and kind of crack, then the load.
    ///
    /// # Errors
    /// Reference data without it.
    pub fn nearest(library: &'a Library, model: &Model) -> Result<Self, Missing> {
        let slit = model.crack == Crack::Slit;
        let far = |d: &Declared| {
            let plane = model.plane != Plane::Unknown && d.plane != model.plane;
            let load = (model.traction.unwrap_or(1e6) / d.traction).ln().abs();
            (u8::from(plane), u8::from(load > 0.2), u8::from(d.slit != slit), (load * 1e6) as u64)
        };
        let declared = FAMILY.into_iter().min_by_key(far).unwrap_or(FAMILY[0]);
        let mut variant = Self::of(library, &format!("{FOLDER}/{}", declared.name), "plate-family", declared)?;
        let unknown = [
            (model.plane == Plane::Unknown, "the plane state is unknown; plane strain is assumed"),
            (model.traction.is_none(), "the traction is unknown; 1 MPa is assumed"),
            (model.crack == Crack::Unknown, "how the crack was made is unknown; a seeded crack is assumed"),
            (model.split == "unknown", "the split is unknown; the spectral one is assumed"),
        ];
        variant.notes.extend(unknown.iter().filter(|u| u.0).map(|u| u.1.to_string()));
        Ok(variant)
    }

    /// The reference of that id: of the family, or the curves `plate/…` of another folder in plane strain.
    ///
    /// # Errors
    /// Reference data without it.
    pub fn named(library: &'a Library, id: &str) -> Result<Self, Missing> {
        let of_family = FAMILY.into_iter().find(|d| id == format!("{FOLDER}/{}", d.name) || id == d.name);
        match of_family {
            Some(declared) => Self::of(library, &format!("{FOLDER}/{}", declared.name), "plate-family", declared),
            None => Self::of(library, id, "plate", FAMILY[0]),
        }
    }

    fn of(library: &'a Library, id: &str, prefix: &str, declared: Declared) -> Result<Self, Missing> {
        let curves = QUANTITIES.map(|q| library.curve(id, &format!("{prefix}/{}", q.reference)));
        let Some(first) = curves.iter().flatten().next() else {
            let known: Vec<&str> = FAMILY.iter().map(|d| d.name).collect();
            return Err((format!("no reference {id:?}"), format!("give one of {}", known.join(", "))));
        };
        let time = |name: &str| Some(library.value(FOLDER, &format!("{}/{name}", declared.name))?.value);
        let onset = time("onset-time").ok_or_else(|| {
            (format!("no onset-time of {id:?}"), format!("restore reference-data/{FOLDER}/source.toml"))
        })?;
        Ok(Self {
            id: id.to_string(),
            label: first.label.clone(),
            uncertainty: first.uncertainty_note.clone(),
            declared,
            curves,
            onset,
            branching: time("branching-time"),
            notes: Vec::new(),
        })
    }

    /// What the declared model has that this reference has not.
    pub fn differences(&self, model: &Model) -> Vec<String> {
        let mut out = Vec::new();
        let here = &self.declared;
        let mut note = |differs: bool, text: String| out.extend(differs.then_some(text));
        let plane = model.plane != Plane::Unknown && model.plane != here.plane;
        let text = format!("plane {:?} where the nearest reference has plane {:?}", model.plane, here.plane);
        note(plane, text.to_lowercase());
        let slit = model.crack == Crack::Slit;
        let crack = |slit| if slit { "a slit" } else { "a seeded crack" };
        note(slit != here.slit, format!("{} where the nearest reference has {}", crack(slit), crack(here.slit)));
        let band = model.crack == Crack::PhaseField;
        note(band, "the crack is a prescribed phase field instead of a history field".into());
        if let Some(traction) = model.traction {
            let far = (traction / here.traction - 1.0).abs() > SAME_LOAD;
            let text = format!("a traction of {} MPa instead of {}", traction * 1e-6, here.traction * 1e-6);
            note(far, text);
        }
        let split = !["spectral", "unknown"].contains(&model.split.as_str());
        note(split, format!("split {:?} instead of the spectral one", model.split));
        let other = !["AT2", "unknown"].contains(&model.phase_field.as_str());
        note(other, format!("phase-field model {} instead of AT2", model.crack_model()));
        let length = model.length_scale.filter(|l| (l / LENGTH_SCALE - 1.0).abs() > 0.01);
        if let Some(l) = length {
            note(true, format!("l0 = {} mm in Borden's convention instead of 0.25 mm", l * 1e3));
        }
        let k = model.residual_stiffness;
        note(k > 1e-9, format!("residual stiffness k = {k:e} instead of 0, which raises the elastic energy late"));
        out.extend(model.differences.iter().cloned());
        out
    }

    /// Phases with their windows, s; the whole curve first. Fracture increments count from 30 µs over the
    /// whole curve, and are not judged before the crack runs: they depend on how it was made.
    pub fn windows(&self, quantity: usize) -> Vec<(&'static str, [f64; 2])> {
        let whole = if quantity == FRACTURE { FRACTURE_START } else { START };
        let mut out = vec![("whole", [whole, END])];
        if quantity != FRACTURE {
            out.push(("before onset", [START, self.onset]));
        }
        let next = self.branching.unwrap_or(END);
        out.push(("one crack", [self.onset, next]));
        if next < END {
            out.push(("branched", [next, END]));
        }
        out
    }
}

/// What bilinear elements of a spacing are off by: `mesh-study.csv` of the family.
#[derive(Debug, Clone)]
pub struct MeshStudy(Table);

impl MeshStudy {
    /// Reads the table below the folder of the reference data.
    ///
    /// # Errors
    /// A table that is missing or damaged.
    pub fn load(data: &Path) -> Result<Self, TableError> {
        Table::read(&data.join(FOLDER).join("mesh-study.csv")).map(Self)
    }

    /// The figure in a column at a spacing over l0, interpolated between meshes on logarithmic axes and
    /// carried on with the square of the spacing beyond them. Of meshes that have none, the nearest that
    /// has.
    pub fn at(&self, column: &str, spacing: f64) -> Option<f64> {
        let (h, values) = (self.0.column("spacing_over_l0")?, self.0.column(column)?);
        let mut rows: Vec<(f64, f64)> = h.iter().copied().zip(values.iter().copied()).filter(|r| r.1 > 0.0).collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut most = 0.0;
        rows.iter_mut().for_each(|row| {
            // A coarse mesh that happens to be near is no better than a finer one.
            most = crate::extremes::larger(most, row.1);
            row.1 = most;
        });
        let (first, last) = (*rows.first()?, *rows.last()?);
        if spacing <= first.0 {
            return Some(first.1 * (spacing / first.0).powi(2));
        }
        let Some(next) = rows.iter().position(|r| r.0 >= spacing) else {
            return Some(last.1 * (spacing / last.0).powi(2));
        };
        let ((h0, v0), (h1, v1)) = (rows[next - 1], rows[next]);
        let weight = (spacing / h0).ln() / (h1 / h0).ln();
        Some(v0 * (v1 / v0).powf(weight))
    }

    /// Largest ratio over the meshes of the figure in `column` to that in `whole`.
    pub fn ratio(&self, column: &str, whole: &str) -> f64 {
        let (Some(part), Some(whole)) = (self.0.column(column), self.0.column(whole)) else { return 1.0 };
        crate::extremes::largest(part.iter().zip(whole).map(|(p, w)| p / w))
    }
}
