//! Fits of gravity and of the correspondence, and removal of the weight.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    calibration::{
        correspondence::{self, PushPair},
        gravity::{self, GravityModel, GravityPose, GravitySource, ModelKind, Orientation},
    },
    frames::{Wrench, WristSample},
};
use numpy::{PyArray2, PyReadonlyArray2, ndarray::ArrayView2};
use pyo3::prelude::*;

use crate::{
    arrays::{given2, rotation, table, vector},
    errors::{guarded, value},
};

/// A table returned to Python.
type PythonTable<'py> = Bound<'py, PyArray2<f64>>;
/// An optional table.
type Optional<'py> = Option<PyReadonlyArray2<'py, f64>>;

/// Returns the table, if it is given.
fn optional<'a>(
    name: &str,
    array: &'a Optional<'_>,
    columns: usize,
    rows: usize,
) -> PyResult<Option<ArrayView2<'a, f64>>> {
    array.as_ref().map(|array| table(name, array, columns, Some(rows))).transpose()
}

/// Returns the orientation of each pose, from either source.
fn orientations(
    rows: usize,
    accelerations: Option<&ArrayView2<'_, f64>>,
    rotations: Option<&ArrayView2<'_, f64>>,
) -> PyResult<Vec<Orientation>> {
    match (accelerations, rotations) {
        (Some(accelerations), None) => Ok((0..rows).map(|row| Orientation::Imu(vector(accelerations, row))).collect()),
        (None, Some(rotations)) => {
            let of_row = |row| Ok(Orientation::Arm(rotation("world_from_sensor_wxyz", rotations, row)?));
            (0..rows).map(of_row).collect()
        }
        _ => Err(value("give either accelerations_m_s2 or world_from_sensor_wxyz: one source of the orientation")),
    }
}

/// Fits the gravity models to still poses; the report of `nima calibrate gravity --json`.
#[pyfunction]
#[pyo3(signature = (forces_n, torques_nm, accelerations_m_s2, world_from_sensor_wxyz, model, flip_imu))]
pub(crate) fn fit_gravity(
    py: Python<'_>,
    forces_n: PyReadonlyArray2<'_, f64>,
    torques_nm: Optional<'_>,
    accelerations_m_s2: Optional<'_>,
    world_from_sensor_wxyz: Optional<'_>,
    model: Option<&str>,
    flip_imu: bool,
) -> PyResult<String> {
    let forces = table("forces_n", &forces_n, 3, None)?;
    let rows = forces.nrows();
    let torques = optional("torques_nm", &torques_nm, 3, rows)?;
    let accelerations = optional("accelerations_m_s2", &accelerations_m_s2, 3, rows)?;
    let rotations = optional("world_from_sensor_wxyz", &world_from_sensor_wxyz, 4, rows)?;
    let orientations = orientations(rows, accelerations.as_ref(), rotations.as_ref())?;
    let pose = |(row, orientation)| GravityPose {
        wrench: Wrench {
            force_n: vector(&forces, row),
            torque_nm: torques.as_ref().map_or_else(Vector3::zeros, |torques| vector(torques, row)),
        },
        has_torque: torques.is_some(),
        orientation,
    };
    let poses: Vec<GravityPose> = orientations.into_iter().enumerate().map(pose).collect();
    let kind = |name: &str| {
        let known = ModelKind::ALL.into_iter().find(|kind| kind.name() == name);
        known.ok_or_else(|| {
            value(format_args!("model is {name:?}; give one of {}", ModelKind::ALL.map(ModelKind::name).join(", ")))
        })
    };
    let settings = gravity::GravitySettings {
        model: model.map(kind).transpose()?,
        imu_sign: if flip_imu { -1 } else { 1 },
        ..gravity::GravitySettings::default()
    };
    guarded(|| {
        py.detach(|| {
            let report = gravity::fit(&poses, &settings).map_err(value)?;
            serde_json::to_string(&report).map_err(value)
        })
    })
}

/// Subtracts weight and bias from readings.
#[pyfunction]
pub(crate) fn remove_gravity<'py>(
    py: Python<'py>,
    model: &str,
    forces_n: PyReadonlyArray2<'py, f64>,
    torques_nm: Optional<'py>,
    accelerations_m_s2: Optional<'py>,
    world_from_sensor_wxyz: Optional<'py>,
) -> PyResult<(PythonTable<'py>, Option<PythonTable<'py>>)> {
    let model: GravityModel =
        serde_json::from_str(model).map_err(|error| value(format_args!("model is not a gravity model: {error}")))?;
    if let Some(fault) = model.fault() {
        return Err(value(format_args!("model: {fault}")));
    }
    let forces = table("forces_n", &forces_n, 3, None)?;
    let rows = forces.nrows();
    let torques = optional("torques_nm", &torques_nm, 3, rows)?;
    let accelerations = optional("accelerations_m_s2", &accelerations_m_s2, 3, rows)?;
    let rotations = optional("world_from_sensor_wxyz", &world_from_sensor_wxyz, 4, rows)?;
    let orientations = orientations(rows, accelerations.as_ref(), rotations.as_ref())?;
    let mut free_n = Vec::with_capacity(3 * rows);
    let mut free_nm = Vec::new();
    for (row, orientation) in orientations.iter().enumerate() {
        let field_m_s2 = field(&model, orientation).ok_or_else(|| {
            let source =
                if model.source == GravitySource::Imu { "accelerations_m_s2" } else { "world_from_sensor_wxyz" };
            value(format_args!("row {row}: no direction of gravity; this model needs {source}"))
        })?;
        let predicted = model.predict(&field_m_s2);
        free_n.extend((vector(&forces, row) - predicted.force_n).iter());
        if let Some(torques) = &torques {
            free_nm.extend((vector(torques, row) - predicted.torque_nm).iter());
        }
    }
    let torques = torques.is_some().then(|| given2(py, free_nm, 3)).transpose()?;
    Ok((given2(py, free_n, 3)?, torques))
}

fn field(model: &GravityModel, orientation: &Orientation) -> Option<Vector3<f64>> {
    let mut sample = WristSample::of(Wrench::default());
    match orientation {
        Orientation::Imu(acceleration_m_s2) => sample.acceleration_m_s2 = Some(*acceleration_m_s2),
        Orientation::Arm(world_from_s1) => sample.world_from_s1 = Some(*world_from_s1),
    }
    model.field_m_s2(&sample)
}

/// Fits the rotation between two sensors; the report of `nima calibrate correspondence --json`.
#[pyfunction]
pub(crate) fn fit_correspondence(
    py: Python<'_>,
    wrist_forces_n: PyReadonlyArray2<'_, f64>,
    tissue_forces_n: PyReadonlyArray2<'_, f64>,
    sensor_from_camera_wxyz: Optional<'_>,
    flip_tissue: bool,
) -> PyResult<String> {
    let wrist = table("wrist_forces_n", &wrist_forces_n, 3, None)?;
    let rows = wrist.nrows();
    let tissue = table("tissue_forces_n", &tissue_forces_n, 3, Some(rows))?;
    let rotations = optional("sensor_from_camera_wxyz", &sensor_from_camera_wxyz, 4, rows)?;
    let pair = |row| {
        let s1_from_c = rotations.as_ref().map(|rotations| rotation("sensor_from_camera_wxyz", rotations, row));
        Ok(PushPair {
            f1_n: vector(&wrist, row),
            f2_n: vector(&tissue, row),
            s1_from_c: s1_from_c.transpose()?.unwrap_or_else(UnitQuaternion::identity),
        })
    };
    let pairs: Vec<PushPair> = (0..rows).map(pair).collect::<PyResult<_>>()?;
    let options = correspondence::CorrespondenceOptions {
        flip_s2: flip_tissue,
        ..correspondence::CorrespondenceOptions::default()
    };
    guarded(|| {
        py.detach(|| {
            let report = correspondence::fit(&pairs, &options).map_err(value)?;
            serde_json::to_string(&report).map_err(value)
        })
    })
}
