//! Mean and standard deviation of columns, computed from the training data alone.

/// Per column: the mean to subtract and the factor to multiply with.
///
/// ```
/// use nima_core::tip_force::Normalisation;
///
/// let values = [1.0, 5.0, 3.0, 5.0];
/// let normal = Normalisation::of(&values, 2, 0..2);
/// let mut row = [3.0, 5.0];
/// normal.apply(&mut row);
/// assert_eq!(row, [1.0, 0.0], "one standard deviation above the mean; a constant column has no effect");
/// normal.undo(&mut row);
/// assert_eq!(row, [3.0, 5.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Normalisation {
    pub mean: Vec<f32>,
    /// One over the standard deviation; zero for a constant column, which therefore has no effect.
    pub inverse_sd: Vec<f32>,
}

impl Normalisation {
    /// Computes the normalisation of `rows` of a matrix with `width` columns, stored row by row.
    pub fn of(values: &[f32], width: usize, rows: impl Iterator<Item = usize> + Clone) -> Self {
        let count = rows.clone().count().max(1) as f64;
        let mut mean = vec![0.0_f64; width];
        let mut variance = vec![0.0_f64; width];
        // Two passes: the difference of sums of squares would lose its digits for a large mean.
        for row in rows.clone() {
            for (mean, value) in mean.iter_mut().zip(&values[row * width..]) {
                *mean += f64::from(*value) / count;
            }
        }
        for row in rows {
            for ((variance, mean), value) in variance.iter_mut().zip(&mean).zip(&values[row * width..]) {
                let off = f64::from(*value) - mean;
                *variance += off * off / count;
            }
        }
        let inverse = |(variance, mean): (&f64, &f64)| {
            // A standard deviation below the precision of f32 is only rounding error.
            let sd = variance.sqrt();
            if sd > 1e-6 * mean.abs() && sd > 1e-30 { (1.0 / sd) as f32 } else { 0.0 }
        };
        let inverse_sd = variance.iter().zip(&mean).map(inverse).collect();
        Self { mean: mean.into_iter().map(|mean| mean as f32).collect(), inverse_sd }
    }

    /// Returns the columns that never change.
    pub fn constant(&self) -> impl Iterator<Item = usize> {
        self.inverse_sd.iter().enumerate().filter(|(_, inverse)| **inverse == 0.0).map(|(column, _)| column)
    }

    /// Normalises in place.
    pub fn apply(&self, row: &mut [f32]) {
        for ((value, mean), inverse) in row.iter_mut().zip(&self.mean).zip(&self.inverse_sd) {
            *value = (*value - mean) * inverse;
        }
    }

    /// Reverts the normalisation in place; a constant column becomes its mean.
    pub fn undo(&self, row: &mut [f32]) {
        for ((value, mean), inverse) in row.iter_mut().zip(&self.mean).zip(&self.inverse_sd) {
            // The inverse of zero is not defined; the mean is the only value that such a column had.
            *value = if *inverse > 0.0 { *value / inverse } else { 0.0 } + mean;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_get_mean_zero_and_spread_one_and_come_back() {
        let values: Vec<f32> = (0..100).flat_map(|k| [k as f32, 1e4 + (k % 2) as f32, 7.0]).collect();
        let normal = Normalisation::of(&values, 3, 0..100);
        assert_eq!(normal.constant().collect::<Vec<_>>(), [2]);
        let mut sums = [0.0_f64; 3];
        for row in values.chunks(3) {
            let mut now = [row[0], row[1], row[2]];
            normal.apply(&mut now);
            sums.iter_mut().zip(now).for_each(|(sum, x)| *sum += f64::from(x).powi(2) / 100.0);
            normal.undo(&mut now);
            assert!(now.iter().zip(row).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs().max(10.0)), "{now:?} {row:?}");
        }
        assert!((sums[0] - 1.0).abs() < 1e-4 && (sums[1] - 1.0).abs() < 1e-2 && sums[2] == 0.0, "{sums:?}");
    }

    #[test]
    fn only_the_named_rows_count() {
        let normal = Normalisation::of(&[1.0, 3.0, 1000.0], 1, 0..2);
        assert_eq!((normal.mean[0], normal.inverse_sd[0]), (2.0, 1.0));
    }
}
