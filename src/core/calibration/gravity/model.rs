//! A fitted gravity model, and the wrench that it predicts.

use nalgebra::{Matrix3, Quaternion, SVector, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::plausible::{LEVER_MAX_M, MASS_MAX_KG};
use crate::frames::{GRAVITY_M_S2, Wrench, WristSample};

/// If the accelerometer measures less than this, m/s^2, it is defective or the arm is in free fall, and the orientation
/// cannot be computed.
pub(super) const MIN_FIELD_M_S2: f64 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GravitySource {
    Imu,
    Arm,
}

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
    pub const ALL: [Self; 3] = [Self::Physical, Self::Gain, Self::Paper];

    /// Returns the model's name in one word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Physical => "physical",
            Self::Gain => "gain",
            Self::Paper => "paper",
        }
    }
}

/// Torque of the weight: `tau = com x f_gravity + tau0`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueParameters {
    /// Centre of mass of the tool in `s1`, m.
    pub com_m: [f64; 3],
    /// Torque reading without load, Nm.
    pub bias_nm: [f64; 3],
}

/// Parameters of a model. Torque is `None` if the poses had no torque; torque is then not compensated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum GravityParameters {
    /// `f = m R u + f0`.
    Physical {
        mass_kg: f64,
        /// `R` from the source's frame to `s1`, unit quaternion `w, x, y, z`.
        s1_from_source_wxyz: [f64; 4],
        /// `f0`, N.
        bias_n: [f64; 3],
        torque: Option<TorqueParameters>,
    },
    /// `f = G u + f0`.
    Gain {
        /// `G`, rows in `s1`, columns in the source's frame, kg.
        gain_kg: [[f64; 3]; 3],
        /// `f0`, N.
        bias_n: [f64; 3],
        torque: Option<TorqueParameters>,
    },
    /// `f = C (sin a, cos a, sin b, cos b, 1)`, one row per axis, N.
    Paper { force_n: [[f64; 5]; 3], torque_nm: Option<[[f64; 5]; 3]> },
}

/// A gravity model and the source of orientation used for its fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityModel {
    pub source: GravitySource,
    /// +1 if the accelerometer points away from the ground at rest (as most accelerometers do), -1 if it points towards
    /// it.
    pub imu_sign: i8,
    /// Fitted parameters, which depend on the type of the model.
    pub parameters: GravityParameters,
}

impl GravityModel {
    pub const fn kind(&self) -> ModelKind {
        match self.parameters {
            GravityParameters::Physical { .. } => ModelKind::Physical,
            GravityParameters::Gain { .. } => ModelKind::Gain,
            GravityParameters::Paper { .. } => ModelKind::Paper,
        }
    }

    /// Returns the fault of parameters read from a file; `None` if they are valid.
    pub fn fault(&self) -> Option<&'static str> {
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let torque_fits = |torque: &Option<TorqueParameters>| {
            torque.is_none_or(|torque| finite(&torque.com_m) && finite(&torque.bias_nm))
        };
        let (all_finite, plausible) = match &self.parameters {
            GravityParameters::Physical { mass_kg, s1_from_source_wxyz, bias_n, torque } => (
                finite(&[*mass_kg]) && finite(s1_from_source_wxyz) && finite(bias_n) && torque_fits(torque),
                (0.0..=MASS_MAX_KG).contains(mass_kg)
                    && torque.is_none_or(|torque| SVector::from(torque.com_m).norm() <= LEVER_MAX_M)
                    && (SVector::from(*s1_from_source_wxyz).norm() - 1.0).abs() < 1e-6,
            ),
            GravityParameters::Gain { gain_kg, bias_n, torque } => {
                (finite(gain_kg.as_flattened()) && finite(bias_n) && torque_fits(torque), true)
            }
            GravityParameters::Paper { force_n, torque_nm } => {
                (finite(force_n.as_flattened()) && torque_nm.is_none_or(|torque| finite(torque.as_flattened())), true)
            }
        };
        match (self.imu_sign, all_finite, plausible) {
            (-1 | 1, true, true) => None,
            (-1 | 1, true, false) => Some(
                "the mass is not within 0 to 10 kg, the centre of mass is more than 0.5 m from the sensor, or the rotation is not a unit quaternion",
            ),
            (-1 | 1, false, _) => Some("a number of the gravity model is not finite"),
            _ => Some("imu_sign is neither 1 nor -1"),
        }
    }

    /// Returns the gravity vector in the source's frame for this sample, m/s^2; `None` if the source is missing, not
    /// finite or defective.
    pub fn field_m_s2(&self, sample: &WristSample) -> Option<Vector3<f64>> {
        let field = match self.source {
            // An accelerometer at rest measures the support, which is opposite to gravity.
            GravitySource::Imu => sample.acceleration_m_s2? * -f64::from(self.imu_sign),
            GravitySource::Arm => arm_field_m_s2(&sample.world_from_s1?),
        };
        (field.iter().all(|x| x.is_finite()) && field.norm() >= MIN_FIELD_M_S2).then_some(field)
    }

    /// Returns the wrench of gravity and bias on the sensor for this gravity vector (m/s^2, source's frame): force N
    /// and torque Nm in `s1`.
    pub fn predict(&self, field_m_s2: &Vector3<f64>) -> Wrench {
        match &self.parameters {
            GravityParameters::Physical { mass_kg, s1_from_source_wxyz: [w, x, y, z], bias_n, torque } => {
                // Not checked here: `fault` rejects a quaternion that does not have unit length.
                let s1_from_source = UnitQuaternion::new_unchecked(Quaternion::new(*w, *x, *y, *z));
                loaded(s1_from_source * field_m_s2 * *mass_kg, bias_n, torque.as_ref())
            }
            GravityParameters::Gain { gain_kg, bias_n, torque } => {
                loaded(matrix(gain_kg) * field_m_s2, bias_n, torque.as_ref())
            }
            GravityParameters::Paper { force_n, torque_nm } => {
                let row = paper_row(field_m_s2);
                let apply = |rows: &[[f64; 5]; 3]| Vector3::from(rows.map(|c| SVector::from(c).dot(&row)));
                Wrench { force_n: apply(force_n), torque_nm: torque_nm.as_ref().map_or_else(Vector3::zeros, apply) }
            }
        }
    }
}

/// Returns the gravity vector in `s1`, m/s^2, from the arm's orientation.
pub(super) fn arm_field_m_s2(world_from_s1: &UnitQuaternion<f64>) -> Vector3<f64> {
    // `world` has z up.
    world_from_s1.inverse_transform_vector(&Vector3::new(0.0, 0.0, -GRAVITY_M_S2))
}

/// Returns the paper's row `(sin a, cos a, sin b, cos b, 1)` with roll `a = atan2(ay, az)` and pitch
/// `b = atan2(-ax, sqrt(ay^2 + az^2))` of `-u`. Sines and cosines are computed as ratios, without the angles.
pub(super) fn paper_row(field_m_s2: &Vector3<f64>) -> SVector<f64, 5> {
    // The paper's angles use the support that the accelerometer reads.
    let support = -field_m_s2;
    let across = libm::hypot(support.y, support.z);
    let whole = libm::hypot(support.x, across);
    // Along x the roll is undefined; the formula gives atan2(0, 0) = 0.
    let (sin_a, cos_a) = if across > 0.0 { (support.y / across, support.z / across) } else { (0.0, 1.0) };
    let (sin_b, cos_b) = if whole > 0.0 { (-support.x / whole, across / whole) } else { (0.0, 1.0) };
    SVector::from([sin_a, cos_a, sin_b, cos_b, 1.0])
}

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
