//! Texts about the calibration of the endoscope's camera.

use nima_camera::{Ask, Cause, Lack, LeftOut, Offer, PlaceError, Region, Unseen, Way};

use crate::language::{told, word};

pub(super) fn camera_cause(cause: &Cause) -> String {
    match cause {
        Cause::TooFew { used, needed } => {
            told!(
                "{used} usable views of {needed}; show the whole board at other positions",
                "{used} brauchbare Ansichten von {needed}; ganze Tafel an anderen Stellen zeigen"
            )
        }
        Cause::Blurred { blurred, of } => {
            told!(
                "{blurred} of {of} views are blurred; focus the endoscope and hold the board still",
                "{blurred} von {of} Ansichten sind unscharf; scharfstellen und Tafel ruhig halten"
            )
        }
        Cause::Repeated { repeated, of } => {
            told!(
                "{repeated} of {of} views show the board at the same position; move it between views",
                "{repeated} von {of} Ansichten zeigen die Tafel an derselben Stelle; zwischen den Ansichten bewegen"
            )
        }
        Cause::Parallel { most_deg } => {
            told!(
                "the board was never tilted by more than {most_deg:.0} deg; tilt it by 25 deg or more in each \
                 direction",
                "die Tafel war nie mehr als {most_deg:.0} deg gekippt; in jede Richtung 25 deg und mehr kippen"
            )
        }
        Cause::OneWay { spread_deg } => {
            told!(
                "the board was tilted about one axis only ({spread_deg:.0} deg about the other); tilt it about both",
                "die Tafel war nur um eine Achse gekippt ({spread_deg:.0} deg um die andere); um beide kippen"
            )
        }
        Cause::Coverage { share } => {
            told!(
                "corners were seen in only {:.0} % of the image; show the board near the image edges",
                "in {:.0} % des Bildes waren Ecken; Tafel nahe den Rändern zeigen",
                100.0 * share
            )
        }
        Cause::NoFit => word(
            "no lens explains the corners; check the number of corners, and check that the board is flat",
            "kein Objektiv erklärt die Ecken; Eckenzahl prüfen, und ob die Tafel eben ist",
        )
        .to_owned(),
        Cause::HeldOut { rms_px, most_px } => {
            told!(
                "held-out corners are {rms_px:.2} px off (limit {most_px:.2} px); use a flat board and focus",
                "Test-Ecken liegen {rms_px:.2} px daneben, mehr als {most_px:.2} px; ebene Tafel nehmen, scharfstellen"
            )
        }
        Cause::Uncertain { focal_percent, centre_px } => told!(
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

pub(super) fn unseen(unseen: Unseen) -> String {
    match unseen {
        Unseen::Nothing => word("no board detected", "keine Tafel zu sehen").to_owned(),
        Unseen::Part { seen, of } => told!(
            "{seen} of {of} corners detected; show the whole board",
            "{seen} von {of} Ecken zu sehen; ganze Tafel zeigen"
        ),
        Unseen::Other([across, down]) => told!(
            "a board with {across}x{down} inner corners was detected",
            "eine Tafel mit {across}x{down} inneren Ecken ist zu sehen"
        ),
    }
}

pub(super) fn offer(offer: Offer) -> &'static str {
    match offer {
        Offer::Taken => word("captured", "aufgenommen"),
        Offer::Moving => word("hold the board still", "ruhig halten"),
        Offer::Blurred => word(
            "blurred; focus, or hold the board farther away",
            "unscharf; scharfstellen oder weiter weg \
         halten",
        ),
        Offer::TakenHere => word("already captured here", "hier schon aufgenommen"),
    }
}

pub(super) fn ask(ask: Ask) -> String {
    match ask {
        Ask::Flat => {
            word("Hold the board straight in front of the lens", "Tafel gerade vor das Objektiv halten").to_owned()
        }
        Ask::Tilted(way) => {
            let side = match way {
                Way::Left => word("left", "links"),
                Way::Right => word("right", "rechts"),
                Way::Up => word("upper", "oben"),
                Way::Down => word("lower", "unten"),
            };
            told!("Tilt the board: {side} side nearer to the lens", "Tafel kippen: {side} näher ans Objektiv")
        }
        Ask::There(Region(place)) => {
            told!("Move the board to the {} of the image", "Tafel im Bild verschieben: {}", region(place))
        }
        Ask::Other => {
            word("Hold the board at another position with another tilt", "Tafel woanders und anders gekippt halten")
                .to_owned()
        }
        Ask::Complete => word("All views captured", "Alle Ansichten aufgenommen").to_owned(),
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
        PlaceError::TooFew { touched, needed } => told!(
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

pub(super) fn place_lack(lack: &Lack) -> String {
    match lack {
        Lack::NotRigid { corner: [column, row], by_m } => told!(
            "corner {} in row {} is {:.1} mm off the board; touch it again, and do not move the board",
            "Ecke {} in Reihe {} liegt {:.1} mm neben der Tafel; neu berühren, Tafel nicht bewegen",
            column + 1,
            row + 1,
            by_m * 1e3
        ),
        Lack::HeldOut { rms_px, most_px } => told!(
            "touched corners are {rms_px:.1} px away from their image positions (limit {most_px:.0} px); \
             calibrate the tip first, and touch the corners exactly",
            "berührte Ecken liegen {rms_px:.1} px neben ihrem Ort im Bild, mehr als {most_px:.0} px; erst Spitze \
             kalibrieren, Ecken genau berühren"
        ),
    }
}
