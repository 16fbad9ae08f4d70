//! The interfaces that a rig expects of its devices, independent of the manufacturer. A driver implements the trait of
//! its kind in its own folder.
//!
//! Every part is a [`Device`] with a fixed type of reading; force sensors, trackers and switches need nothing else.
//! Commands neither wait nor allocate. A rig stores parts as `DeviceSlot<Box<dyn Leader>>` and so on; a virtual call costs a
//! few nanoseconds.

use nalgebra::Vector3;

use crate::{
    ARM_JOINTS, ArmReading, Device, DeviceIdentity, ForceReading, HandleReading, Health, Lever, PedalReading,
    TimedReading, TrackerReading,
};

pub trait Leader: Device<Reading = HandleReading> {
    /// Switches the force on or off. After switching on, the force is zero until it is set.
    fn switch_force(&mut self, on: bool);

    /// Sets the force on the hand and on the gripper, N, in the handle's own frame. Has no effect while the force is
    /// off.
    fn set_force(&mut self, force_n: Vector3<f64>, gripper_n: f64);

    /// Returns whether the force is on, if the device has reported a change since the last call.
    fn force_change(&mut self) -> Option<bool>;

    /// Connects `lever`, which switches the force off from another thread.
    fn attach(&self, lever: &Lever);
}

/// The arm that carries the instrument.
pub trait Follower: Device<Reading = ArmReading> {
    /// Requests servoing, in which the arm follows [`Follower::aim`]; [`ArmReading::servoing`] becomes true when the
    /// arm has entered it.
    fn enter_servoing(&mut self);

    fn leave_servoing(&mut self);

    /// Returns the commanded joint angles, rad; valid only while servoing.
    fn command_rad(&self) -> [f64; ARM_JOINTS];

    /// Returns the commands joint angles, rad: the next point of a path within the arm's limits. Returns false if they
    /// are refused; the arm then deviates from the path.
    fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> bool;

    /// Connects `lever`, which ends servoing from another thread.
    fn attach(&self, lever: &Lever);
}

pub trait ForceSensor: Device<Reading = ForceReading> {}

impl<D: Device<Reading = ForceReading>> ForceSensor for D {}

pub trait Tracker: Device<Reading = TrackerReading> {}

impl<D: Device<Reading = TrackerReading>> Tracker for D {}

/// A foot pedal or another switch.
pub trait Switch: Device<Reading = PedalReading> {}

impl<D: Device<Reading = PedalReading>> Switch for D {}

impl<D: Device + ?Sized> Device for Box<D> {
    type Reading = D::Reading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<D::Reading>> {
        (**self).poll(now_s)
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (**self).about()
    }
}
