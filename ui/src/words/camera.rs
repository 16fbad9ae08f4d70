//! Texts about the calibration of the endoscope's camera.

use nima_camera::{Ask, Cause, Lack, LeftOut, Offer, PlaceError, Region, Unseen, Way};

use crate::language::{told, word};

/// What is missing for a good calibration, and what to do.
pub(crate) fn camera_cause(cause: &Cause) -> String {
    match cause {
        Cause::TooFew { used, needed } => {
            told!(
                "{used} usable views of {needed}; show the board whole at other places",
                "{used} usable views of {needed}; show the board whole at other places"
            )
        }
        Cause::Blurred { blurred, of } => {
            told!(
                "{blurred} of {of} views are blurred; focus, and hold the board still",
                "{blurred} of {of} views are blurred; focus, and hold the board still"
            )
        }
        Cause::Repeated { repeated, of } => {
            told!(
                "{repeated} of {of} views show the board at the same place; move it between the views",
                "{repeated} of {of} views show the board at the same place; move it between the views"
            )
        }
        Cause::Parallel { most_deg } => {
            told!(
                "the board was never tilted by more than {most_deg:.0} deg; tilt it by 25 deg and more, each way",
                "the board was never tilted by more than {most_deg:.0} deg; tilt it by 25 deg and more, each way"
            )
        }
        Cause::OneWay { spread_deg } => {
            told!(
                "the board was tilted about one axis only ({spread_deg:.0} deg about the other); tilt it about both",
                "the board was tilted about one axis only ({spread_deg:.0} deg about the other); tilt it about both"
            )
        }
        Cause::Coverage { share } => {
            told!(
                "{:.0} % of the picture has shown corners; show the board near its edges",
                "{:.0} % of the picture has shown corners; show the board near its edges",
                100.0 * share
            )
        }
        Cause::NoFit => word(
            "no lens explains the corners; check the number of corners, and that the board is flat",
            "no lens explains the corners; check the number of corners, and that the board is flat",
        )
        .to_owned(),
        Cause::HeldOut { rms_px, most_px } => {
            told!(
                "held-out corners are {rms_px:.2} px off, more than {most_px:.2} px; use a flat board, and focus",
                "held-out corners are {rms_px:.2} px off, more than {most_px:.2} px; use a flat board, and focus"
            )
        }
        Cause::Uncertain { focal_percent, centre_px } => told!(
            "the focal length is known to {focal_percent:.2} % and the centre to {centre_px:.1} px only; \
             take more tilted views, near the edges of the picture",
            "the focal length is known to {focal_percent:.2} % and the centre to {centre_px:.1} px only; \
             take more tilted views, near the edges of the picture"
        ),
    }
}

/// Why a view was not used.
pub(crate) fn left_out(why: LeftOut) -> &'static str {
    match why {
        LeftOut::Blurred => word("blurred", "blurred"),
        LeftOut::Repeated => word("at the same place as another", "at the same place as another"),
        LeftOut::Outlier => word("does not fit to the others", "does not fit to the others"),
    }
}

/// Why no board is found.
pub(crate) fn unseen(unseen: Unseen) -> String {
    match unseen {
        Unseen::Nothing => word("no board is seen", "no board is seen").to_owned(),
        Unseen::Part { seen, of } => told!(
            "{seen} of {of} corners are seen; show the whole board",
            "{seen} of {of} corners are seen; show the whole board"
        ),
        Unseen::Other([across, down]) => told!(
            "a board of {across}x{down} inner corners is seen",
            "a board of {across}x{down} inner corners is seen"
        ),
    }
}

/// What became of the board in a picture.
pub(crate) fn offer(offer: Offer) -> &'static str {
    match offer {
        Offer::Taken => word("taken", "taken"),
        Offer::Moving => word("hold it still", "hold it still"),
        Offer::Blurred => word("blurred; focus, or hold it farther away", "blurred; focus, or hold it farther away"),
        Offer::TakenHere => word("taken here already", "taken here already"),
    }
}

/// The view that is wanted next.
pub(crate) fn ask(ask: Ask) -> String {
    match ask {
        Ask::Flat => {
            word("Hold the board straight before the lens", "Hold the board straight before the lens").to_owned()
        }
        Ask::Tilted(way) => {
            let side = match way {
                Way::Left => word("left", "left"),
                Way::Right => word("right", "right"),
                Way::Up => word("upper", "upper"),
                Way::Down => word("lower", "lower"),
            };
            told!(
                "Tilt the board: its {side} side nearer to the lens",
                "Tilt the board: its {side} side nearer to the lens"
            )
        }
        Ask::There(Region(place)) => {
            told!("Move the board to the {} of the picture", "Move the board to the {} of the picture", region(place))
        }
        Ask::Other => {
            word("Hold the board somewhere else, tilted otherwise", "Hold the board somewhere else, tilted otherwise")
                .to_owned()
        }
        Ask::Complete => word("All views are taken", "All views are taken").to_owned(),
    }
}

fn region([column, row]: [usize; 2]) -> &'static str {
    match (column, row) {
        (0, 0) => word("upper left", "upper left"),
        (1, 0) => word("top", "top"),
        (2, 0) => word("upper right", "upper right"),
        (0, 1) => word("left", "left"),
        (2, 1) => word("right", "right"),
        (0, 2) => word("lower left", "lower left"),
        (1, 2) => word("bottom", "bottom"),
        (2, 2) => word("lower right", "lower right"),
        _ => word("middle", "middle"),
    }
}

/// Why the camera has no place.
pub(crate) fn place_error(error: PlaceError) -> String {
    match error {
        PlaceError::TooFew { touched, needed } => told!(
            "{touched} of at least {needed} corners are touched",
            "{touched} of at least {needed} corners are touched"
        ),
        PlaceError::OneLine => word(
            "the touched corners are on one line; touch the outermost ones",
            "the touched corners are on one line; touch the outermost ones",
        )
        .to_owned(),
        PlaceError::NotSeen => word(
            "the board cannot be placed before this lens; calibrate the lens again",
            "the board cannot be placed before this lens; calibrate the lens again",
        )
        .to_owned(),
    }
}

/// What makes the camera's place useless.
pub(crate) fn place_lack(lack: &Lack) -> String {
    match lack {
        Lack::NotRigid { corner: [column, row], by_m } => told!(
            "corner {} in row {} is {:.1} mm beside the board; touch it again, and do not move the board",
            "corner {} in row {} is {:.1} mm beside the board; touch it again, and do not move the board",
            column + 1,
            row + 1,
            by_m * 1e3
        ),
        Lack::HeldOut { rms_px, most_px } => told!(
            "touched corners are {rms_px:.1} px from where the camera sees them, more than {most_px:.0} px; calibrate \
             the tip first, and touch the corners exactly",
            "touched corners are {rms_px:.1} px from where the camera sees them, more than {most_px:.0} px; calibrate \
             the tip first, and touch the corners exactly"
        ),
    }
}
