//! Texts about the frame calibrations: reasons for verdicts with remedies, missing data, and phases of a session.

use nima_core::calibration::frames::{
    CalibrationSource, FrameCause, FramePhase, MissingMotion, Mistake, SignedAxes, SignedAxis, ViewMove,
};

use super::ShortText;
use crate::language::{text_format, word};

impl ShortText for CalibrationSource {
    fn words(self) -> &'static str {
        match self {
            Self::Flange => {
                word("the arm sends no joint angles; connect it", "der Arm sendet keine Gelenkwinkel; anschließen")
            }
            Self::Marker => word(
                "the tracker does not see the instrument's marker; connect the tracker and clear the line of sight",
                "der Tracker sieht den Marker des Instruments nicht; Tracker anschließen und Sichtlinie freimachen",
            ),
            Self::Handle => {
                word("the handle sends no position; connect it", "das Handgerät sendet keine Position; anschließen")
            }
            Self::Wrench => word(
                "the wrist sensor sends no data; connect it",
                "der Handgelenksensor sendet keine Daten; \
                 anschließen",
            ),
        }
    }
}

impl ShortText for MissingMotion {
    fn words(self) -> &'static str {
        match self {
            Self::Poses => word("more measurements", "weitere Messungen"),
            Self::Turns => word(
                "larger turns: tilt further in all directions",
                "größere Drehungen: nach allen Seiten \
             weiter kippen",
            ),
            Self::SecondAxis => word(
                "turns about another axis: turn about the shaft too",
                "Drehungen um eine andere Achse: auch um den Schaft drehen",
            ),
            Self::Tilt => word(
                "larger tilts: pivot further in all directions",
                "stärkere Kippung: nach allen Seiten weiter \
             schwenken",
            ),
            Self::SecondTilt => word("tilts in the other directions", "Kippung nach den anderen Seiten"),
            Self::Distance => word("points further apart", "weiter auseinanderliegende Punkte"),
            Self::Beside => {
                word("a point away from the line through the others", "ein Punkt abseits der Linie durch die anderen")
            }
            Self::Directions => word(
                "other orientations: shaft level and upwards, in all directions",
                "andere Richtungen: Schaft waagrecht und nach oben, nach allen Seiten",
            ),
            Self::Move(way) => way.words(),
        }
    }
}

impl ShortText for ViewMove {
    fn words(self) -> &'static str {
        match self {
            Self::Right => word("move right in the image", "im Bild nach rechts bewegen"),
            Self::Up => word("move up in the image", "im Bild nach oben bewegen"),
            Self::Deeper => word("move deeper into the image", "in das Bild hinein bewegen"),
            Self::Left => word("move left in the image", "im Bild nach links bewegen"),
            Self::Down => word("move down in the image", "im Bild nach unten bewegen"),
            Self::Back => word("move back, out of the image", "zurück, aus dem Bild heraus bewegen"),
        }
    }
}

/// Returns the reason for a verdict, with the remedy.
pub fn cause(cause: &FrameCause) -> String {
    match cause {
        FrameCause::Proven => word("accurate on held-out data", "genau auf Testdaten").to_owned(),
        FrameCause::TooFew { have, min } => text_format!(
            "{have} recorded, at least {min} are needed; record more",
            "{have} aufgezeichnet, mindestens {min} nötig; mehr aufzeichnen"
        ),
        FrameCause::SmallTurns { turn_deg, min_deg } => {
            text_format!(
                "the turns are too small ({turn_deg:.1} of {min_deg:.0} deg); tilt further and record more",
                "die Drehungen sind zu klein ({turn_deg:.1} von {min_deg:.0} deg); weiter kippen und mehr aufzeichnen"
            )
        }
        FrameCause::OneAxis { second_deg, min_deg } => text_format!(
            "turned about one axis only ({second_deg:.1} of {min_deg:.0} deg about another); turn about \
             another axis too",
            "nur um eine Achse gedreht ({second_deg:.1} von {min_deg:.0} deg um eine andere); auch um eine andere \
             Achse drehen"
        ),
        FrameCause::NearlyParallel { tilt_deg, min_deg } => {
            text_format!(
                "the shaft's lines are nearly parallel ({tilt_deg:.1} of {min_deg:.0} deg); pivot further in all \
                 directions",
                "die Schaftlinien sind fast parallel ({tilt_deg:.1} von {min_deg:.0} deg); nach allen Seiten weiter \
                 schwenken"
            )
        }
        FrameCause::Collinear { .. } => word(
            "all points are on one line; add one away from it",
            "alle Punkte liegen auf einer Linie; einen abseits davon hinzufügen",
        )
        .to_owned(),
        FrameCause::OnePlane { .. } => word(
            "all directions are in one plane; add a direction outside it",
            "alle Richtungen liegen in einer Ebene; eine außerhalb hinzufügen",
        )
        .to_owned(),
        FrameCause::Weightless { weight_n, min_n } => text_format!(
            "the force does not follow gravity ({weight_n:.2} of {min_n:.1} N); check that the sensor works \
             and carries a tool",
            "die Kraft folgt nicht der Schwerkraft ({weight_n:.2} von {min_n:.1} N); prüfen, ob der Sensor misst und \
             ein Instrument daran hängt"
        ),
        FrameCause::UncertainPlace { by_m, max_m } => {
            text_format!(
                "uncertainty {:.1} mm (limit {:.1} mm); record more",
                "Unsicherheit {:.1} mm (Grenze {:.1} mm); mehr aufzeichnen",
                by_m * 1e3,
                max_m * 1e3
            )
        }
        FrameCause::UncertainAngle { by_deg, max_deg } => {
            text_format!(
                "uncertainty {by_deg:.2} deg (limit {max_deg:.2} deg); record more",
                "Unsicherheit {by_deg:.2} deg (Grenze {max_deg:.2} deg); mehr aufzeichnen"
            )
        }
        FrameCause::PoorPlace { by_m, max_m } => text_format!(
            "the held-out error is {:.1} mm (limit {:.1} mm): something moved that must be fixed (tip, marker, \
             tracker or base); fasten it and start over",
            "der Testfehler ist {:.1} mm (Grenze {:.1} mm): etwas bewegte sich, das fest sein muss (Spitze, \
             Marker, Tracker oder Basis); befestigen und neu beginnen",
            by_m * 1e3,
            max_m * 1e3
        ),
        FrameCause::PoorAngle { by_deg, max_deg } => text_format!(
            "the held-out error is {by_deg:.1} deg (limit {max_deg:.1} deg): something moved that must be \
             fixed; fasten it and start over",
            "der Testfehler ist {by_deg:.1} deg (Grenze {max_deg:.1} deg): etwas bewegte sich, das fest sein \
             muss; befestigen und neu beginnen"
        ),
        FrameCause::Outliers { fraction, .. } => {
            text_format!(
                "{:.0} % contradict the others; start over",
                "{:.0} % widersprechen den anderen; neu beginnen",
                100.0 * fraction
            )
        }
        FrameCause::Mistake { mistake } => mistake_text(*mistake),
    }
}

fn mistake_text(mistake: Mistake) -> String {
    match mistake {
        Mistake::SwappedMarker => word(
            "the marker of the other instrument was seen; swap the two tool definitions in the rig file",
            "der Marker des anderen Instruments wurde gesehen; die beiden Tool-Definitionen in der Aufbaudatei \
             tauschen",
        )
        .to_owned(),
        Mistake::SwappedArm => word(
            "the poses belong to the other arm; swap the two arms in the rig file",
            "die Posen gehören zum anderen Arm; die beiden Arme in der Aufbaudatei tauschen",
        )
        .to_owned(),
        Mistake::InversePose => word(
            "the tracker's poses are inverse (camera seen from the marker); correct its driver",
            "die Tracker-Posen sind invers (Kamera vom Marker aus gesehen); Treiber berichtigen",
        )
        .to_owned(),
        Mistake::InverseRotation => word(
            "the rotations are inverse (a conjugated quaternion); correct the driver of tracker or arm",
            "die Drehungen sind invers (konjugiertes Quaternion); Treiber von Tracker oder Arm berichtigen",
        )
        .to_owned(),
        Mistake::LeftHanded => word(
            "the tracker's frame is left-handed; correct its driver",
            "die Koordinaten des Trackers sind linkshändig; Treiber berichtigen",
        )
        .to_owned(),
        Mistake::WrongSign(axes) => {
            let names: Vec<_> =
                ["x", "y", "z"].into_iter().zip(axes).filter(|(_, wrong)| *wrong).map(|(name, _)| name).collect();
            text_format!(
                "the sign of {} of the positions is wrong; correct the driver",
                "das Vorzeichen von {} der Positionen ist falsch; Treiber berichtigen",
                names.join(word(" and ", " und "))
            )
        }
        Mistake::WrongAxes(axes) => {
            text_format!(
                "the axes are swapped or reversed: x, y, z are measured as {}; correct the mount",
                "die Achsen sind vertauscht oder umgekehrt: x, y, z werden als {} gemessen; Montage berichtigen",
                axes_text(axes)
            )
        }
        Mistake::Mirrored => word(
            "the directions fit only when mirrored: two axes are swapped or one is reversed; check the order",
            "die Richtungen passen nur gespiegelt: zwei Achsen vertauscht oder eine umgekehrt; Reihenfolge prüfen",
        )
        .to_owned(),
    }
}

/// Returns the names and signs of three axes: `-y, x, z`.
pub fn axes_text(SignedAxes(axes): SignedAxes) -> String {
    let word = |axis: SignedAxis| match axis {
        SignedAxis::PlusX => "x",
        SignedAxis::PlusY => "y",
        SignedAxis::PlusZ => "z",
        SignedAxis::MinusX => "-x",
        SignedAxis::MinusY => "-y",
        SignedAxis::MinusZ => "-z",
    };
    axes.map(word).join(", ")
}

/// Returns the text of the phase, with the fraction (0 to 1) of the required holding time.
pub fn phase(phase: &FramePhase) -> (f64, String) {
    match phase {
        FramePhase::Missing(Some(source)) => (0.0, source.words().to_owned()),
        FramePhase::Missing(None) => (0.0, word("no new measurement", "keine neue Messung").to_owned()),
        FramePhase::Moving { by_m, by_rad } => (
            0.0,
            text_format!(
                "moving ({:.1} mm, {:.2} deg): hold still",
                "bewegt sich ({:.1} mm, {:.2} deg): stillhalten",
                by_m * 1e3,
                by_rad.to_degrees()
            ),
        ),
        FramePhase::TakenHere => (
            0.0,
            word("already recorded here: move to the next", "hier schon aufgezeichnet: zum nächsten bewegen")
                .to_owned(),
        ),
        FramePhase::Recording { fraction } => (*fraction, word("hold still", "stillhalten").to_owned()),
        FramePhase::Recorded { index } => {
            (1.0, text_format!("{} recorded: move to the next", "{} aufgezeichnet: zum nächsten bewegen", index + 1))
        }
        FramePhase::Full => (1.0, word("the session is full: continue", "die Sitzung ist voll: weiter").to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_tells_its_figure_and_what_to_do() {
        let words = cause(&FrameCause::PoorPlace { by_m: 0.0042, max_m: 0.0015 });
        assert!(words.contains("4.2 mm") && words.contains("1.5 mm") && words.contains("start over"), "{words}");
        let words = cause(&FrameCause::Mistake { mistake: Mistake::WrongSign([true, false, true]) });
        assert!(words.contains("x and z"), "{words}");
        let axes = SignedAxes([SignedAxis::MinusY, SignedAxis::PlusX, SignedAxis::PlusZ]);
        let words = cause(&FrameCause::Mistake { mistake: Mistake::WrongAxes(axes) });
        assert!(words.contains("-y, x, z"), "{words}");
    }
}
