//! Objects that move, and the task that is scored.

use nima_machine::config::{ConfigError, Ranges};
use nima_physics::SettingError;
use nima_score::TaskError;

use super::Scene;
use crate::RINGS_MAX;

impl Scene {
    /// Checks the objects and the task.
    pub(super) fn validate_objects(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        if let Some(objects) = &self.objects {
            let rings = objects.rings.len();
            ranges.check("objects.rings (count)", rings as f64, rings <= RINGS_MAX, "at most 12")?;
            if let Err(SettingError { key, value, allowed }) = objects.validate() {
                ranges.check(key, value, false, allowed)?;
            }
        }
        match self.task.as_ref().map(nima_score::TaskFile::check) {
            Some(Err(TaskError::Setting { key, value, allowed })) => ranges.check(key, value, false, allowed),
            _ => Ok(()),
        }
    }
}
