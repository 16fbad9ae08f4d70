//! A client's subscriptions and their timing.

use std::time::Instant;

use super::super::super::ContentKind;

/// Interval between two bundles, s: the default, the minimum, and the maximum. 60 Hz is the rate of a screen; above 100
/// Hz a client would only fill its own queue.
const USUAL_S: f64 = 1.0 / 60.0;
const SHORTEST_S: f64 = 0.01;
const LONGEST_S: f64 = 1.0;
/// A tick that is early by up to this time counts as the due one, s. Otherwise rounding of the times would skip a tick
/// and halve the rate.
pub(in super::super) const EARLY_S: f64 = 1e-4;

/// A set of message kinds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct Kinds(u16);

impl Kinds {
    const fn bit(kind: ContentKind) -> u16 {
        1 << kind as u16
    }

    pub(in super::super) const fn has(self, kind: ContentKind) -> bool {
        self.0 & Self::bit(kind) != 0
    }

    const fn insert(&mut self, kind: ContentKind) {
        self.0 |= Self::bit(kind);
    }

    const fn remove(&mut self, kind: ContentKind) {
        self.0 &= !Self::bit(kind);
    }

    pub(in super::super) const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns the kinds that are part of a state.
    pub(in super::super) fn of_moment(self) -> impl Iterator<Item = ContentKind> {
        let is_other =
            |kind: &ContentKind| matches!(kind, ContentKind::Image | ContentKind::Capability | ContentKind::Status);
        ContentKind::ALL.into_iter().filter(move |kind| self.has(*kind) && !is_other(kind))
    }
}

/// The subscriptions of a client.
#[derive(Debug)]
pub(in super::super) struct Wants {
    streams: Kinds,
    once: Kinds,
    interval_s: f64,
    /// Time of the loop at which the next bundle is due, s.
    pub(in super::super) due_s: f64,
    /// When the next status is due; `None`: now.
    pub(in super::super) status_due: Option<Instant>,
}

impl Default for Wants {
    fn default() -> Self {
        let mut streams = Kinds::default();
        for kind in
            [ContentKind::Transform, ContentKind::Tracking, ContentKind::Sensor, ContentKind::Text, ContentKind::Status]
        {
            streams.insert(kind);
        }
        Self { streams, once: Kinds::default(), interval_s: USUAL_S, due_s: f64::NEG_INFINITY, status_due: None }
    }
}

impl Wants {
    /// Subscribes to this kind, with this interval if given.
    pub(super) fn start(&mut self, kind: ContentKind, interval_ms: Option<u32>) {
        self.streams.insert(kind);
        if let Some(interval_ms) = interval_ms.filter(|interval_ms| *interval_ms > 0) {
            self.interval_s = (f64::from(interval_ms) * 1e-3).clamp(SHORTEST_S, LONGEST_S);
        }
        self.due_s = f64::NEG_INFINITY;
    }

    /// Ends the subscription to this kind.
    pub(super) fn stop(&mut self, kind: ContentKind) {
        self.streams.remove(kind);
    }

    /// Requests this kind once.
    pub(super) fn ask(&mut self, kind: ContentKind) {
        self.once.insert(kind);
    }

    /// Returns and clears the one-time requests for the loop's data.
    pub(in super::super) fn take_asked(&mut self) -> Kinds {
        let asked = self.once_of_loop();
        self.once.0 &= !asked.0;
        asked
    }

    /// Returns whether there is a one-time request for the loop's data.
    pub(in super::super) const fn asks(&self) -> bool {
        !self.once_of_loop().is_empty()
    }

    const fn once_of_loop(&self) -> Kinds {
        let mut asked = self.once;
        asked.remove(ContentKind::Image);
        asked
    }

    /// Returns whether the client requests status messages.
    pub(in super::super) fn wants_states(&self) -> bool {
        self.streams.has(ContentKind::Status)
    }

    /// Returns whether the client requests images.
    pub(in super::super) fn looks(&self) -> bool {
        self.streams.has(ContentKind::Image) || self.once.has(ContentKind::Image)
    }

    /// Called when the client has received an image.
    pub(in super::super) fn has_seen(&mut self) {
        self.once.remove(ContentKind::Image);
    }

    /// Returns the data due at this time of the loop, s, and sets the next time.
    pub(in super::super) fn due(&mut self, t_s: f64) -> Option<Kinds> {
        // The clock belongs to another loop.
        if self.due_s > t_s + 2.0 * LONGEST_S {
            self.due_s = t_s;
        }
        if t_s < self.due_s - EARLY_S {
            return None;
        }
        let next_s = self.due_s + self.interval_s;
        self.due_s = if next_s > t_s { next_s } else { t_s + self.interval_s };
        Some(self.streams)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bundles in ten seconds of a loop of 1 kHz, and the minimum and maximum interval, ms.
    fn bundles(wants: &mut Wants) -> (usize, u32, u32) {
        let due: Vec<u32> = (0..10_000_u32).filter(|ms| wants.due(f64::from(*ms) * 1e-3).is_some()).collect();
        let between = || due.windows(2).map(|pair| pair[1] - pair[0]);
        (due.len(), between().min().unwrap(), between().max().unwrap())
    }

    #[test]
    fn a_client_gets_the_rate_that_it_asks_for_within_limits() {
        assert_eq!(bundles(&mut Wants::default()), (600, 16, 17));
        for (asked_ms, expected) in [
            (33, (304, 33, 33)),
            (100, (100, 100, 100)),
            (10, (1000, 10, 10)),
            (1, (1000, 10, 10)),
            (0, (600, 16, 17)),
            (u32::MAX, (10, 1000, 1000)),
        ] {
            let mut wants = Wants::default();
            wants.start(ContentKind::Tracking, Some(asked_ms));
            assert_eq!(bundles(&mut wants), expected, "{asked_ms} ms");
        }
    }

    #[test]
    fn a_loop_that_begins_anew_is_told_at_once() {
        let mut wants = Wants::default();
        assert!(wants.due(1000.0).is_some() && wants.due(1000.001).is_none());
        assert!(wants.due(0.0).is_some() && wants.due(0.001).is_none());
        // After a pause, missed messages are not sent later.
        assert!(wants.due(0.9).is_some() && wants.due(0.901).is_none());
    }

    #[test]
    fn kinds_are_wanted_until_they_are_stopped_and_once_is_once() {
        let mut wants = Wants::default();
        let kinds = |wants: &mut Wants, t_s| wants.due(t_s).unwrap().of_moment().collect::<Vec<_>>();
        assert_eq!(
            kinds(&mut wants, 0.0),
            [ContentKind::Transform, ContentKind::Tracking, ContentKind::Sensor, ContentKind::Text]
        );
        wants.stop(ContentKind::Tracking);
        wants.stop(ContentKind::Sensor);
        wants.start(ContentKind::Turned, None);
        wants.start(ContentKind::Image, None);
        assert_eq!(kinds(&mut wants, 1.0), [ContentKind::Transform, ContentKind::Turned, ContentKind::Text]);
        assert!(wants.looks() && wants.wants_states() && !wants.asks());
        wants.ask(ContentKind::Sensor);
        assert!(wants.asks() && wants.take_asked().has(ContentKind::Sensor) && !wants.asks());
        wants.stop(ContentKind::Image);
        wants.ask(ContentKind::Image);
        assert!(wants.looks() && !wants.asks());
        wants.has_seen();
        assert!(!wants.looks());
    }
}
