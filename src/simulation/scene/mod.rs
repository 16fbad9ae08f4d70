//! Scene files (TOML): the parts of a simulation. Parts that a scene does not list are not computed.

mod ground;
mod mounted;
mod objects;
mod task;
mod wrist;

use std::path::Path;

use nalgebra::Vector3;
use nima_core::task::TaskKind;
use nima_machine::{
    config::{ANONYMOUS, ConfigError, Ranges, parse, text},
    rig::Side,
};
use serde::{Deserialize, Serialize};

pub use ground::{GroundLayer, GroundMembrane, Lump, Lumps, RandomLumps, Relaxation, TissueModel, Wall};
pub use task::{ReadTask, SceneTask, score_tasks_by};
pub use wrist::{Flaw, Imu, PersonModel, TissueSensor, TrocarModel, WristModel};

/// A simulated world. Parts that are not listed cost nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    pub name: String,
    /// One sentence for the presenter.
    pub description: String,
    /// Seed of all random sequences of the scene.
    pub seed: u64,
    pub hand: SceneHand,
    /// Targets of the task (tops of pegs, m, workspace frame), visited by the hand in turn.
    pub targets_m: Vec<Vector3<f64>>,
    /// Position of the trocar, m; also the pivot of the shaft.
    pub trocar_m: Vector3<f64>,
    /// The left hand's part, in scenes with two hands.
    pub left: Option<LeftHand>,
    /// Whether the force on an axis depends on motion along other axes, so that the full matrix `M` must be identified.
    #[serde(default)]
    pub cross_talk: bool,
    /// Soft tissue under the pegs.
    pub tissue: Option<TissueModel>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<GroundLayer>,
    pub lumps: Option<Lumps>,
    /// Whether the tissue's force fades while it is held.
    pub relaxation: Option<Relaxation>,
    /// A membrane over the tissue.
    pub membrane: Option<GroundMembrane>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub walls: Vec<Wall>,
    /// Rings and pegs, and jaws that hold them. The hands then carry rings instead of pressing at the targets.
    pub objects: Option<crate::physics::ObjectSettings>,
    /// A wire, and loops at the instruments. The hand then leads its loop along the wire instead of pressing at the
    /// targets.
    pub wire: Option<crate::physics::WireSetting>,
    /// The scored task.
    pub task: Option<SceneTask>,
    /// The leader device.
    pub leader: Option<LeaderModel>,
    /// Tracking lag of the follower; without it the tip is at its commanded position.
    pub follower: Option<FollowerModel>,
    /// Noise of the force sensor at the tip. Omitted if a wrist sensor measures instead.
    pub sensor: Option<SensorModel>,
    /// Wrist sensor and tool; without them, the force is measured at the tip.
    pub wrist: Option<WristModel>,
    /// Friction where the instrument passes the body wall.
    pub trocar: Option<TrocarModel>,
    /// The sensor under the tissue.
    pub tissue_sensor: Option<TissueSensor>,
    /// A person at the arm, for calibration; the loop's commands then do not move the arm.
    pub person: Option<PersonModel>,
}

/// The left hand's part of a scene; all other parts are common to both hands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeftHand {
    pub targets_m: Vec<Vector3<f64>>,
    pub trocar_m: Vector3<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneHand {
    /// Duration of one minimum-jerk movement from target to target, s.
    pub reach_s: f64,
    /// Duration of pressing down, and of lifting, s.
    pub press_s: f64,
    /// Duration of holding at the bottom of a press, s.
    pub hold_s: f64,
    /// Intended depth of a press below the target, m.
    pub press_depth_m: f64,
    /// Lateral displacement while pressed, m.
    pub drag_m: f64,
    /// Amplitude of physiological tremor, m (8-12 Hz).
    pub tremor_m: f64,
    /// Lateral error of the hand's aim along a wire, m; standard deviation on each axis.
    #[serde(default)]
    pub aim_error_m: f64,
    /// Effective mass of hand and handle, kg.
    pub mass_kg: f64,
    /// Stiffness of the grip towards the intended position, N/m.
    pub grip_stiffness_n_m: f64,
    /// Damping of the grip, N s/m.
    pub grip_damping_n_s_m: f64,
    /// Factor on the speed of all movements of the task, to represent different persons.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub pace: f64,
    /// The force that the person intends to feel, N; above it, the hand yields and slows down. If omitted, the hand has
    /// no force perception.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intended_n: Option<f64>,
}

const fn one() -> f64 {
    1.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    clippy::float_cmp,
    reason = "serde asks for a reference; the default itself"
)]
fn is_one(pace: &f64) -> bool {
    *pace == one()
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeaderModel {
    /// Resolution of the position reading, m (Omega.7: 0.01 mm).
    pub resolution_m: f64,
    /// Maximum force, N (Omega.7: 12 N).
    pub force_max_n: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FollowerModel {
    /// Natural frequency of its critically damped response, Hz.
    pub bandwidth_hz: f64,
}

/// The force sensor's imperfections.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorModel {
    /// Standard deviation of white noise per sample and axis, N.
    pub noise_n: f64,
}

const SCENES: [(&str, &str); 12] = [
    ("peg_transfer", include_str!("../../../config/scenes/peg_transfer.toml")),
    ("bimanual", include_str!("../../../config/scenes/bimanual.toml")),
    ("rings", include_str!("../../../config/scenes/rings.toml")),
    ("find_lumps", include_str!("../../../config/scenes/find_lumps.toml")),
    ("wire", include_str!("../../../config/scenes/wire.toml")),
    ("free_motion", include_str!("../../../config/scenes/free_motion.toml")),
    ("lumps", include_str!("../../../config/scenes/lumps.toml")),
    ("palpation", include_str!("../../../config/scenes/palpation.toml")),
    ("gravity", include_str!("../../../config/scenes/gravity.toml")),
    ("correspondence", include_str!("../../../config/scenes/correspondence.toml")),
    ("isolation", include_str!("../../../config/scenes/isolation.toml")),
    ("no_contact", include_str!("../../../config/scenes/no_contact.toml")),
];

impl Scene {
    /// Returns the scene as seen by one hand; `None` for a left hand that the scene does not have.
    pub fn of_side(&self, side: Side) -> Option<Self> {
        // Both hands feel the same lumps.
        let scene = Self { left: None, lumps: self.placed_lumps(), ..self.clone() };
        match side {
            Side::Right => Some(scene),
            Side::Left => self.left.clone().map(|LeftHand { targets_m, trocar_m }| {
                // A different seed, so that tremor and noise differ from the right hand's.
                Self { targets_m, trocar_m, seed: scene.seed.wrapping_add(1), ..scene }
            }),
        }
    }

    /// Returns the lumps of the scene, with the drawn ones at positions determined by its seed.
    pub fn placed_lumps(&self) -> Option<Lumps> {
        self.lumps.as_ref().map(|lumps| match &self.tissue {
            Some(tissue) => lumps.placed(self.seed, tissue.size_m),
            None => lumps.clone(),
        })
    }

    /// Returns whether the scene hides objects at positions determined by its seed.
    pub fn is_drawn_by_lot(&self) -> bool {
        self.lumps.as_ref().is_some_and(|lumps| lumps.drawn.is_some())
    }

    /// Returns the scene with its hidden objects at other positions, determined by this seed or the next one that has
    /// room for all; unchanged if it hides nothing.
    #[must_use]
    pub fn drawn_anew(self, seed: u64) -> Self {
        if !self.is_drawn_by_lot() {
            return self;
        }
        let drawn = (0..100).map(|more| Self { seed: seed + more, ..self.clone() });
        drawn.into_iter().find(|scene| scene.validate().is_ok()).unwrap_or(self)
    }

    /// Returns whether the hands perform a training task with objects that the scene simulates for both: rings, a wire,
    /// or lumps to find.
    pub fn is_played(&self) -> bool {
        self.objects.is_some() || self.wire.is_some() || self.is_searched()
    }

    /// Returns whether the task is to find the lumps.
    pub fn is_searched(&self) -> bool {
        let palpation = |task: &SceneTask| task.kind == TaskKind::Palpation;
        self.tissue.is_some() && self.lumps.is_some() && self.task.as_ref().is_some_and(palpation)
    }

    /// Adds a left hand, which mirrors the right one, if the scene has none.
    #[must_use]
    pub fn with_left_hand(mut self) -> Self {
        let mirrored = |position_m: &Vector3<f64>| Vector3::new(-position_m.x, position_m.y, position_m.z);
        let mirror = || LeftHand {
            targets_m: self.targets_m.iter().map(mirrored).collect(),
            trocar_m: mirrored(&self.trocar_m),
        };
        self.left = Some(self.left.clone().unwrap_or_else(mirror));
        self
    }

    /// Loads the built-in scene of this name, or a TOML file.
    ///
    /// # Errors
    /// A name that is neither built in nor a file, a file that cannot be read or parsed, or a value outside its range.
    ///
    /// ```
    /// use nima_machine::config::ConfigError;
    /// use nima_simulation::scene::Scene;
    ///
    /// let scene = Scene::load("peg_transfer")?;
    /// assert!(scene.tissue.is_some() && scene.wrist.is_none(), "the force is measured at the tip");
    /// assert!(matches!(Scene::load("no such scene"), Err(ConfigError::Unknown { .. })));
    /// # Ok::<(), ConfigError>(())
    /// ```
    pub fn load(name: &str) -> Result<Self, ConfigError> {
        let (path, text) = text("scene", name, &SCENES)?;
        Self::parse(&path, &text)
    }

    /// Parses the text of a scene file.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(path: &Path, text: &str) -> Result<Self, ConfigError> {
        let mut scene: Self = parse("scene", path, text).map_err(mounted::moved_to_the_rig)?;
        scene.validate()?;
        scene.count_lumps();
        if let Some(Err(message)) = scene.task.as_mut().map(SceneTask::read) {
            return Err(ConfigError::Parse {
                kind: "scene",
                path: path.to_owned(),
                message: format!("task: {message}"),
            });
        }
        Ok(scene)
    }

    /// Returns the scene without its texts.
    #[must_use]
    pub fn anonymous(mut self) -> Self {
        // Without `..`, so that a new field does not compile until it is decided whether it may reveal a person or
        // place.
        let Self {
            name,
            description,
            seed: _,
            hand: _,
            targets_m: _,
            trocar_m: _,
            left: _,
            cross_talk: _,
            tissue: _,
            layers: _,
            lumps: _,
            relaxation: _,
            membrane: _,
            walls: _,
            objects: _,
            wire: _,
            task,
            leader: _,
            follower: _,
            sensor: _,
            wrist: _,
            trocar: _,
            tissue_sensor: _,
            person: _,
        } = &mut self;
        ANONYMOUS.clone_into(name);
        description.clear();
        if let Some(task) = task {
            task.anonymous(ANONYMOUS);
        }
        self
    }

    pub fn names() -> impl Iterator<Item = &'static str> {
        SCENES.into_iter().map(|(name, _)| name)
    }

    /// # Errors
    /// [`ConfigError`] for the first value outside its range, with its key.
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
        ranges.not_negative("hand.aim_error_m", hand.aim_error_m)?;
        ranges.positive("hand.mass_kg", hand.mass_kg)?;
        ranges.positive("hand.grip_stiffness_n_m", hand.grip_stiffness_n_m)?;
        ranges.not_negative("hand.grip_damping_n_s_m", hand.grip_damping_n_s_m)?;
        ranges.check("hand.pace", hand.pace, (0.1..=3.0).contains(&hand.pace), "from 0.1 to 3")?;
        let intended_n = hand.intended_n.unwrap_or(1.0);
        ranges.check("hand.intended_n", intended_n, (0.1..=20.0).contains(&intended_n), "from 0.1 to 20 N")?;
        self.validate_ground(&ranges)?;
        self.validate_objects(&ranges)?;
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
        // These sections affect only the wrist sensor's readings.
        let needs_wrist = self.trocar.is_some() || self.tissue_sensor.is_some() || self.person.is_some();
        let wrists = if self.wrist.is_some() { 1.0 } else { 0.0 };
        ranges.check("number of [wrist] parts", wrists, self.wrist.is_some() || !needs_wrist, "1 with these parts")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_embedded_scene_is_valid() {
        for (name, _) in SCENES {
            Scene::load(name).expect(name);
        }
    }

    #[test]
    fn an_unknown_scene_names_the_known_ones() {
        let message = Scene::load("no_such_scene").unwrap_err().to_string();
        assert!(message.contains("peg_transfer") && message.contains("no_such_scene"), "{message}");
    }
}
