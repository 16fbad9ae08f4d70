//! Reading pairs of forces for the correspondence.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{Mapping, RecordingError, table::Table};
use crate::calibration::correspondence::Pair;

/// A quaternion may depart from length one by this much: rounding in a file, not an error.
const UNIT_TOLERANCE: f64 = 0.01;

/// Reads `f1x_n, f1y_n, f1z_n, f2x_n, f2y_n, f2z_n` (N) and, where the columns are there, `qw, qx, qy, qz` (`s1_from_c`, which
/// is normalised; one far from length one is refused). Other columns are ignored. Pairs in the order of the rows.
pub fn read_pairs(path: &Path) -> Result<Vec<Pair>, RecordingError> {
    let table = Table::read(path)?;
    let mapping = Mapping::default();
    let find = |name: &str, purpose| match table.column(&mapping.source(name), purpose, name) {
        // There is no mapping here: say what to do instead.
        Err(RecordingError::NoColumn { path, column, purpose, available, .. }) => {
            Err(RecordingError::NoNamedColumn { path, column, purpose, available })
        }
        found => found,
    };
    let force = |sensor: &str| -> Result<_, RecordingError> {
        let axis = |axis: &str| find(&format!("f{sensor}{axis}_n"), "force");
        Ok([axis("x")?, axis("y")?, axis("z")?])
    };
    let (f1, f2) = (force("1")?, force("2")?);
    let parts = ["qw", "qx", "qy", "qz"];
    let rotation = if parts.iter().any(|name| table.has(name)) {
        let part = |name: &str| find(name, "rotation s1_from_c");
        Some([part("qw")?, part("qx")?, part("qy")?, part("qz")?])
    } else {
        None
    };
    let mut pairs = Vec::with_capacity(table.rows());
    for row in 0..table.rows() {
        let vector = |[x, y, z]: &[_; 3]| -> Result<_, RecordingError> {
            Ok(Vector3::new(table.number(row, x)?, table.number(row, y)?, table.number(row, z)?))
        };
        let mut pair = Pair::plain(vector(&f1)?, vector(&f2)?);
        if let Some([w, x, y, z]) = &rotation {
            let number = |column| table.number(row, column);
            let quaternion = Quaternion::new(number(w)?, number(x)?, number(y)?, number(z)?);
            let length = quaternion.norm();
            if (length - 1.0).abs() > UNIT_TOLERANCE {
                return Err(RecordingError::NotARotation { path: path.to_owned(), line: table.line(row), length });
            }
            pair.s1_from_c = UnitQuaternion::from_quaternion(quaternion);
        }
        pairs.push(pair);
    }
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Pair>, RecordingError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.csv");
        std::fs::write(&path, text).unwrap();
        read_pairs(&path)
    }

    #[test]
    fn columns_in_any_order_with_and_without_a_chain() {
        let pairs = read("f2x_n,f2y_n,f2z_n,note,f1x_n,f1y_n,f1z_n\n1,2,3,a,4,5,6\n").unwrap();
        assert_eq!(pairs, [Pair::plain(Vector3::new(4.0, 5.0, 6.0), Vector3::new(1.0, 2.0, 3.0))]);
        let pairs = read("f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n,qw,qx,qy,qz\n4,5,6,1,2,3,0.708,0,0,0.708\n").unwrap();
        let turned = pairs[0].s1_from_c * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-9, "{turned}");
    }

    #[test]
    fn what_is_missing_or_wrong_is_named_with_its_place() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        let missing = message("f1x_n,f1y_n,f1z_n,f2x_n,f2y_n\n");
        assert!(missing.contains("no column \"f2z_n\"") && !missing.contains("--map"), "{missing}");
        let head = "f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n";
        assert!(message(&format!("{head},qw,qx\n")).contains("no column \"qy\""));
        assert!(message(&format!("{head}\n1,2,3,4,5,6\n1,2,3,4,inf,6\n")).contains("line 3, column \"f2y_n\""));
        let turned = message(&format!("{head},qw,qx,qy,qz\n1,2,3,4,5,6,0.5,0,0,0\n"));
        assert!(turned.contains("line 2") && turned.contains("length 0.5"), "{turned}");
    }
}
