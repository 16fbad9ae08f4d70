//! The leader's end of a replay, where the recording has its own motion.

use nalgebra::Vector3;
use nima_core::{
    impedance::{Parcel, Rendered, Renderer, Settings, SettingsError},
    signal::DelayLine,
};

/// Renders what came over the link from the leader's motion.
pub(super) struct Leader {
    renderer: Renderer,
    link: DelayLine<Parcel>,
    delay: usize,
}

impl Leader {
    /// Behind a link of `delay` samples.
    pub(super) fn new(settings: &Settings, delay: usize) -> Result<Self, SettingsError> {
        Ok(Self { renderer: Renderer::new(settings)?, link: DelayLine::new(delay, Parcel::BLANK), delay })
    }

    /// One tick: what the follower sends now, and where the leader is, m.
    pub(super) fn step(&mut self, leader_m: &Vector3<f64>, sent: &Parcel) -> Rendered {
        self.link.push(*sent);
        self.renderer.step(leader_m, self.link.get(self.delay))
    }

    /// After a hole in the recording: nothing is known, and nothing is under way.
    pub(super) fn reset(&mut self) {
        self.renderer.reset();
        self.link.clear();
    }
}
