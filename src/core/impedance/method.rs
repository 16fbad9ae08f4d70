//! The follower's part of each way to render, as one list.

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

/// What a method sees of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    pub(super) posture: &'a Posture,
    /// The paper's `X`.
    pub(super) x: &'a Features,
    /// The force, or the last good one, N.
    pub(super) force_n: Lanes,
    /// The sample was measured, not bridged.
    pub(super) good: bool,
    /// Its features are those of a full filter, too.
    pub(super) usable: bool,
    /// There is something to learn from.
    pub(super) learn: bool,
    /// The parcel that the leader has now; without a delay the last one stands for it.
    pub(super) sent: Option<&'a Parcel>,
}

/// The follower's part of a way to render: learns from samples and writes its parameters into the parcel.
pub(super) trait Method {
    /// Whether it is at work while these modes are computed.
    fn serves(&self, modes: ModeSet) -> bool;

    /// Whether it begins again when the modes `now` take the place of those `before`.
    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        self.serves(now) && !self.serves(before)
    }

    /// Takes the newest sample.
    fn take(&mut self, seen: &Seen<'_>, parcel: &mut Parcel, report: &mut Report);

    /// Learns what happens over another delay from now on.
    fn set_delay(&mut self, _delay_ticks: usize) {}

    /// Forgets everything.
    fn reset(&mut self);
}

/// The methods that there is memory for.
#[derive(Clone, Debug)]
pub(super) struct Methods {
    pub(super) literal: Option<Box<Paper>>,
    /// The paper's linear model alone, where that is all that is computed.
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

    /// Each of them, in the order in which they work.
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
