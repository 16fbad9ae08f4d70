//! Reading pairs of forces for the correspondence.

use std::path::Path;

use nima_core::calibration::correspondence::PushPair;

use super::{ColumnMapping, RecordingError, rotation::RotationColumns, table::CsvTable};

/// Remedy for a missing column.
const CURE: &str = "name the column so, or name another with --map f1xyz=A,B,C";

/// Reads `f1x_n, f1y_n, f1z_n, f2x_n, f2y_n, f2z_n` (N) and, if the columns exist, `qw, qx, qy, qz` (`s1_from_c`). The
/// quaternion is normalised, and refused if it is more than 1 % from unit length. Other columns are ignored. Returns
/// the pairs in the order of the rows.
///
/// # Errors
/// [`RecordingError`] for a file that cannot be read, a missing column, or a row that is not valid numbers or not a
/// rotation.
///
/// ```
/// use nima_recording::csv::read_pairs;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("pushes.csv");
/// std::fs::write(&path, "f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n\n1,0,0,0,1,0\n")?;
/// assert_eq!(read_pairs(&path)?[0].f2_n.y, 1.0);
///
/// std::fs::write(&path, "f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n\n1,0,0,0,one,0\n")?;
/// assert!(read_pairs(&path).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_pairs(path: &Path) -> Result<Vec<PushPair>, RecordingError> {
    read_mapped_pairs(path, &ColumnMapping::default())
}

/// Reads pairs with this mapping of columns ([`PAIRS`](super::PAIRS)). The rotation may also be `roll_deg, pitch_deg,
/// yaw_deg` or the rotation vector `rx_rad, ry_rad, rz_rad`.
///
/// # Errors
/// The errors of [`read_pairs`], and a rotation in another unit.
pub fn read_mapped_pairs(path: &Path, mapping: &ColumnMapping) -> Result<Vec<PushPair>, RecordingError> {
    let mut table = CsvTable::open(path)?;
    let f1 = table.columns(["f1x_n", "f1y_n", "f1z_n"], mapping, "force", CURE)?;
    let f2 = table.columns(["f2x_n", "f2y_n", "f2z_n"], mapping, "force", CURE)?;
    let rotation = RotationColumns::find(&table, mapping, "rotation s1_from_c", CURE)?;
    table.rows(|row| {
        let mut pair = PushPair::plain(row.vector(&f1)?, row.vector(&f2)?);
        if let Some(rotation) = &rotation {
            pair.s1_from_c = rotation.read(row)?;
        }
        Ok(pair)
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn read(text: &str) -> Result<Vec<PushPair>, RecordingError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.csv");
        std::fs::write(&path, text).unwrap();
        read_pairs(&path)
    }

    #[test]
    fn columns_in_any_order_with_and_without_a_chain() {
        let pairs = read("f2x_n,f2y_n,f2z_n,note,f1x_n,f1y_n,f1z_n\n1,2,3,a,4,5,6\n").unwrap();
        assert_eq!(pairs, [PushPair::plain(Vector3::new(4.0, 5.0, 6.0), Vector3::new(1.0, 2.0, 3.0))]);
        let pairs = read("f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n,qw,qx,qy,qz\n4,5,6,1,2,3,0.708,0,0,0.708\n").unwrap();
        let turned = pairs[0].s1_from_c * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-9, "{turned}");
    }

    #[test]
    fn what_is_missing_or_wrong_is_named_with_its_place() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        let missing = message("f1x_n,f1y_n,f1z_n,f2x_n,f2y_n\n");
        assert!(missing.contains("no column \"f2z_n\"") && missing.contains("--map"), "{missing}");
        let head = "f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n";
        assert!(message(&format!("{head},qw,qx\n")).contains("no column \"qy\""));
        assert!(message(&format!("{head}\n1,2,3,4,5,6\n1,2,3,4,inf,6\n")).contains("line 3, column \"f2y_n\""));
        let turned = message(&format!("{head},qw,qx,qy,qz\n1,2,3,4,5,6,0.5,0,0,0\n"));
        assert!(turned.contains("line 2") && turned.contains("length 0.5"), "{turned}");
    }
}
