//! Available commands: by role, and for a participant in a trial.

use nima_console::console::{
    ConsoleOptions,
    commands::{Action, CommandEntry, table},
};
use nima_machine::messages::LoopState;
use nima_panels::roles::Role;

use super::{begin, choose, entry, rows, titles};
use crate::{
    bench::{Console, pick, until, wait},
    studies,
};

#[test]
fn every_role_finds_what_it_can_reach_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let of_role = |console: &mut Console, role: Role| {
        console.state_mut().settings_mut().role = role;
        console.run_steps(3);
        titles(console)
    };
    let of_technician = |entry: &CommandEntry| {
        matches!(
            entry.action,
            Action::Panel(_)
                | Action::Window(_)
                | Action::Arrange(_)
                | Action::ResetLayout
                | Action::Check
                | Action::Calibrations
        ) || matches!(entry.action, Action::Calibrate(which) if which.scene().is_some())
    };
    let with_traces =
        |entry: &CommandEntry| matches!(entry.action, Action::Pause | Action::LastTenSeconds | Action::Draws(_));
    // Unavailable here: in this scene, with one hand, without an endoscope, live.
    let nowhere = |entry: &CommandEntry| {
        use Action::{
            BeginTrial, CloseWizard, EndTrial, HideForces, Jaws, LeavePast, Lens, MarkPlace, OtherHand, Palette, Play,
        };
        match entry.action {
            Action::Calibrate(which) => which.scene().is_none(),
            Action::Step(_)
            | LeavePast
            | Play
            | Palette
            | CloseWizard
            | OtherHand
            | Jaws
            | MarkPlace
            | EndTrial
            | BeginTrial
            | HideForces
            | Lens => true,
            _ => false,
        }
    };
    for role in Role::ALL {
        let wanted: Vec<&str> = table()
            .iter()
            .filter(|entry| !nowhere(entry))
            .filter(|entry| !of_technician(entry) || role == Role::Technician)
            .filter(|entry| !with_traces(entry) || role != Role::Surgeon)
            .map(|entry| entry.title.as_str())
            .collect();
        assert_eq!(of_role(&mut console, role), wanted, "{role:?}");
    }
}

#[test]
fn a_participant_finds_only_what_a_trial_has() {
    let folder = tempfile::tempdir().unwrap();
    studies::make(folder.path(), "trials = 1", 6.0, "");
    let mut console = studies::console(folder.path(), ConsoleOptions::default());
    studies::open(&mut console);
    let greyed = rows(&mut console);
    for blocked in [Action::View(Role::Surgeon), Action::Rig, Action::Sessions, Action::Studies] {
        assert!(greyed.contains(&(entry(blocked).title.clone(), false)), "{blocked:?}: {greyed:?}");
    }
    pick(&mut console, "a simulated hand");
    pick(&mut console, "Start the trial");
    wait(&mut console, "a trial", |console| console.state().in_trial());
    until(&mut console, "idle", |tick| tick.state == LoopState::Idle);
    let wanted =
        ["Alarms", "Larger", "Smaller", "Mark this moment", "Acknowledge alarms", "Stop", "Release stop", "Engage"];
    assert_eq!(titles(&mut console), wanted);
    console.run_steps(30);
    choose(&mut console, Action::Engage);
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    choose(&mut console, Action::Stop);
    wait(&mut console, "the end of the trial, or its stop", |console| {
        !console.state().in_trial() || console.state().tick().is_some_and(|tick| tick.state == LoopState::Stopped)
    });
}
