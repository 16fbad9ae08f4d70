//! The measurements of a rig in the world: force on the tip, wrist, handle and gripper.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::FrameSample,
    kinematics,
    safety::{RawReading, RawReadings},
};
use nima_machine::rig::{Inputs, RemoteIdentification, SensedForce};

use super::{HandForces, World};
use crate::{
    scene::{LeaderModel, Wall},
    simulated_person::Person,
    trocar,
    wrist::{WristLoads, along_shaft},
};

impl World {
    /// Returns the touch of the person at the arm, inside this world or outside.
    fn hands(&self) -> HandForces {
        self.person.as_ref().map_or(self.touch, Person::touch)
    }

    /// Returns the force on the tip by the tissue or a person, N; call it once per step.
    fn contact_n(&mut self) -> Vector3<f64> {
        // The tissue advances once per measurement, whatever the number of steps of the world.
        let passed_s = self.time_s - std::mem::replace(&mut self.measured_s, self.time_s);
        let tissue_n = match &mut self.tissue {
            Some(tissue) if !self.aside => {
                tissue.set_step(passed_s);
                tissue.contact_n(&self.tip_m, &self.tip_velocity_m_s)
            }
            _ => Vector3::zeros(),
        };
        let wall_n = |wall: &Wall| wall.contact_n(&self.tip_m, &self.tip_velocity_m_s);
        let walls_n: Vector3<f64> = self.walls.iter().filter(|_| !self.aside).map(wall_n).sum();
        tissue_n + walls_n + self.hands().tip + self.loads.tip_n
    }

    fn world_from_s1(&self) -> UnitQuaternion<f64> {
        match (&self.carried, &self.person) {
            (Some(carried), _) => *carried,
            (None, Some(person)) => person.world_from_s1(),
            (None, None) => along_shaft(&trocar::shaft(&self.trocar_m, &self.tip_m).0),
        }
    }

    fn sense(&mut self) -> SensedForce {
        let tip_n = self.contact_n();
        self.true_tip_n = tip_n;
        let world_from_s1 = self.world_from_s1();
        let HandForces { tool, stand, .. } = self.hands();
        if let Some(wrist) = &mut self.wrist {
            let trocar = self.trocar.as_ref().filter(|_| !self.aside);
            let twist_nm = self.loads.torque_nm;
            let wall = trocar.map(|trocar| (trocar.force_n(), trocar.shaft(&self.tip_m).1));
            return SensedForce::AtWrist(
                wrist.measure(&world_from_s1, &WristLoads { tip_n, twist_nm, wall, touch_n: tool, stand_n: stand }),
            );
        }
        let noise_n = match &mut self.sensor_noise_n {
            Some((sigma_n, noise)) => Vector3::from_fn(|_, _| *sigma_n * noise.gaussian()),
            None => Vector3::zeros(),
        };
        SensedForce::AtTip(tip_n + noise_n)
    }

    /// Returns the devices' raw readings. This world's arm has no joints.
    fn raw(&self, leader_m: &Vector3<f64>, sensed: &SensedForce) -> RawReadings {
        let parts = match sensed {
            SensedForce::AtTip(force_n) | SensedForce::FarEnd(RemoteIdentification { force_n, .. }) => {
                [Some((*force_n).into()), None, None]
            }
            SensedForce::AtWrist(sample) => [
                Some(sample.raw.force_n.into()),
                Some(sample.raw.torque_nm.into()),
                sample.acceleration_m_s2.map(Into::into),
            ],
        };
        RawReadings {
            handle: Some(RawReading { channels: (*leader_m).into(), device_s: None, arrival_s: self.time_s }),
            arm: None,
            sensor: Some(RawReading::of_sensor(parts, None, self.time_s)),
        }
    }

    /// Returns the current measurements of a rig; call it once per step.
    pub(crate) fn measure(&mut self) -> Inputs {
        let sensed = self.sense();
        // This world has no jointed arm, and its tracker reports no positions.
        let wrench = sensed.wrist().map(|sample| sample.raw);
        let hand_m = self.hand.position_m();
        let leader_m = self.leader.map_or(hand_m, |LeaderModel { resolution_m, .. }| {
            // The encoders of a device count in steps.
            hand_m.map(|x| (x / resolution_m).round() * resolution_m)
        });
        Inputs {
            raw: self.raw(&leader_m, &sensed),
            hand: kinematics::HandPose::at(leader_m),
            gripper_rad: self.jaws.then(|| self.hand.grip_rad()),
            grip_n: self.jaws.then_some(self.loads.opening_n),
            tip_m: self.tip_m,
            sensed,
            frames: FrameSample { wrench, ..FrameSample::from(leader_m) },
            powered: true,
            ..Inputs::NOTHING
        }
    }
}
