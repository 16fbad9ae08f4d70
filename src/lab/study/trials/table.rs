//! A table of trials.

use std::{
    collections::{BTreeMap, BTreeSet},
    io,
    path::Path,
};

use nima_files::{open_table, quoted};
use nima_recording::csv::{Comments, CsvDialect, recognise};

/// Columns that are not measures.
const NO_MEASURES: [&str; 3] = [PARTICIPANT, CONDITION, TRIAL];
const PARTICIPANT: &str = "participant";
const CONDITION: &str = "condition";
const TRIAL: &str = "trial";
/// Whether the session of a row is complete: `yes` or `no`, as `nima score` writes it.
const COMPLETE: &str = "complete";
/// Maximum number of trials and of columns.
const TRIALS_MAX: usize = 100_000;
const COLUMNS_MAX: usize = 1000;

#[derive(Debug, thiserror::Error)]
#[error("{path}: {why}")]
pub struct TableError {
    path: String,
    why: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct TableTrial {
    pub participant: String,
    pub condition: String,
    /// Number, if the table has it.
    pub number: Option<f64>,
    /// The measures, in the order of the table's; `None` for a missing value.
    pub values: Vec<Option<f64>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct TrialTable {
    pub measures: Vec<String>,
    /// Trials, in the order of the file.
    pub trials: Vec<TableTrial>,
}

impl TrialTable {
    /// Reads a CSV file with the columns `participant`, `condition`, optionally `trial` (a number), and a column per
    /// measure: the wanted ones, or every other numeric column. Empty cells and `NA` are missing values. A row whose column
    /// `complete` is `no` is refused.
    ///
    /// # Errors
    /// [`TableError`] with cause, position and remedy.
    pub fn read(path: &Path, wanted: &[String]) -> Result<Self, TableError> {
        let failed = |why: String| TableError { path: path.display().to_string(), why };
        let input = open_table(path).map_err(|error| failed(error.to_string()))?;
        Self::of(input, wanted).map_err(failed)
    }

    fn of(input: impl io::Read, wanted: &[String]) -> Result<Self, String> {
        // A participant may be called `#1`.
        let (dialect, text) = recognise(input, Comments::Kept)?;
        let (mut reader, header) = dialect.reader(text)?;
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        if names.len() > COLUMNS_MAX {
            return Err(format!("{} columns exceed the limit of {COLUMNS_MAX}", names.len()));
        }
        if let Some(twice) = names.iter().enumerate().find(|(at, name)| names[..*at].contains(name)) {
            return Err(format!("column \"{}\" occurs twice", quoted(twice.1)));
        }
        let column = |name: &str| names.iter().position(|known| known == name);
        let needed = |name: &str| column(name).ok_or_else(|| format!("there is no column \"{name}\""));
        let participant = needed(PARTICIPANT)?;
        let condition = needed(CONDITION)?;
        let trial = column(TRIAL);
        for name in wanted {
            column(name).ok_or_else(|| format!("there is no column \"{}\"", quoted(name)))?;
        }
        let mut rows: Vec<(u64, csv::StringRecord)> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| plain(&error))?;
            rows.push((dialect.line(record.position().map_or(0, csv::Position::line)), record));
            if rows.len() > TRIALS_MAX {
                return Err(format!("there are more than {TRIALS_MAX} trials"));
            }
        }
        if let Some(at) = column(COMPLETE) {
            check_complete(&rows, at)?;
        }
        let is_number = |at: usize| rows.iter().all(|(_, row)| value(&dialect, &row[at]).is_ok());
        let measures: Vec<usize> = if wanted.is_empty() {
            (0..names.len()).filter(|at| !NO_MEASURES.contains(&names[*at].as_str()) && is_number(*at)).collect()
        } else {
            wanted.iter().filter_map(|name| column(name)).collect()
        };
        if measures.is_empty() {
            return Err("no column except participant, condition and trial contains only numbers".to_owned());
        }
        let cell = |line: u64, row: &csv::StringRecord, at: usize| {
            value(&dialect, &row[at])
                .map_err(|text| format!("line {line}: \"{}\" in column {} is not a number", quoted(&text), names[at]))
        };
        let word = |line: u64, row: &csv::StringRecord, at: usize| match &row[at] {
            "" => Err(format!("line {line}: {} is empty", names[at])),
            word => Ok(word.to_owned()),
        };
        let trials = rows.iter().map(|(line, row)| {
            Ok(TableTrial {
                participant: word(*line, row, participant)?,
                condition: word(*line, row, condition)?,
                number: trial.map(|at| cell(*line, row, at)).transpose()?.flatten(),
                values: measures.iter().map(|at| cell(*line, row, *at)).collect::<Result<_, String>>()?,
            })
        });
        let trials = trials.collect::<Result<Vec<_>, String>>()?;
        if trials.is_empty() {
            return Err("it has no trials".to_owned());
        }
        check_keys(&rows, &trials)?;
        Ok(Self { measures: measures.into_iter().map(|at| names[at].clone()).collect(), trials })
    }

    /// Returns the conditions in alphabetical order.
    pub fn conditions(&self) -> Vec<String> {
        let all: BTreeSet<&String> = self.trials.iter().map(|trial| &trial.condition).collect();
        all.into_iter().cloned().collect()
    }

    pub fn participants(&self) -> usize {
        self.trials.iter().map(|trial| &trial.participant).collect::<BTreeSet<_>>().len()
    }

    /// Returns the trials that have a value of this measure, with the value.
    pub(super) fn measured(&self, measure: usize) -> impl Iterator<Item = (&TableTrial, f64)> {
        self.trials.iter().filter_map(move |trial| Some((trial, trial.values.get(measure).copied()??)))
    }

    /// Returns the mean of each participant under each condition, and the number of its trials.
    pub(super) fn means(&self, measure: usize) -> BTreeMap<(&str, &str), (f64, usize)> {
        let mut sums: BTreeMap<(&str, &str), (f64, usize)> = BTreeMap::new();
        for (trial, value) in self.measured(measure) {
            let sum = sums.entry((&trial.participant, &trial.condition)).or_default();
            *sum = (sum.0 + value, sum.1 + 1);
        }
        for (sum, count) in sums.values_mut() {
            *sum /= *count as f64;
        }
        sums
    }
}

/// Refuses rows of incomplete sessions: their times and sums are too small.
fn check_complete(rows: &[(u64, csv::StringRecord)], complete: usize) -> Result<(), String> {
    let mut incomplete = rows.iter().filter(|(_, row)| row[complete].trim().eq_ignore_ascii_case("no"));
    let Some((line, _)) = incomplete.next() else { return Ok(()) };
    let more = match incomplete.count() {
        0 => String::new(),
        more => format!(" (and {more} more)"),
    };
    Err(format!(
        "line {line}{more}: column {COMPLETE} is \"no\": data of the session are missing; remove the row, or check it and write yes"
    ))
}

/// Refuses two rows with the same participant, condition and trial: one of them would count twice.
fn check_keys(rows: &[(u64, csv::StringRecord)], trials: &[TableTrial]) -> Result<(), String> {
    let mut seen: BTreeMap<(&str, &str, u64), u64> = BTreeMap::new();
    for ((line, _), trial) in rows.iter().zip(trials) {
        let TableTrial { participant, condition, number: Some(number), .. } = trial else { continue };
        if let Some(first) = seen.insert((participant, condition, number.to_bits()), *line) {
            return Err(format!(
                "line {line} repeats line {first}: participant {}, condition {}, trial {number}; remove one of them, or correct the number",
                quoted(participant),
                quoted(condition)
            ));
        }
    }
    Ok(())
}

/// Parses a cell: a finite number, or nothing.
fn value(dialect: &CsvDialect, cell: &str) -> Result<Option<f64>, String> {
    if cell.is_empty() || cell == "NA" {
        return Ok(None);
    }
    dialect.number(cell).filter(|value| value.is_finite()).map(Some).ok_or_else(|| cell.to_owned())
}

/// Returns a short text for an error of the reader.
fn plain(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!("line {line} has {len} values where the first line has {expected_len} names")
        }
        csv::ErrorKind::Utf8 { .. } => "it is not text (UTF-8)".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, wanted: &[&str]) -> Result<TrialTable, String> {
        let wanted: Vec<String> = wanted.iter().map(|name| (*name).to_owned()).collect();
        TrialTable::of(text.as_bytes(), &wanted)
    }

    #[test]
    fn columns_of_numbers_are_measures_and_empty_cells_are_missing() {
        let text = "participant,condition,trial,time_s,note,force_n\na,x,1,10.5,good,2\na,x,2,NA,bad,3\nb,y,1,9,,\n";
        let table = of(text, &[]).unwrap();
        assert_eq!(table.measures, ["time_s", "force_n"]);
        assert_eq!((table.participants(), table.conditions()), (2, vec!["x".to_owned(), "y".to_owned()]));
        assert_eq!(table.means(0)[&("a", "x")], (10.5, 1));
        assert_eq!(table.means(1)[&("a", "x")], (2.5, 2));
        assert_eq!(table.measured(1).count(), 2);
        assert_eq!(of(text, &["force_n"]).unwrap().measures, ["force_n"]);
    }

    #[test]
    fn a_spreadsheet_with_decimal_commas_is_read_and_a_number_sign_is_no_comment() {
        let table = of("participant;condition;trial;time_s\n#1;x;1;10,5\n#2;x;1;9,25\n", &[]).unwrap();
        assert_eq!(table.trials.iter().map(|trial| trial.values[0]).collect::<Vec<_>>(), [Some(10.5), Some(9.25)]);
        assert_eq!(table.trials[0].participant, "#1");
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, wanted, words) in [
            ("a,b\n1,2\n", &[][..], "no column \"participant\""),
            ("participant,condition\na,x\n", &[], "contains only numbers"),
            ("participant,condition,t\na,x,1\na,y,fast\n", &["t"], "line 3: \"fast\" in column t"),
            ("participant,condition,t\na,x,inf\n", &["t"], "line 2"),
            ("participant,condition,t\na,,1\n", &[], "line 2: condition is empty"),
            ("participant,condition,t\na,x\n", &[], "line 2 has 2 values"),
            ("participant,condition,t,t\na,x,1,2\n", &[], "\"t\" occurs twice"),
            ("participant,condition,t\n", &[], "no trials"),
            ("participant,condition,trial,t\na,x,1,1\na,x,2,1\na,x,1,3\n", &[], "line 4 repeats line 2"),
            ("participant,condition,complete,t\na,x,yes,1\nb,x,no,1\n", &[], "line 3: column complete is \"no\""),
            ("participant,condition,complete,t\na,x,no,1\nb,x,no,1\n", &["t"], "line 2 (and 1 more)"),
            ("participant;condition,t\na;x,1\n", &[], "by commas or by semicolons"),
            ("participant,condition,t\na,x,1\n", &["u"], "no column \"u\""),
        ] {
            let report = of(text, wanted).unwrap_err();
            assert!(report.contains(words), "{report}");
        }
    }
}
