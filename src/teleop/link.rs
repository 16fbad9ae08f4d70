//! The link from follower to leader: what goes in comes out a programmed delay later, exact to one sample.
//!
//! Delivery goes by the parcels' own time, so a missed tick delays nothing but itself.

use crate::impedance::{MAX_DELAY_S, Parcel};

/// What a bad line does to parcels. A programmed link has none of it; studies of faults make it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weather {
    /// Nothing.
    #[default]
    Fair,
    /// Loses all.
    Silent,
    /// Loses every second one.
    LosesHalf,
    /// Delivers all so much later than it should, s.
    Late(f64),
    /// Exchanges neighbours.
    Swaps,
    /// Delivers everything twice.
    Doubles,
    /// Makes numbers of the force that are none.
    Poisons,
    /// Repeats one parcel under new time stamps.
    Repeats,
}

/// A ring of parcels on their way.
#[derive(Clone, Debug)]
pub struct Link {
    ring: Vec<Parcel>,
    /// Parcels sent so far; the newest is at `sent - 1` modulo the ring's length.
    sent: usize,
    /// Parcels delivered so far, in the same count.
    delivered: usize,
    delay_s: f64,
    half_period_s: f64,
    weather: Weather,
    /// Parcels that were to be sent since the weather changed, and one that is kept back.
    offered: usize,
    kept: Parcel,
}

impl Link {
    /// An empty link for a loop of this rate (Hz), with room for [`MAX_DELAY_S`].
    pub fn new(rate_hz: f64, delay_s: f64) -> Self {
        let room = (MAX_DELAY_S * rate_hz).ceil() as usize + 2;
        Self {
            ring: vec![Parcel::BLANK; room],
            sent: 0,
            delivered: 0,
            delay_s,
            half_period_s: 0.5 / rate_hz,
            weather: Weather::Fair,
            offered: 0,
            kept: Parcel::BLANK,
        }
    }

    /// Changes the delay (s, already a whole number of samples). A longer one goes back to what was delivered before.
    pub fn set_delay(&mut self, delay_s: f64) {
        self.delay_s = delay_s;
        self.delivered = self.oldest_kept();
    }

    fn oldest_kept(&self) -> usize {
        self.sent.saturating_sub(self.ring.len())
    }

    fn slot(&self, count: usize) -> usize {
        count % self.ring.len()
    }

    /// Makes the line a bad one, or a good one again.
    pub fn disturb(&mut self, weather: Weather) {
        (self.weather, self.offered) = (weather, 0);
    }

    /// Loses everything under way.
    pub fn clear(&mut self) {
        (self.sent, self.delivered) = (0, 0);
    }

    /// Sends one parcel. No allocation.
    pub fn send(&mut self, parcel: &Parcel) {
        let offered = self.offered;
        self.offered += 1;
        match self.weather {
            Weather::Fair | Weather::Late(_) => self.push(parcel),
            Weather::Silent => {}
            Weather::LosesHalf => {
                if offered.is_multiple_of(2) {
                    self.push(parcel);
                }
            }
            Weather::Swaps if offered.is_multiple_of(2) => self.kept = *parcel,
            Weather::Swaps => {
                let kept = self.kept;
                self.push(parcel);
                self.push(&kept);
            }
            Weather::Doubles => {
                self.push(parcel);
                self.push(parcel);
            }
            Weather::Poisons => {
                let mut poisoned = *parcel;
                poisoned.force_n.fill(f64::NAN);
                self.push(&poisoned);
            }
            Weather::Repeats => {
                if offered == 0 {
                    self.kept = *parcel;
                }
                let mut again = self.kept;
                again.t_s = parcel.t_s;
                self.push(&again);
            }
        }
    }

    fn push(&mut self, parcel: &Parcel) {
        let slot = self.slot(self.sent);
        self.ring[slot] = *parcel;
        self.sent += 1;
        self.delivered = self.delivered.max(self.oldest_kept());
    }

    /// The newest parcel that has been under way for the delay at `now_s`; `None` until the first arrives.
    pub fn receive(&mut self, now_s: f64) -> Option<&Parcel> {
        let late_s = if let Weather::Late(by_s) = self.weather { by_s } else { 0.0 };
        let due_s = now_s - self.delay_s - late_s + self.half_period_s;
        // Bounded by the ring's length; one step a tick except after a change of delay.
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

    fn parcel(t_s: f64) -> Parcel {
        Parcel { t_s, ..Parcel::BLANK }
    }

    #[test]
    fn the_delay_is_exact_to_one_sample() {
        for delay in [0_u32, 1, 50, 300, 1000] {
            let mut link = Link::new(1000.0, f64::from(delay) * 1e-3);
            for i in 0..3000_u32 {
                link.send(&parcel(f64::from(i) * 1e-3));
                let got = link.receive(f64::from(i) * 1e-3).map(|p| (p.t_s * 1e3).round() as u32);
                assert_eq!(got, i.checked_sub(delay));
            }
        }
    }

    #[test]
    fn a_missed_tick_and_a_changed_delay_lose_nothing() {
        let mut link = Link::new(1000.0, 0.05);
        let at = |link: &mut Link, i: u32| {
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
