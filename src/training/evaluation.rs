//! Errors of a model on data it was not trained on, compared with simpler methods fitted on its training data.

use std::time::Instant;

use nima_core::{
    statistics::{Percentiles, Quantiles},
    tip_force::{BASELINES, Estimator},
};
use nima_recording::tip_force::{DataSet, TipForceError};
use serde::Serialize;

/// Errors of one output, in its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stats {
    pub mae: f64,
    pub sd: f64,
    /// Half width of the interval around zero that contains 95 % of the errors.
    pub band95: f64,
    /// Coefficient of determination; 0 if the output is constant.
    pub r2: f64,
    pub n: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodFigures {
    /// `network`, or one of [`BASELINES`].
    pub method: &'static str,
    /// Per output, in the model's order; `None` if the method does not predict it.
    pub outputs: Vec<Option<Stats>>,
}

/// Mean and standard deviation of a model's predictions without contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct NoContact {
    pub mean: f64,
    pub sd: f64,
    pub n: usize,
}

/// Errors on a subset of the rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EvaluationPart {
    /// The file, or `all`.
    pub name: String,
    /// The network first, then [`BASELINES`].
    pub methods: Vec<MethodFigures>,
    /// Fraction of rows flagged as uncertain.
    #[serde(rename = "doubt_share")]
    pub doubt_fraction: f64,
    /// Per output, for rows without contact; empty if the data have no column `contact`.
    pub no_contact: Vec<NoContact>,
}

/// All errors of a model on a data set.
#[derive(Clone, Debug, Serialize)]
pub struct Evaluation {
    /// Names of the outputs, which contain the unit.
    pub outputs: Vec<String>,
    pub files: Vec<EvaluationPart>,
    pub overall: EvaluationPart,
    /// Files that were used to train the model: their errors do not show the accuracy on new data.
    pub trained_on: Vec<String>,
    /// Time of one prediction, microseconds.
    pub inference_us: Quantiles,
    /// Predictions, row by row.
    #[serde(skip)]
    pub predictions: Vec<f32>,
    #[serde(skip)]
    pub in_doubt: Vec<bool>,
}

/// Evaluates a model on all rows.
///
/// # Errors
/// [`TipForceError`] if the columns are not the model's (see
/// [`Selection::of`](nima_recording::tip_force::Selection::of)).
pub fn evaluate(estimator: &mut Estimator, data: &DataSet) -> Result<Evaluation, TipForceError> {
    if data.inputs != estimator.model().inputs || data.outputs != estimator.model().outputs {
        return Err(TipForceError::Columns {
            reason: "the data were read with different columns from the model's".into(),
        });
    }
    let outputs = data.outputs.len();
    let mut times = Percentiles::new();
    let mut methods: Vec<Vec<Vec<Option<f32>>>> = vec![Vec::with_capacity(data.rows()); 1 + BASELINES.len()];
    let mut in_doubt = Vec::with_capacity(data.rows());
    for row in 0..data.rows() {
        let start = Instant::now();
        let estimate = estimator.estimate(data.input(row));
        times.record(start.elapsed().as_secs_f64());
        in_doubt.push(estimate.in_doubt);
        methods[0].push(estimate.output[..outputs].iter().copied().map(Some).collect());
        for (method, predicted) in methods[1..].iter_mut().zip(estimator.model().baselines.predict(data.input(row))) {
            method.push(predicted);
        }
    }
    let part = |name: String, rows: &[usize]| EvaluationPart {
        name,
        methods: method_names()
            .zip(&methods)
            .map(|(method, predicted)| MethodFigures {
                method,
                outputs: (0..outputs).map(|o| stats(data, predicted, rows, o)).collect(),
            })
            .collect(),
        doubt_fraction: rows.iter().filter(|row| in_doubt[**row]).count() as f64 / rows.len().max(1) as f64,
        no_contact: no_contact(data, &methods[0], rows),
    };
    let all: Vec<usize> = (0..data.rows()).collect();
    let of_file = |file: usize| -> Vec<usize> {
        data.trajectories.iter().filter(|t| t.file == file).flat_map(|t| t.rows.clone()).collect()
    };
    let files = data.files.iter().enumerate().map(|(k, path)| part(path.display().to_string(), &of_file(k))).collect();
    Ok(Evaluation {
        outputs: data.outputs.clone(),
        files,
        overall: part("all".into(), &all),
        trained_on: trained_on(data, &estimator.model().origin.data_hashes),
        inference_us: times.quantiles(),
        predictions: methods[0].iter().flatten().map(|value| value.unwrap_or_default()).collect(),
        in_doubt,
    })
}

/// Returns the files of this data set whose hashes are in the list.
fn trained_on(data: &DataSet, hashes: &[String]) -> Vec<String> {
    let files = data.files.iter().zip(&data.hashes);
    files.filter(|(_, hash)| hashes.contains(hash)).map(|(path, _)| path.display().to_string()).collect()
}

fn method_names() -> impl Iterator<Item = &'static str> {
    ["network"].into_iter().chain(BASELINES)
}

fn stats(data: &DataSet, predicted: &[Vec<Option<f32>>], rows: &[usize], output: usize) -> Option<Stats> {
    let pairs: Vec<(f64, f64)> = rows
        .iter()
        .map(|&row| Some((f64::from(predicted[row][output]?), f64::from(data.output(row)[output]))))
        .collect::<Option<_>>()?;
    let n = pairs.len();
    if n == 0 {
        return None;
    }
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n as f64;
    let bias = mean(&|(p, y)| p - y);
    let truth = mean(&|(_, y)| *y);
    let variance = mean(&|(_, y)| (y - truth).powi(2));
    let mut absolute: Vec<f64> = pairs.iter().map(|(p, y)| (p - y).abs()).collect();
    let place = ((n as f64 * 0.95).ceil() as usize).clamp(1, n) - 1;
    let band95 = *absolute.select_nth_unstable_by(place, f64::total_cmp).1;
    Some(Stats {
        mae: mean(&|(p, y)| (p - y).abs()),
        sd: mean(&|(p, y)| (p - y - bias).powi(2)).sqrt(),
        band95,
        r2: if variance > 0.0 { 1.0 - mean(&|(p, y)| (p - y).powi(2)) / variance } else { 0.0 },
        n,
    })
}

fn no_contact(data: &DataSet, predicted: &[Vec<Option<f32>>], rows: &[usize]) -> Vec<NoContact> {
    let Some(contact) = &data.contact else { return Vec::new() };
    let free: Vec<usize> = rows.iter().copied().filter(|row| !contact[*row]).collect();
    let n = free.len();
    let one = |output: usize| {
        let values = || free.iter().filter_map(|row| predicted[*row][output]).map(f64::from);
        let mean = values().sum::<f64>() / n.max(1) as f64;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / n.max(1) as f64;
        NoContact { mean, sd: variance.sqrt(), n }
    };
    (0..data.outputs.len()).map(one).collect()
}

#[cfg(test)]
mod tests {
    use nima_recording::tip_force::Selection;

    use super::*;

    #[test]
    fn one_training_file_among_new_ones_is_found() {
        let columns = Selection { inputs: Some(vec!["a".into()]), outputs: Some(vec!["b".into()]) };
        let read = |files: &[(&str, &str)]| {
            let texts: Vec<_> = files.iter().map(|(name, text)| ((*name).into(), text.as_bytes().to_vec())).collect();
            DataSet::parse(&texts, &columns).unwrap()
        };
        let old = "a,b\n1,2\n";
        let new = "a,b\n3,4\n";
        let training = read(&[("one.csv", old), ("two.csv", "a,b\n5,6\n")]);
        let evaluation = read(&[("new.csv", new), ("renamed.csv", old)]);
        assert_eq!(trained_on(&evaluation, &training.hashes), ["renamed.csv"]);
        assert!(trained_on(&read(&[("new.csv", new)]), &training.hashes).is_empty());
    }
}
