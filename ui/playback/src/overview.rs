//! Overview of a session along its time: maximum forces, states, and events.

use std::collections::BTreeMap;

use nima_devices::ConnectionState;
use nima_machine::{
    messages::{Event, LoopState, attention},
    rig::Side,
};
use nima_session::file::LineKind;

use super::feed::TickFrame;

/// Length of a bucket, s.
pub(super) const BUCKET_S: f64 = 0.5;

/// Maximum forces, and the state that needs most attention, in a short time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OverviewBucket {
    /// `None` if the force was never known.
    pub(super) measured_n: Option<f32>,
    /// `None` if it was never known.
    pub(super) rendered_n: Option<f32>,
    pub(super) state: Option<LoopState>,
}

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EventNote {
    pub(super) t_s: f64,
    pub(super) kind: LineKind,
    pub(super) words: String,
}

/// Calibration tables of a session: by side for those at the start, by number for later ones.
pub(super) type OverviewTables = BTreeMap<String, BTreeMap<String, String>>;

/// Results of reading a session.
#[derive(Clone, Debug, Default)]
pub(super) struct Overview {
    /// Number of the first bucket; a part has only its own.
    first: usize,
    pub(super) buckets: Vec<OverviewBucket>,
    pub(super) notes: Vec<EventNote>,
    /// Changes of devices: time (s), device, new state.
    pub(super) devices: Vec<(f64, usize, ConnectionState)>,
    /// Activated calibrations: time (s), side, number.
    pub(super) active: Vec<(f64, Side, u64)>,
    pub(super) read_s: f64,
}

impl Overview {
    /// Adds a tick; times must rise.
    pub(super) fn take(&mut self, frame: &TickFrame) {
        let number = (frame.t_s / BUCKET_S) as usize;
        if self.buckets.is_empty() {
            self.first = number;
        }
        let place = number.saturating_sub(self.first);
        if place >= self.buckets.len() {
            self.buckets.resize(place + 1, OverviewBucket::default());
        }
        for tick in frame.ticks.iter().flatten() {
            let state = Some(tick.state);
            let [measured_n, rendered_n] =
                [tick.measured_n, tick.rendering.rendered_n].map(|force_n| known_length(force_n.as_slice()));
            self.buckets[place].merge(&OverviewBucket { measured_n, rendered_n, state });
        }
        self.active.extend(frame.active.iter().map(|(side, number)| (frame.t_s, *side, *number)));
        self.devices.extend(frame.events.iter().filter_map(|event| match event {
            Event::Device(device) => Some((frame.t_s, usize::from(device.device), device.standing)),
            _ => None,
        }));
        self.read_s = frame.t_s;
    }

    /// Returns the state of this device at this time (s); closed before its first report.
    pub(super) fn standing(&self, device: usize, t_s: f64) -> ConnectionState {
        let of_device = |(at_s, which, _): &&(f64, usize, ConnectionState)| *which == device && *at_s <= t_s;
        self.devices.iter().rfind(of_device).map_or(ConnectionState::Closed, |(_, _, standing)| *standing)
    }

    /// Returns the active calibrations of this side at this time (s): start and number; `None`: those of the start.
    pub(super) fn calibrations(&self, side: Side, t_s: f64) -> Option<(f64, u64)> {
        let of_side = |(at_s, of, _): &&(f64, Side, u64)| *of == side && *at_s <= t_s;
        self.active.iter().rfind(of_side).map(|(at_s, _, number)| (*at_s, *number))
    }

    /// Adds the next part.
    pub(super) fn add(&mut self, part: Self) {
        let Self { first, buckets, notes, devices, active, read_s } = part;
        self.buckets.resize(self.buckets.len().max(first + buckets.len()), OverviewBucket::default());
        for (now, more) in self.buckets[first..].iter_mut().zip(&buckets) {
            now.merge(more);
        }
        self.notes.extend(notes);
        self.devices.extend(devices);
        self.active.extend(active);
        self.read_s = read_s;
    }
}

/// Returns the length of a force along the axes on which it is known: other programs record one or two axes.
fn known_length(force_n: &[f64]) -> Option<f32> {
    let known = force_n.iter().filter(|along_n| along_n.is_finite()).map(|along_n| along_n * along_n);
    known.reduce(|sum, square| sum + square).map(|sum| sum.sqrt() as f32)
}

impl OverviewBucket {
    pub(super) fn merge(&mut self, other: &Self) {
        self.measured_n = self.measured_n.into_iter().chain(other.measured_n).reduce(f32::max);
        self.rendered_n = self.rendered_n.into_iter().chain(other.rendered_n).reduce(f32::max);
        self.state = self.state.into_iter().chain(other.state).max_by_key(|state| attention(*state));
    }
}

#[cfg(test)]
mod tests {
    use nima_devices::Loss;
    use nima_machine::rig::{DeviceEvent, SIDES};

    use super::*;

    #[test]
    fn a_moment_has_the_devices_and_calibrations_that_it_had() {
        let device =
            |t_s, device, standing| Event::Device(DeviceEvent { t_s, device, standing, of_side: [true, false] });
        let frame = |t_s, events, active| TickFrame { t_s, active, events, ticks: [None; SIDES], objects: None };
        let mut parts = [Overview::default(), Overview::default()];
        parts[0].take(&frame(1.0, vec![device(1.0, 0, ConnectionState::Connected)], Vec::new()));
        parts[0].take(&frame(2.0, vec![device(2.0, 1, ConnectionState::Connected)], vec![(Side::Right, 4)]));
        parts[1].take(&frame(3.0, vec![device(3.0, 0, ConnectionState::Lost(Loss::Silent))], vec![(Side::Left, 5)]));
        let mut whole = Overview::default();
        for part in parts {
            whole.add(part);
        }
        let standing = |t_s| [0, 1].map(|device| whole.standing(device, t_s));
        assert_eq!(standing(0.5), [ConnectionState::Closed; 2]);
        assert_eq!(standing(2.0), [ConnectionState::Connected; 2]);
        assert_eq!(standing(9.0), [ConnectionState::Lost(Loss::Silent), ConnectionState::Connected]);
        assert_eq!(
            [1.9, 2.0, 9.0].map(|t_s| whole.calibrations(Side::Right, t_s)),
            [None, Some((2.0, 4)), Some((2.0, 4))]
        );
        assert_eq!(whole.calibrations(Side::Left, 2.9), None);
    }
}
