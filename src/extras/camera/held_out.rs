//! Prediction error of a lens on views that were not used for its fit.

use nima_endoscope::Lens;

use crate::{
    fit::{CameraFit, FitCorners, Terms, refined_pose},
    plane,
};

/// Number of parts into which the views are divided; each is held out once. With the eight views of the minimum, six
/// remain for each fit.
const FOLDS: usize = 4;
const STEPS: usize = 12;

/// Errors of held-out corners, px.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldOut {
    pub(crate) rms_px: f64,
    pub(crate) max_px: f64,
}

/// Holds out views in turn. In a held-out view, every second corner determines the board's pose, and the others are
/// compared.
pub(crate) fn held_out(fit: &CameraFit, views: &[FitCorners], terms: Terms) -> Option<HeldOut> {
    let mut squares = Vec::new();
    for fold in 0..FOLDS {
        let is_out = |at: usize| at % FOLDS == fold;
        let kept: Vec<usize> = (0..views.len()).filter(|at| !is_out(*at)).collect();
        let of: Vec<FitCorners> = kept.iter().map(|at| views[*at].clone()).collect();
        let begin = CameraFit { lens: fit.lens, poses: kept.iter().map(|at| fit.poses[*at]).collect() };
        let lens = begin.refined(&of, terms, STEPS)?.lens;
        for at in (0..views.len()).filter(|at| is_out(*at)) {
            squares.extend(predicted(&lens, &views[at])?);
        }
    }
    if squares.is_empty() {
        return None;
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    let max = squares.iter().copied().fold(0.0, f64::max);
    Some(HeldOut { rms_px: mean.sqrt(), max_px: max.sqrt() })
}

fn predicted(lens: &Lens, view: &FitCorners) -> Option<Vec<f64>> {
    let half = |odd: usize| {
        let pairs = view.places_m.iter().zip(&view.seen_px).enumerate().filter(|(at, _)| at % 2 == odd);
        let (places_m, seen_px) = pairs.map(|(_, (place, seen))| (*place, *seen)).unzip();
        FitCorners { places_m, seen_px }
    };
    let used = half(0);
    let compared = half(1);
    let first = plane::pose(lens, &used.places_m, &used.seen_px)?;
    compared.squares(lens, &refined_pose(lens, &used, first, STEPS)?)
}
