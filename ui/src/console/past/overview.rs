//! A whole session in little: its largest forces, its states, and what happened, along its time.

use nima_machine::messages::{LoopState, attention};
use nima_session::file::LineKind;

use super::feed::Frame;

/// Length of a bucket, s.
pub(super) const BUCKET_S: f64 = 0.5;

/// The largest forces and the state that needs most attention in a short time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bucket {
    pub(super) measured_n: f32,
    pub(super) rendered_n: f32,
    pub(super) state: Option<LoopState>,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Note {
    pub(super) t_s: f64,
    pub(super) kind: LineKind,
    pub(super) words: String,
}

/// What has been read of a session.
#[derive(Clone, Debug, Default)]
pub(super) struct Overview {
    /// By their numbers; a part has only its own.
    first: usize,
    pub(super) buckets: Vec<Bucket>,
    pub(super) notes: Vec<Note>,
    pub(super) read_s: f64,
}

impl Overview {
    /// Takes in a tick; rising in time.
    pub(super) fn take(&mut self, frame: &Frame) {
        let number = (frame.t_s / BUCKET_S) as usize;
        if self.buckets.is_empty() {
            self.first = number;
        }
        let place = number.saturating_sub(self.first);
        if place >= self.buckets.len() {
            self.buckets.resize(place + 1, Bucket::default());
        }
        for tick in frame.ticks.iter().flatten() {
            let state = Some(tick.state);
            let (measured_n, rendered_n) = (tick.measured_n.norm() as f32, tick.rendered_n.norm() as f32);
            self.buckets[place].merge(&Bucket { measured_n, rendered_n, state });
        }
        self.read_s = frame.t_s;
    }

    /// Takes in the next part.
    pub(super) fn add(&mut self, part: Self) {
        let Self { first, buckets, notes, read_s } = part;
        self.buckets.resize(self.buckets.len().max(first + buckets.len()), Bucket::default());
        for (now, more) in self.buckets[first..].iter_mut().zip(&buckets) {
            now.merge(more);
        }
        self.notes.extend(notes);
        self.read_s = read_s;
    }
}

impl Bucket {
    /// `f32::max` leaves out what is not a number.
    pub(super) fn merge(&mut self, other: &Self) {
        self.measured_n = self.measured_n.max(other.measured_n);
        self.rendered_n = self.rendered_n.max(other.rendered_n);
        self.state = self.state.into_iter().chain(other.state).max_by_key(|state| attention(*state));
    }
}
