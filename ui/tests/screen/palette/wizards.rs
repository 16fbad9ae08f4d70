//! The wizards, opened and left.

use egui::accesskit::Role as Kind;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_console::console::commands::Action;
use nima_machine::messages::LoopState;
use nima_testing::real_time::{alone, judged};
use nima_wizards::WizardKind;

use super::{alike, begin, choose, entry, expect, rows};
use crate::bench::{Console, pick, shows, until};

/// Wizards that cannot be opened, because one is open.
pub(super) fn open_pages(console: &mut Console) -> String {
    let all = console.query_all_by_role(Kind::Button).map(|button| button.accesskit_node());
    let ours = all.filter(|button| button.is_disabled() && button.label().unwrap_or_default().ends_with('…'));
    ours.filter_map(|button| button.label()).collect::<Vec<_>>().join(", ")
}

pub(super) fn back(console: &mut Console) {
    if shows(console, "Back to the monitor") {
        pick(console, "Back to the monitor");
        console.run_steps(3);
    }
}

#[test]
fn every_wizard_is_opened_and_left() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let mut done = Vec::new();
    let simulated = WizardKind::ALL.into_iter().filter(|which| which.scene().is_some()).map(Action::Calibrate);
    for action in [Action::Calibrations, Action::Check].into_iter().chain(simulated) {
        let title = &entry(action).title;
        done.push(alike(&mut console, action, back, |console| pick(console, title), open_pages));
    }
    pick(&mut console, "Ready check…");
    choose(&mut console, Action::CloseWizard);
    assert!(!shows(&console, "Back to the monitor"));
    done.push(Action::CloseWizard);
    let offered = rows(&mut console);
    assert!(
        offered.iter().all(|(title, _)| *title != entry(Action::Calibrate(WizardKind::Camera)).title),
        "no endoscope"
    );
    // The wizards that need arms or an endoscope are opened by other tests.
    done.extend(WizardKind::ALL.into_iter().filter(|which| which.scene().is_none()).map(Action::Calibrate));
    expect(&done, "the wizards");
}

#[cfg(target_os = "linux")]
#[test]
fn every_wizard_of_a_rig_with_arms_is_opened() {
    // Its devices are emulated in real time: under load one of them may be lost, and no wizard opens during a fault.
    judged(|| {
        let _alone = alone();
        let folder = tempfile::tempdir().unwrap();
        let (mut console, _emulators, _) = crate::wizard_frames::console(folder.path());
        let idle = |console: &mut Console| {
            back(console);
            until(console, "idle", |tick| tick.state == LoopState::Idle);
        };
        idle(&mut console);
        for which in WizardKind::ALL.into_iter().filter(|which| matches!(which, WizardKind::Frame(_))) {
            let action = Action::Calibrate(which);
            let title = &entry(action).title;
            alike(&mut console, action, idle, |console| pick(console, title), open_pages);
        }
    });
}
