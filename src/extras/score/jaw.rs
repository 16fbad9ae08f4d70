//! Number of jaw openings.

/// Open above the first, closed below the second, rad: 20 and 10 degrees, so that noise and play do not count.
const OPEN_RAD: f64 = 0.35;
const CLOSED_RAD: f64 = 0.175;

/// Counts openings with hysteresis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jaw {
    open: Option<bool>,
    openings: u32,
}

impl Jaw {
    pub(crate) fn take(&mut self, jaw_rad: f64) {
        let open = match self.open {
            Some(true) => jaw_rad >= CLOSED_RAD,
            _ => jaw_rad > OPEN_RAD,
        };
        // A jaw that is open from the beginning was not opened in this trial.
        if open && self.open == Some(false) {
            self.openings += 1;
        }
        self.open = Some(open);
    }

    /// `None` if there was never an angle.
    pub(crate) fn openings(self) -> Option<f64> {
        self.open.map(|_| f64::from(self.openings))
    }
}
