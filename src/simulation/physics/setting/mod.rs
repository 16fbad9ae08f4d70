//! The objects in a scene file.

mod check;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use check::RINGS_MAX;

/// Board, pegs, rings and jaws: the section `[objects]` of a scene file. Workspace frame, z up. Every key has a default: the peg transfer
/// of FLS, six rings on the pegs of the left side.
///
/// ```
/// use nima_simulation::physics::{ObjectSettings, RingStart};
///
/// let mut setting = ObjectSettings { rings: vec![RingStart::Peg(0), RingStart::At([0.0, 0.0, 0.01])], ..ObjectSettings::default() };
/// setting.validate()?;
/// setting.ring.mass_kg = -1.0;
/// assert!(setting.validate().is_err_and(|error| error.to_string().contains("ring.mass_kg = -1")));
/// # Ok::<(), nima_simulation::physics::SettingError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ObjectSettings {
    pub board: BoardSettings,
    /// The pegs; those at x < 0 are the left side's.
    pub pegs: Pegs,
    pub ring: RingShape,
    /// Start position of each ring.
    pub rings: Vec<RingStart>,
    /// Coefficients of friction.
    pub friction: Friction,
    /// Stiffness and damping of contacts.
    pub contact: ContactSettings,
    pub jaws: JawSettings,
    /// The region that counts as in view.
    pub view: ViewBox,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BoardSettings {
    /// Height of its surface, m.
    pub z_m: f64,
    /// Extent in x and y, m.
    pub size_m: [f64; 2],
}

/// Upright pegs with round tops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pegs {
    /// Positions, x and y, m.
    #[serde(rename = "at_m")]
    pub position_m: Vec<[f64; 2]>,
    pub radius_m: f64,
    /// Height above the board, m.
    pub height_m: f64,
}

/// A ring: a torus of uniform density.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RingShape {
    /// From the middle of the ring to the middle of its tube, m.
    pub major_radius_m: f64,
    /// Radius of the tube, m.
    pub tube_radius_m: f64,
    pub mass_kg: f64,
}

/// Start position of a ring: `{ peg = 3 }` or `{ position_m = [x, y, z] }`, flat in both cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum RingStart {
    /// At the foot of this peg (counted from 0), or on top of earlier rings there.
    #[serde(rename = "peg")]
    Peg(usize),
    /// Middle, m.
    #[serde(rename = "at_m")]
    At([f64; 3]),
}

/// Coefficients of Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Friction {
    /// Fingers and shafts on rings.
    pub jaw_ring: f64,
    pub ring_board: f64,
    pub ring_peg: f64,
    pub ring_ring: f64,
    /// Instruments on board, pegs and each other.
    pub instrument: f64,
    /// Effective radius of the patch where a finger touches a ring, m: friction holds a ring against turning about the contact's normal
    /// up to `jaw_ring` times the normal force times this (soft finger; Howe and Cutkosky, Int. J. Robotics Research 15, 1996). Two thirds of
    /// the patch's radius for an even pressure.
    pub patch_radius_m: f64,
}

/// Springs and dampers of contacts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ContactSettings {
    /// Instruments on board, pegs and each other: stiffness of one contact, N/m. The two fingers of closed jaws are two
    /// contacts.
    pub stiffness_n_m: f64,
    /// Damping of the same, N s/m.
    pub damping_n_s_m: f64,
    /// Contact stiffness of rings with all objects, N/m. The damping is chosen so that they do not bounce.
    pub ring_stiffness_n_m: f64,
}

/// Dimensions and stiffness of the instruments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct JawSettings {
    /// From the hinge to the end of a finger, m.
    pub finger_length_m: f64,
    pub finger_radius_m: f64,
    pub shaft_radius_m: f64,
    /// Force at the end of the fingers per distance between actual and commanded position, N/m.
    pub stiffness_n_m: f64,
    /// Maximum closing or opening force, N at the end of a finger.
    pub force_max_n: f64,
}

/// The region that counts as in view: a box, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ViewBox {
    /// Minimum x, y and z.
    pub from_m: [f64; 3],
    /// Maximum x, y and z.
    pub to_m: [f64; 3],
}

#[derive(Clone, Debug, PartialEq, Error)]
#[error("scene objects: {key} = {value}, but it must be {allowed}")]
pub struct SettingError {
    pub key: &'static str,
    pub value: f64,
    pub allowed: &'static str,
}

impl Default for ObjectSettings {
    fn default() -> Self {
        Self {
            board: BoardSettings::default(),
            pegs: Pegs::default(),
            ring: RingShape::default(),
            rings: (0..6).map(RingStart::Peg).collect(),
            friction: Friction::default(),
            contact: ContactSettings::default(),
            jaws: JawSettings::default(),
            view: ViewBox::default(),
        }
    }
}

impl Default for BoardSettings {
    /// Creates the workspace of this project.
    fn default() -> Self {
        Self { z_m: 0.0, size_m: [0.12, 0.09] }
    }
}

impl Default for Pegs {
    /// Twelve, six on each side as in FLS (Derossis et al. 1998), as far apart as this workspace allows. The pegs of
    /// FLS boards are 25 to 30 mm high and about 5 mm thick; these are thinner in the ratio of our rings to FLS's
    /// blocks.
    fn default() -> Self {
        let rows_m = [-0.026, 0.0, 0.026];
        let side = |sign: f64| rows_m.into_iter().flat_map(move |y_m| [0.019, 0.045].map(|x_m| [sign * x_m, y_m]));
        Self { position_m: side(-1.0).chain(side(1.0)).collect(), radius_m: 0.00175, height_m: 0.025 }
    }
}

impl Default for RingShape {
    /// 18 mm across, with a hole of 11 mm. The blocks of FLS are hollow triangles in a circle of 20 mm (block of
    /// `SurRoL`, Xu et al., IROS 2021); a ring has no corners. The mass is our choice: rubber of this volume would be
    /// 0.5 g, FLS's taller blocks have some grams.
    fn default() -> Self {
        Self { major_radius_m: 0.00725, tube_radius_m: 0.00175, mass_kg: 0.0015 }
    }
}

impl Default for Friction {
    /// Serrated jaws hold rubber better than a smooth peg or board does. Our choice, not measured.
    fn default() -> Self {
        Self { jaw_ring: 0.4, ring_board: 0.3, ring_peg: 0.2, ring_ring: 0.3, instrument: 0.15, patch_radius_m: 0.001 }
    }
}

impl Default for ContactSettings {
    /// Stiff enough to feel hard, soft enough to render at 1 kHz: a damping of at least half the stiffness times the period is needed
    /// (Colgate and Brown, ICRA 1994), 0.5 N s/m here.
    fn default() -> Self {
        Self { stiffness_n_m: 1000.0, damping_n_s_m: 3.0, ring_stiffness_n_m: 4000.0 }
    }
}

impl Default for JawSettings {
    /// Creates a 5 mm instrument with fingers of 10 mm. Fingers that are commanded to close on a ring press it with
    /// about 2.5 N. The maximum is our choice: graspers hold tissue with some N (Heijnsdijk et al., Surg. Endosc. 18,
    /// 2004).
    fn default() -> Self {
        Self {
            finger_length_m: 0.010,
            finger_radius_m: 0.0008,
            shaft_radius_m: 0.0025,
            stiffness_n_m: 500.0,
            force_max_n: 5.0,
        }
    }
}

impl Default for ViewBox {
    /// Creates the workspace and the space above it.
    fn default() -> Self {
        Self { from_m: [-0.06, -0.045, -0.01], to_m: [0.06, 0.045, 0.12] }
    }
}
