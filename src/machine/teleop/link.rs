//! The link from follower to leader: a packet leaves it a programmed delay after it was sent, exact to one sample.
//!
//! Delivery is by the time stamps of the packets, so a missed tick does not delay other packets.

use std::fmt::Debug;

use nima_core::impedance::{LinkPacket, MAX_DELAY_S};

/// Carries packets from follower to leader. An implementation neither waits nor allocates.
pub trait Link: Debug + Send {
    /// Changes the programmed delay (s, already a whole number of samples).
    fn set_delay(&mut self, delay_s: f64);

    fn clear(&mut self);

    fn send(&mut self, parcel: &LinkPacket);

    /// Returns the newest packet that has been under way for the delay at `now_s`; `None` until the first one arrives.
    fn receive(&mut self, now_s: f64) -> Option<&LinkPacket>;
}

/// A ring buffer of packets under way, within one process.
#[derive(Clone, Debug)]
pub struct ProgrammedLink {
    ring: Vec<LinkPacket>,
    /// Number of packets sent; the newest is at `sent - 1` modulo the length of the ring.
    sent: usize,
    delivered: usize,
    delay_s: f64,
    half_period_s: f64,
}

impl ProgrammedLink {
    /// Creates an empty link for a loop of this rate (Hz), with room for [`MAX_DELAY_S`].
    pub fn new(rate_hz: f64, delay_s: f64) -> Self {
        // Two more than the longest delay: one for the newest packet and one for rounding.
        let room = (MAX_DELAY_S * rate_hz).ceil() as usize + 2;
        Self { ring: vec![LinkPacket::BLANK; room], sent: 0, delivered: 0, delay_s, half_period_s: 0.5 / rate_hz }
    }

    fn oldest_kept(&self) -> usize {
        // Older packets have been overwritten.
        self.sent.saturating_sub(self.ring.len())
    }

    fn slot(&self, count: usize) -> usize {
        count % self.ring.len()
    }
}

impl Link for ProgrammedLink {
    /// If the delay increases, packets that were already delivered are delivered again.
    fn set_delay(&mut self, delay_s: f64) {
        self.delay_s = delay_s;
        // Searched again from the oldest packet, because with another delay another packet is the newest due one.
        self.delivered = self.oldest_kept();
    }

    fn clear(&mut self) {
        self.sent = 0;
        self.delivered = 0;
    }

    fn send(&mut self, parcel: &LinkPacket) {
        let slot = self.slot(self.sent);
        self.ring[slot] = *parcel;
        self.sent += 1;
        // Overwritten packets can no longer be delivered.
        self.delivered = self.delivered.max(self.oldest_kept());
    }

    fn receive(&mut self, now_s: f64) -> Option<&LinkPacket> {
        // Half a period of tolerance: times are sums of rounded periods, and a packet must arrive in its own tick.
        let due_s = now_s - self.delay_s + self.half_period_s;
        // Steps at most through the whole ring; one step per tick except after a change of the delay.
        while self.delivered < self.sent && self.ring[self.slot(self.delivered)].t_s <= due_s {
            self.delivered += 1;
        }
        let newest = self.delivered.checked_sub(1)?;
        (newest >= self.oldest_kept()).then(|| &self.ring[self.slot(newest)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parcel(t_s: f64) -> LinkPacket {
        LinkPacket { t_s, ..LinkPacket::BLANK }
    }

    #[test]
    fn the_delay_is_exact_to_one_sample() {
        for delay in [0_u32, 1, 50, 300, 1000] {
            let mut link = ProgrammedLink::new(1000.0, f64::from(delay) * 1e-3);
            for i in 0..3000_u32 {
                link.send(&parcel(f64::from(i) * 1e-3));
                let got = link.receive(f64::from(i) * 1e-3).map(|p| (p.t_s * 1e3).round() as u32);
                assert_eq!(got, i.checked_sub(delay));
            }
        }
    }

    #[test]
    fn a_missed_tick_and_a_changed_delay_lose_nothing() {
        let mut link = ProgrammedLink::new(1000.0, 0.05);
        let at = |link: &mut ProgrammedLink, i: u32| {
            link.send(&parcel(f64::from(i) * 1e-3));
            link.receive(f64::from(i) * 1e-3).map(|p| (p.t_s * 1e3).round() as u32)
        };
        for i in 0..100 {
            at(&mut link, i);
        }
        assert_eq!(at(&mut link, 110), Some(60), "ten ticks were missed, the age is still 50 ms");
        assert_eq!(at(&mut link, 155), Some(99), "nothing was sent between 99 and 110");
        link.set_delay(0.1);
        assert_eq!(at(&mut link, 156), Some(56), "a longer delay goes back");
        link.set_delay(0.0);
        assert_eq!(at(&mut link, 157), Some(157));
    }
}
