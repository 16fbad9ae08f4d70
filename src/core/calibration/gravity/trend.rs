//! A bias that drifts over the poses, as during the warm-up of a sensor.

use nalgebra::{DMatrix, Vector3};

use super::{
    pose::GravityRow,
    solve::{forces, least_squares, torques},
};
use crate::frames::{GRAVITY_M_S2, Wrench};

/// With fewer poses, a drift cannot be distinguished from chance.
const MIN_POSES: usize = 12;
/// A drift is removed if this leaves less than this fraction of the disagreement between poses; for pure noise, almost
/// all would remain.
const LEFT_FRACTION: f64 = 0.5;
/// Poses for each term of the drift, and the maximum number of terms: a warm-up is steep at first and flat at the end,
/// which four terms follow.
const POSES_PER_TERM: usize = 8;
const MAX_TERMS: usize = 4;
/// The last quarter of the poses shows whether the bias still drifts.
const LATE_PLACE: f64 = 0.5;

/// The bias over the order of the poses, as Legendre polynomials of the place from -1 (first pose) to 1 (last).
#[derive(Clone, Debug)]
pub(super) struct BiasDrift {
    terms: Vec<Wrench>,
}

impl BiasDrift {
    /// Returns the drift if it explains the disagreement of the poses and is more than `floor_n`.
    pub(super) fn find(rows: &[GravityRow], has_torque: bool, floor_n: f64) -> Option<Self> {
        let count = (rows.len() / POSES_PER_TERM).clamp(1, MAX_TERMS);
        if rows.len() < MIN_POSES {
            return None;
        }
        let left_n = |terms: usize| {
            let design = design(rows, terms);
            let forces_n = forces(rows);
            let found = least_squares(design.clone(), &forces_n)?;
            Some((forces_n - design * found).row_iter().map(|row| row.norm()).sum::<f64>())
        };
        let explains = left_n(count)? < LEFT_FRACTION * left_n(0)?;
        let found = Self::fit(rows, has_torque, count)?;
        (explains && found.max_n(rows) > floor_n).then_some(found)
    }

    /// Fits the same number of terms to other rows.
    pub(super) fn refit(&self, rows: &[GravityRow], has_torque: bool) -> Option<Self> {
        Self::fit(rows, has_torque, self.terms.len())
    }

    /// Regresses the wrench on gravity (a free 3x3 gain), a constant, and the terms.
    fn fit(rows: &[GravityRow], has_torque: bool, count: usize) -> Option<Self> {
        let design = design(rows, count);
        let force_n = least_squares(design.clone(), &forces(rows))?;
        let torque_nm = if has_torque { Some(least_squares(design, &torques(rows))?) } else { None };
        let term = |found: &DMatrix<f64>, term: usize| Vector3::from_fn(|axis, _| found[(4 + term, axis)]);
        let terms = (0..count).map(|i| Wrench {
            force_n: term(&force_n, i),
            torque_nm: torque_nm.as_ref().map_or_else(Vector3::zeros, |found| term(found, i)),
        });
        Some(Self { terms: terms.collect() })
    }

    /// Returns the row as it would have been read with the bias of the last pose, which is the newest.
    pub(super) fn removed(&self, row: &GravityRow) -> GravityRow {
        let Wrench { force_n, torque_nm } = self.since(row.place);
        let wrench = Wrench { force_n: row.wrench.force_n + force_n, torque_nm: row.wrench.torque_nm + torque_nm };
        GravityRow { wrench, ..*row }
    }

    /// Returns the change of the bias from a place to the last pose.
    fn since(&self, place: f64) -> Wrench {
        let nothing = Wrench { force_n: Vector3::zeros(), torque_nm: Vector3::zeros() };
        self.terms.iter().zip(polynomials(place)).fold(nothing, |sum, (term, value)| Wrench {
            force_n: sum.force_n + term.force_n * (1.0 - value),
            torque_nm: sum.torque_nm + term.torque_nm * (1.0 - value),
        })
    }

    /// Returns the change of the bias from the first pose to the last, N.
    pub(super) fn total_n(&self) -> f64 {
        self.since(-1.0).force_n.norm()
    }

    /// Returns the change of the bias over the last quarter of the poses, N.
    pub(super) fn late_n(&self) -> f64 {
        self.since(LATE_PLACE).force_n.norm()
    }

    fn max_n(&self, rows: &[GravityRow]) -> f64 {
        rows.iter().map(|row| self.since(row.place).force_n.norm()).fold(0.0, f64::max)
    }
}

fn design(rows: &[GravityRow], terms: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), 4 + terms, |i, column| match column {
        0..3 => rows[i].field_m_s2[column] / GRAVITY_M_S2,
        3 => 1.0,
        _ => polynomials(rows[i].place)[column - 4],
    })
}

/// Returns the Legendre polynomials of degree 1 to 4, all 1 at 1.
fn polynomials(p: f64) -> [f64; MAX_TERMS] {
    let square = p * p;
    [p, 1.5 * square - 0.5, p * (2.5 * square - 1.5), square * (4.375 * square - 3.75) + 0.375]
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::super::{GravityPose, GravitySettings, Orientation, fit, tests::Tool};
    use crate::calibration::{AxisStats, Verdict};

    /// Returns poses of a sensor whose bias changes by this much during warm-up, mostly at the start; `tool` has the last
    /// bias.
    fn warming(seed: u64, count: usize, drift_n: f64) -> (Tool, Vec<GravityPose>) {
        let mut tool = Tool::new(seed, 0.3);
        let way = tool.vector(1.0).normalize() * drift_n;
        let pose = |i: usize| {
            let mut pose = tool.imu_pose(0.02, 1e-3);
            let warm = |place: f64| 1.0 - (-2.0 * place).exp();
            pose.wrench.force_n += way * (warm(i as f64 / (count - 1) as f64) / warm(1.0) - 1.0);
            pose
        };
        let poses = (0..count).map(pose).collect();
        (tool, poses)
    }

    #[test]
    fn a_sensor_that_warms_up_is_named_and_no_pose_is_blamed() {
        for (seed, count) in (0..40).map(|seed| (seed, if seed % 2 == 0 { 100 } else { 16 })) {
            let (_, poses) = warming(seed, count, 1.5);
            let report = fit(&poses, &GravitySettings::default()).unwrap();
            assert_eq!(report.verdict, Verdict::PoorData, "{}", report.reason);
            assert!(report.reason.contains("the bias drifted by 1."), "seed {seed}, {count} poses: {}", report.reason);
            assert!(report.outliers.is_empty());
        }
    }

    #[test]
    fn a_small_drift_is_removed_and_the_bias_is_that_of_the_last_pose() {
        let mut errors = Vec::new();
        for seed in 0..40 {
            let (tool, poses) = warming(seed, 40, 0.3);
            let report = fit(&poses, &GravitySettings::default()).unwrap();
            let model = report.chosen_fit().unwrap().model;
            assert_eq!(report.verdict, Verdict::Accepted, "seed {seed}: {}", report.reason);
            assert!(report.reason.contains("the bias drifted by 0."), "seed {seed}: {}", report.reason);
            errors.push(model.predict(&Vector3::zeros()).force_n - tool.bias.force_n);
        }
        assert!(AxisStats::of(errors).largest() < 0.05);
    }

    /// The drift of 1.5 N ends in the middle of the poses, and the sensor's axes are neither equal nor orthogonal.
    #[test]
    fn a_sensor_that_warmed_up_during_the_poses_is_calibrated_without_its_drift() {
        let mut errors = Vec::new();
        for seed in 0..20 {
            let mut tool = Tool::new(seed, 0.4);
            let way = tool.vector(1.0).normalize() * 1.5;
            let skew = Matrix3::identity() + Matrix3::from_fn(|_, _| tool.noise.gaussian() * 0.03);
            let read = |i: usize, tool: &mut Tool| {
                let mut pose = tool.imu_pose(0.02, 1e-3);
                let cold = (1.0 - i as f64 / 50.0).max(0.0);
                pose.wrench.force_n = skew * (pose.wrench.force_n - tool.bias.force_n) + tool.bias.force_n - way * cold;
                pose
            };
            let poses: Vec<_> = (0..100).map(|i| read(i, &mut tool)).collect();
            let report = fit(&poses, &GravitySettings::default()).unwrap();
            assert_eq!(report.verdict, Verdict::Accepted, "seed {seed}: {}", report.reason);
            assert!(report.reason.contains("the bias drifted by 1."), "seed {seed}: {}", report.reason);
            assert!(report.outliers.len() <= 2, "seed {seed}: {:?}", report.outliers);
            let model = report.chosen_fit().unwrap().model;
            for _ in 0..20 {
                let pose = read(99, &mut tool);
                let Orientation::Imu(acceleration) = pose.orientation else { panic!("{pose:?}") };
                errors.push(pose.wrench.force_n - model.predict(&-acceleration).force_n);
            }
        }
        let errors = AxisStats::of(errors);
        assert!(errors.mean_mae() < 0.05, "{errors:?}");
    }

    #[test]
    fn neither_steady_nor_touched_poses_are_called_a_drift() {
        for seed in 0..200 {
            let (mut tool, mut poses) = warming(seed, 16, 0.0);
            if seed % 2 == 0 {
                for touched in [3, 9, 14] {
                    poses[touched].wrench.force_n += tool.vector(2.0);
                }
            }
            let report = fit(&poses, &GravitySettings::default()).unwrap();
            assert!(!report.reason.contains("drift"), "seed {seed}: {}", report.reason);
            assert_eq!(report.verdict, Verdict::Accepted, "seed {seed}: {}", report.reason);
        }
    }
}
