//! The link of a pair: within this process, or from the machine that runs the follower's half.

use nalgebra::Vector3;
use nima_core::impedance::{IdentificationReport, ImpedanceSettings, LinkPacket, ParameterPack, SLOTS};

use super::{Link, Timing, follower_half::FollowerHalf};
use crate::{
    messages::{FarStop, ForceReport, ForceSource},
    rig::RemoteIdentification,
};

/// If no new packet arrives from the link for longer than this beyond its delay, s, that is a fault. The age gate has
/// removed the force long before. Longer than the pauses of an ordinary network, so that engagements do not end with
/// every lost burst.
pub(super) const LINK_SILENT_AFTER_S: f64 = 0.1;
/// Parameters that were not renewed for this long are not used for a force, s: a matched model remembers some seconds,
/// and a renewal arrives every 20 ms.
const PARAMETERS_OLD_S: f64 = 0.3;

/// The receiving end of a link between two machines: assembles the newest packet from the received messages.
#[derive(Clone, Debug)]
pub(super) struct FarLink {
    parcel: LinkPacket,
    /// Report of the identification there.
    report: IdentificationReport,
    /// Ticks from a command to its answer.
    behind: usize,
    /// Time of the last parameters of each slot, s.
    renewed_s: [f64; SLOTS],
    stop: Option<FarStop>,
    source: ForceSource,
    /// Whether the force in the packet may be rendered.
    is_usable: bool,
}

impl FarLink {
    const NEW: Self = Self {
        parcel: LinkPacket::BLANK,
        report: IdentificationReport::BLANK,
        behind: 0,
        // Never renewed, so that parameters of an earlier run count as old.
        renewed_s: [f64::NEG_INFINITY; SLOTS],
        stop: None,
        source: ForceSource::NoSample,
        is_usable: false,
    };

    fn take(&mut self, identified: &RemoteIdentification) {
        self.stop = identified.stop;
        self.source = identified.source;
        let parcel = &mut self.parcel;
        parcel.t_s = identified.t_s;
        parcel.force_n = identified.force_n;
        parcel.fresh = identified.fresh;
        parcel.resting = identified.resting;
        parcel.modes = identified.modes;
        let packed = &identified.packed;
        // Only a model that was accepted counts as renewed: damaged numbers change nothing.
        if packed.put_into(parcel)
            && let Some(renewed_s) = self.renewed_s.get_mut(usize::from(packed.slot))
        {
            *renewed_s = identified.t_s;
        }
        // Do not use parameters whose renewals are lost repeatedly: the received force is then reflected instead.
        for (slot, renewed_s) in self.renewed_s.iter().enumerate() {
            if identified.t_s - renewed_s > PARAMETERS_OLD_S {
                ParameterPack::forget(slot as u8, parcel);
            }
        }
        self.note(identified);
    }

    fn note(&mut self, identified: &RemoteIdentification) {
        self.report.note(&self.parcel);
        if let Some(errors_n) = identified.errors_n {
            self.report.horizon_error_n = errors_n.map(f64::from);
        }
    }
}

impl Link for FarLink {
    /// The delay is measured and cannot be set.
    fn set_delay(&mut self, _delay_s: f64) {}

    /// Packets under way are on the network.
    fn clear(&mut self) {}

    /// The follower's half sends at the other machine.
    fn send(&mut self, _parcel: &LinkPacket) {}

    fn receive(&mut self, _now_s: f64) -> Option<&LinkPacket> {
        self.is_usable.then_some(&self.parcel)
    }
}

/// One of two links: the pair's own link, or the far link once a message has arrived over it.
#[derive(Clone, Debug)]
pub(super) struct PairLink<L> {
    pub(super) own: L,
    far: Box<FarLink>,
    is_far: bool,
    delay_s: f64,
    /// Age of the own link's output beyond its delay, s.
    age_s: f64,
    rate_hz: f64,
}

impl<L: Link> PairLink<L> {
    pub(super) fn new(own: L, rate_hz: f64) -> Self {
        Self { own, far: Box::new(FarLink::NEW), is_far: false, delay_s: 0.0, age_s: 0.0, rate_hz }
    }

    /// Returns the delay over which the force is rendered, s.
    pub(super) const fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// Returns whether the follower's half runs at another machine, which then judges the modes; the delay is measured.
    pub(super) const fn is_far(&self) -> bool {
        self.is_far
    }

    /// Identifies a sample with the follower's half here, and sends the packets if permitted. The other machine has
    /// identified its samples already: of those, only the force that the plausibility check admits is written into the
    /// packet.
    pub(super) fn identify(&mut self, follower: &mut FollowerHalf, tip_m: &Vector3<f64>, timing: &Timing, sends: bool) {
        if !self.is_far {
            follower.identify(tip_m, timing, sends.then_some(&mut self.own));
        } else if self.far.is_usable {
            // The force at the tip after the checks of this machine, not the received one.
            self.far.parcel.force_n = follower.force.tip_n;
        }
    }

    /// Handles a tick without a sample.
    pub(super) fn miss(&self, follower: &mut FollowerHalf, timing: &Timing) {
        if !self.is_far {
            follower.miss(timing);
        }
    }

    /// Returns the report of the identification, at whichever machine it runs.
    pub(super) fn report<'a>(&'a self, follower: &'a FollowerHalf) -> &'a IdentificationReport {
        if self.is_far { &self.far.report } else { follower.identifier.report() }
    }

    /// Marks the last sample of another machine as too old to be rendered.
    pub(super) fn mute(&mut self) {
        self.far.is_usable = false;
    }

    /// Returns the reason why the other machine is stopped.
    pub(super) fn far_stop(&self) -> Option<FarStop> {
        self.far.stop
    }

    /// Switches to the far link, whose delay was measured; returns the delay (s) if it has changed.
    pub(super) fn turn_far(&mut self, identified: &RemoteIdentification, settings: &ImpedanceSettings) -> Option<f64> {
        // In ticks: a change below half a tick does not change the delay, and learning must not restart for it.
        let behind = settings.delay_ticks(identified.delay_s);
        if self.is_far && behind == self.far.behind {
            return None;
        }
        self.is_far = true;
        self.far.behind = behind;
        // The delay of whole ticks, so that both ends render with the same number.
        self.delay_s = behind as f64 / self.rate_hz;
        Some(self.delay_s)
    }

    /// Stores data from the far link, unless they are suppressed; returns the force in them.
    pub(super) fn receive_identified(&mut self, identified: Option<&RemoteIdentification>) -> ForceReport {
        let far = &mut *self.far;
        if let Some(identified) = identified {
            far.take(identified);
        }
        // A report that is missing in this tick leaves the last one, whose age is judged elsewhere.
        far.is_usable = far.source.is_usable();
        ForceReport::of_far_end(far.source, far.parcel.force_n)
    }

    /// Returns the ticks since the command was given that was active when the tip was measured; `silent_s`: time
    /// without a message over the network.
    pub(super) fn behind(&self, silent_s: f64) -> usize {
        self.far.behind + (silent_s * self.rate_hz).round() as usize
    }

    /// Records the age of the delivered packet, s; `None` without a packet.
    pub(super) fn note_age(&mut self, age_s: Option<f64>) {
        // Over a network the age is judged by the silence of the messages instead.
        self.age_s = age_s.filter(|_| !self.is_far).unwrap_or(0.0);
    }

    /// Returns whether the own link's packet is older than a silence of the devices. An engagement waits for the first
    /// new packet.
    pub(super) fn is_old(&self) -> bool {
        self.age_s > LINK_SILENT_AFTER_S
    }
}

impl<L: Link> Link for PairLink<L> {
    fn set_delay(&mut self, delay_s: f64) {
        self.delay_s = delay_s;
        self.own.set_delay(delay_s);
    }

    fn clear(&mut self) {
        self.own.clear();
    }

    fn send(&mut self, parcel: &LinkPacket) {
        self.own.send(parcel);
    }

    fn receive(&mut self, now_s: f64) -> Option<&LinkPacket> {
        if self.is_far { self.far.receive(now_s) } else { self.own.receive(now_s) }
    }
}
