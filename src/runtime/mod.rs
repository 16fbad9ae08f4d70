//! Time and threads: runs the loop on the real clock in its own thread, or on the virtual clock as fast as it goes.
//!
//! Takes a [`Plan`]; gives a [`Handle`] (commands in; ticks and events out, over bounded queues) or a [`Summary`].
//! The real-time thread owns the rig and the loop. It never waits for a receiver: what does not fit is dropped and counted.

mod messages;
mod os;
mod summary;
mod supervisor;
mod thread;
mod virtual_clock;

pub use messages::{Command, Event, Fault, Tick};
pub use os::Scheduling;
pub use summary::{CpuShare, DeviceFigures, Histograms, ModeError, Summary};
pub use supervisor::STALL_MAX_S;
pub use thread::{Handle, StartError, start, start_on};
pub use virtual_clock::run_virtual;

use crate::{
    config::{Rig, Scene},
    device::{
        self, Roster, Side,
        rig::{DeviceRig, RigError, SensorPlace},
    },
    impedance::SettingsError,
    sim::{Desk, Worlds},
    teleop::{Calibrations, Loop},
};

/// What to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The rig.
    pub rig: Rig,
    /// The simulated world.
    pub scene: Scene,
    /// What is known of the wrist sensor and the tool: of the right arm pair, or the only one.
    pub calibrations: Calibrations,
    /// The same of the left arm pair; it needs none where the force is measured at the tip.
    pub left_calibrations: Calibrations,
    /// Engage as soon as everything is there: for simulated and emulated rigs only, where nobody can be hurt.
    pub engage: bool,
}

impl Plan {
    /// There is an arm pair of this side.
    pub fn has(&self, side: Side) -> bool {
        match &self.rig.devices {
            Some(devices) => devices.arm(side).is_some(),
            None => side == Side::Right || self.scene.left.is_some(),
        }
    }

    /// The calibrations of a side.
    pub const fn calibrations_of(&self, side: Side) -> &Calibrations {
        match side {
            Side::Right => &self.calibrations,
            Side::Left => &self.left_calibrations,
        }
    }

    /// The force at the tip is measured at the wrist on this side.
    pub fn is_at_wrist(&self, side: Side) -> bool {
        match &self.rig.devices {
            // What an emulated sensor feels is what the scene has.
            Some(devices) if !devices.emulated => {
                devices.arm(side).is_some_and(|arm| arm.sensor_at == SensorPlace::Wrist)
            }
            _ => self.scene.wrist.is_some(),
        }
    }

    /// The force at every tip will be known and the followers will obey: without that nothing may be engaged by itself.
    pub fn may_engage(&self) -> bool {
        let known = |side| !self.is_at_wrist(side) || self.calibrations_of(side).gravity.is_some();
        self.scene.person.is_none() && Side::ALL.into_iter().all(|side| !self.has(side) || known(side))
    }

    fn control(&self) -> Result<Loop, SettingsError> {
        // What the scene requires is identified; what it does not is left out.
        let mut rig = self.rig.clone();
        rig.identification.cross_talk |= self.scene.cross_talk;
        Loop::new(&rig, &Side::ALL.map(|side| self.has(side).then(|| self.calibrations_of(side).clone())))
    }

    /// The rig, and the devices in it.
    fn assemble(&self) -> Result<(Box<dyn device::Rig>, Roster), RigError> {
        if let Some(desk) = &self.rig.desk {
            let (desk, roster) = Desk::start(desk, self.worlds())?;
            return Ok((Box::new(desk), roster));
        }
        let Some(devices) = &self.rig.devices else { return Ok((Box::new(self.worlds()), Roster::new())) };
        let at_wrist = Side::ALL.map(|side| self.is_at_wrist(side));
        let (rig, roster) = DeviceRig::start(devices, 1.0 / self.rig.rate_hz, at_wrist)?;
        Ok((Box::new(rig), roster))
    }

    fn worlds(&self) -> Worlds {
        Worlds::new(&self.scene, self.rig.rate_hz)
    }
}
