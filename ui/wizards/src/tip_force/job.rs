//! Background work of the wizard: training and evaluation. The window never waits for it.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{Builder, JoinHandle},
};

use nima_core::{
    calibration::Verdict,
    tip_force::{Estimator, ForceModel, GoalKind, OriginCheck, TrainingSettings},
};
use nima_recording::{
    store::{Store, keep_previous},
    tip_force::{DataSet, Selection, TipForceRecorder},
};
use nima_training::{Evaluation, EvaluationPart, TrainingProgress, check, train_model};
use nima_words::{
    language::{self, Language},
    text,
};

/// A background thread. Dropping this asks it to stop; the thread then ends on its own, and its result is discarded.
#[derive(Debug)]
pub(super) struct TrainingJob<T> {
    cancel: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<T, String>>>,
}

impl<T: Send + 'static> TrainingJob<T> {
    /// Starts `work` on a thread with normal priority; the loop's thread has priority over it if that is granted.
    pub(super) fn start(
        name: &str,
        work: impl FnOnce(&AtomicBool) -> Result<T, String> + Send + 'static,
    ) -> Result<Self, String> {
        let cancel = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&cancel);
        let thread = Builder::new().name(name.to_owned()).spawn(language::carried(move || work(&stop)));
        let thread = thread.map_err(|error| text::tip_force::no_thread(&error))?;
        Ok(Self { cancel, thread: Some(thread) })
    }

    /// Returns the result, once; `None` while the work continues.
    pub(super) fn take_result(&mut self) -> Option<Result<T, String>> {
        let thread = self.thread.take_if(|thread| thread.is_finished())?;
        Some(thread.join().unwrap_or_else(|_| Err(text::tip_force::JOB_FAILED.get().to_owned())))
    }
}

impl<T> TrainingJob<T> {
    /// Requests it to stop.
    pub(super) fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Returns whether it was requested to stop.
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

impl<T> Drop for TrainingJob<T> {
    fn drop(&mut self) {
        // Its result is no longer needed.
        self.cancel();
    }
}

/// Losses of one member by epoch.
#[derive(Clone, Debug, Default)]
pub(super) struct LossCurve {
    /// Epoch, and logarithm (base 10) of the loss on training rows.
    pub(super) training: Vec<[f64; 2]>,
    /// Logarithm of the loss on held-out rows.
    pub(super) held_out: Vec<[f64; 2]>,
    fraction: f64,
}

/// Progress of the training.
#[derive(Clone, Debug, Default)]
pub(super) struct Curves {
    /// Losses of each member.
    pub(super) members: Vec<LossCurve>,
    /// Time since the start, s.
    pub(super) elapsed_s: f64,
}

impl Curves {
    fn add(&mut self, now: &TrainingProgress) {
        self.members.resize_with(self.members.len().max(now.members), LossCurve::default);
        self.elapsed_s = now.elapsed_s;
        // A loss of 0 has no logarithm.
        let decades = |loss: f64| [now.epoch as f64, loss.max(1e-12).log10()];
        let Some(curve) = self.members.get_mut(now.member) else { return };
        curve.training.push(decades(now.training_loss));
        curve.held_out.push(decades(now.validation_loss));
        curve.fraction = if now.finished { 1.0 } else { now.epoch as f64 / now.epochs_max.max(1) as f64 };
    }

    /// Returns the fraction of the work that is done, 0 to 1.
    pub(super) fn fraction(&self) -> f64 {
        self.members.iter().map(|curve| curve.fraction).sum::<f64>() / self.members.len().max(1) as f64
    }
}

/// Losses shared by two threads.
pub(super) type SharedLosses = Arc<Mutex<Curves>>;

/// Locks the losses; if a thread has panicked, they are used in their last state.
pub(super) fn look(curves: &Mutex<Curves>) -> MutexGuard<'_, Curves> {
    curves.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Inputs of the training, and the store for its data.
#[derive(Debug)]
pub(super) struct TrainingOrder {
    pub(super) recorder: TipForceRecorder,
    /// Keep the existing data set, which is from another recording.
    pub(super) keep_previous: bool,
    pub(super) settings: TrainingSettings,
    pub(super) bound: [String; 2],
    pub(super) store: Store,
}

/// Returns the path of a recording of this kind.
pub(super) fn path_of(store: &Store, kind: &str, sensor: &str) -> Result<PathBuf, String> {
    store.path_of(kind, sensor, "csv").map_err(|error| nima_words::report_text::quoted(&error))
}

fn write(recorder: &TipForceRecorder, path: &Path, keeps: bool) -> Result<(), String> {
    let failed = |error: std::io::Error| text::tip_force::not_written(path, &error);
    path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    if keeps {
        keep_previous(path).map_err(failed)?;
    }
    recorder.save(path).map_err(failed)
}

/// Saves the data set, so that it is not lost and the command line can use it, then trains on it.
pub(super) fn train(order: TrainingOrder, curves: &Mutex<Curves>, cancel: &AtomicBool) -> Result<ForceModel, String> {
    let TrainingOrder { recorder, keep_previous, settings, bound: [sensor, tool], store } = order;
    let path = path_of(&store, "tip-force-data", &sensor)?;
    // Written first, so that the recording survives the training.
    write(&recorder, &path, keep_previous)?;
    drop(recorder);
    let data =
        DataSet::read(&[path], &Selection::default()).map_err(|error| nima_words::report_text::quoted(&error))?;
    let report = |now: &TrainingProgress| look(curves).add(now);
    train_model(&data, &settings, [Some(sensor), Some(tool)], cancel, &report)
        .map_err(|error| nima_words::report_text::quoted(&error))
}

/// Bins of the histogram of predictions without contact, and their width, N.
pub(super) const BINS: usize = 41;
pub(super) const BIN_N: f64 = 0.01;
/// Maximum number of points in a regression plot.
const POINTS: usize = 700;

/// Result of a check, prepared for drawing.
#[derive(Clone, Debug)]
pub(super) struct CheckResult {
    /// Errors and verdict.
    pub(super) check: OriginCheck,
    /// Errors of all methods.
    pub(super) part: EvaluationPart,
    /// Per axis: measured and predicted force, N; a subset of the rows.
    pub(super) points: [Vec<[f64; 2]>; 3],
    /// Per axis: fraction of rows without contact in each bin; the middle bin is around zero, the outer ones include
    /// everything beyond.
    pub(super) bins: [[f64; BINS]; 3],
}

/// Evaluates a model on a new recording, which is saved next to the data set. If the training data were incomplete
/// (`narrow`), the model is not accepted, however small its errors are.
pub(super) fn judge(
    recorder: &TipForceRecorder,
    model: ForceModel,
    narrow: Option<GoalKind>,
    (store, sensor): (&Store, &str),
) -> Result<CheckResult, String> {
    let path = path_of(store, "tip-force-check", sensor)?;
    write(recorder, &path, true)?;
    let mut estimator = Estimator::new(model);
    let data = DataSet::read(&[path], &Selection::of(estimator.model()))
        .map_err(|error| nima_words::report_text::quoted(&error))?;
    let (mut check, evaluation) =
        check(&mut estimator, &data).map_err(|error| nima_words::report_text::quoted(&error))?;
    if let (Some(goal), Verdict::Accepted) = (narrow, check.judgement.verdict) {
        check.judgement.verdict = Verdict::InsufficientMotion;
        // The reason is stored in the file, hence in English.
        let reason = || text::tip_force::trained_on_too_little(&goal.name().to_lowercase());
        check.judgement.reason = language::with(Language::English, reason);
    }
    let points = points(&data, &evaluation);
    let bins = bins(&data, &evaluation);
    Ok(CheckResult { check, part: evaluation.overall, points, bins })
}

fn points(data: &DataSet, evaluation: &Evaluation) -> [Vec<[f64; 2]>; 3] {
    let every = data.rows().div_ceil(POINTS).max(1);
    std::array::from_fn(|axis| {
        let point = |row: usize| [data.output(row)[axis], evaluation.predictions[row * 3 + axis]].map(f64::from);
        (0..data.rows()).step_by(every).map(point).collect()
    })
}

fn bins(data: &DataSet, evaluation: &Evaluation) -> [[f64; BINS]; 3] {
    let free = |row: &usize| data.contact.as_ref().is_some_and(|contact| !contact[*row]);
    let rows: Vec<usize> = (0..data.rows()).filter(free).collect();
    std::array::from_fn(|axis| {
        let mut bins = [0.0; BINS];
        for &row in &rows {
            let place = (f64::from(evaluation.predictions[row * 3 + axis]) / BIN_N).round() + (BINS / 2) as f64;
            bins[place.clamp(0.0, (BINS - 1) as f64) as usize] += 1.0 / rows.len() as f64;
        }
        bins
    })
}
