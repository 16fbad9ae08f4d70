//! Texts about the frame calibrations: why a result got its verdict and what to do, what is missing, and what a session sees.

use nima_core::calibration::frames::{Cause, Missing, Mistake, Move, Phase, SignedAxes, SignedAxis, Source};

use super::Words;
use crate::language::{told, word};

impl Words for Source {
    fn words(self) -> &'static str {
        match self {
            Self::Flange => {
                word("the arm sends no joint angles; connect it", "the arm sends no joint angles; connect it")
            }
            Self::Marker => word(
                "the tracker does not see the instrument's marker; connect the tracker and clear the line of sight",
                "the tracker does not see the instrument's marker; connect the tracker and clear the line of sight",
            ),
            Self::Handle => {
                word("the handle sends no position; connect it", "the handle sends no position; connect it")
            }
            Self::Wrench => {
                word("the wrist sensor sends no data; connect it", "the wrist sensor sends no data; connect it")
            }
        }
    }
}

impl Words for Missing {
    fn words(self) -> &'static str {
        match self {
            Self::Poses => word("more of them", "more of them"),
            Self::Turns => word("larger turns: tilt further to all sides", "larger turns: tilt further to all sides"),
            Self::SecondAxis => word(
                "turns about another axis: turn about the shaft too",
                "turns about another axis: turn about the shaft too",
            ),
            Self::Tilt => word("larger tilts: pivot further to all sides", "larger tilts: pivot further to all sides"),
            Self::SecondTilt => word("tilts to the other sides", "tilts to the other sides"),
            Self::Distance => word("points further apart", "points further apart"),
            Self::Beside => {
                word("a point beside the line through the others", "a point beside the line through the others")
            }
            Self::Directions => word(
                "other directions: shaft level and up, to all sides",
                "other directions: shaft level and up, to all sides",
            ),
            Self::Move(way) => way.words(),
        }
    }
}

impl Words for Move {
    fn words(self) -> &'static str {
        match self {
            Self::Right => word("move to the right in the picture", "move to the right in the picture"),
            Self::Up => word("move up in the picture", "move up in the picture"),
            Self::Deeper => word("move into the picture", "move into the picture"),
            Self::Left => word("move to the left in the picture", "move to the left in the picture"),
            Self::Down => word("move down in the picture", "move down in the picture"),
            Self::Back => word("move back, out of the picture", "move back, out of the picture"),
        }
    }
}

/// Why a result got its verdict, and what to do.
pub(crate) fn cause(cause: &Cause) -> String {
    match cause {
        Cause::Proven => word("accurate on held-out data", "accurate on held-out data").to_owned(),
        Cause::TooFew { have, least } => told!(
            "{have} recorded, at least {least} are needed; record more",
            "{have} recorded, at least {least} are needed; record more"
        ),
        Cause::SmallTurns { turn_deg, least_deg } => {
            told!(
                "the turns are too small ({turn_deg:.1} of {least_deg:.0} deg); tilt further and record more",
                "the turns are too small ({turn_deg:.1} of {least_deg:.0} deg); tilt further and record more"
            )
        }
        Cause::OneAxis { second_deg, least_deg } => told!(
            "it turned about one axis only ({second_deg:.1} of {least_deg:.0} deg about another); turn about another \
             axis too",
            "it turned about one axis only ({second_deg:.1} of {least_deg:.0} deg about another); turn about another \
             axis too"
        ),
        Cause::NearlyParallel { tilt_deg, least_deg } => {
            told!(
                "the shaft's lines are nearly parallel ({tilt_deg:.1} of {least_deg:.0} deg); pivot further to all \
                 sides",
                "the shaft's lines are nearly parallel ({tilt_deg:.1} of {least_deg:.0} deg); pivot further to all \
                 sides"
            )
        }
        Cause::Collinear { .. } => {
            word("all lie on one line; add one beside it", "all lie on one line; add one beside it").to_owned()
        }
        Cause::OnePlane { .. } => {
            word("all lie in one plane; add a direction out of it", "all lie in one plane; add a direction out of it")
                .to_owned()
        }
        Cause::Weightless { weight_n, least_n } => told!(
            "the force does not follow gravity ({weight_n:.2} of {least_n:.1} N); check that the sensor reads and that \
             a tool hangs on it",
            "the force does not follow gravity ({weight_n:.2} of {least_n:.1} N); check that the sensor reads and that \
             a tool hangs on it"
        ),
        Cause::UncertainPlace { by_m, most_m } => {
            told!(
                "known to {:.1} mm only, {:.1} mm are allowed; record more",
                "known to {:.1} mm only, {:.1} mm are allowed; record more",
                by_m * 1e3,
                most_m * 1e3
            )
        }
        Cause::UncertainAngle { by_deg, most_deg } => {
            told!(
                "known to {by_deg:.2} deg only, {most_deg:.2} deg are allowed; record more",
                "known to {by_deg:.2} deg only, {most_deg:.2} deg are allowed; record more"
            )
        }
        Cause::PoorPlace { by_m, most_m } => told!(
            "the held-out error is {:.1} mm, {:.1} mm are allowed: something moved that should not (tip, marker, \
             tracker or base); fix it and start over",
            "the held-out error is {:.1} mm, {:.1} mm are allowed: something moved that should not (tip, marker, \
             tracker or base); fix it and start over",
            by_m * 1e3,
            most_m * 1e3
        ),
        Cause::PoorAngle { by_deg, most_deg } => told!(
            "the held-out error is {by_deg:.1} deg, {most_deg:.1} deg are allowed: something moved that should not; \
             fix it and start over",
            "the held-out error is {by_deg:.1} deg, {most_deg:.1} deg are allowed: something moved that should not; \
             fix it and start over"
        ),
        Cause::Outliers { share, .. } => {
            told!(
                "{:.0} % contradict the others; start over",
                "{:.0} % contradict the others; start over",
                100.0 * share
            )
        }
        Cause::Mistake { mistake } => mistake_words(*mistake),
    }
}

fn mistake_words(mistake: Mistake) -> String {
    match mistake {
        Mistake::SwappedMarker => word(
            "the marker of the other instrument was seen; exchange the two tool definitions in the rig file",
            "the marker of the other instrument was seen; exchange the two tool definitions in the rig file",
        )
        .to_owned(),
        Mistake::SwappedArm => word(
            "the poses are those of the other arm; exchange the two arms in the rig file",
            "the poses are those of the other arm; exchange the two arms in the rig file",
        )
        .to_owned(),
        Mistake::InversePose => word(
            "the tracker's poses are inverse (camera seen from the marker); correct its driver",
            "the tracker's poses are inverse (camera seen from the marker); correct its driver",
        )
        .to_owned(),
        Mistake::InverseRotation => word(
            "the rotations are inverse (a conjugated quaternion); correct the driver of tracker or arm",
            "the rotations are inverse (a conjugated quaternion); correct the driver of tracker or arm",
        )
        .to_owned(),
        Mistake::LeftHanded => word(
            "the tracker's frame is left-handed; correct its driver",
            "the tracker's frame is left-handed; correct its driver",
        )
        .to_owned(),
        Mistake::WrongSign(axes) => {
            let names: Vec<_> =
                ["x", "y", "z"].into_iter().zip(axes).filter(|(_, wrong)| *wrong).map(|(name, _)| name).collect();
            told!(
                "the sign of {} of the positions is wrong; correct the driver",
                "the sign of {} of the positions is wrong; correct the driver",
                names.join(word(" and ", " and "))
            )
        }
        Mistake::WrongAxes(axes) => {
            told!(
                "the axes are exchanged or reversed: x, y, z are measured as {}; correct the mount",
                "the axes are exchanged or reversed: x, y, z are measured as {}; correct the mount",
                axes_words(axes)
            )
        }
        Mistake::Mirrored => word(
            "the directions fit in a mirror only: two axes are exchanged or one is reversed; check the order",
            "the directions fit in a mirror only: two axes are exchanged or one is reversed; check the order",
        )
        .to_owned(),
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
        Phase::Missing(None) => (0.0, word("no new measurement", "no new measurement").to_owned()),
        Phase::Moving { by_m, by_rad } => (
            0.0,
            told!(
                "moving ({:.1} mm, {:.2} deg): hold still",
                "moving ({:.1} mm, {:.2} deg): hold still",
                by_m * 1e3,
                by_rad.to_degrees()
            ),
        ),
        Phase::TakenHere => (0.0, word("recorded here already: move on", "recorded here already: move on").to_owned()),
        Phase::Recording { share } => (*share, word("hold still", "hold still").to_owned()),
        Phase::Recorded { index } => (1.0, told!("{} recorded: move on", "{} recorded: move on", index + 1)),
        Phase::Full => (1.0, word("the session is full: go on", "the session is full: go on").to_owned()),
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
