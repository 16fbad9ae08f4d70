//! Training of the ensemble: `AdamW`, mini-batches, decreasing learning rate, early stopping.
//!
//! Early stopping of every member uses held-out data: the folds are whole trajectories or, if there are too few,
//! contiguous blocks with a gap to the training rows. Each member holds out another fold, so that together they use all
//! data. The same seed gives the same result, because initial weights and the order of rows come from our own
//! generator. Training takes seconds to minutes, so call it on a background thread; members are trained in parallel on
//! the available cores.

use std::{
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Instant,
};

use nima_core::tip_force::{
    Baselines, DEFAULT_INPUTS, Doubt, Expansion, ForceModel, Member, MemberFigures, ModelOrigin, Normalisation,
    TipForceNetwork, TrainingSettings, linear,
};
use nima_recording::{
    store::utc_now,
    tip_force::{DataSet, TipForceError},
};

use super::{fit::TrainingFit, folds::Folds};

// Design choice: one second of the wizard's rows (5 ms). A held-out part of fewer rows would say little.
pub const MIN_ROWS: usize = 200;

fn checked(settings: &TrainingSettings) -> Result<(), TipForceError> {
    let wrong = |name, value: String, allowed| Err(TipForceError::Setting { name, value, allowed });
    if !(1..=16).contains(&settings.members) {
        return wrong("members", settings.members.to_string(), "1 to 16");
    }
    if !(1..=4).contains(&settings.hidden.len()) || settings.hidden.iter().any(|width| !(1..=256).contains(width)) {
        return wrong("hidden", format!("{:?}", settings.hidden), "one to four widths of 1 to 256");
    }
    if settings.epochs.is_some_and(|epochs| !(1..=100_000).contains(&epochs)) {
        return wrong("epochs", settings.epochs.unwrap_or(0).to_string(), "1 to 100000");
    }
    if !(8..=65_536).contains(&settings.batch) {
        return wrong("batch", settings.batch.to_string(), "8 to 65536");
    }
    if !(1e-6..=1.0).contains(&settings.learning_rate) {
        return wrong("learning rate", settings.learning_rate.to_string(), "0.000001 to 1");
    }
    if !(0.0..=1.0).contains(&settings.weight_decay) {
        return wrong("weight decay", settings.weight_decay.to_string(), "0 to 1");
    }
    Ok(())
}

/// Progress after one epoch of one member.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct TrainingProgress {
    /// From 0.
    pub member: usize,
    pub members: usize,
    /// From 1.
    pub epoch: usize,
    pub epochs_max: usize,
    /// Mean square error on the training rows, in units of the outputs' variance.
    pub training_loss: f64,
    /// The same on the held-out rows, used for early stopping.
    pub validation_loss: f64,
    /// Lowest validation loss so far.
    pub best: f64,
    /// Since the training started, s.
    pub elapsed_s: f64,
    pub finished: bool,
}

/// A trained ensemble and everything needed to use it.
#[derive(Clone, Debug)]
pub struct TrainedEnsemble {
    pub members: Vec<Member>,
    pub figures: Vec<MemberFigures>,
    pub expansion: Expansion,
    pub features: Normalisation,
    pub outputs: Normalisation,
    /// Names of features that are constant in the data and therefore have no effect in the model.
    pub constant: Vec<String>,
    /// Training rows and held-out rows of each fold.
    pub(super) folds: Vec<(Vec<usize>, Vec<usize>)>,
    pub elapsed_s: f64,
}

/// Returns the normalised features of all rows, row by row.
pub(super) fn features_of(data: &DataSet, expansion: &Expansion) -> Vec<f32> {
    let width = expansion.width();
    let mut features = vec![0.0; data.rows() * width];
    for (row, to) in features.chunks_mut(width).enumerate() {
        expansion.expand(data.input(row), to);
    }
    features
}

/// Trains an ensemble. Setting `cancel` stops it within one mini-batch. `progress` is called after every epoch from the
/// thread that ran it, never from two threads at once.
///
/// # Errors
/// [`TipForceError`] if the settings or data are unusable, the loss diverges, or the training is cancelled.
///
/// ```
/// use std::{path::PathBuf, sync::atomic::AtomicBool};
///
/// use nima_core::tip_force::TrainingSettings;
/// use nima_recording::tip_force::{DataSet, Selection, TipForceError};
///
/// let columns = Selection { inputs: Some(vec!["fx_n".into()]), outputs: Some(vec!["tip_fx_n".into()]) };
/// let data = DataSet::parse(&[(PathBuf::from("short.csv"), b"fx_n,tip_fx_n\n1,1\n2,2\n".to_vec())], &columns)?;
/// let refused = nima_training::train(&data, &TrainingSettings::default(), &AtomicBool::new(false), &|_| {});
/// assert!(matches!(refused, Err(TipForceError::TooFewRows { found: 2, .. })));
/// # Ok::<(), TipForceError>(())
/// ```
pub fn train(
    data: &DataSet,
    settings: &TrainingSettings,
    cancel: &AtomicBool,
    progress: &(dyn Fn(&TrainingProgress) + Sync),
) -> Result<TrainedEnsemble, TipForceError> {
    checked(settings)?;
    if data.rows() < MIN_ROWS {
        return Err(TipForceError::TooFewRows { found: data.rows(), needed: MIN_ROWS });
    }
    let start = Instant::now();
    let expansion = Expansion::fit(&data.inputs, &data.x);
    let mut x = features_of(data, &expansion);
    if let Some(row) = x.chunks(expansion.width()).position(|row| row.iter().any(|value| !value.is_finite())) {
        let reason = format!("row {} of the data has a quaternion of length zero", row + 1);
        return Err(TipForceError::Columns { reason });
    }
    // Scaled by all rows, so that the members have the same inputs and can be averaged.
    let features = Normalisation::of(&x, expansion.width(), 0..data.rows());
    let outputs = Normalisation::of(&data.y, data.outputs.len(), 0..data.rows());
    // The errors are divided by the variance of the outputs.
    if let Some(column) = outputs.constant().next() {
        return Err(TipForceError::ConstantOutput { column: data.outputs[column].clone() });
    }
    let constant: Vec<String> = features.constant().map(|feature| expansion.name(feature, &data.inputs)).collect();
    if let Some(reason) = nothing_to_learn_from(&data.inputs, &constant, expansion.width()) {
        return Err(TipForceError::Columns { reason });
    }
    let mut y = data.y.clone();
    x.chunks_mut(expansion.width()).for_each(|row| features.apply(row));
    y.chunks_mut(data.outputs.len()).for_each(|row| outputs.apply(row));
    let folds = Folds::of(data, settings.members, settings.seed);
    let alone = Mutex::new(());
    let report = |now: &TrainingProgress| {
        let _one_at_a_time = alone.lock();
        progress(&TrainingProgress { elapsed_s: start.elapsed().as_secs_f64(), ..*now });
    };
    let shape = (expansion.width(), data.outputs.len());
    let skip = linear::solve(&x, &y, shape, &(0..data.rows()).collect::<Vec<_>>());
    let fit = TrainingFit { x: &x, y: &y, shape, skip: &skip, settings, cancel, progress: &report };
    let (members, figures) = all_members(&fit, &folds)?.into_iter().unzip();
    let folds = (0..folds.count()).map(|fold| folds.split(fold)).collect();
    Ok(TrainedEnsemble {
        members,
        figures,
        expansion,
        features,
        outputs,
        constant,
        folds,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

/// Trained with a frozen sensor, the network would see only the pose and no force, and its wrong predictions would look
/// certain.
fn nothing_to_learn_from(inputs: &[String], constant: &[String], width: usize) -> Option<String> {
    let cure = "check that the sensors send new readings, and record again";
    let mut forces = inputs.iter().filter(|name| DEFAULT_INPUTS[..3].contains(&name.as_str())).peekable();
    if forces.peek().is_some() && forces.all(|name| constant.contains(name)) {
        return Some(format!("no force at the wrist changes over the whole data set; {cure}"));
    }
    (constant.len() == width).then(|| format!("no input changes over the whole data set; {cure}"))
}

/// Trains the members on as many threads as there are cores; the first error ends them all.
fn all_members(fit: &TrainingFit<'_>, folds: &Folds) -> Result<Vec<(Member, MemberFigures)>, TipForceError> {
    let count = fit.settings.members;
    let workers = thread::available_parallelism().map_or(1, usize::from).min(count);
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::with_capacity(count));
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let member = next.fetch_add(1, Ordering::Relaxed);
                    if member >= count {
                        return;
                    }
                    let (training, validation) = folds.split(member);
                    let result = fit.member(member, &training, &validation);
                    // The other threads end before their next member.
                    if result.is_err() {
                        next.store(count, Ordering::Relaxed);
                    }
                    results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((member, result));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    // The order must not depend on the threads.
    results.sort_by_key(|(member, _)| *member);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Trains a model (see [`train`]), fits its baselines and calibrates its limits of uncertainty on the same data.
///
/// # Errors
/// As [`train`].
///
/// ```
/// use std::{fmt::Write, path::PathBuf, sync::atomic::AtomicBool};
///
/// use nima_core::tip_force::{Estimator, TrainingSettings};
/// use nima_recording::tip_force::{DataSet, Selection};
/// use nima_training::{evaluate, train_model};
///
/// // The wrist measures the force at the tip plus a friction against the motion.
/// let mut text = String::from("fz_n,insertion_speed_m_s,tip_fz_n,trajectory\n");
/// for row in 0..800 {
///     let t = 0.01 * f64::from(row);
///     let (speed, tip) = (0.03 * (5.0 * t).sin(), 2.0 * (4.1 * t).sin());
///     writeln!(text, "{},{speed},{tip},{}", tip + speed.signum(), row / 200)?;
/// }
/// let columns = Selection {
///     inputs: Some(vec!["fz_n".into(), "insertion_speed_m_s".into()]),
///     outputs: Some(vec!["tip_fz_n".into()]),
/// };
/// let data = DataSet::parse(&[(PathBuf::from("made.csv"), text.into_bytes())], &columns)?;
///
/// let settings = TrainingSettings { hidden: vec![8], members: 1, epochs: Some(5), ..TrainingSettings::default() };
/// let model = train_model(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {})?;
/// let figures = evaluate(&mut Estimator::new(model), &data)?;
/// let mae = |method: usize| figures.overall.methods[method].outputs[0].expect("both predict it").mae;
/// assert!(mae(0) < 0.5 * mae(1), "network {} N, without a model {} N", mae(0), mae(1));
/// assert!(!figures.trained_on.is_empty(), "these errors say nothing about new data");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn train_model(
    data: &DataSet,
    settings: &TrainingSettings,
    [sensor, tool]: [Option<String>; 2],
    cancel: &AtomicBool,
    progress: &(dyn Fn(&TrainingProgress) + Sync),
) -> Result<ForceModel, TipForceError> {
    let trained = train(data, settings, cancel, progress)?;
    let mut network = TipForceNetwork::new(trained.members).ok_or(TipForceError::Shapes)?;
    let width = trained.expansion.width();
    let mut x = features_of(data, &trained.expansion);
    x.chunks_mut(width).for_each(|row| trained.features.apply(row));
    let mut spreads = Vec::new();
    for (_, judge) in trained.folds.iter().take(settings.members) {
        for row in judge {
            // The most uncertain output decides.
            let spread = network.answer(&x[row * width..(row + 1) * width], 1.0).spread;
            spreads.push(spread.iter().copied().fold(0.0, f32::max));
        }
    }
    let measured = trained.expansion.measured();
    // If every trajectory is its own file, each held-out fold is a different session.
    let whole_sessions = data.files.len() > 1 && data.trajectories.len() == data.files.len();
    let doubt = Doubt::fit(&x, width, measured, &trained.folds, spreads, whole_sessions, settings.seed);
    let origin = ModelOrigin {
        sensor,
        tool,
        date: utc_now(),
        software: env!("CARGO_PKG_VERSION").to_owned(),
        data_hashes: data.hashes.clone(),
        rows: data.rows(),
        settings: settings.clone(),
        figures: trained.figures,
        constant: trained.constant,
        check: None,
    };
    Ok(ForceModel {
        inputs: data.inputs.clone(),
        outputs: data.outputs.clone(),
        baselines: Baselines::fit(&data.inputs, &data.outputs, &data.x, &data.y),
        expansion: trained.expansion,
        features: trained.features,
        scale: trained.outputs,
        network,
        doubt,
        origin,
    })
}
