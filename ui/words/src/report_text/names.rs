//! Names and short clauses that are used within other texts.

use nima_core::{kinematics::ArmStartError, tip_force::GoalKind};
use nima_devices::Loss;
use nima_machine::{
    messages::{LoopState, Scheduling, SchedulingLack},
    rig::{AwaitedDevice, DeviceName, DeviceRole, EngageBlocker, RigPart, Side, SideSwap},
};

use crate::{
    language::{Language, current, text_format, word},
    text::common,
};

/// Returns the side as a name, for example of a hand.
pub fn side_name(side: Side) -> &'static str {
    match side {
        Side::Right => common::RIGHT.get(),
        Side::Left => common::LEFT.get(),
    }
}

/// Returns the side within a sentence: before the noun in English, after it in German.
pub fn side_word(side: Side) -> &'static str {
    match side {
        Side::Right => word("right", "rechts"),
        Side::Left => word("left", "links"),
    }
}

pub fn state_name(state: LoopState) -> &'static str {
    match state {
        LoopState::Disconnected => word("No device", "Kein Gerät"),
        LoopState::Idle => word("Idle", "Leerlauf"),
        LoopState::Ready => word("Ready", "Bereit"),
        LoopState::Engaged => word("Engaged", "Gekoppelt"),
        LoopState::Clutched => word("Clutched", "Ausgekuppelt"),
        LoopState::Stopped => word("Stopped", "Angehalten"),
        LoopState::Faulted(_) => word("Fault", "Störung"),
    }
}

/// Returns the name within a sentence: lower case in English; a German noun keeps its capital.
pub fn within(name: &str) -> String {
    if current() == Language::German { name.to_owned() } else { name.to_lowercase() }
}

/// Returns the device with its role and model: `right handle (Haply)`.
pub fn device_name(name: DeviceName) -> String {
    let DeviceName { role, make } = name;
    role_name(role) + &make.map_or_else(String::new, |make| format!(" ({make})"))
}

pub fn role_name(role: DeviceRole) -> String {
    match role {
        DeviceRole::Part(part) => part_name(part),
        DeviceRole::Cap => word("cap", "Kappe").to_owned(),
    }
}

pub fn part_name(part: RigPart) -> String {
    match part {
        RigPart::Handle(side) => text_format!("{} handle", "Handgerät {}", side_word(side)),
        RigPart::Arm(side) => text_format!("{} arm", "Arm {}", side_word(side)),
        RigPart::Sensor(side) => text_format!("{} sensor", "Sensor {}", side_word(side)),
        RigPart::Servos(side) => text_format!("{} servos", "Servos {}", side_word(side)),
        RigPart::TissueSensor => word("tissue sensor", "Gewebesensor").to_owned(),
        RigPart::Tracker => word("tracker", "Tracker").to_owned(),
        RigPart::Pedal => word("pedal", "Pedal").to_owned(),
    }
}

pub fn loss_text(loss: Loss) -> &'static str {
    match loss {
        Loss::Disconnected => word("the connection was interrupted", "Verbindung getrennt"),
        Loss::Silent => word("it sends no data", "sendet keine Daten"),
        Loss::Corrupt => word("its data are damaged", "Daten beschädigt"),
        Loss::Implausible => word("it sends impossible values", "sendet unmögliche Werte"),
        Loss::Device { .. } => word("it reports a fault", "meldet eine Störung"),
    }
}

/// Returns the swapped parts, a clause without a full stop.
pub fn exchange_text(exchange: SideSwap) -> &'static str {
    match exchange {
        SideSwap::Handles => {
            word("the right and left handles are swapped", "rechtes und linkes Handgerät sind vertauscht")
        }
        SideSwap::Arms => word(
            "the right and left arms, or their mounts in the rig file, are swapped",
            "rechter und linker Arm oder ihre Montage in der Aufbaudatei sind vertauscht",
        ),
        SideSwap::Sensors => {
            word("the right and left sensors are swapped", "rechter und linker Sensor sind vertauscht")
        }
        SideSwap::Servos => word(
            "the servos of the right and left instruments are swapped",
            "die Servos des rechten und des linken Instruments sind vertauscht",
        ),
        SideSwap::Markers => word(
            "the markers of the right and left instruments are swapped",
            "die Marker des rechten und des linken Instruments sind vertauscht",
        ),
        SideSwap::Trocars => word(
            "the right and left trocars are swapped, or each instrument is in the other's trocar",
            "rechter und linker Trokar sind vertauscht, oder jedes Instrument steckt im Trokar des anderen",
        ),
    }
}

/// Returns the reason why an arm cannot be engaged, with its remedy, a clause without a full stop.
pub fn obstacle_text(obstacle: &EngageBlocker) -> String {
    match obstacle {
        EngageBlocker::Start(start) => start_words(*start),
        EngageBlocker::Waiting(AwaitedDevice::Servos) => {
            word("the servos have not responded yet", "die Servos haben noch nicht geantwortet").to_owned()
        }
        EngageBlocker::Waiting(AwaitedDevice::Markers) => word(
            "the tracker has not seen the markers of both instruments yet",
            "der Tracker hat noch nicht die Marker beider Instrumente gesehen",
        )
        .to_owned(),
        EngageBlocker::Exchanged(exchange) => exchange_text(*exchange).to_owned(),
        EngageBlocker::OneHandle => word(
            "the right and left handles are one device: both report the same serial number",
            "rechtes und linkes Handgerät sind ein Gerät: beide melden dieselbe Seriennummer",
        )
        .to_owned(),
        EngageBlocker::OneArm => word(
            "the right and left arms are one device: both report the same serial number",
            "rechter und linker Arm sind ein Gerät: beide melden dieselbe Seriennummer",
        )
        .to_owned(),
        EngageBlocker::OneSensor => word(
            "two of the sensors are one device: both report the same serial number",
            "zwei der Sensoren sind ein Gerät: beide melden dieselbe Seriennummer",
        )
        .to_owned(),
        EngageBlocker::FarEnd => word(
            "the follower's machine refuses to engage; its screen shows the reason",
            "der Rechner des Folgearms lehnt das Koppeln ab; sein Bildschirm zeigt den Grund",
        )
        .to_owned(),
    }
}

/// Returns the reason why an arm cannot start from its current position, with the remedy.
fn start_words(error: ArmStartError) -> String {
    match error {
        ArmStartError::Period { period_s } => text_format!(
            "the period of the kinematics is {period_s} s, outside its range: use more than 0 and at most 0.02 s",
            "der Takt der Kinematik ist {period_s} s, außerhalb seines Bereichs: mehr als 0 und höchstens 0.02 s verwenden"
        ),
        ArmStartError::ShortShaft { shaft_m, insertion_max_m } => text_format!(
            "the shaft of {shaft_m} m is too short for an insertion of {insertion_max_m} m: correct one of them",
            "der Schaft von {shaft_m} m ist zu kurz für eine Einführtiefe von {insertion_max_m} m: eines davon berichtigen"
        ),
        ArmStartError::NotFinite { joint } => text_format!(
            "joint {joint} reports an invalid angle: check the arm's connection",
            "Gelenk {joint} meldet einen ungültigen Winkel: Verbindung des Arms prüfen"
        ),
        ArmStartError::AtLimit { joint, angle_deg, limit_deg } => text_format!(
            "joint {joint} is at {angle_deg:.1} degrees (limit {limit_deg:.1}): move the arm off the limit by hand",
            "Gelenk {joint} steht bei {angle_deg:.1} Grad (Grenze {limit_deg:.1}): Arm von Hand von der Grenze weg bewegen"
        ),
        ArmStartError::BesideTrocar { miss_m, max_m } => text_format!(
            "the shaft's axis misses the trocar by {:.1} mm (limit {:.1} mm): move the arm to the ready pose",
            "die Schaftachse verfehlt den Trokar um {:.1} mm (Grenze {:.1} mm): Arm in die Startpose bewegen",
            1e3 * miss_m,
            1e3 * max_m
        ),
        ArmStartError::NotInserted { insertion_m } => text_format!(
            "the tip is inserted only {:.1} mm: insert the instrument into the body before starting",
            "die Spitze ist nur {:.1} mm eingeführt: Instrument vor dem Start in den Körper einführen",
            1e3 * insertion_m
        ),
    }
}

/// Returns the real-time property that the loop lacks, and the remedy.
pub fn lack_text(lack: SchedulingLack) -> [&'static str; 2] {
    match lack {
        SchedulingLack::Priority => [
            word("no real-time priority", "keine Echtzeitpriorität"),
            word(
                "add the line \"@realtime - rtprio 95\" to /etc/security/limits.d/realtime.conf, join the group \
                 realtime and log in again",
                "Zeile \"@realtime - rtprio 95\" in /etc/security/limits.d/realtime.conf eintragen, der Gruppe realtime \
                 beitreten und neu anmelden",
            ),
        ],
        SchedulingLack::Memory => [
            word("memory is not locked", "Speicher ist nicht gesperrt"),
            word(
                "add the line \"@realtime - memlock unlimited\" to /etc/security/limits.d/realtime.conf, join the group \
                 realtime and log in again",
                "Zeile \"@realtime - memlock unlimited\" in /etc/security/limits.d/realtime.conf eintragen, der Gruppe \
                 realtime beitreten und neu anmelden",
            ),
        ],
        SchedulingLack::PriorityInContainer => [
            word("no real-time priority in this container", "keine Echtzeitpriorität in diesem Container"),
            word(
                "start it with --cap-add=sys_nice --ulimit rtprio=95; if its control group has no real-time budget, \
                 also with --cpu-rt-runtime=950000",
                "ihn mit --cap-add=sys_nice --ulimit rtprio=95 starten; hat seine Kontrollgruppe kein Echtzeitbudget, \
                 auch mit --cpu-rt-runtime=950000",
            ),
        ],
        SchedulingLack::MemoryInContainer => [
            word("memory is not locked in this container", "Speicher ist in diesem Container nicht gesperrt"),
            word(
                "start it with --cap-add=ipc_lock --ulimit memlock=-1",
                "ihn mit --cap-add=ipc_lock --ulimit memlock=-1 starten",
            ),
        ],
        SchedulingLack::NotLinux => [
            word("real-time scheduling is available on Linux only", "Echtzeitpriorität gibt es nur unter Linux"),
            word("expect more missed ticks here", "hier sind mehr versäumte Takte zu erwarten"),
        ],
    }
}

pub fn scheduling_text(scheduling: Scheduling) -> Option<String> {
    let [cause, cure] = lack_text(scheduling.lack()?);
    Some(format!("{cause}: {cure}"))
}

/// Returns the name of a goal of a tip-force recording, and the advice until it is met.
pub fn goal_text(what: GoalKind) -> [&'static str; 2] {
    match what {
        GoalKind::Tilt => [
            word("Tilt of the shaft", "Neigung des Schafts"),
            word("reach left, right, near and far", "nach links, rechts, nah und fern reichen"),
        ],
        GoalKind::Depth => [word("Depth", "Tiefe"), word("move in and out by 2 cm", "2 cm hinein- und herausbewegen")],
        GoalKind::InAndOut => [
            word("In and out", "Hinein und heraus"),
            word("move as often outwards as inwards", "so oft heraus wie hinein bewegen"),
        ],
        GoalKind::Speed => [
            word("Speed", "Tempo"),
            word("make quick strokes in and out, up to 10 cm/s", "schnell hinein- und herausfahren, bis zu 10 cm/s"),
        ],
        GoalKind::Force => [
            word("Force at the tip", "Kraft an der Spitze"),
            word(
                "press into the tissue up to 3 N, and drag it sideways",
                "bis 3 N in das Gewebe drücken und es seitwärts ziehen",
            ),
        ],
        GoalKind::Contact => [
            word("Contact and free", "Kontakt und frei"),
            word("be in contact half of the time", "die Hälfte der Zeit in Kontakt sein"),
        ],
        GoalKind::Rows => [word("Rows", "Zeilen"), word("keep going", "weitermachen")],
    }
}

#[cfg(test)]
mod tests {
    use nima_core::tip_force::TipForceCoverage;
    use nima_machine::rig::EngageBlocker;

    use super::*;
    use crate::language;

    #[test]
    fn what_is_said_in_english_is_what_the_libraries_say() {
        let losses = [Loss::Disconnected, Loss::Silent, Loss::Corrupt, Loss::Implausible, Loss::Device { code: 1 }];
        assert!(losses.iter().all(|loss| loss_text(*loss) == loss.cause()));
        let states = [LoopState::Disconnected, LoopState::Idle, LoopState::Ready, LoopState::Engaged];
        assert!(states.iter().all(|state| state_name(*state) == state.word()));
        assert!(RigPart::ALL.iter().all(|part| part_name(*part) == part.name()));
        let exchanges = [SideSwap::Handles, SideSwap::Arms, SideSwap::Sensors, SideSwap::Servos, SideSwap::Markers];
        let obstacles = exchanges.map(EngageBlocker::Exchanged).into_iter();
        let obstacles = obstacles.chain([AwaitedDevice::Servos, AwaitedDevice::Markers].map(EngageBlocker::Waiting));
        let others = [EngageBlocker::OneHandle, EngageBlocker::OneArm, EngageBlocker::OneSensor, EngageBlocker::FarEnd];
        for obstacle in obstacles.chain([EngageBlocker::Exchanged(SideSwap::Trocars)]).chain(others) {
            assert_eq!(obstacle_text(&obstacle), obstacle.to_string());
        }
        for (fifo, memory_locked) in [(false, false), (true, false), (true, true)] {
            let scheduling = Scheduling { fifo, deadline: false, memory_locked };
            assert_eq!(scheduling_text(scheduling), scheduling.advice());
        }
    }

    #[test]
    fn every_goal_of_a_recording_has_german_words() {
        for goal in TipForceCoverage::default().goals() {
            let english = goal_text(goal.what);
            assert_eq!(english, [goal.what.name(), goal.what.advice()]);
            let german = language::with(Language::German, || goal_text(goal.what));
            assert!(german[0] != english[0] && german[1] != english[1], "{german:?}");
        }
    }

    #[test]
    fn a_device_is_named_in_german_with_its_make() {
        let name = DeviceName { role: DeviceRole::Part(RigPart::Handle(Side::Right)), make: Some("Force Dimension") };
        assert_eq!(device_name(name), name.to_string());
        let german = language::with(Language::German, || device_name(name));
        assert_eq!(german, "Handgerät rechts (Force Dimension)");
    }
}
