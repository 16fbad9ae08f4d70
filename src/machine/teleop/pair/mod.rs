//! One arm pair: handle, arm, force sensor, and the loop between them.
//!
//! ```text
//! FollowerHalf: readings → tip force → identification → packet      LeaderHalf: packet, hand → rendering → gates → handle
//!                  └──── PairLink: a delay in this process, or another machine ────┘
//! ```
//! `tick.rs` is one tick from top to bottom; `commands.rs` contains the changes of state between two ticks.

mod commands;
mod refusal_reasons;
mod tick;
mod watchdog_test;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Baseline, Identifier, ImpedanceSettings as IdentifierSettings, SettingsError},
    safety::{Interlock, Plausibility},
};
use nima_devices::ConnectionState;

use self::watchdog_test::WatchdogTest;
use super::{
    Accuracy, Calibrations, ForcePath, Link, ProgrammedLink, far_link::PairLink, follower_half::FollowerHalf,
    leader_half::LeaderHalf, samples::Samples, timing::Ticks,
};
use crate::{
    config::RigConfig,
    messages::{Event, Fault, LoopState, PeerStatus},
    rig::{Acts, DeviceEvent, Prompt, Side},
};

/// Maximum number of events in one tick; more are impossible.
pub const EVENTS_PER_TICK_MAX: usize = 6;

#[derive(Clone, Debug)]
pub struct Pair<L: Link = ProgrammedLink> {
    side: Side,
    /// Settings of the identification; only they define the conversion of a delay to ticks.
    settings: IdentifierSettings,
    interlock: Interlock<Fault>,
    follower: FollowerHalf,
    link: PairLink<L>,
    leader: LeaderHalf,
    plausibility: Plausibility,
    samples: Samples,
    ticks: Ticks,
    screen: ScreenRequests,
    accuracy: Accuracy,
    /// Whether a ready check has passed; `None` if none is required.
    checked: Option<bool>,
    releases: u8,
    watchdog_test: Option<WatchdogTest>,
    events: [Option<Event>; EVENTS_PER_TICK_MAX],
}

/// Requests of the operator at the screen to the rig.
#[derive(Clone, Copy, Debug)]
struct ScreenRequests {
    prompt: Prompt,
    guide_m: Option<Vector3<f64>>,
    grip_rad: Option<f64>,
    acts: Acts,
    /// Whether the simulated hand has released the handle; `None` if the handle is a device, which a person may hold.
    lets_go: Option<bool>,
}

impl Pair {
    /// Creates the pair of this side, idle, with leader and follower in this process. All memory is allocated here.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn new(rig: &RigConfig, side: Side, calibrations: &Calibrations) -> Result<Self, SettingsError> {
        Self::over(rig, side, calibrations, ProgrammedLink::new(rig.rate_hz, rig.delay_s))
    }
}

impl<L: Link> Pair<L> {
    /// Creates the pair with this link.
    ///
    /// # Errors
    /// The errors of [`Pair::new`].
    pub fn over(rig: &RigConfig, side: Side, calibrations: &Calibrations, link: L) -> Result<Self, SettingsError> {
        let settings = rig.settings();
        let mut this = Self {
            side,
            interlock: Interlock::default(),
            follower: FollowerHalf::new(&settings, calibrations)?,
            link: PairLink::new(link, rig.rate_hz),
            leader: LeaderHalf::new(rig, &settings)?,
            settings,
            plausibility: Plausibility::default(),
            samples: Samples::new(rig.rate_hz),
            ticks: Ticks::new(1.0 / rig.rate_hz),
            screen: ScreenRequests {
                prompt: Prompt::Rest,
                guide_m: None,
                grip_rad: None,
                acts: Acts::NONE,
                lets_go: rig.has_simulated_hand().then_some(false),
            },
            accuracy: Accuracy::default(),
            checked: rig.requires_check().then_some(false),
            releases: 0,
            watchdog_test: None,
            events: [None; EVENTS_PER_TICK_MAX],
        };
        // After construction, because both set parts that have to agree: link, identifier and renderer.
        this.set_delay(rig.delay_s);
        this.compute();
        Ok(this)
    }

    pub const fn side(&self) -> Side {
        self.side
    }

    pub(super) const fn force_path(&self) -> &ForcePath {
        &self.follower.force_path
    }

    /// Returns whether the force at the tip could be rendered in the last tick. True before the first sample, for which
    /// an engagement waits.
    pub(super) const fn may_know_force(&self) -> bool {
        self.follower.force.source.is_usable() || self.samples.last.is_none()
    }

    pub(super) const fn rate_hz(&self) -> f64 {
        self.settings.rate_hz
    }

    /// Returns the baseline that is computed together with the program's own modes, if the rig starts with one.
    pub const fn baseline(&self) -> Option<Baseline> {
        self.settings.modes.baseline()
    }

    pub const fn state(&self) -> LoopState {
        self.interlock.state()
    }

    pub const fn identifier(&self) -> &Identifier {
        &self.follower.identifier
    }

    pub const fn accuracy(&self) -> &Accuracy {
        &self.accuracy
    }

    pub const fn missed(&self) -> u64 {
        self.ticks.missed
    }

    pub(super) const fn link_mut(&mut self) -> &mut L {
        &mut self.link.own
    }

    /// Returns the events since [`Pair::clear_events`], oldest first.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.events.iter().flatten()
    }

    /// Removes all events; call before the commands of the next tick are handled.
    pub fn clear_events(&mut self) {
        self.events = [None; EVENTS_PER_TICK_MAX];
    }

    fn note(&mut self, event: Event) {
        if let Some(free) = self.events.iter_mut().find(|slot| slot.is_none()) {
            // More events than places are impossible (`EVENTS_PER_TICK_MAX`); one that did not fit would be lost, not
            // awaited.
            *free = Some(event);
        }
    }

    /// Handles a wrist sensor that was connected, lost or swapped.
    pub(super) const fn suspend_calibrations(&mut self) {
        self.follower.force_path.suspend();
    }

    /// Swaps the force path with `path`; refused while drives are on.
    pub(super) fn exchange_force_path(&mut self, path: &mut ForcePath) -> bool {
        let rests = !self.state().permits().drives;
        if rests {
            // A swap instead of a copy: the old path goes back to the caller and is freed outside the loop.
            std::mem::swap(&mut self.follower.force_path, path);
            // Another calibration changes the force, which is not a jump of the sensor.
            self.plausibility.force_is_new();
        }
        rests
    }

    /// Handles the connection or loss of a device of this pair.
    pub(super) fn notice(&mut self, event: &DeviceEvent) {
        if let ConnectionState::Lost(loss) = event.standing {
            self.fail_if_driven(Fault::DeviceLost { device: event.device, loss }, event.t_s);
        }
    }

    /// Returns whether this pair itself has a fault, which disengages the other pair in the next tick.
    pub fn has_failed(&self) -> bool {
        // Otherwise each pair would keep the other one failed, and neither could be released.
        matches!(self.state(), LoopState::Faulted(fault) if fault != Fault::OtherArm)
    }

    /// Returns the state of the pair for the other machine.
    pub(super) fn bulletin(&self) -> PeerStatus<'_> {
        PeerStatus {
            side: self.side,
            state: self.state(),
            mode: self.leader.modes.mode,
            compares: self.leader.modes.compares,
            delay_s: self.link.delay_s(),
            releases: self.releases,
            source: self.follower.force.source,
            parcel: self.follower.identifier.parcel(),
            report: self.follower.identifier.report(),
        }
    }
}
