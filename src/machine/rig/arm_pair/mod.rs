//! The devices of one side (handle, arm, force sensor, servos) and the kinematics between tip position (m) and joint
//! angles (rad).

mod measured;

use nalgebra::{Isometry3, IsometryMatrix3, UnitQuaternion, Vector3};
use nima_core::kinematics::{Inverse, Joints};
use nima_devices::{ArmReading, DeviceSlot, Follower, ForceSensor, Health, Leader, Lever, TimedReading, dynamixel};

use super::{
    ArmSet, Gauge, RigEnds, RigError, RigPart,
    device_identity::{DeviceIdentities, ServoObjections},
    devices::{OLDEST_S, is_there},
    engage_blocker::{ArmAndMarker, AwaitedDevice, EngageBlocker},
    jaws::JawsControl,
    starting::{servos_opener, start},
};
use crate::rig::{Inputs, Outputs, PlannedTip, Roster, Side, ViewOrientation};

pub use measured::{DeliveringDevices, SideReadings};

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SharedReadings {
    pub(super) tissue_n: Option<Vector3<f64>>,
    /// Pose of the marker on this side's instrument, in the camera's frame.
    pub(super) c_from_m: Option<Isometry3<f64>>,
    /// Orientation of the endoscope in the camera's frame: `c_from_view`.
    pub(super) c_from_view: ViewOrientation,
    /// Pose of the endoscope's marker in the camera's frame.
    pub(super) c_from_n: Option<Isometry3<f64>>,
}

impl SharedReadings {
    fn m_from_c(&self) -> Option<UnitQuaternion<f64>> {
        self.c_from_m.map(|c_from_m| c_from_m.rotation.inverse())
    }
}

fn rigid(pose: &IsometryMatrix3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(pose.translation, UnitQuaternion::from_rotation_matrix(&pose.rotation))
}

#[derive(Debug)]
struct FollowerSlots {
    arm: DeviceSlot<Box<dyn Follower>>,
    sensor: DeviceSlot<Box<dyn ForceSensor>>,
}

#[derive(Debug)]
pub struct ArmPair {
    levers: [Lever; 2],
    /// `None` if the handle is at another machine.
    handle: Option<DeviceSlot<Box<dyn Leader>>>,
    /// `None` if arm and sensor are at another machine.
    follower: Option<FollowerSlots>,
    servos: Option<(DeviceSlot<dynamixel::DynamixelDriver>, JawsControl)>,
    servos_known: ServoObjections,
    measured: SideReadings,
    /// Deliveries of handle, arm, sensor and servos since the last [`ArmPair::take_gauges`].
    gauges: [Gauge; 4],
    /// Orientation of the handle at its first reading.
    held_from: Option<UnitQuaternion<f64>>,
    period_s: f64,
    inverse: Option<Inverse>,
    /// Whether the drives were permitted in the last tick.
    driven: bool,
}

impl ArmPair {
    pub(super) fn start(
        side: Side,
        set: &ArmSet,
        period_s: f64,
        at_wrist: bool,
        ends: RigEnds,
        known: &DeviceIdentities,
        roster: &mut Roster,
    ) -> Result<Self, RigError> {
        let measured = SideReadings::new(side, set, period_s, at_wrist)?;
        let levers = [Lever::default(), Lever::default()];
        let [of_handle, of_arm] = levers.clone();
        // With one handle there is nothing to confuse, and any device of the model may be used.
        let leader = if known.has_both_sides() { set.handle.for_hand_of(side) } else { set.handle.clone() };
        let handle = ends.have_leader().then(|| {
            start(RigPart::Handle(side), leader.opener(), known, roster, move |handle| handle.attach(&of_handle))
        });
        let handle = handle.transpose()?;
        let follower = ends.have_follower().then(|| {
            let arm = start(RigPart::Arm(side), set.arm.opener(measured.mount.model()), known, roster, move |arm| {
                arm.attach(&of_arm);
            })?;
            let sensor = start(RigPart::Sensor(side), set.sensor.opener(), known, roster, |_| ())?;
            Ok::<_, std::io::Error>(FollowerSlots { arm, sensor })
        });
        let follower = follower.transpose()?;
        let servos = set.servos.clone().filter(|_| ends.have_follower()).map(|settings| {
            let slot = start(RigPart::Servos(side), servos_opener(settings), known, roster, |_| ())?;
            Ok::<_, std::io::Error>((slot, JawsControl::new(set.jaws, period_s)))
        });
        Ok(Self {
            levers,
            handle,
            follower,
            servos: servos.transpose()?,
            servos_known: known.servos_of(side),
            measured,
            gauges: [Gauge::NONE; 4],
            held_from: None,
            period_s,
            inverse: None,
            driven: false,
        })
    }

    pub(super) fn poll(&mut self, now_s: f64) {
        let [of_handle, of_arm, of_sensor, of_servos] = &mut self.gauges;
        if let Some(reading) = self.handle.as_mut().and_then(|slot| slot.poll(now_s)) {
            // Relative to the first reading, because the zero of a handle differs from device to device.
            let from = self.held_from.get_or_insert(reading.value.orientation.unwrap_or_default());
            of_handle.handle(&reading.value, from);
            self.measured.take_handle(reading);
        }
        if let Some(reading) = self.follower.as_mut().and_then(|slots| slots.arm.poll(now_s)) {
            of_arm.arm(&reading.value, self.measured.mount.model().joints());
            self.measured.take_arm(reading);
        }
        if let Some(reading) = self.follower.as_mut().and_then(|slots| slots.sensor.poll(now_s)) {
            of_sensor.sensor(&reading.value);
            self.measured.take_force(reading);
        }
        if let Some((slot, _)) = &mut self.servos
            && let Some(reading) = slot.poll(now_s)
        {
            of_servos.servos(&reading.value);
            self.measured.turned = Some(reading);
        }
        if let Some(handle) = &self.handle {
            of_handle.tick(handle.health(), now_s, self.period_s);
        }
        if let Some(FollowerSlots { arm, sensor }) = &self.follower {
            of_arm.tick(arm.health(), now_s, self.period_s);
            of_sensor.tick(sensor.health(), now_s, self.period_s);
        }
        if let Some((slot, _)) = &self.servos {
            of_servos.tick(slot.health(), now_s, self.period_s);
        }
        if let Some(slot) = &mut self.handle {
            // The device reports only changes, so the last state is kept while it is connected.
            let changed = slot.device().and_then(|handle| handle.force_change());
            // A handle that was lost has no force, whatever it reported last.
            self.measured.force_is_on = changed.unwrap_or(self.measured.force_is_on && is_there(slot));
        }
        // Only while the drives are off, because the reason concerns the next engagement.
        if !self.driven {
            let begin = |joints: TimedReading<ArmReading>| self.measured.begin(&joints.value.joint_rad.into()).err();
            let of_servos = self.servos.as_ref().and_then(|_| self.servos_known.obstacle());
            self.measured.obstacle =
                of_servos.or_else(|| self.measured.joints.and_then(begin).map(EngageBlocker::Start));
        }
    }

    /// Returns the measurements; `None` unless every device of the force path delivers data and no reading is too old.
    pub(in crate::rig) fn inputs(&self, now_s: f64, shared: &SharedReadings) -> Option<Inputs> {
        let follower = self.follower.as_ref().map(|slots| is_there(&slots.arm) && is_there(&slots.sensor));
        let delivering = DeliveringDevices { handle: self.handle.as_ref().map(is_there), follower };
        let jaws = self.servos.as_ref().map(|(slot, control)| (control, is_there(slot)));
        let planned = PlannedTip::of(self.inverse.as_ref());
        self.measured.with(now_s, delivering, jaws, shared).map(|inputs| Inputs { planned, ..inputs })
    }

    /// Returns the poses of arm and marker while the drives are off; `c_from_m` is the marker as measured by the
    /// tracker.
    pub(super) fn shown(&self, c_from_m: Option<Isometry3<f64>>) -> Option<ArmAndMarker> {
        let SideReadings { mount, rcm, hand_eye, .. } = self.measured;
        let joints = Joints::from(self.measured.joints.filter(|_| !self.driven)?.value.joint_rad);
        let base_from_s1 = rigid(&(mount.world_from_base().inverse() * mount.pose(&joints).world_from_s1));
        Some(ArmAndMarker { mount, rcm, joints, base_from_s1, hand_eye, c_from_m })
    }

    /// Records that a device has not reported its side yet, unless there is another obstacle.
    pub(super) fn wait_for(&mut self, awaited: AwaitedDevice) {
        self.measured.obstacle.get_or_insert(EngageBlocker::Waiting(awaited));
    }

    /// Records that a device is at the wrong part, which takes precedence over any other reason.
    pub(super) const fn object(&mut self, obstacle: EngageBlocker) {
        self.measured.obstacle = Some(obstacle);
    }

    pub(super) fn write(&mut self, now_s: f64, outputs: &Outputs) {
        // Only on a change: a drive that has switched itself off must not be switched on again by the next tick.
        if outputs.drives != self.driven {
            self.driven = outputs.drives;
            self.switch_drives(outputs.drives);
        }
        // Even while the drives are off and the force is zero, this keeps the handle in step with the loop.
        if let Some(handle) = self.handle.as_mut().and_then(DeviceSlot::device) {
            let (hand_n, gripper_n) =
                if outputs.drives { (outputs.hand_force_n, outputs.gripper_n) } else { (Vector3::zeros(), 0.0) };
            handle.set_force(hand_n, gripper_n);
        }
        self.lead(outputs.tip_command_m.filter(|_| outputs.drives));
        self.turn(now_s, outputs.world_from_jaws);
    }

    /// Switches the drives on only when commanded: drives that switched themselves off stay off until the next
    /// engagement.
    fn switch_drives(&mut self, on: bool) {
        // When switched off, the arm leaves servoing only once it has come to rest.
        if let (true, Some(arm)) = (on, self.follower.as_mut().and_then(|slots| slots.arm.device())) {
            arm.enter_servoing();
        }
        if let Some(handle) = self.handle.as_mut().and_then(DeviceSlot::device) {
            handle.switch_force(on);
        }
        if let Some((slot, control)) = &mut self.servos {
            control.reset();
            if let Some(servos) = slot.device() {
                servos.set_torque(on);
            }
        }
    }

    /// Plans one step of the joints: towards the tip's target or, without a target, braking along a path through the
    /// trocar.
    fn lead(&mut self, tip_command_m: Option<Vector3<f64>>) {
        let arm = self.follower.as_mut().and_then(|slots| slots.arm.device());
        // Without an arm or its angles no plan is possible; the next one starts from a measurement.
        let (Some(arm), Some(joints)) = (arm, self.measured.joints) else {
            self.inverse = None;
            return;
        };
        let measured_rad = Joints::from(joints.value.joint_rad);
        if self.inverse.is_none() && tip_command_m.is_some() {
            // Start from the commanded angles, so that the first command does not jump.
            let from_rad = if joints.value.servoing { Joints::from(arm.command_rad()) } else { measured_rad };
            match self.measured.begin(&from_rad) {
                Ok(inverse) => self.inverse = Some(inverse),
                Err(obstacle) => self.measured.obstacle = Some(EngageBlocker::Start(obstacle)),
            }
        }
        let Some(arm) = self.follower.as_mut().and_then(|slots| slots.arm.device()) else { return };
        if let Some(inverse) = &mut self.inverse {
            inverse.observe(&measured_rad);
            let step = match tip_command_m {
                Some(target_m) => inverse.step(&target_m),
                None => inverse.brake(),
            };
            let at_rest = tip_command_m.is_none() && inverse.is_still();
            // After a refused command the arm is not where the plan assumes it to be, so plan again from the actual
            // position.
            if !arm.aim(step.joint_rad.as_ref()) || at_rest {
                self.inverse = None;
            }
        }
        // Not before the arm is at rest, because outside servoing it leaves the planned path through the trocar.
        if !self.driven && self.inverse.is_none() {
            arm.leave_servoing();
        }
    }

    fn turn(&mut self, now_s: f64, world_from_jaws: Option<UnitQuaternion<f64>>) {
        let (Some(world_from_jaws), Some(pose)) = (world_from_jaws, &self.measured.pose) else { return };
        let Some(turned) = self.measured.turned.filter(|turned| now_s - turned.arrival_s <= OLDEST_S) else { return };
        let gripper_rad = self.measured.hand.and_then(|hand| hand.value.gripper_rad);
        let Some((slot, control)) = &mut self.servos else { return };
        let s1_from_jaws = pose.orientation().inverse() * world_from_jaws;
        let goals = control.goals(now_s, &s1_from_jaws, gripper_rad, &turned.value);
        if let Some(servos) = slot.device() {
            servos.set_goals(&goals);
        }
    }

    /// Begins to close all devices; see [`DeviceSlot::retire`].
    pub(super) fn retire(&mut self) {
        if let Some(FollowerSlots { arm, sensor }) = &mut self.follower {
            arm.retire();
            sensor.retire();
        }
        self.handle.iter_mut().for_each(DeviceSlot::retire);
        if let Some((slot, _)) = &mut self.servos {
            slot.retire();
        }
    }

    /// Returns the levers of the handle and of the arm.
    pub(super) const fn levers(&self) -> &[Lever; 2] {
        &self.levers
    }

    /// Returns the reason why the arm cannot be engaged from its current position.
    pub(super) const fn obstacle(&self) -> Option<EngageBlocker> {
        self.measured.obstacle
    }

    /// Returns the deliveries of the devices, in the order of the roster, and resets them.
    pub(super) fn take_gauges(&mut self) -> [Option<Gauge>; 4] {
        let [handle, arm, sensor, servos] = std::mem::replace(&mut self.gauges, [Gauge::NONE; 4]);
        let [leads, follows] = [self.handle.is_some(), self.follower.is_some()];
        [
            leads.then_some(handle),
            follows.then_some(arm),
            follows.then_some(sensor),
            self.servos.as_ref().map(|_| servos),
        ]
    }

    /// Returns the health of the devices in the order of the roster, and whether the force path needs each of them.
    pub(super) fn healths(&self) -> [Option<(&Health, bool)>; 4] {
        [
            self.handle.as_ref().map(|slot| (slot.health(), true)),
            self.follower.as_ref().map(|slots| (slots.arm.health(), true)),
            self.follower.as_ref().map(|slots| (slots.sensor.health(), true)),
            self.servos.as_ref().map(|(slot, _)| (slot.health(), false)),
        ]
    }
}
