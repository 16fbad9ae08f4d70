//! A bias that drifts from the first pose to the last, as during the warm-up of a sensor.

use nalgebra::{DMatrix, Matrix5x3};

use super::pose::GravityRow;
use crate::frames::GRAVITY_M_S2;

/// With fewer poses, a drift cannot be distinguished from chance.
const MIN_POSES: usize = 12;
/// A drift is reported if removing it leaves less than this fraction of the disagreement between poses; for pure noise,
/// almost all would remain.
const LEFT_FRACTION: f64 = 0.5;

/// Returns the change of the bias over all poses, in the order of recording (N), if a steady drift explains the
/// disagreement of the poses. A change below `floor_n` is ignored.
///
/// Least squares of the force on gravity (a free 3x3 gain), a constant, and the position in the order.
pub(super) fn drift_n(rows: &[GravityRow], floor_n: f64) -> Option<f64> {
    if rows.len() < MIN_POSES {
        return None;
    }
    // From -0.5 to 0.5, so that the slope is the change from the first pose to the last.
    let place = |i: usize| i as f64 / (rows.len() - 1) as f64 - 0.5;
    let design = DMatrix::from_fn(rows.len(), 5, |i, column| match column {
        0..3 => rows[i].field_m_s2[column] / GRAVITY_M_S2,
        3 => 1.0,
        _ => place(i),
    });
    let forces_n = DMatrix::from_fn(rows.len(), 3, |i, axis| rows[i].wrench.force_n[axis]);
    let steady = design.columns(0, 4).into_owned();
    let left_n = |design: &DMatrix<f64>| -> Option<(f64, DMatrix<f64>)> {
        let found = design.clone().svd(true, true).solve(&forces_n, 1e-9).ok()?;
        let errors_n = &forces_n - design * &found;
        Some((errors_n.row_iter().map(|row| row.norm()).sum::<f64>(), found))
    };
    let (without_n, _) = left_n(&steady)?;
    let (with_n, found) = left_n(&design)?;
    let drift_n = Matrix5x3::from_iterator(found.iter().copied()).row(4).norm();
    (drift_n > floor_n && with_n < LEFT_FRACTION * without_n).then_some(drift_n)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::super::{GravityPose, GravitySettings, fit, tests::Tool};
    use crate::calibration::{AxisStats, Verdict};

    /// Returns poses of a sensor whose bias changes by this much during warm-up, mostly at the start.
    fn warming(seed: u64, count: usize, drift_n: f64) -> (Tool, Vec<GravityPose>) {
        let mut tool = Tool::new(seed, 0.3);
        let way = tool.vector(1.0).normalize() * drift_n;
        let pose = |i: usize| {
            let mut pose = tool.imu_pose(0.02, 1e-3);
            pose.wrench.force_n += way * (1.0 - (-2.0 * i as f64 / count as f64).exp()) / (1.0 - (-2.0_f64).exp());
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
    fn a_drift_within_the_limits_is_averaged_like_least_squares_does() {
        let mut errors = Vec::new();
        for seed in 0..40 {
            let (tool, poses) = warming(seed, 40, 0.15);
            let report = fit(&poses, &GravitySettings::default()).unwrap();
            let model = report.chosen_fit().unwrap().model;
            // In the middle of the drift, the bias is off by half the drift from either end.
            errors.push(model.predict(&Vector3::zeros()).force_n - tool.bias.force_n);
        }
        assert!(AxisStats::of(errors).largest() < 0.15);
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
