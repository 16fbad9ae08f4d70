//! The tiles of the set-up page: for each arm its devices, its calibrations and the ready check, each with its state.

use nima_core::calibration::Judgement;
use nima_machine::rig::{RigPart, Side};
use nima_recording::store::{CalibrationAge, ReadyRecord};
use nima_screen::live::LiveState;
use nima_words::text;

use nima_calibrations::{
    CalibrationTarget, WizardKind,
    frames::FrameKind,
    overview::{ArmOverview, CalibrationEntry, OverviewLine, day, made_text, verdict_text},
};

/// State of a step of the set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepState {
    Done,
    /// It works, but should be checked.
    Doubtful,
    /// It is missing, or cannot be used.
    Missing,
}

/// Page to which a tile leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetupStep {
    Devices,
    Calibrate(CalibrationTarget),
    Check,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct SetupTile {
    pub(super) name: &'static str,
    pub(super) state: StepState,
    /// Reason for the state.
    pub(super) why: String,
    pub(super) step: SetupStep,
}

/// Returns the tiles of an arm in the order of the set-up; `check` is the last ready check of the rig.
pub(super) fn tiles(arm: &ArmOverview, live: &LiveState, check: Option<&ReadyRecord>) -> Vec<SetupTile> {
    let calibrations = arm.lines.iter().map(calibration);
    std::iter::once(devices(arm.side, live)).chain(calibrations).chain([ready(live, check)]).collect()
}

/// Returns how much of the set-up is done, and the least time of the rest.
pub(super) fn progress_text(arms: &[Vec<SetupTile>]) -> String {
    let mut done = 0;
    let mut all = 0;
    let mut left_s = 0;
    for (place, tiles) in arms.iter().enumerate() {
        // Both arms share the ready check.
        for tile in tiles.iter().filter(|tile| place == 0 || tile.step != SetupStep::Check) {
            all += 1;
            if tile.state == StepState::Done {
                done += 1;
            } else {
                left_s += seconds(tile.step);
            }
        }
    }
    text::overview::progress(done, all, left_s.div_ceil(60))
}

/// Returns the time of a step if nothing has to be repeated, s: measured with the technician of the emulated rig
/// (`docs/results/calibration.md`, `docs/results/frames.md`, `docs/results/ready-check.md`).
const fn seconds(step: SetupStep) -> u64 {
    match step {
        SetupStep::Devices => 0,
        SetupStep::Check => 26,
        SetupStep::Calibrate(wanted) => match wanted.which {
            WizardKind::Frame(FrameKind::Mount) => 60,
            WizardKind::Frame(FrameKind::Tip | FrameKind::HandEye) => 40,
            WizardKind::Frame(FrameKind::Table) => 30,
            WizardKind::Frame(FrameKind::View) => 15,
            WizardKind::Frame(FrameKind::Trocar) | WizardKind::Correspondence => 12,
            WizardKind::Gravity => 42,
            WizardKind::TipForce => 147,
            // It has no tile.
            WizardKind::Camera => 0,
        },
    }
}

/// Returns the devices of this arm, and those that both arms share.
fn devices(side: Side, live: &LiveState) -> SetupTile {
    let is_of_arm = |place: usize| {
        let part = live.roster.get(place).and_then(|entry| entry.part);
        part.and_then(RigPart::side).is_none_or(|of| of == side)
    };
    let count = (0..live.roster.len()).filter(|place| is_of_arm(*place)).count();
    let missing: Vec<String> = live
        .missing()
        .filter(|device| is_of_arm(device.place))
        .map(|device| format!("{}: {}", device.name, device.cause))
        .collect();
    let (state, why) = match (missing.first(), count) {
        (Some(_), _) => (StepState::Missing, missing.join("\n")),
        (None, 0) => (StepState::Done, text::overview::SIMULATED.get().to_owned()),
        (None, count) => (StepState::Done, text::overview::all_connected(count)),
    };
    SetupTile { name: text::devices::NAME.get(), state, why, step: SetupStep::Devices }
}

fn calibration(line: &OverviewLine) -> SetupTile {
    let (state, why) = match &line.kept {
        Err(why) => (StepState::Missing, why.clone()),
        Ok(None) => (StepState::Missing, text::overview::NEVER.get().to_owned()),
        Ok(Some(kept)) => {
            let words = [verdict_text(kept), made_text(kept), line.since.clone()];
            let words: Vec<String> = words.into_iter().filter(|words| !words.is_empty()).collect();
            (state_of(kept), words.join("\n"))
        }
    };
    SetupTile { name: line.wanted.name(), state, why, step: SetupStep::Calibrate(line.wanted) }
}

fn state_of(kept: &CalibrationEntry) -> StepState {
    let is_refused = |judgement: &Judgement| !judgement.allows();
    let is_overridden = |judgement: &Judgement| judgement.override_by.is_some();
    match &kept.judgement {
        Some(judgement) if is_refused(judgement) => StepState::Missing,
        Some(judgement) if !is_overridden(judgement) && kept.age == CalibrationAge::Fresh => StepState::Done,
        _ => StepState::Doubtful,
    }
}

fn ready(live: &LiveState, check: Option<&ReadyRecord>) -> SetupTile {
    let (state, why) = match check {
        Some(check) if !check.passed => (StepState::Missing, text::overview::check_failed(day(&check.date))),
        Some(check) if live.is_unchecked => (StepState::Doubtful, text::overview::check_outdated(day(&check.date))),
        Some(check) => (StepState::Done, text::overview::check_passed(day(&check.date))),
        None if live.is_unchecked => (StepState::Missing, text::overview::NEVER_CHECKED.get().to_owned()),
        None => (StepState::Doubtful, text::overview::NEVER_CHECKED.get().to_owned()),
    };
    SetupTile { name: text::overview::READY_TILE.get(), state, why, step: SetupStep::Check }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_progress_counts_what_is_done_and_the_time_of_the_rest() {
        let tile = |which: WizardKind, state: StepState| {
            let step = SetupStep::Calibrate(CalibrationTarget { side: Side::Right, which, by_handle: false });
            SetupTile { name: "", state, why: String::new(), step }
        };
        let gravity = tile(WizardKind::Gravity, StepState::Done);
        let tip_force = tile(WizardKind::TipForce, StepState::Doubtful);
        let half = progress_text(&[vec![gravity.clone(), tip_force]]);
        assert_eq!(half, "1 of 2 done, at least 3 min left");
        assert_eq!(progress_text(&[vec![gravity]]), "1 of 1 done");
    }
}
