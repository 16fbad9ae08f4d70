//! Computes a lens from views of a board.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use nima_endoscope::{Bend, Checkerboard, Lens};

use crate::{
    BoardSight, CameraCause, CameraCoverage, Deviations, LeftOut, LensReport, Terms,
    detect::median,
    fit::{CameraFit, FitCorners, FitParameters},
    held_out::{HeldOut, held_out},
    plane,
    report::CalibratedLens,
};

pub type BoardView = BoardSight;

/// Minimum number of usable views. Each view adds six unknowns, and a few views leave focal length and distance
/// undetermined together.
pub(crate) const VIEWS: usize = 8;
/// Maximum blur of a sharp view, in widths of the image: 3.2 px of 1280. As a fraction of the width, so that one limit
/// serves every camera.
const BLUR: f64 = 0.0025;
/// Mean motion below which a board counts as being in the same place, in widths of the image. Two views from one place
/// add no information but count twice.
const SAME: f64 = 0.006;
/// Minimum angle between the boards of two views, and minimum spread of the tilt in any direction, degrees. Boards that
/// are parallel to each other cannot separate focal length and distance (Zhang 2000).
const TILT_DEG: f64 = 25.0;
const SPREAD_DEG: f64 = 6.0;
/// Minimum fraction of the image with corners. The distortion is largest at the edges, where a fit without corners
/// extrapolates.
const COVERAGE: f64 = 0.6;
/// Maximum error on held-out views, in widths of the image: 0.64 px of 1280.
const HELD_OUT: f64 = 0.0005;
/// Maximum standard deviations of the focal length, relative to it, and of the centre, in widths of the image.
const FOCAL_FRACTION: f64 = 0.002;
const CENTRE: f64 = 0.002;
/// A view whose error exceeds this multiple of the median is an outlier if it also exceeds this error, px. The second
/// condition keeps good views of a sharp camera, whose median error is tiny.
const OUTLIER: f64 = 3.0;
const OUTLIER_PX: f64 = 0.4;
/// Initial focal lengths, in widths of the image, and distortions. From a wide to a narrow lens: the fit converges from
/// the nearest of them.
const FOCALS: [f64; 5] = [0.5, 0.75, 1.1, 1.6, 2.4];
const BENDS: [f64; 3] = [-0.3, 0.0, 0.3];
/// Number of views and steps of a first try, and steps of a whole fit.
const FIRST_VIEWS: usize = 8;
const FIRST_STEPS: usize = 12;
const STEPS: usize = 60;
/// A term is kept only if it reduces the error on held-out views by this fraction. A term that does not help on other
/// views fits the noise of these.
const PAYS: f64 = 0.01;

/// Returns whether a view is too blurred for an image of this width, px.
pub(crate) fn is_blurred(blur_px: f64, width_px: usize) -> bool {
    let is_sharp = blur_px <= BLUR * width_px as f64;
    !is_sharp
}

/// Returns whether the board is at the same place in both views.
pub(crate) fn is_same_place(one: &BoardSight, other: &BoardSight, width_px: usize) -> bool {
    one.mean_move_px(other) < SAME * width_px as f64
}

/// Returns the lens that fits these views of a board, and whether it may be used. Unsuitable sets of views are refused
/// with their cause.
pub fn calibrate(board: &Checkerboard, size_px: [usize; 2], views: &[BoardView]) -> LensReport {
    let (mut used, mut left_out) = sorted_out(board, size_px, views);
    let cause = too_few(&used, &left_out, views.len());
    let report = |lens, used: &[usize], left_out: &[_], cause| {
        let mut coverage = CameraCoverage::default();
        for at in used {
            coverage.add(&views[*at].coverage);
        }
        LensReport { lens, used: used.to_vec(), left_out: left_out.to_vec(), coverage, cause }
    };
    if cause.is_some() {
        return report(None, &used, &left_out, cause);
    }
    let corners = |used: &[usize]| used.iter().map(|at| of_view(board, &views[*at])).collect::<Vec<_>>();
    let terms = Terms::default();
    let fit = first(size_px, &corners(&used)).and_then(|first| first.refined(&corners(&used), terms, STEPS));
    let Some(mut fit) = fit else { return report(None, &used, &left_out, Some(CameraCause::NoFit)) };
    let outliers = outliers(&fit, &corners(&used));
    if !outliers.is_empty() && used.len() - outliers.len() >= VIEWS {
        for at in outliers.into_iter().rev() {
            left_out.push((used.remove(at), LeftOut::Outlier));
            fit.poses.remove(at);
        }
        left_out.sort_by_key(|(at, _)| *at);
        let again = fit.refined(&corners(&used), terms, STEPS);
        let Some(again) = again else { return report(None, &used, &left_out, Some(CameraCause::NoFit)) };
        fit = again;
    }
    let Some(found) = chosen(&fit, &corners(&used)) else {
        return report(None, &used, &left_out, Some(CameraCause::NoFit));
    };
    let mut report = report(Some(found.0), &used, &left_out, None);
    report.cause = judged(&found.0, &found.1, report.coverage.fraction());
    report
}

pub(crate) fn of_view(board: &Checkerboard, view: &BoardView) -> FitCorners {
    FitCorners { places_m: board.places_m(), seen_px: view.corners_px.clone() }
}

/// Separates the usable views from the others.
fn sorted_out(
    board: &Checkerboard,
    [width, _]: [usize; 2],
    views: &[BoardView],
) -> (Vec<usize>, Vec<(usize, LeftOut)>) {
    let mut used = Vec::new();
    let mut left_out = Vec::new();
    for (at, view) in views.iter().enumerate() {
        let is_whole = view.corners_px.len() == board.count();
        if !is_whole {
            left_out.push((at, LeftOut::Outlier));
        } else if is_blurred(view.blur_px, width) {
            left_out.push((at, LeftOut::Blurred));
        } else if used.iter().any(|other: &usize| is_same_place(view, &views[*other], width)) {
            left_out.push((at, LeftOut::Repeated));
        } else {
            used.push(at);
        }
    }
    (used, left_out)
}

fn too_few(used: &[usize], left_out: &[(usize, LeftOut)], of: usize) -> Option<CameraCause> {
    let count = |wanted: LeftOut| left_out.iter().filter(|(_, why)| *why == wanted).count();
    let blurred = count(LeftOut::Blurred);
    let repeated = count(LeftOut::Repeated);
    let missing = VIEWS.saturating_sub(used.len());
    (missing > 0).then_some(if blurred >= missing && blurred >= repeated {
        CameraCause::Blurred { blurred, of }
    } else if repeated >= missing {
        CameraCause::Repeated { repeated, of }
    } else {
        CameraCause::TooFew { used: used.len(), needed: VIEWS }
    })
}

/// Returns an initial lens: the focal length and distortion, out of several, that fit some views best after a few
/// steps.
fn first(size_px: [usize; 2], corners: &[FitCorners]) -> Option<CameraFit> {
    let width = size_px[0] as f64;
    let step = corners.len().div_ceil(FIRST_VIEWS).max(1);
    let some: Vec<FitCorners> = corners.iter().step_by(step).cloned().collect();
    let middle = Vector2::from(size_px.map(|side| 0.5 * side as f64));
    let homographies = some.iter().filter_map(|view| {
        let plane: Vec<_> = view.places_m.iter().map(Vector3::xy).collect();
        let seen: Vec<_> = view.seen_px.iter().map(|place| (place - middle) / width).collect();
        plane::homography(&plane, &seen)
    });
    let zhang = plane::focal(&homographies.collect::<Vec<_>>());
    let focals = FOCALS.into_iter().chain(zhang.filter(|focal| (0.2..10.0).contains(focal)));
    let starts = focals.flat_map(|focal| BENDS.map(|k1| Lens::simple(size_px, focal * width, k1)));
    let tried = starts.filter_map(|lens| {
        let fit = posed(lens, &some)?.refined(&some, Terms::default(), FIRST_STEPS)?;
        Some((fit.rms_px(&some)?, fit.lens)).filter(|(rms_px, lens)| rms_px.is_finite() && is_possible(lens))
    });
    let (_, lens) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    posed(lens, corners)
}

fn is_possible(lens: &Lens) -> bool {
    let width = lens.size_px[0] as f64;
    (0.1 * width..20.0 * width).contains(&lens.focal_px.x)
}

/// Adds the pose of each view.
fn posed(lens: Lens, corners: &[FitCorners]) -> Option<CameraFit> {
    let poses = corners.iter().map(|view| plane::pose(&lens, &view.places_m, &view.seen_px));
    Some(CameraFit { lens, poses: poses.collect::<Option<_>>()? })
}

fn outliers(fit: &CameraFit, corners: &[FitCorners]) -> Vec<usize> {
    let mean = |(view, pose): (&FitCorners, _)| {
        view.square(&fit.lens, pose).map_or(f64::INFINITY, |square| (square / view.seen_px.len() as f64).sqrt())
    };
    let errors: Vec<f64> = corners.iter().zip(&fit.poses).map(mean).collect();
    let limit_px = (OUTLIER * median(errors.clone()).unwrap_or_default()).max(OUTLIER_PX);
    (0..errors.len()).filter(|at| errors[*at] > limit_px).collect()
}

/// Returns the lens with the terms that improve it, and the directions of the boards.
fn chosen(base: &CameraFit, corners: &[FitCorners]) -> Option<(CalibratedLens, Vec<Vector3<f64>>)> {
    let mut terms = Terms::default();
    let mut best: (HeldOut, CameraFit) = (held_out(base, corners, terms)?, base.clone());
    loop {
        let more = [Terms { aspect: true, ..terms }, Terms { k2: true, ..terms }, Terms { tangential: true, ..terms }];
        let tried = more.into_iter().filter(|more| *more != terms).filter_map(|more| {
            let fit = best.1.clone().refined(corners, more, STEPS)?;
            Some((held_out(&fit, corners, more)?, fit, more))
        });
        let next = tried.min_by(|a, b| a.0.rms_px.total_cmp(&b.0.rms_px));
        let Some((error, fit, more)) = next.filter(|next| next.0.rms_px < (1.0 - PAYS) * best.0.rms_px) else { break };
        best = (error, fit);
        terms = more;
    }
    let (HeldOut { rms_px, max_px }, fit) = best;
    let deviations = spread_out(&fit.deviations(corners, terms)?);
    let normals: Vec<Vector3<f64>> = fit.poses.iter().map(|pose| pose.rotation * Vector3::z()).collect();
    let found = CalibratedLens {
        lens: fit.lens,
        terms,
        deviations,
        fitted_px: fit.rms_px(corners)?,
        held_out_px: rms_px,
        held_out_max_px: max_px,
        tilt_deg: max_angle_deg(&normals),
    };
    Some((found, normals))
}

fn spread_out(sd: &FitParameters) -> Deviations {
    Deviations {
        focal_px: Vector2::new(sd[0], sd[1]),
        centre_px: Vector2::new(sd[2], sd[3]),
        bend: Bend { k1: sd[4], k2: sd[5], p1: sd[6], p2: sd[7] },
    }
}

fn max_angle_deg(normals: &[Vector3<f64>]) -> f64 {
    let pairs =
        normals.iter().enumerate().flat_map(|(at, one)| normals[..at].iter().map(move |other| one.angle(other)));
    pairs.fold(0.0, f64::max).to_degrees()
}

/// Returns the standard deviation of the tilt in the direction in which it varies least, degrees.
fn min_spread_deg(normals: &[Vector3<f64>]) -> f64 {
    let tilts: Vec<Vector2<f64>> =
        normals.iter().map(|normal| Vector2::new(normal.x.atan2(normal.z), normal.y.atan2(normal.z))).collect();
    let count = tilts.len().max(1) as f64;
    let mean = tilts.iter().sum::<Vector2<f64>>() / count;
    let square = tilts.iter().map(|tilt| (tilt - mean) * (tilt - mean).transpose()).sum::<Matrix2<f64>>() / count;
    SymmetricEigen::new(square).eigenvalues.min().max(0.0).sqrt().to_degrees()
}

/// Returns the first deficiency of the calibration, if there is one.
fn judged(found: &CalibratedLens, normals: &[Vector3<f64>], fraction: f64) -> Option<CameraCause> {
    let width = found.lens.size_px[0] as f64;
    let spread_deg = min_spread_deg(normals);
    let focal = found.deviations.focal_px.component_div(&found.lens.focal_px).max();
    let centre_px = found.deviations.centre_px.max();
    if found.tilt_deg < TILT_DEG {
        return Some(CameraCause::Parallel { max_deg: found.tilt_deg });
    }
    if spread_deg < SPREAD_DEG {
        return Some(CameraCause::OneWay { spread_deg });
    }
    if !is_possible(&found.lens) {
        return Some(CameraCause::NoFit);
    }
    if fraction < COVERAGE {
        return Some(CameraCause::Coverage { fraction });
    }
    let max_px = HELD_OUT * width;
    let is_predicted = found.held_out_px <= max_px;
    if !is_predicted {
        return Some(CameraCause::HeldOut { rms_px: found.held_out_px, max_px });
    }
    let certain = focal <= FOCAL_FRACTION && centre_px <= CENTRE * width;
    (!certain).then_some(CameraCause::Uncertain { focal_percent: focal * 100.0, centre_px })
}
