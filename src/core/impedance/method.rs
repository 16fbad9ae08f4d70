//! The follower's part of each rendering method, as one list.

use super::{
    Mode,
    anchored::Anchored,
    baselines::Ends,
    degrees::Degrees,
    features::Features,
    matched::{Form, Matched},
    messages::{Parcel, Posture, Report},
    paper::Paper,
    settings::{ModeSet, Settings},
};
use crate::signal::Lanes;

#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    pub(super) posture: &'a Posture,
    /// The paper's `X`.
    pub(super) x: &'a Features,
    /// The force, or the last good force, N.
    pub(super) force_n: Lanes,
    /// The sample was measured, not bridged.
    pub(super) good: bool,
    /// The features come from a full filter, too.
    pub(super) usable: bool,
    pub(super) learn: bool,
    /// The packet that the leader has now; without a delay the last one.
    pub(super) sent: Option<&'a Parcel>,
}

/// The follower's part of a rendering method: learns from samples and writes its parameters into the packet.
pub(super) trait Method {
    /// Returns whether the method runs while these modes are computed.
    fn serves(&self, modes: ModeSet) -> bool;

    /// Returns whether the method restarts when the modes change from `before` to `now`.
    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        self.serves(now) && !self.serves(before)
    }

    fn take(&mut self, seen: &Seen<'_>, parcel: &mut Parcel, report: &mut Report);

    fn set_delay(&mut self, _delay_ticks: usize) {}

    fn reset(&mut self);
}

/// The methods for which memory is allocated.
#[derive(Clone, Debug)]
pub(super) struct Methods {
    pub(super) literal: Option<Box<Paper>>,
    /// The paper's linear model, if it is computed without the others.
    pub(super) linear: Option<Box<Paper>>,
    anchored: Option<Box<Anchored>>,
    /// The degrees of the window's impedance, where anchored is compared with the paper.
    pub(super) degrees: Option<Box<Degrees>>,
    matched: Option<Box<Matched>>,
    nima: Option<Box<Matched>>,
    pub(super) baseline: Option<Box<Ends>>,
}

impl Methods {
    pub(super) fn new(settings: &Settings, delay_ticks: usize) -> Self {
        let modes = settings.modes;
        let paper = |mode: Mode| modes.contains(mode).then(|| Box::new(Paper::new(mode, settings)));
        let matched =
            |mode: Mode, form: Form| modes.contains(mode).then(|| Box::new(Matched::new(form, settings, delay_ticks)));
        Self {
            literal: paper(Mode::Literal),
            linear: paper(Mode::Linear),
            anchored: modes.contains(Mode::Anchored).then(|| Box::new(Anchored::new(settings, delay_ticks))),
            degrees: Degrees::are_wanted(modes).then(|| Box::new(Degrees::new(settings, delay_ticks))),
            matched: matched(Mode::Matched, Form::of(settings)),
            nima: matched(Mode::Nima, Form::Paper(settings.max_degree as u8)),
            baseline: modes.baseline().map(|baseline| Box::new(Ends::new(baseline, settings, delay_ticks))),
        }
    }

    /// Returns the methods in their order of execution.
    pub(super) fn each(&mut self) -> impl Iterator<Item = &mut dyn Method> {
        fn entry<M: Method>(method: &mut Option<Box<M>>) -> Option<&mut dyn Method> {
            method.as_deref_mut().map(|method| method as &mut dyn Method)
        }
        let Self { literal, linear, anchored, degrees, matched, nima, baseline } = self;
        let all = [
            entry(literal),
            entry(linear),
            entry(anchored),
            entry(degrees),
            entry(matched),
            entry(nima),
            entry(baseline),
        ];
        all.into_iter().flatten()
    }
}
