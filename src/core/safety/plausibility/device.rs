//! Judges the readings of one device by themselves.

use super::{
    channel::{Around, Channel, Wrong},
    raw::{News, Pace, Raw, Step},
    repeats::Repeats,
};

#[derive(Clone, Debug)]
pub(super) struct Device<const N: usize> {
    pace: Pace,
    channels: [Channel; N],
    repeats: Repeats,
    wrong: Option<Wrong>,
}

impl<const N: usize> Device<N> {
    /// `most`: see [`Repeats::new`].
    pub(super) const fn new(most: u32) -> Self {
        Self { pace: Pace::NEW, channels: [Channel::NONE; N], repeats: Repeats::new(most), wrong: None }
    }

    pub(super) const fn wrong(&self) -> Option<Wrong> {
        self.wrong
    }

    /// Returns the step if this is a new reading; checks nothing else.
    pub(super) fn is_new(&mut self, raw: &Raw<N>) -> Option<Step> {
        match self.pace.look(raw) {
            News::Old => None,
            News::First => {
                let most = self.repeats.most();
                self.channels = [Channel::NONE; N];
                self.repeats = Repeats::new(most);
                self.wrong = None;
                Some(Step { t_s: 0.0, moved_s: f64::INFINITY })
            }
            News::New(step) => Some(step),
        }
    }

    /// Checks a new reading for a repeated block.
    pub(super) fn look_for_blocks(&mut self, raw: &Raw<N>, step: &Step) {
        self.wrong = self.repeats.look(&raw.channels, step.t_s).then_some(Wrong::Repeats);
    }

    /// Checks each number of a new reading; `around` returns the surroundings of a number by its index.
    pub(super) fn look_at_all(&mut self, raw: &Raw<N>, step: &Step, around: impl Fn(usize) -> Around) {
        self.look_for_blocks(raw, step);
        for (place, (channel, now)) in self.channels.iter_mut().zip(raw.channels).enumerate() {
            let wrong = channel.look(now, step.t_s, &around(place));
            // The first cause in the order of `Wrong`, regardless of the number.
            self.wrong = [self.wrong, wrong].into_iter().flatten().min();
        }
    }
}
