//! Forces looked up by mode, with "not valid" as `None`.

use nalgebra::Vector3;

use super::{Mode, Rendered, Report};

impl Rendered {
    /// Force of `mode` (N); `None` where it has nothing valid.
    pub fn force(&self, mode: Mode) -> Option<Vector3<f64>> {
        self.valid[mode.index()].then(|| self.force_n[mode.index()])
    }
}

impl Report {
    /// What `mode` would render now (N) from data up to `t - D`; `None` where it has nothing valid.
    pub fn prediction(&self, mode: Mode) -> Option<Vector3<f64>> {
        self.prediction_valid[mode.index()].then(|| self.prediction_n[mode.index()])
    }
}
