//! What a submission says about the model of its result.

use serde::{Deserialize, Serialize};

use crate::scene::fields::Item;
use crate::scene::units::Dimension;

/// Plane state as declared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// Plane strain: the strain across the plane is zero.
    #[default]
    Strain,
    /// Plane stress: the stress across the plane is zero.
    Stress,
    /// The submission says that it is not known.
    Unknown,
}

/// How the initial crack is made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Crack {
    /// Seeded by an initial history field.
    #[default]
    Seeded,
    /// A prescribed phase field.
    PhaseField,
    /// Free faces in the mesh, or a gap between points.
    Slit,
    /// The submission says that it is not known.
    Unknown,
}

/// What was modelled, SI units; the default is that of closed forms, which ask for no model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// Plane state that the submission declares.
    pub plane: Plane,
    /// Traction on each loaded edge, Pa; absent where unknown.
    pub traction: Option<f64>,
    /// How the crack is made.
    pub crack: Crack,
    /// `spectral` is that of the references.
    pub split: String,
    /// `AT2` is that of the references.
    pub phase_field: String,
    /// Tensile strength of a cohesive crack, Pa, where said.
    pub tensile_strength: Option<f64>,
    /// Softening of a cohesive crack, where said.
    pub softening: Option<String>,
    /// l0 in Borden's convention, m; absent where not said.
    pub length_scale: Option<f64>,
    /// Residual stiffness k of broken material.
    pub residual_stiffness: f64,
    /// Whether the upper half alone was computed.
    pub half: bool,
    /// Thickness, m, by which energies in J are divided.
    pub thickness: Option<f64>,
    /// What else differs from the benchmark, in words.
    pub differences: Vec<String>,
}

impl Model {
    /// Its phase-field model in words.
    pub(super) fn crack_model(&self) -> String {
        let strength = self.tensile_strength.map(|ft| format!("ft = {} MPa", ft * 1e-6));
        let softening = self.softening.as_ref().map(|law| format!("{law} softening"));
        let said: Vec<String> = strength.into_iter().chain(softening).collect();
        let said = if said.is_empty() { String::new() } else { format!(" ({})", said.join(", ")) };
        format!("{}{said}", self.phase_field)
    }
}

/// The model, of which some keys are `needed`: what the variants of the benchmark differ in.
pub(super) fn model(item: &Item<'_>, needed: &[&str]) -> Option<Model> {
    item.table(|fields| {
        let planes = [("strain", Plane::Strain), ("stress", Plane::Stress), ("unknown", Plane::Unknown)];
        let plane = fields.need("plane", "plane = \"strain\", \"stress\" or \"unknown\"", |item| item.choice(&planes));
        let need = |key: &str, like: &str| {
            if needed.contains(&key) && fields.get(key).is_none() {
                item.missing::<()>(key, like);
            }
        };
        need("traction", "traction = \"1 MPa\", or \"unknown\"");
        let traction = fields.maybe("traction", |item| match item.node.as_str() {
            Some("unknown") => None,
            _ => item.positive(Dimension::STRESS),
        });
        let cracks = [
            ("seeded", Crack::Seeded),
            ("phase-field", Crack::PhaseField),
            ("slit", Crack::Slit),
            ("unknown", Crack::Unknown),
        ];
        need("crack", "crack = \"seeded\", \"phase-field\", \"slit\" or \"unknown\"");
        let crack = fields.or("crack", Crack::Slit, |item| item.choice(&cracks));
        let splits =
            ["spectral", "none", "volumetric-deviatoric", "star-convex", "rankine", "other", "unknown"].map(|w| (w, w));
        need("split", "split = \"spectral\"");
        let split = fields.or("split", "spectral", |item| item.choice(&splits)).into();
        let models = ["AT2", "AT1", "PF-CZM", "none", "other", "unknown"].map(|w| (w, w));
        need("phase_field", "phase_field = \"AT1\", \"AT2\", …");
        let phase_field = fields.or("phase_field", "AT2", |item| item.choice(&models));
        let of_cohesive = ["tensile_strength", "softening"].map(|key| fields.get(key).map(|given| (key, given)));
        if let Some((key, given)) = of_cohesive.into_iter().flatten().next().filter(|_| phase_field != "PF-CZM") {
            given.fail::<()>(format!("{key} belongs to PF-CZM"), "remove it, or give phase_field = \"PF-CZM\"");
        }
        let laws = ["linear", "exponential", "cornelissen", "other"].map(|w| (w, w));
        let convention = fields.or("convention", 1.0, |item| item.choice(&[("l0", 1.0), ("l", 0.5)]));
        let length = fields.maybe("length_scale", |item| item.positive(Dimension::LENGTH));
        Some(Model {
            traction,
            crack,
            split,
            phase_field: phase_field.into(),
            tensile_strength: fields.maybe("tensile_strength", |item| item.positive(Dimension::STRESS)),
            softening: fields.maybe("softening", |item| item.choice(&laws)).map(String::from),
            length_scale: length.map(|length| length * convention),
            residual_stiffness: fields.or("residual_stiffness", 0.0, |item| item.quantity(Dimension::NONE)),
            half: fields.or("part", false, |item| item.choice(&[("whole", false), ("half", true)])),
            thickness: fields.maybe("thickness", |item| item.positive(Dimension::LENGTH)),
            differences: fields.or("differences", Vec::new(), |item| item.each(Item::words)),
            plane: plane?,
        })
    })
}
