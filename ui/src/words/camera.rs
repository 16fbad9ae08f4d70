//! Texts about the calibration of the endoscope's camera.

use nima_camera::{Ask, Cause, Lack, LeftOut, Offer, PlaceError, Region, Unseen, Way};

/// What is missing for a good calibration, and what to do.
pub(crate) fn camera_cause(cause: &Cause) -> String {
    match cause {
        Cause::TooFew { used, needed } => {
            format!("{used} usable views of {needed}; show the board whole at other places")
        }
        Cause::Blurred { blurred, of } => {
            format!("{blurred} of {of} views are blurred; focus, and hold the board still")
        }
        Cause::Repeated { repeated, of } => {
            format!("{repeated} of {of} views show the board at the same place; move it between the views")
        }
        Cause::Parallel { most_deg } => {
            format!("the board was never tilted by more than {most_deg:.0} deg; tilt it by 25 deg and more, each way")
        }
        Cause::OneWay { spread_deg } => {
            format!(
                "the board was tilted about one axis only ({spread_deg:.0} deg about the other); tilt it about both"
            )
        }
        Cause::Coverage { share } => {
            format!("{:.0} % of the picture has shown corners; show the board near its edges", 100.0 * share)
        }
        Cause::NoFit => {
            "no lens explains the corners; check the number of corners, and that the board is flat".to_owned()
        }
        Cause::HeldOut { rms_px, most_px } => {
            format!("held-out corners are {rms_px:.2} px off, more than {most_px:.2} px; use a flat board, and focus")
        }
        Cause::Uncertain { focal_percent, centre_px } => format!(
            "the focal length is known to {focal_percent:.2} % and the centre to {centre_px:.1} px only; \
             take more tilted views, near the edges of the picture"
        ),
    }
}

/// Why a view was not used.
pub(crate) const fn left_out(why: LeftOut) -> &'static str {
    match why {
        LeftOut::Blurred => "blurred",
        LeftOut::Repeated => "at the same place as another",
        LeftOut::Outlier => "does not fit to the others",
    }
}

/// Why no board is found.
pub(crate) fn unseen(unseen: Unseen) -> String {
    match unseen {
        Unseen::Nothing => "no board is seen".to_owned(),
        Unseen::Part { seen, of } => format!("{seen} of {of} corners are seen; show the whole board"),
        Unseen::Other([across, down]) => format!("a board of {across}x{down} inner corners is seen"),
    }
}

/// What became of the board in a picture.
pub(crate) const fn offer(offer: Offer) -> &'static str {
    match offer {
        Offer::Taken => "taken",
        Offer::Moving => "hold it still",
        Offer::Blurred => "blurred; focus, or hold it farther away",
        Offer::TakenHere => "taken here already",
    }
}

/// The view that is wanted next.
pub(crate) fn ask(ask: Ask) -> String {
    match ask {
        Ask::Flat => "Hold the board straight before the lens".to_owned(),
        Ask::Tilted(way) => {
            let side = match way {
                Way::Left => "left",
                Way::Right => "right",
                Way::Up => "upper",
                Way::Down => "lower",
            };
            format!("Tilt the board: its {side} side nearer to the lens")
        }
        Ask::There(Region(place)) => format!("Move the board to the {} of the picture", region(place)),
        Ask::Other => "Hold the board somewhere else, tilted otherwise".to_owned(),
        Ask::Complete => "All views are taken".to_owned(),
    }
}

const fn region([column, row]: [usize; 2]) -> &'static str {
    match (column, row) {
        (0, 0) => "upper left",
        (1, 0) => "top",
        (2, 0) => "upper right",
        (0, 1) => "left",
        (2, 1) => "right",
        (0, 2) => "lower left",
        (1, 2) => "bottom",
        (2, 2) => "lower right",
        _ => "middle",
    }
}

/// Why the camera has no place.
pub(crate) fn place_error(error: PlaceError) -> String {
    match error {
        PlaceError::TooFew { touched, needed } => format!("{touched} of at least {needed} corners are touched"),
        PlaceError::OneLine => "the touched corners are on one line; touch the outermost ones".to_owned(),
        PlaceError::NotSeen => "the board cannot be placed before this lens; calibrate the lens again".to_owned(),
    }
}

/// What makes the camera's place useless.
pub(crate) fn place_lack(lack: &Lack) -> String {
    match lack {
        Lack::NotRigid { corner: [column, row], by_m } => format!(
            "corner {} in row {} is {:.1} mm beside the board; touch it again, and do not move the board",
            column + 1,
            row + 1,
            by_m * 1e3
        ),
        Lack::HeldOut { rms_px, most_px } => format!(
            "touched corners are {rms_px:.1} px from where the camera sees them, more than {most_px:.0} px; calibrate \
             the tip first, and touch the corners exactly"
        ),
    }
}
