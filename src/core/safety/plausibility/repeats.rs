//! A device that tells the same block of readings again and again, as from a buffer that is not filled any more.

/// Readings that are kept: the longest block that is found.
const KEPT: usize = 256;
/// Readings in a row that must be the same as those of a block before, at least.
const RUN: u32 = 10;
/// Readings of a block that a late loop did not see the first time.
const MISSED_MAX: u32 = 2;
/// A quarter of the changes that are a fault, but not fewer than two, come again by chance for a device that has few values; it is not judged for
/// [`CLEAN_S`]. A device for which that happens less than once in 3 s repeats all of them less than once in 1e9 s.
const BY_CHANCE: u32 = 2;
const CLEAN_S: f64 = 3.0;

/// The last readings, each as one word.
#[derive(Clone, Debug)]
pub(super) struct Repeats {
    words: [u64; KEPT],
    count: usize,
    /// Length of the block that repeats itself now; 0 if none does.
    lag: usize,
    run: u32,
    /// Readings within the run that were not seen before.
    missed: u32,
    /// Changes from reading to reading in that run.
    changes: u32,
    /// Changes that make the run a fault.
    most: u32,
    clean_since_s: f64,
    told: bool,
}

impl Repeats {
    /// `most` changes in a row that have all been before are a fault.
    pub(super) const fn new(most: u32) -> Self {
        let words = [0; KEPT];
        Self { words, count: 0, lag: 0, run: 0, missed: 0, changes: 0, most, clean_since_s: f64::NAN, told: false }
    }

    /// See [`Repeats::new`].
    pub(super) const fn most(&self) -> u32 {
        self.most
    }

    /// Takes a reading at `t_s`; whether it is one of a block that has been before.
    pub(super) fn look<const N: usize>(&mut self, channels: &[f64; N], t_s: f64) -> bool {
        let word = word_of(channels);
        if self.clean_since_s.is_nan() {
            self.clean_since_s = t_s;
        }
        let changes = self.count == 0 || word != self.before(1);
        if self.lag > 0 && word == self.before(self.lag) {
            self.run += 1;
            self.changes += u32::from(changes);
        } else if let Some(lag) = self.skipped(word, changes) {
            self.lag = lag;
            self.run += 1;
            self.changes += 1;
        } else if self.is_fine() && self.lag > 0 && self.missed < MISSED_MAX {
            self.missed += 1;
        } else {
            if self.changes >= BY_CHANCE.max(self.most / 4) && !self.told {
                self.clean_since_s = t_s;
            }
            self.lag = if changes { self.find(word) } else { 0 };
            self.run = u32::from(self.lag > 0);
            self.missed = 0;
            self.changes = self.run;
        }
        self.words[self.count % KEPT] = word;
        self.count += 1;
        self.told = self.run >= RUN && self.changes >= self.most && t_s - self.clean_since_s >= CLEAN_S;
        self.told
    }

    /// Whether its readings hardly ever come twice; positions of a slow hand do.
    const fn is_fine(&self) -> bool {
        self.most < RUN
    }

    /// A late loop does not see every reading of a block: the run goes on at another place.
    fn skipped(&self, word: u64, changes: bool) -> Option<usize> {
        (self.is_fine() && self.lag > 0 && changes).then(|| self.find(word)).filter(|lag| *lag > 0)
    }

    /// The reading so many ago.
    const fn before(&self, ago: usize) -> u64 {
        self.words[(self.count + KEPT - ago) % KEPT]
    }

    /// How many readings ago this one was last; 0 if it was not.
    fn find(&self, word: u64) -> usize {
        (2..=self.count.min(KEPT)).find(|ago| self.before(*ago) == word).unwrap_or(0)
    }
}

/// All numbers of a reading as one word (FNV-1a over words); one in 2^64 others has the same.
fn word_of<const N: usize>(channels: &[f64; N]) -> u64 {
    channels.iter().fold(0xcbf2_9ce4_8422_2325, |word, channel| {
        let mixed = (word ^ channel.to_bits()).wrapping_mul(0x0100_0000_01b3);
        mixed ^ mixed >> 29
    })
}
