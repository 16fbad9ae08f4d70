//! The set-up of a rig: for every arm with its sensor the devices, each calibration with its age, its verdict and later
//! changes, and the ready check.

#[cfg(test)]
mod tests;

use std::time::SystemTime;

use nima_core::calibration::Judgement;
use nima_machine::{
    config::{RigConfig, RigFile},
    ready::ReadyPoint,
    rig::Side,
};
use nima_recording::store::{CalibrationAge, PointOutcome, ReadyRecord, Store, WristId, days_since};
use nima_words::{
    report_text::{ShortText as _, chain, check_name},
    text,
};

use crate::{
    CalibrationTarget, WizardKind,
    active_calibrations::ActiveCalibrations,
    frames::{FrameKind, StoredFrame, frame_kept, sizes_text},
};

/// A saved calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationEntry {
    /// UTC, ISO 8601.
    pub date: String,
    pub age: CalibrationAge,
    /// `None` for a network that was never checked.
    pub judgement: Option<Judgement>,
    /// Error on held-out data, with its unit.
    pub error: String,
}

/// One line of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct OverviewLine {
    pub wanted: CalibrationTarget,
    /// The saved calibration: `None` if it was never calibrated, an error if its file cannot be used.
    pub kept: Result<Option<CalibrationEntry>, String>,
    /// Changes since the calibration.
    pub since: String,
}

impl OverviewLine {
    /// Returns whether nothing needs to be done: proven, and neither old nor overridden.
    pub fn is_in_order(&self) -> bool {
        let Ok(Some(kept)) = &self.kept else { return false };
        let is_proven = |judgement: &Judgement| judgement.allows() && judgement.override_by.is_none();
        kept.age == CalibrationAge::Fresh && kept.judgement.as_ref().is_some_and(is_proven)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct ArmOverview {
    pub side: Side,
    /// Sensor and tool; `None` until the sensor has reported its identity.
    pub wrist: Option<WristId>,
    pub lines: Vec<OverviewLine>,
}

/// Returns the list of every arm with calibrations, for the rig of this name.
pub fn overview(active: &ActiveCalibrations, rig: &RigConfig, name: &str) -> Vec<ArmOverview> {
    let has_joints = rig.devices.is_some();
    let last = active.store().and_then(|store| store.last_check(&rig.name));
    let file = RigFile::of(name).ok();
    let sides = Side::ALL.into_iter().filter(|side| active.is_at_wrist(*side));
    let of_arm = |side: Side| {
        // Without the sensor, it is unknown which calibrations belong to this arm.
        let wrist = active.wrist(side).cloned();
        let mut lines = Vec::new();
        if let (true, Some(store), Some(wrist)) = (has_joints, active.store(), &wrist) {
            lines.extend(frames(store, wrist, side, last.as_ref(), file.as_ref()));
        }
        lines.extend(wrist.iter().flat_map(|_| active.kept(side, last.as_ref())));
        ArmOverview { side, wrist, lines }
    };
    sides.map(of_arm).collect()
}

/// Returns the next calibration after this one (from the start without one): the first that needs work. The one just
/// saved is not suggested again.
pub fn following(arms: &[ArmOverview], after: Option<CalibrationTarget>) -> Option<CalibrationTarget> {
    let all: Vec<&OverviewLine> = arms.iter().flat_map(|arm| &arm.lines).collect();
    let from = all.iter().position(|line| Some(line.wanted) == after).map_or(0, |place| place + 1);
    let (before, behind) = all.split_at(from);
    let mut open = behind.iter().chain(before).filter(|line| !line.is_in_order() && Some(line.wanted) != after);
    open.next().map(|line| line.wanted)
}

fn frames(
    store: &Store,
    wrist: &WristId,
    side: Side,
    last: Option<&ReadyRecord>,
    file: Option<&RigFile>,
) -> Vec<OverviewLine> {
    let of_wrist = [wrist.serial_number.as_str(), wrist.tool.as_str()];
    let line = |kind: FrameKind, by_handle: bool| {
        let found = frame_kept(store, kind, by_handle, of_wrist);
        let since = match &found {
            Ok(Some(kept)) if kind == FrameKind::Trocar => {
                found_since(last, ReadyPoint::Trocar(side), &kept.date).unwrap_or_else(|| in_file(kept, file))
            }
            Ok(Some(kept)) => in_file(kept, file),
            _ => String::new(),
        };
        let kept = found.map_err(|error| chain(&error)).map(|kept| kept.map(CalibrationEntry::from));
        OverviewLine { wanted: CalibrationTarget { side, which: WizardKind::Frame(kind), by_handle }, kept, since }
    };
    let lines = FrameKind::ALL.into_iter().flat_map(|kind| {
        let handle = (kind == FrameKind::View).then(|| line(kind, true));
        std::iter::once(line(kind, false)).chain(handle)
    });
    lines.collect()
}

impl From<StoredFrame> for CalibrationEntry {
    fn from(kept: StoredFrame) -> Self {
        let StoredFrame { date, age, judgement, held_out, .. } = kept;
        Self { date, age, judgement: Some(judgement), error: sizes_text(held_out).unwrap_or_default() }
    }
}

/// States whether the rig file still has the values that the calibration wrote.
fn in_file(kept: &StoredFrame, file: Option<&RigFile>) -> String {
    let Some(file) = file.filter(|_| !kept.rig.is_empty()) else { return text::overview::NOT_WATCHED.get().to_owned() };
    let same = kept.rig.iter().all(|change| file.value(&change.key) == change.after);
    if same { text::overview::IN_FILE.get() } else { text::overview::OTHER_IN_FILE.get() }.to_owned()
}

/// Returns the result of the last ready check for this point, if it was run after the calibration of this date.
pub fn found_since(last: Option<&ReadyRecord>, check: ReadyPoint, date: &str) -> Option<String> {
    // Dates in this format sort as text.
    let last = last.filter(|last| last.date.as_str() >= date)?;
    let item = last.items.iter().find(|item| item.check == check_name(check))?;
    let found = match (item.outcome, item.value.zip(item.limit), &item.cause) {
        (PointOutcome::Passed, Some((value, limit)), _) => {
            text::overview::within(value, limit, item.unit.as_deref().unwrap_or_default())
        }
        (PointOutcome::Failed, _, Some(cause)) => cause.clone(),
        _ => return None,
    };
    Some(text::overview::checked(day(&last.date), &found))
}

pub fn day(date: &str) -> &str {
    date.split('T').next().unwrap_or_default()
}

pub fn made_text(kept: &CalibrationEntry) -> String {
    let age = match kept.age {
        CalibrationAge::Future => text::overview::FUTURE.get().to_owned(),
        CalibrationAge::Fresh | CalibrationAge::Old { .. } => {
            days_since(&kept.date, SystemTime::now()).map_or_else(String::new, text::overview::days)
        }
    };
    text::overview::made(day(&kept.date), &age)
}

pub fn verdict_text(kept: &CalibrationEntry) -> String {
    let Some(judgement) = &kept.judgement else { return text::overview::UNCHECKED.get().to_owned() };
    let words = text::overview::verdict(judgement.verdict.words(), &kept.error);
    judgement.override_by.as_ref().map_or_else(|| words.clone(), |name| text::overview::overridden(&words, name))
}
