//! One type for the sessions, results and records of all frame calibrations.

use std::{fmt::Debug, path::PathBuf, time::SystemTime};

use nima_core::calibration::{
    Judgement, RecordHead, Verdict,
    frames::{
        Calibration, CalibrationResult, CalibrationSource, FrameCause, FrameCoverage, FrameError, FramePhase,
        FrameRecord, FrameReport, FrameSample, FrameSession, HandEyeResult, RigChange, SensorMountResult, Serials,
        Sizes, TableResult, TipResult, TrocarResult, ViewResult,
    },
};
use nima_recording::store::{self, CalibrationAge, LoadedRecord, Store, StoreError};
use nima_words::language::{self, Language};

use super::kind::FrameKind;

/// A session of any frame calibration.
pub trait FrameJob: Debug {
    fn needs(&self) -> Vec<CalibrationSource>;
    fn step(&mut self, sample: &FrameSample, t_s: f64) -> FramePhase;
    fn coverage(&self) -> FrameCoverage;
    fn samples(&self) -> &[FrameSample];
    fn undo(&mut self);
    fn report(&self) -> Result<Outcome, FrameError>;
}

impl<C> FrameJob for FrameSession<C>
where
    C: Calibration + Debug,
    Outcome: From<FrameReport<C::Solution>>,
{
    fn needs(&self) -> Vec<CalibrationSource> {
        self.calibration().needs()
    }

    fn step(&mut self, sample: &FrameSample, t_s: f64) -> FramePhase {
        Self::step(self, sample, t_s)
    }

    fn coverage(&self) -> FrameCoverage {
        Self::coverage(self)
    }

    fn samples(&self) -> &[FrameSample] {
        Self::samples(self)
    }

    fn undo(&mut self) {
        Self::undo(self);
    }

    fn report(&self) -> Result<Outcome, FrameError> {
        Self::report(self).map(Into::into)
    }
}

/// An enum over the results of the calibrations, with one type around each.
macro_rules! of_each {
    ($(#[$meta:meta])* $vis:vis $name:ident($around:ident): $($variant:ident($found:ty)),*) => {
        $(#[$meta])*
        #[derive(Clone, Debug)]
        $vis enum $name {
            $($variant($around<$found>)),*
        }

        $(impl From<$around<$found>> for $name {
            fn from(value: $around<$found>) -> Self {
                Self::$variant(value)
            }
        })*
    };
}

/// Dispatches a common operation.
macro_rules! each {
    ($value:expr, $name:ident => $same:expr) => {
        match $value {
            Self::Tip($name) => $same,
            Self::HandEye($name) => $same,
            Self::Trocar($name) => $same,
            Self::Table($name) => $same,
            Self::View($name) => $same,
            Self::Mount($name) => $same,
        }
    };
}

of_each!(
    /// The result of a frame calibration.
    pub Outcome(FrameReport): Tip(TipResult), HandEye(HandEyeResult), Trocar(TrocarResult), Table(TableResult), View(ViewResult),
    Mount(SensorMountResult)
);

of_each!(
    /// The record of a frame calibration.
    pub FrameCalibration(FrameRecord): Tip(TipResult), HandEye(HandEyeResult), Trocar(TrocarResult), Table(TableResult), View(ViewResult),
    Mount(SensorMountResult)
);

/// Common parts of all results.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    pub verdict: Verdict,
    pub cause: FrameCause,
    pub poses: usize,
    pub fitted: Sizes,
    pub held_out: Sizes,
    pub held_out_max: Sizes,
    pub uncertainty: Sizes,
}

impl Outcome {
    pub fn quality(&self) -> Quality {
        each!(self, report => Quality {
            verdict: report.verdict,
            cause: report.cause,
            poses: report.poses,
            fitted: report.fitted,
            held_out: report.held_out,
            held_out_max: report.held_out_max,
            uncertainty: report.uncertainty,
        })
    }

    /// Returns the indices of the poses that were left out.
    pub fn outliers(&self) -> &[usize] {
        each!(self, report => &report.outliers)
    }

    /// Returns whether there is a result.
    pub fn is_found(&self) -> bool {
        each!(self, report => report.found.is_some())
    }

    /// `None` without a result.
    pub fn record(&self, head: RecordHead, serials: Serials) -> Option<FrameCalibration> {
        let reason = language::with(Language::English, || nima_words::report_text::cause(&self.quality().cause));
        each!(self, report => report.record(head, serials, &reason).map(Into::into))
    }
}

impl FrameCalibration {
    pub fn judgement_mut(&mut self) -> &mut Judgement {
        each!(self, record => &mut record.judgement)
    }

    /// Returns its changes to the rig file.
    pub fn rig_mut(&mut self) -> &mut Vec<RigChange> {
        each!(self, record => &mut record.rig)
    }

    /// Writes it into the store; returns its path.
    ///
    /// # Errors
    /// As [`Store::save`].
    pub fn save(&self, store: &Store) -> Result<PathBuf, StoreError> {
        match self {
            // The two parts of a view calibration are saved as two files.
            Self::View(record) if record.found.carrier == nima_core::calibration::frames::Carrier::Handle => {
                let path = store.path_of(HANDLE, &record.head.sensor, "toml")?;
                let failed = |source| StoreError::Write { path: path.clone(), source };
                std::fs::create_dir_all(store.folder()).map_err(failed)?;
                store::write(&path, record)?;
                Ok(path)
            }
            _ => each!(self, record => store.save(record)),
        }
    }
}

/// First part of the name of the file for the handle's part of a view.
const HANDLE: &str = "view_handle";

/// Facts of a saved frame calibration of any kind.
#[derive(Clone, Debug)]
pub struct StoredFrame {
    /// Date, UTC, ISO 8601.
    pub date: String,
    pub age: CalibrationAge,
    pub judgement: Judgement,
    /// Root mean square error on held-out poses.
    pub held_out: Sizes,
    /// Changes to the rig file.
    pub rig: Vec<RigChange>,
}

impl<F: CalibrationResult> From<LoadedRecord<FrameRecord<F>>> for StoredFrame {
    fn from(LoadedRecord { record, age, .. }: LoadedRecord<FrameRecord<F>>) -> Self {
        let FrameRecord { head, judgement, held_out, rig, .. } = record;
        Self { date: head.date, age, judgement, held_out, rig }
    }
}

/// Returns the last saved calibration of this kind for a sensor and tool (`handle`: the handle's part of a view);
/// `None` if there is none.
///
/// # Errors
/// As [`Store::load`].
pub fn frame_kept(
    store: &Store,
    kind: FrameKind,
    handle: bool,
    [sensor, tool]: [&str; 2],
) -> Result<Option<StoredFrame>, StoreError> {
    fn of<F: CalibrationResult>(store: &Store, [sensor, tool]: [&str; 2]) -> Result<Option<StoredFrame>, StoreError> {
        Ok(store.load::<FrameRecord<F>>(sensor, tool, SystemTime::now())?.map(Into::into))
    }
    let wrist = [sensor, tool];
    match kind {
        FrameKind::Tip => of::<TipResult>(store, wrist),
        FrameKind::HandEye => of::<HandEyeResult>(store, wrist),
        FrameKind::Trocar => of::<TrocarResult>(store, wrist),
        FrameKind::Table => of::<TableResult>(store, wrist),
        FrameKind::View if handle => {
            let path = store.path_of(HANDLE, sensor, "toml")?;
            let record = store::read::<FrameRecord<ViewResult>>(&path)?;
            Ok(record.map(|record| {
                let age = store.age_of(&record.head.date, SystemTime::now()).unwrap_or(CalibrationAge::Future);
                LoadedRecord { record, age, path }.into()
            }))
        }
        FrameKind::View => of::<ViewResult>(store, wrist),
        FrameKind::Mount => of::<SensorMountResult>(store, wrist),
    }
}

/// Returns the changes of the last saved calibration of this kind to the rig file; empty if there is none for this
/// sensor and tool.
pub fn last_changes(store: &Store, kind: FrameKind, handle: bool, wrist: [&str; 2]) -> Vec<RigChange> {
    frame_kept(store, kind, handle, wrist).ok().flatten().map(|kept| kept.rig).unwrap_or_default()
}
