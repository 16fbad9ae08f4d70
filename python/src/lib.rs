//! The Python package `nima`: what its functions in Python call.
//!
//! Arrays come and go without a copy where they are float64. Nothing in here decides anything: every function calls the one that the
//! command line calls. The lock of the interpreter is released while something is computed.

mod arrays;
mod calibration;
mod environment;
mod errors;
mod identification;
mod session;
mod tip_force;

/// What `nima` imports.
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
    fn init(_module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        nima_baselines::provide();
        Ok(())
    }
}
