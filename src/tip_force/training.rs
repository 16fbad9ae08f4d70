//! Training of the ensemble (on candle, on the CPU): `AdamW`, mini-batches, falling learning rate, early stopping.
//!
//! Every member is stopped by trajectories it never saw: the folds are whole trajectories, or, where there are too few of
//! them, contiguous blocks with a gap towards the training part. Each member leaves out another fold, so that together they
//! use all data. A seed repeats exactly: weights and orders come from our own generator. Takes seconds to minutes: call it
//! on a background thread; members are trained side by side on the cores there are.

use std::{
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Instant,
};

use super::{DataSet, Expansion, Member, Normalisation, TipForceError, fit::Fit, folds::Folds, linear};

/// How to train.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Settings {
    /// Seed of weights, folds and orders.
    pub seed: u64,
    /// Networks in the ensemble, 1 to 16.
    pub members: usize,
    /// Widths of the hidden layers, one to four of 1 to 256.
    pub hidden: Vec<usize>,
    /// Most epochs of a member; `None` chooses as many as give about 5000 steps.
    pub epochs: Option<usize>,
    /// Rows in a mini-batch.
    pub batch: usize,
    /// Learning rate at the start; it falls along a half cosine to a fiftieth.
    pub learning_rate: f64,
    /// Weight decay of `AdamW`.
    pub weight_decay: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            seed: 1,
            members: 4,
            hidden: vec![32, 32],
            epochs: None,
            batch: 256,
            learning_rate: 3e-3,
            weight_decay: 1e-3,
        }
    }
}

/// Steps of the optimiser that a member gets where the caller names no epochs.
const STEPS: usize = 5000;

/// Fewest rows to learn from.
pub const MIN_ROWS: usize = 200;

impl Settings {
    fn check(&self) -> Result<(), TipForceError> {
        let wrong = |name, value: String, allowed| Err(TipForceError::Setting { name, value, allowed });
        if !(1..=16).contains(&self.members) {
            return wrong("members", self.members.to_string(), "1 to 16");
        }
        if !(1..=4).contains(&self.hidden.len()) || self.hidden.iter().any(|width| !(1..=256).contains(width)) {
            return wrong("hidden", format!("{:?}", self.hidden), "one to four widths of 1 to 256");
        }
        if self.epochs.is_some_and(|epochs| !(1..=100_000).contains(&epochs)) {
            return wrong("epochs", self.epochs.unwrap_or(0).to_string(), "1 to 100000");
        }
        if !(8..=65_536).contains(&self.batch) {
            return wrong("batch", self.batch.to_string(), "8 to 65536");
        }
        if !(1e-6..=1.0).contains(&self.learning_rate) {
            return wrong("learning rate", self.learning_rate.to_string(), "0.000001 to 1");
        }
        if !(0.0..=1.0).contains(&self.weight_decay) {
            return wrong("weight decay", self.weight_decay.to_string(), "0 to 1");
        }
        Ok(())
    }

    /// Most epochs for this many training rows.
    pub fn epochs_for(&self, rows: usize) -> usize {
        self.epochs.unwrap_or_else(|| (STEPS / rows.div_ceil(self.batch).max(1)).clamp(10, 500))
    }
}

/// One epoch of one member.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Progress {
    /// Which member, from 0.
    pub member: usize,
    /// How many members there are.
    pub members: usize,
    /// Epoch, from 1.
    pub epoch: usize,
    /// Most epochs there can be.
    pub epochs_max: usize,
    /// Mean square error on the training part, in squares of the outputs' standard deviation.
    pub training_loss: f64,
    /// The same on the part that stops the training.
    pub validation_loss: f64,
    /// Least validation loss so far.
    pub best: f64,
    /// Time since the training began, s.
    pub elapsed_s: f64,
    /// This was the member's last epoch.
    pub finished: bool,
}

/// What one member reached.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MemberFigures {
    /// Epoch whose weights were kept, from 1; 0 where the linear path alone was best.
    pub epoch: usize,
    /// Epochs run.
    pub epochs: usize,
    /// Mean square error on the training part in that epoch, in squares of the outputs' standard deviation.
    pub training_loss: f64,
    /// The same on the rows that stopped the training.
    pub validation_loss: f64,
}

/// A trained ensemble and all that belongs to it.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The members.
    pub members: Vec<Member>,
    /// What each reached.
    pub figures: Vec<MemberFigures>,
    /// How inputs become features.
    pub expansion: Expansion,
    /// Normalisation of the features.
    pub features: Normalisation,
    /// Normalisation of the outputs.
    pub outputs: Normalisation,
    /// Features that never change in the data and are neutral in the model, by name.
    pub constant: Vec<String>,
    /// Rows that a fold learns from, and rows it is judged by.
    pub(super) folds: Vec<(Vec<usize>, Vec<usize>)>,
    /// How long it took, s.
    pub elapsed_s: f64,
}

/// Normalised features of all rows, row by row.
pub(super) fn features_of(data: &DataSet, expansion: &Expansion) -> Vec<f32> {
    let width = expansion.width();
    let mut features = vec![0.0; data.rows() * width];
    for (row, to) in features.chunks_mut(width).enumerate() {
        expansion.expand(data.input(row), to);
    }
    features
}

/// Trains an ensemble. `cancel` stops it within one mini-batch; `progress` is called after every epoch, from the thread
/// that ran it, never from two at once.
pub fn train(
    data: &DataSet,
    settings: &Settings,
    cancel: &AtomicBool,
    progress: &(dyn Fn(&Progress) + Sync),
) -> Result<Trained, TipForceError> {
    settings.check()?;
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
    let features = Normalisation::of(&x, expansion.width(), 0..data.rows());
    let outputs = Normalisation::of(&data.y, data.outputs.len(), 0..data.rows());
    if let Some(column) = outputs.constant().next() {
        return Err(TipForceError::ConstantOutput { column: data.outputs[column].clone() });
    }
    let mut y = data.y.clone();
    x.chunks_mut(expansion.width()).for_each(|row| features.apply(row));
    y.chunks_mut(data.outputs.len()).for_each(|row| outputs.apply(row));
    let folds = Folds::of(data, settings.members, settings.seed);
    let alone = Mutex::new(());
    let report = |now: &Progress| {
        let _one_at_a_time = alone.lock();
        progress(&Progress { elapsed_s: start.elapsed().as_secs_f64(), ..*now });
    };
    let shape = (expansion.width(), data.outputs.len());
    let skip = linear::solve(&x, &y, shape, &(0..data.rows()).collect::<Vec<_>>());
    let fit = Fit { x: &x, y: &y, shape, skip: &skip, settings, cancel, progress: &report };
    let (members, figures) = all_members(&fit, &folds)?.into_iter().unzip();
    let constant = features.constant().map(|feature| expansion.name(feature, &data.inputs)).collect();
    let folds = (0..folds.count()).map(|fold| folds.split(fold)).collect();
    Ok(Trained {
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

/// Trains the members on as many threads as there are cores; the first failure ends all.
fn all_members(fit: &Fit<'_>, folds: &Folds) -> Result<Vec<(Member, MemberFigures)>, TipForceError> {
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
                    if result.is_err() {
                        next.store(count, Ordering::Relaxed);
                    }
                    results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((member, result));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.sort_by_key(|(member, _)| *member);
    results.into_iter().map(|(_, result)| result).collect()
}
