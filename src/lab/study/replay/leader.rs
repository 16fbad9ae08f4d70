//! The leader's end of a replay, for a recording with the leader's motion.

use nalgebra::Vector3;
use nima_core::{
    impedance::{Parcel, Rendered, Renderer, Settings, SettingsError},
    signal::DelayLine,
};

/// Renders the data received over the link from the leader's motion.
pub(super) struct Leader {
    renderer: Renderer,
    link: DelayLine<Parcel>,
    delay: usize,
}

impl Leader {
    /// After a link of `delay` samples.
    pub(super) fn new(settings: &Settings, delay: usize) -> Result<Self, SettingsError> {
        Ok(Self { renderer: Renderer::new(settings)?, link: DelayLine::new(delay, Parcel::BLANK), delay })
    }

    /// Runs one tick with the data sent by the follower now and the leader's position, m.
    pub(super) fn step(&mut self, leader_m: &Vector3<f64>, sent: &Parcel) -> Rendered {
        self.link.push(*sent);
        self.renderer.step(leader_m, self.link.get(self.delay))
    }

    /// Called after a gap in the recording: clears everything, including data in transit.
    pub(super) fn reset(&mut self) {
        self.renderer.reset();
        self.link.clear();
    }
}
