//! The wire in a scene file.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::SmoothCurve;
use crate::physics::{
    geometry::{Circle, unit_or},
    instrument::Instrument,
    setting::{BoardSettings, SettingError},
};

/// Maximum number of points, and maximum length of the wire, m: bounds the cost of a step.
const POINTS_MAX: usize = 64;
const LONGEST_M: f64 = 0.6;
/// Minimum distance of two neighbouring points, m.
const APART_M: f64 = 1e-3;

/// Wire, loop and board: the section `[wire]` of a scene file. Workspace frame, z up. Every key has a default: a wire that swings from left to
/// right over the board.
///
/// ```
/// use nima_simulation::physics::WireSetting;
///
/// let mut setting = WireSetting::default();
/// setting.validate()?;
/// setting.hoop.radius_m = 0.001;
/// assert!(setting.validate().is_err_and(|error| error.to_string().contains("wire.loop.radius_m = 0.001")));
/// # Ok::<(), nima_simulation::physics::SettingError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WireSetting {
    /// Points on the centre line of the wire, m, starting at its free end.
    pub points_m: Vec<[f64; 3]>,
    /// The goal: the point that the loop has to reach, counted from 0.
    pub goal_point: usize,
    pub radius_m: f64,
    /// The loop around the tip of each instrument.
    #[serde(rename = "loop")]
    pub hoop: LoopGeometry,
    /// Spring, damper and friction of loop and wire, and of loop and board.
    pub contact: WireContact,
    pub board: BoardSettings,
}

/// A loop, whose middle is the tip of its instrument.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LoopGeometry {
    /// From its middle to the middle of its tube, m.
    pub radius_m: f64,
    /// Radius of its tube, m.
    pub tube_radius_m: f64,
    /// The direction through it, of any length; by default along the shaft, so that the loop's plane is perpendicular
    /// to it.
    pub axis: Option<[f64; 3]>,
}

/// The law of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WireContact {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    /// Coefficient of Coulomb friction.
    pub friction: f64,
}

impl Default for WireSetting {
    /// Bends of about 12 mm radius to both sides and up and down, then down to the board. The goal is at the last
    /// crest.
    fn default() -> Self {
        let points_m = vec![
            [-0.050, 0.000, 0.026],
            [-0.038, 0.000, 0.026],
            [-0.027, 0.009, 0.031],
            [-0.014, 0.000, 0.037],
            [-0.003, -0.010, 0.031],
            [0.008, 0.000, 0.024],
            [0.019, 0.010, 0.029],
            [0.030, 0.003, 0.034],
            [0.040, 0.000, 0.034],
            [0.049, 0.000, 0.030],
            [0.054, 0.000, 0.019],
            [0.055, 0.000, 0.000],
        ];
        Self {
            points_m,
            goal_point: 8,
            radius_m: 0.0008,
            hoop: LoopGeometry::default(),
            contact: WireContact::default(),
            board: BoardSettings::default(),
        }
    }
}

impl Default for LoopGeometry {
    /// 12 mm across, in the plane of a hand that moves from left to right.
    fn default() -> Self {
        Self { radius_m: 0.006, tube_radius_m: 0.0006, axis: Some([1.0, 0.0, 0.0]) }
    }
}

impl Default for WireContact {
    /// As hard as the contacts of [`Contact`](crate::physics::ContactSettings): steel on steel, slightly oily.
    fn default() -> Self {
        Self { stiffness_n_m: 1000.0, damping_n_s_m: 3.0, friction: 0.15 }
    }
}

impl LoopGeometry {
    /// Returns the middle line of its tube for this pose of its instrument.
    pub(super) fn circle(&self, at: &Instrument) -> Circle {
        let along_shaft = at.trocar_m - at.tip_m;
        let (axis, _) = unit_or(&self.axis.map_or(along_shaft, Vector3::from), &Vector3::x());
        // Any direction not parallel to the axis.
        let helper = if axis.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
        let (across, _) = unit_or(&helper.cross(&axis), &Vector3::y());
        let across = [across, axis.cross(&across)];
        Circle { centre_m: at.tip_m, across, axis, radius_m: self.radius_m }
    }
}

fn within(key: &'static str, value: f64, fits: bool, allowed: &'static str) -> Result<(), SettingError> {
    if fits && value.is_finite() { Ok(()) } else { Err(SettingError { key, value, allowed }) }
}

impl WireSetting {
    /// Returns the curve of the wire's middle. The setting must have been validated.
    pub fn curve(&self) -> SmoothCurve {
        SmoothCurve::through(&self.points_m)
    }

    /// # Errors
    /// [`SettingError`] for the first value out of range.
    pub fn validate(&self) -> Result<(), SettingError> {
        self.validate_points()?;
        let fits = (2e-4..=0.01).contains(&self.radius_m);
        within("wire.radius_m", self.radius_m, fits, "from 0.0002 to 0.01 m")?;
        let LoopGeometry { radius_m, tube_radius_m, axis } = self.hoop;
        let fits = (2e-4..=0.01).contains(&tube_radius_m);
        within("wire.loop.tube_radius_m", tube_radius_m, fits, "from 0.0002 to 0.01 m")?;
        let fits = radius_m > self.radius_m + tube_radius_m && radius_m <= 0.05;
        within("wire.loop.radius_m", radius_m, fits, "above the radii of wire and tube together, at most 0.05 m")?;
        let length = axis.map_or(1.0, |axis| Vector3::from(axis).norm());
        within("wire.loop.axis (length)", length, (1e-6..1e6).contains(&length), "a direction")?;
        let WireContact { stiffness_n_m, damping_n_s_m, friction } = self.contact;
        let fits = (100.0..=5000.0).contains(&stiffness_n_m);
        within("wire.contact.stiffness_n_m", stiffness_n_m, fits, "from 100 to 5000 N/m")?;
        let fits = (0.0..=50.0).contains(&damping_n_s_m);
        within("wire.contact.damping_n_s_m", damping_n_s_m, fits, "from 0 to 50 N s/m")?;
        within("wire.contact.friction", friction, (0.0..=2.0).contains(&friction), "from 0 to 2")?;
        within("wire.board.z_m", self.board.z_m, self.board.z_m.abs() <= 0.5, "within 0.5 m of 0")?;
        for size_m in self.board.size_m {
            within("wire.board.size_m", size_m, (0.01..=1.0).contains(&size_m), "from 0.01 to 1 m")?;
        }
        Ok(())
    }

    fn validate_points(&self) -> Result<(), SettingError> {
        let count = self.points_m.len();
        within("wire.points_m (count)", count as f64, (2..=POINTS_MAX).contains(&count), "from 2 to 64")?;
        for entry in self.points_m.iter().flatten() {
            within("wire.points_m", *entry, entry.abs() <= 0.5, "within 0.5 m of the origin")?;
        }
        let mut length_m = 0.0;
        for pair in self.points_m.windows(2) {
            let chord_m = (Vector3::from(pair[1]) - Vector3::from(pair[0])).norm();
            within("wire.points_m (distance)", chord_m, chord_m >= APART_M, "at least 0.001 m from point to point")?;
            length_m += chord_m;
        }
        within("wire.points_m (length)", length_m, length_m <= LONGEST_M, "at most 0.6 m in all")?;
        let fits = (1..count).contains(&self.goal_point);
        within("wire.goal_point", self.goal_point as f64, fits, "the number of a point behind the first, from 1")
    }
}
