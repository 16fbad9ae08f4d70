//! Collects views while the board is moved, and requests the next one.

use nalgebra::Vector3;
use nima_endoscope::{Checkerboard, Lens};

use crate::{
    BoardSight, CameraCoverage, Region,
    calibrate::{VIEWS, is_blurred, is_same_place},
    plane,
};

/// A board that has moved less between two images is held still, in widths of the image: 1 px of 1280. A moving board
/// is blurred, and with a rolling shutter it is bent.
const STILL: f64 = 0.0008;
/// Number of views requested, and fraction of the image with corners.
const WANTED: usize = VIEWS + 4;
const FRACTION: f64 = 0.75;
/// A tilt counts from the first angle on, degrees; below the second the board counts as flat. Two limits, so that the
/// request does not change back and forth while the board is held near one of them.
const TILTED_DEG: f64 = 15.0;
const FLAT_DEG: f64 = 12.0;
/// Assumed focal length while it is unknown, in widths of the image.
const FOCAL: f64 = 0.8;

/// The side of the board that is nearer to the lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LensSide {
    Left,
    Right,
    Up,
    Down,
}

/// The view that is requested next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewRequest {
    /// Parallel to the lens.
    Flat,
    /// Tilted with this side nearer.
    Tilted(LensSide),
    /// In this part of the image.
    There(Region),
    /// In any other pose.
    Other,
    /// There are enough views.
    Complete,
}

/// Result of an offered view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewOutcome {
    /// Added.
    Taken,
    /// The board is moving.
    Moving,
    /// The image is blurred.
    Blurred,
    /// The board had been in this place before.
    TakenHere,
}

/// Views of a board.
#[derive(Clone, Debug)]
pub struct CameraSession {
    board: Checkerboard,
    size_px: [usize; 2],
    views: Vec<BoardSight>,
    last: Option<BoardSight>,
}

impl CameraSession {
    /// Starts without views, for images of this size.
    pub const fn new(board: Checkerboard, size_px: [usize; 2]) -> Self {
        Self { board, size_px, views: Vec::new(), last: None }
    }

    pub const fn board(&self) -> &Checkerboard {
        &self.board
    }

    /// Returns the size of the images, px.
    pub const fn size_px(&self) -> [usize; 2] {
        self.size_px
    }

    /// Returns the views added so far.
    pub fn views(&self) -> &[BoardSight] {
        &self.views
    }

    /// Offers the board of another image; the view is added if the board is held still in a new place.
    pub fn offer(&mut self, sight: BoardSight) -> ViewOutcome {
        let width = self.size_px[0];
        let before = self.last.replace(sight.clone());
        if sight.corners_px.len() != self.board.count() {
            return ViewOutcome::Moving;
        }
        if !before.is_some_and(|before| before.mean_move_px(&sight) < STILL * width as f64) {
            return ViewOutcome::Moving;
        }
        if is_blurred(sight.blur_px, width) {
            return ViewOutcome::Blurred;
        }
        if self.views.iter().any(|view| is_same_place(view, &sight, width)) {
            return ViewOutcome::TakenHere;
        }
        self.views.push(sight);
        ViewOutcome::Taken
    }

    /// Called if there is no board in the image.
    pub fn miss(&mut self) {
        self.last = None;
    }

    pub fn undo(&mut self) {
        self.views.pop();
    }

    /// Returns the positions of corners so far.
    pub fn coverage(&self) -> CameraCoverage {
        let mut all = CameraCoverage::default();
        for view in &self.views {
            all.add(&view.coverage);
        }
        all
    }

    /// Returns the view that is requested next.
    pub fn asks(&self) -> ViewRequest {
        let tilts = self.tilts_deg();
        if !tilts.iter().any(|[x, y]| x.hypot(*y) < FLAT_DEG) {
            return ViewRequest::Flat;
        }
        let tilted = |way: LensSide| match way {
            LensSide::Left => tilts.iter().any(|[x, _]| *x < -TILTED_DEG),
            LensSide::Right => tilts.iter().any(|[x, _]| *x > TILTED_DEG),
            LensSide::Up => tilts.iter().any(|[_, y]| *y < -TILTED_DEG),
            LensSide::Down => tilts.iter().any(|[_, y]| *y > TILTED_DEG),
        };
        let missing =
            [LensSide::Left, LensSide::Right, LensSide::Up, LensSide::Down].into_iter().find(|way| !tilted(*way));
        if let Some(way) = missing {
            return ViewRequest::Tilted(way);
        }
        let coverage = self.coverage();
        match coverage.emptiest().filter(|_| coverage.fraction() < FRACTION) {
            Some(region) => ViewRequest::There(region),
            None if self.views.len() < WANTED => ViewRequest::Other,
            None => ViewRequest::Complete,
        }
    }

    /// Returns the completed fraction, 0 to 1.
    pub fn fraction(&self) -> f64 {
        if self.asks() == ViewRequest::Complete {
            return 1.0;
        }
        let views = (self.views.len() as f64 / WANTED as f64).min(1.0);
        let seen = (self.coverage().fraction() / FRACTION).min(1.0);
        (0.5 * (views + seen)).min(0.99)
    }

    /// Returns the tilts of each view about the vertical and the horizontal axis: positive if the right-hand or the
    /// lower side is nearer. Assumes a typical lens.
    fn tilts_deg(&self) -> Vec<[f64; 2]> {
        let lens = Lens::simple(self.size_px, FOCAL * self.size_px[0] as f64, 0.0);
        let places_m = self.board.places_m();
        let tilt = |view: &BoardSight| {
            let pose = plane::pose(&lens, &places_m, &view.corners_px)?;
            let normal = pose.rotation * Vector3::z();
            Some([normal.x.atan2(normal.z), normal.y.atan2(normal.z)].map(f64::to_degrees))
        };
        self.views.iter().filter_map(tilt).collect()
    }
}
