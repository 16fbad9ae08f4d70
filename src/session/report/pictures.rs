//! Figures of the endoscope's pictures in a session, from what is told of each: the pictures themselves are not read.

use serde::Serialize;

use crate::pictures::PictureFigures;

/// The endoscope's pictures in a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PicturesFigures {
    /// How many there are.
    pub count: u64,
    /// Their bytes.
    pub bytes: u64,
    /// How many are missing because the disk was too slow.
    pub dropped: u64,
    /// When the first and the last one arrived, s from the beginning of the session.
    pub times_s: [f64; 2],
    /// The longest time between two of them, s.
    pub longest_gap_s: f64,
}

impl PicturesFigures {
    pub(super) fn take(&mut self, t_s: f64, data: &[u8]) {
        let Ok(PictureFigures { bytes, dropped, .. }) = serde_json::from_slice(data) else { return };
        if self.count == 0 {
            self.times_s = [t_s; 2];
        }
        self.longest_gap_s = self.longest_gap_s.max(t_s - self.times_s[1]);
        self.times_s[1] = t_s;
        self.count += 1;
        self.bytes = self.bytes.saturating_add(bytes);
        self.dropped = dropped;
    }

    /// Pictures a second; `None` with fewer than two.
    pub fn rate_hz(&self) -> Option<f64> {
        let [first_s, last_s] = self.times_s;
        (last_s > first_s).then(|| (self.count - 1) as f64 / (last_s - first_s))
    }
}
