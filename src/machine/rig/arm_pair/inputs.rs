//! What the devices of one side have measured, as the loop takes it.

use nalgebra::{Isometry3, UnitQuaternion};
use nima_core::{
    calibration::frames::FrameSample,
    frames::WristSample,
    kinematics::{Hand, Jaws, Pose, START_MISS_M, world_from_tracked_view},
};
use nima_devices::{ForceReading, HandleReading};

use super::{ArmPair, FollowerSlots, OLDEST_S, Shared, is_there, rigid};
use crate::rig::{Inputs, Sensed, View};

impl ArmPair {
    /// The measurements; `None` unless every device of the force path delivers and none of its readings is too old. What is at
    /// another machine is at rest in them, and has no force.
    pub(in crate::rig) fn inputs(&self, now_s: f64, shared: &Shared) -> Option<Inputs> {
        let led = match &self.handle {
            Some(slot) => Some(self.hand.filter(|hand| is_there(slot) && now_s - hand.arrival_s <= OLDEST_S)?),
            None => None,
        };
        let inputs = match &self.follower {
            Some(slots) => self.follower_inputs(now_s, slots, shared)?,
            None => Inputs { powered: true, ..Inputs::NOTHING },
        };
        let Some(hand) = led else { return Some(inputs) };
        let HandleReading { position_m, orientation, gripper_rad, .. } = hand.value;
        let turn = orientation.unwrap_or_else(UnitQuaternion::identity);
        let leader_from_handle = Some(Isometry3::from_parts(position_m.into(), turn));
        Some(Inputs {
            hand: Hand { position_m, orientation },
            gripper_rad,
            frames: FrameSample { leader_from_handle, ..inputs.frames },
            powered: inputs.powered && self.force_is_on,
            age_s: inputs.age_s.max(now_s - hand.arrival_s),
            ..inputs
        })
    }

    /// The measurements of arm and sensor.
    fn follower_inputs(&self, now_s: f64, slots: &FollowerSlots, shared: &Shared) -> Option<Inputs> {
        let (joints, force) = (self.joints?, self.force?);
        let pose = self.pose.as_ref()?;
        let age_s = [joints.arrival_s, force.arrival_s].map(|at_s| now_s - at_s).into_iter().fold(0.0, f64::max);
        if !(is_there(&slots.arm) && is_there(&slots.sensor)) || age_s > OLDEST_S {
            return None;
        }
        let world_from_s1 = pose.orientation();
        let jaws = self.measured_jaws();
        Some(Inputs {
            grip_n: self.servos.as_ref().zip(self.turned).and_then(|((_, jaws), turned)| jaws.grip_n(&turned.value)),
            tip_m: pose.tip_m,
            world_from_jaws: jaws.map(|jaws| world_from_s1 * jaws.s1_from_jaws()),
            sensed: self.sensed(&force.value, pose, &world_from_s1, shared),
            view: self.view(&world_from_s1, shared),
            frames: self.frames(pose, &force.value, shared),
            powered: joints.value.servoing && self.obstacle.is_none(),
            obstacle: self.obstacle,
            age_s,
            ..Inputs::NOTHING
        })
    }

    fn view(&self, world_from_s1: &UnitQuaternion<f64>, shared: &Shared) -> View {
        let View::Seen(c_from_view) = shared.c_from_view else { return shared.c_from_view };
        let Some((s1_from_m, m_from_c)) = self.s1_from_m.zip(shared.m_from_c()) else { return View::Unseen };
        let world_from_view = world_from_tracked_view(&(world_from_s1 * s1_from_m), &m_from_c, &c_from_view);
        match self.world_from_c().zip(shared.c_from_n) {
            Some((world_from_c, c_from_n)) => View::SeenAt { world_from_view, world_from_n: world_from_c * c_from_n },
            None => View::Seen(world_from_view),
        }
    }

    /// Where the tracker stands, as the hand-eye calibration found it: steadier than by way of the instrument's marker, whose noise would be
    /// seen at the end of a lever of some decimetres.
    fn world_from_c(&self) -> Option<Isometry3<f64>> {
        self.hand_eye.map(|hand_eye| rigid(self.mount.world_from_base()) * hand_eye.base_from_c)
    }

    /// What the frame calibrations are made of; the other side's poses are added by the rig.
    fn frames(&self, pose: &Pose, force: &ForceReading, shared: &Shared) -> FrameSample {
        let base_from_flange = self.mount.world_from_base().inverse() * pose.chain.world_from_flange;
        FrameSample {
            base_from_flange: Some(rigid(&base_from_flange)),
            c_from_m: shared.c_from_m,
            wrench: Some(force.wrench),
            ..FrameSample::default()
        }
    }

    fn measured_jaws(&self) -> Option<Jaws> {
        let ((slot, control), turned) = (self.servos.as_ref()?, self.turned.as_ref()?);
        is_there(slot).then(|| control.measured(&turned.value))
    }

    fn sensed(
        &self,
        force: &ForceReading,
        pose: &Pose,
        world_from_s1: &UnitQuaternion<f64>,
        shared: &Shared,
    ) -> Sensed {
        if !self.at_wrist {
            return Sensed::AtTip(world_from_s1 * force.wrench.force_n);
        }
        let trocar_m = &self.rcm.settings().trocar_m;
        let in_trocar = pose.axis_miss_m(trocar_m).norm() <= START_MISS_M;
        Sensed::AtWrist(WristSample {
            raw: force.wrench,
            acceleration_m_s2: force.acceleration_m_s2,
            world_from_s1: Some(*world_from_s1),
            world_from_m: self.s1_from_m.map(|s1_from_m| world_from_s1 * s1_from_m),
            m_from_c: shared.m_from_c(),
            // A tool that was taken out has no depth.
            insertion_m: Some(pose.insertion_m(trocar_m)).filter(|_| in_trocar),
            tissue_n: shared.tissue_n,
        })
    }
}
