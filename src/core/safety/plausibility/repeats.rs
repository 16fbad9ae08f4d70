//! Detects a device that sends the same block of readings again and again, for example from a buffer that is no longer
//! filled.

/// Number of stored readings: the longest block that can be found.
const KEPT: usize = 256;
/// Minimum number of consecutive readings that must equal an earlier block. Shorter runs occur by chance in a device
/// with few distinct values.
const RUN: u32 = 10;
/// Maximum number of readings of a block that a late loop missed the first time.
const MISSED_MAX: u32 = 2;
/// For a device with few values, a quarter of the changes that are a fault (at least two) recur by chance; such a
/// device is not judged for [`CLEAN_S`]. A device for which that happens less than once in 3 s repeats all of them less
/// than once in 1e9 s.
const BY_CHANCE: u32 = 2;
const CLEAN_S: f64 = 3.0;

/// The recent readings, each hashed to one word.
#[derive(Clone, Debug)]
pub(super) struct Repeats {
    words: [u64; KEPT],
    count: usize,
    /// Length of the block that currently repeats; 0 if none does.
    lag: usize,
    run: u32,
    /// Readings within the run that were not seen the first time.
    missed: u32,
    /// Number of changes from reading to reading in that run.
    changes: u32,
    /// Number of changes that makes the run a fault.
    max: u32,
    clean_since_s: f64,
    report: bool,
}

impl Repeats {
    /// Treats a run with `max` changes that all occurred before as a fault.
    pub(super) const fn new(max: u32) -> Self {
        let words = [0; KEPT];
        Self { words, count: 0, lag: 0, run: 0, missed: 0, changes: 0, max, clean_since_s: f64::NAN, report: false }
    }

    /// Returns the limit of [`Repeats::new`].
    pub(super) const fn max(&self) -> u32 {
        self.max
    }

    /// Adds a reading at `t_s`; returns whether it belongs to a repeated block.
    pub(super) fn look<const N: usize>(&mut self, channels: &[f64; N], t_s: f64) -> bool {
        let word = word_of(channels);
        if self.clean_since_s.is_nan() {
            self.clean_since_s = t_s;
        }
        // Only changes count: a device at rest repeats its reading without a fault.
        let changes = self.count == 0 || word != self.before(1);
        if self.lag > 0 && word == self.before(self.lag) {
            self.run += 1;
            self.changes += u32::from(changes);
        // Not in a coarse device: there the search would find a chance match at almost every reading.
        } else if let Some(lag) = self.skipped(word, changes) {
            self.lag = lag;
            self.run += 1;
            self.changes += 1;
        } else if self.is_fine() && self.lag > 0 && self.missed < MISSED_MAX {
            self.missed += 1;
        } else {
            // Few changes that repeat show that the device has few values; a real repeat has already been reported.
            if self.changes >= BY_CHANCE.max(self.max / 4) && !self.report {
                self.clean_since_s = t_s;
            }
            self.lag = if changes { self.find(word) } else { 0 };
            self.run = u32::from(self.lag > 0);
            self.missed = 0;
            self.changes = self.run;
        }
        // A ring: the newest reading overwrites the oldest.
        self.words[self.count % KEPT] = word;
        self.count += 1;
        self.report = self.run >= RUN && self.changes >= self.max && t_s - self.clean_since_s >= CLEAN_S;
        self.report
    }

    /// Returns whether readings hardly ever occur twice; positions of a slow hand do.
    const fn is_fine(&self) -> bool {
        self.max < RUN
    }

    /// Continues the run at another place, because a late loop does not receive every reading of a block.
    fn skipped(&self, word: u64, changes: bool) -> Option<usize> {
        (self.is_fine() && self.lag > 0 && changes).then(|| self.find(word)).filter(|lag| *lag > 0)
    }

    /// Returns the reading `ago` readings back.
    const fn before(&self, ago: usize) -> u64 {
        self.words[(self.count + KEPT - ago) % KEPT]
    }

    /// Returns how many readings ago this one last occurred; 0 if it has not.
    /// Starts at 2: a lag of 1 is a reading at rest, which is judged elsewhere.
    fn find(&self, word: u64) -> usize {
        (2..=self.count.min(KEPT)).find(|ago| self.before(*ago) == word).unwrap_or(0)
    }
}

/// Hashes all numbers of a reading to one word (FNV-1a over words); one reading in 2^64 collides.
fn word_of<const N: usize>(channels: &[f64; N]) -> u64 {
    // Offset basis and prime of FNV-1a (64 bits). The shift carries high bits down, which a multiplication never
    // does.
    channels.iter().fold(0xcbf2_9ce4_8422_2325, |word, channel| {
        let mixed = (word ^ channel.to_bits()).wrapping_mul(0x0100_0000_01b3);
        mixed ^ mixed >> 29
    })
}
