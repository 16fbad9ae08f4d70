//! A device that tells the same block of readings again and again, as from a buffer that is not filled any more.

/// Readings that are kept: the longest block that is found.
const KEPT: usize = 256;
/// Readings in a row that must be the same as those of a block before, at least.
const RUN: u32 = 10;
/// So many changes in a row are the same as before by chance, for a device that has few values; it is not judged for [`CLEAN_S`].
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
        Self { words, count: 0, lag: 0, run: 0, changes: 0, most, clean_since_s: f64::NAN, told: false }
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
        } else {
            if self.changes >= BY_CHANCE && !self.told {
                self.clean_since_s = t_s;
            }
            self.lag = if changes { self.find(word) } else { 0 };
            self.run = u32::from(self.lag > 0);
            self.changes = self.run;
        }
        self.words[self.count % KEPT] = word;
        self.count += 1;
        self.told = self.run >= RUN && self.changes >= self.most && t_s - self.clean_since_s >= CLEAN_S;
        self.told
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
