//! The tiles of the set-up page: for each arm its devices, its calibrations and the ready check, each with its state.

use nima_core::calibration::Judgement;
use nima_machine::rig::{RigPart, Side};
use nima_recording::store::{CalibrationAge, ReadyRecord};
use nima_screen::live::LiveState;
use nima_words::text;

use nima_calibrations::{
    CalibrationTarget,
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
