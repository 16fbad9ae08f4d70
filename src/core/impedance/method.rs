//! Trait of the rendering methods: one part at each end of the link, and the parameters sent between them.
//!
//! `mode` lists all methods; this file runs them.

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

/// Rendering method. Its prediction error is the error of its leader part, which the identifier also runs on the follower's motion.
pub trait RenderingMethod {
    /// The name on the command line, in files and on the screen.
    const NAME: &'static str;
    /// Short description for tables.
    const ABOUT: &'static str;
    /// Whether the method uses a window of samples; the length of the window is then one of its settings.
    const HAS_WINDOW: bool = false;
    /// Whether the method selects a polynomial degree; the maximum degree is then one of its settings.
    const HAS_DEGREES: bool = false;
    /// Whether the force of the method is damped if the leader's motion is measured at the handle.
    const IS_DAMPED: bool = false;
    /// Modes whose forces the method uses: they are computed with it, and precede it in the list.
    const PARTS: &'static [Mode] = &[];
    /// Field of the method's parameters in a packet, if it sends any.
    const PARAMETERS: Option<Place> = None;

    /// Returns the follower part; `None` if the measured force and the parameters of other modes are enough.
    fn follower(_settings: &ImpedanceSettings, _delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        None
    }

    fn leader(settings: &ImpedanceSettings) -> Box<dyn LeaderEnd>;

    /// Returns the selected degree; 0: none.
    fn degree(_report: &IdentificationReport) -> u8 {
        0
    }

    /// Copies the results of the follower part from a packet to a report.
    fn note(_models: &Models, _report: &mut IdentificationReport) {}
}

/// Access to the parameters of a method in a packet.
pub type Place = fn(&mut Models) -> &mut dyn PackedParameters;

/// Row of the list of methods.
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
    pub const fn of<M: RenderingMethod>() -> Self {
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

/// Input of a follower part for one sample.
#[derive(Clone, Copy, Debug)]
pub struct MethodInput<'a> {
    pub posture: &'a Posture,
    /// The paper's `X`.
    pub x: &'a ImpedanceFeatures,
    /// The force, or the last good one, N.
    pub force_n: Lanes,
    /// The sample was measured, not interpolated.
    pub good: bool,
    /// Whether the filters that compute the features have settled.
    pub usable: bool,
    /// The method may learn from the sample.
    pub learn: bool,
    /// The packet that the leader has now; without a delay, the previous packet.
    pub sent: Option<&'a LinkPacket>,
}

/// Follower part of a method: learns from samples and writes its parameters into the packet.
pub trait FollowerEnd: Debug + DynClone + Send + Sync {
    /// Returns whether these modes need it.
    fn serves(&self, modes: ModeSet) -> bool;

    /// Returns whether the method restarts when the modes change from `before` to `now`.
    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        self.serves(now) && !self.serves(before)
    }

    fn take(&mut self, seen: &MethodInput<'_>, parcel: &mut LinkPacket, report: &mut IdentificationReport);

    fn set_delay(&mut self, _delay_ticks: usize) {}

    fn reset(&mut self);

    /// Returns the paper's solutions of every degree, if it computes them.
    fn paper(&self) -> Option<&LiteralSolver> {
        None
    }

    /// Returns the nested solutions for the newest window, if it computes them.
    fn nested(&self) -> Option<&ImpedanceSolution> {
        None
    }
}

clone_trait_object!(FollowerEnd);

/// Follower parts of the modes in the settings.
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

    /// Returns the first result of this kind.
    pub(super) fn find<'a, T>(&'a self, of: impl Fn(&'a dyn FollowerEnd) -> Option<T>) -> Option<T> {
        self.0.iter().find_map(|follower| of(&**follower))
    }
}

/// Input of a leader part for one tick.
#[derive(Clone, Copy, Debug)]
pub struct LeaderInput<'a> {
    pub parcel: &'a LinkPacket,
    /// Force in the packet, N; finite.
    pub measured_n: Lanes,
    /// The leader's motion now, and at the time of the packet.
    pub now: &'a Posture,
    pub then: &'a Posture,
    /// The paper's `X` of the leader's motion.
    pub x: &'a ImpedanceFeatures,
    /// Age of the packet.
    pub age_ticks: usize,
    /// Forces of the earlier modes in the list, N, by [`Mode::index`].
    pub forces_n: &'a [Option<Lanes>; SLOTS],
}

/// Leader part of a method: computes a force from the newest packet and the leader's motion.
pub trait LeaderEnd: Debug + DynClone + Send + Sync {
    /// Returns the force (N) of this tick; `None` without parameters or if the force is not finite.
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes>;

    /// Stores the forces of all modes in this tick, N. `pace`: rate of the motion clock.
    fn keep(&mut self, _forces_n: &[Option<Lanes>; SLOTS], _pace: f64) {}

    /// Compares a newly received packet with the forces stored `age_ticks` ago.
    fn judge(&mut self, _parcel: &LinkPacket, _age_ticks: usize) {}

    /// Replaces the computed modes `before` by the modes `now`.
    fn compute(&mut self, _before: ModeSet, _now: ModeSet) {}

    fn reset(&mut self) {}
}

clone_trait_object!(LeaderEnd);

/// Leader parts of all modes, by [`Mode::index`], and of the baseline in the settings.
#[derive(Clone, Debug)]
pub(super) struct Leaders(Vec<Box<dyn LeaderEnd>>);

impl Leaders {
    pub(super) fn new(settings: &ImpedanceSettings) -> Self {
        let modes = Mode::ALL.into_iter().chain(settings.modes.baseline().map(Mode::Baseline));
        Self(modes.filter_map(|mode| Some((mode.entry()?.leader)(settings))).collect())
    }

    /// Returns the force of every mode (N), by [`Mode::index`]. A non-finite measured force gives no forces, because
    /// clamping would turn it into one of the limits.
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
        // In order: a mode may use the forces of those before it (`PARTS`).
        for (slot, leader) in self.0.iter_mut().enumerate() {
            let moment = LeaderInput { parcel, measured_n, now, then, x, age_ticks, forces_n: &forces_n };
            forces_n[slot] = leader.render(&moment);
        }
        // Cleared afterwards instead of skipped, so that each leader sees every tick.
        for mode in Mode::ALL.into_iter().filter(|mode| !parcel.modes.contains(*mode)) {
            forces_n[mode.index()] = None;
        }
        forces_n
    }

    pub(super) fn each(&mut self) -> impl Iterator<Item = &mut Box<dyn LeaderEnd>> {
        self.0.iter_mut()
    }
}
