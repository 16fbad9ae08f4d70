//! The stored network of a sensor. It is bound to sensor and tool, and used only if its check allows this.

use std::{fs, time::SystemTime};

use nima_core::tip_force::ForceModel;

use super::{TipForceError, load_model, save_model};
use crate::store::{LoadedRecord, Store, keep_previous};

const KIND: &str = "tip-force";
const ENDING: &str = "safetensors";

/// Saves the model in the store of its sensor; the previous file is kept as `.previous`. Returns its path.
///
/// # Errors
/// [`TipForceError`] if the model has no sensor, tool or accepted check, or the file cannot be written.
pub fn keep_model(model: &ForceModel, store: &Store) -> Result<std::path::PathBuf, TipForceError> {
    let (Some(sensor), Some(_)) = (&model.origin.sensor, &model.origin.tool) else {
        return Err(TipForceError::NotProven { reason: "it does not name a sensor and a tool".to_owned() });
    };
    proven(model)?;
    let path = store.path_of(KIND, sensor, ENDING)?;
    let failed = |error: std::io::Error| TipForceError::Write { path: path.clone(), reason: error.to_string() };
    fs::create_dir_all(store.folder()).map_err(failed)?;
    keep_previous(&path).map_err(failed)?;
    save_model(model, &path)?;
    Ok(path)
}

/// Loads the model of this sensor and tool; `None` if there is none.
///
/// # Errors
/// [`TipForceError`] if the file cannot be read, belongs to another sensor or tool, or its check does not allow its
/// use.
pub fn kept_model(
    store: &Store,
    sensor: &str,
    tool: &str,
    now: SystemTime,
) -> Result<Option<LoadedRecord<ForceModel>>, TipForceError> {
    let path = store.path_of(KIND, sensor, ENDING)?;
    if !path.exists() {
        return Ok(None);
    }
    let record = load_model(&path)?;
    let origin = &record.origin;
    let damaged = |reason: String| TipForceError::Model { path: path.clone(), reason };
    for (what, found, wanted) in [("sensor", &origin.sensor, sensor), ("tool", &origin.tool, tool)] {
        if found.as_deref() != Some(wanted) {
            let found = found.as_deref().unwrap_or("none");
            return Err(damaged(format!("it is for {what} \"{found}\", not \"{wanted}\"")));
        }
    }
    proven(&record)?;
    let age = store.age_of(&origin.date, now).ok_or_else(|| damaged("it has no date".to_owned()))?;
    Ok(Some(LoadedRecord { record, age, path }))
}

fn proven(model: &ForceModel) -> Result<(), TipForceError> {
    match &model.origin.check {
        Some(check) if check.judgement.allows() => Ok(()),
        Some(check) => Err(TipForceError::NotProven { reason: check.judgement.reason.clone() }),
        None => Err(TipForceError::NotProven { reason: "it was never checked on new data".to_owned() }),
    }
}
