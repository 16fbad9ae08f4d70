//! The likelihood as a function of the ratio of the variances, with its derivatives.

use super::MixedCriterion;
use super::design::MixedDesign;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Sums required for every ratio. The covariance of the n trials of one participant is `s (1 + ratio 11')`, whose
/// inverse is `(1 - 11'/n) / s` within the participant and `11' / (n (1 + n ratio)) / s` for the mean: summing the two
/// parts separately loses no digits.
pub(super) struct LikelihoodProfile<'a> {
    design: &'a MixedDesign,
    criterion: MixedCriterion,
    /// `Q` and `y` without the participants' means.
    q_within: DMatrix<f64>,
    y_within: DVector<f64>,
    within: DMatrix<f64>,
    within_y: DVector<f64>,
    /// Sums over each participant's trials: participants by columns, and one per participant.
    q_sums: DMatrix<f64>,
    y_sums: DVector<f64>,
}

/// The model at one ratio; all fixed effects are in the columns of `Q`.
pub(super) struct LikelihoodPoint {
    pub(super) ratio: f64,
    pub(super) gamma: DVector<f64>,
    /// `Q' V^-1 Q` in units of the residual variance.
    pub(super) information: Cholesky<f64, Dyn>,
    /// Residual sum of squares in the metric of V.
    pub(super) squares: f64,
    /// `1 + n ratio` of each participant.
    pub(super) inflation: DVector<f64>,
    /// `Q' V^-1 1` of each participant, columns by participants.
    pub(super) u: DMatrix<f64>,
    /// `1' V^-1 e` of each participant.
    pub(super) z: DVector<f64>,
}

impl<'a> LikelihoodProfile<'a> {
    pub(super) fn of(design: &'a MixedDesign, criterion: MixedCriterion) -> Self {
        let columns = design.q.ncols();
        let sums: Vec<DVector<f64>> = (0..columns).map(|column| design.sums(|row| design.q[(row, column)])).collect();
        let q_sums = DMatrix::from_columns(&sums);
        let y_sums = design.sums(|row| design.y[row]);
        let mean = |sum: f64, row: usize| sum / design.sizes[design.of_row[row]];
        let q_within = DMatrix::from_fn(design.rows(), columns, |row, column| {
            design.q[(row, column)] - mean(q_sums[(design.of_row[row], column)], row)
        });
        let y_within = DVector::from_fn(design.rows(), |row, _| design.y[row] - mean(y_sums[design.of_row[row]], row));
        let within = q_within.tr_mul(&q_within);
        let within_y = q_within.tr_mul(&y_within);
        Self { design, criterion, q_within, y_within, within, within_y, q_sums, y_sums }
    }

    /// Returns `None` if the information matrix has no inverse.
    pub(super) fn at(&self, ratio: f64) -> Option<LikelihoodPoint> {
        let inflation =
            DVector::from_iterator(self.design.sizes.len(), self.design.sizes.iter().map(|n| 1.0 + n * ratio));
        let mut information = self.within.clone();
        let mut right = self.within_y.clone();
        for (participant, n) in self.design.sizes.iter().enumerate() {
            let weight = 1.0 / (n * inflation[participant]);
            let row = self.q_sums.row(participant).transpose();
            information.ger(weight, &row, &row, 1.0);
            right.axpy(weight * self.y_sums[participant], &row, 1.0);
        }
        let information = information.cholesky()?;
        let gamma = information.solve(&right);
        let left = &self.y_sums - &self.q_sums * &gamma;
        let between =
            left.iter().zip(inflation.iter()).zip(&self.design.sizes).map(|((sum, by), n)| sum * sum / (n * by));
        let squares = (&self.y_within - &self.q_within * &gamma).norm_squared() + between.sum::<f64>();
        let u = DMatrix::from_fn(gamma.len(), inflation.len(), |column, at| self.q_sums[(at, column)] / inflation[at]);
        let z = left.component_div(&inflation);
        Some(LikelihoodPoint { ratio, gamma, information, squares, inflation, u, z })
    }

    /// Returns the divisor of the residual sum of squares: trials, for REML minus the fixed effects.
    pub(super) fn degrees(&self) -> f64 {
        let taken = if self.criterion == MixedCriterion::Reml { self.design.q.ncols() } else { 0 };
        (self.design.rows() - taken) as f64
    }

    pub(super) fn residual_variance(&self, point: &LikelihoodPoint) -> f64 {
        point.squares / self.degrees()
    }

    /// Returns minus twice the logarithm of the likelihood at its best residual variance and fixed effects.
    pub(super) fn deviance(&self, point: &LikelihoodPoint) -> f64 {
        let variance = self.residual_variance(point);
        let residual = self.degrees() * (1.0 + (std::f64::consts::TAU * variance).ln());
        let participants: f64 = point.inflation.iter().map(|by| by.ln()).sum();
        let fixed = match self.criterion {
            // The determinant of X is used, not of Q, because X includes R.
            MixedCriterion::Reml => {
                let r = (0..self.design.r.ncols()).map(|at| self.design.r[(at, at)].abs().ln()).sum::<f64>();
                let l = point.information.l_dirty();
                2.0 * (r + (0..l.ncols()).map(|at| l[(at, at)].ln()).sum::<f64>())
            }
            MixedCriterion::Ml => 0.0,
        };
        residual + participants + fixed
    }

    /// Returns its derivative with respect to the ratio.
    pub(super) fn slope(&self, point: &LikelihoodPoint) -> f64 {
        let residual = self.degrees() * point.z.norm_squared() / point.squares;
        let own: f64 = self.design.sizes.iter().zip(point.inflation.iter()).map(|(n, by)| n / by).sum();
        match self.criterion {
            MixedCriterion::Reml => own - point.information.solve(&point.u).dot(&point.u) - residual,
            MixedCriterion::Ml => own - residual,
        }
    }

    /// Returns the second derivatives of the deviance with respect to the ratio and the residual variance, before
    /// optimisation: ratio twice, both, variance twice.
    ///
    /// With `P = V^-1 - V^-1 X (X' V^-1 X)^-1 X' V^-1` and `dP = -P ZZ' P`; `m` is `Z' P Z`.
    pub(super) fn curvature(&self, point: &LikelihoodPoint) -> [f64; 3] {
        let own = self.design.sizes.iter().zip(point.inflation.iter()).map(|(n, by)| n / by);
        let own = DMatrix::from_diagonal(&DVector::from_iterator(self.design.sizes.len(), own));
        let m = &own - point.u.tr_mul(&point.information.solve(&point.u));
        let variance = self.residual_variance(point);
        let determinants = if self.criterion == MixedCriterion::Reml { &m } else { &own }.norm_squared();
        let ratio = 2.0 * point.z.dot(&(&m * &point.z)) / variance - determinants;
        [ratio, point.z.norm_squared() / variance.powi(2), self.degrees() / variance.powi(2)]
    }
}
