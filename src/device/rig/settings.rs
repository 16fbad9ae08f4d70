//! What the rig file says of the devices: which there are, where, and what hangs on them.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::JawsSettings;
use crate::{
    device::{SIDES, Side, TRACKED_TOOLS, Trouble, bota, dynamixel, force_dimension, hid, kinova, ndi},
    kinematics::{ArmSettings, RcmSettings},
};

/// The devices of a rig. Each is there or not; an arm pair is there as a whole.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// The devices are emulated on this computer, at the places that stand here: the console starts them itself.
    pub emulated: bool,
    /// The right arm pair, or the only one.
    pub right: Option<ArmSet>,
    /// The left arm pair.
    pub left: Option<ArmSet>,
    /// The sensor under the tissue, for calibration.
    pub tissue_sensor: Option<bota::Settings>,
    /// The optical tracker.
    pub tracker: Option<ndi::Settings>,
    /// The marker on the endoscope, which the tracker sees: hand and tip are joined by how it looks.
    pub endoscope: Option<EndoscopeSettings>,
    /// The foot pedal: clutch and presence.
    pub pedal: Option<hid::PedalSettings>,
}

/// A marker of the tracker on the endoscope.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndoscopeSettings {
    /// Which of the tracker's tools it is, counted from 0; those of the arms are 0 (right) and 1 (left).
    pub tool: usize,
    /// How the picture sits on the marker: roll, pitch, yaw of `n_from_view`, degrees.
    pub n_from_view_deg: Vector3<f64>,
}

/// A handle, an arm and what it carries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmSet {
    /// Name of the tool: calibrations are bound to it.
    pub tool: String,
    /// Where the sensor feels: at the wrist, with the tool's weight and the trocar's friction, or at the tip itself.
    #[serde(default)]
    pub sensor_at: SensorPlace,
    /// The haptic handle.
    pub handle: force_dimension::Settings,
    /// The arm.
    pub arm: kinova::Settings,
    /// How the arm is mounted, and the instrument.
    pub mount: ArmSettings,
    /// Where the instrument enters the body.
    pub rcm: RcmSettings,
    /// The force sensor between arm and instrument.
    pub sensor: bota::Settings,
    /// How the tracker's marker sits on the instrument: roll, pitch, yaw of `s1_from_m`, degrees; where there is one.
    #[serde(default)]
    pub s1_from_m_deg: Option<Vector3<f64>>,
    /// The servos of the instrument.
    #[serde(default)]
    pub servos: Option<dynamixel::Settings>,
    /// How the servos move its wrist.
    #[serde(default)]
    pub jaws: JawsSettings,
}

/// The desk part of a rig file: what leads a simulated rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DeskSettings {
    /// The cap.
    pub cap: Option<hid::CapSettings>,
    /// The pedals.
    pub pedal: Option<hid::PedalSettings>,
    /// Speed of the hand at a full push, m/s, above 0 to 0.15.
    pub speed_m_s: f64,
}

impl Default for DeskSettings {
    fn default() -> Self {
        Self { cap: Some(hid::CapSettings::default()), pedal: None, speed_m_s: 0.06 }
    }
}

/// Where a force sensor feels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorPlace {
    /// Between arm and instrument.
    #[default]
    Wrist,
    /// At the tip, beyond the trocar: what it reads is the tissue's force.
    Tip,
}

impl Settings {
    /// The arm pair of this side.
    pub const fn arm(&self, side: Side) -> Option<&ArmSet> {
        match side {
            Side::Right => self.right.as_ref(),
            Side::Left => self.left.as_ref(),
        }
    }

    /// Tells the first setting that no device can have, by its whole key; nothing is opened.
    ///
    /// # Errors
    /// [`Trouble::Setting`].
    pub fn check(&self) -> Result<(), Trouble> {
        for side in Side::ALL {
            let Some(set) = self.arm(side) else { continue };
            let of = |part: &'static str| move |trouble| below(&format!("{}.{part}", side.word()), trouble);
            set.handle.check().map_err(of("handle"))?;
            set.arm.check().map_err(of("arm"))?;
            set.sensor.check().map_err(of("sensor"))?;
            set.servos.as_ref().map_or(Ok(()), dynamixel::Settings::check).map_err(of("servos"))?;
        }
        if let (Some(right), Some(left)) = (&self.right, &self.left)
            && (right.handle.serial.is_none() || right.handle.serial == left.handle.serial)
        {
            let value = right.handle.serial.map_or_else(|| "not given".to_owned(), |serial| serial.to_string());
            let allowed = "two handles are told apart by their serial numbers: give each its own".to_owned();
            return Err(Trouble::Setting { key: "devices.right.handle.serial".to_owned(), value, allowed });
        }
        self.check_endoscope()?;
        let of = |part: &'static str| move |trouble| below(part, trouble);
        self.tissue_sensor.as_ref().map_or(Ok(()), bota::Settings::check).map_err(of("tissue_sensor"))?;
        self.tracker.as_ref().map_or(Ok(()), ndi::Settings::check).map_err(of("tracker"))?;
        self.pedal.as_ref().map_or(Ok(()), hid::PedalSettings::check).map_err(of("pedal"))
    }
}

impl Settings {
    fn check_endoscope(&self) -> Result<(), Trouble> {
        let Some(endoscope) = &self.endoscope else { return Ok(()) };
        let refuse = |key: &str, value: String, allowed: &str| Trouble::Setting {
            key: format!("devices.{key}"),
            value,
            allowed: allowed.to_owned(),
        };
        if self.tracker.is_none() {
            return Err(refuse("tracker", "not given".to_owned(), "the tracker that sees the endoscope's marker"));
        }
        if !(SIDES..TRACKED_TOOLS).contains(&endoscope.tool) {
            let allowed = format!("a tool from {SIDES} to {}; those before are on the arms", TRACKED_TOOLS - 1);
            return Err(refuse("endoscope.tool", endoscope.tool.to_string(), &allowed));
        }
        if !endoscope.n_from_view_deg.iter().all(|deg| deg.is_finite()) {
            let value = format!("{:?}", endoscope.n_from_view_deg.as_slice());
            return Err(refuse("endoscope.n_from_view_deg", value, "three finite angles, degrees"));
        }
        for side in Side::ALL {
            if self.arm(side).is_some_and(|set| set.s1_from_m_deg.is_none()) {
                let key = format!("{}.s1_from_m_deg", side.word());
                let allowed = "how this arm's marker sits: without it nobody knows where the endoscope looks from it";
                return Err(refuse(&key, "not given".to_owned(), allowed));
            }
        }
        Ok(())
    }
}

/// A trouble with its key as it stands in the rig file.
fn below(part: &str, trouble: Trouble) -> Trouble {
    match trouble {
        Trouble::Setting { key, value, allowed } => {
            Trouble::Setting { key: format!("devices.{part}.{key}"), value, allowed }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use crate::config::Rig;

    #[test]
    fn an_impossible_setting_is_told_by_its_whole_key() {
        let good = Rig::load("paper").unwrap().devices.unwrap();
        assert_eq!(good.check(), Ok(()));
        let told = |change: fn(&mut super::Settings)| {
            let mut settings = good.clone();
            change(&mut settings);
            settings.check().unwrap_err().to_string()
        };
        let same = told(|settings| settings.left.as_mut().unwrap().handle.serial = Some(1));
        assert!(same.contains("devices.right.handle.serial") && same.contains("serial numbers"), "{same}");
        let speed = told(|settings| settings.left.as_mut().unwrap().arm.speed_fraction = f64::NAN);
        assert!(speed.contains("devices.left.arm.speed_fraction"), "{speed}");
        let baud = told(|settings| settings.right.as_mut().unwrap().servos.as_mut().unwrap().baud = 1);
        assert!(baud.contains("devices.right.servos.baud"), "{baud}");
        let pedal = told(|settings| settings.pedal.as_mut().unwrap().source = "nothing".to_owned());
        assert!(pedal.contains("devices.pedal.source"), "{pedal}");
    }
}
