//! Data sets for training and evaluation: CSV files with named columns.
//!
//! Contains inputs and outputs by name ([`DEFAULT_INPUTS`], [`DEFAULT_OUTPUTS`] or the caller's), and optionally
//! `trajectory` (integer: consecutive rows with the same number belong together; without this column each file is one
//! trajectory) and `contact` (0 or 1). A missing column or a field that is not a finite number is an error that states
//! its position. An input can be computed from the history of others (see [`DerivedInput`]).

mod hashed;

use std::{
    io,
    ops::Range,
    path::{Path, PathBuf},
};

use csv::StringRecord;
use nima_core::tip_force::{
    DEFAULT_INPUTS, DEFAULT_OUTPUTS, DerivedInput, Expansion, ForceModel, MAX_FEATURES, MAX_OUTPUTS,
};
use nima_files::{PASSAGE, quoted, shortened};

use self::hashed::{FNV_START, HashingReader};
use crate::{
    csv::{Comments, CsvDialect, recognise},
    tip_force::TipForceError,
};

/// Columns to use; `None` selects the default ones.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Names of the inputs, columns or [`DerivedInput`]; by default the [`DEFAULT_INPUTS`] that the first file has.
    pub inputs: Option<Vec<String>>,
    /// Default: [`DEFAULT_OUTPUTS`].
    pub outputs: Option<Vec<String>>,
}

impl Selection {
    /// Selects the columns that a data set must have for this model.
    pub fn of(model: &ForceModel) -> Self {
        Self { inputs: Some(model.inputs.clone()), outputs: Some(model.outputs.clone()) }
    }
}

/// Rows that are contiguous in time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trajectory {
    /// Index into [`DataSet::files`].
    pub file: usize,
    pub rows: Range<usize>,
}

/// Rows of inputs and outputs, in the order of the files.
#[derive(Clone, Debug)]
pub struct DataSet {
    /// The name of a derived input is complete (see [`DerivedInput`]).
    pub inputs: Vec<String>,
    pub outputs: Vec<String>,
    /// Row by row.
    pub x: Vec<f32>,
    /// Row by row.
    pub y: Vec<f32>,
    /// Whether the tip was in contact in each row; `None` if a file has no such column.
    pub contact: Option<Vec<bool>>,
    /// In the given order.
    pub files: Vec<PathBuf>,
    /// In order; they cover all rows.
    pub trajectories: Vec<Trajectory>,
    /// FNV-1a (64 bit) over the bytes of each file, as 16 hexadecimal digits.
    pub hashes: Vec<String>,
}

impl DataSet {
    /// Reads these files, which must have the same columns.
    ///
    /// # Errors
    /// [`TipForceError`] for a file that cannot be read, a column that is missing or differs between the files, or a
    /// field that is not a number.
    pub fn read(paths: &[PathBuf], selection: &Selection) -> Result<Self, TipForceError> {
        let open = |path: &PathBuf| {
            let failed = |error: io::Error| TipForceError::Open { path: path.clone(), reason: error.to_string() };
            nima_files::open_table(path).map(|file| (path.clone(), file)).map_err(failed)
        };
        Self::of(paths.iter().map(open), selection)
    }

    /// Parses texts with these file names.
    ///
    /// # Errors
    /// As [`DataSet::read`].
    pub fn parse(texts: &[(PathBuf, Vec<u8>)], selection: &Selection) -> Result<Self, TipForceError> {
        Self::of(texts.iter().map(|(path, bytes)| Ok((path.clone(), &bytes[..]))), selection)
    }

    /// Parses the texts of any readers.
    fn of<R: io::Read>(
        sources: impl Iterator<Item = Result<(PathBuf, R), TipForceError>>,
        selection: &Selection,
    ) -> Result<Self, TipForceError> {
        let mut set: Option<Self> = None;
        let mut histories = Vec::new();
        for source in sources {
            let (path, from) = source?;
            let open = |reason: String| TipForceError::Open { path: path.clone(), reason };
            let mut hash = FNV_START;
            let hashed = HashingReader { from, hash: &mut hash };
            let (dialect, text) = recognise(hashed, Comments::Skipped).map_err(open)?;
            let (mut reader, header) = dialect.reader(text).map_err(open)?;
            if set.is_none() {
                let chosen = Self::chosen(selection, &header);
                check_columns(&chosen)?;
                histories = histories_of(&chosen.inputs)?;
                set = Some(chosen);
            }
            if let Some(set) = &mut set {
                set.append(&path, &header, (&dialect, &mut reader), &mut histories)?;
                set.hashes.push(format!("{hash:016x}"));
            }
        }
        let mut set = set.ok_or(TipForceError::TooFewRows { found: 0, needed: 1 })?;
        if set.rows() == 0 {
            return Err(TipForceError::TooFewRows { found: 0, needed: 1 });
        }
        for history in histories {
            set.fill(history)?;
        }
        Ok(set)
    }

    pub fn rows(&self) -> usize {
        self.y.len() / self.outputs.len().max(1)
    }

    pub fn input(&self, row: usize) -> &[f32] {
        &self.x[row * self.inputs.len()..(row + 1) * self.inputs.len()]
    }

    pub fn output(&self, row: usize) -> &[f32] {
        &self.y[row * self.outputs.len()..(row + 1) * self.outputs.len()]
    }

    fn chosen(selection: &Selection, header: &StringRecord) -> Self {
        let has = |name: &&str| header.iter().any(|found| found == *name);
        let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect::<Vec<_>>();
        let inputs =
            selection.inputs.clone().unwrap_or_else(|| owned(DEFAULT_INPUTS.into_iter().filter(has).collect()));
        let outputs = selection.outputs.clone().unwrap_or_else(|| owned(DEFAULT_OUTPUTS.to_vec()));
        Self {
            // If no input is found, use the first default: the error then lists the columns that exist.
            inputs: if inputs.is_empty() { owned(vec![DEFAULT_INPUTS[0]]) } else { inputs },
            outputs,
            x: Vec::new(),
            y: Vec::new(),
            contact: Some(Vec::new()),
            files: Vec::new(),
            trajectories: Vec::new(),
            hashes: Vec::new(),
        }
    }

    fn append(
        &mut self,
        path: &Path,
        header: &StringRecord,
        (dialect, reader): (&CsvDialect, &mut csv::Reader<impl io::Read>),
        histories: &mut [DataSetHistory],
    ) -> Result<(), TipForceError> {
        let find = |name: &str| column(path, header, name);
        let plain = |name: &String| (!name.contains(':')).then(|| find(name)).transpose();
        let inputs = self.inputs.iter().map(plain).collect::<Result<Vec<_>, _>>()?;
        let outputs = self.outputs.iter().map(|name| find(name)).collect::<Result<Vec<_>, _>>()?;
        for history in &mut *histories {
            let [position, load] = history.derived.columns();
            history.columns = [find(position)?, find(load)?];
        }
        let optional = |name: &str| header.iter().position(|found| found == name);
        let trajectory = optional("trajectory");
        let contact = optional("contact");
        if contact.is_none() {
            self.contact = None;
        }
        let file = self.files.len();
        self.files.push(path.to_owned());
        let first = self.rows();
        let mut start = first;
        let mut last = None;
        let mut record = StringRecord::new();
        let wrong = |error: csv::Error| TipForceError::Open { path: path.to_owned(), reason: error.to_string() };
        while reader.read_record(&mut record).map_err(wrong)? {
            dialect.normalise(&mut record);
            let row = self.rows();
            let id = trajectory.map(|index| number(path, header, &record, index)).transpose()?.map(f32::to_bits);
            if row > first && id != last {
                self.trajectories.push(Trajectory { file, rows: start..row });
                start = row;
            }
            last = id;
            for &index in &inputs {
                // A derived input is computed after all files have been read.
                self.x.push(index.map_or(Ok(0.0), |index| number(path, header, &record, index))?);
            }
            for history in &mut *histories {
                let [position, load] = history.columns;
                let values = [number(path, header, &record, position)?, number(path, header, &record, load)?];
                history.rows.push(values);
            }
            if let (Some(index), Some(contacts)) = (contact, &mut self.contact) {
                contacts.push(number(path, header, &record, index)? > 0.5);
            }
            for &index in &outputs {
                self.y.push(number(path, header, &record, index)?);
            }
        }
        if self.rows() > start {
            self.trajectories.push(Trajectory { file, rows: start..self.rows() });
        }
        Ok(())
    }

    /// Computes a derived input. If its swing is not given, the mean of all measured swings is used and added to its
    /// name. For rows before the first measured swing, training uses the first swing of the same trajectory.
    fn fill(&mut self, history: DataSetHistory) -> Result<(), TipForceError> {
        let DataSetHistory { input, mut derived, rows, .. } = history;
        let open = derived.is_open();
        let mut firsts = vec![None; self.trajectories.len()];
        if open {
            let swings: Vec<_> = self.trajectories.iter().map(|t| derived.swings(&rows[t.rows.clone()])).collect();
            firsts = swings.iter().map(|swings| swings.first().copied()).collect();
            let all: Vec<f32> = swings.concat();
            if all.is_empty() {
                let reason = format!("\"{}\" requires a position that reverses in the data", self.inputs[input]);
                return Err(TipForceError::Columns { reason });
            }
            let mean = all.iter().sum::<f32>() / all.len() as f32;
            let named = format!("{}:{mean:.3e}", self.inputs[input]);
            derived = parsed(&named)?.unwrap_or(derived);
            self.inputs[input] = named;
        }
        let width = self.inputs.len();
        for (trajectory, first) in self.trajectories.iter().zip(firsts) {
            let mut memory = derived.memory(first);
            for row in trajectory.rows.clone() {
                self.x[row * width + input] = derived.step(&mut memory, rows[row]).0;
            }
        }
        Ok(())
    }
}

/// A derived input under construction.
struct DataSetHistory {
    input: usize,
    derived: DerivedInput,
    /// Indices of the columns of position and load in the current file.
    columns: [usize; 2],
    /// Position and load, row by row.
    rows: Vec<[f32; 2]>,
}

fn histories_of(inputs: &[String]) -> Result<Vec<DataSetHistory>, TipForceError> {
    let mut histories = Vec::new();
    for (input, name) in inputs.iter().enumerate() {
        if let Some(derived) = parsed(name)? {
            histories.push(DataSetHistory { input, derived, columns: [0; 2], rows: Vec::new() });
        }
    }
    Ok(histories)
}

fn parsed(name: &str) -> Result<Option<DerivedInput>, TipForceError> {
    DerivedInput::parse(name).transpose().map_err(|reason| TipForceError::Columns { reason })
}

fn column(path: &Path, header: &StringRecord, name: &str) -> Result<usize, TipForceError> {
    let mut places = header.iter().enumerate().filter(|(_, found)| *found == name).map(|(place, _)| place);
    let found = places.next();
    if let (Some(first), Some(second)) = (found, places.next()) {
        let reason = format!(
            "\"{}\" is the name of two columns of {} ({} and {})",
            quoted(name),
            path.display(),
            first + 1,
            second + 1
        );
        return Err(TipForceError::Columns { reason });
    }
    found.ok_or_else(|| TipForceError::NoColumn {
        path: path.to_owned(),
        column: quoted(name),
        available: shortened(&header.iter().collect::<Vec<_>>().join(", "), PASSAGE),
    })
}

fn number(path: &Path, header: &StringRecord, record: &StringRecord, index: usize) -> Result<f32, TipForceError> {
    let field = record.get(index).unwrap_or_default();
    match field.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(TipForceError::NotANumber {
            path: path.to_owned(),
            line: record.position().map_or(0, csv::Position::line),
            column: quoted(header.get(index).unwrap_or_default()),
            field: quoted(field),
        }),
    }
}

fn check_columns(set: &DataSet) -> Result<(), TipForceError> {
    let refuse = |reason: String| Err(TipForceError::Columns { reason });
    let names: Vec<&String> = set.inputs.iter().chain(&set.outputs).collect();
    if let Some(twice) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        return refuse(format!("\"{}\" is listed twice", quoted(twice.1)));
    }
    if set.outputs.is_empty() || set.outputs.len() > MAX_OUTPUTS {
        return refuse(format!("there are {} outputs; use 1 to {MAX_OUTPUTS}", set.outputs.len()));
    }
    let width = Expansion::fit(&set.inputs, &[]).width();
    if width > MAX_FEATURES {
        return refuse(format!("the inputs result in {width} numbers; the limit is {MAX_FEATURES}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(texts: &[&str], inputs: &str, outputs: &str) -> Result<DataSet, TipForceError> {
        let folder = tempfile::tempdir().unwrap();
        let paths: Vec<PathBuf> = (0..texts.len()).map(|i| folder.path().join(format!("{i}.csv"))).collect();
        for (path, text) in paths.iter().zip(texts) {
            std::fs::write(path, text).unwrap();
        }
        let names = |list: &str| (!list.is_empty()).then(|| list.split(',').map(str::to_owned).collect());
        DataSet::read(&paths, &Selection { inputs: names(inputs), outputs: names(outputs) })
    }

    #[test]
    fn files_and_trajectory_numbers_make_trajectories() {
        let set = read(
            &["a,b,trajectory,contact\n1,2,0,0\n3,4,0,1\n5,6,1,1\n", "b,a,trajectory,contact\n8,7,1,0\n"],
            "a",
            "b",
        )
        .unwrap();
        let rows: Vec<_> = set.trajectories.iter().map(|t| (t.file, t.rows.clone())).collect();
        assert_eq!(rows, [(0, 0..2), (0, 2..3), (1, 3..4)]);
        assert_eq!((set.x, set.y), (vec![1.0, 3.0, 5.0, 7.0], vec![2.0, 4.0, 6.0, 8.0]));
        assert_eq!(set.contact.unwrap(), [false, true, true, false]);
    }

    #[test]
    fn the_hash_is_that_of_the_bytes() {
        let hash = |text: &str| read(&[text], "a", "b").unwrap().hashes;
        assert_eq!(hash("a,b\n1,2\n"), hash("a,b\n1,2\n"));
        assert_ne!(hash("a,b\n1,2\n"), hash("a,b\n1,3\n"));
        let both = read(&["a,b\n1,2\n", "a,b\n1,3\n"], "a", "b").unwrap().hashes;
        assert_eq!(both, [hash("a,b\n1,2\n"), hash("a,b\n1,3\n")].concat(), "each file has its own");
    }

    #[test]
    fn a_derived_input_begins_anew_in_every_trajectory_and_its_swing_is_found_once() {
        let there_and_back = "x,f,y\n0,1,0\n1,1,0\n2,1,0\n1,3,0\n0,3,0\n";
        let set = read(&[there_and_back, there_and_back], "f,presliding:x:0.5,midline:f:x:0.5", "y").unwrap();
        assert_eq!(set.inputs[2], "midline:f:x:0.5:-2.000e0");
        let half = set.x.len() / 2;
        assert_eq!(set.x[..half], set.x[half..]);
        let column = |k: usize| set.x[..half].iter().skip(k).step_by(3).copied().collect::<Vec<_>>();
        assert_eq!(column(1), [0.0, 1.0, 1.0, -1.0, -1.0]);
        assert_eq!(column(2), [1.0, 2.0, 2.0, 2.0, 2.0]);
        // A model stores a name that does not depend on the file, not even on a file without a reversal.
        let other = read(&["x,f,y\n0,1,0\n1,1,0\n"], &set.inputs.join(","), "y").unwrap();
        assert_eq!(other.x[5].to_bits(), 2.0_f32.to_bits());
        let message = |inputs: &str| read(&["x,f,y\n0,1,0\n1,1,0\n"], inputs, "y").unwrap_err().to_string();
        assert!(message("midline:f:x:0.5").contains("reverses"));
        assert!(message("presliding:x").contains("presliding:POSITION:WIDTH"));
        assert!(message("presliding:z:1").contains("no column \"z\""));
    }

    #[test]
    fn other_dialects_are_read_and_a_column_that_stands_twice_is_refused() {
        let set = read(&["sep=;\na;b\n1,5;2\n3;4,25\n"], "a", "b").unwrap();
        assert_eq!((set.x, set.y), (vec![1.5, 3.0], vec![2.0, 4.25]));
        let wrong = read(&["sep=;\na;b\n1,5;2\n3;x\n"], "a", "b").unwrap_err().to_string();
        assert!(wrong.contains("line 4"), "{wrong}");
        let twice = read(&["a,a,b\n1,2,3\n"], "a", "b").unwrap_err().to_string();
        assert!(twice.contains("the name of two columns") && twice.contains("(1 and 2)"), "{twice}");
    }

    #[test]
    fn default_columns_are_those_that_exist() {
        let set = read(&["fz_n,fx_n,tip_fx_n,tip_fy_n,tip_fz_n\n1,2,3,4,5\n"], "", "").unwrap();
        assert_eq!(set.inputs, ["fx_n", "fz_n"]);
        assert_eq!(set.outputs, DEFAULT_OUTPUTS);
        assert_eq!(set.input(0), [2.0, 1.0]);
    }

    #[test]
    fn every_bad_input_names_its_place() {
        let message = |text: &str, inputs: &str, outputs: &str| read(&[text], inputs, outputs).unwrap_err().to_string();
        assert!(message("a,b\n1,2\n", "", "").contains("no column \"fx_n\": its columns are a, b"));
        assert!(message("a,b\n1,2\n1,nan\n", "a", "b").contains("line 3, column \"b\""));
        assert!(message("a,b\n1e300,2\n", "a", "b").contains("line 2, column \"a\""));
        assert!(message("a,b\n1\n", "a", "b").contains("line"));
        assert!(message("a,b\n1,2\n", "a", "a").contains("twice"));
        assert!(message("a,b\n", "a", "b").contains("too few rows: 0"));
        assert!(message("", "a", "b").contains("no column"));
        let absent = DataSet::read(&[PathBuf::from("/nowhere/d.csv")], &Selection::default()).unwrap_err();
        assert!(absent.to_string().contains("/nowhere/d.csv"));
    }
}
