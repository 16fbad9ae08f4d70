//! Reading still poses of a tool (CSV) for the calibration of gravity.
//!
//! Columns `fx_n, fy_n, fz_n`, optionally `tx_nm, ty_nm, tz_nm` (`s1`), and either `ax, ay, az` (m/s^2, `imu`) or
//! `qw, qx, qy, qz` (`kbf_from_s1`, base from sensor). With both, the accelerometer is taken. A quaternion is normalised; one
//! further than 1 % from unit length is refused with its line.

use std::path::Path;

use nalgebra::Vector3;

use super::{RecordingError, table::Table};
use crate::{
    calibration::gravity::{Orientation, Pose},
    frames::Wrench,
};

/// What to do about a missing column.
const CURE: &str = "give fx_n,fy_n,fz_n, optionally tx_nm,ty_nm,tz_nm, and ax,ay,az or qw,qx,qy,qz";

/// Reads still poses in the order of their rows.
pub fn read_poses(path: &Path) -> Result<Vec<Pose>, RecordingError> {
    let table = Table::read(path)?;
    let has = |names: &[&str]| names.iter().any(|name| table.has(name));
    let force = table.columns(["fx_n", "fy_n", "fz_n"], "force", CURE)?;
    let [torque, acceleration] = [["tx_nm", "ty_nm", "tz_nm"], ["ax", "ay", "az"]];
    let quaternion = ["qw", "qx", "qy", "qz"];
    let torque = if has(&torque) { Some(table.columns(torque, "torque", CURE)?) } else { None };
    let by_arm = has(&quaternion) && !has(&acceleration);
    let orientation: Box<dyn Fn(usize) -> Result<Orientation, RecordingError>> = if by_arm {
        let columns = table.columns(quaternion, "orientation", CURE)?;
        let table = &table;
        Box::new(move |row| table.rotation(row, &columns).map(Orientation::Arm))
    } else {
        let columns = table.columns(acceleration, "orientation", CURE)?;
        let table = &table;
        Box::new(move |row| table.vector(row, &columns).map(Orientation::Imu))
    };
    let pose = |row| {
        let force_n = table.vector(row, &force)?;
        let torque_nm = torque.as_ref().map_or(Ok(Vector3::zeros()), |columns| table.vector(row, columns))?;
        let wrench = Wrench { force_n, torque_nm };
        Ok(Pose { wrench, has_torque: torque.is_some(), orientation: orientation(row)? })
    };
    (0..table.rows()).map(pose).collect()
}
