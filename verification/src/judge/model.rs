//! What a submission says about the model of its result.

use serde::{Deserialize, Serialize};

use crate::scene::fields::Item;
use crate::scene::units::Dimension;

/// Plane state as declared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// Plane strain.
    Strain,
    /// Plane stress.
    Stress,
    /// Nobody knows.
    Unknown,
}

/// How the initial crack is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Crack {
    /// A history field.
    Seeded,
    /// A prescribed phase field.
    PhaseField,
    /// Free faces in the mesh, or a gap between points.
    Slit,
    /// Nobody knows.
    Unknown,
}

/// What was modelled, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Plane state.
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
    /// k.
    pub residual_stiffness: f64,
    /// Whether the upper half alone was computed.
    pub half: bool,
    /// Thickness, m, by which energies in J are divided.
    pub thickness: Option<f64>,
    /// What else differs from the benchmark, in words.
    pub differences: Vec<String>,
}

impl Default for Model {
    fn default() -> Self {
        Self {
            plane: Plane::Strain,
            traction: None,
            crack: Crack::Seeded,
            split: "spectral".into(),
            phase_field: "AT2".into(),
            tensile_strength: None,
            softening: None,
            length_scale: None,
            residual_stiffness: 0.0,
            half: false,
            thickness: None,
            differences: Vec::new(),
        }
    }
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

const MODEL: [&str; 13] = [
    "plane",
    "traction",
    "crack",
    "split",
    "phase_field",
    "tensile_strength",
    "softening",
    "length_scale",
    "convention",
    "residual_stiffness",
    "part",
    "thickness",
    "differences",
];

/// The model, of which some keys are `needed`: what the variants of the benchmark differ in.
pub(super) fn model(item: &Item<'_>, needed: &[&str]) -> Option<Model> {
    let fields = item.fields(&MODEL)?;
    let asked = |key: &str| needed.contains(&key) || fields.get(key).is_some();
    let planes = [("strain", Plane::Strain), ("stress", Plane::Stress), ("unknown", Plane::Unknown)];
    let plane = fields.need("plane", "plane = \"strain\", \"stress\" or \"unknown\"", |item| item.choice(&planes));
    let unknown = |item: &Item<'_>| item.node.as_str() == Some("unknown");
    let traction = asked("traction").then(|| {
        fields.need("traction", "traction = \"1 MPa\", or \"unknown\"", |item| {
            if unknown(item) { Some(None) } else { item.positive(Dimension::STRESS).map(Some) }
        })
    });
    let cracks = [
        ("seeded", Crack::Seeded),
        ("phase-field", Crack::PhaseField),
        ("slit", Crack::Slit),
        ("unknown", Crack::Unknown),
    ];
    let crack = asked("crack").then(|| {
        fields
            .need("crack", "crack = \"seeded\", \"phase-field\", \"slit\" or \"unknown\"", |item| item.choice(&cracks))
    });
    let splits =
        ["spectral", "none", "volumetric-deviatoric", "star-convex", "rankine", "other", "unknown"].map(|w| (w, w));
    let split = asked("split").then(|| fields.need("split", "split = \"spectral\"", |item| item.choice(&splits)));
    let models = ["AT2", "AT1", "PF-CZM", "none", "other", "unknown"].map(|w| (w, w));
    let phase_field = asked("phase_field")
        .then(|| fields.need("phase_field", "phase_field = \"AT1\", \"AT2\", …", |item| item.choice(&models)));
    if phase_field != Some(Some("PF-CZM"))
        && let Some((key, given)) = ["tensile_strength", "softening"].iter().find_map(|k| Some((k, fields.get(k)?)))
    {
        return given.fail(format!("{key} belongs to PF-CZM"), "remove it, or give phase_field = \"PF-CZM\"");
    }
    let strength = fields.maybe("tensile_strength", |item| item.positive(Dimension::STRESS));
    let laws = ["linear", "exponential", "cornelissen", "other"].map(|w| (w, w));
    let softening = fields.maybe("softening", |item| item.choice(&laws));
    let length = fields.maybe("length_scale", |item| item.positive(Dimension::LENGTH));
    let convention = fields.or("convention", 1.0, |item| item.choice(&[("l0", 1.0), ("l", 0.5)]));
    let k = fields.or("residual_stiffness", 0.0, |item| item.quantity(Dimension::NONE));
    let half = fields.or("part", false, |item| item.choice(&[("whole", false), ("half", true)]));
    let thickness = fields.maybe("thickness", |item| item.positive(Dimension::LENGTH));
    let differences = fields.or("differences", Vec::new(), |item| item.each(Item::words));
    let convention = convention?;
    Some(Model {
        plane: plane?,
        traction: traction.unwrap_or(Some(None))?,
        crack: crack.unwrap_or(Some(Crack::Slit))?,
        split: split.unwrap_or(Some("spectral"))?.into(),
        phase_field: phase_field.unwrap_or(Some("AT2"))?.into(),
        tensile_strength: strength?,
        softening: softening?.map(String::from),
        length_scale: length?.map(|l| l * convention),
        residual_stiffness: k?,
        half: half?,
        thickness: thickness?,
        differences: differences?,
    })
}
