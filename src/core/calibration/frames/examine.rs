//! Common part of every fit: leave out the rows that contradict the others, and compare each row with a fit to the
//! rest.

/// Distance of a row from a model; `None` for an error that the calibration does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RowMiss {
    pub(super) place_m: Option<f64>,
    pub(super) angle_rad: Option<f64>,
}

impl RowMiss {
    pub(super) const fn of_place(place_m: f64) -> Self {
        Self { place_m: Some(place_m), angle_rad: None }
    }

    pub(super) const fn of_angle(angle_rad: f64) -> Self {
        Self { place_m: None, angle_rad: Some(angle_rad) }
    }
}

pub(super) trait Problem {
    type Row: Copy;
    type Model;
    const HYPOTHESIS: usize;
    /// Errors up to this limit belong to good rows: at least four standard deviations of the expected noise.
    const FLOOR: RowMiss;

    /// Returns the least-squares model; `None` if the rows do not determine a model.
    fn solve(&self, rows: &[Self::Row]) -> Option<Self::Model>;

    /// Returns a fast model that is accurate enough to show which rows agree.
    fn guess(&self, rows: &[Self::Row]) -> Option<Self::Model> {
        self.solve(rows)
    }

    fn miss(&self, model: &Self::Model, row: &Self::Row) -> RowMiss;

    /// Returns the size of an error relative to the floor.
    fn size(&self, model: &Self::Model, row: &Self::Row) -> f64 {
        let miss = self.miss(model, row);
        let part = |miss: Option<f64>, floor: Option<f64>| miss.zip(floor).map_or(0.0, |(miss, floor)| miss / floor);
        let size = part(miss.place_m, Self::FLOOR.place_m).max(part(miss.angle_rad, Self::FLOOR.angle_rad));
        // NaN counts as infinitely wrong, so that it never wins a comparison.
        if size.is_nan() { f64::INFINITY } else { size }
    }
}

#[derive(Debug)]
pub(super) struct ExaminedModel<M> {
    pub(super) model: M,
    /// Indices of the rows that agree, in increasing order, and of the others.
    pub(super) kept: Vec<usize>,
    pub(super) outliers: Vec<usize>,
    pub(super) fitted: Vec<RowMiss>,
    /// Empty if a fold does not determine a model.
    pub(super) held_out: Vec<RowMiss>,
}

impl<M> ExaminedModel<M> {
    /// Returns the sum of the squared position errors of the fit, m^2.
    pub(super) fn squares_m2(&self) -> f64 {
        self.fitted.iter().filter_map(|miss| miss.place_m).map(|miss| miss * miss).sum()
    }

    /// Returns the sum of the squared angle errors of the fit, rad^2.
    pub(super) fn squares_rad2(&self) -> f64 {
        self.fitted.iter().filter_map(|miss| miss.angle_rad).map(|miss| miss * miss).sum()
    }
}

/// Number of random hypotheses: with a quarter of outliers and four rows in each, the probability that all contain one
/// is 2e-7.
const DRAWS: usize = 40;
/// Median length of a 3-D normal vector with a standard deviation of 1 per axis: the root of the median 2.366 of
/// chi-squared with three degrees of freedom, so that the median error gives the standard deviation.
const MEDIAN_OF_LENGTH: f64 = 1.538;
/// A row beyond this many standard deviations is an outlier. This loses one in 900 good rows, because the length of a
/// 3-D normal vector rarely exceeds it.
const CUT: f64 = 4.0;
/// If the median error of the rows exceeds this many floors, they do not fit any model.
const HOPELESS: f64 = 10.0;
/// Up to this number of rows, each is held out individually; above it, every tenth row together.
const LEAVE_ONE_OUT: usize = 20;

/// Fits the rows that agree with each other; returns `None` if no model can be determined.
pub(super) fn examined<P: Problem>(problem: &P, rows: &[P::Row]) -> Option<ExaminedModel<P::Model>> {
    let kept = agreeing(problem, rows)?;
    let outliers = (0..rows.len()).filter(|i| kept.binary_search(i).is_err()).collect();
    let good: Vec<P::Row> = kept.iter().map(|&i| rows[i]).collect();
    let model = problem.solve(&good)?;
    let fitted: Vec<RowMiss> = good.iter().map(|row| problem.miss(&model, row)).collect();
    // Do not refit rows that fit no model: their held-out errors would be just as large.
    let hopeless = median(problem, &model, &good) > HOPELESS;
    let held_out = if hopeless { fitted.clone() } else { held_out(problem, &good).unwrap_or_default() };
    Some(ExaminedModel { model, kept, outliers, fitted, held_out })
}

fn held_out<P: Problem>(problem: &P, rows: &[P::Row]) -> Option<Vec<RowMiss>> {
    let folds = if rows.len() <= LEAVE_ONE_OUT { rows.len() } else { 10 };
    let mut misses = Vec::with_capacity(rows.len());
    for fold in 0..folds {
        // Interleaved: neighbouring poses are similar and would not test each other.
        let (tested, training): (Vec<_>, Vec<_>) = rows.iter().enumerate().partition(|(i, _)| i % folds == fold);
        let training: Vec<P::Row> = training.into_iter().map(|(_, row)| *row).collect();
        let model = problem.solve(&training)?;
        misses.extend(tested.into_iter().map(|(_, row)| problem.miss(&model, row)));
    }
    Some(misses)
}

/// Returns the indices of the rows that agree: all of them if no error exceeds the floor; otherwise those near the
/// hypothesis with the smallest median error (Rousseeuw 1984), refined until nothing changes.
fn agreeing<P: Problem>(problem: &P, rows: &[P::Row]) -> Option<Vec<usize>> {
    let whole = problem.guess(rows)?;
    // All rows fit already, or there are too few to draw others from.
    if rows.iter().all(|row| problem.size(&whole, row) <= 1.0) || rows.len() <= P::HYPOTHESIS {
        return Some((0..rows.len()).collect());
    }
    let mut model = first_guess(problem, rows, whole);
    let mut kept = Vec::new();
    for _ in 0..10 {
        // At least one floor, so that perfect data keep the rows within the noise.
        let cut = (CUT * median(problem, &model, rows) / MEDIAN_OF_LENGTH).max(1.0);
        let near: Vec<usize> = (0..rows.len()).filter(|&i| problem.size(&model, &rows[i]) <= cut).collect();
        if near == kept {
            break;
        }
        let good: Vec<P::Row> = near.iter().map(|&i| rows[i]).collect();
        kept = near;
        match problem.guess(&good) {
            Some(refined) => model = refined,
            None => break,
        }
    }
    Some(kept)
}

fn first_guess<P: Problem>(problem: &P, rows: &[P::Row], whole: P::Model) -> P::Model {
    let mut rng = fastrand::Rng::with_seed(1);
    // The fit of all rows is a hypothesis too.
    let mut best = (median(problem, &whole, rows), whole);
    for _ in 0..DRAWS {
        let few: Vec<P::Row> = rng.choose_multiple(rows.iter().copied(), P::HYPOTHESIS);
        let Some(model) = problem.guess(&few) else { continue };
        let size = median(problem, &model, rows);
        if size < best.0 {
            best = (size, model);
        }
    }
    best.1
}

fn median<P: Problem>(problem: &P, model: &P::Model, rows: &[P::Row]) -> f64 {
    let mut sizes: Vec<f64> = rows.iter().map(|row| problem.size(model, row)).collect();
    if sizes.is_empty() {
        return f64::INFINITY;
    }
    let middle = sizes.len() / 2;
    *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
}
