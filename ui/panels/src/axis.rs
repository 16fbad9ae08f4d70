//! Marks and numbers on the axes of a plot.

use std::ops::RangeInclusive;

use egui_plot::{GridInput, GridMark};

/// Returns the marks at round values over the range of an axis, at least `apart` points apart, so that the numbers are
/// readable however small the plot is.
pub(super) fn marks(grid: &GridInput, apart: f64) -> Vec<GridMark> {
    let (low, high) = grid.bounds;
    // egui_plot's base step is 8 points long.
    let min = (grid.base_step_size * apart / 8.0).max((high - low) / 12.0);
    if !min.is_finite() || min <= 0.0 {
        return Vec::new();
    }
    let decade = 10f64.powf(min.log10().floor());
    let step_size = [1.0, 2.0, 5.0, 10.0].map(|x| x * decade).into_iter().find(|&step| step >= min).unwrap_or(min);
    let first = (low / step_size).ceil() as i64;
    (first..=first + 12)
        .map(|i| GridMark { value: i as f64 * step_size, step_size })
        .take_while(|mark| mark.value <= high)
        .collect()
}

/// Returns whether a value is at the end of the axis, where its number would overlap the next plot.
pub(super) fn near_end(value: f64, shown: &RangeInclusive<f64>) -> bool {
    let margin = 0.07 * (shown.end() - shown.start());
    value < shown.start() + margin || value > shown.end() - margin
}

/// Formats a number with this many decimals and its sign; zero has no sign.
pub(super) fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    let is_zero = text.chars().all(|letter| matches!(letter, '+' | '-' | '0' | '.'));
    if is_zero { text[1..].to_owned() } else { text }
}

/// Returns a number with this many decimals, without trailing zeros.
pub(super) fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_a_few_marks_far_enough_apart() {
        for (low, high) in [(-0.25, 0.25), (-1.0, 0.5), (-0.25, 4.0), (-6.0, 1e3), (-10.0, 0.0)] {
            for points in [64.0, 100.0, 800.0] {
                let grid = GridInput { bounds: (low, high), base_step_size: 8.0 * (high - low) / points };
                let marks = marks(&grid, 18.0);
                assert!((1..=13).contains(&marks.len()), "{low} to {high}: {}", marks.len());
                assert!(marks.iter().all(|mark| mark.step_size * points / (high - low) >= 17.9));
            }
        }
        let nothing = GridInput { bounds: (0.0, f64::NAN), base_step_size: f64::NAN };
        assert!(marks(&nothing, 18.0).is_empty());
    }

    #[test]
    fn a_sign_stands_where_there_is_something() {
        assert_eq!([-0.004, 0.004, 1.0, -0.126].map(|value| signed(value, 2)), ["0.00", "0.00", "+1.00", "-0.13"]);
        assert_eq!([-0.4, 250.4].map(|value| signed(value, 0)), ["0", "+250"]);
    }

    #[test]
    fn axis_numbers_are_plain() {
        assert_eq!([0.0, -0.001, 2.5, -10.0, 0.25].map(|value| plain(value, 2)), ["0", "0", "2.5", "-10", "0.25"]);
        assert_eq!([500.0, 0.0].map(|value| plain(value, 0)), ["500", "0"]);
    }
}
