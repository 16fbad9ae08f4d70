//! A haptic handle that controls the right hand of a simulated rig instead of the simulated hand, so that a person
//! feels the simulated tissue.
//!
//! The loop gets position, orientation and gripper of the handle in the handle's own frame, as on a rig with devices,
//! and its force goes to the handle in the same tick. Without a recent reading the side has no sample, and the loop
//! enters a fault. Drives are on only after the handle has reported that its force is on.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    kinematics::HandPose,
    safety::{RawReading, RawReadings},
};
use nima_devices::{ConnectionState, DeviceSlot, HandleReading, Health, Leader, Lever, TimedReading};
use nima_machine::rig::{GUIDE_MAX_M, Inputs, LeaderSettings, Outputs, RigError, RosterEntry};

/// A reading older than this counts as missing, s, as on a rig with devices.
const OLDEST_S: f64 = 0.020;

/// The handle on the desk.
#[derive(Debug)]
pub(super) struct HapticInput {
    slot: DeviceSlot<Box<dyn Leader>>,
    lever: Lever,
    newest: Option<TimedReading<HandleReading>>,
    driven: bool,
    force_is_on: bool,
}

impl HapticInput {
    /// Starts to open the device.
    pub(super) fn start(settings: &LeaderSettings) -> Result<(Self, RosterEntry), RigError> {
        let lever = Lever::default();
        let (slot, entry) = settings.start(&lever)?;
        Ok((Self { slot, lever, newest: None, driven: false, force_is_on: false }, entry))
    }

    pub(super) const fn health(&self) -> &Health {
        self.slot.health()
    }

    pub(super) fn lever(&self) -> Lever {
        self.lever.clone()
    }

    fn is_there(&self) -> bool {
        self.slot.health().standing == ConnectionState::Connected
    }

    /// Reads new data; returns the handle's position, m, limited to the range that the simulated hand can follow.
    pub(super) fn poll(&mut self, now_s: f64) -> Option<Vector3<f64>> {
        if let Some(reading) = self.slot.poll(now_s) {
            self.newest = Some(reading);
        }
        let changed = self.slot.device().and_then(|handle| handle.force_change());
        self.force_is_on = changed.unwrap_or(self.force_is_on) && self.is_there();
        let fresh = self.newest.filter(|reading| self.is_there() && now_s - reading.arrival_s <= OLDEST_S);
        self.newest = fresh;
        fresh.map(|reading| reading.value.position_m.map(|axis| axis.clamp(-GUIDE_MAX_M, GUIDE_MAX_M)))
    }

    /// Returns the measurements of its side with this hand instead of the simulated one.
    pub(super) fn led(&self, now_s: f64, simulated: &Inputs) -> Option<Inputs> {
        let inputs = *simulated;
        let reading = self.newest?;
        let HandleReading { position_m, orientation, gripper_rad, .. } = reading.value;
        let turn = orientation.unwrap_or_else(UnitQuaternion::identity);
        let mut frames = inputs.frames;
        frames.leader_from_handle = Some(nalgebra::Isometry3::from_parts(position_m.into(), turn));
        let TimedReading { device_s, arrival_s, .. } = reading;
        let handle = Some(RawReading { channels: position_m.into(), device_s, arrival_s });
        Some(Inputs {
            raw: RawReadings { handle, ..inputs.raw },
            hand: HandPose { position_m, orientation },
            gripper_rad: gripper_rad.or(inputs.gripper_rad),
            frames,
            powered: inputs.powered && self.force_is_on,
            age_s: inputs.age_s.max(now_s - reading.arrival_s),
            ..inputs
        })
    }

    /// Sends the loop's force to the handle.
    pub(super) fn write(&mut self, outputs: &Outputs) {
        let switched = std::mem::replace(&mut self.driven, outputs.drives) != outputs.drives;
        let Some(handle) = self.slot.device() else { return };
        // Only an engagement switches the force on: a handle that was reopened stays off until the next engagement.
        if switched {
            handle.switch_force(outputs.drives);
        }
        let (force_n, gripper_n) =
            if outputs.drives { (outputs.hand_force_n, outputs.gripper_n) } else { (Vector3::zeros(), 0.0) };
        handle.set_force(force_n, gripper_n);
    }
}
