//! What a way to render consists of: a part at either end of the link, and parameters that cross it.
//!
//! The list of all ways is in `mode`; this file has the trait that each of them implements, and runs them.

use std::fmt::Debug;

use dyn_clone::{DynClone, clone_trait_object};

use super::{
    Mode, SLOTS,
    degrees::ImpedanceDegrees,
    features::ImpedanceFeatures,
    literal::LiteralSolver,
    messages::{IdentificationReport, LinkPacket, Posture},
    mode::Models,
    packed::PackedParameters,
    settings::{ImpedanceSettings, ModeSet},
    solution::ImpedanceSolution,
};
use crate::signal::Lanes;

/// A way to render. Its error at the horizon is that of its leader's part, which the identifier also runs on the follower's own motion.
pub trait BaselineMethod {
    /// The name on the command line, in files and on the screen.
    const NAME: &'static str;
    /// Short description for tables.
    const ABOUT: &'static str;
    /// Whether it is fitted to a window of samples, whose length is then a setting of it.
    const HAS_WINDOW: bool = false;
    /// Whether it chooses among polynomial degrees, the highest of which is then a setting of it.
    const HAS_DEGREES: bool = false;
    /// Whether its force is damped where the leader's own motion is that of the handle.
    const IS_DAMPED: bool = false;
    /// The modes whose forces it uses. They are computed with it, and come before it in the list.
    const PARTS: &'static [Mode] = &[];
    /// Its parameters in a parcel, if it sends any.
    const PARAMETERS: Option<Place> = None;

    /// The follower's part; `None` if the measured force and the parameters of other modes are enough.
    fn follower(_settings: &ImpedanceSettings, _delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        None
    }

    /// The leader's part.
    fn leader(settings: &ImpedanceSettings) -> Box<dyn LeaderEnd>;

    /// The degree that it uses; 0: none.
    fn degree(_report: &IdentificationReport) -> u8 {
        0
    }

    /// Enters into a report what a parcel tells of the follower's part.
    fn note(_models: &Models, _report: &mut IdentificationReport) {}
}

/// Where the parameters of a method are in a parcel.
pub type Place = fn(&mut Models) -> &mut dyn PackedParameters;

/// A method as a row of the list.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) has_window: bool,
    pub(super) has_degrees: bool,
    pub(super) is_damped: bool,
    pub(super) parts: &'static [Mode],
    pub(super) parameters: Option<Place>,
    pub(super) follower: fn(&ImpedanceSettings, usize) -> Option<Box<dyn FollowerEnd>>,
    pub(super) leader: fn(&ImpedanceSettings) -> Box<dyn LeaderEnd>,
    pub(super) degree: fn(&IdentificationReport) -> u8,
    pub(super) note: fn(&Models, &mut IdentificationReport),
}

impl Entry {
    /// The row of a method.
    pub const fn of<M: BaselineMethod>() -> Self {
        Self {
            name: M::NAME,
            about: M::ABOUT,
            has_window: M::HAS_WINDOW,
            has_degrees: M::HAS_DEGREES,
            is_damped: M::IS_DAMPED,
            parts: M::PARTS,
            parameters: M::PARAMETERS,
            follower: M::follower,
            leader: M::leader,
            degree: M::degree,
            note: M::note,
        }
    }
}

/// What the follower's part of a method sees of a sample.
#[derive(Clone, Copy, Debug)]
pub struct MethodInput<'a> {
    pub posture: &'a Posture,
    /// The paper's `X`.
    pub x: &'a ImpedanceFeatures,
    /// The force, or the last good one, N.
    pub force_n: Lanes,
    /// The sample was measured, not bridged.
    pub good: bool,
    /// Its features are those of a full filter, too.
    pub usable: bool,
    /// There is something to learn from.
    pub learn: bool,
    /// The parcel that the leader has now; without a delay the last one stands for it.
    pub sent: Option<&'a LinkPacket>,
}

/// The follower's part of a method: learns from samples and writes its parameters into the parcel.
pub trait FollowerEnd: Debug + DynClone + Send + Sync {
    /// Whether it is at work while these modes are computed.
    fn serves(&self, modes: ModeSet) -> bool;

    /// Returns whether the method restarts when the modes change from `before` to `now`.
    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        self.serves(now) && !self.serves(before)
    }

    fn take(&mut self, seen: &MethodInput<'_>, parcel: &mut LinkPacket, report: &mut IdentificationReport);

    fn set_delay(&mut self, _delay_ticks: usize) {}

    fn reset(&mut self);

    /// The paper's solutions of every degree, if it solves them.
    fn paper(&self) -> Option<&LiteralSolver> {
        None
    }

    /// The nested solutions on the newest window, if it solves them.
    fn nested(&self) -> Option<&ImpedanceSolution> {
        None
    }
}

clone_trait_object!(FollowerEnd);

/// The follower's parts that there is memory for.
#[derive(Clone, Debug)]
pub(super) struct Followers(Vec<Box<dyn FollowerEnd>>);

impl Followers {
    pub(super) fn new(settings: &ImpedanceSettings, delay_ticks: usize) -> Self {
        let modes = settings.modes;
        let parts = modes.modes().filter_map(|mode| (mode.entry()?.follower)(settings, delay_ticks));
        let degrees = ImpedanceDegrees::are_wanted(modes).then(|| ImpedanceDegrees::new(settings, delay_ticks));
        Self(parts.chain(degrees.map(|degrees| Box::new(degrees) as Box<dyn FollowerEnd>)).collect())
    }

    pub(super) fn each(&mut self) -> impl Iterator<Item = &mut Box<dyn FollowerEnd>> {
        self.0.iter_mut()
    }

    /// The first thing of this kind that one of them has.
    pub(super) fn find<'a, T>(&'a self, of: impl Fn(&'a dyn FollowerEnd) -> Option<T>) -> Option<T> {
        self.0.iter().find_map(|follower| of(&**follower))
    }
}

/// What the leader's part of a method sees in a tick.
#[derive(Clone, Copy, Debug)]
pub struct AnchoredMoment<'a> {
    pub parcel: &'a LinkPacket,
    /// The force in the parcel, N; it is finite.
    pub measured_n: Lanes,
    /// The leader's own motion now, and at the time of the parcel.
    pub now: &'a Posture,
    pub then: &'a Posture,
    /// The paper's `X` of the leader's own motion.
    pub x: &'a ImpedanceFeatures,
    /// Age of the parcel.
    pub age_ticks: usize,
    /// The forces of the modes that come before in the list, N, by [`Mode::index`].
    pub forces_n: &'a [Option<Lanes>; SLOTS],
}

/// The leader's part of a method: makes a force of the newest parcel and the leader's own motion.
pub trait LeaderEnd: Debug + DynClone + Send + Sync {
    /// The force (N) of this tick; `None` without parameters or where it is not finite.
    fn render(&mut self, moment: &AnchoredMoment<'_>) -> Option<Lanes>;

    /// Takes the forces of all modes in this tick, N. `pace`: how fast time runs by the motion.
    fn keep(&mut self, _forces_n: &[Option<Lanes>; SLOTS], _pace: f64) {}

    /// Takes a parcel that has just come, to judge what was kept `age_ticks` ago.
    fn judge(&mut self, _parcel: &LinkPacket, _age_ticks: usize) {}

    /// The modes `now` take the place of those `before`.
    fn compute(&mut self, _before: ModeSet, _now: ModeSet) {}

    /// Forgets everything.
    fn reset(&mut self) {}
}

clone_trait_object!(LeaderEnd);

/// The leader's parts of all modes, by [`Mode::index`]; of the baselines that of the one in the settings.
#[derive(Clone, Debug)]
pub(super) struct Leaders(Vec<Box<dyn LeaderEnd>>);

impl Leaders {
    pub(super) fn new(settings: &ImpedanceSettings) -> Self {
        let modes = Mode::ALL.into_iter().chain(settings.modes.baseline().map(Mode::Baseline));
        Self(modes.filter_map(|mode| Some((mode.entry()?.leader)(settings))).collect())
    }

    /// The force of every mode (N), by [`Mode::index`]. Nothing is made of a force that is not finite: limits would turn it into one of
    /// their edges.
    pub(super) fn render(
        &mut self,
        parcel: &LinkPacket,
        [now, then]: [&Posture; 2],
        x: &ImpedanceFeatures,
        age_ticks: usize,
    ) -> [Option<Lanes>; SLOTS] {
        let mut forces_n = [None; SLOTS];
        let measured_n = Lanes::from(parcel.force_n);
        if !measured_n.is_finite() {
            return forces_n;
        }
        for (slot, leader) in self.0.iter_mut().enumerate() {
            let moment = AnchoredMoment { parcel, measured_n, now, then, x, age_ticks, forces_n: &forces_n };
            forces_n[slot] = leader.render(&moment);
        }
        for mode in Mode::ALL.into_iter().filter(|mode| !parcel.modes.contains(*mode)) {
            forces_n[mode.index()] = None;
        }
        forces_n
    }

    pub(super) fn each(&mut self) -> impl Iterator<Item = &mut Box<dyn LeaderEnd>> {
        self.0.iter_mut()
    }
}
