//! The arm to calibrate, from its current rig file, and the serial numbers of the devices that measure it.

use nalgebra::{Isometry3, IsometryMatrix3, Point3, UnitQuaternion, Vector3};
use nima_core::{calibration::frames::Serials, frames::from_roll_pitch_yaw_deg, kinematics::Arm};
use nima_machine::{
    config::{RigConfig, Teleoperation},
    rig::{ArmSet, EndoscopeSettings, RigPart, Roster, Side},
};

/// The arm pair of a side in a rig file.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSubject {
    pub side: Side,
    /// Devices, and their mounts.
    pub set: ArmSet,
    /// The mapping from hand to tip.
    pub teleoperation: Teleoperation,
    /// The marker on the endoscope, if there is one.
    pub endoscope: Option<EndoscopeSettings>,
    pub arm: Geometry,
    /// Serial numbers of the measuring devices.
    pub serials: Serials,
}

/// Poses of base and sensor, and the length of the shaft, as in the rig file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    pub world_from_base: Isometry3<f64>,
    pub flange_from_s1: Isometry3<f64>,
    pub shaft_m: f64,
}

fn pose(isometry: &IsometryMatrix3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(isometry.translation, UnitQuaternion::from_rotation_matrix(&isometry.rotation))
}

impl FrameSubject {
    /// Returns the arm of this side; `None` if the rig has none.
    pub fn of(rig: &RigConfig, side: Side, roster: &Roster) -> Option<Self> {
        let devices = rig.devices.as_ref()?;
        let set = devices.arm(side)?.clone();
        let arm = set.kinematics().ok()?;
        let serial = |part: RigPart| {
            let entry = roster.iter().find(|entry| entry.part == Some(part))?;
            entry.view.report().identity.map(|identity| identity.serial).filter(|serial| !serial.is_empty())
        };
        let marker = devices.tracker.as_ref().and_then(|tracker| tracker.tools.get(side.index()));
        let marker = marker.and_then(|path| Some(path.file_stem()?.to_string_lossy().into_owned()));
        let serials = Serials { arm: serial(RigPart::Arm(side)), tracker: serial(RigPart::Tracker), marker };
        let arm = Geometry {
            world_from_base: pose(arm.world_from_base()),
            flange_from_s1: pose(arm.flange_from_s1()),
            shaft_m: arm.shaft_m(),
        };
        let teleoperation = rig.teleoperation;
        let endoscope = devices.endoscope;
        Some(Self { side, set, teleoperation, endoscope, arm, serials })
    }

    /// Returns whether the values are equal, whatever device measures them.
    pub fn is_same_place(&self, other: &Self) -> bool {
        Self { serials: Serials::default(), ..self.clone() } == Self { serials: Serials::default(), ..other.clone() }
    }

    /// Returns the arm for the kinematics.
    pub fn arm(&self) -> Option<Arm> {
        self.set.kinematics().ok()
    }

    /// Returns the tip in the flange's frame, m.
    pub fn tip_in_flange_m(&self) -> Vector3<f64> {
        (self.arm.flange_from_s1 * Point3::new(0.0, 0.0, self.arm.shaft_m)).coords
    }

    /// Returns the direction upwards in the frame of the base.
    pub fn up_in_base(&self) -> Vector3<f64> {
        self.arm.world_from_base.rotation.inverse() * Vector3::z()
    }

    /// Returns the marker in the wrist sensor's frame, if known.
    pub fn s1_from_m(&self) -> Option<Isometry3<f64>> {
        from(self.set.s1_from_m_m?, self.set.s1_from_m_deg?)
    }

    /// Returns the tracker's camera in the frame of the base, if it is known.
    pub fn base_from_c(&self) -> Option<Isometry3<f64>> {
        from(self.set.base_from_c_m?, self.set.base_from_c_deg?)
    }

    /// Returns the result of the hand-eye calibration: marker on the flange, and camera relative to the base.
    pub fn hand_eye(&self) -> Option<[Isometry3<f64>; 2]> {
        Some([self.arm.flange_from_s1 * self.s1_from_m()?, self.base_from_c()?])
    }

    /// Returns the key of a value of this arm pair in the rig file.
    pub fn key(&self, name: &str) -> String {
        format!("devices.{}.{name}", self.side.word())
    }
}

#[expect(clippy::unnecessary_wraps, reason = "ends a chain of options")]
fn from(place_m: Vector3<f64>, angles_deg: Vector3<f64>) -> Option<Isometry3<f64>> {
    Some(Isometry3::from_parts(place_m.into(), from_roll_pitch_yaw_deg(&angles_deg)))
}
