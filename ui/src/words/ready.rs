//! Texts about the ready check: its points, what they ask of a person, and why one failed and what to do.

use nima_core::{calibration::gravity::NotChecked, kinematics::START_MISS_M};
use nima_machine::{
    messages::{Refusal, Watchdog},
    ready::{Ask, Cause, Check, Figure, Lacks, Unit},
    rig::{Roster, Side},
};

use super::findings::finding_words;
use super::{
    Remedy as _, Words as _, cure_of_refusal, refused_because,
    sides::{arm_stuck, exchanged, marker_stuck, no_push},
};

/// Name of a point.
pub(crate) fn check_name(check: Check) -> String {
    let of_arm = |side: Side, words: &str| format!("{} arm: {words}", capital(side.word()));
    match check {
        Check::Devices => "Devices present and steady".to_owned(),
        Check::Rates => "Rates and losses of the devices".to_owned(),
        Check::Clocks => "Clocks and deadlines".to_owned(),
        Check::Own(side) => of_arm(side, "arm and marker are its own"),
        Check::Bias(side) => of_arm(side, "drift of the bias"),
        Check::Push(side) => of_arm(side, "direction of the force"),
        Check::Handle(side) => of_arm(side, "handle free"),
        Check::Trocar(side) => of_arm(side, "trocar where it was"),
        Check::Ceiling => "Largest force as in the rig file".to_owned(),
        Check::Stop => "Stop".to_owned(),
        Check::Watchdog(Watchdog::Loop) => "Watchdog over the loop".to_owned(),
        Check::Watchdog(Watchdog::Source) => "Watchdog over the measurements".to_owned(),
        Check::Watchdog(Watchdog::Link) => "Watchdog over the link".to_owned(),
    }
}

pub(super) fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// What a person is to do; empty if nothing.
pub(crate) fn ask_words(ask: &Ask) -> String {
    match ask {
        Ask::Nothing => String::new(),
        Ask::Move(side) => {
            format!("Take the {} instrument out of its trocar; if it is out, move it by 10 cm", side.word())
        }
        Ask::TakeOut(side) => {
            format!("Take the {} instrument out of its trocar, so that nothing touches it", side.word())
        }
        Ask::LeaveAlone(side) => format!("Do not touch the {} arm and its instrument", side.word()),
        Ask::Push(side, direction) => {
            format!(
                "Push the tip of the {} instrument {}, for half a second",
                side.word(),
                way(&direction.into_inner())
            )
        }
        Ask::LetGo(side) => format!("Let the {} handle go", side.word()),
        Ask::MoveHandle(side, way) => format!("Take the {} handle and {}, by 2 cm", side.word(), way.words()),
        Ask::PutBack(side) => format!("Put the {} instrument through its trocar and leave it there", side.word()),
        Ask::PressStop => "Press the stop".to_owned(),
        Ask::Release => "Press Release stop".to_owned(),
    }
}

/// The workspace's axis that is nearest to a direction.
fn way(direction: &nalgebra::Vector3<f64>) -> &'static str {
    let axis = direction.iamax();
    match (axis, direction[axis] < 0.0) {
        (0, false) => "to the right",
        (0, true) => "to the left",
        (1, false) => "away from you",
        (1, true) => "towards you",
        (_, false) => "up",
        (_, true) => "down",
    }
}

/// Symbol of a unit; empty for a number of things.
pub(crate) const fn unit(unit: Unit) -> &'static str {
    match unit {
        Unit::Count => "",
        Unit::Newton => "N",
        Unit::Millimetre => "mm",
        Unit::Degree => "degrees",
        Unit::Percent => "%",
        Unit::Second => "s",
    }
}

/// What was measured, and its limit.
pub(crate) fn figure_words(figure: &Figure) -> String {
    let Figure { value, limit, unit: of } = figure;
    match of {
        Unit::Count => format!("{value:.0} of {limit:.0}"),
        Unit::Newton | Unit::Millimetre | Unit::Percent => format!("{value:.2} {}, limit {limit:.2}", unit(*of)),
        Unit::Degree => format!("{value:.0} {}, limit {limit:.0}", unit(*of)),
        Unit::Second => format!("{value:.3} {}, limit {limit:.2}", unit(*of)),
    }
}

/// Why a point is left out.
pub(crate) const fn lacks_words(lacks: Lacks) -> &'static str {
    match lacks {
        Lacks::Devices => "this rig is simulated and has no devices",
        Lacks::WristSensor => "the force is measured at the tip",
        Lacks::OtherArm => "there is one arm only",
        Lacks::Person => "nobody is at the simulated arm in this scene",
    }
}

/// Cause and cure of a point that failed, on a rig with these devices.
pub(crate) fn cause_words(cause: &Cause, roster: &Roster) -> [String; 2] {
    let [what, cure] = match *cause {
        Cause::Missing { place } => return missing(place, roster),
        Cause::Found { place, ref finding } => return found(place, finding, roster),
        Cause::BiasUnseen(why) => return bias_unseen(why),
        Cause::OtherFault(fault) => {
            return [format!("Another fault was raised: {}", fault.cause()), fault.cure().to_owned()];
        }
        Cause::Refused(why) => {
            return [format!("The loop refused the test: {}", refused_because(why)), capital(cure_of_refusal(why))];
        }
        Cause::Missed { share } => {
            return with(format!("{:.1} % of the periods were missed", 100.0 * share), CLOSE_PROGRAMS);
        }
        Cause::LoopClock { by_s } => {
            return with(format!("The loop's clock and this computer's went apart by {by_s:.2} s"), CLOSE_PROGRAMS);
        }
        Cause::BiasMoved { by_n, limit_n } => {
            return with(
                format!("{by_n:.2} N remain at rest, more than {limit_n:.2} N"),
                "Make sure that nothing touches the tool; if it stays, calibrate gravity again",
            );
        }
        Cause::Exchanged(exchange) => return exchanged(exchange),
        Cause::ArmStuck { by_m } => return arm_stuck(by_m),
        Cause::MarkerStuck { by_m } => return marker_stuck(by_m),
        Cause::NoPush { most_n } => return no_push(most_n),
        Cause::PushAskew { by_deg } => return askew(by_deg),
        Cause::HandlePulls { by_m } => {
            return with(
                format!("Let go, the handle moved by {:.1} mm and did not rest", 1e3 * by_m),
                "Let it go; if it moves by itself, calibrate the handle (button on the device) and check its balance",
            );
        }
        Cause::HandleForce { force_n } | Cause::Force { force_n } => {
            return with(
                format!("A force of {force_n:.2} N was asked for where there must be none"),
                "Do not engage; report this with the record of the check",
            );
        }
        Cause::HandleStuck { by_m } => {
            return with(
                format!("The handle moved by {:.1} mm only", 1e3 * by_m),
                "Move the handle; if it is stuck, look for what blocks it and calibrate it (button on the device)",
            );
        }
        Cause::HandleAskew { by_deg } => {
            return with(
                format!("The handle's reading moved {by_deg:.0} degrees off the direction asked for"),
                "Repeat the move; if it stays, calibrate the view, or see how the handle stands and whether left and right are exchanged",
            );
        }
        Cause::BesideTrocar { miss_m } => return beside(miss_m),
        Cause::TrocarMoved { by_m } => {
            return with(
                format!("The trocar is {:.1} mm from where it was, across the shaft", 1e3 * by_m),
                "Put patient or table back, or calibrate the trocar again",
            );
        }
        Cause::OtherCeiling { in_force_n, in_file_n } => {
            return with(
                format!("The largest force is {in_force_n:.2} N; the rig file says {in_file_n:.2} N"),
                "Start the console again, so that the rig file is in force",
            );
        }
        Cause::HalfStop(side) => {
            return with(format!("The {} arm did not stop with the other one", side.word()), STOP_CURE);
        }
        Cause::LateBite { after_s } => {
            return with(format!("The fault came after {after_s:.2} s, too late"), CLOSE_PROGRAMS);
        }
        Cause::Engaged(side) => {
            return with(
                format!("The {} arm was engaged during the check", side.word()),
                "Let both arms rest, then check again",
            );
        }
        Cause::NoGauges => ["The devices delivered no figures", "See the panel Devices, then check again"],
        Cause::NoTicks => ["The control loop sends nothing", "Start the console again"],
        Cause::DateBehind => ["A calibration is dated in the future", "Set this computer's date and time"],
        Cause::Uncalibrated => {
            ["There is no gravity calibration for this sensor and tool", "Calibrate gravity, then check again"]
        }
        Cause::NoRigFile => ["The rig file cannot be read", "Put the rig file back, then start the console again"],
        Cause::NoStop => ["No stop was seen", STOP_CURE],
        Cause::NotReleased(why) => return not_released(why),
        Cause::NoBite(Watchdog::Loop) => {
            ["The loop was silent on purpose, and the supervisor did nothing", "Do not engage; start the console again"]
        }
        Cause::NoBite(Watchdog::Source) => {
            ["Measurements were withheld on purpose, and no fault came", "Do not engage; start the console again"]
        }
        Cause::NoBite(Watchdog::Link) => {
            ["The link was silent on purpose, and no fault came", "Do not engage; start the console again"]
        }
    };
    [what, cure].map(str::to_owned)
}

fn not_released(why: Option<Refusal>) -> [String; 2] {
    let Some(why) = why else {
        return with(
            "The stop or the fault was not released in time".to_owned(),
            "Press Release stop, then check again",
        );
    };
    [format!("The release was refused: {}", refused_because(why)), capital(cure_of_refusal(why))]
}

const CLOSE_PROGRAMS: &str = "Close other programs or grant real-time priority (panel Timing), then check again";
const STOP_CURE: &str = "Do not engage; check the key, the pedal or the button with which you stop";

pub(super) fn with(cause: String, cure: &str) -> [String; 2] {
    [cause, cure.to_owned()]
}

fn name(place: usize, roster: &Roster) -> &str {
    roster.get(place).map_or("a device", |entry| entry.name.as_str())
}

fn missing(place: usize, roster: &Roster) -> [String; 2] {
    let trouble = roster.get(place).and_then(|entry| entry.view.report().trouble);
    let name = name(place, roster);
    match trouble {
        Some(trouble) => [format!("The {name} is not there: {trouble}"), trouble.cure()],
        None => with(format!("The {name} is not there, or does not stay"), "Check plug, cable and power; see Devices"),
    }
}

fn found(place: usize, finding: &nima_machine::rig::checkup::Finding, roster: &Roster) -> [String; 2] {
    let kind = roster.get(place).and_then(|entry| entry.part).map(nima_machine::rig::Part::kind);
    let Some(kind) = kind else { return with("A device is not in order".to_owned(), "See the panel Devices") };
    let [cause, cure] = finding_words(kind, finding);
    [format!("{}: {cause}", capital(name(place, roster))), cure]
}

fn bias_unseen(why: NotChecked) -> [String; 2] {
    let [why, cure] = match why {
        NotChecked::NoSample => ["no data from the sensor", "Check the sensor's cable and the arm, then check again"],
        NotChecked::Moving => ["the tool moved", "Let the tool hang still, then check again"],
        NotChecked::Touched => ["something touched the tool", "Take away what touches the tool, then check again"],
        NotChecked::InTrocar => {
            ["the instrument was in the trocar", "Take the instrument out of the trocar, then check again"]
        }
        NotChecked::Engaged => ["the arm was engaged", "Let both arms rest, then check again"],
    };
    [format!("The bias could not be looked at: {why}"), cure.to_owned()]
}

fn askew(by_deg: f64) -> [String; 2] {
    let what = if by_deg > 150.0 { "its sign is wrong" } else { "its axes are wrong, or the push was" };
    with(
        format!("The push was measured {by_deg:.0} degrees off: {what}"),
        "Repeat the push in the direction asked for; if it stays, calibrate the sensor's mount and gravity again",
    )
}

fn beside(miss_m: f64) -> [String; 2] {
    let cause = if miss_m.is_finite() {
        format!("The shaft passes the trocar at {:.0} mm; {:.0} mm would be in it", 1e3 * miss_m, 1e3 * START_MISS_M)
    } else {
        "The instrument is not through its trocar".to_owned()
    };
    with(cause, "Put the instrument through its trocar; if it is, the trocar has moved: calibrate the trocar")
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::Exchange;

    use super::*;

    #[test]
    fn no_sentence_ends_with_a_full_stop_and_each_cause_says_what_to_do() {
        let causes = [
            Cause::Missing { place: 0 },
            Cause::Missed { share: 0.02 },
            Cause::DateBehind,
            Cause::BiasMoved { by_n: 0.5, limit_n: 0.2 },
            Cause::BiasUnseen(NotChecked::Touched),
            Cause::NoPush { most_n: 0.1 },
            Cause::Exchanged(Exchange::Handles),
            Cause::Exchanged(Exchange::Arms),
            Cause::Exchanged(Exchange::Sensors),
            Cause::Exchanged(Exchange::Servos),
            Cause::Exchanged(Exchange::Markers),
            Cause::Exchanged(Exchange::Trocars),
            Cause::ArmStuck { by_m: 0.0 },
            Cause::MarkerStuck { by_m: 0.0 },
            Cause::PushAskew { by_deg: 178.0 },
            Cause::PushAskew { by_deg: 88.0 },
            Cause::HandlePulls { by_m: 0.01 },
            Cause::HandleStuck { by_m: 0.0 },
            Cause::HandleAskew { by_deg: 90.0 },
            Cause::BesideTrocar { miss_m: f64::INFINITY },
            Cause::BesideTrocar { miss_m: 0.012 },
            Cause::TrocarMoved { by_m: 0.003 },
            Cause::OtherCeiling { in_force_n: 4.0, in_file_n: 3.0 },
            Cause::NoStop,
            Cause::HalfStop(Side::Left),
            Cause::NoBite(Watchdog::Loop),
            Cause::NoBite(Watchdog::Source),
            Cause::NoBite(Watchdog::Link),
            Cause::Engaged(Side::Right),
        ];
        let mut told: Vec<_> = causes.iter().map(|cause| cause_words(cause, &Roster::new())).collect();
        assert!(told.iter().flatten().all(|words| !words.is_empty() && !words.ends_with('.')), "{told:?}");
        told.sort();
        told.dedup();
        assert_eq!(told.len(), causes.len(), "no two say the same");
        assert!(told.iter().any(|[cause, _]| cause.contains("sign is wrong")));
    }

    #[test]
    fn a_push_is_asked_for_in_words_of_the_room() {
        let ask = Ask::Push(Side::Left, nalgebra::Vector3::x_axis());
        assert_eq!(ask_words(&ask), "Push the tip of the left instrument to the right, for half a second");
    }
}
