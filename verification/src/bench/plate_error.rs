//! Errors of a run of the plate, by its energies and its crack.

use super::BenchError;
use super::record::AnswerError;
use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::reference::{Library, ReferenceCurve, relative_rms, relative_uncertainty, rms_difference, rms_uncertainty};

/// Folder of the reference.
const REFERENCE: &str = "plate-family";
/// End of every window, s.
const END: f64 = 80e-6;
/// End of the initial crack, m: the tip before anything is broken.
const NOTCH: f64 = 0.05;
/// Tolerance of the phase field against which others are held.
pub const TIGHT_TOLERANCE: f64 = 2e-8;

/// What a run is measured by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name of the quantity in words.
    pub name: &'static str,
    /// Where the comparison begins, s.
    pub from: f64,
    /// Unit of the error; empty for one that is relative.
    pub unit: &'static str,
    /// Quantity of the reference.
    curve: &'static str,
    /// Columns of a history of this solver and of one of the finite elements.
    columns: [&'static str; 2],
}

/// All of them; the first is the error of the record.
pub const QUANTITIES: [Quantity; 5] = [
    quantity("kinetic energy", "plate/kinetic-energy", ["kinetic_j", "kinetic_j_per_m"]),
    quantity("external work", "plate/external-work", ["external_work_j", "external_work_j_per_m"]),
    quantity("elastic energy", "plate/elastic-energy", ["elastic_j", "elastic_j_per_m"]),
    Quantity {
        from: 30e-6,
        ..quantity("fracture energy", "plate/fracture-increment", ["fracture_j", "fracture_increment_j_per_m"])
    },
    Quantity { unit: "mm", ..quantity("crack tip", "plate/tip-x", ["crack_tip_x_m", "tip_x_mm"]) },
];

const fn quantity(name: &'static str, curve: &'static str, columns: [&'static str; 2]) -> Quantity {
    Quantity { name, from: 5e-6, unit: "", curve, columns }
}

impl Quantity {
    fn is_length(&self) -> bool {
        self.unit == "mm"
    }

    /// Norm and window in words.
    fn words(&self) -> String {
        let norm = if self.is_length() { "rms" } else { "relative rms" };
        format!("{}, {norm} from {:.0} to {:.0} µs", self.name, 1e6 * self.from, 1e6 * END)
    }

    fn error(&self, reference: &ReferenceCurve, seconds: &[f64], values: &[f64]) -> Option<AnswerError> {
        let window = (self.from, END);
        let (value, uncertainty) = if self.is_length() {
            let value = 1e3 * rms_difference(reference, seconds, values, window.0, window.1)?;
            (value, rms_uncertainty(reference, window.0, window.1).map(|u| 1e3 * u))
        } else {
            let value = relative_rms(reference, seconds, values, window.0, window.1)?;
            (value, relative_uncertainty(reference, window.0, window.1))
        };
        let uncertainty = uncertainty.unwrap_or(0.0);
        let (quantity, reference) = (self.words(), reference.label.clone());
        let error = AnswerError { quantity, value, unit: self.unit.into(), reference, uncertainty };
        error.value.is_finite().then_some(error)
    }
}

/// The curves of the reference, one for each of [`QUANTITIES`].
pub struct References<'a>([&'a ReferenceCurve; QUANTITIES.len()]);

impl<'a> References<'a> {
    /// Those of the library.
    ///
    /// # Errors
    /// If one is missing.
    pub fn of(library: &'a Library) -> Result<Self, BenchError> {
        let find = |quantity: &Quantity| {
            let missing = || BenchError::input(format!("there is no curve {} in {REFERENCE}", quantity.curve));
            library.curve(REFERENCE, quantity.curve).ok_or_else(missing)
        };
        let found = QUANTITIES.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let found = found.try_into().map_err(|_| BenchError::input("quantities without a curve"))?;
        Ok(Self(found))
    }

    /// Errors of a history of this solver, whose energies are a `factor`th of those of the plate.
    pub fn errors_of_history(&self, history: &Table, factor: f64) -> Option<Vec<AnswerError>> {
        let values = |quantity: &Quantity| {
            let column = history.column(quantity.columns[0])?;
            let first = if quantity.name == "fracture energy" { *column.first()? } else { 0.0 };
            Some(match quantity.is_length() {
                true => with_notch(column, 1.0),
                false => column.iter().map(|value| factor * (value - first)).collect(),
            })
        };
        self.errors(history.column("time_s")?, values)
    }

    /// Errors of a history of the finite elements, which has the energies of the whole plate.
    pub fn errors_of_elements(&self, history: &Table) -> Option<Vec<AnswerError>> {
        let seconds: Vec<f64> = history.column("time_us")?.iter().map(|t| 1e-6 * t).collect();
        let values = |quantity: &Quantity| {
            let column = history.column(quantity.columns[1])?;
            Some(if quantity.is_length() { with_notch(column, 1e-3) } else { column.to_vec() })
        };
        self.errors(&seconds, values)
    }

    fn errors(&self, seconds: &[f64], values: impl Fn(&Quantity) -> Option<Vec<f64>>) -> Option<Vec<AnswerError>> {
        let pairs = QUANTITIES.iter().zip(self.0);
        pairs.map(|(quantity, curve)| quantity.error(curve, seconds, &values(quantity)?)).collect()
    }
}

/// Abscissae of the tip in m; where there is none yet, the end of the initial crack.
fn with_notch(column: &[f64], metre: f64) -> Vec<f64> {
    column.iter().map(|x| if x.is_finite() { metre * x } else { NOTCH }).collect()
}

/// Largest difference of kinetic, elastic and fracture energy from those of another run, over the largest
/// value of each.
pub fn difference_of_energies(history: &Table, other: &Table) -> Option<AnswerError> {
    let mut value = 0.0;
    for name in ["kinetic_j", "elastic_j", "fracture_j"] {
        let (ours, theirs) = (history.column(name)?, other.column(name)?);
        let size = largest(theirs.iter().map(|x| x.abs()));
        let pairs = (ours.len() == theirs.len() && size > 0.0).then(|| ours.iter().zip(theirs))?;
        value = larger(value, largest(pairs.map(|(a, b)| (a - b).abs() / size)));
    }
    let reference = format!("tolerance {TIGHT_TOLERANCE:e}");
    Some(AnswerError::relative("largest relative difference of an energy", value, &reference))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::own_workspace;

    #[test]
    fn a_history_that_is_the_reference_has_no_error_in_either_form() {
        let library = Library::load(&own_workspace().join("reference-data")).unwrap();
        let references = References::of(&library).unwrap();
        let seconds = references.0[0].x.clone();
        let at = |curve: &ReferenceCurve, t: f64| curve.at(t).unwrap_or(f64::NAN);
        let [mut ours, mut theirs] = [(); 2].map(|()| Table { names: Vec::new(), columns: Vec::new() });
        ours.names.push("time_s".into());
        ours.columns.push(seconds.clone());
        theirs.names.push("time_us".into());
        theirs.columns.push(seconds.iter().map(|t| 1e6 * t).collect());
        for (quantity, curve) in QUANTITIES.iter().zip(references.0) {
            let values: Vec<f64> = seconds.iter().map(|t| at(curve, *t)).collect();
            let scaled = |a: f64, b: f64| values.iter().map(|v| a * v + b).collect::<Vec<f64>>();
            let length = quantity.is_length();
            let first = if quantity.name == "fracture energy" { 0.1 } else { 0.0 };
            ours.names.push(quantity.columns[0].into());
            ours.columns.push(if length { values.clone() } else { scaled(0.5, first) });
            theirs.names.push(quantity.columns[1].into());
            theirs.columns.push(if length { scaled(1e3, 0.0) } else { values });
        }
        let both = [references.errors_of_history(&ours, 2.0), references.errors_of_elements(&theirs)];
        for errors in both.map(Option::unwrap) {
            assert!(errors.iter().all(|e| e.value < 1e-9 && e.uncertainty > 1e-3), "{errors:?}");
            assert_eq!(errors.iter().filter(|e| e.unit == "mm").count(), 1);
        }
        ours.names[1] = "another".into();
        assert_eq!(references.errors_of_history(&ours, 2.0), None);
    }

    #[test]
    fn a_tip_that_is_not_there_yet_is_the_end_of_the_notch() {
        assert_eq!(with_notch(&[f64::NAN, 60.0], 1e-3), [0.05, 0.06]);
    }
}
