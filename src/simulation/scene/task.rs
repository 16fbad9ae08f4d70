//! The training task of a scene: the keys that the simulation needs, and the others for the score.

use std::{ops::RangeInclusive, sync::OnceLock};

use nima_core::task::TaskKind;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// The table `[task]` of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneTask {
    /// Name for the screen.
    pub name: String,
    /// Kind of task.
    pub kind: TaskKind,
    /// A mark finds a lump if it is on the lump, or at most this far from it, m.
    #[serde(default = "mark_tolerance_m")]
    pub mark_tolerance_m: f64,
    /// Number of lumps that can be found. In a scene with lumps, this is the number of lumps in the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lumps: Option<u32>,
    /// All other keys: the parameters of the score.
    #[serde(flatten)]
    pub scored: Table,
}

const fn mark_tolerance_m() -> f64 {
    SceneTask::MARK_TOLERANCE_M
}

impl SceneTask {
    /// Default tolerance of a mark, m.
    pub const MARK_TOLERANCE_M: f64 = 0.003;
    /// Range of that tolerance, m.
    pub const MARK_TOLERANCES_M: RangeInclusive<f64> = 0.0..=0.05;

    /// Returns the task without its texts.
    pub(super) fn anonymous(&mut self, name: &str) {
        name.clone_into(&mut self.name);
        keep_numbers(&mut self.scored);
    }

    /// Lets the registered reader check the keys that the simulation does not use.
    pub(super) fn read(&mut self) -> Result<(), String> {
        SCORING.get().map_or(Ok(()), |read| read(self))
    }
}

fn keep_numbers(table: &mut Table) {
    table.retain(|_, value| !matches!(value, Value::String(_) | Value::Array(_) | Value::Datetime(_)));
    table.iter_mut().filter_map(|(_, value)| value.as_table_mut()).for_each(keep_numbers);
}

/// Reads [`SceneTask::scored`], completes it with its defaults, and returns a one-line message if it is invalid.
pub type ReadTask = fn(&mut SceneTask) -> Result<(), String>;

static SCORING: OnceLock<ReadTask> = OnceLock::new();

/// Registers the reader for the tasks of all scenes that are loaded from now on. A program calls it once, before it
/// loads a scene; without a reader, those keys are kept unread.
pub fn score_tasks_by(read: ReadTask) {
    SCORING.set(read).ok();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_the_simulation_does_not_know_are_kept_and_texts_among_them_are_not_anonymous() {
        let text =
            "name = 'Ward 3'\nkind = 'palpation'\ntime_limit_s = 60.0\n[proficiency]\ntime_s = 48.0\nby = 'Dr. N.'\n";
        let mut task: SceneTask = toml::from_str(text).unwrap();
        assert_eq!((task.kind, task.mark_tolerance_m), (TaskKind::Palpation, 0.003));
        assert_eq!(task.scored["time_limit_s"].as_float(), Some(60.0));
        assert_eq!(toml::from_str::<SceneTask>(&toml::to_string(&task).unwrap()).unwrap(), task);
        task.anonymous("unnamed");
        let written = toml::to_string(&task).unwrap();
        assert!(
            written.contains("time_s = 48.0") && !written.contains("Ward") && !written.contains("Dr."),
            "{written}"
        );
    }
}
