//! Identification over arrays.

use std::path::PathBuf;

use nima_core::{
    impedance::{AXES, DegreeChoice, IncrementReading, LinkPacket, LiteralModel, MOTION_COLUMNS, Mode, Recipe, Sample},
    safety::Gate,
};
use nima_machine::rig::Side;
use nima_recording::{
    csv::{self, AXIS_NAMES, ColumnMapping, ColumnSource, CsvRecording, RecordingError},
    session::SessionReader,
};
use nima_session::{completeness, plot_channels};
use nima_study::replay::{ReplayMotion, ReplayOptions, ReplayRow, replay_motion};
use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::{
    prelude::*,
    types::{PyDict, PyList},
};
use serde::de::DeserializeOwned;

use crate::{
    arrays::{ArrayAxes, given2, given3, rising},
    errors::{guarded, of_file, value},
};

/// Name of the arrays in messages: `recording ... has 3 samples`.
const NAME: &str = "of these arrays";
/// Columns of the anchored model.
const ANCHORED_COLUMNS: usize = 9;

/// Returns all modes by name.
#[pyfunction]
pub(crate) fn modes() -> Vec<&'static str> {
    Mode::ALL.into_iter().chain(Mode::BASELINES).map(Mode::name).collect()
}

/// Returns the rate of these times, Hz, as `nima identify` computes it.
#[pyfunction]
pub(crate) fn rate_of(times_s: PyReadonlyArray1<'_, f64>) -> PyResult<f64> {
    let times_s = times_s.as_array();
    rising(&times_s)?;
    csv::rate_hz(times_s.iter().copied())
        .ok_or_else(|| value(format_args!("times_s has {} samples, 3 are needed; record longer", times_s.len())))
}

/// The rows of a replay, column by column.
struct IdentificationRows {
    axes: usize,
    forces_n: Vec<f64>,
    held_n: Vec<f64>,
    degrees: Vec<u8>,
    conditions: Vec<f64>,
    gates: Vec<u8>,
    parcels: Option<Parcels>,
}

/// The data that cross the link, column by column.
#[derive(Default)]
struct Parcels {
    literal: PaperModel,
    linear: PaperModel,
    anchored_motion: Vec<f64>,
    anchored_constant_n: Vec<f64>,
    anchored_gain: Vec<f64>,
    anchored_degree: Vec<u8>,
    matched_degree: Vec<u8>,
    nima_degree: Vec<u8>,
    resting: Vec<bool>,
}

/// A model `f = M X` of the paper.
#[derive(Default)]
struct PaperModel {
    degree: Vec<u8>,
    constant_n: Vec<f64>,
    coefficients: Vec<f64>,
}

impl IdentificationRows {
    fn new(samples: usize, axes: usize, parcels: bool) -> Self {
        Self {
            axes,
            forces_n: Vec::with_capacity(samples * axes),
            held_n: Vec::with_capacity(samples * axes),
            degrees: Vec::with_capacity(samples),
            conditions: Vec::with_capacity(samples),
            gates: Vec::with_capacity(samples),
            parcels: parcels.then(Parcels::default),
        }
    }

    fn push(&mut self, row: &ReplayRow, parcel: &LinkPacket) {
        for (forces_n, force_n) in [(&mut self.forces_n, &row.rendered), (&mut self.held_n, &row.held)] {
            // NaN rather than zero: nothing had arrived yet, or the force is invalid.
            forces_n.extend((0..self.axes).map(|lane| force_n.map_or(f64::NAN, |force_n| force_n[lane])));
        }
        self.degrees.push(row.degree as u8);
        self.conditions.push(row.condition);
        let gate = Gate::ALL.iter().position(|gate| gate.name() == row.gate);
        self.gates.push(gate.map_or(0, |gate| gate as u8 + 1));
        if let Some(parcels) = &mut self.parcels {
            parcels.push(parcel, self.axes);
        }
    }

    fn give(self, result: &Bound<'_, PyDict>) -> PyResult<()> {
        let py = result.py();
        result.set_item("forces_n", given2(py, self.forces_n, self.axes)?)?;
        result.set_item("held_n", given2(py, self.held_n, self.axes)?)?;
        result.set_item("degrees", self.degrees.into_pyarray(py))?;
        result.set_item("conditions", self.conditions.into_pyarray(py))?;
        result.set_item("gates", self.gates.into_pyarray(py))?;
        let parcels = self.parcels.map(|parcels| parcels.give(py, self.axes)).transpose()?;
        result.set_item("parcels", parcels)
    }
}

impl Parcels {
    fn push(&mut self, parcel: &LinkPacket, axes: usize) {
        self.literal.push(&parcel.models.literal, axes);
        self.linear.push(&parcel.models.linear, axes);
        let anchored = &parcel.models.anchored;
        self.anchored_motion.extend(anchored.motion.iter().flat_map(|column| (0..axes).map(move |lane| column[lane])));
        self.anchored_constant_n.extend((0..axes).map(|lane| anchored.constant_n[lane]));
        self.anchored_gain.push(anchored.gain);
        self.anchored_degree.push(anchored.degree);
        self.matched_degree.push(parcel.models.matched.degree);
        self.nima_degree.push(parcel.models.nima.degree);
        self.resting.push(parcel.resting);
    }

    fn give(self, py: Python<'_>, axes: usize) -> PyResult<Bound<'_, PyDict>> {
        let all = PyDict::new(py);
        self.literal.give(&all, "literal", axes)?;
        self.linear.give(&all, "linear", axes)?;
        all.set_item("anchored_motion", given3(py, self.anchored_motion, [ANCHORED_COLUMNS, axes])?)?;
        all.set_item("anchored_constant_n", given2(py, self.anchored_constant_n, axes)?)?;
        all.set_item("anchored_gain", self.anchored_gain.into_pyarray(py))?;
        all.set_item("anchored_degree", self.anchored_degree.into_pyarray(py))?;
        all.set_item("matched_degree", self.matched_degree.into_pyarray(py))?;
        all.set_item("nima_degree", self.nima_degree.into_pyarray(py))?;
        all.set_item("resting", self.resting.into_pyarray(py))?;
        Ok(all)
    }
}

impl PaperModel {
    fn push(&mut self, model: &LiteralModel, axes: usize) {
        self.degree.push(model.degree);
        self.constant_n.extend((0..axes).map(|lane| model.constant_n[lane]));
        self.coefficients.extend(model.coefficients.iter().flat_map(|column| (0..axes).map(move |lane| column[lane])));
    }

    fn give(self, all: &Bound<'_, PyDict>, name: &str, axes: usize) -> PyResult<()> {
        let py = all.py();
        all.set_item(format!("{name}_degree"), self.degree.into_pyarray(py))?;
        all.set_item(format!("{name}_constant_n"), given2(py, self.constant_n, axes)?)?;
        all.set_item(format!("{name}_coefficients"), given3(py, self.coefficients, [MOTION_COLUMNS, axes])?)
    }
}

/// Parses a keyword of a rig file.
fn word<T: DeserializeOwned>(keyword: &str, text: &str) -> PyResult<T> {
    serde_json::from_value(text.into()).map_err(|error| value(format_args!("{keyword}: {error}")))
}

/// Replays motion and force from arrays, one for each axis; see `nima.identify`.
#[pyfunction]
#[pyo3(signature = (positions_m, forces_n, *, times_s, rate_hz, leader_positions_m, axes, mode, delay_s, window_s, max_degree, cross_talk, reading, choice, constant, ridge, parcels))]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    positions_m: Vec<PyReadonlyArray1<'py, f64>>,
    forces_n: Vec<PyReadonlyArray1<'py, f64>>,
    times_s: Option<PyReadonlyArray1<'py, f64>>,
    rate_hz: f64,
    leader_positions_m: Option<Vec<PyReadonlyArray1<'py, f64>>>,
    axes: Vec<usize>,
    mode: &str,
    delay_s: f64,
    window_s: f64,
    max_degree: usize,
    cross_talk: bool,
    reading: &str,
    choice: &str,
    constant: bool,
    ridge: f64,
    parcels: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let mode: Mode = mode.parse().map_err(value)?;
    let reading = word::<IncrementReading>("reading", reading)?;
    let choice = word::<DegreeChoice>("choice", choice)?;
    let literal = Recipe { reading, choice, constant, ridge };
    let options = ReplayOptions { mode, window_s, delay_s, max_degree, cross_talk, literal };
    let positions = ArrayAxes::new("positions_m", &positions_m)?;
    let forces = ArrayAxes::new("forces_n", &forces_n)?;
    positions.fits(&forces)?;
    if !(1..=AXES).contains(&positions.count()) || axes.len() != positions.count() {
        return Err(value(format_args!("positions_m has {} axes; it must be 1, 2 or 3", positions.count())));
    }
    let leader =
        leader_positions_m.as_deref().map(|arrays| ArrayAxes::new("leader_positions_m", arrays)).transpose()?;
    leader.as_ref().map_or(Ok(()), |leader| leader.fits(&positions))?;
    let times_s = times_s.as_ref().map(PyReadonlyArray1::as_array);
    if let Some(times_s) = &times_s {
        rising(times_s)?;
        if times_s.len() != positions.rows() {
            return Err(value(format_args!(
                "times_s has {} rows, positions_m has {}",
                times_s.len(),
                positions.rows()
            )));
        }
    }
    let (figures, rows) = guarded(|| {
        py.detach(|| {
            let samples = positions.rows();
            let sample = |i: usize| Sample {
                t_s: times_s.as_ref().map_or_else(|| i as f64 / rate_hz, |times_s| times_s[i]),
                position_m: positions.at(i),
                force_n: forces.at(i),
            };
            let leader = leader.as_ref().map(|leader| move |i: usize| leader.at(i));
            let leader_m = leader.as_ref().map(|leader| leader as &dyn Fn(usize) -> nalgebra::Vector3<f64>);
            let motion =
                ReplayMotion { name: NAME.to_owned(), axes: &axes, rate_hz, samples, sample: &sample, leader_m };
            let mut rows = IdentificationRows::new(samples, positions.count(), parcels);
            let figures = replay_motion(&motion, &options, |row, parcel| rows.push(row, parcel)).map_err(value)?;
            Ok((serde_json::to_string(&figures).map_err(value)?, rows))
        })
    })?;
    let result = PyDict::new(py);
    result.set_item("figures", figures)?;
    rows.give(&result)?;
    Ok(result)
}

/// Returns motion and force of a table or of an arm of a session; see `nima.read_recording`.
#[pyfunction]
pub(crate) fn read_recording<'py>(
    py: Python<'py>,
    path: PathBuf,
    map: Vec<String>,
    arm: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let is_session = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
    if is_session && !map.is_empty() {
        return Err(value(format_args!("map names columns of a table, and {} is a session; omit map", path.display())));
    }
    if !is_session && arm.is_some() {
        return Err(value(format_args!(
            "arm chooses an arm of a session, and {} is a table; omit arm",
            path.display()
        )));
    }
    let arm = arm.map(side).transpose()?;
    let mapping = ColumnMapping::parse(&map).map_err(value)?;
    let (recording, notes) = guarded(|| {
        py.detach(|| {
            if is_session {
                let reader = SessionReader::open(&path).map_err(|error| of_file(&path, error))?;
                let recording = plot_channels::recording(&path, arm).map_err(|error| of_file(&path, error))?;
                return Ok((recording, completeness::missing(&reader)));
            }
            let read = CsvRecording::read(&path, &mapping);
            Ok((read.map_err(|error: RecordingError| of_file(&path, error))?, Vec::new()))
        })
    })?;
    let lanes = recording.axes.len();
    let flat = |of: fn(&Sample) -> &nalgebra::Vector3<f64>| {
        recording.samples.iter().flat_map(|sample| (0..lanes).map(move |lane| of(sample)[lane])).collect::<Vec<f64>>()
    };
    let result = PyDict::new(py);
    let times_s: Vec<f64> = recording.samples.iter().map(|sample| sample.t_s).collect();
    result.set_item("times_s", times_s.into_pyarray(py))?;
    result.set_item("rate_hz", recording.rate_hz)?;
    result.set_item("axes", PyList::new(py, recording.axes.iter().map(|axis| AXIS_NAMES[*axis]))?)?;
    result.set_item("positions_m", given2(py, flat(|sample| &sample.position_m), lanes)?)?;
    result.set_item("forces_n", given2(py, flat(|sample| &sample.force_n), lanes)?)?;
    let leader = recording.leader_m.as_ref().map(|leader_m| {
        leader_m.iter().flat_map(|position_m| (0..lanes).map(move |lane| position_m[lane])).collect::<Vec<f64>>()
    });
    result.set_item("leader_positions_m", leader.map(|leader| given2(py, leader, lanes)).transpose()?)?;
    result.set_item("notes", notes)?;
    Ok(result)
}

/// Returns full name, column and factor of each mapped quantity.
#[pyfunction]
pub(crate) fn parse_map(map: Vec<String>) -> PyResult<Vec<(&'static str, String, f64)>> {
    let mapping = ColumnMapping::parse(&map).map_err(value)?;
    let of = |(quantity, source): (&'static str, &ColumnSource)| (quantity, source.column().to_owned(), source.scale());
    Ok(mapping.sources().map(of).collect())
}

/// Parses an arm's name as used on the command line.
pub(crate) fn side(text: &str) -> PyResult<Side> {
    let known = Side::ALL.into_iter().find(|side| side.word() == text);
    known.ok_or_else(|| value(format_args!("arm is {text:?}; give \"right\" or \"left\"")))
}
