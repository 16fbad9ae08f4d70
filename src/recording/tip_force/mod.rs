//! Files for the force at the tip: data sets (CSV), their recording, and trained networks (safetensors).

mod data_set;
mod error;
mod model;
mod recorder;

pub use data_set::{DataSet, Selection, Trajectory};
pub use error::TipForceError;
pub use model::{keep_model, kept_model, load_model, model_from_bytes, model_to_bytes, save_model};
pub use recorder::{MAX_ROWS, ROW_EVERY_S, RecorderLack, RecorderPhase, TipForceRecorder};
