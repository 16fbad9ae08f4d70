//! Time and threads: runs the loop on the real clock in its own thread, or on the virtual clock as fast as it goes.
//!
//! Takes a [`Plan`]; gives a [`Handle`] (commands in; ticks and events out, over bounded queues) or a [`Summary`].
//! The real-time thread owns the rig and the loop. It never waits for a receiver: what does not fit is dropped and counted.

mod messages;
mod os;
mod summary;
mod thread;
mod virtual_clock;

pub use messages::{Command, Event, Fault, Tick};
pub use os::Scheduling;
pub use summary::{ModeError, Summary};
pub use thread::{Handle, StartError, start};
pub use virtual_clock::run_virtual;

use crate::{
    config::{Rig, Scene},
    impedance::SettingsError,
    sim::World,
    teleop::{Calibrations, Loop},
};

/// What to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The rig.
    pub rig: Rig,
    /// The simulated world.
    pub scene: Scene,
    /// What is known of the wrist sensor and the tool.
    pub calibrations: Calibrations,
    /// Engage at the first tick: for simulated rigs only, where nobody can be hurt.
    pub engage: bool,
}

impl Plan {
    /// The force at the tip will be known and the follower will obey: without that nothing may be engaged by itself.
    pub const fn may_engage(&self) -> bool {
        self.scene.person.is_none() && (self.scene.wrist.is_none() || self.calibrations.gravity.is_some())
    }

    fn control(&self) -> Result<Loop, SettingsError> {
        // What the scene requires is identified; what it does not is left out.
        let mut rig = self.rig.clone();
        rig.identification.cross_talk |= self.scene.cross_talk;
        Loop::new(&rig, &self.calibrations)
    }

    fn world(&self) -> World {
        World::new(&self.scene, self.rig.rate_hz)
    }
}
