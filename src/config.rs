//! Rig and scene files (TOML). An unknown key is an error; what a scene does not list is not computed.

mod wrist;

use std::path::{Path, PathBuf};

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

pub use wrist::{Flaw, Imu, Person, TissueSensor, Trocar, Wrist};

use crate::{
    device::{self, Side},
    frames::from_roll_pitch_yaw_deg,
    impedance::{MAX_DEGREE, MAX_DELAY_S, Mode, Scales, Settings},
    kinematics::{Mapping, SCALES, view_from_omega},
    safety::ChainSettings,
    tip_force::Fallback,
};

/// A file that could not be used: what, where, what to do.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The name is neither an embedded one nor a file.
    #[error("there is no {kind} \"{name}\": give one of {known} or the path of a TOML file")]
    Unknown {
        /// `rig` or `scene`.
        kind: &'static str,
        /// As given.
        name: String,
        /// Embedded names.
        known: String,
    },
    /// The file could not be read.
    #[error("cannot read {kind} file {path}")]
    Read {
        /// `rig` or `scene`.
        kind: &'static str,
        /// Its path.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is not valid TOML for its kind.
    #[error("{kind} file {path}: {message}")]
    Parse {
        /// `rig` or `scene`.
        kind: &'static str,
        /// Its path or embedded name.
        path: PathBuf,
        /// Line, column and key.
        message: String,
    },
    /// A device of the rig has a setting that it cannot have.
    #[error("rig \"{name}\"")]
    Device {
        /// Its name.
        name: String,
        /// Which setting.
        source: device::Trouble,
    },
    /// A value is outside its range.
    #[error("{kind} \"{name}\": {key} is {value}, must be {range}")]
    Range {
        /// `rig` or `scene`.
        kind: &'static str,
        /// Its name.
        name: String,
        /// Which key.
        key: &'static str,
        /// As given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
}

/// What the loop runs on and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Name shown on the screen.
    pub name: String,
    /// Rate of the loop, Hz.
    pub rate_hz: f64,
    /// Mode to start with.
    pub mode: Mode,
    /// One-way delay from follower to leader, s.
    pub delay_s: f64,
    /// Fastest command to the follower, m/s.
    pub follower_speed_max_m_s: f64,
    /// Identification window and scales.
    #[serde(default)]
    pub identification: Identification,
    /// Gates between model and hand.
    #[serde(default)]
    pub gates: ChainSettings,
    /// The network against the trocar's friction.
    #[serde(default)]
    pub tip_force: TipForcePart,
    /// What to ask of the operating system for the loop's thread; what it refuses is told.
    #[serde(default)]
    pub scheduling: SchedulingClass,
    /// From the hand's motion to the tip's.
    #[serde(default)]
    pub teleoperation: Teleoperation,
    /// A cap and pedals before a simulated rig.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub desk: Option<device::rig::DeskSettings>,
    /// The devices; without them everything is simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub devices: Option<device::rig::Settings>,
}

/// How the operating system shall treat the loop's thread (Linux).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SchedulingClass {
    /// As any other thread.
    Ordinary,
    /// `SCHED_FIFO` and locked memory.
    #[default]
    Fifo,
    /// `SCHED_DEADLINE` and locked memory: before the share that newer kernels keep for ordinary threads; a runaway loop is
    /// held back by the kernel. Needs root.
    Deadline,
}

impl SchedulingClass {
    /// All, most modest first.
    pub const ALL: [Self; 3] = [Self::Ordinary, Self::Fifo, Self::Deadline];

    /// Its name in files and on the command line.
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

/// From the hand's motion to the tip's: `kbf_from_view * view_from_leader`, and the scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Teleoperation {
    /// The tip's way per way of the hand.
    pub scale: f64,
    /// How the endoscope looks: roll, pitch, yaw of `kbf_from_view`, degrees (picture: x right, y down, z into it).
    pub kbf_from_view_deg: Vector3<f64>,
    /// How the leader stands before the picture.
    pub leader: LeaderMount,
}

impl Default for Teleoperation {
    fn default() -> Self {
        Self { scale: 1.0, kbf_from_view_deg: Vector3::zeros(), leader: LeaderMount::Workspace }
    }
}

/// How a leader stands before the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeaderMount {
    /// Its axes are those of the picture.
    #[default]
    Workspace,
    /// An Omega whose base faces the user below the screen.
    Omega,
}

impl Teleoperation {
    /// The mapping; the default one where the numbers are none ([`Rig::validate`] refuses them).
    pub fn mapping(&self) -> Mapping {
        self.seen(&from_roll_pitch_yaw_deg(&self.kbf_from_view_deg), self.scale)
    }

    /// The mapping by an endoscope that looks so; the default one where the numbers are none.
    pub fn seen(&self, kbf_from_view: &UnitQuaternion<f64>, scale: f64) -> Mapping {
        let view_from_leader = match self.leader {
            LeaderMount::Workspace => UnitQuaternion::identity(),
            LeaderMount::Omega => view_from_omega(),
        };
        Mapping::new(kbf_from_view, &view_from_leader, scale).unwrap_or_default()
    }
}

/// Tip-force part of a rig file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TipForcePart {
    /// What is felt while the network is in doubt.
    pub fallback: Fallback,
}

/// Identification part of a rig file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Identification {
    /// Length of the rolling window, s (the paper's 0.3 s).
    pub window_s: f64,
    /// Highest degree identified, 1 to 5.
    pub max_degree: usize,
    /// Learn the full `M` with cross-talk between the axes too; costs as much again.
    pub cross_talk: bool,
    /// Fixed physical scales of the columns, from the rig's workspace.
    pub scales: Scales,
}

impl Default for Identification {
    fn default() -> Self {
        Self { window_s: 0.3, max_degree: MAX_DEGREE, cross_talk: false, scales: Scales::default() }
    }
}

/// A simulated world: what is in it. An effect that is not listed costs nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name shown on the screen.
    pub name: String,
    /// One sentence for the presenter.
    pub description: String,
    /// Seed of every random sequence of the scene.
    pub seed: u64,
    /// The surgeon's hand and its task.
    pub hand: Hand,
    /// Pegs to reach (tops, m, workspace frame); the hand visits them in turn.
    pub targets_m: Vec<Vector3<f64>>,
    /// Where the instrument enters the body, m; drawn, and the pivot of the shaft.
    pub trocar_m: Vector3<f64>,
    /// What the left hand does, where the scene has two.
    pub left: Option<LeftHand>,
    /// Axes of force depend on motion along other axes: identify the full `M`.
    #[serde(default)]
    pub cross_talk: bool,
    /// Soft tissue under the pegs.
    pub tissue: Option<Tissue>,
    /// The leader device.
    pub leader: Option<Leader>,
    /// Tracking lag of the follower; without it the tip is where it is commanded.
    pub follower: Option<Follower>,
    /// Noise of the force sensor at the tip. Left out where a wrist sensor measures instead.
    pub sensor: Option<Sensor>,
    /// Wrist sensor and tool; without it the force at the tip is measured there.
    pub wrist: Option<Wrist>,
    /// Friction where the instrument passes the body wall.
    pub trocar: Option<Trocar>,
    /// The sensor under the tissue.
    pub tissue_sensor: Option<TissueSensor>,
    /// Somebody at the arm, for calibration: then the loop's commands do not move it.
    pub person: Option<Person>,
}

/// The left hand's part of a scene; everything else is the same for both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeftHand {
    /// Its pegs, m.
    pub targets_m: Vec<Vector3<f64>>,
    /// Its trocar, m.
    pub trocar_m: Vector3<f64>,
}

/// The simulated surgeon's hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    /// Time of one minimum-jerk reach from target to target, s.
    pub reach_s: f64,
    /// Time of pressing down, and again of lifting, s.
    pub press_s: f64,
    /// Time held at the bottom of a press, s.
    pub hold_s: f64,
    /// How far below the target the hand intends to press, m.
    pub press_depth_m: f64,
    /// Sideways drag while pressed, m.
    pub drag_m: f64,
    /// Amplitude of physiological tremor, m (8-12 Hz).
    pub tremor_m: f64,
    /// Effective mass of hand and handle, kg.
    pub mass_kg: f64,
    /// Stiffness with which the grip holds to its intention, N/m.
    pub grip_stiffness_n_m: f64,
    /// Damping of the grip, N s/m.
    pub grip_damping_n_s_m: f64,
}

/// Soft tissue with a flat surface at rest (Hunt and Crossley 1975: `f = k d^n (1 + c d')`), Coulomb friction sideways.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tissue {
    /// Height of the surface at rest, m.
    pub surface_z_m: f64,
    /// Extent of the pad in x and y, m, centred on the origin.
    pub size_m: [f64; 2],
    /// `k`, N/m^n.
    pub stiffness: f64,
    /// `n`, 1 to 3.
    pub exponent: f64,
    /// `c`, s/m.
    pub damping_s_m: f64,
    /// Coulomb friction coefficient; zero for none.
    pub friction: f64,
    /// Stiffness with which the surface sticks to the tip before it slips, N/m.
    pub shear_stiffness_n_m: f64,
}

/// The leader device's measurable limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Leader {
    /// Step of the position reading, m (Omega.7: 0.01 mm).
    pub resolution_m: f64,
    /// Largest force it can give, N (Omega.7: 12 N).
    pub force_max_n: f64,
}

/// The follower's tracking behaviour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Follower {
    /// Natural frequency of its critically damped response, Hz.
    pub bandwidth_hz: f64,
}

/// The force sensor's imperfections.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Standard deviation of white noise per sample and axis, N.
    pub noise_n: f64,
}

const RIGS: [(&str, &str); 4] = [
    ("simulated", include_str!("../config/rigs/simulated.toml")),
    ("desk", include_str!("../config/rigs/desk.toml")),
    ("emulated", include_str!("../config/rigs/emulated.toml")),
    ("paper", include_str!("../config/rigs/paper.toml")),
];
const SCENES: [(&str, &str); 8] = [
    ("peg_transfer", include_str!("../config/scenes/peg_transfer.toml")),
    ("bimanual", include_str!("../config/scenes/bimanual.toml")),
    ("free_motion", include_str!("../config/scenes/free_motion.toml")),
    ("palpation", include_str!("../config/scenes/palpation.toml")),
    ("gravity", include_str!("../config/scenes/gravity.toml")),
    ("correspondence", include_str!("../config/scenes/correspondence.toml")),
    ("isolation", include_str!("../config/scenes/isolation.toml")),
    ("no_contact", include_str!("../config/scenes/no_contact.toml")),
];

/// The text of a file or an embedded name, and where it came from.
fn text(kind: &'static str, name: &str, embedded: &[(&str, &str)]) -> Result<(PathBuf, String), ConfigError> {
    if let Some((known, text)) = embedded.iter().find(|(known, _)| *known == name) {
        return Ok((PathBuf::from(known), (*text).to_owned()));
    }
    let path = Path::new(name);
    if !path.exists() {
        let known = embedded.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
        return Err(ConfigError::Unknown { kind, name: name.to_owned(), known });
    }
    match std::fs::read_to_string(path) {
        Ok(text) => Ok((path.to_owned(), text)),
        Err(source) => Err(ConfigError::Read { kind, path: path.to_owned(), source }),
    }
}

fn parse<T: for<'de> Deserialize<'de>>(kind: &'static str, path: &Path, text: &str) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].lines().count().max(1));
        let message = format!("line {line}: {}", error.message().lines().collect::<Vec<_>>().join(" "));
        ConfigError::Parse { kind, path: path.to_owned(), message }
    })
}

/// Collects range checks so that each reads as one line.
struct Ranges<'a> {
    kind: &'static str,
    name: &'a str,
}

impl Ranges<'_> {
    fn check(&self, key: &'static str, value: f64, good: bool, range: &'static str) -> Result<(), ConfigError> {
        if good && value.is_finite() {
            return Ok(());
        }
        Err(ConfigError::Range { kind: self.kind, name: self.name.to_owned(), key, value, range })
    }

    /// Every entry on its own: a sum would hide infinities that cancel.
    fn finite(&self, key: &'static str, vector: &Vector3<f64>) -> Result<(), ConfigError> {
        vector.iter().try_for_each(|entry| self.check(key, *entry, true, "finite numbers"))
    }

    fn positive(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        self.check(key, value, value > 0.0, "a number above 0")
    }

    fn not_negative(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        self.check(key, value, value >= 0.0, "0 or above")
    }
}

impl Rig {
    /// The rig of this embedded name or TOML file.
    pub fn load(name: &str) -> Result<Self, ConfigError> {
        let (path, text) = text("rig", name, &RIGS)?;
        let rig: Self = parse("rig", &path, &text)?;
        rig.validate()?;
        Ok(rig)
    }

    /// Settings of the identification for this rig.
    pub fn settings(&self) -> Settings {
        let Identification { window_s, max_degree, cross_talk, scales } = self.identification;
        Settings {
            rate_hz: self.rate_hz,
            window_s,
            max_degree,
            cross_talk,
            scales,
            delay_s: self.delay_s,
            ..Settings::default()
        }
    }

    /// Checks every value's range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let ranges = Ranges { kind: "rig", name: &self.name };
        ranges.check("rate_hz", self.rate_hz, (20.0..=10_000.0).contains(&self.rate_hz), "20 to 10000 Hz")?;
        ranges.check("delay_s", self.delay_s, (0.0..=MAX_DELAY_S).contains(&self.delay_s), "0 to 1 s")?;
        ranges.positive("follower_speed_max_m_s", self.follower_speed_max_m_s)?;
        if let Some(desk) = &self.desk {
            let speed = desk.speed_m_s;
            ranges.check("desk.speed_m_s", speed, speed > 0.0 && speed <= 0.15, "above 0, at most 0.15 m/s")?;
            let simulated = if self.devices.is_none() { 1.0 } else { 0.0 };
            ranges.check(
                "desk beside [devices]",
                simulated,
                self.devices.is_none(),
                "left out: a rig has one or the other",
            )?;
        }
        let scale = self.teleoperation.scale;
        ranges.check("teleoperation.scale", scale, SCALES.contains(&scale), "0.01 to 5")?;
        ranges.finite("teleoperation.kbf_from_view_deg", &self.teleoperation.kbf_from_view_deg)?;
        let window_s = self.identification.window_s;
        let samples = window_s * self.rate_hz;
        ranges.check(
            "identification.window_s",
            window_s,
            (10.0..=10_000.0).contains(&samples),
            "10 to 10000 samples long",
        )?;
        let degree = self.identification.max_degree;
        ranges.check("identification.max_degree", degree as f64, (1..=MAX_DEGREE).contains(&degree), "1 to 5")?;
        let gates = &self.gates;
        ranges.check(
            "gates.gain",
            gates.gain,
            (0.0..=1.0).contains(&gates.gain),
            "0 to 1 (more needs the operator)",
        )?;
        ranges.check(
            "gates.ceiling_n",
            gates.ceiling_n,
            gates.ceiling_n > 0.0 && gates.ceiling_n <= 12.0,
            "above 0, at most 12 N",
        )?;
        ranges.positive("gates.slew_n_per_s", gates.slew_n_per_s)?;
        ranges.positive("gates.gain_rate_per_s", gates.gain_rate_per_s)?;
        ranges.not_negative("gates.dead_band_m_s", gates.dead_band_m_s)?;
        let ages = gates.fade_after_s >= 0.0 && gates.zero_after_s > gates.fade_after_s;
        ranges.check("gates.zero_after_s", gates.zero_after_s, ages, "later than fade_after_s")?;
        let devices = self.devices.as_ref().map_or(Ok(()), device::rig::Settings::check);
        devices.map_err(|source| ConfigError::Device { name: self.name.clone(), source })
    }
}

impl Scene {
    /// The scene as one hand has it; `None` for a left hand that is not in it.
    pub fn of_side(&self, side: Side) -> Option<Self> {
        let scene = Self { left: None, ..self.clone() };
        match side {
            Side::Right => Some(scene),
            Side::Left => self.left.clone().map(|LeftHand { targets_m, trocar_m }| {
                // Another tremor and other noise than the right hand's.
                Self { targets_m, trocar_m, seed: scene.seed.wrapping_add(1), ..scene }
            }),
        }
    }

    /// The same with a left hand, which does what the right one does in a mirror, where the scene has none.
    #[must_use]
    pub fn with_left_hand(mut self) -> Self {
        let mirrored = |at_m: &Vector3<f64>| Vector3::new(-at_m.x, at_m.y, at_m.z);
        let mirror = || LeftHand {
            targets_m: self.targets_m.iter().map(mirrored).collect(),
            trocar_m: mirrored(&self.trocar_m),
        };
        self.left = Some(self.left.clone().unwrap_or_else(mirror));
        self
    }

    /// The scene of this embedded name or TOML file.
    pub fn load(name: &str) -> Result<Self, ConfigError> {
        let (path, text) = text("scene", name, &SCENES)?;
        let scene: Self = parse("scene", &path, &text)?;
        scene.validate()?;
        Ok(scene)
    }

    /// Checks every value's range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let ranges = Ranges { kind: "scene", name: &self.name };
        ranges.check(
            "targets_m (count)",
            self.targets_m.len() as f64,
            !self.targets_m.is_empty(),
            "at least one target",
        )?;
        let left = self.left.iter().flat_map(|left| left.targets_m.iter().chain([&left.trocar_m]));
        let left_count = self.left.as_ref().map_or(1, |left| left.targets_m.len());
        ranges.check("left.targets_m (count)", left_count as f64, left_count > 0, "at least one target")?;
        for target in self.targets_m.iter().chain([&self.trocar_m]).chain(left) {
            for entry in target {
                ranges.check("targets_m, trocar_m", *entry, entry.abs() <= 1.0, "within 1 m of the origin")?;
            }
        }
        let hand = &self.hand;
        ranges.positive("hand.reach_s", hand.reach_s)?;
        ranges.positive("hand.press_s", hand.press_s)?;
        ranges.not_negative("hand.hold_s", hand.hold_s)?;
        ranges.not_negative("hand.press_depth_m", hand.press_depth_m)?;
        ranges.not_negative("hand.drag_m", hand.drag_m)?;
        ranges.not_negative("hand.tremor_m", hand.tremor_m)?;
        ranges.positive("hand.mass_kg", hand.mass_kg)?;
        ranges.positive("hand.grip_stiffness_n_m", hand.grip_stiffness_n_m)?;
        ranges.not_negative("hand.grip_damping_n_s_m", hand.grip_damping_n_s_m)?;
        if let Some(tissue) = &self.tissue {
            ranges.check("tissue.surface_z_m", tissue.surface_z_m, tissue.surface_z_m.abs() <= 1.0, "within 1 m")?;
            ranges.positive("tissue.size_m", tissue.size_m[0])?;
            ranges.positive("tissue.size_m", tissue.size_m[1])?;
            ranges.not_negative("tissue.stiffness", tissue.stiffness)?;
            ranges.check("tissue.exponent", tissue.exponent, (1.0..=3.0).contains(&tissue.exponent), "1 to 3")?;
            ranges.not_negative("tissue.damping_s_m", tissue.damping_s_m)?;
            ranges.not_negative("tissue.friction", tissue.friction)?;
            ranges.not_negative("tissue.shear_stiffness_n_m", tissue.shear_stiffness_n_m)?;
        }
        if let Some(leader) = &self.leader {
            ranges.positive("leader.resolution_m", leader.resolution_m)?;
            ranges.positive("leader.force_max_n", leader.force_max_n)?;
        }
        if let Some(follower) = &self.follower {
            ranges.positive("follower.bandwidth_hz", follower.bandwidth_hz)?;
        }
        self.sensor.as_ref().map_or(Ok(()), |sensor| ranges.not_negative("sensor.noise_n", sensor.noise_n))?;
        self.wrist.as_ref().map_or(Ok(()), |wrist| wrist.validate(&ranges))?;
        self.trocar.as_ref().map_or(Ok(()), |trocar| trocar.validate(&ranges))?;
        self.tissue_sensor.as_ref().map_or(Ok(()), |sensor| sensor.validate(&ranges))?;
        // What hangs on the wrist is felt there and nowhere else.
        let needs_wrist = self.trocar.is_some() || self.tissue_sensor.is_some() || self.person.is_some();
        let wrists = if self.wrist.is_some() { 1.0 } else { 0.0 };
        ranges.check("number of [wrist] parts", wrists, self.wrist.is_some() || !needs_wrist, "1 with these parts")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_embedded_file_is_valid() {
        for (name, _) in RIGS {
            Rig::load(name).expect(name);
        }
        for (name, _) in SCENES {
            Scene::load(name).expect(name);
        }
    }

    #[test]
    fn an_unknown_scene_names_the_known_ones() {
        let message = Scene::load("no_such_scene").unwrap_err().to_string();
        assert!(message.contains("peg_transfer") && message.contains("no_such_scene"), "{message}");
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        std::fs::write(&path, RIGS[0].1.replace("rate_hz", "rate_khz")).unwrap();
        let message = Rig::load(path.to_str().unwrap()).unwrap_err().to_string();
        assert!(message.contains("rate_khz") && message.contains("line "), "{message}");
    }

    #[test]
    fn a_value_out_of_range_is_named_with_its_range() {
        let mut rig = Rig::load("simulated").unwrap();
        rig.gates.ceiling_n = 40.0;
        assert!(rig.validate().unwrap_err().to_string().contains("gates.ceiling_n is 40"));
        rig.gates.ceiling_n = f64::NAN;
        assert!(rig.validate().is_err());
    }
}
