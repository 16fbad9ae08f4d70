//! Finds the poses that agree with each other, so that one or two poses in which the tool was touched do not spoil the
//! fit.
//!
//! The least quantile of residuals over small random sets (Rousseeuw 1984) gives a start that a minority of bad poses
//! cannot affect. Then poses beyond a multiple of the agreeing poses' deviation are left out, until the set no longer
//! changes.

use super::{pose::GravityRow, solve::scaled_rotation};
use nalgebra::Vector3;

/// Fraction of the poses that must agree.
const AGREEING_FRACTION: f64 = 0.7;
/// Poses in one random set: fifteen equations for seven unknowns.
const SET: usize = 5;
/// Number of random sets: with 30 % bad poses, all of them contain a bad pose once in 1700 cases.
const SETS: usize = 40;
/// With fewer poses, it cannot be determined which of them is wrong: a random set of five must leave some for the
/// evaluation.
const MIN_POSES: usize = 8;
/// Number of standard deviations beyond which a pose is an outlier: 1 in 900 by chance for three axes.
const DEVIATIONS: f64 = 4.0;
/// Median length of a vector of three standard normal numbers: the root of the median 2.366 of chi-squared with three
/// degrees of freedom, so that the median error gives the standard deviation per axis.
const MEDIAN_LENGTH: f64 = 1.538;
/// A fixed seed: the same poses give the same result.
const SEED: u64 = 0x6772_6176;

/// Returns the indices of the rows that agree, in increasing order. A residual below `floor_n` (N) is never an outlier.
pub(super) fn agreeing(rows: &[GravityRow], floor_n: f64) -> Vec<usize> {
    let all: Vec<usize> = (0..rows.len()).collect();
    if rows.len() < MIN_POSES {
        return all;
    }
    let min = (AGREEING_FRACTION * rows.len() as f64).ceil() as usize;
    // Without any solvable set all poses are used, and the verdict judges them.
    let Some(mut chosen) = start(rows, min) else { return all };
    // The chosen poses usually repeat after a few rounds; the limit is for two sets that alternate.
    for _ in 0..20 {
        let Some(residuals) = residuals(rows, &chosen) else { return all };
        let (order, sorted) = ranked(&residuals);
        // The correction for small samples is from Rousseeuw and Leroy (1987).
        let spread = sorted[rows.len() / 2] / MEDIAN_LENGTH * (1.0 + 5.0 / (rows.len() as f64 - 2.0));
        let limit = (DEVIATIONS * spread).max(floor_n);
        // Never fewer than the fraction that must agree, so that a wrong start cannot shrink the set.
        let count = sorted.partition_point(|&r| r <= limit).max(min);
        let mut next = order[..count].to_vec();
        next.sort_unstable();
        if next == chosen {
            break;
        }
        chosen = next;
    }
    chosen
}

/// Returns the `min` best rows of the random set whose `min`-th residual is the smallest.
fn start(rows: &[GravityRow], min: usize) -> Option<Vec<usize>> {
    let mut rng = fastrand::Rng::with_seed(SEED);
    let mut best: Option<(f64, Vec<usize>)> = None;
    for _ in 0..SETS {
        let set = rng.choose_multiple(0..rows.len(), SET);
        let Some(residuals) = residuals(rows, &set) else { continue };
        let (order, sorted) = ranked(&residuals);
        // The residual at the required fraction decides; the poses beyond it may be wrong.
        if best.as_ref().is_none_or(|(score, _)| sorted[min - 1] < *score) {
            best = Some((sorted[min - 1], order[..min].to_vec()));
        }
    }
    let mut chosen = best?.1;
    chosen.sort_unstable();
    Some(chosen)
}

/// Returns the length of every row's force residual (N) under the physical model of the chosen rows.
fn residuals(rows: &[GravityRow], chosen: &[usize]) -> Option<Vec<f64>> {
    let subset: Vec<GravityRow> = chosen.iter().map(|&i| rows[i]).collect();
    let (mass_kg, s1_from_source) = scaled_rotation(&subset)?;
    let gain = s1_from_source.matrix() * mass_kg;
    let fraction = 1.0 / subset.len() as f64;
    let bias: Vector3<f64> = subset.iter().map(|row| (row.wrench.force_n - gain * row.field_m_s2) * fraction).sum();
    Some(rows.iter().map(|row| (row.wrench.force_n - gain * row.field_m_s2 - bias).norm()).collect())
}

fn ranked(residuals: &[f64]) -> (Vec<usize>, Vec<f64>) {
    let mut order: Vec<usize> = (0..residuals.len()).collect();
    order.sort_by(|&i, &j| residuals[i].total_cmp(&residuals[j]));
    let sorted = order.iter().map(|&i| residuals[i]).collect();
    (order, sorted)
}
