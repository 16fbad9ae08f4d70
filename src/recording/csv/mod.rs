//! Reading recordings of motion and force (CSV).
//!
//! Columns: `t_s`; `x_m, y_m, z_m` with `fx_n, fy_n, fz_n`, one to three axes. Other names can be mapped to these, and
//! the leader's motion can be mapped as well. Separators, decimal commas and times in other forms are recognised. SI units, or any consistent ones (rad and Nm of a lever). A missing
//! column, a field that is not a number and a time that does not increase are errors that state their position. A row
//! whose force fields are all empty is left out, because its force is unknown. A file is read as a stream, so it may
//! be a pipe, up to [`nima_files::TABLE_MAX`] bytes.

mod dialect;
mod mapping;
mod pairs;
mod poses;
mod rotation;
mod signals;
mod table;
mod time;

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use nima_core::impedance::{AXES, Sample};
use table::CsvTable;
use time::{TimeColumn, Times};

pub use dialect::{Comments, CsvDialect, TableText, recognise};
pub use mapping::{ColumnMapping, ColumnMappingError, ColumnSource, PAIRS, POSES, Quantities};
pub use pairs::{read_mapped_pairs, read_pairs};
pub use poses::{read_mapped_poses, read_poses};
pub use signals::{Signals, read_signals};

pub const AXIS_NAMES: [&str; AXES] = ["x", "y", "z"];

#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    #[error("cannot read recording {path}: {reason}")]
    Open {
        path: PathBuf,
        /// Includes the source of the error.
        reason: String,
    },
    #[error("recording {path}: {message}")]
    Row { path: PathBuf, message: String },
    #[error("recording {path} has no column \"{column}\" for {purpose}; its columns are {available}; {cure}")]
    NoColumn {
        path: PathBuf,
        column: String,
        purpose: &'static str,
        available: String,
        /// Remedy: columns of some files can be mapped, other files have fixed names.
        cure: String,
    },
    #[error(
        "recording {path}, line {line}: the quaternion has length {length:.3} instead of 1; remove or repair the row"
    )]
    NotARotation {
        path: PathBuf,
        /// From 1.
        line: u64,
        length: f64,
    },
    #[error(
        "recording {path}, line {line}, column \"{column}\": \"{field}\" is not a finite number; remove or repair the row"
    )]
    NotANumber {
        path: PathBuf,
        /// From 1.
        line: u64,
        column: String,
        field: String,
    },
    #[error(
        "recording {path}, line {line}, column \"{column}\": \"{field}\" has a decimal comma, but the rows before have decimal points or whole numbers; use the same decimal separator in all rows"
    )]
    DecimalComma {
        path: PathBuf,
        /// From 1.
        line: u64,
        column: String,
        field: String,
    },
    #[error(
        "recording {path}, line {line}, column \"{column}\": \"{field}\" is not a time; give seconds, a date and time such as 2026-11-28T07:25:56.125, or two columns with --map t=date+time"
    )]
    NotATime {
        path: PathBuf,
        /// From 1.
        line: u64,
        column: String,
        field: String,
    },
    #[error(
        "recording {path}, line {line}: the time steps back by {back_s} s (from {before_s} s to {now_s} s), as happens when the computer's clock is set; split the file before this line and use the parts separately"
    )]
    ClockSet {
        path: PathBuf,
        /// From 1.
        line: u64,
        before_s: f64,
        now_s: f64,
        back_s: f64,
    },
    #[error("recording {path}, line {line}: the time {now_s} s occurs twice; remove one of the two rows")]
    SameTime {
        path: PathBuf,
        /// From 1.
        line: u64,
        now_s: f64,
    },
    #[error(
        "recording {path}, column \"{column}\": the times look like {unit} since 1970, but this gives a rate of {rate_hz} Hz; give the unit with --map t=COLUMN*SCALE (1e-9 for ns)"
    )]
    TimeUnit { path: PathBuf, column: String, unit: &'static str, rate_hz: f64 },
    #[error(
        "recording {path}: two columns have the name \"{column}\" (columns {first} and {second}); rename one of them"
    )]
    Double {
        path: PathBuf,
        column: String,
        /// From 1.
        first: usize,
        /// From 1.
        second: usize,
    },
    #[error("recording {path}, line {line}: {what} is {value}; {cure}")]
    Implausible {
        path: PathBuf,
        /// From 1.
        line: u64,
        what: &'static str,
        value: f64,
        cure: &'static str,
    },
    #[error("recording {path} has {found} samples, {needed} are needed; record longer or choose a shorter window")]
    TooShort { path: PathBuf, found: usize, needed: usize },
}

/// Motion and force over time at a nearly constant rate. Rows without a force are left out, because it is unknown.
#[derive(Clone, Debug)]
pub struct CsvRecording {
    /// Axes of the recording, as indices into [`AXIS_NAMES`]; lane `i` of a sample is axis `axes[i]`.
    pub path: PathBuf,
    /// Which axes it contains, as indices into [`AXIS_NAMES`]; lane `i` of a sample is axis `axes[i]`.
    pub axes: Vec<usize>,
    /// One over the median time step.
    pub rate_hz: f64,
    /// Lanes beyond `axes.len()` are zero.
    pub samples: Vec<Sample>,
    /// The leader's motion, sample by sample, mapped to the tip, m; `None` if it was not recorded or not requested.
    pub leader_m: Option<Vec<Vector3<f64>>>,
}

impl CsvRecording {
    /// Reads a CSV file with this mapping of columns.
    ///
    /// # Errors
    /// [`RecordingError`], with the position, for a file that cannot be read, a missing column, a field that is not a
    /// number, a time that does not increase, or fewer than three samples.
    ///
    /// ```
    /// use nima_recording::csv::{ColumnMapping, CsvRecording};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("recording.csv");
    /// std::fs::write(&path, "time_ms,x_m,fx_n\n0,0.00,0.0\n1,0.01,0.5\n2,0.02,1.0\n")?;
    ///
    /// assert!(CsvRecording::read(&path, &ColumnMapping::default()).is_err(), "there is no column t_s");
    /// let recording = CsvRecording::read(&path, &ColumnMapping::parse(&["t=time_ms*0.001"])?)?;
    /// assert_eq!(recording.rate_hz, 1000.0);
    /// assert_eq!(recording.samples[2].force_n.x, 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(path: &Path, mapping: &ColumnMapping) -> Result<Self, RecordingError> {
        let mut table = CsvTable::open(path)?;
        let time = TimeColumn::find(&table, &mapping.source("t_s"), &cure("t"))?;
        let mut times = Times::default();
        let axes = axes(&table, mapping);
        let has_leader = mapping.names_leader();
        let mut columns = Vec::with_capacity(axes.len());
        for &axis in &axes {
            let name = AXIS_NAMES[axis];
            let position = table.column(&mapping.source(&format!("{name}_m")), "position", &cure(name))?;
            let force_key = format!("f{name}");
            let force = table.column(&mapping.source(&format!("{force_key}_n")), "force", &cure(&force_key))?;
            let leader_key = format!("l{name}");
            let of_leader = mapping.source(&format!("{leader_key}_m"));
            let leader = has_leader.then(|| table.column(&of_leader, "leader's motion", &cure(&leader_key)));
            columns.push((position, force, leader.transpose()?));
        }
        let mut samples = Vec::new();
        let mut leader_m = Vec::new();
        while table.advance()? {
            times.read(&table, &time)?;
            let [mut position_m, mut force_n, mut handle_m] = [Vector3::zeros(); 3];
            if columns.iter().all(|(_, force, _)| table.is_empty(force)) {
                continue;
            }
            for (lane, (position, force, leader)) in columns.iter().enumerate() {
                position_m[lane] = table.number(position)?;
                force_n[lane] = table.number(force)?;
                if let Some(leader) = leader {
                    handle_m[lane] = table.number(leader)?;
                }
            }
            samples.push(Sample { t_s: times.last_s(), position_m, force_n });
            if has_leader {
                leader_m.push(handle_m);
            }
        }
        times.check(&table, &time)?;
        let recording = Self::of_samples(path, axes, samples)?;
        Ok(Self { leader_m: has_leader.then_some(leader_m), ..recording })
    }

    /// Creates a recording of samples whose times rise.
    ///
    /// # Errors
    /// [`RecordingError::TooShort`] for fewer than three.
    pub fn of_samples(path: &Path, axes: Vec<usize>, samples: Vec<Sample>) -> Result<Self, RecordingError> {
        let too_short = |found| RecordingError::TooShort { path: path.to_owned(), found, needed: 3 };
        let rate_hz = rate_hz(samples.iter().map(|sample| sample.t_s)).ok_or_else(|| too_short(samples.len()))?;
        Ok(Self { path: path.to_owned(), axes, rate_hz, samples, leader_m: None })
    }
}

/// Returns the remedy for a missing column that can be mapped.
fn cure(key: &str) -> String {
    format!("name another with --map {key}=COLUMN")
}

/// Returns the axes with a position, a force or a mapped leader's motion. If an axis has only a position or only a
/// force, the other is reported as missing.
fn axes(table: &CsvTable, mapping: &ColumnMapping) -> Vec<usize> {
    let has = |name: &str| mapping.names(name) || table.has(mapping.source(name).column());
    let found: Vec<usize> = (0..AXES)
        .filter(|&axis| {
            let name = AXIS_NAMES[axis];
            has(&format!("{name}_m")) || has(&format!("f{name}_n")) || mapping.names(&format!("l{name}_m"))
        })
        .collect();
    // If no axis exists, use x: the error then lists the columns that exist.
    if found.is_empty() { vec![0] } else { found }
}

/// Returns the rate of these times (s): one over the median time step, rounded to eight digits so that steps of 0.001 s
/// give 1000 Hz. `None` for fewer than three times.
pub fn rate_hz(times_s: impl Iterator<Item = f64>) -> Option<f64> {
    let mut before_s = None;
    let mut steps: Vec<f64> =
        times_s.filter_map(|t_s| before_s.replace(t_s).map(|before_s: f64| t_s - before_s)).collect();
    if steps.len() < 2 {
        return None;
    }
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    format!("{:.7e}", 1.0 / *median).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, maps: &[&str]) -> Result<CsvRecording, RecordingError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        std::fs::write(&path, text).unwrap();
        CsvRecording::read(&path, &ColumnMapping::parse(maps).unwrap())
    }

    #[test]
    fn default_columns_in_any_order_and_number() {
        let recording = read("fz_n,t_s,z_m,x_m,fx_n,note\n1,0,2,3,4,a\n1,0.01,2,3,4,b\n1,0.02,2,3,5,c\n", &[]).unwrap();
        assert_eq!(recording.axes, [0, 2]);
        assert!((recording.rate_hz - 100.0).abs() < f64::EPSILON);
        assert_eq!(recording.samples[2].position_m, Vector3::new(3.0, 2.0, 0.0));
        assert_eq!(recording.samples[2].force_n, Vector3::new(5.0, 1.0, 0.0));
    }

    #[test]
    fn rows_without_a_force_are_left_out() {
        let text = "t_s,x_m,z_m,fx_n,fz_n\n0,1,2,,\n1,1,2,3,4\n2,1,2,,\n3,1,2,3,4\n4,1,2,0,0\n";
        let recording = read(text, &[]).unwrap();
        assert_eq!(recording.samples.iter().map(|sample| sample.t_s).collect::<Vec<_>>(), [1.0, 3.0, 4.0]);
        let half = read("t_s,x_m,z_m,fx_n,fz_n\n0,1,2,,4\n", &[]).unwrap_err().to_string();
        assert!(half.contains("line 2, column \"fx_n\""), "a part of a force is none: {half}");
    }

    #[test]
    fn mapped_columns_with_a_scale() {
        let recording = read("t_s,px_mm,torque\n0,1,2\n1,2,3\n2,3,4\n", &["x=px_mm*0.001", "fx=torque*-1"]).unwrap();
        assert!((recording.samples[1].position_m.x - 0.002).abs() < 1e-15);
        assert!((recording.samples[1].force_n.x + 3.0).abs() < 1e-15);
    }

    #[test]
    fn the_leaders_motion_is_read_where_it_is_mapped_and_only_there() {
        let text = "t_s,x_m,y_m,fx_n,fy_n,hx_mm,hy_mm,lx_m\n0,1,2,3,4,5,6,9\n1,1,2,3,4,7,8,9\n2,1,2,3,4,9,10,9\n";
        assert_eq!(read(text, &[]).unwrap().leader_m, None, "a column of that name alone says nothing");
        let leader_m = read(text, &["lx=hx_mm*0.001", "ly=hy_mm*0.001"]).unwrap().leader_m.unwrap();
        assert!((leader_m[1] - Vector3::new(0.007, 0.008, 0.0)).norm() < 1e-15 && leader_m.len() == 3);
        let missing = read(text, &["lx=hx_mm"]).unwrap_err().to_string();
        assert!(missing.contains("no column \"ly_m\" for leader's motion") && missing.contains("--map ly=COLUMN"));
        assert!(read(text, &["lz=hx_mm"]).unwrap_err().to_string().contains("no column"), "an axis without a force");
    }

    #[test]
    fn every_bad_input_names_its_place() {
        let message = |text: &str, maps: &[&str]| read(text, maps).unwrap_err().to_string();
        assert!(message("t_s,x_m\n0,1\n", &[]).contains("no column \"fx_n\""));
        assert!(message("t_s,a,b\n0,1,2\n", &["x=a", "fx=c"]).contains("its columns are t_s, a, b"));
        assert!(message("t_s,x_m,fx_n\n0,1,2\n1,nan,2\n", &[]).contains("line 3, column \"x_m\""));
        assert!(message("t_s,x_m,fx_n\n0,1,2\n1,,2\n", &[]).contains("line 3"));
        assert!(message("t_s,x_m,fx_n\n0,1,2\n1,1,2\n1,1,2\n", &[]).contains("line 4: the time 1 s occurs twice"));
        assert!(message("t_s,x_m,fx_n\n0,1,2\n1,1\n", &[]).contains("line"));
        assert!(message("t_s,x_m,fx_n\n0,1,2\n", &[]).contains("1 samples"));
        assert!(message("", &[]).contains("t_s"));
    }

    #[test]
    fn times_in_many_forms_give_the_same_recording() {
        let read = |header: &str, times: [&str; 4], maps: &[&str]| {
            let rows = times.map(|time| format!("{time},1,2\n")).concat();
            read(&format!("{header},x_m,fx_n\n{rows}"), maps)
        };
        for (header, times, maps) in [
            ("t_s", ["0", "0.25", "0.5", "0.75"], &[][..]),
            ("t_s", ["1764314756000", "1764314756250", "1764314756500", "1764314756750"], &[]),
            ("t_s", ["1764314756000000", "1764314756250000", "1764314756500000", "1764314756750000"], &[]),
            ("t_s", ["1764314756000000000", "1764314756250000000", "1764314756500000000", "1764314756750000000"], &[]),
            (
                "stamp",
                [
                    "2026-11-28T07:25:56Z",
                    "2026-11-28T07:25:56.25Z",
                    "2026-11-28T07:25:56.5Z",
                    "2026-11-28T07:25:56.75Z",
                ],
                &["t=stamp"],
            ),
            (
                "stamp",
                ["2026-11-28 07:25:56", "2026-11-28 07:25:56.25", "2026-11-28 07:25:56.5", "2026-11-28 07:25:56.75"],
                &["t=stamp"],
            ),
            ("time", ["23:59:59.5", "23:59:59.75", "00:00:00", "00:00:00.25"], &["t=time"]),
            (
                "date,time",
                ["2026-11-28,07:25:56", "2026-11-28,07:25:56.25", "2026-11-28,07:25:56.5", "2026-11-28,07:25:56.75"],
                &["t=date+time"],
            ),
            (
                "date,time",
                ["28.11.2026,23:59:59.5", "28.11.2026,23:59:59.75", "29.11.2026,00:00:00", "29.11.2026,00:00:00.25"],
                &["t=date+time"],
            ),
            (
                "sec,nanosec",
                ["1764314756,500000000", "1764314756,750000000", "1764314757,0", "1764314757,250000000"],
                &["t=sec+nanosec"],
            ),
        ] {
            let recording = read(header, times, maps).unwrap();
            assert!((recording.rate_hz - 4.0).abs() < 1e-9, "{times:?}: {}", recording.rate_hz);
            let first_s = recording.samples[0].t_s;
            assert_eq!(
                recording.samples.iter().map(|sample| sample.t_s - first_s).collect::<Vec<_>>(),
                [0.0, 0.25, 0.5, 0.75]
            );
        }
        let kept = read("t_s", ["1764314756.0", "1764314756.25", "1764314756.5", "1764314756.75"], &[]).unwrap();
        assert!((kept.samples[1].t_s - 1_764_314_756.25).abs() < 1e-6, "seconds stay unchanged");
        let unknown = read("t_s", ["1764314756000", "1764324756000", "1764334756000", "1764344756000"], &[]);
        assert!(unknown.is_err());
        let slash = read("date,time", ["11/28/2026,07:25:56", "", "", ""], &["t=date+time"]).unwrap_err().to_string();
        assert!(slash.contains("line 2") && slash.contains("11/28/2026"), "{slash}");
    }

    #[test]
    fn a_clock_that_was_set_is_named_and_sorting_is_not_advised() {
        let text = "t_s,x_m,fx_n\n0.5,1,2\n1.0,1,2\n0.25,1,2\n0.5,1,2\n";
        let words = read(text, &[]).unwrap_err().to_string();
        assert!(words.contains("line 4: the time steps back by 0.75 s") && words.contains("split the file"), "{words}");
        assert!(!words.contains("sort"), "{words}");
    }

    #[test]
    fn a_decimal_comma_far_below_is_named() {
        let row = |number: u32| format!("{number};1;2\n");
        let text: String = std::iter::once("t_s;x_m;fx_n\n".to_owned()).chain((0..60).map(row)).collect();
        let words = read(&(text + "60;1,5;2\n"), &[]).unwrap_err().to_string();
        assert!(words.contains("line 62") && words.contains("\"1,5\" has a decimal comma"), "{words}");
    }

    #[test]
    fn a_name_that_stands_twice_is_refused_with_both_places() {
        let words = read("t_s,x_m,x_m,fx_n\n0,1,1,2\n", &[]).unwrap_err().to_string();
        assert!(words.contains("\"x_m\" (columns 2 and 3)"), "{words}");
        assert!(
            read("t_s,x_m,fx_n,note,note\n0,1,2,a,b\n1,1,2,a,b\n2,1,2,a,b\n", &[]).is_ok(),
            "not a column that is read"
        );
    }
}
