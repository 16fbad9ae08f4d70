//! Decides whether a trained network may be used, from a recording made after the training.
//!
//! Takes a model and a data set that it was not trained on; returns a verdict with its reason. The limits follow the
//! paper's errors: mean absolute error per axis (at most 0.19 N in the paper, 0.20 N here), and a prediction near zero
//! without contact.

use nima_core::{
    calibration::{Judgement, Verdict},
    tip_force::{Estimator, NO_MODEL, OriginCheck},
};
use nima_recording::{
    store::utc_now,
    tip_force::{DataSet, TipForceError},
};

use super::{Evaluation, evaluate};

/// Maximum mean absolute error of an axis, N.
const MAE_N: f64 = 0.20;
/// Maximum mean prediction without contact, N.
const FREE_MEAN_N: f64 = 0.05;
/// Maximum fraction of samples flagged as uncertain.
const DOUBT: f64 = 0.10;
/// Minimum number of rows: in total, and with and without contact.
const ROWS: usize = 1000;
const OF_EACH: usize = 150;

/// Judges a model by these data. Returns the check to be stored in [`nima_core::tip_force::ModelOrigin::check`] and all
/// errors.
///
/// # Errors
/// [`TipForceError`] if the columns are not the model's.
pub fn check(estimator: &mut Estimator, data: &DataSet) -> Result<(OriginCheck, Evaluation), TipForceError> {
    if data.outputs.len() != 3 || data.contact.is_none() {
        let reason = "a check needs the three forces at the tip and the column \"contact\"".to_owned();
        return Err(TipForceError::Columns { reason });
    }
    let evaluation = evaluate(estimator, data)?;
    let free = data.contact.iter().flatten().filter(|contact| !**contact).count();
    let (verdict, reason) = judge(&evaluation, [data.rows(), free]);
    let part = &evaluation.overall;
    let of = |value: &dyn Fn(&super::Stats) -> f64| {
        let stats = &part.methods[0].outputs;
        std::array::from_fn(|axis| stats.get(axis).copied().flatten().map_or(f64::INFINITY, |stats| value(&stats)))
    };
    let at_rest = |value: &dyn Fn(&super::NoContact) -> f64| std::array::from_fn(|axis| value(&part.no_contact[axis]));
    let check = OriginCheck {
        judgement: Judgement::new(verdict, reason),
        date: utc_now(),
        rows: data.rows(),
        mae_n: of(&|stats| stats.mae),
        sd_n: of(&|stats| stats.sd),
        free_mean_n: at_rest(&|rest| rest.mean),
        free_sd_n: at_rest(&|rest| rest.sd),
        doubt_fraction: part.doubt_fraction,
    };
    Ok((check, evaluation))
}

fn judge(evaluation: &Evaluation, [rows, free]: [usize; 2]) -> (Verdict, String) {
    let part = &evaluation.overall;
    let worst = |method: &super::MethodFigures| {
        method.outputs.iter().map(|stats| stats.map_or(f64::INFINITY, |stats| stats.mae)).fold(0.0, f64::max)
    };
    let mae_n = worst(&part.methods[0]);
    let wrist_n = part.methods.iter().find(|method| method.method == NO_MODEL).map_or(f64::INFINITY, worst);
    let free_n = part.no_contact.iter().map(|rest| rest.mean.abs()).fold(0.0, f64::max);
    let doubt = part.doubt_fraction;
    // On its training data every network looks accurate.
    if !evaluation.trained_on.is_empty() {
        (Verdict::PoorData, "the model was trained on these data; record new data".to_owned())
    } else if rows < ROWS || free < OF_EACH || rows - free < OF_EACH {
        let touching = rows - free;
        let reason =
            format!("too few rows: {touching} with and {free} without contact; work on the tissue and above it");
        (Verdict::InsufficientMotion, reason)
    } else if doubt > DOUBT {
        let reason = format!(
            "{:.0} % of the samples are outside the range of the training data; record a wider range",
            100.0 * doubt
        );
        (Verdict::PoorData, reason)
    } else if mae_n > MAE_N {
        (Verdict::PoorData, format!("the mean error is {mae_n:.2} N (limit {MAE_N:.2} N); record more"))
    } else if mae_n >= wrist_n {
        (
            Verdict::PoorData,
            format!(
                "the model's error ({mae_n:.2} N) is as large as that of the wrist force itself: the model does not help"
            ),
        )
    } else if free_n > FREE_MEAN_N {
        let reason = format!("the model predicts {free_n:.2} N without contact; record more data without contact");
        (Verdict::PoorData, reason)
    } else {
        (Verdict::Accepted, format!("mean error {mae_n:.2} N on new data; the wrist force alone has {wrist_n:.2} N"))
    }
}
