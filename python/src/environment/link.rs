//! A link that can also deliver a force requested by an external controller.

use nalgebra::Vector3;
use nima_core::impedance::LinkPacket;
use nima_machine::teleop::{Link, ProgrammedLink};

/// The programmed link. While an external controller renders, a packet with the requested force replaces the newest
/// one. In the mode `dfr` it is the force requested from the gates, and nothing bypasses them.
#[derive(Debug)]
pub(super) struct OwnLink {
    under: ProgrammedLink,
    delay_s: f64,
    /// The force requested by the external controller, N, and the packet that contains it.
    asked_n: Option<Vector3<f64>>,
    own: LinkPacket,
    turned: bool,
    /// The force last delivered by the link itself, N.
    pub(super) delayed_n: Option<Vector3<f64>>,
}

impl OwnLink {
    pub(super) fn new(rate_hz: f64, delay_s: f64) -> Self {
        let under = ProgrammedLink::new(rate_hz, delay_s);
        let own = LinkPacket { fresh: true, ..LinkPacket::BLANK };
        Self { under, delay_s, asked_n: None, own, turned: false, delayed_n: None }
    }

    /// Requests this force from now on, N.
    pub(super) const fn ask(&mut self, force_n: Vector3<f64>) {
        self.asked_n = Some(force_n);
    }
}

impl Link for OwnLink {
    fn set_delay(&mut self, delay_s: f64) {
        self.delay_s = delay_s;
        self.under.set_delay(delay_s);
    }

    fn clear(&mut self) {
        self.under.clear();
    }

    fn send(&mut self, parcel: &LinkPacket) {
        self.under.send(parcel);
    }

    fn receive(&mut self, now_s: f64) -> Option<&LinkPacket> {
        let delivered = self.under.receive(now_s);
        self.delayed_n = delivered.map(|parcel| parcel.force_n);
        let Some(asked_n) = self.asked_n else { return self.under.receive(now_s) };
        // The frozen-data check triggers on values that repeat bit for bit. A controller may hold its force constant,
        // so alternate its last bit.
        self.turned = !self.turned;
        self.own.force_n = if self.turned { asked_n.map(f64::next_up) } else { asked_n };
        self.own.t_s = now_s - self.delay_s;
        Some(&self.own)
    }
}
