//! What a study yields for a case, known before it runs: which quantities, for which variants, and whether
//! the study brings a reference value of its own.

use crate::case::expand::CaseScene;
use crate::study::orders::{Norm, Refined};

/// A number that a study will measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Offer {
    /// Variant it belongs to; empty if there is one only.
    pub variant: String,
    /// Quantity in words.
    pub quantity: String,
    /// Unit.
    pub unit: &'static str,
    /// Whether the study holds it against a value of its own.
    pub held: bool,
}

/// All numbers of a study, in the order of its loops.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Offers(Vec<Offer>);

impl Offers {
    /// The same quantities for every scene.
    pub fn of_scenes(scenes: &[CaseScene], held: &[&str], bare: &[&str]) -> Self {
        let mut offers = Self::default();
        for scene in scenes {
            offers.held(&scene.name, held);
            offers.bare(&scene.name, bare);
        }
        offers
    }

    /// Adds dimensionless numbers that the study holds against values of its own.
    pub fn held<Q: AsRef<str>>(&mut self, variant: &str, quantities: impl IntoIterator<Item = Q>) {
        quantities.into_iter().for_each(|quantity| self.push(variant, quantity.as_ref(), "1", true));
    }

    /// Adds dimensionless numbers without such a value.
    pub fn bare<Q: AsRef<str>>(&mut self, variant: &str, quantities: impl IntoIterator<Item = Q>) {
        quantities.into_iter().for_each(|quantity| self.push(variant, quantity.as_ref(), "1", false));
    }

    /// Adds one number.
    pub fn push(&mut self, variant: &str, quantity: &str, unit: &'static str, held: bool) {
        self.0.push(Offer { variant: variant.into(), quantity: quantity.into(), unit, held });
    }

    /// Adds what [`Convergence::measurements`](crate::study::orders::Convergence::measurements) gives for a
    /// curve with these norms and orders of theory.
    pub fn curve(&mut self, name: &str, refined: Refined, norms: &[&str], orders: &[Option<f64>]) {
        for (norm, order) in norms.iter().zip(orders) {
            self.push(name, &Norm::order_of(norm), "1", order.is_some());
            self.push(name, &refined.at_the_finest(norm), "1", false);
        }
    }

    /// All of them.
    pub fn all(&self) -> &[Offer] {
        &self.0
    }
}
