//! Direct force reflection: what every other mode is compared with.

use super::{
    method::{Leader, Method, Moment},
    settings::Settings,
};
use crate::signal::Lanes;

/// The measured force, as late as the link delivers it.
#[derive(Clone, Debug)]
pub(super) struct Dfr;

impl Method for Dfr {
    const NAME: &'static str = "dfr";
    const ABOUT: &'static str = "the delayed force itself, for comparison";

    fn leader(_settings: &Settings) -> Box<dyn Leader> {
        Box::new(Self)
    }
}

impl Leader for Dfr {
    fn render(&mut self, moment: &Moment<'_>) -> Option<Lanes> {
        Some(moment.measured_n)
    }
}
