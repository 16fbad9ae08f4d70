//! Direct force reflection, the reference for every other mode.

use super::{
    method::{LeaderEnd, LeaderInput, RenderingMethod},
    settings::ImpedanceSettings,
};
use crate::signal::Lanes;

/// The measured force, delayed by the link.
#[derive(Clone, Debug)]
pub(super) struct Dfr;

impl RenderingMethod for Dfr {
    const NAME: &'static str = "dfr";
    const ABOUT: &'static str = "the delayed force itself, for comparison";

    fn leader(_settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self)
    }
}

impl LeaderEnd for Dfr {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        Some(moment.measured_n)
    }
}
