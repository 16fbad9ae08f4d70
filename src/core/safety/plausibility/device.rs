//! Judges the readings of one device by themselves.

use super::{
    channel::{Around, PlausibilityChannel, ReadingFault},
    raw::{RawOutcome, RawPace, RawReading, RawStep},
    repeats::Repeats,
};

#[derive(Clone, Debug)]
pub(super) struct DeviceMemory<const N: usize> {
    pace: RawPace,
    channels: [PlausibilityChannel; N],
    repeats: Repeats,
    wrong: Option<ReadingFault>,
}

impl<const N: usize> DeviceMemory<N> {
    /// `max`: see [`Repeats::new`].
    pub(super) const fn new(max: u32) -> Self {
        Self { pace: RawPace::NEW, channels: [PlausibilityChannel::NONE; N], repeats: Repeats::new(max), wrong: None }
    }

    pub(super) const fn wrong(&self) -> Option<ReadingFault> {
        self.wrong
    }

    /// Returns the step if this is a new reading; checks nothing else.
    pub(super) fn is_new(&mut self, raw: &RawReading<N>) -> Option<RawStep> {
        match self.pace.look(raw) {
            RawOutcome::Old => None,
            RawOutcome::First => {
                let max = self.repeats.max();
                // After a gap nothing that was learnt applies: it may be another device.
                self.channels = [PlausibilityChannel::NONE; N];
                self.repeats = Repeats::new(max);
                self.wrong = None;
                Some(RawStep { t_s: 0.0, moved_s: f64::INFINITY })
            }
            RawOutcome::New(step) => Some(step),
        }
    }

    /// Checks a new reading for a repeated block.
    pub(super) fn look_for_blocks(&mut self, raw: &RawReading<N>, step: &RawStep) {
        self.wrong = self.repeats.look(&raw.channels, step.t_s).then_some(ReadingFault::Repeats);
    }

    /// Checks each number of a new reading; `around` returns the surroundings of a number by its index.
    pub(super) fn look_at_all(&mut self, raw: &RawReading<N>, step: &RawStep, around: impl Fn(usize) -> Around) {
        self.look_for_blocks(raw, step);
        for (place, (channel, now)) in self.channels.iter_mut().zip(raw.channels).enumerate() {
            let wrong = channel.look(now, step.t_s, &around(place));
            // The first cause in the order of `ReadingFault`, regardless of the number.
            self.wrong = [self.wrong, wrong].into_iter().flatten().min();
        }
    }
}
