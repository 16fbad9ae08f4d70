//! Texts about the calibration of the endoscope's camera.

use nima_camera::{
    CameraCause, DetectionFailure, LeftOut, LensSide, PlaceError, PlaceLack, Region, ViewOutcome, ViewRequest,
};
use nima_words::language::{text_format, word};

pub(super) fn camera_cause(cause: &CameraCause) -> String {
    match cause {
        CameraCause::TooFew { used, needed } => {
            text_format!(
                "{used} usable views of {needed}; show the whole board at other positions",
                "{used} brauchbare Ansichten von {needed}; ganze Tafel an anderen Stellen zeigen"
            )
        }
        CameraCause::Blurred { blurred, of } => {
            text_format!(
                "{blurred} of {of} views are blurred; focus the endoscope and hold the board still",
                "{blurred} von {of} Ansichten sind unscharf; scharfstellen und Tafel ruhig halten"
            )
        }
        CameraCause::Repeated { repeated, of } => {
            text_format!(
                "{repeated} of {of} views show the board at the same position; move it between views",
                "{repeated} von {of} Ansichten zeigen die Tafel an derselben Stelle; zwischen den Ansichten bewegen"
            )
        }
        CameraCause::Parallel { max_deg } => {
            text_format!(
                "the board was never tilted by more than {max_deg:.0} deg; tilt it by 25 deg or more in each \
                 direction",
                "die Tafel war nie mehr als {max_deg:.0} deg gekippt; in jede Richtung 25 deg und mehr kippen"
            )
        }
        CameraCause::OneWay { spread_deg } => {
            text_format!(
                "the board was tilted about one axis only ({spread_deg:.0} deg about the other); tilt it about both",
                "die Tafel war nur um eine Achse gekippt ({spread_deg:.0} deg um die andere); um beide kippen"
            )
        }
        CameraCause::Coverage { fraction } => {
            text_format!(
                "corners were seen in only {:.0} % of the image; show the board near the image edges",
                "in {:.0} % des Bildes waren Ecken; Tafel nahe den Rändern zeigen",
                100.0 * fraction
            )
        }
        CameraCause::NoFit => word(
            "no lens model fits the corners; check the number of corners, and check that the board is flat",
            "kein Objektivmodell passt zu den Ecken; Eckenzahl prüfen, und ob die Tafel eben ist",
        )
        .to_owned(),
        CameraCause::HeldOut { rms_px, max_px } => {
            text_format!(
                "held-out corners are {rms_px:.2} px off (limit {max_px:.2} px); use a flat board and focus",
                "Test-Ecken liegen {rms_px:.2} px daneben, mehr als {max_px:.2} px; ebene Tafel nehmen, scharfstellen"
            )
        }
        CameraCause::Uncertain { focal_percent, centre_px } => text_format!(
            "the focal length is uncertain by {focal_percent:.2} % and the centre by {centre_px:.1} px; capture \
             more tilted views near the image edges",
            "Brennweite nur auf {focal_percent:.2} % und Mitte nur auf {centre_px:.1} px bekannt; mehr gekippte \
             Ansichten nahe den Bildrändern aufnehmen"
        ),
    }
}

pub(super) fn left_out(why: LeftOut) -> &'static str {
    match why {
        LeftOut::Blurred => word("blurred", "unscharf"),
        LeftOut::Repeated => word("at the same position as another view", "an derselben Stelle wie eine andere"),
        LeftOut::Outlier => word("does not fit the others", "passt nicht zu den anderen"),
    }
}

pub(super) fn unseen(unseen: DetectionFailure) -> String {
    match unseen {
        DetectionFailure::Nothing => word("no board detected", "keine Tafel zu sehen").to_owned(),
        DetectionFailure::Part { seen, of } => text_format!(
            "{seen} of {of} corners detected; show the whole board",
            "{seen} von {of} Ecken zu sehen; ganze Tafel zeigen"
        ),
        DetectionFailure::Other([across, down]) => text_format!(
            "a board with {across}x{down} inner corners was detected",
            "eine Tafel mit {across}x{down} inneren Ecken ist zu sehen"
        ),
    }
}

pub(super) fn offer(offer: ViewOutcome) -> &'static str {
    match offer {
        ViewOutcome::Taken => word("captured", "aufgenommen"),
        ViewOutcome::Moving => word("hold the board still", "ruhig halten"),
        ViewOutcome::Blurred => word(
            "blurred; focus, or hold the board farther away",
            "unscharf; scharfstellen oder weiter weg \
         halten",
        ),
        ViewOutcome::TakenHere => word("already captured here", "hier schon aufgenommen"),
    }
}

pub(super) fn ask(ask: ViewRequest) -> String {
    match ask {
        ViewRequest::Flat => {
            word("Hold the board straight in front of the lens", "Tafel gerade vor das Objektiv halten").to_owned()
        }
        ViewRequest::Tilted(way) => {
            let side = match way {
                LensSide::Left => word("left", "links"),
                LensSide::Right => word("right", "rechts"),
                LensSide::Up => word("upper", "oben"),
                LensSide::Down => word("lower", "unten"),
            };
            text_format!("Tilt the board: {side} side nearer to the lens", "Tafel kippen: {side} näher ans Objektiv")
        }
        ViewRequest::There(Region(place)) => {
            text_format!("Move the board to the {} of the image", "Tafel im Bild verschieben: {}", region(place))
        }
        ViewRequest::Other => {
            word("Hold the board at another position with another tilt", "Tafel woanders und anders gekippt halten")
                .to_owned()
        }
        ViewRequest::Complete => word("All views captured", "Alle Ansichten aufgenommen").to_owned(),
    }
}

fn region([column, row]: [usize; 2]) -> &'static str {
    match (column, row) {
        (0, 0) => word("upper left", "oben links"),
        (1, 0) => word("top", "oben"),
        (2, 0) => word("upper right", "oben rechts"),
        (0, 1) => word("left", "links"),
        (2, 1) => word("right", "rechts"),
        (0, 2) => word("lower left", "unten links"),
        (1, 2) => word("bottom", "unten"),
        (2, 2) => word("lower right", "unten rechts"),
        _ => word("middle", "in die Mitte"),
    }
}

pub(super) fn place_error(error: PlaceError) -> String {
    match error {
        PlaceError::TooFew { touched, needed } => text_format!(
            "{touched} of at least {needed} corners are touched",
            "{touched} von mindestens {needed} Ecken berührt"
        ),
        PlaceError::OneLine => word(
            "the touched corners are on one line; touch the outermost ones",
            "die berührten Ecken liegen auf einer Linie; die äußersten berühren",
        )
        .to_owned(),
        PlaceError::NotSeen => word(
            "the board position cannot be found with this lens; calibrate the lens again",
            "Tafellage vor diesem Objektiv nicht bestimmbar; Objektiv neu kalibrieren",
        )
        .to_owned(),
    }
}

pub(super) fn place_lack(lack: &PlaceLack) -> String {
    match lack {
        PlaceLack::NotRigid { corner: [column, row], by_m } => text_format!(
            "corner {} in row {} is {:.1} mm off the board; touch it again, and do not move the board",
            "Ecke {} in Reihe {} liegt {:.1} mm neben der Tafel; neu berühren, Tafel nicht bewegen",
            column + 1,
            row + 1,
            by_m * 1e3
        ),
        PlaceLack::HeldOut { rms_px, max_px } => text_format!(
            "touched corners are {rms_px:.1} px away from their image positions (limit {max_px:.0} px); \
             calibrate the tip first, and touch the corners exactly",
            "berührte Ecken liegen {rms_px:.1} px neben ihrem Ort im Bild, mehr als {max_px:.0} px; erst Spitze \
             kalibrieren, Ecken genau berühren"
        ),
    }
}
