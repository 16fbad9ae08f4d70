//! Sentences for what is done to the loop: commands of the operator, devices, calibrations.

use nima_core::impedance::Mode;
use nima_machine::{
    messages::{Command, Watchdog},
    rig::Act,
    runtime::Operation,
};

use super::events::device;
use super::modes::mode_name;
use crate::language::{told, word};

/// What was done to the loop; `devices` as for an [`event`](super::event).
pub(crate) fn operation(operation: &Operation, devices: &[String]) -> String {
    match *operation {
        Operation::Command { command: of, .. } => told!("command: {}", "command: {}", command(of)),
        Operation::Device(event) => device(&event, devices),
        Operation::Suspend(side) => told!(
            "{} arm: calibrations suspended, the sensor is not known",
            "{} arm: calibrations suspended, the sensor is not known",
            side.word()
        ),
        Operation::Calibrations { side, number } => {
            told!(
                "{} arm: calibrations number {number} handed to the loop",
                "{} arm: calibrations number {number} handed to the loop",
                side.word()
            )
        }
        Operation::Stall { silent_s, .. } => {
            told!("the loop was silent for {:.0} ms", "the loop was silent for {:.0} ms", silent_s * 1e3)
        }
    }
}

/// What the operator asked for.
pub(crate) fn command(command: Command) -> String {
    match command {
        Command::SetMode(mode) => told!("mode {}", "mode {}", name_of(mode)),
        Command::Compare(true) => {
            word("compute all modes to compare them", "compute all modes to compare them").to_owned()
        }
        Command::Compare(false) => word("compute the mode in use only", "compute the mode in use only").to_owned(),
        Command::SetGain(gain) => told!("gain {gain:.2}", "gain {gain:.2}"),
        Command::SetGainAboveOne(gain) => {
            told!("gain {gain:.2}, confirmed above 1", "gain {gain:.2}, confirmed above 1")
        }
        Command::SetDelay(delay_s) => told!("delay of the link {:.0} ms", "delay of the link {:.0} ms", delay_s * 1e3),
        Command::SetDeadBand(speed_m_s) => told!("dead band {:.1} mm/s", "dead band {:.1} mm/s", speed_m_s * 1e3),
        Command::SetStaticHold(true) => word("keep the force at standstill", "keep the force at standstill").to_owned(),
        Command::SetStaticHold(false) => {
            word("fade the force out at standstill", "fade the force out at standstill").to_owned()
        }
        Command::Prompt(side, _) => {
            told!("instruction to the person at the {} arm", "instruction to the person at the {} arm", side.word())
        }
        Command::Guide(side, Some(at_m)) => {
            let [x, y, z] = [at_m.x, at_m.y, at_m.z].map(|m| m * 1e3);
            told!(
                "lead the {} handle to {x:.0}, {y:.0}, {z:.0} mm",
                "lead the {} handle to {x:.0}, {y:.0}, {z:.0} mm",
                side.word()
            )
        }
        Command::Guide(side, None) => {
            told!("lead the {} handle no longer", "lead the {} handle no longer", side.word())
        }
        Command::Grip(side, Some(rad)) => {
            told!(
                "hold the {} gripper open by {:.0} degrees",
                "hold the {} gripper open by {:.0} degrees",
                side.word(),
                rad.to_degrees()
            )
        }
        Command::Grip(side, None) => {
            told!("leave the {} gripper to the hand", "leave the {} gripper to the hand", side.word())
        }
        Command::Task(_, Act::Begin) => word("begin the trial anew", "begin the trial anew").to_owned(),
        Command::Task(side, Act::Mark) => {
            told!("mark the place under the {} tip", "mark the place under the {} tip", side.word())
        }
        Command::Task(_, Act::End) => word("end the trial", "end the trial").to_owned(),
        Command::LetGo(true) => word("the simulated hand lets go", "the simulated hand lets go").to_owned(),
        Command::LetGo(false) => word("the simulated hand takes hold", "the simulated hand takes hold").to_owned(),
        Command::SetGovernor(true) => word("governor on", "governor on").to_owned(),
        Command::SetGovernor(false) => word("governor off", "governor off").to_owned(),
        Command::SetScale(scale) => told!("scale of motion {scale:.2}", "scale of motion {scale:.2}"),
        Command::Engage => word("engage", "engage").to_owned(),
        Command::EngageOne(side) => told!("engage the {} arm", "engage the {} arm", side.word()),
        Command::Rest => word("rest", "rest").to_owned(),
        Command::Stop => word("stop", "stop").to_owned(),
        Command::ReleaseStop => word("release the stop", "release the stop").to_owned(),
        Command::TestWatchdog(watchdog) => {
            told!("fire the watchdog of the {}", "fire the watchdog of the {}", watched(watchdog))
        }
        Command::Checked(true) => {
            word("the ready check of today has passed", "the ready check of today has passed").to_owned()
        }
        Command::Checked(false) => {
            word("no ready check of today has passed", "no ready check of today has passed").to_owned()
        }
        Command::Shutdown => word("end the loop", "end the loop").to_owned(),
    }
}

fn name_of(mode: Mode) -> String {
    format!("\"{}\"", mode_name(mode))
}

fn watched(watchdog: Watchdog) -> &'static str {
    match watchdog {
        Watchdog::Loop => word("loop", "loop"),
        Watchdog::Source => word("measurements", "measurements"),
        Watchdog::Link => word("link", "link"),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use nima_machine::rig::Side;

    use super::*;

    #[test]
    fn commands_are_told_in_words_with_their_values() {
        let told = |of: Command| operation(&Operation::Command { command: of, t_s: 1.0 }, &[]);
        assert_eq!(told(Command::SetMode(Mode::Dfr)), "command: mode \"Direct (DFR)\"");
        assert_eq!(told(Command::SetDelay(0.05)), "command: delay of the link 50 ms");
        assert_eq!(
            told(Command::Guide(Side::Left, Some(Vector3::new(0.01, 0.0, -0.002)))),
            "command: lead the left handle to 10, 0, -2 mm"
        );
        assert_eq!(told(Command::EngageOne(Side::Left)), "command: engage the left arm");
    }
}
