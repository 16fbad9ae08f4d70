//! The readings of one device, judged by themselves.

use super::{
    channel::{Around, Channel, Wrong},
    raw::{News, Pace, Raw, Step},
    repeats::Repeats,
};

/// The memory of one device of `N` numbers.
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

    /// What is wrong with the newest reading.
    pub(super) const fn wrong(&self) -> Option<Wrong> {
        self.wrong
    }

    /// Whether this is a new reading; nothing else is looked at.
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

    /// Looks for a block that repeats itself, in a new reading.
    pub(super) fn look_for_blocks(&mut self, raw: &Raw<N>, step: &Step) {
        self.wrong = self.repeats.look(&raw.channels, step.t_s).then_some(Wrong::Repeats);
    }

    /// Looks at each number of a new reading too; `around` tells what surrounds it by its place.
    pub(super) fn look_at_all(&mut self, raw: &Raw<N>, step: &Step, around: impl Fn(usize) -> Around) {
        self.look_for_blocks(raw, step);
        for (place, (channel, now)) in self.channels.iter_mut().zip(raw.channels).enumerate() {
            let wrong = channel.look(now, step.t_s, &around(place));
            // The first cause in the order of `Wrong`, whichever number it is of.
            self.wrong = [self.wrong, wrong].into_iter().flatten().min();
        }
    }
}
