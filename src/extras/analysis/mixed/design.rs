//! Columns of the fixed effects, and the participant of each row.

use super::MixedModel;
use crate::error::{AnalysisError, Result};
use crate::{check, summary};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A column is considered dependent if its residual against the earlier columns is below this fraction of its length
/// (the limit of R's `lm`).
const DEPENDENT: f64 = 1e-7;

/// The model as matrices. Its columns are orthonormalised (`X = Q R`), so that the size or mean of a covariate costs no
/// digits; `y` is the residual of the response against `Q`.
pub(super) struct MixedDesign {
    /// Name of each column of X: the intercept, the conditions in alphabetical order without the reference, the
    /// covariates.
    pub(super) names: Vec<String>,
    pub(super) reference: String,
    /// The columns that are conditions.
    pub(super) conditions: Range<usize>,
    pub(super) participants: Vec<String>,
    pub(super) of_row: Vec<usize>,
    /// Number of rows of each participant.
    pub(super) sizes: Vec<f64>,
    /// Rows by columns.
    pub(super) q: DMatrix<f64>,
    /// Columns by columns, upper triangular.
    pub(super) r: DMatrix<f64>,
    /// `Q'` times the response.
    pub(super) projected: DVector<f64>,
    /// Residual of the response after the projection.
    pub(super) y: DVector<f64>,
}

impl MixedDesign {
    pub(super) fn of(model: &MixedModel) -> Result<Self> {
        let names: BTreeSet<&str> = model.participant.iter().map(String::as_str).collect();
        check::enough("participants", names.len(), 2)?;
        let index: BTreeMap<&str, usize> = names.iter().enumerate().map(|(at, name)| (*name, at)).collect();
        let of_row: Vec<usize> = model.participant.iter().map(|name| index[name.as_str()]).collect();
        let mut sizes = vec![0.0; names.len()];
        for at in &of_row {
            sizes[*at] += 1.0;
        }
        let (column_names, columns, conditions) = columns(model);
        let x = DMatrix::from_fn(model.response.len(), columns.len(), |row, column| columns[column][row]);
        let (q, r) = orthonormal(&x, &column_names)?;
        let degrees = DesignDegrees::of(&x, &r, &of_row, &sizes);
        degrees.check()?;
        let response = DVector::from_column_slice(&model.response);
        let projected = q.tr_mul(&response);
        let y = &response - &q * &projected;
        // Relative to the variation of the responses, and to the rounding error of their size.
        if y.norm() <= 1e-12 * summary::squares(&model.response).sqrt() + 1e-14 * response.norm() {
            return Err(AnalysisError::NotEstimable {
                why: "the fixed effects explain the responses exactly, without a residual",
            });
        }
        let participants = names.into_iter().map(str::to_owned).collect();
        let reference = model.reference.clone();
        Ok(Self { names: column_names, reference, conditions, participants, of_row, sizes, q, r, projected, y })
    }

    /// Returns the sum over the rows of each participant.
    pub(super) fn sums(&self, column: impl Fn(usize) -> f64) -> DVector<f64> {
        let mut sums = DVector::zeros(self.sizes.len());
        for (row, &participant) in self.of_row.iter().enumerate() {
            sums[participant] += column(row);
        }
        sums
    }

    pub(super) fn rows(&self) -> usize {
        self.of_row.len()
    }
}

/// Returns the names and columns of X, and which columns are conditions.
fn columns(model: &MixedModel) -> (Vec<String>, Vec<Vec<f64>>, Range<usize>) {
    let levels: BTreeSet<&String> = model.condition.iter().filter(|name| **name != model.reference).collect();
    let mut names = vec!["(intercept)".to_owned()];
    let mut columns = vec![vec![1.0; model.response.len()]];
    for level in levels {
        names.push(level.clone());
        columns.push(model.condition.iter().map(|name| f64::from(u8::from(name == level))).collect());
    }
    let conditions = 1..names.len();
    for (name, values) in &model.covariates {
        names.push(name.clone());
        columns.push(values.clone());
    }
    (names, columns, conditions)
}

fn orthonormal(x: &DMatrix<f64>, names: &[String]) -> Result<(DMatrix<f64>, DMatrix<f64>)> {
    if x.nrows() <= x.ncols() {
        return Err(AnalysisError::TooFew { what: "trials", needed: x.ncols() + 1, found: x.nrows() });
    }
    let (q, r) = x.clone().qr().unpack();
    let dependent = (0..x.ncols()).find(|&at| r[(at, at)].abs() <= DEPENDENT * x.column(at).norm());
    match dependent {
        Some(at) => Err(AnalysisError::DependentColumn { column: names[at].clone() }),
        None => Ok((q, r)),
    }
}

/// Degrees of freedom for estimating the variances.
struct DesignDegrees {
    within: usize,
    between: usize,
}

impl DesignDegrees {
    /// `within`: trials minus the participants and the effects within them. `between`: participants minus the effects
    /// that only differ between them, including the intercept.
    fn of(x: &DMatrix<f64>, r: &DMatrix<f64>, of_row: &[usize], sizes: &[f64]) -> Self {
        let mut means: DMatrix<f64> = DMatrix::zeros(sizes.len(), x.ncols());
        for (row, &participant) in of_row.iter().enumerate() {
            for column in 0..x.ncols() {
                means[(participant, column)] += x[(row, column)] / sizes[participant];
            }
        }
        let centred =
            DMatrix::from_fn(x.nrows(), x.ncols(), |row, column| x[(row, column)] - means[(of_row[row], column)]);
        // Scaled by the part of each column that is independent of earlier ones, so that a small effect within a large
        // column counts.
        let centred =
            DMatrix::from_fn(x.nrows(), x.ncols(), |row, column| centred[(row, column)] / r[(column, column)].abs());
        let explained = rank(centred);
        let trials = x.nrows();
        let participants = sizes.len();
        let within = trials.saturating_sub(participants + explained);
        Self { within, between: participants.saturating_sub(x.ncols() - explained) }
    }

    fn check(&self) -> Result<()> {
        if self.within == 0 {
            return Err(AnalysisError::NotEstimable {
                why: "there are too few trials for the participants and the effects within them",
            });
        }
        if self.between == 0 {
            return Err(AnalysisError::NotEstimable {
                why: "there are too few participants for the effects that differ between them",
            });
        }
        Ok(())
    }
}

/// Returns the number of columns that do not depend on earlier ones.
fn rank(mut columns: DMatrix<f64>) -> usize {
    let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    let mut rank = 0;
    for at in 0..columns.ncols() {
        let length = columns.column(at).norm();
        // Columns are scaled to about one; a smaller length is the rounding error of a column that does not vary within
        // participants.
        if length <= DEPENDENT * lengths[at].max(1.0) {
            continue;
        }
        rank += 1;
        let unit = columns.column(at) / length;
        for later in at + 1..columns.ncols() {
            let along = unit.dot(&columns.column(later));
            columns.column_mut(later).axpy(-along, &unit, 1.0);
        }
    }
    rank
}
