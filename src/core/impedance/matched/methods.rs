//! The two methods of matched rendering: in columns of position and slip, and in the paper's.

use super::{
    super::{
        Models,
        messages::IdentificationReport,
        method::{FollowerEnd, LeaderEnd, LeaderInput, Place, RenderingMethod},
        settings::ImpedanceSettings,
    },
    Learner, ModelForm,
    slip::Slip,
};
use crate::signal::Lanes;

/// Matched rendering; at the leader it has the springs of its slip columns.
#[derive(Clone, Debug, Default)]
pub(in crate::impedance) struct MatchedMethod {
    slip: Slip,
}

impl RenderingMethod for MatchedMethod {
    const NAME: &'static str = "matched";
    const ABOUT: &'static str = "parameters alone, the force from the hand's own motion";
    const IS_DAMPED: bool = true;
    const PARAMETERS: Option<Place> = Some(|models| &mut models.matched);

    fn follower(settings: &ImpedanceSettings, delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        Some(Box::new(Learner::new(ModelForm::of(settings), settings, delay_ticks)))
    }

    fn leader(_settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self::default())
    }

    fn degree(report: &IdentificationReport) -> u8 {
        report.degrees.matched
    }

    fn note(models: &Models, report: &mut IdentificationReport) {
        report.degrees.matched = models.matched.degree;
    }
}

impl LeaderEnd for MatchedMethod {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        moment.parcel.models.matched.force(moment.now, &mut self.slip)
    }

    fn reset(&mut self) {
        self.slip = Slip::default();
    }
}

/// Matched rendering in the paper's columns, none of which slips.
#[derive(Clone, Debug)]
pub(in crate::impedance) struct Nima;

impl RenderingMethod for Nima {
    const NAME: &'static str = "nima";
    const ABOUT: &'static str = "the paper's columns with a constant, a kept origin and a ridge";
    const HAS_WINDOW: bool = true;
    const HAS_DEGREES: bool = true;
    const IS_DAMPED: bool = true;
    const PARAMETERS: Option<Place> = Some(|models| &mut models.nima);

    fn follower(settings: &ImpedanceSettings, delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        Some(Box::new(Learner::new(ModelForm::Paper(settings.max_degree as u8), settings, delay_ticks)))
    }

    fn leader(_settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self)
    }

    fn degree(report: &IdentificationReport) -> u8 {
        report.degrees.nima
    }

    fn note(models: &Models, report: &mut IdentificationReport) {
        report.degrees.nima = models.nima.degree;
    }
}

impl LeaderEnd for Nima {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        // A new `Slip` each time: no column of this form has a memory.
        moment.parcel.models.nima.force(moment.now, &mut Slip::default())
    }
}
