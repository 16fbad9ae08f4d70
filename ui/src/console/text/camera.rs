//! The wizard of the endoscope's camera.

use std::path::Path;

use nima_endoscope::Bend;

use crate::language::{Text, told, word};

pub(in crate::console) const NAME: Text = Text::of("Camera", "Camera");
pub(in crate::console) const MEANING: Text = Text::of(
    "Finds the endoscope's lens and its place, so that forces are drawn where the tip is seen",
    "Finds the endoscope's lens and its place, so that forces are drawn where the tip is seen",
);
pub(in crate::console) const STEP_CHECK_HOVER: Text =
    Text::of("The endoscope's picture, and the board", "The endoscope's picture, and the board");
pub(in crate::console) const STEP_VIEWS: Text = Text::of("Views", "Views");
pub(in crate::console) const STEP_VIEWS_HOVER: Text = Text::of(
    "Show the board to the camera at different places and tilts",
    "Show the board to the camera at different places and tilts",
);
pub(in crate::console) const STEP_LENS: Text = Text::of("Lens", "Lens");
pub(in crate::console) const STEP_LENS_HOVER: Text =
    Text::of("What was found, and whether it may be used", "What was found, and whether it may be used");
pub(in crate::console) const STEP_TOUCH: Text = Text::of("Place", "Place");
pub(in crate::console) const STEP_TOUCH_HOVER: Text = Text::of(
    "Touch corners of the board with the instrument's tip",
    "Touch corners of the board with the instrument's tip",
);
pub(in crate::console) const STEP_SAVE_HOVER: Text =
    Text::of("Writes lens and place into the rig file", "Writes lens and place into the rig file");
pub(in crate::console) const CHECKS_TITLE: Text = Text::of("Before you begin", "Before you begin");
pub(in crate::console) const CHECKS_HOVER: Text = Text::of("What the wizard needs", "What the wizard needs");
pub(in crate::console) const TASK: Text = Text::of(
    "Focus the endoscope at its working distance, and do not change focus or zoom from now on",
    "Focus the endoscope at its working distance, and do not change focus or zoom from now on",
);
pub(in crate::console) const CHECK_ENDOSCOPE: Text = Text::of("Endoscope in the rig file", "Endoscope in the rig file");
pub(in crate::console) const NO_ENDOSCOPE: Text =
    Text::of("add [endoscope] with its url to the rig file", "add [endoscope] with its url to the rig file");
pub(in crate::console) const CHECK_PICTURE: Text = Text::of("Picture", "Picture");
pub(in crate::console) const NO_PICTURE: Text =
    Text::of("no picture has come; the panel Devices says why", "no picture has come; the panel Devices says why");
pub(in crate::console) const BOARD_TITLE: Text = Text::of("Board", "Board");
pub(in crate::console) const BOARD_HOVER: Text = Text::of(
    "A flat checkerboard, seen whole at the working distance",
    "A flat checkerboard, seen whole at the working distance",
);
pub(in crate::console) const CORNERS: Text = Text::of("Inner corners", "Inner corners");
pub(in crate::console) const CORNERS_HOVER: Text = Text::of(
    "Where four squares meet, along both sides: one number odd, the other even",
    "Where four squares meet, along both sides: one number odd, the other even",
);
pub(in crate::console) const SQUARE: Text = Text::of("Side of a square", "Side of a square");
pub(in crate::console) const SQUARE_HOVER: Text = Text::of(
    "Measure it on the paper, mm: the camera's place is as right as this",
    "Measure it on the paper, mm: the camera's place is as right as this",
);
pub(in crate::console) const PRINT: Text = Text::of(
    "To print one: nima calibrate board --board 9x6 --square-mm 10 --out board.svg",
    "To print one: nima calibrate board --board 9x6 --square-mm 10 --out board.svg",
);
pub(in crate::console) const KEEP: Text = Text::of(
    "Keep the lens of the rig file, find its place only",
    "Keep the lens of the rig file, find its place only",
);
pub(in crate::console) const KEEP_HOVER: Text = Text::of(
    "When the endoscope was moved, and neither focus nor zoom was changed",
    "When the endoscope was moved, and neither focus nor zoom was changed",
);
pub(in crate::console) const LENS_IS_KEPT: Text =
    Text::of("The lens of the rig file is kept", "The lens of the rig file is kept");
pub(in crate::console) const VIEWS_TITLE: Text = Text::of("Show the board", "Show the board");
pub(in crate::console) const VIEWS_HOVER: Text = Text::of(
    "A view is taken by itself when the whole board is held still at a new place",
    "A view is taken by itself when the whole board is held still at a new place",
);
pub(in crate::console) const PROGRESS: Text = Text::of("Views", "Views");
pub(in crate::console) const REMOVE_LAST: Text = Text::of("Remove the last view", "Remove the last view");
pub(in crate::console) const VIEWS_NOTE: Text = Text::of(
    "Views are taken by themselves. Any other place is good too. Go on when all are taken.",
    "Views are taken by themselves. Any other place is good too. Go on when all are taken.",
);
pub(in crate::console) const LOOKING: Text = Text::of("waiting for a picture", "waiting for a picture");
pub(in crate::console) const SEEN: Text = Text::of("the board is seen", "the board is seen");
pub(in crate::console) const CALCULATING: Text = Text::of("There are no views yet", "There are no views yet");
pub(in crate::console) const LENS_TITLE: Text = Text::of("Lens", "Lens");
pub(in crate::console) const LENS_HOVER: Text = Text::of(
    "The lens that explains the corners of all views best",
    "The lens that explains the corners of all views best",
);
pub(in crate::console) const LENS_GOOD: Text =
    Text::of("it predicts views that were left out", "it predicts views that were left out");
pub(in crate::console) const VIEWS_USED: Text = Text::of("Views used", "Views used");
pub(in crate::console) const VIEWS_USED_HOVER: Text = Text::of(
    "Blurred, repeated and contradicting views are left out",
    "Blurred, repeated and contradicting views are left out",
);
pub(in crate::console) const COVERAGE: Text = Text::of("Picture covered", "Picture covered");
pub(in crate::console) const COVERAGE_HOVER: Text = Text::of(
    "Share of the lit picture in which corners were seen; distortion is known there only",
    "Share of the lit picture in which corners were seen; distortion is known there only",
);
pub(in crate::console) const HELD_OUT: Text = Text::of("Held-out error", "Held-out error");
pub(in crate::console) const HELD_OUT_MAX: Text = Text::of("Largest of these", "Largest of these");
pub(in crate::console) const HELD_OUT_HOVER: Text = Text::of(
    "Distance of corners from where a lens found without their view expects them, px",
    "Distance of corners from where a lens found without their view expects them, px",
);
pub(in crate::console) const FITTED: Text = Text::of("Fitted error", "Fitted error");
pub(in crate::console) const FITTED_HOVER: Text = Text::of(
    "The same for the views from which the lens was found, root mean square, px",
    "The same for the views from which the lens was found, root mean square, px",
);
pub(in crate::console) const TILT: Text = Text::of("Tilt", "Tilt");
pub(in crate::console) const TILT_HOVER: Text =
    Text::of("Largest angle between the boards of two views", "Largest angle between the boards of two views");
pub(in crate::console) const FOCAL: Text = Text::of("Focal length", "Focal length");
pub(in crate::console) const FOCAL_DOWN: Text = Text::of("Focal length down", "Focal length down");
pub(in crate::console) const FOCAL_HOVER: Text =
    Text::of("With its standard deviation, px", "With its standard deviation, px");
pub(in crate::console) const CENTRE: Text = Text::of("Centre", "Centre");
pub(in crate::console) const CENTRE_HOVER: Text = Text::of(
    "Where the lens's axis meets the picture, from its upper left corner, px",
    "Where the lens's axis meets the picture, from its upper left corner, px",
);
pub(in crate::console) const BEND: Text = Text::of("Distortion", "Distortion");
pub(in crate::console) const BEND_HOVER: Text = Text::of(
    "A term that does not pay on held-out views is zero",
    "A term that does not pay on held-out views is zero",
);
pub(in crate::console) const TOUCH_TITLE: Text = Text::of("Touch the board", "Touch the board");
pub(in crate::console) const TOUCH_HOVER: Text = Text::of(
    "The touched corners tell where the board lies in the workspace, and so where the camera is",
    "The touched corners tell where the board lies in the workspace, and so where the camera is",
);
pub(in crate::console) const LAY_DOWN: Text = Text::of(
    "Lay the board down where the tip reaches it, and take your hands away",
    "Lay the board down where the tip reaches it, and take your hands away",
);
pub(in crate::console) const ALL_TOUCHED: Text = Text::of("All corners are touched", "All corners are touched");
pub(in crate::console) const MOVED: Text = Text::of(
    "The board or the endoscope has moved: lay it down and touch it again",
    "The board or the endoscope has moved: lay it down and touch it again",
);
pub(in crate::console) const TOUCHED: Text = Text::of("Tip is at it", "Tip is at it");
pub(in crate::console) const TOUCHED_HOVER: Text = Text::of(
    "Takes the place of the tip, which must be held still for 0.3 s",
    "Takes the place of the tip, which must be held still for 0.3 s",
);
pub(in crate::console) const TOUCHED_DISABLED: Text =
    Text::of("Hold the tip still at the marked corner", "Hold the tip still at the marked corner");
pub(in crate::console) const REMOVE_TOUCH: Text = Text::of("Remove the last corner", "Remove the last corner");
pub(in crate::console) const LAY_ANEW: Text = Text::of("Lay it anew", "Lay it anew");
pub(in crate::console) const LAY_ANEW_HOVER: Text = Text::of(
    "Forgets what was touched, and waits for the board to lie still",
    "Forgets what was touched, and waits for the board to lie still",
);
pub(in crate::console) const TIP_STILL: Text = Text::of("the tip is still", "the tip is still");
pub(in crate::console) const TIP_MOVES: Text =
    Text::of("the tip moves, or its place is not known", "the tip moves, or its place is not known");
pub(in crate::console) const PLACE_OPTIONAL: Text = Text::of(
    "Without this step only the lens is saved, and no forces are drawn into the picture",
    "Without this step only the lens is saved, and no forces are drawn into the picture",
);
pub(in crate::console) const PLACE_GOOD: Text = Text::of("tip and picture agree", "tip and picture agree");
pub(in crate::console) const PLACE_HELD_OUT_HOVER: Text = Text::of(
    "Distance in the picture between a touched point and its corner, by a camera found without it, px",
    "Distance in the picture between a touched point and its corner, by a camera found without it, px",
);
pub(in crate::console) const RIGID: Text = Text::of("Flatness", "Flatness");
pub(in crate::console) const RIGID_HOVER: Text = Text::of(
    "Distance of the touched points from a rigid board, root mean square",
    "Distance of the touched points from a rigid board, root mean square",
);
pub(in crate::console) const NEEDS_BOARD: Text = Text::of("The board cannot be used", "The board cannot be used");
pub(in crate::console) const NEEDS_VIEWS: Text = Text::of(
    "At least four views, better all that are asked for",
    "At least four views, better all that are asked for",
);
pub(in crate::console) const NEEDS_LENS: Text = Text::of(
    "There is no good lens: go back and take more views",
    "There is no good lens: go back and take more views",
);
pub(in crate::console) const NEEDS_PLACE: Text = Text::of(
    "There is no good place yet: touch the marked corners",
    "There is no good place yet: touch the marked corners",
);

/// Why there is no such board.
pub(in crate::console) fn no_board(why: &str) -> String {
    told!("No board: {why}", "No board: {why}")
}

/// Number of views, and how it stands with the present one.
pub(in crate::console) fn views(count: usize, told: &str) -> String {
    told!("{count} taken; {told}", "{count} taken; {told}")
}

/// The picture in words.
pub(in crate::console) fn picture(told: &str) -> String {
    told!("Endoscope's picture: {told}", "Endoscope's picture: {told}")
}

/// The map in words.
pub(in crate::console) fn covered(share: f64) -> String {
    told!("{:.0} % of the picture covered", "{:.0} % of the picture covered", 100.0 * share)
}

/// A view that was not used.
pub(in crate::console) fn left_out(number: usize, why: &str) -> String {
    told!("View {number} is left out: {why}", "View {number} is left out: {why}")
}

/// A value with its standard deviation, px.
pub(in crate::console) fn with_deviation(value: f64, sd: f64) -> String {
    told!("{value:.1} ± {sd:.1} px", "{value:.1} ± {sd:.1} px")
}

/// Distortion, with the standard deviation of its first term.
pub(in crate::console) fn bend(bend: &Bend, sd: &Bend) -> String {
    let Bend { k1, k2, p1, p2 } = bend;
    format!("k1 {k1:.4} ± {:.4}, k2 {k2:.4}, p1 {p1:.4}, p2 {p2:.4}", sd.k1)
}

/// What is to be touched.
pub(in crate::console) fn touch(corner: usize) -> String {
    told!(
        "Touch the marked corner with the tip (corner {})",
        "Touch the marked corner with the tip (corner {})",
        corner + 1
    )
}

/// How many corners are touched.
pub(in crate::console) fn touched(count: usize, tip: &str) -> String {
    told!("{count} corners touched; {tip}", "{count} corners touched; {tip}")
}

/// Why it may be saved.
pub(in crate::console) fn proof(lens_px: Option<f64>, place: Option<(f64, bool)>) -> String {
    let lens = lens_px
        .map_or(word("The lens is that of the rig file", "The lens is that of the rig file").to_owned(), |px| {
            told!("Held-out corners: {px:.2} px", "Held-out corners: {px:.2} px")
        });
    let place = match place {
        None => word("the place is not known, no forces are drawn", "the place is not known, no forces are drawn")
            .to_owned(),
        Some((px, true)) => told!(
            "touched corners: {px:.1} px; the place follows the endoscope's marker",
            "berührte Ecken: {px:.1} px; der Ort folgt dem Marker des Endoskops"
        ),
        Some((px, false)) => told!(
            "touched corners: {px:.1} px; the place holds until the endoscope is moved",
            "berührte Ecken: {px:.1} px; der Ort gilt, bis das Endoskop bewegt wird"
        ),
    };
    format!("{lens}; {place}")
}

/// Where it was written.
pub(in crate::console) fn written(path: &Path) -> String {
    told!("Saved in {}", "Saved in {}", path.display())
}
