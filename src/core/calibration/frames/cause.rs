//! Reasons for the verdict of a frame calibration: values for the screen and the record, without sentences.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{Carrier, FrameSample};
use crate::calibration::Verdict;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "snake_case", deny_unknown_fields)]
pub enum FrameCause {
    /// Accurate on held-out data.
    Proven,
    TooFew {
        have: usize,
        #[serde(rename = "least")]
        min: usize,
    },
    /// The carrier hardly turned: root mean square of the turns from their mean. A pure translation has no turns.
    SmallTurns {
        turn_deg: f64,
        #[serde(rename = "least_deg")]
        min_deg: f64,
    },
    /// The carrier turned about one axis only: root mean square of the turns about the second axis.
    OneAxis {
        second_deg: f64,
        #[serde(rename = "least_deg")]
        min_deg: f64,
    },
    /// The lines are nearly parallel: root mean square of their tilts from the mean, about the weaker axis.
    NearlyParallel {
        tilt_deg: f64,
        #[serde(rename = "least_deg")]
        min_deg: f64,
    },
    /// The points or directions are on one line: their spread along the second axis (m; for directions a fraction of
    /// one).
    Collinear {
        spread: f64,
        #[serde(rename = "least")]
        min: f64,
    },
    /// The directions are in one plane: their spread along the third axis, as a fraction of one.
    OnePlane {
        spread: f64,
        #[serde(rename = "least")]
        min: f64,
    },
    Weightless {
        weight_n: f64,
        #[serde(rename = "least_n")]
        min_n: f64,
    },
    /// The data determine the position only weakly: half the length of its 95 % interval.
    UncertainPlace {
        by_m: f64,
        #[serde(rename = "most_m")]
        max_m: f64,
    },
    /// The data determine the angle only weakly: half the length of its 95 % interval.
    UncertainAngle {
        by_deg: f64,
        #[serde(rename = "most_deg")]
        max_deg: f64,
    },
    /// The root mean square error of the position on held-out data is too large.
    PoorPlace {
        by_m: f64,
        #[serde(rename = "most_m")]
        max_m: f64,
    },
    /// The root mean square error of the angle on held-out data is too large.
    PoorAngle {
        by_deg: f64,
        #[serde(rename = "most_deg")]
        max_deg: f64,
    },
    Outliers {
        #[serde(rename = "share")]
        fraction: f64,
        #[serde(rename = "most")]
        max: f64,
    },
    /// The input contains a mistake. Correcting it explains the data.
    Mistake { mistake: Mistake },
}

impl FrameCause {
    pub const fn verdict(&self) -> Verdict {
        match self {
            Self::Proven => Verdict::Accepted,
            Self::TooFew { .. }
            | Self::SmallTurns { .. }
            | Self::OneAxis { .. }
            | Self::NearlyParallel { .. }
            | Self::Collinear { .. }
            | Self::OnePlane { .. }
            | Self::UncertainPlace { .. }
            | Self::UncertainAngle { .. } => Verdict::InsufficientMotion,
            Self::Weightless { .. }
            | Self::PoorPlace { .. }
            | Self::PoorAngle { .. }
            | Self::Outliers { .. }
            | Self::Mistake { .. } => Verdict::PoorData,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mistake {
    SwappedMarker,
    SwappedArm,
    /// The poses are inverse: marker from camera instead of camera from marker (or flange from base).
    InversePose,
    /// Only the rotations are inverse (a conjugated quaternion).
    InverseRotation,
    /// The poses belong to a left-handed frame (or, equivalently, all positions have the wrong sign).
    LeftHanded,
    /// The signs of these axes (x, y, z) of the positions are wrong. A tip or a trocar cannot distinguish one axis from
    /// the other two together; the single axis is reported.
    WrongSign([bool; 3]),
    /// The measured axes are the expected ones with other names or signs.
    WrongAxes(SignedAxes),
    /// The directions fit only in a mirror: two axes are swapped, or one axis points the other way.
    Mirrored,
}

impl Mistake {
    /// Returns the mistakes that the poses of one carrier can reveal. Position signs are known up to a common factor of
    /// -1, which pivoting cannot show.
    pub(super) const fn of_pivoting(carrier: Carrier) -> [Self; 6] {
        [
            Self::swapped(carrier),
            Self::InversePose,
            Self::InverseRotation,
            Self::WrongSign([true, false, false]),
            Self::WrongSign([false, true, false]),
            Self::WrongSign([false, false, true]),
        ]
    }

    /// Returns the mistake of using the other side's poses.
    pub(super) const fn swapped(carrier: Carrier) -> Self {
        match carrier {
            Carrier::Marker => Self::SwappedMarker,
            Carrier::Flange | Carrier::Handle => Self::SwappedArm,
        }
    }

    /// Returns the sample without this mistake in the poses of `carrier`; `None` if the sample lacks the required
    /// poses.
    pub(super) fn undone(self, sample: &FrameSample, carrier: Carrier) -> Option<FrameSample> {
        let mut right = *sample;
        match self {
            Self::SwappedMarker => {
                right.c_from_m = Some(sample.c_from_other_m?);
                right.c_from_other_m = sample.c_from_m;
            }
            Self::SwappedArm => {
                right.base_from_flange = Some(sample.other_base_from_flange?);
                right.other_base_from_flange = sample.base_from_flange;
            }
            _ => {
                let pose = right.pose_mut(carrier)?;
                *pose = self.corrected(pose)?;
            }
        }
        Some(right)
    }

    fn corrected(self, pose: &Isometry3<f64>) -> Option<Isometry3<f64>> {
        let place_m = pose.translation.vector;
        let turn = pose.rotation;
        let (place_m, turn) = match self {
            Self::InversePose => return Some(pose.inverse()),
            Self::InverseRotation => (place_m, turn.inverse()),
            // A mirror along z changes the components of the rotation along x and y.
            Self::LeftHanded => (flipped(&place_m, [false, false, true]), mirrored_z(&turn)),
            Self::WrongSign(axes) => (flipped(&place_m, axes), turn),
            Self::SwappedMarker | Self::SwappedArm | Self::WrongAxes(_) | Self::Mirrored => return None,
        };
        Some(Isometry3::from_parts(place_m.into(), turn))
    }
}

fn flipped(vector: &Vector3<f64>, axes: [bool; 3]) -> Vector3<f64> {
    vector.zip_map(&Vector3::from(axes), |value, flip| if flip { -value } else { value })
}

fn mirrored_z(turn: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(turn.w, -turn.i, -turn.j, turn.k))
}

/// An axis of a frame, with its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignedAxis {
    PlusX,
    PlusY,
    PlusZ,
    MinusX,
    MinusY,
    MinusZ,
}

impl SignedAxis {
    const ALL: [Self; 6] = [Self::PlusX, Self::PlusY, Self::PlusZ, Self::MinusX, Self::MinusY, Self::MinusZ];
}

/// Assignment of the measured x, y and z to the axes of the expected frame: a permutation with signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignedAxes(pub [SignedAxis; 3]);

impl SignedAxes {
    /// Every axis with its own name and a positive sign.
    pub const SAME: Self = Self([SignedAxis::PlusX, SignedAxis::PlusY, SignedAxis::PlusZ]);
    /// Above this angle, two frames differ by more than names and signs of axes, degrees.
    const NEAR_DEG: f64 = 20.0;

    /// Returns the nearest permutation with signs to an orthogonal matrix `measured_from_expected`; `None` if none is
    /// within 20 degrees.
    pub(super) fn nearest(measured_from_expected: &Matrix3<f64>) -> Option<Self> {
        let mut axes = [SignedAxis::PlusX; 3];
        let mut taken = [false; 3];
        for (row, axis) in axes.iter_mut().enumerate() {
            let values = measured_from_expected.row(row);
            let column = values.transpose().iamax();
            let near = values[column].abs() >= libm::cos(Self::NEAR_DEG.to_radians());
            if !near || std::mem::replace(&mut taken[column], true) {
                return None;
            }
            *axis = SignedAxis::ALL[column + if values[column] < 0.0 { 3 } else { 0 }];
        }
        Some(Self(axes))
    }
}
