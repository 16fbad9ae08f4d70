//! Texts about the frame calibrations: why a result got its verdict and what to do, what is missing, and what a session sees.

use nima_core::calibration::frames::{Cause, Missing, Mistake, Move, Phase, SignedAxes, SignedAxis, Source};

use super::Words;

impl Words for Source {
    fn words(self) -> &'static str {
        match self {
            Self::Flange => "the arm sends no joint angles; connect it",
            Self::Marker => {
                "the tracker does not see the instrument's marker; connect the tracker and clear the line of sight"
            }
            Self::Handle => "the handle sends no position; connect it",
            Self::Wrench => "the wrist sensor sends no data; connect it",
        }
    }
}

impl Words for Missing {
    fn words(self) -> &'static str {
        match self {
            Self::Poses => "more of them",
            Self::Turns => "larger turns: tilt further to all sides",
            Self::SecondAxis => "turns about another axis: turn about the shaft too",
            Self::Tilt => "larger tilts: pivot further to all sides",
            Self::SecondTilt => "tilts to the other sides",
            Self::Distance => "points further apart",
            Self::Beside => "a point beside the line through the others",
            Self::Directions => "other directions: shaft level and up, to all sides",
            Self::Move(way) => way.words(),
        }
    }
}

impl Words for Move {
    fn words(self) -> &'static str {
        match self {
            Self::Right => "move to the right in the picture",
            Self::Up => "move up in the picture",
            Self::Deeper => "move into the picture",
            Self::Left => "move to the left in the picture",
            Self::Down => "move down in the picture",
            Self::Back => "move back, out of the picture",
        }
    }
}

/// Why a result got its verdict, and what to do.
pub(crate) fn cause(cause: &Cause) -> String {
    match cause {
        Cause::Proven => "accurate on held-out data".to_owned(),
        Cause::TooFew { have, least } => format!("{have} recorded, at least {least} are needed; record more"),
        Cause::SmallTurns { turn_deg, least_deg } => {
            format!("the turns are too small ({turn_deg:.1} of {least_deg:.0} deg); tilt further and record more")
        }
        Cause::OneAxis { second_deg, least_deg } => format!(
            "it turned about one axis only ({second_deg:.1} of {least_deg:.0} deg about another); turn about another axis too"
        ),
        Cause::NearlyParallel { tilt_deg, least_deg } => {
            format!(
                "the shaft's lines are nearly parallel ({tilt_deg:.1} of {least_deg:.0} deg); pivot further to all sides"
            )
        }
        Cause::Collinear { .. } => "all lie on one line; add one beside it".to_owned(),
        Cause::OnePlane { .. } => "all lie in one plane; add a direction out of it".to_owned(),
        Cause::Weightless { weight_n, least_n } => format!(
            "the force does not follow gravity ({weight_n:.2} of {least_n:.1} N); check that the sensor reads and that a tool hangs on it"
        ),
        Cause::UncertainPlace { by_m, most_m } => {
            format!("known to {:.1} mm only, {:.1} mm are allowed; record more", by_m * 1e3, most_m * 1e3)
        }
        Cause::UncertainAngle { by_deg, most_deg } => {
            format!("known to {by_deg:.2} deg only, {most_deg:.2} deg are allowed; record more")
        }
        Cause::PoorPlace { by_m, most_m } => format!(
            "the held-out error is {:.1} mm, {:.1} mm are allowed: something moved that should not (tip, marker, tracker or base); fix it and start over",
            by_m * 1e3,
            most_m * 1e3
        ),
        Cause::PoorAngle { by_deg, most_deg } => format!(
            "the held-out error is {by_deg:.1} deg, {most_deg:.1} deg are allowed: something moved that should not; fix it and start over"
        ),
        Cause::Outliers { share, .. } => {
            format!("{:.0} % contradict the others; start over", 100.0 * share)
        }
        Cause::Mistake { mistake } => mistake_words(*mistake),
    }
}

fn mistake_words(mistake: Mistake) -> String {
    match mistake {
        Mistake::SwappedMarker => {
            "the marker of the other instrument was seen; exchange the two tool definitions in the rig file".to_owned()
        }
        Mistake::SwappedArm => "the poses are those of the other arm; exchange the two arms in the rig file".to_owned(),
        Mistake::InversePose => {
            "the tracker's poses are inverse (camera seen from the marker); correct its driver".to_owned()
        }
        Mistake::InverseRotation => {
            "the rotations are inverse (a conjugated quaternion); correct the driver of tracker or arm".to_owned()
        }
        Mistake::LeftHanded => "the tracker's frame is left-handed; correct its driver".to_owned(),
        Mistake::WrongSign(axes) => {
            let names: Vec<_> =
                ["x", "y", "z"].into_iter().zip(axes).filter(|(_, wrong)| *wrong).map(|(name, _)| name).collect();
            format!("the sign of {} of the positions is wrong; correct the driver", names.join(" and "))
        }
        Mistake::WrongAxes(axes) => {
            format!(
                "the axes are exchanged or reversed: x, y, z are measured as {}; correct the mount",
                axes_words(axes)
            )
        }
        Mistake::Mirrored => {
            "the directions fit in a mirror only: two axes are exchanged or one is reversed; check the order".to_owned()
        }
    }
}

/// Names and signs of three axes: `-y, x, z`.
pub(crate) fn axes_words(SignedAxes(axes): SignedAxes) -> String {
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

/// What the session sees now, with the share of the time that a pose has been held.
pub(crate) fn phase(phase: &Phase) -> (f64, String) {
    match phase {
        Phase::Missing(Some(source)) => (0.0, source.words().to_owned()),
        Phase::Missing(None) => (0.0, "no new measurement".to_owned()),
        Phase::Moving { by_m, by_rad } => {
            (0.0, format!("moving ({:.1} mm, {:.2} deg): hold still", by_m * 1e3, by_rad.to_degrees()))
        }
        Phase::TakenHere => (0.0, "recorded here already: move on".to_owned()),
        Phase::Recording { share } => (*share, "hold still".to_owned()),
        Phase::Recorded { index } => (1.0, format!("{} recorded: move on", index + 1)),
        Phase::Full => (1.0, "the session is full: go on".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_tells_its_figure_and_what_to_do() {
        let words = cause(&Cause::PoorPlace { by_m: 0.0042, most_m: 0.0015 });
        assert!(words.contains("4.2 mm") && words.contains("1.5 mm") && words.contains("start over"), "{words}");
        let words = cause(&Cause::Mistake { mistake: Mistake::WrongSign([true, false, true]) });
        assert!(words.contains("x and z"), "{words}");
        let axes = SignedAxes([SignedAxis::MinusY, SignedAxis::PlusX, SignedAxis::PlusZ]);
        let words = cause(&Cause::Mistake { mistake: Mistake::WrongAxes(axes) });
        assert!(words.contains("-y, x, z"), "{words}");
    }
}
