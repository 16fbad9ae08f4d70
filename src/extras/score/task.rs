//! The file that describes a training task.

use std::fmt::Display;

use nima_core::task::TaskKind;
use nima_simulation::scene::{SceneTask, score_tasks_by};
use serde::{Deserialize, Serialize};
use thiserror::Error;
use toml::Table;

/// Maximum time limit of a trial, s: its trajectory is stored at 100 Hz until it ends.
pub const LONGEST_TRIAL_S: f64 = 1200.0;

/// A training task in its TOML file. Every key but `name` and `kind` has a default.
///
/// ```
/// use nima_core::task::TaskKind;
/// use nima_score::TaskFile;
///
/// let task = TaskFile::from_toml("name = 'Lumps'\nkind = 'palpation'\nlumps = 5\ntime_limit_s = 240.0")?;
/// assert_eq!((task.kind, task.lumps, task.proficiency.time_s), (TaskKind::Palpation, Some(5), 48.0));
/// let wrong = TaskFile::from_toml("name = 'Lumps'\nkind = 'palpation'\ntime_limit_s = -1.0");
/// assert!(wrong.is_err_and(|error| error.to_string().contains("time_limit_s")));
/// # Ok::<(), nima_score::TaskError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskFile {
    pub name: String,
    /// Kind of task.
    pub kind: TaskKind,
    /// Time limit of the trial, s. 300 s in the peg transfer of FLS (Derossis et al. 1998).
    #[serde(default = "time_limit_s")]
    pub time_limit_s: f64,
    /// Subtracted from the score for each drop out of view, s. FLS does not publish its value; 10 s is our choice.
    #[serde(default = "penalty_s")]
    pub penalty_s: f64,
    /// Time of an expert, s, used for `time_over_reference`.
    #[serde(default = "reference_time_s")]
    pub reference_time_s: f64,
    /// Threshold of the force at the tip for counting time and excursions, N.
    #[serde(default = "force_threshold_n")]
    pub force_threshold_n: f64,
    /// Force at the tip above which the instrument is in contact, N: above the noise of the force.
    #[serde(default = "contact_n")]
    pub contact_n: f64,
    /// Number of lumps that can be found. In a scene with lumps, this is the number of lumps in the scene.
    #[serde(default)]
    pub lumps: Option<u32>,
    /// A mark finds a lump if it is on the lump, or at most this far from it, m.
    #[serde(default = "mark_tolerance_m")]
    pub mark_tolerance_m: f64,
    /// When training is complete.
    #[serde(default)]
    pub proficiency: TaskCriterion,
}

/// Criterion for the end of training; the default is the criterion for peg transfer in Ritter and Scott 2007 (Surg.
/// Innov. 14:107-112) and its curriculum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TaskCriterion {
    /// A trial meets the criterion within this time, s.
    pub time_s: f64,
    /// Maximum drops out of view in such a trial.
    pub drops_out_of_view: u32,
    /// Number of such trials in a row,
    pub consecutive: u32,
    /// followed by this many more, not necessarily in a row.
    pub additional: u32,
    /// Training is given up after this many trials without success.
    pub max_trials: u32,
}

#[derive(Clone, Debug, PartialEq, Error)]
pub enum TaskError {
    #[error("cannot read the task file: {reason}")]
    Toml { reason: String },
    #[error("the task file has {key} = {value}: it must be {allowed}")]
    Setting { key: &'static str, value: f64, allowed: &'static str },
}

impl Default for TaskCriterion {
    fn default() -> Self {
        Self { time_s: 48.0, drops_out_of_view: 0, consecutive: 2, additional: 10, max_trials: 80 }
    }
}

impl TaskCriterion {
    /// Returns whether a trial meets the criterion: by its completion time (s; `None` if it was not completed) and its
    /// drops out of view.
    pub fn is_met(&self, completion_time_s: Option<f64>, drops_out_of_view: u32) -> bool {
        completion_time_s.is_some_and(|time_s| time_s <= self.time_s) && drops_out_of_view <= self.drops_out_of_view
    }
}

impl TaskFile {
    /// Parses a task file.
    ///
    /// # Errors
    /// [`TaskError::Toml`] if it is not TOML or has an unknown or missing key, [`TaskError::Setting`] if a value is out
    /// of range.
    pub fn from_toml(text: &str) -> Result<Self, TaskError> {
        let task: Self = nima_files::from_toml(text).map_err(|misfit| {
            let reason = format!("line {}: {}", misfit.line(text), misfit.message());
            TaskError::Toml { reason }
        })?;
        task.check()?;
        Ok(task)
    }

    /// Returns the task of a scene.
    ///
    /// # Errors
    /// As [`from_toml`](Self::from_toml).
    pub fn of(task: &SceneTask) -> Result<Self, TaskError> {
        let task: Self = Table::try_from(task).map_err(unreadable)?.try_into().map_err(unreadable)?;
        task.check()?;
        Ok(task)
    }

    /// Converts it to the task of a scene.
    ///
    /// # Errors
    /// [`TaskError::Toml`] if it cannot be written.
    pub fn to_scene(&self) -> Result<SceneTask, TaskError> {
        Table::try_from(self).map_err(unreadable)?.try_into().map_err(unreadable)
    }

    /// # Errors
    /// [`TaskError::Setting`] for the first value out of range.
    pub fn check(&self) -> Result<(), TaskError> {
        let positive = |key, value: f64, up_to: f64, allowed| {
            if value > 0.0 && value <= up_to { Ok(()) } else { Err(TaskError::Setting { key, value, allowed }) }
        };
        positive("time_limit_s", self.time_limit_s, LONGEST_TRIAL_S, "above 0 s and at most 1200 s")?;
        positive("reference_time_s", self.reference_time_s, LONGEST_TRIAL_S, "above 0 s and at most 1200 s")?;
        positive("force_threshold_n", self.force_threshold_n, 1e3, "above 0 N and at most 1000 N")?;
        positive("contact_n", self.contact_n, 1e3, "above 0 N and at most 1000 N")?;
        positive("proficiency.time_s", self.proficiency.time_s, LONGEST_TRIAL_S, "above 0 s and at most 1200 s")?;
        if !(0.0..=LONGEST_TRIAL_S).contains(&self.penalty_s) {
            let allowed = "from 0 s to 1200 s";
            return Err(TaskError::Setting { key: "penalty_s", value: self.penalty_s, allowed });
        }
        if !SceneTask::MARK_TOLERANCES_M.contains(&self.mark_tolerance_m) {
            let allowed = "from 0 m to 0.05 m";
            return Err(TaskError::Setting { key: "mark_tolerance_m", value: self.mark_tolerance_m, allowed });
        }
        let TaskCriterion { consecutive, max_trials, .. } = self.proficiency;
        positive("proficiency.consecutive", f64::from(consecutive), 1e3, "from 1 to 1000")?;
        positive("proficiency.max_trials", f64::from(max_trials), 1e4, "from 1 to 10000")
    }

    /// Returns the time limit, s, also for a task that was never checked: a trial is always bounded.
    pub(crate) fn limit_s(&self) -> f64 {
        if self.time_limit_s > 0.0 { self.time_limit_s.min(LONGEST_TRIAL_S) } else { time_limit_s() }
    }
}

/// Registers this crate as the reader of the tasks of all scenes that are loaded from now on. A program calls it once,
/// before it loads a scene.
pub fn provide_tasks() {
    score_tasks_by(|task| {
        let read = TaskFile::of(task).and_then(|file| file.to_scene());
        *task = read.map_err(|error| error.to_string())?;
        Ok(())
    });
}

fn unreadable(error: impl Display) -> TaskError {
    TaskError::Toml { reason: error.to_string().lines().collect::<Vec<_>>().join(" ") }
}

fn time_limit_s() -> f64 {
    300.0
}

fn penalty_s() -> f64 {
    10.0
}

fn reference_time_s() -> f64 {
    48.0
}

fn force_threshold_n() -> f64 {
    3.0
}

fn contact_n() -> f64 {
    0.2
}

fn mark_tolerance_m() -> f64 {
    SceneTask::MARK_TOLERANCE_M
}
