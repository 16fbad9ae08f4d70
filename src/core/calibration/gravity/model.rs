//! A fitted gravity model, and what it takes off a sample.

use nalgebra::{Matrix3, Quaternion, SVector, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::frames::{GRAVITY_M_S2, Wrench, WristSample};

/// Below this an accelerometer is dead or the arm falls: no orientation can be read, m/s^2.
pub(super) const LEAST_FIELD_M_S2: f64 = 1.0;

/// Where the direction of gravity comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The accelerometer inside the sensor.
    Imu,
    /// The arm's kinematics.
    Arm,
}

/// Which of the three models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// Mass, mounting rotation, centre of mass and bias.
    Physical,
    /// A free 3x3 gain and bias.
    Gain,
    /// The paper's five columns of sines and cosines.
    Paper,
}

impl ModelKind {
    /// All of them, in the order of a report.
    pub const ALL: [Self; 3] = [Self::Physical, Self::Gain, Self::Paper];

    /// The model's name in one word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Physical => "physical",
            Self::Gain => "gain",
            Self::Paper => "paper",
        }
    }
}

/// How the weight makes a torque: `tau = com x f_gravity + tau0`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueParameters {
    /// Centre of mass of the tool in `s1`, m.
    pub com_m: [f64; 3],
    /// Torque that the sensor reads without any load, Nm.
    pub bias_nm: [f64; 3],
}

/// The numbers of a model. Torque is `None` where the poses had none; the torque then passes as read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Parameters {
    /// `f = m R u + f0`.
    Physical {
        /// Mass of what hangs on the sensor, kg.
        mass_kg: f64,
        /// `R` from the source's frame to `s1`, unit quaternion `w, x, y, z`.
        s1_from_source_wxyz: [f64; 4],
        /// `f0`, N.
        bias_n: [f64; 3],
        /// The torque's part.
        torque: Option<TorqueParameters>,
    },
    /// `f = G u + f0`.
    Gain {
        /// `G`, rows in `s1`, columns in the source's frame, kg.
        gain_kg: [[f64; 3]; 3],
        /// `f0`, N.
        bias_n: [f64; 3],
        /// The torque's part.
        torque: Option<TorqueParameters>,
    },
    /// `f = C (sin a, cos a, sin b, cos b, 1)`: a row per axis, N.
    Paper {
        /// Coefficients of the force, N.
        force_n: [[f64; 5]; 3],
        /// Coefficients of the torque, Nm.
        torque_nm: Option<[[f64; 5]; 3]>,
    },
}

/// A gravity model with the source it was fitted on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityModel {
    /// Where its orientation comes from.
    pub source: Source,
    /// +1 when the accelerometer reads the support at rest (as most do), -1 when it reads towards gravity.
    pub imu_sign: i8,
    /// What the fit found; its fields depend on the kind of model.
    pub parameters: Parameters,
}

impl GravityModel {
    /// Which model it is.
    pub const fn kind(&self) -> ModelKind {
        match self.parameters {
            Parameters::Physical { .. } => ModelKind::Physical,
            Parameters::Gain { .. } => ModelKind::Gain,
            Parameters::Paper { .. } => ModelKind::Paper,
        }
    }

    /// What is wrong with numbers that came from a file, in words; `None` when nothing is.
    pub fn fault(&self) -> Option<&'static str> {
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let torque_fits = |torque: &Option<TorqueParameters>| {
            torque.is_none_or(|torque| finite(&torque.com_m) && finite(&torque.bias_nm))
        };
        let (all_finite, plausible) = match &self.parameters {
            Parameters::Physical { mass_kg, s1_from_source_wxyz, bias_n, torque } => (
                finite(&[*mass_kg]) && finite(s1_from_source_wxyz) && finite(bias_n) && torque_fits(torque),
                *mass_kg >= 0.0 && (SVector::from(*s1_from_source_wxyz).norm() - 1.0).abs() < 1e-6,
            ),
            Parameters::Gain { gain_kg, bias_n, torque } => {
                (finite(gain_kg.as_flattened()) && finite(bias_n) && torque_fits(torque), true)
            }
            Parameters::Paper { force_n, torque_nm } => {
                (finite(force_n.as_flattened()) && torque_nm.is_none_or(|torque| finite(torque.as_flattened())), true)
            }
        };
        match (self.imu_sign, all_finite, plausible) {
            (-1 | 1, true, true) => None,
            (-1 | 1, true, false) => Some("the mass is negative or the rotation is no unit quaternion"),
            (-1 | 1, false, _) => Some("a number of the gravity model is not finite"),
            _ => Some("imu_sign is neither 1 nor -1"),
        }
    }

    /// Field of gravity in the source's frame at this sample, m/s^2; `None` when the source is missing, not finite or dead.
    pub fn field_m_s2(&self, sample: &WristSample) -> Option<Vector3<f64>> {
        let field = match self.source {
            Source::Imu => sample.acceleration_m_s2? * -f64::from(self.imu_sign),
            Source::Arm => arm_field_m_s2(&sample.world_from_s1?),
        };
        (field.iter().all(|x| x.is_finite()) && field.norm() >= LEAST_FIELD_M_S2).then_some(field)
    }

    /// What gravity and bias put on the sensor in this field (m/s^2, source's frame): force N and torque Nm in `s1`.
    pub fn predict(&self, field_m_s2: &Vector3<f64>) -> Wrench {
        match &self.parameters {
            Parameters::Physical { mass_kg, s1_from_source_wxyz: [w, x, y, z], bias_n, torque } => {
                // Refused on reading unless of unit length, see `fault`.
                let s1_from_source = UnitQuaternion::new_unchecked(Quaternion::new(*w, *x, *y, *z));
                loaded(s1_from_source * field_m_s2 * *mass_kg, bias_n, torque.as_ref())
            }
            Parameters::Gain { gain_kg, bias_n, torque } => {
                loaded(matrix(gain_kg) * field_m_s2, bias_n, torque.as_ref())
            }
            Parameters::Paper { force_n, torque_nm } => {
                let row = paper_row(field_m_s2);
                let apply = |rows: &[[f64; 5]; 3]| Vector3::from(rows.map(|c| SVector::from(c).dot(&row)));
                Wrench { force_n: apply(force_n), torque_nm: torque_nm.as_ref().map_or_else(Vector3::zeros, apply) }
            }
        }
    }
}

/// Field of gravity in `s1`, m/s^2, by the arm's orientation.
pub(super) fn arm_field_m_s2(world_from_s1: &UnitQuaternion<f64>) -> Vector3<f64> {
    world_from_s1.inverse_transform_vector(&Vector3::new(0.0, 0.0, -GRAVITY_M_S2))
}

/// The paper's row `(sin a, cos a, sin b, cos b, 1)` with roll `a = atan2(ay, az)` and pitch
/// `b = atan2(-ax, sqrt(ay^2 + az^2))` of the support `-u`. Sines and cosines are taken as the ratios they are.
pub(super) fn paper_row(field_m_s2: &Vector3<f64>) -> SVector<f64, 5> {
    let support = -field_m_s2;
    let across = support.y.hypot(support.z);
    let whole = support.x.hypot(across);
    // Straight along x the roll is undefined; atan2(0, 0) = 0 is what the formula then gives.
    let (sin_a, cos_a) = if across > 0.0 { (support.y / across, support.z / across) } else { (0.0, 1.0) };
    let (sin_b, cos_b) = if whole > 0.0 { (-support.x / whole, across / whole) } else { (0.0, 1.0) };
    SVector::from([sin_a, cos_a, sin_b, cos_b, 1.0])
}

/// A matrix from its rows.
pub(super) fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

fn loaded(weight_n: Vector3<f64>, bias_n: &[f64; 3], torque: Option<&TorqueParameters>) -> Wrench {
    Wrench {
        force_n: weight_n + Vector3::from(*bias_n),
        torque_nm: torque.map_or_else(Vector3::zeros, |torque| {
            Vector3::from(torque.com_m).cross(&weight_n) + Vector3::from(torque.bias_nm)
        }),
    }
}
