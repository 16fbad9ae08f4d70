//! Recorded sessions.

use std::{
    collections::BTreeMap,
    ops::Range,
    path::{Path, PathBuf},
};

use nalgebra::Vector3;
use nima_machine::rig::Side;
use nima_recording::{
    messages::{JointStateDecoder, foxglove::Log},
    session::{Attachment, SessionReader},
};
use nima_session::{
    completeness,
    plot_channels::{self, PlottedError, PlottedTick},
};
use numpy::IntoPyArray as _;
use prost::Message as _;
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict, PyList},
};

use crate::{
    arrays::given2,
    errors::{guarded, of_file, value},
    identification::side,
};

/// Topic of the log.
const LOG: &str = "log";
/// Name of the encoding of named numbers.
const NAMED_NUMBERS: &str = "sensor_msgs/msg/JointState";

/// An open session file.
#[pyclass(module = "nima._nima", frozen)]
pub(crate) struct Session {
    path: PathBuf,
    reader: SessionReader,
    begin_ns: u64,
}

/// A tick, in columns.
#[derive(Default)]
struct TickColumns {
    times_s: Vec<f64>,
    times_ns: Vec<u64>,
    vectors: [Vec<f64>; VECTORS.len()],
    states: Vec<&'static str>,
}

/// Names of a tick's vectors.
const VECTORS: [&str; 6] = ["tip_m", "leader_m", "measured_n", "delayed_n", "asked_n", "rendered_n"];

impl TickColumns {
    fn push(&mut self, tick: &PlottedTick) {
        self.times_s.push(tick.t_s);
        self.times_ns.push(tick.time_ns);
        let vectors = [&tick.tip_m, &tick.leader_m, &tick.measured_n, &tick.delayed_n, &tick.asked_n, &tick.rendered_n];
        for (column, vector) in self.vectors.iter_mut().zip(vectors) {
            column.extend(Vector3::iter(vector).copied());
        }
        self.states.push(tick.state.word());
    }
}

impl Session {
    /// Converts a range (s since the session began) to ns since 1970; half open.
    fn stretch(&self, from_s: Option<f64>, to_s: Option<f64>) -> PyResult<Range<u64>> {
        let time_ns = |name: &str, seconds: f64| {
            if !(0.0..=1e9).contains(&seconds) {
                return Err(value(format_args!(
                    "{name} is {seconds}; give seconds since the session began, 0 or more"
                )));
            }
            Ok(self.begin_ns.saturating_add((seconds * 1e9).round() as u64))
        };
        let start = from_s.map_or(Ok(0), |from_s| time_ns("from_s", from_s))?;
        let end = to_s.map_or(Ok(u64::MAX), |to_s| time_ns("to_s", to_s))?;
        if start >= end {
            return Err(value("from_s must be before to_s"));
        }
        Ok(start..end)
    }

    fn seconds(&self, time_ns: u64) -> f64 {
        time_ns.saturating_sub(self.begin_ns) as f64 / 1e9
    }

    fn arm(&self, arm: Option<&str>) -> PyResult<Side> {
        let asked = arm.map(side).transpose()?;
        plot_channels::arm(&self.reader, &self.path, asked).map_err(value)
    }

    fn wrong(&self, error: impl std::fmt::Display) -> PyErr {
        of_file(&self.path, error)
    }
}

#[pymethods]
impl Session {
    /// Opens a file.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let open = |path: &Path| {
            let reader = SessionReader::open(path).map_err(|error| of_file(path, error))?;
            let begin_ns = plot_channels::beginning_ns(&reader).map_err(|error| of_file(path, error))?;
            Ok((reader, begin_ns))
        };
        let (reader, begin_ns) = guarded(|| py.detach(|| open(&path)))?;
        Ok(Self { path, reader, begin_ns })
    }

    /// Returns the program that wrote it.
    #[getter]
    fn library(&self) -> &str {
        self.reader.library()
    }

    /// Returns the data that the file lacks, one line each; reads it completely.
    #[getter]
    fn notes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        guarded(|| py.detach(|| Ok(completeness::missing(&self.reader))))
    }

    /// Returns the plotted arms.
    #[getter]
    fn arms(&self) -> Vec<&'static str> {
        plot_channels::arms(&self.reader).into_iter().map(Side::word).collect()
    }

    /// Returns the start of the session, ns since 1970 (UTC).
    #[getter]
    fn begin_ns(&self) -> u64 {
        self.begin_ns
    }

    /// Returns the end of the session, in s since its start.
    #[getter]
    fn end_s(&self) -> f64 {
        self.seconds(self.reader.statistics().times_ns.1)
    }

    /// Returns topic, schema, and number of messages (if the file states it) of each channel.
    #[getter]
    fn channels(&self) -> Vec<(String, String, Option<u64>)> {
        let of = |channel: &nima_recording::session::ReaderChannel| {
            (channel.topic.clone(), channel.encoding.schema.clone(), channel.messages)
        };
        self.reader.channels().iter().map(of).collect()
    }

    /// Returns name, media type and size (bytes) of each attachment.
    #[getter]
    fn attachments(&self) -> Vec<(String, String, u64)> {
        let of = |one: &Attachment| (one.name.clone(), one.media_type.clone(), one.size);
        self.reader.attachments().iter().map(of).collect()
    }

    /// Returns the data of the attachment with this name.
    fn attachment<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let found = self.reader.attachments().iter().find(|one| one.name == name);
        let found = found.ok_or_else(|| {
            value(format_args!("session {} has no attachment {name:?}; see attachments", self.path.display()))
        })?;
        let data = self.reader.attachment(found).map_err(|error| self.wrong(error))?;
        Ok(PyBytes::new(py, &data))
    }

    /// Returns the tables of the file, by name.
    #[getter]
    fn metadata(&self) -> PyResult<BTreeMap<String, BTreeMap<String, String>>> {
        let tables = self.reader.metadata().map_err(|error| self.wrong(error))?;
        let mut all: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
        for (name, table) in tables {
            all.entry(name).or_default().extend(table);
        }
        Ok(all)
    }

    /// Returns the plotted signals of an arm in every tick.
    #[pyo3(signature = (arm, from_s, to_s))]
    fn ticks<'py>(
        &self,
        py: Python<'py>,
        arm: Option<&str>,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let arm = self.arm(arm)?;
        let times_ns = self.stretch(from_s, to_s)?;
        let mut columns = TickColumns::default();
        guarded(|| {
            py.detach(|| {
                plot_channels::each_tick(&self.reader, &self.path, arm, times_ns, |tick| {
                    columns.push(&tick);
                    Ok::<_, PlottedError>(())
                })
                .map_err(value)
            })
        })?;
        let result = PyDict::new(py);
        result.set_item("t_s", columns.times_s.into_pyarray(py))?;
        result.set_item("time_ns", columns.times_ns.into_pyarray(py))?;
        for (name, numbers) in VECTORS.into_iter().zip(columns.vectors) {
            result.set_item(name, given2(py, numbers, 3)?)?;
        }
        result.set_item("state", PyList::new(py, columns.states)?)?;
        Ok(result)
    }

    /// Returns the named numbers of a channel, and the times of its messages.
    #[pyo3(signature = (topic, from_s, to_s))]
    fn plot<'py>(
        &self,
        py: Python<'py>,
        topic: &str,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let is_wanted = |channel: &&nima_recording::session::ReaderChannel| channel.topic == topic;
        let channel = self.reader.channels().iter().find(is_wanted).ok_or_else(|| {
            value(format_args!("session {} has no channel {topic:?}; see channels", self.path.display()))
        })?;
        if channel.encoding.schema != NAMED_NUMBERS {
            return Err(value(format_args!("channel {topic:?} holds {}, not named numbers", channel.encoding.schema)));
        }
        let times_ns = self.stretch(from_s, to_s)?;
        let mut decoder = JointStateDecoder::default();
        let mut times_s = Vec::new();
        let mut names: Vec<String> = Vec::new();
        let mut numbers: Vec<Vec<f64>> = Vec::new();
        guarded(|| {
            py.detach(|| {
                for message in self.reader.messages(&[topic], times_ns) {
                    let message = message.map_err(value)?;
                    let t_s = self.seconds(message.log_time_ns());
                    if !decoder.decode(message.data()) || !(names.is_empty() || names == decoder.names()) {
                        return Err(value(format_args!(
                            "channel {topic:?} at {t_s} s: no named numbers of this program"
                        )));
                    }
                    if names.is_empty() {
                        names = decoder.names().to_vec();
                        numbers = vec![Vec::new(); names.len()];
                    }
                    times_s.push(t_s);
                    numbers.iter_mut().zip(decoder.values()).for_each(|(column, number)| column.push(*number));
                }
                Ok(())
            })
        })?;
        let result = PyDict::new(py);
        result.set_item("t_s", times_s.into_pyarray(py))?;
        for (name, column) in names.into_iter().zip(numbers) {
            result.set_item(name, column.into_pyarray(py))?;
        }
        Ok(result)
    }

    /// Returns the lines of the log: time (s), level, part, text.
    #[pyo3(signature = (from_s, to_s))]
    fn events(
        &self,
        py: Python<'_>,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> PyResult<Vec<(f64, String, String, String)>> {
        let times_ns = self.stretch(from_s, to_s)?;
        guarded(|| {
            py.detach(|| {
                let mut lines = Vec::new();
                for message in self.reader.messages(&[LOG], times_ns) {
                    let message = message.map_err(value)?;
                    let t_s = self.seconds(message.log_time_ns());
                    let Ok(line) = Log::decode(message.data()) else {
                        return Err(value(format_args!(
                            "the log at {t_s} s contains a line that this program did not write"
                        )));
                    };
                    let level = format!("{:?}", line.level()).to_lowercase();
                    lines.push((t_s, level, line.name, line.message));
                }
                Ok(lines)
            })
        })
    }
}
