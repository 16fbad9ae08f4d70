//! Statistics of the endoscope images in a session, from the properties recorded with each image; the images themselves
//! are not read.

use serde::Serialize;

use crate::images::ImageFigures;

/// The endoscope images in a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ImageReport {
    /// Number of images.
    pub count: u64,
    /// Total size, bytes.
    pub bytes: u64,
    /// Number of images that are missing because the disk was too slow or the camera too fast.
    pub dropped: u64,
    /// Arrival of the first and the last image, s since the start of the session.
    pub times_s: [f64; 2],
    /// Maximum time between two images, s.
    pub longest_gap_s: f64,
}

impl ImageReport {
    pub(super) fn take(&mut self, t_s: f64, data: &[u8]) {
        let Ok(ImageFigures { bytes, dropped, .. }) = serde_json::from_slice(data) else { return };
        if self.count == 0 {
            self.times_s = [t_s; 2];
        }
        self.longest_gap_s = self.longest_gap_s.max(t_s - self.times_s[1]);
        self.times_s[1] = t_s;
        self.count += 1;
        self.bytes = self.bytes.saturating_add(bytes);
        self.dropped = dropped;
    }

    /// Returns the frames per second; `None` with fewer than two.
    pub fn rate_hz(&self) -> Option<f64> {
        let [first_s, last_s] = self.times_s;
        (last_s > first_s).then(|| (self.count - 1) as f64 / (last_s - first_s))
    }
}
