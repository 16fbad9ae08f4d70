//! Reading still poses of a tool (CSV) for the calibration of gravity.
//!
//! Columns `fx_n, fy_n, fz_n`, optionally `tx_nm, ty_nm, tz_nm` (`s1`), and either `ax, ay, az` (m/s^2, `imu`) or
//! `qw, qx, qy, qz` (`kbf_from_s1`, base from sensor). With both, the accelerometer is taken. A quaternion is normalised; one
//! further than 1 % from unit length is refused with its line.

use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{
    Mapping, RecordingError,
    table::{Column, Table},
};
use crate::{
    calibration::gravity::{Orientation, Pose},
    frames::Wrench,
};

/// How far from one the length of a quaternion may be.
const UNIT_TOLERANCE: f64 = 0.01;

/// Why a file of poses could not be used.
#[derive(Debug, thiserror::Error)]
pub enum PosesError {
    /// The file or one of its cells cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A needed column is not there.
    #[error(
        "poses {path} have no column \"{column}\"; give fx_n,fy_n,fz_n, optionally tx_nm,ty_nm,tz_nm, and ax,ay,az or qw,qx,qy,qz"
    )]
    NoColumn {
        /// Its path.
        path: PathBuf,
        /// The first column missing.
        column: &'static str,
    },
    /// A quaternion is no rotation.
    #[error("poses {path}, line {line}: the quaternion has length {norm:.3} instead of 1; repair or remove the row")]
    Quaternion {
        /// Its path.
        path: PathBuf,
        /// Line of the file, from 1.
        line: u64,
        /// Its length.
        norm: f64,
    },
}

/// Reads still poses in the order of their rows.
pub fn read_poses(path: &Path) -> Result<Vec<Pose>, PosesError> {
    let table = Table::read(path)?;
    let force = columns(&table, path, ["fx_n", "fy_n", "fz_n"])?;
    let torque_names = ["tx_nm", "ty_nm", "tz_nm"];
    let has_torque = torque_names.iter().any(|name| table.has(name));
    let torque = if has_torque { Some(columns(&table, path, torque_names)?) } else { None };
    let quaternion_names = ["qw", "qx", "qy", "qz"];
    let acceleration_names = ["ax", "ay", "az"];
    let from_arm =
        !acceleration_names.iter().any(|name| table.has(name)) && quaternion_names.iter().any(|name| table.has(name));
    let quaternion = if from_arm { Some(columns(&table, path, quaternion_names)?) } else { None };
    let acceleration = if from_arm { None } else { Some(columns(&table, path, acceleration_names)?) };
    let mut poses = Vec::with_capacity(table.rows());
    for row in 0..table.rows() {
        let force_n = Vector3::from(numbers(&table, row, &force)?);
        let torque_nm = match &torque {
            Some(columns) => Vector3::from(numbers(&table, row, columns)?),
            None => Vector3::zeros(),
        };
        let orientation = match (&quaternion, &acceleration) {
            (Some(columns), _) => Orientation::Arm(rotation(path, table.line(row), numbers(&table, row, columns)?)?),
            (None, Some(columns)) => Orientation::Imu(numbers(&table, row, columns)?.into()),
            (None, None) => return Err(PosesError::NoColumn { path: path.to_owned(), column: "ax" }),
        };
        poses.push(Pose { wrench: Wrench { force_n, torque_nm }, has_torque, orientation });
    }
    Ok(poses)
}

fn columns<const N: usize>(table: &Table, path: &Path, names: [&'static str; N]) -> Result<Vec<Column>, PosesError> {
    let mapping = Mapping::default();
    let find = |column: &'static str| {
        if !table.has(column) {
            return Err(PosesError::NoColumn { path: path.to_owned(), column });
        }
        Ok(table.column(&mapping.source(column), "a pose", column)?)
    };
    names.into_iter().map(find).collect()
}

fn numbers<const N: usize>(table: &Table, row: usize, columns: &[Column]) -> Result<[f64; N], PosesError> {
    let mut result = [0.0; N];
    for (number, column) in result.iter_mut().zip(columns) {
        *number = table.number(row, column)?;
    }
    Ok(result)
}

fn rotation(path: &Path, line: u64, [w, x, y, z]: [f64; 4]) -> Result<UnitQuaternion<f64>, PosesError> {
    let quaternion = Quaternion::new(w, x, y, z);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > UNIT_TOLERANCE {
        return Err(PosesError::Quaternion { path: path.to_owned(), line, norm });
    }
    Ok(UnitQuaternion::new_normalize(quaternion))
}
