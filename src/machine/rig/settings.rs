//! The devices section of a rig file: devices, addresses and mounting.

use std::path::Path;

use nalgebra::{Isometry3, Vector3};
use nima_core::{
    frames::from_roll_pitch_yaw_deg,
    kinematics::{ArmSettings, RcmSettings},
};
use nima_devices::{DeviceError, TRACKED_TOOLS, dynamixel, hid, ndi};
use serde::{Deserialize, Serialize};

use super::{
    ArmModelSettings, CheckedDevices, Flaws, FollowerSettings, JawsSettings, LeaderSettings, SensorSettings, places,
};
use crate::rig::{SIDES, Side};

/// The devices of a rig. Each is optional; the parts of an arm pair are not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RigSettings {
    /// The devices are emulated on this computer, at the addresses given here, and the console starts the emulators.
    /// Relative paths are within the user's [`runtime_folder`](nima_devices::own_folder::runtime_folder).
    pub emulated: bool,
    /// The right arm pair, or the only one.
    pub right: Option<ArmSet>,
    pub left: Option<ArmSet>,
    /// The sensor under the tissue, for calibration.
    pub tissue_sensor: Option<SensorSettings>,
    pub tracker: Option<ndi::NdiSettings>,
    /// The endoscope's marker for the tracker: the mapping from hand to tip then follows the endoscope's orientation.
    pub endoscope: Option<EndoscopeSettings>,
    /// The foot pedal: clutch and presence.
    pub pedal: Option<hid::PedalSettings>,
    /// Flaws of the emulated devices; none on a rig of real devices.
    pub flaws: Flaws,
    /// The devices of the last passed ready check, which distinguish right from left if the file contains no serial
    /// number. Not in the file.
    #[serde(skip)]
    pub checked: Option<CheckedDevices>,
    /// The devices on this machine. Not in the file, which is the same at both ends of a network.
    #[serde(skip)]
    pub ends: RigEnds,
}

/// The devices of a rig file that are at this machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RigEnds {
    /// All devices.
    #[default]
    Both,
    /// Handles and pedals.
    Leader,
    /// Arms, sensors, servos, the tracker.
    Follower,
}

impl RigEnds {
    pub const fn have_leader(self) -> bool {
        matches!(self, Self::Both | Self::Leader)
    }

    pub const fn have_follower(self) -> bool {
        matches!(self, Self::Both | Self::Follower)
    }
}

/// A marker of the tracker on the endoscope.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndoscopeSettings {
    /// Index of the tracker's tool, from 0; tools 0 (right) and 1 (left) are on the instruments.
    pub tool: usize,
    /// Orientation of the image relative to the marker: roll, pitch, yaw of `n_from_view`, degrees.
    pub n_from_view_deg: Vector3<f64>,
}

/// A handle, and an arm with its sensor and instrument.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmSet {
    /// Name of the tool: calibrations are bound to it.
    pub tool: String,
    /// Location of the force sensor: at the wrist, where it also measures the tool's weight and the trocar's friction,
    /// or at the tip.
    #[serde(default)]
    pub sensor_at: SensorPlace,
    pub handle: LeaderSettings,
    pub arm: FollowerSettings,
    /// The arm's joints, if it is not a Gen3 with seven joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ArmModelSettings>,
    /// Mounting of the arm, and dimensions of the instrument.
    pub mount: ArmSettings,
    /// Trocar point, where the instrument enters the body.
    pub rcm: RcmSettings,
    pub sensor: SensorSettings,
    /// Orientation of the tracker's marker on the instrument: roll, pitch, yaw of `s1_from_m`, degrees; only with a
    /// marker.
    #[serde(default)]
    pub s1_from_m_deg: Option<Vector3<f64>>,
    /// Origin of the marker in the frame of the wrist sensor, m; found by the hand-eye calibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub s1_from_m_m: Option<Vector3<f64>>,
    /// Origin of the tracker's camera in the frame of the arm's base, m; found by the hand-eye calibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_from_c_m: Option<Vector3<f64>>,
    /// Orientation of the camera: roll, pitch, yaw of `base_from_c`, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_from_c_deg: Option<Vector3<f64>>,
    #[serde(default)]
    pub servos: Option<dynamixel::DynamixelSettings>,
    /// Transmission from the servos to the instrument's wrist.
    #[serde(default)]
    pub jaws: JawsSettings,
}

impl ArmSet {
    /// Returns the marker in the frame of the wrist sensor, and the camera in the frame of the arm's base; `None`
    /// before the hand-eye calibration.
    pub(super) fn hand_eye(&self) -> Option<[Isometry3<f64>; 2]> {
        let pose = |position_m: Option<Vector3<f64>>, deg: Option<Vector3<f64>>| {
            Some(Isometry3::from_parts(position_m?.into(), from_roll_pitch_yaw_deg(&deg?)))
        };
        Some([pose(self.s1_from_m_m, self.s1_from_m_deg)?, pose(self.base_from_c_m, self.base_from_c_deg)?])
    }
}

/// The desk section of a rig file: input devices that control a simulated rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DeskSettings {
    /// A haptic handle, which controls the rig and feels its force; the cap is then not used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub handle: Option<LeaderSettings>,
    pub cap: Option<hid::CapSettings>,
    pub pedal: Option<hid::PedalSettings>,
    /// Speed of the hand at full deflection of the cap, m/s, above 0 to 0.15.
    pub speed_m_s: f64,
}

impl Default for DeskSettings {
    fn default() -> Self {
        Self { handle: None, cap: Some(hid::CapSettings::default()), pedal: None, speed_m_s: 0.06 }
    }
}

impl DeskSettings {
    /// Returns the cap, if no handle is configured.
    pub fn leading_cap(&self) -> Option<&hid::CapSettings> {
        self.cap.as_ref().filter(|_| self.handle.is_none())
    }

    /// Checks the handle, and that cap and pedal are two devices.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid value, with its full key.
    pub fn check(&self) -> Result<(), DeviceError> {
        let cap = self.leading_cap().and_then(|cap| places::of_hid(&cap.source));
        if let (Some(cap), Some(pedal)) = (cap, self.pedal.as_ref().and_then(|pedal| places::of_hid(&pedal.source)))
            && cap.is_also(&pedal)
        {
            return Err(DeviceError::Setting {
                key: "desk.pedal.source".to_owned(),
                value: pedal.to_string(),
                allowed: "give the pedal a different source than the cap (desk.cap.source)".to_owned(),
            });
        }
        let Some(handle) = &self.handle else { return Ok(()) };
        // An emulated handle must not be mistaken for a real one, nor may both control the loop.
        handle.check().and_then(|()| handle.check_emulated(false)).map_err(|trouble| match trouble {
            DeviceError::Setting { key, value, allowed } => {
                DeviceError::Setting { key: format!("desk.handle.{key}"), value, allowed }
            }
            other => other,
        })
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorPlace {
    #[default]
    Wrist,
    /// At the tip, beyond the trocar, where it measures only the force of the tissue.
    Tip,
}

impl RigSettings {
    pub const fn arm(&self, side: Side) -> Option<&ArmSet> {
        match side {
            Side::Right => self.right.as_ref(),
            Side::Left => self.left.as_ref(),
        }
    }

    /// Returns a copy in which relative paths of emulated devices are within `folder`; addresses of real devices do not
    /// change.
    #[must_use]
    pub fn emulated_in(mut self, folder: &Path) -> Self {
        if !self.emulated {
            return self;
        }
        let place = |path: &mut String| {
            // An empty path is refused by the check; joined with a folder it would look like a valid one.
            if !path.trim().is_empty() {
                *path = folder.join(&*path).display().to_string();
            }
        };
        let on_a_line = |sensor: &mut SensorSettings| sensor.device_file().into_iter().for_each(place);
        for set in [&mut self.right, &mut self.left].into_iter().flatten() {
            on_a_line(&mut set.sensor);
            set.servos.iter_mut().for_each(|servos| place(&mut servos.port));
        }
        self.tissue_sensor.iter_mut().for_each(on_a_line);
        if let Some(tracker) = &mut self.tracker {
            tracker.port.iter_mut().for_each(place);
            tracker.tools.iter_mut().for_each(|tool| *tool = folder.join(&*tool));
        }
        if let Some(pedal) = &mut self.pedal
            && let Some(path) = pedal.source.strip_prefix("emulated:").filter(|path| !path.is_empty())
        {
            pedal.source = format!("emulated:{}", folder.join(path).display());
        }
        self
    }

    /// Checks every setting; opens nothing.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid setting, with its full key.
    pub fn check(&self) -> Result<(), DeviceError> {
        for side in Side::ALL {
            let Some(set) = self.arm(side) else { continue };
            let of = |part: &'static str| move |trouble| below(&format!("{}.{part}", side.word()), trouble);
            set.handle.check().map_err(of("handle"))?;
            set.handle.check_emulated(self.emulated).map_err(of("handle"))?;
            set.arm.check(&set.checked_model().map_err(of("model"))?).map_err(of("arm"))?;
            set.arm.check_emulated(self.emulated).map_err(of("arm"))?;
            set.sensor.check().map_err(of("sensor"))?;
            set.sensor.check_emulated(self.emulated).map_err(of("sensor"))?;
            set.servos.as_ref().map_or(Ok(()), dynamixel::DynamixelSettings::check).map_err(of("servos"))?;
            set.jaws.check(set.servos.as_ref()).map_err(of("jaws"))?;
            set.check_lengths().map_err(|(key, value, allowed)| DeviceError::Setting {
                key: format!("devices.{}.{key}", side.word()),
                value,
                allowed,
            })?;
        }
        if let (Some(right), Some(left)) = (&self.right, &self.left) {
            right.handle.check_beside(&left.handle).map_err(|trouble| below("right.handle", trouble))?;
            if let (Some(of_right), Some(of_left)) = (&right.servos, &left.servos) {
                of_left.check_beside(of_right).map_err(|trouble| below("left.servos", trouble))?;
            }
            if right.tool == left.tool {
                return Err(DeviceError::Setting {
                    key: "devices.left.tool".to_owned(),
                    value: format!("\"{}\"", left.tool),
                    allowed: "a different name from the right tool's: otherwise swapped sensors would keep their calibrations, which belong to a sensor and a tool".to_owned(),
                });
            }
        }
        self.check_unique()?;
        self.check_hand_eye()?;
        self.check_endoscope()?;
        self.flaws.check(self.emulated).map_err(|trouble| match trouble {
            DeviceError::Setting { key, value, allowed } => {
                DeviceError::Setting { key: format!("devices.{key}"), value, allowed }
            }
            other => other,
        })?;
        let of = |part: &'static str| move |trouble| below(part, trouble);
        self.tissue_sensor.as_ref().map_or(Ok(()), SensorSettings::check).map_err(of("tissue_sensor"))?;
        let emulated = |sensor: &SensorSettings| sensor.check_emulated(self.emulated);
        self.tissue_sensor.as_ref().map_or(Ok(()), emulated).map_err(of("tissue_sensor"))?;
        self.tracker.as_ref().map_or(Ok(()), ndi::NdiSettings::check).map_err(of("tracker"))?;
        self.pedal.as_ref().map_or(Ok(()), hid::PedalSettings::check).map_err(of("pedal"))
    }
}

impl RigSettings {
    fn check_hand_eye(&self) -> Result<(), DeviceError> {
        for side in Side::ALL {
            let Some(set) = self.arm(side) else { continue };
            let given = [
                ("s1_from_m_deg", set.s1_from_m_deg),
                ("s1_from_m_m", set.s1_from_m_m),
                ("base_from_c_m", set.base_from_c_m),
                ("base_from_c_deg", set.base_from_c_deg),
            ];
            let finite = |vector: &Vector3<f64>| vector.iter().all(|x| x.is_finite());
            if let Some((key, Some(vector))) = given.into_iter().find(|(_, given)| given.is_some_and(|v| !finite(&v))) {
                return Err(DeviceError::Setting {
                    key: format!("devices.{}.{key}", side.word()),
                    value: format!("{:?}", vector.as_slice()),
                    allowed: "three finite numbers".to_owned(),
                });
            }
        }
        Ok(())
    }

    fn check_endoscope(&self) -> Result<(), DeviceError> {
        let Some(endoscope) = &self.endoscope else { return Ok(()) };
        let refuse = |key: &str, value: String, allowed: &str| DeviceError::Setting {
            key: format!("devices.{key}"),
            value,
            allowed: allowed.to_owned(),
        };
        // Without a tracker the marker would never be seen, and the mapping would silently stay fixed.
        if self.tracker.is_none() {
            return Err(refuse("tracker", "not given".to_owned(), "the tracker that detects the endoscope's marker"));
        }
        if !(SIDES..TRACKED_TOOLS).contains(&endoscope.tool) {
            let allowed =
                format!("a tool from {SIDES} to {}; tools with lower numbers are on the arms", TRACKED_TOOLS - 1);
            return Err(refuse("endoscope.tool", endoscope.tool.to_string(), &allowed));
        }
        if !endoscope.n_from_view_deg.iter().all(|deg| deg.is_finite()) {
            let value = format!("{:?}", endoscope.n_from_view_deg.as_slice());
            return Err(refuse("endoscope.n_from_view_deg", value, "three finite angles, degrees"));
        }
        for side in Side::ALL {
            if self.arm(side).is_some_and(|set| set.s1_from_m_deg.is_none()) {
                let key = format!("{}.s1_from_m_deg", side.word());
                let allowed = "the orientation of this arm's marker, to which the endoscope's orientation refers";
                return Err(refuse(&key, "not given".to_owned(), allowed));
            }
        }
        Ok(())
    }
}

/// Adds the part of the rig file as a prefix to the key of an error.
pub(super) fn below(part: &str, trouble: DeviceError) -> DeviceError {
    match trouble {
        DeviceError::Setting { key, value, allowed } => {
            DeviceError::Setting { key: format!("devices.{part}.{key}"), value, allowed }
        }
        DeviceError::File { key, path, reason } => {
            DeviceError::File { key: format!("devices.{part}.{key}"), path, reason }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use nima_devices::force_dimension;

    use super::ArmSet;
    use crate::config::RigConfig;

    #[test]
    fn emulated_devices_are_placed_in_a_folder_and_real_ones_and_whole_paths_stay() {
        let rig = RigConfig::load("emulated").unwrap().devices.unwrap();
        let own = nima_devices::own_folder::runtime_folder();
        let right = rig.right.as_ref().unwrap();
        assert_eq!(right.sensor.bota().unwrap().port, own.join("ttyACM-right-sensor").display().to_string());
        assert_eq!(right.servos.as_ref().unwrap().port, own.join("ttyUSB-right-servos").display().to_string());
        assert_eq!(rig.left.as_ref().unwrap().sensor.bota().unwrap().port, "127.0.0.1:47140");
        assert_eq!(
            rig.tissue_sensor.as_ref().unwrap().bota().unwrap().port,
            own.join("ttyUSB-tissue-sensor").display().to_string()
        );
        assert_eq!(rig.tracker.as_ref().unwrap().tools[2], own.join("endoscope.rom"));
        assert_eq!(rig.pedal.as_ref().unwrap().source, format!("emulated:{}", own.join("pedal").display()));
        assert_eq!(rig.clone().emulated_in("/elsewhere".as_ref()), rig);
        let real = RigConfig::load("paper").unwrap().devices.unwrap();
        assert_eq!(real.clone().emulated_in("/elsewhere".as_ref()), real);
    }

    fn handle_of(set: &mut Option<ArmSet>) -> &mut force_dimension::ForceDimensionSettings {
        set.as_mut().unwrap().handle.force_dimension_mut().unwrap()
    }

    #[test]
    fn an_impossible_setting_is_told_by_its_whole_key() {
        let good = RigConfig::load("paper").unwrap().devices.unwrap();
        assert_eq!(good.check(), Ok(()));
        let report = |change: fn(&mut super::RigSettings)| {
            let mut settings = good.clone();
            change(&mut settings);
            settings.check().unwrap_err().to_string()
        };
        let same = report(|settings| handle_of(&mut settings.left).serial = Some(1));
        assert!(same.contains("devices.right.handle.serial") && same.contains("different serial number"), "{same}");
        let emulator = report(|settings| handle_of(&mut settings.left).emulator = Some(([127, 0, 0, 1], 1).into()));
        assert!(emulator.contains("devices.left.handle.emulator = 127.0.0.1:1"), "{emulator}");
        let real = report(|settings| settings.emulated = true);
        assert!(real.contains("devices.right.handle.emulator = not given"), "{real}");
        let speed =
            report(|settings| settings.left.as_mut().unwrap().arm.kinova_mut().unwrap().speed_fraction = f64::NAN);
        assert!(speed.contains("devices.left.arm.speed_fraction"), "{speed}");
        let ids = report(|settings| {
            let servos = settings.right.as_ref().unwrap().servos.clone();
            settings.left.as_mut().unwrap().servos = servos;
        });
        assert!(ids.contains("devices.left.servos.servos[0].id = 1") && ids.contains("different ids"), "{ids}");
        let tool = report(|settings| settings.left.as_mut().unwrap().tool = "Right grasper".to_owned());
        assert!(tool.contains("devices.left.tool = \"Right grasper\""), "{tool}");
        let baud = report(|settings| settings.right.as_mut().unwrap().servos.as_mut().unwrap().baud = 1);
        assert!(baud.contains("devices.right.servos.baud"), "{baud}");
        let pedal = report(|settings| settings.pedal.as_mut().unwrap().source = "nothing".to_owned());
        assert!(pedal.contains("devices.pedal.source"), "{pedal}");
    }
}
