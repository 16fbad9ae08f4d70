//! The link of a pair: within this process, or from the machine at which the follower's half works.

use nima_core::impedance::{Packed, Parcel, Report, SLOTS, Settings};

use super::Link;
use crate::{
    messages::{FarStop, ForceReport, ForceSource},
    rig::Identified,
};

/// No new parcel from the link for longer than this beyond its delay, s, is a fault. The age gate has removed the force
/// long before.
pub(super) const LINK_SILENT_AFTER_S: f64 = 0.1;
/// Parameters that were not renewed for so long make no force, s: a matched model remembers some seconds, and a renewal comes every
/// 20 ms.
const PARAMETERS_OLD_S: f64 = 0.3;

/// The end of a link between two machines: puts the newest parcel together from what comes of it.
#[derive(Clone, Debug)]
pub(super) struct FarLink {
    parcel: Parcel,
    /// What is known of the identification there.
    report: Report,
    /// Ticks from a command to the answer to it.
    behind: usize,
    /// When the parameters of each slot last came, s.
    renewed_s: [f64; SLOTS],
    stop: Option<FarStop>,
    source: ForceSource,
    /// The force in the parcel may be rendered.
    is_usable: bool,
}

impl FarLink {
    /// Nothing has come.
    const NEW: Self = Self {
        parcel: Parcel::BLANK,
        report: Report::BLANK,
        behind: 0,
        renewed_s: [f64::NEG_INFINITY; SLOTS],
        stop: None,
        source: ForceSource::NoSample,
        is_usable: false,
    };

    /// What is known of the identification at the other machine.
    pub(super) const fn report(&self) -> &Report {
        &self.report
    }

    /// Puts the force that plausibility admits into the parcel.
    pub(super) const fn admit(&mut self, force: &ForceReport) {
        if self.is_usable {
            self.parcel.force_n = force.tip_n;
        }
    }

    /// The last sample is too old to be rendered.
    pub(super) const fn mute(&mut self) {
        self.is_usable = false;
    }

    fn take(&mut self, identified: &Identified) {
        self.stop = identified.stop;
        self.source = identified.source;
        let parcel = &mut self.parcel;
        parcel.t_s = identified.t_s;
        parcel.force_n = identified.force_n;
        parcel.fresh = identified.fresh;
        parcel.resting = identified.resting;
        parcel.modes = identified.modes;
        let packed = &identified.packed;
        if packed.put_into(parcel)
            && let Some(renewed_s) = self.renewed_s.get_mut(usize::from(packed.slot))
        {
            *renewed_s = identified.t_s;
        }
        // Parameters that are lost again and again are no parameters: the force is then reflected as it came.
        for (slot, renewed_s) in self.renewed_s.iter().enumerate() {
            if identified.t_s - renewed_s > PARAMETERS_OLD_S {
                Packed::forget(slot as u8, parcel);
            }
        }
        self.note(identified);
    }

    fn note(&mut self, identified: &Identified) {
        self.report.note(&self.parcel);
        if let Some(errors_n) = identified.errors_n {
            self.report.horizon_error_n = errors_n.map(f64::from);
        }
    }
}

impl Link for FarLink {
    /// The delay is measured.
    fn set_delay(&mut self, _delay_s: f64) {}

    /// What is under way is on the network.
    fn clear(&mut self) {}

    /// The follower's half sends at the other machine.
    fn send(&mut self, _parcel: &Parcel) {}

    fn receive(&mut self, _now_s: f64) -> Option<&Parcel> {
        self.is_usable.then_some(&self.parcel)
    }
}

/// One of two links: the pair's own, or the far one, once something has come over it.
#[derive(Clone, Debug)]
pub(super) struct PairLink<L> {
    /// The link within this process.
    pub(super) own: L,
    far: Box<FarLink>,
    is_far: bool,
    delay_s: f64,
    /// Age, beyond its delay, of what the own link delivers, s.
    age_s: f64,
    rate_hz: f64,
}

impl<L: Link> PairLink<L> {
    pub(super) fn new(own: L, rate_hz: f64) -> Self {
        Self { own, far: Box::new(FarLink::NEW), is_far: false, delay_s: 0.0, age_s: 0.0, rate_hz }
    }

    /// The delay over which the force is rendered, s.
    pub(super) const fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// The far link, if the follower's half is at another machine.
    pub(super) fn far(&self) -> Option<&FarLink> {
        self.is_far.then_some(&*self.far)
    }

    /// The far link, if the follower's half is at another machine.
    pub(super) fn far_mut(&mut self) -> Option<&mut FarLink> {
        self.is_far.then_some(&mut *self.far)
    }

    /// Why the other machine is stopped.
    pub(super) fn far_stop(&self) -> Option<FarStop> {
        self.far.stop
    }

    /// Turns to the far link, whose delay was measured; returns the delay (s) if it is another one than before.
    pub(super) fn turn_far(&mut self, identified: &Identified, settings: &Settings) -> Option<f64> {
        let behind = settings.delay_ticks(identified.delay_s);
        if self.is_far && behind == self.far.behind {
            return None;
        }
        self.is_far = true;
        self.far.behind = behind;
        self.delay_s = behind as f64 / self.rate_hz;
        Some(self.delay_s)
    }

    /// Takes what came over the far link, if it is not withheld; returns the force in it.
    pub(super) fn hear(&mut self, identified: Option<&Identified>) -> ForceReport {
        let far = &mut *self.far;
        if let Some(identified) = identified {
            far.take(identified);
        }
        far.is_usable = far.source.is_usable();
        ForceReport::of_far_end(far.source, far.parcel.force_n)
    }

    /// Ticks since the command was given that was active when the tip was measured; `silent_s`: how long nothing came over a network.
    pub(super) fn behind(&self, silent_s: f64) -> usize {
        self.far.behind + (silent_s * self.rate_hz).round() as usize
    }

    /// Notes the age of what was delivered, s; `None` if nothing was.
    pub(super) fn note_age(&mut self, age_s: Option<f64>) {
        self.age_s = age_s.filter(|_| !self.is_far).unwrap_or(0.0);
    }

    /// Whether what the own link delivers is from before a silence of the devices. An engagement waits for the first new parcel.
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

    fn send(&mut self, parcel: &Parcel) {
        self.own.send(parcel);
    }

    fn receive(&mut self, now_s: f64) -> Option<&Parcel> {
        if self.is_far { self.far.receive(now_s) } else { self.own.receive(now_s) }
    }
}
