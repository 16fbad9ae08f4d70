//! Reading still poses of a tool (CSV) for the calibration of gravity.
//!
//! Columns `fx_n, fy_n, fz_n`, optionally `tx_nm, ty_nm, tz_nm` (`s1`), and either `ax, ay, az` (m/s^2, `imu`) or the
//! rotation `world_from_s1` (base from sensor): `qw, qx, qy, qz`, `roll_deg, pitch_deg, yaw_deg`, or the rotation vector
//! `rx_rad, ry_rad, rz_rad`. Other names can be mapped to these. If both exist, the accelerometer is used, unless the
//! rotation is mapped. A quaternion is normalised; if it is more than 1 % from unit length, it is refused with its line.

use std::path::Path;

use nalgebra::Vector3;
use nima_core::{
    calibration::gravity::{GravityPose, Orientation},
    frames::Wrench,
};

use super::{
    ColumnMapping, RecordingError,
    rotation::{RotationColumns, is_mapped, is_there},
    table::{CsvColumn, CsvTable},
};

/// Remedy for a missing column.
const CURE: &str = "give fx_n,fy_n,fz_n, optionally tx_nm,ty_nm,tz_nm, and ax,ay,az, qw,qx,qy,qz, roll_deg,pitch_deg,yaw_deg or rx_rad,ry_rad,rz_rad, or name other columns with --map fxyz=A,B,C";

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
    read_mapped_poses(path, &ColumnMapping::default())
}

/// Reads still poses with this mapping of columns ([`POSES`](super::POSES)).
///
/// # Errors
/// The errors of [`read_poses`], and a rotation in another unit.
pub fn read_mapped_poses(path: &Path, mapping: &ColumnMapping) -> Result<Vec<GravityPose>, RecordingError> {
    let mut table = CsvTable::open(path)?;
    let force = table.columns(["fx_n", "fy_n", "fz_n"], mapping, "force", CURE)?;
    let [torque, acceleration] = [["tx_nm", "ty_nm", "tz_nm"], ["ax", "ay", "az"]];
    let has = |names: &[&str]| is_mapped(mapping, names) || is_there(&table, names);
    let torque = if has(&torque) { Some(table.columns(torque, mapping, "torque", CURE)?) } else { None };
    let has_imu =
        is_mapped(mapping, &acceleration) || is_there(&table, &acceleration) && !RotationColumns::are_mapped(mapping);
    let rotation = if has_imu { None } else { RotationColumns::find(&table, mapping, "orientation", CURE)? };
    let columns = match rotation {
        Some(rotation) => OrientationColumns::Arm(rotation),
        None => OrientationColumns::Imu(table.columns(acceleration, mapping, "orientation", CURE)?),
    };
    table.rows(|row| {
        let force_n = row.vector(&force)?;
        let torque_nm = torque.as_ref().map_or(Ok(Vector3::zeros()), |columns| row.vector(columns))?;
        let orientation = match &columns {
            OrientationColumns::Arm(columns) => Orientation::Arm(columns.read(row)?),
            OrientationColumns::Imu(columns) => Orientation::Imu(row.vector(columns)?),
        };
        Ok(GravityPose { wrench: Wrench { force_n, torque_nm }, has_torque: torque.is_some(), orientation })
    })
}

enum OrientationColumns {
    Arm(RotationColumns),
    Imu([CsvColumn; 3]),
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::{super::POSES, *};

    fn read(text: &str, maps: &[&str]) -> Result<Vec<GravityPose>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.csv");
        std::fs::write(&path, text).unwrap();
        let mapping = ColumnMapping::parse_for(&POSES, maps).map_err(|error| error.to_string())?;
        read_mapped_poses(&path, &mapping).map_err(|error| error.to_string())
    }

    fn turn(text: &str, maps: &[&str]) -> UnitQuaternion<f64> {
        match read(text, maps).unwrap()[0].orientation {
            Orientation::Arm(rotation) => rotation,
            Orientation::Imu(_) => panic!("an orientation of the arm"),
        }
    }

    #[test]
    fn one_orientation_in_every_form() {
        let expected = UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1);
        let [roll, pitch, yaw] = [0.3_f64, -0.5, 1.1].map(f64::to_degrees);
        let q = expected.quaternion();
        let r = expected.scaled_axis();
        let force = "F_x;F_y;F_z";
        let maps = ["fxyz=F_x,F_y,F_z"];
        let with = |map: &'static str| [maps[0], map];
        for (header, numbers, map) in [
            ("qw;qx;qy;qz", vec![q.w, q.i, q.j, q.k], None),
            ("a;b;c;d", vec![q.i, q.j, q.k, q.w], Some("qxyzw=a,b,c,d")),
            ("roll_deg;pitch_deg;yaw_deg", vec![roll, pitch, yaw], None),
            ("ThetaX;ThetaY;ThetaZ", vec![0.3, -0.5, 1.1], Some("rpy=ThetaX,ThetaY,ThetaZ*57.29577951308232")),
            ("rx_rad;ry_rad;rz_rad", vec![r.x, r.y, r.z], None),
            (
                "a;b;c",
                vec![r.x.to_degrees(), r.y.to_degrees(), r.z.to_degrees()],
                Some("rxyz=a,b,c*0.017453292519943295"),
            ),
        ] {
            let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
            let text = format!("{force};{header}\n1.0;2.0;3.0;{}\n", numbers.join(";"));
            let found = map.map_or_else(|| turn(&text, &maps), |map| turn(&text, &with(map)));
            assert!(found.angle_to(&expected) < 1e-9, "{header}: {found}");
        }
    }

    #[test]
    fn angles_in_another_unit_and_unknown_names_are_refused() {
        let degrees = read("fx_n,fy_n,fz_n,rx_rad,ry_rad,rz_rad\n1,2,3,0,90,0\n", &[]).unwrap_err();
        assert!(degrees.contains("line 2") && degrees.contains("enter radians"), "{degrees}");
        let angle = read("fx_n,fy_n,fz_n,roll_deg,pitch_deg,yaw_deg\n1,2,3,0,9000,0\n", &[]).unwrap_err();
        assert!(angle.contains("enter degrees"), "{angle}");
        let name = read("fx_n\n", &["x=a"]).unwrap_err();
        assert!(name.contains("no quantity \"x\"") && name.contains("rpy"), "{name}");
    }
}
