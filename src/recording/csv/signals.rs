//! Reading as much of motion and force as a table has, for a look at it: the rest is unknown.

use std::path::Path;

use nalgebra::Vector3;
use nima_core::impedance::{AXES, Sample};

use super::{
    AXIS_NAMES, ColumnMapping, RecordingError, cure, rate_hz,
    table::{CsvColumn, CsvTable},
    time::{TimeColumn, Times},
};

/// Longest time between two values that can be one signal, s: a recording at 1 Hz.
const MAX_GAP_S: f64 = 2.5;

/// Recorded force and position over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals {
    /// Times count from the first row, s. NaN where a value is unknown.
    pub rows: Vec<Sample>,
    /// Faults of the file, one line each; empty for a sound file.
    pub notes: Vec<String>,
}

impl Signals {
    /// Takes rows whose times rise.
    pub fn new(mut rows: Vec<Sample>) -> Self {
        let first_s = rows.first().map_or(0.0, |first| first.t_s);
        for row in &mut rows {
            row.t_s -= first_s;
        }
        Self { rows, notes: Vec::new() }
    }

    /// Returns on which axes a force is ever known.
    pub fn force_axes(&self) -> [bool; AXES] {
        self.axes(|row| &row.force_n)
    }

    /// Returns on which axes a position is ever known.
    pub fn position_axes(&self) -> [bool; AXES] {
        self.axes(|row| &row.position_m)
    }

    fn axes(&self, of: impl Fn(&Sample) -> &Vector3<f64>) -> [bool; AXES] {
        std::array::from_fn(|axis| self.rows.iter().any(|row| of(row)[axis].is_finite()))
    }

    /// Returns the time of the last row, s.
    pub fn end_s(&self) -> f64 {
        self.rows.last().map_or(0.0, |last| last.t_s)
    }

    /// Returns the time without a value beyond which a signal has a gap, s: a little more than twice the usual step of
    /// the slowest one.
    pub fn gap_s(&self) -> f64 {
        let forces = (0..AXES).map(|axis| self.step_s(|row| row.force_n[axis]));
        let positions = (0..AXES).map(|axis| self.step_s(|row| row.position_m[axis]));
        let slowest_s = forces.chain(positions).flatten().fold(0.0, f64::max);
        (2.5 * slowest_s).min(MAX_GAP_S)
    }

    fn step_s(&self, value: impl Fn(&Sample) -> f64) -> Option<f64> {
        let known = self.rows.iter().filter(|row| value(row).is_finite());
        rate_hz(known.map(|row| row.t_s)).map(f64::recip)
    }
}

/// Reads forces and positions with this mapping of columns. Columns that are missing and not mapped are unknown, as are
/// empty fields and `nan`.
///
/// # Errors
/// [`RecordingError`], with the position, for a file that cannot be read, a table without a time or without any force or
/// position, a mapped column that is missing, a field that is not a number, or a time that does not increase.
///
/// ```
/// use nima_recording::csv::{ColumnMapping, read_signals};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("forces.csv");
/// std::fs::write(&path, "t_s,fz_n\n0,1.5\n0.01,\n")?;
///
/// let signals = read_signals(&path, &ColumnMapping::default())?;
/// assert_eq!(signals.rows[0].force_n.z, 1.5);
/// assert!(signals.rows[0].force_n.x.is_nan() && signals.rows[1].force_n.z.is_nan());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_signals(path: &Path, mapping: &ColumnMapping) -> Result<Signals, RecordingError> {
    let mut table = CsvTable::open(path)?;
    let time = TimeColumn::find(&table, &mapping.source("t_s"), &cure("t"))?;
    let forces = columns(&table, mapping, |axis| format!("f{axis}_n"))?;
    let positions = columns(&table, mapping, |axis| format!("{axis}_m"))?;
    if forces.iter().chain(&positions).all(Option::is_none) {
        // Reports the missing column together with those that exist.
        table.column(&mapping.source("fx_n"), "force", &cure("fx"))?;
    }
    let mut times = Times::default();
    let mut rows = Vec::new();
    while table.advance()? {
        times.read(&table, &time)?;
        let [position_m, force_n] = [vector(&table, &positions)?, vector(&table, &forces)?];
        rows.push(Sample { t_s: times.last_s(), position_m, force_n });
    }
    times.check(&table, &time)?;
    if rows.is_empty() {
        return Err(RecordingError::TooShort { path: path.to_owned(), found: 0, needed: 1 });
    }
    Ok(Signals::new(rows))
}

/// Finds the columns of a quantity that are mapped or exist.
fn columns(
    table: &CsvTable,
    mapping: &ColumnMapping,
    name: impl Fn(&str) -> String,
) -> Result<[Option<CsvColumn>; AXES], RecordingError> {
    let mut found = [const { None }; AXES];
    for (axis, place) in AXIS_NAMES.iter().zip(&mut found) {
        let quantity = name(axis);
        let source = mapping.source(&quantity);
        if mapping.names(&quantity) || table.has(source.column()) {
            *place = Some(table.column(&source, "a signal", &cure(&quantity))?);
        }
    }
    Ok(found)
}

fn vector(table: &CsvTable, columns: &[Option<CsvColumn>; AXES]) -> Result<Vector3<f64>, RecordingError> {
    let mut values = Vector3::repeat(f64::NAN);
    for (column, value) in columns.iter().zip(values.iter_mut()) {
        let Some(column) = column else { continue };
        if !table.is_empty(column) && !table.field(column).eq_ignore_ascii_case("nan") {
            *value = table.number(column)?;
        }
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, maps: &[&str]) -> Result<Signals, RecordingError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        std::fs::write(&path, text).unwrap();
        read_signals(&path, &ColumnMapping::parse(maps).unwrap())
    }

    #[test]
    fn what_a_table_lacks_is_unknown_and_never_zero() {
        let signals = read("t_s,fx_n,fz_n\n5,1,2\n5.1,,2\n5.2,nan,3\n5.3,4,\n", &[]).unwrap();
        assert_eq!((signals.force_axes(), signals.position_axes()), ([true, false, true], [false; 3]));
        let x = signals.rows.iter().map(|row| row.force_n.x).map(|x| x.is_finite().then_some(x)).collect::<Vec<_>>();
        assert_eq!(x, [Some(1.0), None, None, Some(4.0)]);
        assert!(
            signals.rows.iter().all(|row| row.position_m.iter().chain([&row.force_n.y]).all(|value| value.is_nan()))
        );
        assert!((signals.end_s() - 0.3).abs() < 1e-9, "times count from the first row: {}", signals.end_s());
        let mapped =
            read("time;Kraft;Weg_mm\n0;1,5;20\n0,1;1,6;30\n", &["t=time", "fy=Kraft", "z=Weg_mm*0.001"]).unwrap();
        assert_eq!((mapped.rows[1].force_n.y, mapped.rows[0].position_m.z), (1.6, 0.02));
    }

    #[test]
    fn a_signal_of_a_slow_recording_has_no_gaps_between_its_values() {
        let slow = read("t_s,z_m\n0,1\n0.1,1\n0.2,1\n0.3,1\n", &[]).unwrap();
        assert!((slow.gap_s() - 0.25).abs() < 1e-6, "{}", slow.gap_s());
        assert!(read("t_s,z_m\n0,1\n60,1\n120,1\n", &[]).unwrap().gap_s() <= MAX_GAP_S);
    }

    #[test]
    fn a_table_without_a_signal_or_a_time_is_refused_with_its_columns() {
        let words = |text: &str, maps: &[&str]| read(text, maps).unwrap_err().to_string();
        let none = words("t_s,a,b\n0,1,2\n", &[]);
        assert!(none.contains("a, b") && none.contains("--map fx=COLUMN"), "{none}");
        assert!(words("fx_n\n1\n", &[]).contains("t_s"));
        assert!(words("t_s,fx_n\n0,1\n", &["z=height"]).contains("\"height\""));
        assert!(words("t_s,fx_n\n0,1\n1,high\n", &[]).contains("line 3"));
        assert!(words("t_s,fx_n\n", &[]).contains("0 samples"));
    }
}
