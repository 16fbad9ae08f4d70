//! Rotations in a table, in one of the forms in which robots and trackers report them.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::from_roll_pitch_yaw_deg;

use super::{
    ColumnMapping, RecordingError,
    table::{CsvColumn, CsvTable},
};

const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];
/// Roll, pitch, yaw: turns about the fixed x, y and z axes, in this order. The same as turns about the moving z, y and x
/// axes, and as A, B, C of a KUKA with A as yaw.
const EULER: [&str; 3] = ["roll_deg", "pitch_deg", "yaw_deg"];
/// Axis times angle, as universal robots report it.
const VECTOR: [&str; 3] = ["rx_rad", "ry_rad", "rz_rad"];

/// Largest angle in a table, degrees; a larger number is in another unit.
const ANGLE_MAX_DEG: f64 = 360.0;
/// Longest rotation vector, rad: a whole turn, rounded up.
const TURN_MAX_RAD: f64 = 6.4;

pub(super) enum RotationColumns {
    Quaternion([CsvColumn; 4]),
    Euler([CsvColumn; 3]),
    Vector([CsvColumn; 3]),
}

/// Returns whether one of these quantities is mapped.
pub(super) fn is_mapped(mapping: &ColumnMapping, names: &[&str]) -> bool {
    names.iter().any(|name| mapping.names(name))
}

/// Returns whether the table has one of these columns.
pub(super) fn is_there(table: &CsvTable, names: &[&str]) -> bool {
    names.iter().any(|name| table.has(name))
}

impl RotationColumns {
    /// Finds the form of rotation that the mapping names, else the first that the table has; `None` if there is none.
    pub(super) fn find(
        table: &CsvTable,
        mapping: &ColumnMapping,
        purpose: &'static str,
        cure: &str,
    ) -> Result<Option<Self>, RecordingError> {
        let forms: [&[&str]; 3] = [&QUATERNION, &EULER, &VECTOR];
        let mapped = forms.iter().position(|names| is_mapped(mapping, names));
        let form = mapped.or_else(|| forms.iter().position(|names| is_there(table, names)));
        Ok(match form {
            None => None,
            Some(0) => Some(Self::Quaternion(table.columns(QUATERNION, mapping, purpose, cure)?)),
            Some(1) => Some(Self::Euler(table.columns(EULER, mapping, purpose, cure)?)),
            Some(_) => Some(Self::Vector(table.columns(VECTOR, mapping, purpose, cure)?)),
        })
    }

    /// Returns whether the mapping names a rotation.
    pub(super) fn are_mapped(mapping: &ColumnMapping) -> bool {
        is_mapped(mapping, &QUATERNION) || is_mapped(mapping, &EULER) || is_mapped(mapping, &VECTOR)
    }

    pub(super) fn read(&self, row: &CsvTable) -> Result<UnitQuaternion<f64>, RecordingError> {
        match self {
            Self::Quaternion(columns) => row.quaternion(columns),
            Self::Euler(columns) => {
                let deg: Vector3<f64> = row.vector(columns)?;
                match deg.iter().find(|angle| angle.abs() > ANGLE_MAX_DEG) {
                    Some(angle) => Err(row.implausible("an angle", *angle, "enter degrees, at most a whole turn")),
                    None => Ok(from_roll_pitch_yaw_deg(&deg)),
                }
            }
            Self::Vector(columns) => {
                let turn_rad = row.vector(columns)?;
                let angle_rad = turn_rad.norm();
                if angle_rad > TURN_MAX_RAD {
                    let cure = "enter radians; from degrees with --map rxyz=A,B,C*0.0174533";
                    return Err(row.implausible("the length of the rotation vector", angle_rad, cure));
                }
                Ok(UnitQuaternion::from_scaled_axis(turn_rad))
            }
        }
    }
}
