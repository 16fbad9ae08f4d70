//! The wizard of the endoscope's camera.

use std::path::Path;

use nima_endoscope::Bend;

pub(in crate::console) const NAME: &str = "Camera";
pub(in crate::console) const MEANING: &str =
    "Finds the endoscope's lens and its place, so that forces are drawn where the tip is seen";
pub(in crate::console) const STEP_CHECK_HOVER: &str = "The endoscope's picture, and the board";
pub(in crate::console) const STEP_VIEWS: &str = "Views";
pub(in crate::console) const STEP_VIEWS_HOVER: &str = "Show the board to the camera at different places and tilts";
pub(in crate::console) const STEP_LENS: &str = "Lens";
pub(in crate::console) const STEP_LENS_HOVER: &str = "What was found, and whether it may be used";
pub(in crate::console) const STEP_TOUCH: &str = "Place";
pub(in crate::console) const STEP_TOUCH_HOVER: &str = "Touch corners of the board with the instrument's tip";
pub(in crate::console) const STEP_SAVE_HOVER: &str = "Writes lens and place into the rig file";
pub(in crate::console) const CHECKS_TITLE: &str = "Before you begin";
pub(in crate::console) const CHECKS_HOVER: &str = "What the wizard needs";
pub(in crate::console) const TASK: &str =
    "Focus the endoscope at its working distance, and do not change focus or zoom from now on";
pub(in crate::console) const CHECK_ENDOSCOPE: &str = "Endoscope in the rig file";
pub(in crate::console) const NO_ENDOSCOPE: &str = "add [endoscope] with its url to the rig file";
pub(in crate::console) const CHECK_PICTURE: &str = "Picture";
pub(in crate::console) const NO_PICTURE: &str = "no picture has come; the panel Devices says why";
pub(in crate::console) const BOARD_TITLE: &str = "Board";
pub(in crate::console) const BOARD_HOVER: &str = "A flat checkerboard, seen whole at the working distance";
pub(in crate::console) const CORNERS: &str = "Inner corners";
pub(in crate::console) const CORNERS_HOVER: &str =
    "Where four squares meet, along both sides: one number odd, the other even";
pub(in crate::console) const SQUARE: &str = "Side of a square";
pub(in crate::console) const SQUARE_HOVER: &str = "Measure it on the paper, mm: the camera's place is as right as this";
pub(in crate::console) const PRINT: &str =
    "To print one: nima calibrate board --board 9x6 --square-mm 10 --out board.svg";
pub(in crate::console) const KEEP: &str = "Keep the lens of the rig file, find its place only";
pub(in crate::console) const KEEP_HOVER: &str = "When the endoscope was moved, and neither focus nor zoom was changed";
pub(in crate::console) const LENS_IS_KEPT: &str = "The lens of the rig file is kept";
pub(in crate::console) const VIEWS_TITLE: &str = "Show the board";
pub(in crate::console) const VIEWS_HOVER: &str =
    "A view is taken by itself when the whole board is held still at a new place";
pub(in crate::console) const PROGRESS: &str = "Views";
pub(in crate::console) const REMOVE_LAST: &str = "Remove the last view";
pub(in crate::console) const VIEWS_NOTE: &str =
    "Views are taken by themselves. Any other place is good too. Go on when all are taken.";
pub(in crate::console) const LOOKING: &str = "waiting for a picture";
pub(in crate::console) const SEEN: &str = "the board is seen";
pub(in crate::console) const CALCULATING: &str = "There are no views yet";
pub(in crate::console) const LENS_TITLE: &str = "Lens";
pub(in crate::console) const LENS_HOVER: &str = "The lens that explains the corners of all views best";
pub(in crate::console) const LENS_GOOD: &str = "it predicts views that were left out";
pub(in crate::console) const VIEWS_USED: &str = "Views used";
pub(in crate::console) const VIEWS_USED_HOVER: &str = "Blurred, repeated and contradicting views are left out";
pub(in crate::console) const COVERAGE: &str = "Picture covered";
pub(in crate::console) const COVERAGE_HOVER: &str =
    "Share of the lit picture in which corners were seen; distortion is known there only";
pub(in crate::console) const HELD_OUT: &str = "Held-out error";
pub(in crate::console) const HELD_OUT_MAX: &str = "Largest of these";
pub(in crate::console) const HELD_OUT_HOVER: &str =
    "Distance of corners from where a lens found without their view expects them, px";
pub(in crate::console) const FITTED: &str = "Fitted error";
pub(in crate::console) const FITTED_HOVER: &str =
    "The same for the views from which the lens was found, root mean square, px";
pub(in crate::console) const TILT: &str = "Tilt";
pub(in crate::console) const TILT_HOVER: &str = "Largest angle between the boards of two views";
pub(in crate::console) const FOCAL: &str = "Focal length";
pub(in crate::console) const FOCAL_DOWN: &str = "Focal length down";
pub(in crate::console) const FOCAL_HOVER: &str = "With its standard deviation, px";
pub(in crate::console) const CENTRE: &str = "Centre";
pub(in crate::console) const CENTRE_HOVER: &str =
    "Where the lens's axis meets the picture, from its upper left corner, px";
pub(in crate::console) const BEND: &str = "Distortion";
pub(in crate::console) const BEND_HOVER: &str = "A term that does not pay on held-out views is zero";
pub(in crate::console) const TOUCH_TITLE: &str = "Touch the board";
pub(in crate::console) const TOUCH_HOVER: &str =
    "The touched corners tell where the board lies in the workspace, and so where the camera is";
pub(in crate::console) const LAY_DOWN: &str = "Lay the board down where the tip reaches it, and take your hands away";
pub(in crate::console) const ALL_TOUCHED: &str = "All corners are touched";
pub(in crate::console) const MOVED: &str = "The board or the endoscope has moved: lay it down and touch it again";
pub(in crate::console) const TOUCHED: &str = "Tip is at it";
pub(in crate::console) const TOUCHED_HOVER: &str = "Takes the place of the tip, which must be held still for 0.3 s";
pub(in crate::console) const TOUCHED_DISABLED: &str = "Hold the tip still at the marked corner";
pub(in crate::console) const REMOVE_TOUCH: &str = "Remove the last corner";
pub(in crate::console) const LAY_ANEW: &str = "Lay it anew";
pub(in crate::console) const LAY_ANEW_HOVER: &str = "Forgets what was touched, and waits for the board to lie still";
pub(in crate::console) const TIP_STILL: &str = "the tip is still";
pub(in crate::console) const TIP_MOVES: &str = "the tip moves, or its place is not known";
pub(in crate::console) const PLACE_OPTIONAL: &str =
    "Without this step only the lens is saved, and no forces are drawn into the picture";
pub(in crate::console) const PLACE_GOOD: &str = "tip and picture agree";
pub(in crate::console) const PLACE_HELD_OUT_HOVER: &str =
    "Distance in the picture between a touched point and its corner, by a camera found without it, px";
pub(in crate::console) const RIGID: &str = "Flatness";
pub(in crate::console) const RIGID_HOVER: &str = "Distance of the touched points from a rigid board, root mean square";
pub(in crate::console) const NEEDS_BOARD: &str = "The board cannot be used";
pub(in crate::console) const NEEDS_VIEWS: &str = "At least four views, better all that are asked for";
pub(in crate::console) const NEEDS_LENS: &str = "There is no good lens: go back and take more views";
pub(in crate::console) const NEEDS_PLACE: &str = "There is no good place yet: touch the marked corners";

/// Why there is no such board.
pub(in crate::console) fn no_board(why: &str) -> String {
    format!("No board: {why}")
}

/// Number of views, and how it stands with the present one.
pub(in crate::console) fn views(count: usize, told: &str) -> String {
    format!("{count} taken; {told}")
}

/// The picture in words.
pub(in crate::console) fn picture(told: &str) -> String {
    format!("Endoscope's picture: {told}")
}

/// The map in words.
pub(in crate::console) fn covered(share: f64) -> String {
    format!("{:.0} % of the picture covered", 100.0 * share)
}

/// A view that was not used.
pub(in crate::console) fn left_out(number: usize, why: &str) -> String {
    format!("View {number} is left out: {why}")
}

/// A value with its standard deviation, px.
pub(in crate::console) fn with_deviation(value: f64, sd: f64) -> String {
    format!("{value:.1} ± {sd:.1} px")
}

/// Distortion, with the standard deviation of its first term.
pub(in crate::console) fn bend(bend: &Bend, sd: &Bend) -> String {
    let Bend { k1, k2, p1, p2 } = bend;
    format!("k1 {k1:.4} ± {:.4}, k2 {k2:.4}, p1 {p1:.4}, p2 {p2:.4}", sd.k1)
}

/// What is to be touched.
pub(in crate::console) fn touch(corner: usize) -> String {
    format!("Touch the marked corner with the tip (corner {})", corner + 1)
}

/// How many corners are touched.
pub(in crate::console) fn touched(count: usize, tip: &str) -> String {
    format!("{count} corners touched; {tip}")
}

/// Why it may be saved.
pub(in crate::console) fn proof(lens_px: Option<f64>, place: Option<(f64, bool)>) -> String {
    let lens =
        lens_px.map_or("The lens is that of the rig file".to_owned(), |px| format!("Held-out corners: {px:.2} px"));
    let place = match place {
        None => "the place is not known, no forces are drawn".to_owned(),
        Some((px, true)) => format!("touched corners: {px:.1} px; the place follows the endoscope's marker"),
        Some((px, false)) => format!("touched corners: {px:.1} px; the place holds until the endoscope is moved"),
    };
    format!("{lens}; {place}")
}

/// Where it was written.
pub(in crate::console) fn written(path: &Path) -> String {
    format!("Saved in {}", path.display())
}
