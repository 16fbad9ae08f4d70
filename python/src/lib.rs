//! The Python package `nima`: the native functions called by its Python code.
//!
//! float64 arrays are passed in both directions without a copy. There is no logic here: every function calls the one
//! used by the command line. The interpreter lock is released during computations.

mod arrays;
mod calibration;
mod environment;
mod errors;
mod identification;
mod session;
mod tip_force;

/// The native module imported by `nima`.
#[pyo3::pymodule(name = "_nima")]
mod native {
    #[pymodule_export]
    use crate::{
        calibration::{fit_correspondence, fit_gravity, remove_gravity},
        environment::Simulation,
        identification::{identify, modes, parse_map, rate_of, read_recording},
        session::Session,
        tip_force::TipForceModel,
    };

    #[pymodule_init]
    #[expect(clippy::unnecessary_wraps, reason = "the form that `PyO3` requires")]
    fn init(_module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        nima_baselines::provide();
        Ok(())
    }
}
