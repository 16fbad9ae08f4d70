//! Rig files (TOML). An unknown key is an error.

mod anonymous;
mod endoscope;
mod files;
mod gates;
mod identification;
mod mounted;
mod own_copy;
mod rig_file;
mod secrets;
mod teleoperation;
pub mod urdf;

use std::path::Path;

use nima_core::{
    impedance::{ImpedanceSettings, MAX_DEGREE, Mode, ModeSet},
    limits::{self, WINDOW_SAMPLES},
    safety::ChainSettings,
    tip_force::Fallback,
};
use nima_devices::discovery::Probe;
use nima_recording::store::ReadyRecord;
use serde::{Deserialize, Serialize};

pub use anonymous::ANONYMOUS;
pub use endoscope::{EndoscopeCamera, EndoscopeConfig, StereoView};
pub(crate) use files::parse_with;
pub use files::{ConfigError, Ranges, parse, text};
pub use identification::Identification;
pub use mounted::SimulatedWrists;
pub use own_copy::{change_rig, own_copy};
pub use rig_file::{ChosenDevice, RigFile, RigFileError};
pub use teleoperation::{LeaderMount, Teleoperation};

use crate::rig::{self, DeviceName, DeviceRole, RigPart, Side};

/// Settings of a rig: its loop, and its devices if it has any.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigConfig {
    pub name: String,
    pub rate_hz: f64,
    pub mode: Mode,
    /// One-way delay from follower to leader, s.
    pub delay_s: f64,
    /// Speed limit of commands to the follower, m/s.
    pub follower_speed_max_m_s: f64,
    #[serde(default)]
    pub identification: Identification,
    /// Settings of the gates between the model and the hand.
    #[serde(default)]
    pub gates: ChainSettings,
    /// Settings of the network that removes the trocar's friction.
    #[serde(default)]
    pub tip_force: TipForcePart,
    /// Scheduling to request for the loop's thread; a refusal is reported.
    #[serde(default)]
    pub scheduling: SchedulingClass,
    #[serde(default)]
    pub ready_check: ReadyCheck,
    #[serde(default)]
    pub teleoperation: Teleoperation,
    /// A six-axis cap and pedals that control a simulated rig.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub desk: Option<rig::DeskSettings>,
    /// Sensors and tools on the simulated arms of a rig without devices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated: Option<SimulatedWrists>,
    /// The endoscope image for the surgeon's view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub endoscope: Option<EndoscopeConfig>,
    /// The devices; if absent, everything is simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub devices: Option<rig::RigSettings>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReadyCheck {
    #[default]
    Told,
    /// A passed check of today: without one the loop refuses to engage.
    Required,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SchedulingClass {
    /// Scheduled like any other thread.
    Ordinary,
    /// `SCHED_FIFO` and locked memory.
    #[default]
    Fifo,
    /// `SCHED_DEADLINE` and locked memory. Takes precedence over the processor time that newer kernels reserve for
    /// ordinary threads; the kernel suspends a runaway loop. Requires root.
    Deadline,
}

impl SchedulingClass {
    /// All classes, in increasing order of privilege.
    pub const ALL: [Self; 3] = [Self::Ordinary, Self::Fifo, Self::Deadline];

    /// Returns the name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ordinary => "ordinary",
            Self::Fifo => "fifo",
            Self::Deadline => "deadline",
        }
    }
}

impl std::str::FromStr for SchedulingClass {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = || Self::ALL.map(Self::name).join(", ");
        Self::ALL.into_iter().find(|class| class.name() == text).ok_or_else(|| format!("give one of {}", known()))
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TipForcePart {
    /// Force to render while the network is uncertain.
    pub fallback: Fallback,
}

const RIGS: [(&str, &str); 5] = [
    ("simulated", include_str!("../../../config/rigs/simulated.toml")),
    ("desk", include_str!("../../../config/rigs/desk.toml")),
    ("haply-desk", include_str!("../../../config/rigs/haply-desk.toml")),
    ("emulated", include_str!("../../../config/rigs/emulated.toml")),
    ("paper", include_str!("../../../config/rigs/paper.toml")),
];

impl RigConfig {
    /// Loads the embedded rig of this name, or a TOML file.
    ///
    /// # Errors
    /// A name that is neither embedded nor a file, a file that cannot be read or parsed, or a value outside its range.
    ///
    /// ```
    /// use nima_machine::config::{ConfigError, RigConfig};
    ///
    /// let rig = RigConfig::load("simulated")?;
    /// assert!(rig.devices.is_none(), "everything is simulated");
    /// assert!(matches!(RigConfig::load("no such rig"), Err(ConfigError::Unknown { .. })));
    ///
    /// let wrong = RigConfig { rate_hz: f64::NAN, ..rig };
    /// assert!(wrong.validate().is_err());
    /// # Ok::<(), ConfigError>(())
    /// ```
    pub fn load(name: &str) -> Result<Self, ConfigError> {
        let (path, text) = text("rig", name, &RIGS)?;
        Self::parse(&path, &text)
    }

    /// Parses the text of a rig file.
    ///
    /// # Errors
    /// The errors of [`load`](Self::load).
    pub fn parse(path: &Path, text: &str) -> Result<Self, ConfigError> {
        let mut rig: Self = parse_with("rig", path, text, rig::take_out_makes)?;
        rig.devices = rig.devices.map(|devices| devices.emulated_in(&nima_devices::own_folder::runtime_folder()));
        let read = rig.devices.as_mut().map_or(Ok(()), |devices| devices.read_models(path));
        read.map_err(|source| ConfigError::Device { name: rig.name.clone(), source })?;
        rig.validate()?;
        Ok(rig)
    }

    /// Returns the names of the embedded rigs.
    pub fn names() -> impl Iterator<Item = &'static str> {
        RIGS.into_iter().map(|(name, _)| name)
    }

    /// Returns whether the loop refuses to engage without a ready check that passed today: if the file requires it, and
    /// on a rig of real devices whose file does not distinguish right from left.
    pub fn requires_check(&self) -> bool {
        let unnamed = |devices: &rig::RigSettings| !devices.emulated && !devices.names_sides();
        self.ready_check == ReadyCheck::Required || self.devices.as_ref().is_some_and(unnamed)
    }

    /// Returns names and makes of the devices, in the order of the roster.
    pub fn device_names(&self) -> Vec<DeviceName> {
        let parts = self.devices.iter().flat_map(|devices| {
            RigPart::ALL.into_iter().filter(|part| part.is_in(devices)).map(|part| part.device(devices))
        });
        let named = |role, make| DeviceName { role, make };
        let desk = self.desk.iter().flat_map(|desk| {
            let handle = DeviceRole::Part(RigPart::Handle(Side::Right));
            let handle = desk.handle.as_ref().map(|chosen| named(handle, Some(chosen.maker())));
            let cap = desk.leading_cap().map(|_| named(DeviceRole::Cap, None));
            [handle, cap, desk.pedal.as_ref().map(|_| named(DeviceRole::Part(RigPart::Pedal), None))]
        });
        parts.chain(desk.flatten()).collect()
    }

    /// Returns a test of each device; on a simulated rig, of the handle that controls it.
    pub fn probes(&self) -> Vec<Box<dyn Probe>> {
        let handle = self.desk.as_ref().and_then(|desk| desk.handle.as_ref());
        let handle = handle.map(|handle| handle.probe(RigPart::Handle(Side::Right).name()));
        self.devices.as_ref().map(rig::rig_probes).into_iter().flatten().chain(handle).collect()
    }

    /// Returns the parts whose network address is only an example, with the key of the address in the rig file.
    pub fn example_addresses(&self) -> Vec<(RigPart, String)> {
        self.devices.as_ref().map(rig::RigSettings::example_addresses).unwrap_or_default()
    }

    /// Returns whether the rig cannot hurt a person: no real device renders a force or moves. Only such a rig may
    /// engage automatically.
    pub fn is_harmless(&self) -> bool {
        self.devices.as_ref().is_none_or(|devices| devices.emulated) && !self.has_real_hand()
    }

    /// Returns whether a person's hand holds the handle of a simulated rig.
    pub fn has_real_hand(&self) -> bool {
        self.desk.as_ref().is_some_and(|desk| desk.handle.is_some())
    }

    /// Returns whether the hand at the handle is simulated within this program.
    pub fn has_simulated_hand(&self) -> bool {
        self.devices.is_none() && !self.has_real_hand()
    }

    /// Stores the devices of the last passed ready check, against which swapped devices are detected; `None` removes
    /// them.
    pub fn remember(&mut self, check: Option<&ReadyRecord>) {
        if let Some(devices) = &mut self.devices {
            devices.checked = check.map(rig::CheckedDevices::of);
        }
    }

    pub fn settings(&self) -> ImpedanceSettings {
        let Identification {
            window_s,
            max_degree,
            compare: _,
            rest_n,
            own_motion,
            cross_talk,
            scales,
            literal,
            earlier_forces,
        } = self.identification;
        ImpedanceSettings {
            rate_hz: self.rate_hz,
            window_s,
            max_degree,
            rest_n,
            own_motion,
            cross_talk,
            scales,
            literal,
            earlier_forces,
            delay_s: self.delay_s,
            modes: ModeSet::default().with(self.mode),
            ..ImpedanceSettings::default()
        }
    }

    /// Checks every value's range.
    ///
    /// # Errors
    /// [`ConfigError`] for the first value outside its range, with its key.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let ranges = Ranges { kind: "rig", name: &self.name };
        ranges.within("rate_hz", self.rate_hz, &limits::RATE_HZ)?;
        ranges.within("delay_s", self.delay_s, &limits::DELAY_S)?;
        // Hand and instrument move at up to 0.5 m/s; a larger number is in mm/s.
        let speed_m_s = self.follower_speed_max_m_s;
        let allowed = "above 0, at most 1 m/s; check the unit";
        ranges.check("follower_speed_max_m_s", speed_m_s, speed_m_s > 0.0 && speed_m_s <= 1.0, allowed)?;
        if let Some(desk) = &self.desk {
            let speed = desk.speed_m_s;
            ranges.check("desk.speed_m_s", speed, speed > 0.0 && speed <= 0.15, "above 0, at most 0.15 m/s")?;
            let simulated = if self.devices.is_none() { 1.0 } else { 0.0 };
            ranges.check(
                "desk together with [devices]",
                simulated,
                self.devices.is_none(),
                "omitted: a rig has either of them",
            )?;
        }
        ranges.within("teleoperation.scale", self.teleoperation.scale, &limits::SCALE)?;
        ranges.finite("teleoperation.world_from_view_deg", &self.teleoperation.world_from_view_deg)?;
        if let Some(measured_deg) = &self.teleoperation.view_from_leader_deg {
            ranges.finite("teleoperation.view_from_leader_deg", measured_deg)?;
        }
        let window_s = self.identification.window_s;
        let samples = window_s * self.rate_hz;
        ranges.check(
            "identification.window_s",
            window_s,
            WINDOW_SAMPLES.contains(samples),
            format!("{WINDOW_SAMPLES} long"),
        )?;
        let degree = self.identification.max_degree;
        ranges.check(
            "identification.max_degree",
            degree as f64,
            (1..=MAX_DEGREE).contains(&degree),
            format!("1 to {MAX_DEGREE}"),
        )?;
        ranges.within("identification.rest_n", self.identification.rest_n, &limits::REST_N)?;
        ranges.within("identification.literal.ridge", self.identification.literal.ridge, &limits::RIDGE)?;
        gates::check(&self.gates, &ranges)?;
        self.endoscope.as_ref().map_or(Ok(()), |endoscope| endoscope.check(&ranges))?;
        let camera = self.endoscope.as_ref().and_then(|endoscope| endoscope.camera);
        if camera.is_some_and(|camera| camera.n_from_camera_m.is_some()) {
            let is_marked = self.devices.as_ref().is_some_and(|devices| devices.endoscope.is_some());
            let markers = if is_marked { 1.0 } else { 0.0 };
            let key = "endoscope.camera.n_from_camera_m (markers on the endoscope)";
            ranges.check(key, markers, is_marked, "1: [devices.endoscope] names the tracker's tool")?;
        }
        let devices = self.devices.as_ref().map_or(Ok(()), rig::RigSettings::check);
        let desk = self.desk.as_ref().map_or(Ok(()), rig::DeskSettings::check);
        devices
            .and(desk)
            .and_then(|()| self.check_simulated_wrists())
            .map_err(|source| ConfigError::Device { name: self.name.clone(), source })
    }
}

#[cfg(test)]
mod tests {
    use nima_core::impedance::{Baseline, DegreeChoice, IncrementReading, Recipe};

    use super::*;

    #[test]
    fn every_embedded_rig_is_valid() {
        for (name, _) in RIGS {
            RigConfig::load(name).expect(name);
        }
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        std::fs::write(&path, RIGS[0].1.replace("rate_hz", "rate_khz")).unwrap();
        let message = RigConfig::load(path.to_str().unwrap()).unwrap_err().to_string();
        assert!(message.contains("rate_khz") && message.contains("line "), "{message}");
    }

    #[test]
    fn the_keys_of_the_literal_mode_are_read_and_what_is_unknown_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let with = |keys: &str| {
            let path = folder.path().join("rig.toml");
            let text = RIGS[0].1.replace("[gates]", &format!("[identification.literal]\n{keys}\n\n[gates]"));
            std::fs::write(&path, text).unwrap();
            RigConfig::load(path.to_str().unwrap()).map(|rig| rig.settings().literal)
        };
        assert_eq!(with("").unwrap(), Recipe::default());
        let all = "reading = \"displacement\"\nchoice = \"next\"\nconstant = true\nridge = 0.003";
        let read =
            Recipe { reading: IncrementReading::Displacement, choice: DegreeChoice::Next, constant: true, ridge: 3e-3 };
        assert_eq!(with(all).unwrap(), read);
        let printed = "reading = \"increments\"\nchoice = \"window\"\nconstant = false\nridge = 0.0";
        assert_eq!(with(printed).unwrap(), Recipe::default());
        for (wrong, words) in [
            ("reading = \"sideways\"", ["sideways", "displacement"]),
            ("choice = \"best\"", ["best", "window"]),
            ("constant = 1", ["line 14", "boolean"]),
            ("ridges = 1.0", ["ridges", "ridge"]),
            ("ridge = -1.0", ["identification.literal.ridge is -1", "0 to 1000000"]),
            ("ridge = nan", ["identification.literal.ridge", "0 to 1000000"]),
        ] {
            let report = with(wrong).unwrap_err().to_string();
            assert!(words.iter().all(|word| report.contains(word)) && !report.contains('\n'), "{wrong}: {report}");
        }
    }

    #[test]
    fn a_baseline_is_computed_only_where_the_rig_names_it() {
        let rig = RigConfig::load("simulated").unwrap();
        assert_eq!(rig.settings().modes.baseline(), None);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        std::fs::write(&path, RIGS[0].1.replace("mode = \"best\"", "mode = \"kalman\"")).unwrap();
        let rig = RigConfig::load(path.to_str().unwrap()).unwrap();
        assert_eq!(rig.mode, Mode::Baseline(Baseline::Kalman));
        assert_eq!(rig.settings().modes.baseline(), Some(Baseline::Kalman));
        std::fs::write(&path, RIGS[0].1.replace("mode = \"best\"", "mode = \"smith\"")).unwrap();
        let message = RigConfig::load(path.to_str().unwrap()).unwrap_err().to_string();
        assert!(message.contains("smith") && message.contains("line "), "{message}");
    }

    #[test]
    fn a_value_out_of_range_is_named_with_its_range() {
        let mut rig = RigConfig::load("simulated").unwrap();
        rig.gates.ceiling_n = 40.0;
        assert!(rig.validate().unwrap_err().to_string().contains("gates.ceiling_n is 40"));
        rig.gates.ceiling_n = f64::NAN;
        assert!(rig.validate().is_err());
    }
}
