//! The leader's end of a replay, for a recording with the leader's motion.

use nalgebra::Vector3;
use nima_core::{
    impedance::{ImpedanceSettings, LinkPacket, RenderedForces, Renderer, SettingsError},
    signal::DelayLine,
};

/// Renders the data received over the link from the leader's motion.
pub(super) struct ReplayLeader {
    renderer: Renderer,
    link: DelayLine<LinkPacket>,
    delay: usize,
}

impl ReplayLeader {
    /// After a link of `delay` samples.
    pub(super) fn new(settings: &ImpedanceSettings, delay: usize) -> Result<Self, SettingsError> {
        Ok(Self { renderer: Renderer::new(settings)?, link: DelayLine::new(delay, LinkPacket::BLANK), delay })
    }

    /// Runs one tick with the data sent by the follower now and the leader's position, m.
    pub(super) fn step(&mut self, leader_m: &Vector3<f64>, sent: &LinkPacket) -> RenderedForces {
        self.link.push(*sent);
        self.renderer.step(leader_m, self.link.get(self.delay))
    }

    /// Called after a gap in the recording: clears everything, including data in transit.
    pub(super) fn reset(&mut self) {
        self.renderer.reset();
        self.link.clear();
    }
}
