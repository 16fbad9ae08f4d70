//! The network in force: its file in the store, bound to sensor and tool, and used only when its check allows it.

use std::{fs, time::SystemTime};

use nima_core::tip_force::Model;

use super::{TipForceError, load_model, save_model};
use crate::store::{Loaded, Store, keep_previous};

const KIND: &str = "tip-force";
const ENDING: &str = "safetensors";

/// Takes the model into the store of its sensor; the file before stays as `.previous`. Refused without a sensor, a tool and
/// a check that allows it.
pub fn keep_model(model: &Model, store: &Store) -> Result<std::path::PathBuf, TipForceError> {
    let (Some(sensor), Some(_)) = (&model.origin.sensor, &model.origin.tool) else {
        return Err(TipForceError::NotProven { reason: "it names no sensor and tool".to_owned() });
    };
    proven(model)?;
    let path = store.path_of(KIND, sensor, ENDING)?;
    let failed = |error: std::io::Error| TipForceError::Write { path: path.clone(), reason: error.to_string() };
    fs::create_dir_all(store.folder()).map_err(failed)?;
    keep_previous(&path).map_err(failed)?;
    save_model(model, &path)?;
    Ok(path)
}

/// The model kept for this sensor and tool; `None` when there is none. Refuses what belongs elsewhere or is not proven.
pub fn kept_model(
    store: &Store,
    sensor: &str,
    tool: &str,
    now: SystemTime,
) -> Result<Option<Loaded<Model>>, TipForceError> {
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
    Ok(Some(Loaded { record, age, path }))
}

fn proven(model: &Model) -> Result<(), TipForceError> {
    match &model.origin.check {
        Some(check) if check.judgement.allows() => Ok(()),
        Some(check) => Err(TipForceError::NotProven { reason: check.judgement.reason.clone() }),
        None => Err(TipForceError::NotProven { reason: "it was never checked on new data".to_owned() }),
    }
}
