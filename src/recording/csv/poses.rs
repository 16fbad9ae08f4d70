//! Reading still poses of a tool (CSV) for the calibration of gravity.
//!
//! Columns `fx_n, fy_n, fz_n`, optionally `tx_nm, ty_nm, tz_nm` (`s1`), and either `ax, ay, az` (m/s^2, `imu`) or `qw,
//! qx, qy, qz` (`world_from_s1`, base from sensor). If both exist, the accelerometer is used. A quaternion is
//! normalised; if it is more than 1 % from unit length, it is refused with its line.

use std::path::Path;

use nalgebra::Vector3;
use nima_core::{
    calibration::gravity::{GravityPose, Orientation},
    frames::Wrench,
};

use super::{
    RecordingError,
    table::{CsvColumn, CsvTable},
};

/// Remedy for a missing column.
const CURE: &str = "give fx_n,fy_n,fz_n, optionally tx_nm,ty_nm,tz_nm, and ax,ay,az or qw,qx,qy,qz";

/// Reads still poses in the order of their rows.
///
/// # Errors
/// [`RecordingError`] for a file that cannot be read, a missing column, or a row that is not valid numbers or not a
/// rotation.
///
/// ```
/// use nima_recording::csv::read_poses;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("poses.csv");
/// std::fs::write(&path, "fx_n,fy_n,fz_n,ax,ay,az\n0,0,-2.5,0,0,9.81\n")?;
/// let poses = read_poses(&path)?;
/// assert_eq!((poses.len(), poses[0].wrench.force_n.z, poses[0].has_torque), (1, -2.5, false));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_poses(path: &Path) -> Result<Vec<GravityPose>, RecordingError> {
    let mut table = CsvTable::open(path)?;
    let has = |names: &[&str]| names.iter().any(|name| table.has(name));
    let force = table.columns(["fx_n", "fy_n", "fz_n"], "force", CURE)?;
    let [torque, acceleration] = [["tx_nm", "ty_nm", "tz_nm"], ["ax", "ay", "az"]];
    let quaternion = ["qw", "qx", "qy", "qz"];
    let torque = if has(&torque) { Some(table.columns(torque, "torque", CURE)?) } else { None };
    let by_arm = has(&quaternion) && !has(&acceleration);
    let columns = if by_arm {
        OrientationColumns::Arm(table.columns(quaternion, "orientation", CURE)?)
    } else {
        OrientationColumns::Imu(table.columns(acceleration, "orientation", CURE)?)
    };
    table.rows(|row| {
        let force_n = row.vector(&force)?;
        let torque_nm = torque.as_ref().map_or(Ok(Vector3::zeros()), |columns| row.vector(columns))?;
        let orientation = match &columns {
            OrientationColumns::Arm(columns) => Orientation::Arm(row.rotation(columns)?),
            OrientationColumns::Imu(columns) => Orientation::Imu(row.vector(columns)?),
        };
        Ok(GravityPose { wrench: Wrench { force_n, torque_nm }, has_torque: torque.is_some(), orientation })
    })
}

enum OrientationColumns {
    Arm([CsvColumn; 4]),
    Imu([CsvColumn; 3]),
}
