//! The network that removes the trocar's friction.

use std::path::PathBuf;

use nalgebra::Vector3;
use nima_core::{
    frames::{Wrench, WristSample},
    tip_force::{Estimator, Fallback, ForceModel, LiveTipForce},
};
use nima_recording::tip_force::load_model;
use numpy::{IntoPyArray as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    arrays::{given2, rising, rotation, table, vector},
    errors::{guarded, of_file, value},
};

/// A trained network.
#[pyclass(module = "nima._nima", frozen)]
pub(crate) struct TipForceModel {
    model: ForceModel,
}

#[pymethods]
impl TipForceModel {
    /// Reads a file written by `nima train tip-force`.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let load = || py.detach(|| load_model(&path).map_err(|error| of_file(&path, error)));
        Ok(Self { model: guarded(load)? })
    }

    /// Returns the names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        self.model.inputs.clone()
    }

    /// Returns the names of the outputs.
    #[getter]
    fn outputs(&self) -> Vec<String> {
        self.model.outputs.clone()
    }

    /// Returns the origin of the model, as JSON.
    #[getter]
    fn origin(&self) -> PyResult<String> {
        serde_json::to_string(&self.model.origin).map_err(value)
    }

    /// Predicts row by row.
    fn estimate<'py>(&self, py: Python<'py>, inputs: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyDict>> {
        let outputs = self.model.outputs.len();
        let inputs = table("inputs", &inputs, self.model.inputs.len(), None)?;
        let mut output = Vec::new();
        let mut spread = Vec::new();
        let mut doubt = Vec::new();
        let mut in_doubt = Vec::new();
        guarded(|| {
            py.detach(|| {
                let mut estimator = Estimator::new(self.model.clone());
                let mut row = Vec::with_capacity(inputs.ncols());
                for numbers in inputs.rows() {
                    row.clear();
                    row.extend(numbers.iter().map(|number| *number as f32));
                    let estimate = estimator.estimate(&row);
                    output.extend(estimate.output[..outputs].iter().copied().map(f64::from));
                    spread.extend(estimate.spread[..outputs].iter().copied().map(f64::from));
                    doubt.push(f64::from(estimate.doubt));
                    in_doubt.push(estimate.in_doubt);
                }
            });
            Ok(())
        })?;
        let result = PyDict::new(py);
        result.set_item("output", given2(py, output, outputs)?)?;
        result.set_item("spread", given2(py, spread, outputs)?)?;
        result.set_item("doubt", doubt.into_pyarray(py))?;
        result.set_item("in_doubt", in_doubt.into_pyarray(py))?;
        Ok(result)
    }

    /// Returns the force at the tip sample by sample, as computed by the loop.
    #[pyo3(signature = (times_s, forces_n, torques_nm, world_from_sensor_wxyz, insertion_m, fallback))]
    fn infer<'py>(
        &self,
        py: Python<'py>,
        times_s: PyReadonlyArray1<'py, f64>,
        forces_n: PyReadonlyArray2<'py, f64>,
        torques_nm: PyReadonlyArray2<'py, f64>,
        world_from_sensor_wxyz: PyReadonlyArray2<'py, f64>,
        insertion_m: PyReadonlyArray1<'py, f64>,
        fallback: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let fallback: Fallback =
            serde_json::from_value(fallback.into()).map_err(|error| value(format_args!("fallback: {error}")))?;
        let times_s = times_s.as_array();
        rising(&times_s)?;
        let rows = times_s.len();
        let forces = table("forces_n", &forces_n, 3, Some(rows))?;
        let torques = table("torques_nm", &torques_nm, 3, Some(rows))?;
        let rotations = table("world_from_sensor_wxyz", &world_from_sensor_wxyz, 4, Some(rows))?;
        let insertion = insertion_m.as_array();
        if insertion.len() != rows || insertion.iter().any(|depth_m| !depth_m.is_finite()) {
            return Err(value(format_args!("insertion_m needs {rows} finite numbers, it has {}", insertion.len())));
        }
        let turned: Vec<_> =
            (0..rows).map(|row| rotation("world_from_sensor_wxyz", &rotations, row)).collect::<PyResult<_>>()?;
        let mut tip_force = LiveTipForce::new(self.model.clone(), fallback).map_err(value)?;
        let mut force_n = Vec::new();
        let mut fraction = Vec::new();
        let mut doubt = Vec::new();
        guarded(|| {
            py.detach(|| {
                for row in 0..rows {
                    let wrench = Wrench { force_n: vector(&forces, row), torque_nm: vector(&torques, row) };
                    let sample = WristSample {
                        world_from_s1: Some(turned[row]),
                        insertion_m: Some(insertion[row]),
                        ..WristSample::of(wrench)
                    };
                    let report = tip_force.step(times_s[row], &wrench, &sample);
                    force_n.extend(Vector3::iter(&report.force_s1_n).copied());
                    fraction.push(report.network_fraction);
                    doubt.push(f64::from(report.doubt));
                }
            });
            Ok(())
        })?;
        let result = PyDict::new(py);
        result.set_item("forces_n", given2(py, force_n, 3)?)?;
        result.set_item("network_share", fraction.into_pyarray(py))?;
        result.set_item("doubt", doubt.into_pyarray(py))?;
        Ok(result)
    }
}
