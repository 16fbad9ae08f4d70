//! What a rig asks of its parts, whoever made them. A driver implements the trait of its part in its own folder.
//!
//! Every part is a [`Device`] with a fixed kind of reading; force sensors, trackers and switches need nothing beyond it. Commands neither
//! wait nor allocate. A rig keeps parts as `Slot<Box<dyn Leader>>` and so on: a call through the table costs some nanoseconds.

use nalgebra::Vector3;

use crate::{
    ARM_JOINTS, ArmReading, Device, ForceReading, HandleReading, Health, Identity, Lever, PedalReading, Stamped,
    TrackerReading,
};

/// The handle in the operator's hand.
pub trait Leader: Device<Reading = HandleReading> {
    /// Asks for force, or takes it away. Until a force is set it is zero.
    fn switch_force(&mut self, on: bool);

    /// Force on the hand and on the gripper, N, in the handle's own frame. Does nothing while force is off.
    fn set_force(&mut self, force_n: Vector3<f64>, gripper_n: f64);

    /// Whether force is on, by the newest word of the device; `None` where it said nothing since the last call.
    fn force_change(&mut self) -> Option<bool>;

    /// Attaches what takes the force away from another thread.
    fn attach(&self, lever: &Lever);
}

/// The arm that carries the instrument.
pub trait Follower: Device<Reading = ArmReading> {
    /// Asks the arm to obey [`Follower::aim`]; [`ArmReading::servoing`] tells when it does.
    fn enter_servoing(&mut self);

    /// Brakes, then obeys no longer.
    fn leave_servoing(&mut self);

    /// Where the joints are commanded to be, rad; has a meaning while servoing.
    fn command_rad(&self) -> [f64; ARM_JOINTS];

    /// Where the joints shall be now, rad: one step of a path that keeps to the arm's limits. False where it is refused: the arm is then
    /// not where the path has it.
    fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> bool;

    /// Attaches what takes the arm out of servoing from another thread.
    fn attach(&self, lever: &Lever);
}

/// A force-torque sensor.
pub trait ForceSensor: Device<Reading = ForceReading> {}

impl<D: Device<Reading = ForceReading>> ForceSensor for D {}

/// An optical tracker.
pub trait Tracker: Device<Reading = TrackerReading> {}

impl<D: Device<Reading = TrackerReading>> Tracker for D {}

/// A foot pedal or another switch.
pub trait Switch: Device<Reading = PedalReading> {}

impl<D: Device<Reading = PedalReading>> Switch for D {}

impl<D: Device + ?Sized> Device for Box<D> {
    type Reading = D::Reading;

    fn poll(&mut self, now_s: f64) -> Option<Stamped<D::Reading>> {
        (**self).poll(now_s)
    }

    fn about(&self) -> (&Health, &Identity) {
        (**self).about()
    }
}
