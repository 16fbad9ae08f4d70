//! The step of the touched corners: the board at rest, its corners one after another, and the camera's pose from them.

use nima_camera::{BoardSight, CameraPlacement, CameraSession, TouchedCorner, place};
use nima_core::calibration::Verdict;

use super::{CameraWizard, tip::EndoscopeMarker};
use crate::extras::camera::camera_calibration::FoundPlace;

/// A board farther than this from its earlier position has moved, px of an image 1280 wide.
const MOVED_PX: f64 = 3.0;

impl CameraWizard {
    /// Checks that the board is at rest before it is touched: it must be seen twice at the same position; a later sight
    /// elsewhere means that it has moved.
    pub(super) fn lie(&mut self, sight: &BoardSight) {
        let limit_px = MOVED_PX * sight_width(self.session.as_ref()) / 1280.0;
        match &self.base {
            Some(base) => self.moved |= !self.touches.is_empty() && base.mean_move_px(sight) > limit_px,
            None if self.lying.as_ref().is_some_and(|lying| lying.mean_move_px(sight) < 0.3 * limit_px) => {
                self.base = Some(sight.clone());
            }
            None => self.lying = Some(sight.clone()),
        }
        if self.touches.is_empty() && self.base.as_ref().is_some_and(|base| base.mean_move_px(sight) > limit_px) {
            self.base = None;
            self.lying = Some(sight.clone());
            self.marker = EndoscopeMarker::default();
        }
    }

    /// Returns the outermost corners and one in the middle, in this order.
    pub(super) fn wanted(&self) -> Vec<[usize; 2]> {
        let Ok(board) = self.board() else { return Vec::new() };
        let [right, low] = board.corners().map(|side| side - 1);
        vec![[0, 0], [right, 0], [right, low], [0, low], [right / 2, low / 2]]
    }

    /// Returns the number of the next corner to touch.
    pub(super) fn next_corner(&self) -> Option<usize> {
        self.base.as_ref()?;
        let corner = *self.wanted().get(self.touches.len())?;
        Some(self.board().ok()?.index(corner))
    }

    pub(super) fn take_touch(&mut self) {
        let (Some(tip_m), Some(corner)) = (self.tip.still_m(), self.wanted().get(self.touches.len()).copied()) else {
            return;
        };
        self.touches.push(TouchedCorner { corner, tip_m });
        self.find_place();
    }

    pub(super) fn find_place(&mut self) {
        self.pending = None;
        self.frame.saved = None;
        let found = self.board().ok().zip(self.lens()).zip(self.base.as_ref());
        self.placed = found
            .filter(|_| !self.touches.is_empty())
            .map(|((board, lens), base)| place(&board, &lens, base, &self.touches));
    }

    /// The board was moved: the touched corners are discarded.
    pub(super) fn lay_anew(&mut self) {
        self.base = None;
        self.lying = None;
        self.moved = false;
        self.marker = EndoscopeMarker::default();
        self.touches.clear();
        self.find_place();
    }

    /// Returns the pose to save: on the endoscope's marker, if the tracker saw it while the board was at rest.
    pub(super) fn found_place(&self) -> Option<FoundPlace> {
        let placed = self.good_place()?;
        let world_from_camera = placed.world_from_camera;
        let checked_px = placed.held_out_px;
        let on_marker = self.marker.world_from_n().map(|world_from_n| world_from_n.inverse() * world_from_camera);
        Some(FoundPlace { pose: on_marker.unwrap_or(world_from_camera), on_marker: on_marker.is_some(), checked_px })
    }

    pub(super) fn good_place(&self) -> Option<&CameraPlacement> {
        let placed = self.placed.as_ref()?.as_ref().ok()?;
        (placed.verdict() == Verdict::Accepted && !self.moved).then_some(placed)
    }
}

fn sight_width(session: Option<&CameraSession>) -> f64 {
    session.map_or(1280.0, |session| session.size_px()[0] as f64)
}
