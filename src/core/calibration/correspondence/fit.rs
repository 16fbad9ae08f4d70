//! Fits pairs of forces and returns a report with its verdict.

use std::ops::Range;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{
    CorrespondenceError, CorrespondenceExcitation, CorrespondenceLimits, CorrespondenceOptions, CorrespondenceReport,
    CorrespondenceSolution, FitTarget, OffsetFrame, PushAgreement, PushPair, SensorDiagnosis, euler,
    report::parts,
    solver::{PushRow, consensus, wahba},
};
use crate::{calibration::Verdict, units};

/// Maximum plausible force, N; the squares of larger numbers would lose precision.
const PLAUSIBLE_N: f64 = 1e4;
/// Up to this number of pairs, each is held out individually; above it, a tenth at a time.
const ALONE: usize = 20;
/// With fewer rows the residual of a rotation is meaningless.
const MIN_SOLVABLE: usize = 3;

/// Fits the rotation between both sensors and evaluates it. Pairs in the order recorded; a few hundred rows take about
/// a millisecond. Returns `Err` only for numbers that cannot be forces or rotations; all other data get a verdict.
///
/// # Errors
/// [`CorrespondenceError`] for a number that cannot be part of a force or rotation, with its pair.
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::calibration::correspondence::{CorrespondenceOptions, PushPair, fit};
///
/// let s1_from_s2 = UnitQuaternion::from_euler_angles(0.1, -0.4, 1.2);
/// let push = |i: u32| {
///     let (a, b) = (f64::from(i) * 0.9, f64::from(i) * 0.5);
///     let f2_n = Vector3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin()) * 5.0;
///     PushPair::plain(s1_from_s2 * f2_n, f2_n)
/// };
/// let pairs: Vec<PushPair> = (0..30).map(push).collect();
/// let found = fit(&pairs, &CorrespondenceOptions::default())?.solution.expect("pushes in all directions").rotation();
/// assert!(found.angle_to(&s1_from_s2).to_degrees() < 0.01);
/// # Ok::<(), nima_core::calibration::correspondence::CorrespondenceError>(())
/// ```
pub fn fit(pairs: &[PushPair], options: &CorrespondenceOptions) -> Result<CorrespondenceReport, CorrespondenceError> {
    check(pairs)?;
    let limits = &options.limits;
    // The weaker of the two sensors decides: a push that misses the tissue is felt at the wrist only.
    let strong = |pair: &PushPair| pair.f1_n.norm().min(pair.f2_n.norm()) >= limits.min_force_n;
    let (used, weak): (Vec<usize>, Vec<usize>) = (0..pairs.len()).partition(|&index| strong(&pairs[index]));
    let rows: Vec<PushRow> = used.iter().map(|&index| PushRow::of(&pairs[index], options.flip_s2)).collect();
    let found = consensus(&rows);
    let outliers: Vec<usize> = used.iter().zip(&found.inlier).filter(|&(_, &good)| !good).map(|(&i, _)| i).collect();
    let good: Vec<PushRow> = rows.iter().zip(&found.inlier).filter(|&(_, &good)| good).map(|(row, _)| *row).collect();
    let folds = folds(good.len());
    let excitation = CorrespondenceExcitation::of(&good, &folds, limits.min_spread);
    // No pair has a chain: the rotation is then the one between the sensors.
    let target = if pairs.iter().all(|pair| pair.s1_from_c == UnitQuaternion::identity()) {
        FitTarget::S1FromS2
    } else {
        FitTarget::CFromS2
    };
    let solution = (good.len() >= MIN_SOLVABLE).then(|| solve(&good, &folds, target));
    let mut report = CorrespondenceReport {
        verdict: Verdict::InsufficientMotion,
        reason: String::new(),
        pairs: pairs.len(),
        weak,
        outliers,
        excitation,
        solution,
    };
    let mistaken = mistaken_input(pairs, &used, &rows, found.median_n, options);
    (report.verdict, report.reason) = judge(&report, rows.len(), mistaken, limits);
    Ok(report)
}

fn check(pairs: &[PushPair]) -> Result<(), CorrespondenceError> {
    for (index, pair) in pairs.iter().enumerate() {
        let forces = [pair.f1_n, pair.f2_n];
        let numbers = forces.iter().flatten().chain(pair.s1_from_c.coords.iter());
        if numbers.into_iter().any(|number| !number.is_finite()) {
            return Err(CorrespondenceError::NotFinite { index });
        }
        let force_n = forces.iter().map(Vector3::amax).fold(0.0, f64::max);
        if force_n > PLAUSIBLE_N {
            return Err(CorrespondenceError::NotPlausible { index, force_n });
        }
    }
    Ok(())
}

/// Returns the ranges to hold out in turn: single rows, or tenths in the order recorded (neighbouring rows of one push
/// are not an independent test).
fn folds(rows: usize) -> Vec<Range<usize>> {
    let count = if rows <= ALONE { rows } else { 10 };
    (0..count).map(|fold| fold * rows / count..(fold + 1) * rows / count).collect()
}

fn solve(good: &[PushRow], folds: &[Range<usize>], target: FitTarget) -> CorrespondenceSolution {
    let rotation = wahba(good);
    let f1_n: Vec<_> = good.iter().map(|row| row.s1_from_c * row.c_n).collect();
    let fitted_n: Vec<_> = good.iter().map(|row| row.residual_in_s1_n(&rotation)).collect();
    let mut held_out_n = Vec::with_capacity(good.len());
    for fold in folds {
        let others = wahba(good[..fold.start].iter().chain(&good[fold.end..]));
        held_out_n.extend(good[fold.clone()].iter().map(|row| row.residual_in_s1_n(&others)));
    }
    // Three per row, less the three angles that were fitted.
    let freedom = (3 * good.len() - 3) as f64;
    let noise_n = (fitted_n.iter().map(Vector3::norm_squared).sum::<f64>() / freedom).sqrt();
    let (rotation_wxyz, roll_pitch_yaw_deg) = parts(&rotation.into());
    CorrespondenceSolution {
        target,
        rotation_wxyz,
        roll_pitch_yaw_deg,
        agreement: PushAgreement::of(&f1_n, &fitted_n, &held_out_n),
        noise_n,
        uncertainty_deg: uncertainty_deg(good, noise_n),
        cross_check_deg: UnitQuaternion::from(rotation).angle_to(&euler::search(good).into()).to_degrees(),
        diagnosis: SensorDiagnosis::of(good, &rotation),
    }
}

/// Returns the root mean square angular error from the information of the pushes, `sum [f]x^T [f]x / noise^2`; at most
/// 180.
fn uncertainty_deg(good: &[PushRow], noise_n: f64) -> f64 {
    let information: Matrix3<f64> =
        good.iter().map(|row| row.s2_n.cross_matrix().transpose() * row.s2_n.cross_matrix()).sum();
    let variance = information.try_inverse().map_or(f64::INFINITY, |inverse| noise_n * noise_n * inverse.trace());
    // Written so that NaN maps to the largest error.
    if variance >= 0.0 { variance.sqrt().to_degrees().min(180.0) } else { 180.0 }
}

/// Returns a wrong sign or an inverted rotation that explains the pushes at least twice as well as the input does.
/// Valid only if the pushes span all three dimensions: in a plane, a change of sign equals half a turn.
fn mistaken_input(
    pairs: &[PushPair],
    used: &[usize],
    rows: &[PushRow],
    median_n: f64,
    options: &CorrespondenceOptions,
) -> Option<&'static str> {
    let spread = CorrespondenceExcitation::of(rows, &[], options.limits.min_spread);
    if rows.len() < options.limits.min_pairs || spread.rank < 3 {
        return None;
    }
    // Half the median: a coincidence hardly halves the error of all pushes.
    let better = |edit: fn(&PushPair) -> PushPair| {
        let rows: Vec<PushRow> = used.iter().map(|&index| PushRow::of(&edit(&pairs[index]), options.flip_s2)).collect();
        consensus(&rows).median_n < 0.5 * median_n
    };
    if better(|pair| PushPair { f2_n: -pair.f2_n, ..*pair }) {
        return Some("the sensors report opposite forces (action and reaction); change the sign of sensor 2");
    }
    if better(|pair| PushPair { s1_from_c: pair.s1_from_c.inverse(), ..*pair }) {
        return Some("the given rotations are inverse (c_from_s1); use s1_from_c");
    }
    None
}

fn judge(
    report: &CorrespondenceReport,
    used: usize,
    mistaken: Option<&'static str>,
    limits: &CorrespondenceLimits,
) -> (Verdict, String) {
    // Checked first, because every later reason would make the operator push again with the same wrong input.
    if let Some(reason) = mistaken {
        return (Verdict::PoorData, reason.to_owned());
    }
    if let Some(reason) = lack_of_motion(report, used, limits) {
        return (Verdict::InsufficientMotion, reason);
    }
    let Some(solution) = &report.solution else {
        return (Verdict::PoorData, "fewer than three pushes agree on any rotation; repeat them".to_owned());
    };
    if let Some(reason) = disagreement(report, solution, used, limits) {
        return (Verdict::PoorData, reason);
    }
    if solution.uncertainty_deg > limits.uncertainty_deg {
        let reason = format!(
            "the pushes determine the rotation only to {:.1} degrees (limit {}); push harder, longer or in more directions",
            solution.uncertainty_deg, limits.uncertainty_deg
        );
        return (Verdict::InsufficientMotion, reason);
    }
    let mae_n = worst(&solution.agreement.residuals.held_out.mae);
    let reason = format!(
        "{} pushes agree to {mae_n:.3} N held out; the rotation is known to {:.2} degrees",
        used - report.outliers.len(),
        solution.uncertainty_deg
    );
    (Verdict::Accepted, reason)
}

fn lack_of_motion(report: &CorrespondenceReport, used: usize, limits: &CorrespondenceLimits) -> Option<String> {
    let CorrespondenceExcitation { second, third, weakest_n, rank } = report.excitation;
    if used < limits.min_pairs {
        let needed = limits.min_pairs;
        let min_n = limits.min_force_n;
        return Some(format!("only {used} pushes reach {min_n} N, {needed} are required; push more often and harder"));
    }
    let agree = used - report.outliers.len();
    // With many outliers, `disagreement` reports a more specific reason.
    if agree < limits.min_pairs && fraction(report.outliers.len(), used) <= limits.outlier_fraction {
        return Some(format!("only {agree} pushes agree, {} are required; push more often", limits.min_pairs));
    }
    match rank {
        0 | 1 => Some(format!("the pushes lie along one line (spread {second:.2}); push in all directions")),
        2 => Some(format!("the pushes lie in one plane (spread {third:.2}); push in other directions too")),
        // The spread is judged without strength; this compares the forces along the weakest axis with their noise.
        _ => {
            let noise_n = report.solution.as_ref()?.noise_n;
            (weakest_n < limits.min_signal * noise_n).then(|| {
                format!(
                    "along their weakest axis the pushes ({weakest_n:.2} N) are not clearly above the noise ({noise_n:.2} N); \
                     push harder there"
                )
            })
        }
    }
}

fn disagreement(
    report: &CorrespondenceReport,
    solution: &CorrespondenceSolution,
    used: usize,
    limits: &CorrespondenceLimits,
) -> Option<String> {
    let outliers = report.outliers.len();
    if fraction(outliers, used) > limits.outlier_fraction {
        return Some(format!("{outliers} of {used} pushes contradict the others; repeat them"));
    }
    // Checked before the errors, because a wrong gain or offset explains them and has a remedy.
    if let Some(diagnosis) = &solution.diagnosis {
        if diagnosis.gain_is_off(limits.gain_error) {
            return Some(gain_text(diagnosis.gain));
        }
        if diagnosis.offset_is_off(limits.offset_n) {
            return Some(offset_text(diagnosis));
        }
    }
    let agreement = &solution.agreement;
    let mae_n = worst(&agreement.residuals.held_out.mae);
    if mae_n > limits.held_out_mae_n {
        let max_n = limits.held_out_mae_n;
        return Some(format!("the error on held-out pushes is {mae_n:.2} N on the worst axis (limit {max_n} N)"));
    }
    if agreement.r2_held_out_overall < limits.min_r2 {
        let r2 = agreement.r2_held_out_overall;
        let min = limits.min_r2;
        return Some(format!("the rotation explains only {r2:.2} of the variance of held-out forces (minimum {min})"));
    }
    let angle_deg = solution.cross_check_deg;
    // Written so that NaN is rejected too.
    let same = angle_deg <= limits.cross_check_deg;
    (!same)
        .then(|| format!("the two solvers differ by {angle_deg:.2} degrees; the pushes do not determine the rotation"))
}

fn gain_text(gain: f64) -> String {
    let units = [(gain, "1"), (1.0 / gain, "2")];
    if let Some((unit, sensor)) =
        units.into_iter().find_map(|(ratio, sensor)| Some((units::force_unit(ratio)?, sensor)))
    {
        return format!(
            "sensor 1 reads {gain:.3} times the force of sensor 2; sensor {sensor} is probably in {unit}: convert it to N"
        );
    }
    if gain < 1.0 {
        format!(
            "sensor 2 reads {:.0} % more than sensor 1; check units and calibration of both",
            (1.0 / gain - 1.0) * 100.0
        )
    } else {
        format!("sensor 1 reads {:.0} % more than sensor 2; check units and calibration of both", (gain - 1.0) * 100.0)
    }
}

fn offset_text(diagnosis: &SensorDiagnosis) -> String {
    let by_n = diagnosis.offset_norm_n();
    let which = match diagnosis.offset_frame {
        OffsetFrame::S1 => "sensor 1 was not zeroed, or its gravity is not compensated",
        OffsetFrame::S2 => "sensor 2 was not zeroed",
        OffsetFrame::Unknown => "one sensor was not zeroed",
    };
    format!("{which}: a constant {by_n:.2} N remains; set both sensors to zero without contact and repeat")
}

fn fraction(part: usize, of: usize) -> f64 {
    part as f64 / of.max(1) as f64
}

fn worst(axes: &[f64; 3]) -> f64 {
    axes.iter().copied().fold(0.0, f64::max)
}
