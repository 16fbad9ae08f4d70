//! Sentences for the operations of a session: operator commands, devices, calibrations.

use nima_core::impedance::Mode;
use nima_machine::{
    messages::{Command, Watchdog},
    rig::{DeviceName, TaskAction},
    runtime::Operation,
};

use super::events::device;
use super::modes::mode_name;
use super::side_word;
use crate::language::{text_format, word};

/// `devices` as for an [`event`](super::event).
pub fn operation(operation: &Operation, devices: &[DeviceName]) -> String {
    match *operation {
        Operation::Command { command: of, .. } => text_format!("command: {}", "Befehl: {}", command(of)),
        Operation::Device(event) => device(&event, devices),
        Operation::Suspend(side) => text_format!(
            "{} arm: calibrations suspended, sensor unknown",
            "Arm {}: Kalibrierungen ausgesetzt, Sensor unbekannt",
            side_word(side)
        ),
        Operation::Calibrations { side, number } => {
            text_format!(
                "{} arm: calibration set {number} passed to the loop",
                "Arm {}: Kalibriersatz {number} an die Regelung übergeben",
                side_word(side)
            )
        }
        Operation::Stall { silent_s, .. } => {
            text_format!("the loop was silent for {:.0} ms", "die Regelung schwieg {:.0} ms lang", silent_s * 1e3)
        }
    }
}

pub(crate) fn command(command: Command) -> String {
    match command {
        Command::SetMode(mode) => text_format!("mode {}", "Modus {}", name_of(mode)),
        Command::Compare(true) => {
            word("compute all modes to compare them", "alle Modi zum Vergleich rechnen").to_owned()
        }
        Command::Compare(false) => word("compute the mode in use only", "nur den benutzten Modus rechnen").to_owned(),
        Command::SetGain(gain) => text_format!("gain {gain:.2}", "Verstärkung {gain:.2}"),
        Command::SetGainAboveOne(gain) => {
            text_format!("gain {gain:.2}, confirmed above 1", "Verstärkung {gain:.2}, über 1 bestätigt")
        }
        Command::SetDelay(delay_s) => {
            text_format!("delay of the link {:.0} ms", "Verzögerung der Verbindung {:.0} ms", delay_s * 1e3)
        }
        Command::SetDeadBand(speed_m_s) => text_format!("dead band {:.1} mm/s", "Totband {:.1} mm/s", speed_m_s * 1e3),
        Command::SetStaticHold(true) => word("keep the force at standstill", "Kraft im Stillstand halten").to_owned(),
        Command::SetStaticHold(false) => {
            word("fade the force out at standstill", "Kraft im Stillstand ausblenden").to_owned()
        }
        Command::Prompt(side, _) => {
            text_format!(
                "instruction to the person at the {} arm",
                "Anweisung an die Person am Arm {}",
                side_word(side)
            )
        }
        Command::Guide(side, Some(position_m)) => {
            let [x, y, z] = [position_m.x, position_m.y, position_m.z].map(|m| m * 1e3);
            text_format!(
                "guide the {} handle to {x:.0}, {y:.0}, {z:.0} mm",
                "Handgerät {} nach {x:.0}, {y:.0}, {z:.0} mm führen",
                side_word(side)
            )
        }
        Command::Guide(side, None) => {
            text_format!("stop guiding the {} handle", "Handgerät {} nicht mehr führen", side_word(side))
        }
        Command::Grip(side, Some(rad)) => {
            text_format!(
                "hold the {} gripper open by {:.0} degrees",
                "Greifer {} um {:.0} Grad offen halten",
                side_word(side),
                rad.to_degrees()
            )
        }
        Command::Grip(side, None) => {
            text_format!("leave the {} gripper to the hand", "Greifer {} der Hand überlassen", side_word(side))
        }
        Command::Task(_, TaskAction::Begin) => word("restart the trial", "Versuch neu starten").to_owned(),
        Command::Task(side, TaskAction::Mark) => {
            text_format!("mark the place under the {} tip", "Stelle unter der Spitze {} markieren", side_word(side))
        }
        Command::Task(_, TaskAction::End) => word("end the trial", "Versuch beenden").to_owned(),
        Command::LetGo(true) => {
            word("the simulated hand releases the handle", "die simulierte Hand lässt los").to_owned()
        }
        Command::LetGo(false) => word("the simulated hand grips the handle", "die simulierte Hand fasst an").to_owned(),
        Command::SetGovernor(true) => word("governor on", "Wächter an").to_owned(),
        Command::SetGovernor(false) => word("governor off", "Wächter aus").to_owned(),
        Command::SetScale(scale) => text_format!("motion scale {scale:.2}", "Bewegungsmaßstab {scale:.2}"),
        Command::Engage => word("engage", "koppeln").to_owned(),
        Command::EngageOne(side) => text_format!("engage the {} arm", "Arm {} koppeln", side_word(side)),
        Command::Rest => word("rest", "in Leerlauf setzen").to_owned(),
        Command::Stop => word("stop", "anhalten").to_owned(),
        Command::ReleaseStop => word("release the stop", "Halt lösen").to_owned(),
        Command::TestWatchdog(watchdog) => {
            text_format!("trip the watchdog of the {}", "Watchdog auslösen: {}", watched(watchdog))
        }
        Command::Checked(true) => word("today's ready check has passed", "Startprüfung von heute bestanden").to_owned(),
        Command::Checked(false) => {
            word("no ready check has passed today", "heute keine Startprüfung bestanden").to_owned()
        }
        Command::Shutdown => word("end the loop", "Regelung beenden").to_owned(),
    }
}

fn name_of(mode: Mode) -> String {
    format!("\"{}\"", mode_name(mode))
}

fn watched(watchdog: Watchdog) -> &'static str {
    match watchdog {
        Watchdog::Loop => word("loop", "Regelung"),
        Watchdog::Source => word("measurements", "Messwerte"),
        Watchdog::Link => word("link", "Verbindung"),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use nima_machine::rig::Side;

    use super::*;

    #[test]
    fn commands_are_told_in_words_with_their_values() {
        let report = |of: Command| operation(&Operation::Command { command: of, t_s: 1.0 }, &[]);
        assert_eq!(report(Command::SetMode(Mode::Dfr)), "command: mode \"Direct (DFR)\"");
        assert_eq!(report(Command::SetDelay(0.05)), "command: delay of the link 50 ms");
        assert_eq!(
            report(Command::Guide(Side::Left, Some(Vector3::new(0.01, 0.0, -0.002)))),
            "command: guide the left handle to 10, 0, -2 mm"
        );
        assert_eq!(report(Command::EngageOne(Side::Left)), "command: engage the left arm");
    }
}
