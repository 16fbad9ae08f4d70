//! The fit: agreement of the poses, the three models, their errors on held-out poses, and the verdict.

use nalgebra::Vector3;

use super::{
    GravityError, GravityLimits, GravityModel, GravityParameters, GravityReport, GravitySettings, GravitySource,
    ModelFit, ModelKind,
    consensus::agreeing,
    coverage::{condition, coverage},
    plausible::implausible,
    pose::{GravityPose, GravityRow, OrientationReading, checked, rows},
    solve::solve,
    trend::BiasDrift,
};
use crate::{
    calibration::{AxisStats, Residuals, Verdict},
    frames::{GRAVITY_M_S2, Wrench},
};

/// Up to this number of poses, each is held out individually; above it, every tenth pose together.
const LEAVE_ONE_OUT: usize = 20;
/// The gain model is chosen automatically only with at least this many poses, because it has twelve unknowns for the
/// force, the physical model only seven.
const GAIN_POSES: usize = 12;
/// The gain model is chosen automatically only if its held-out error is below this fraction of the physical model's. On
/// twelve poses of an ideal sensor, the held-out error of the gain model is about 1.2 times as large, because each pose
/// matters more to a model with more unknowns; on new poses, it is only 1.06 times as large.
const GAIN_FRACTION: f64 = 0.9;
/// Errors below this are rounding and give no information, N.
const ROUNDING_N: f64 = 1e-9;
/// A mistake in the orientation is reported if correcting it leaves less than this fraction of the error; noise alone
/// would leave about as much as before.
const MISTAKE_FRACTION: f64 = 0.5;

struct FitFrame {
    source: GravitySource,
    imu_sign: i8,
    has_torque: bool,
    floor_n: f64,
}

impl FitFrame {
    fn fit(&self, kind: ModelKind, rows: &[GravityRow]) -> Option<GravityModel> {
        let parameters = solve(kind, rows, self.has_torque)?;
        Some(GravityModel { source: self.source, imu_sign: self.imu_sign, parameters })
    }

    /// Removes a drift and the poses that disagree with the others.
    fn agreeing(&self, rows: &[GravityRow], drift: Option<&BiasDrift>) -> AgreeingRows {
        let of = |drift: Option<BiasDrift>| {
            let steady: Vec<GravityRow> = rows.iter().map(|row| without(drift.as_ref(), row)).collect();
            let inliers = agreeing(&steady, self.floor_n);
            let kept = inliers.iter().map(|&i| steady[i]).collect();
            AgreeingRows { inliers, kept, drift }
        };
        let Some(drift) = drift.and_then(|drift| drift.refit(rows, self.has_torque)) else { return of(None) };
        // Once more without the poses that disagree, because a touched pose also bends the drift.
        let AgreeingRows { inliers, .. } = of(Some(drift.clone()));
        let agreeing: Vec<GravityRow> = inliers.iter().map(|&i| rows[i]).collect();
        of(Some(drift.refit(&agreeing, self.has_torque).unwrap_or(drift)))
    }
}

/// Returns the row without the drift, if there is one.
fn without(drift: Option<&BiasDrift>, row: &GravityRow) -> GravityRow {
    drift.map_or(*row, |drift| drift.removed(row))
}

/// Rows that agree with each other, without the drift of the bias.
struct AgreeingRows {
    /// Increasing indices of the rows.
    inliers: Vec<usize>,
    kept: Vec<GravityRow>,
    drift: Option<BiasDrift>,
}

/// The rows, the subset that agrees, and the training rows of each fold.
struct FitData {
    all: Vec<GravityRow>,
    agreeing: AgreeingRows,
    trainings: Vec<AgreeingRows>,
}

impl FitData {
    fn new(frame: &FitFrame, all: Vec<GravityRow>) -> Self {
        let drift = BiasDrift::find(&all, frame.has_torque, frame.floor_n);
        let agreeing = frame.agreeing(&all, drift.as_ref());
        let folds = if all.len() <= LEAVE_ONE_OUT { all.len() } else { 10 };
        let trainings = trainings(frame, &all, drift.as_ref(), folds);
        Self { all, agreeing, trainings }
    }
}

/// Fits all models to still poses and evaluates the chosen one. `Err` is returned only for invalid poses; poses that do
/// not determine a model, or fit badly, give a report with that verdict.
///
/// # Errors
/// [`GravityError`] for a pose with a non-finite number, a different source of orientation than the first, or a
/// defective accelerometer; without any poses; for a sign that is neither 1 nor -1.
///
/// A tool of 0.25 kg, held still in eight orientations that the arm reports:
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::{
///     calibration::gravity::{Orientation, GravityParameters, GravityPose, GravitySettings, fit},
///     frames::Wrench,
/// };
///
/// let bias_n = Vector3::new(0.3, -0.1, 0.8);
/// let pose = |i: u32| {
///     let world_from_s1 = UnitQuaternion::from_euler_angles(f64::from(i), 0.7 * f64::from(i), 1.3 * f64::from(i));
///     let weight_n = world_from_s1.inverse() * Vector3::new(0.0, 0.0, -0.25 * 9.81);
///     let wrench = Wrench { force_n: weight_n + bias_n, torque_nm: Vector3::zeros() };
///     GravityPose { wrench, has_torque: false, orientation: Orientation::Arm(world_from_s1) }
/// };
/// let poses: Vec<GravityPose> = (0..12).map(pose).collect();
/// let report = fit(&poses, &GravitySettings::default())?;
/// let model = report.fits.iter().find(|fit| Some(fit.kind) == report.chosen).expect("a chosen model").model;
/// let GravityParameters::Physical { mass_kg, .. } = model.parameters else { panic!("{:?}", model.kind()) };
/// assert!((mass_kg - 0.25).abs() < 1e-3, "{mass_kg} kg");
/// assert!(fit(&[], &GravitySettings::default()).is_err());
/// # Ok::<(), nima_core::calibration::gravity::GravityError>(())
/// ```
pub fn fit(poses: &[GravityPose], settings: &GravitySettings) -> Result<GravityReport, GravityError> {
    // Any other number would scale the accelerometer.
    if !matches!(settings.imu_sign, -1 | 1) {
        return Err(GravityError::BadSign { sign: settings.imu_sign });
    }
    let source = checked(poses)?;
    let GravitySettings { imu_sign, limits, .. } = *settings;
    // A torque model needs the torque of every pose.
    let has_torque = poses.iter().all(|pose| pose.has_torque);
    let frame = FitFrame { source, imu_sign, has_torque, floor_n: limits.outlier_floor_n };
    let data = FitData::new(&frame, rows(poses, imu_sign, OrientationReading::AsGiven));
    let AgreeingRows { inliers, kept, drift } = &data.agreeing;
    let outliers: Vec<usize> = (0..poses.len()).filter(|i| inliers.binary_search(i).is_err()).collect();
    let fits: Vec<ModelFit> = ModelKind::ALL.into_iter().filter_map(|kind| one_fit(kind, &frame, &data)).collect();
    let (mass_kg, com_m) = weight(&fits);
    let condition = condition(kept);
    let mut report = GravityReport {
        verdict: Verdict::Accepted,
        reason: String::new(),
        chosen: None,
        poses: poses.len(),
        source,
        outliers,
        coverage: coverage(kept),
        condition: condition.is_finite().then_some(condition),
        mass_kg,
        com_m,
        folds: data.trainings.len(),
        drift_n: drift.as_ref().map(BiasDrift::total_n),
        fits,
    };
    report.chosen = chosen(&report, settings);
    (report.verdict, report.reason) = judge(&report, poses, settings, &frame, drift.as_ref());
    Ok(report)
}

/// Fits one model to the agreeing rows; computes its errors on these and on held-out rows.
fn one_fit(kind: ModelKind, frame: &FitFrame, data: &FitData) -> Option<ModelFit> {
    let kept = &data.agreeing.kept;
    let model = frame.fit(kind, kept)?;
    let fitted: Vec<_> = kept.iter().map(|row| errors(&model, row)).collect();
    let held_out = held_out(kind, frame, data)?;
    let stats = |pick: fn(&Wrench) -> Vector3<f64>| Residuals {
        fitted: AxisStats::of(fitted.iter().map(pick)),
        held_out: AxisStats::of(held_out.iter().map(pick)),
    };
    Some(ModelFit {
        kind,
        model,
        force_n: stats(|e| e.force_n),
        torque_nm: frame.has_torque.then(|| stats(|e| e.torque_nm)),
    })
}

fn errors(model: &GravityModel, row: &GravityRow) -> Wrench {
    let predicted = model.predict(&row.field_m_s2);
    Wrench { force_n: row.wrench.force_n - predicted.force_n, torque_nm: row.wrench.torque_nm - predicted.torque_nm }
}

/// Returns the training rows of each fold. Agreement and drift are determined again for each fold, so that a held-out row
/// has no influence.
fn trainings(frame: &FitFrame, all: &[GravityRow], drift: Option<&BiasDrift>, folds: usize) -> Vec<AgreeingRows> {
    // Interleaved folds: consecutive poses are similar and would not test each other.
    let training = |fold| -> Vec<GravityRow> { (0..all.len()).filter(|i| i % folds != fold).map(|i| all[i]).collect() };
    (0..folds).map(|fold| frame.agreeing(&training(fold), drift)).collect()
}

/// Returns the errors on held-out rows, without the outliers of the whole set.
fn held_out(kind: ModelKind, frame: &FitFrame, data: &FitData) -> Option<Vec<Wrench>> {
    let inliers = &data.agreeing.inliers;
    let mut result = Vec::with_capacity(inliers.len());
    let folds = data.trainings.len();
    for (fold, training) in data.trainings.iter().enumerate() {
        let model = frame.fit(kind, &training.kept)?;
        let error = |&i: &usize| errors(&model, &without(training.drift.as_ref(), &data.all[i]));
        // Outliers are not tested here: they are judged by their number.
        result.extend(inliers.iter().filter(|&&i| i % folds == fold).map(error));
    }
    Some(result)
}

fn weight(fits: &[ModelFit]) -> (Option<f64>, Option<[f64; 3]>) {
    fits.iter()
        .find_map(|fit| match fit.model.parameters {
            GravityParameters::Physical { mass_kg, torque, .. } => {
                Some((Some(mass_kg), torque.map(|torque| torque.com_m)))
            }
            _ => None,
        })
        .unwrap_or_default()
}

/// Returns the requested model; by default the physical one, unless the gain model is clearly better on held-out poses.
fn chosen(report: &GravityReport, settings: &GravitySettings) -> Option<ModelKind> {
    if let Some(kind) = settings.model {
        return report.fit_of(kind).map(|fit| fit.kind);
    }
    let error = |kind| report.fit_of(kind).map(|fit| fit.force_n.held_out.mean_mae());
    let physical = error(ModelKind::Physical)?;
    let enough = report.poses - report.outliers.len() >= GAIN_POSES;
    let better = error(ModelKind::Gain).is_some_and(|gain| gain < GAIN_FRACTION * physical);
    Some(if enough && better { ModelKind::Gain } else { ModelKind::Physical })
}

fn judge(
    report: &GravityReport,
    poses: &[GravityPose],
    settings: &GravitySettings,
    frame: &FitFrame,
    drift: Option<&BiasDrift>,
) -> (Verdict, String) {
    let limits = &settings.limits;
    // Before the limits, because a wrong sign also looks like poor data.
    if let Some(mistake) = mistake(report, poses, settings, frame) {
        return (Verdict::PoorData, mistake.to_owned());
    }
    if let Some(reason) = insufficient(report, limits) {
        return (Verdict::InsufficientMotion, reason);
    }
    match report.chosen_fit() {
        None => (Verdict::InsufficientMotion, "the poses do not determine a model; record more poses".to_owned()),
        Some(fit) => match weightless(report, limits)
            .or_else(|| poor(report, fit, limits))
            .or_else(|| implausible(report, settings.weighed_kg))
        {
            Some(reason) => (Verdict::PoorData, drift.map_or(reason, still_drifting)),
            None => match drift {
                Some(drift) if drift.late_n() > limits.outlier_floor_n => (Verdict::PoorData, still_drifting(drift)),
                _ => (Verdict::Accepted, accepted(report, fit)),
            },
        },
    }
}

fn still_drifting(drift: &BiasDrift) -> String {
    format!(
        "the bias drifted by {:.2} N from the first pose to the last, {:.2} N of it in the last quarter; let the sensor warm up and record the poses again",
        drift.total_n(),
        drift.late_n()
    )
}

fn insufficient(report: &GravityReport, limits: &GravityLimits) -> Option<String> {
    let kept = report.poses - report.outliers.len();
    if kept < limits.min_poses {
        return Some(format!(
            "only {kept} poses are usable, at least {} are required; record more poses",
            limits.min_poses
        ));
    }
    if report.coverage < limits.min_coverage {
        return Some(format!(
            "the poses cover {:.2} of all directions of gravity (minimum {:.2}); tilt the tool further",
            report.coverage, limits.min_coverage
        ));
    }
    match report.condition {
        Some(condition) if condition <= limits.max_condition => None,
        condition => Some(format!(
            "the poses lie in a narrow cone or in one plane (condition {}, limit {:.0}); tilt the tool to other sides",
            condition.map_or_else(|| "infinite".to_owned(), |c| format!("{c:.0}")),
            limits.max_condition
        )),
    }
}

/// Checks that the force follows gravity by more than its noise: a sensor that repeats one reading fits every model
/// with a mass of zero.
fn weightless(report: &GravityReport, limits: &GravityLimits) -> Option<String> {
    let fit = report.fit_of(ModelKind::Physical)?;
    let weight_n = report.mass_kg? * GRAVITY_M_S2;
    let noise_n = fit.force_n.fitted.sd.into_iter().fold(0.0, f64::max);
    // Above the noise as well as above a fixed limit, because both can hide a tool.
    let min_n = limits.min_weight_n.max(limits.min_signal * noise_n);
    // Written so that NaN is rejected too.
    let seen = weight_n >= min_n;
    (!seen).then(|| {
        format!(
            "no weight was measured: gravity explains only {weight_n:.3} N of the force, but at least {min_n:.3} N are required above the noise; \
             check that the sensor sends new readings in N and that the tool hangs on it"
        )
    })
}

fn poor(report: &GravityReport, fit: &ModelFit, limits: &GravityLimits) -> Option<String> {
    let weight_n = report.mass_kg.unwrap_or(0.0) * GRAVITY_M_S2;
    let held_out = &fit.force_n.held_out;
    let mae_n = held_out.mean_mae();
    let max_n = held_out.largest();
    // An error of the orientation causes an error in proportion to the weight.
    let mae_limit = limits.mae_n.max(limits.mae_fraction * weight_n);
    let max_limit = limits.max_n.max(limits.max_fraction * weight_n);
    let fraction = report.outliers.len() as f64 / report.poses as f64;
    if mae_n > mae_limit {
        return Some(format!("the mean error on held-out poses is {mae_n:.3} N (limit {mae_limit:.3} N)"));
    }
    if max_n > max_limit {
        return Some(format!("the largest error on a held-out pose is {max_n:.3} N (limit {max_limit:.3} N)"));
    }
    if fraction > limits.max_outliers {
        return Some(format!(
            "{} of {} poses do not agree with the others; repeat them without touching the tool",
            report.outliers.len(),
            report.poses
        ));
    }
    let torque_nm = fit.torque_nm.map_or(0.0, |torque| torque.held_out.mean_mae());
    (torque_nm > limits.torque_mae_nm).then(|| {
        let limit = limits.torque_mae_nm;
        format!("the mean error of the torque on held-out poses is {torque_nm:.4} Nm (limit {limit:.4} Nm)")
    })
}

fn accepted(report: &GravityReport, fit: &ModelFit) -> String {
    let held_out = &fit.force_n.held_out;
    let drifted = |drift_n| format!("; the bias drifted by {drift_n:.2} N and is taken from the last poses");
    format!(
        "held-out poses agree within {:.3} N on average and {:.3} N at most, coverage {:.2}{}",
        held_out.mean_mae(),
        held_out.largest(),
        report.coverage,
        report.drift_n.map_or_else(String::new, drifted)
    )
}

/// Returns a common mistake in the orientation if correcting it explains well-distributed poses far better. With a
/// wrong sign the best fit is a reflection, which is not a possible mounting.
fn mistake(
    report: &GravityReport,
    poses: &[GravityPose],
    settings: &GravitySettings,
    frame: &FitFrame,
) -> Option<&'static str> {
    let limits = &settings.limits;
    let given = report.fit_of(ModelKind::Physical)?.force_n.held_out.mean_mae();
    if given < ROUNDING_N {
        return None;
    }
    let candidates: &[(OrientationReading, &str)] = match frame.source {
        GravitySource::Imu => &[(
            OrientationReading::Opposite,
            "the accelerometer reads opposite to the chosen sign (or one of its axes is mirrored); flip the sign",
        )],
        GravitySource::Arm => &[
            (
                OrientationReading::InverseRotation,
                "the inverse orientations fit: the file contains sensor from base; use base from sensor",
            ),
            (
                OrientationReading::Opposite,
                "the forces point opposite to gravity; check the signs of the force columns",
            ),
        ],
    };
    candidates.iter().find_map(|&(reading, words)| {
        let other = FitData::new(frame, rows(poses, settings.imu_sign, reading));
        // A correction has to pass the same limits as the data, otherwise chance would find mistakes.
        let kept = &other.agreeing.kept;
        let sound = kept.len() >= limits.min_poses
            && coverage(kept) >= limits.min_coverage
            && condition(kept) <= limits.max_condition;
        let errors = held_out(ModelKind::Physical, frame, &other)?;
        let error = AxisStats::of(errors.into_iter().map(|e| e.force_n)).mean_mae();
        (sound && error < MISTAKE_FRACTION * given).then_some(words)
    })
}
