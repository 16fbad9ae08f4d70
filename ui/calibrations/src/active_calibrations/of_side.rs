//! The active calibrations of one side, for one wrist sensor with one tool.

use std::{path::PathBuf, time::SystemTime};

use nima_core::{
    calibration::{
        CalibrationRecord,
        correspondence::CorrespondenceRecord,
        gravity::{DriftCheck, GravityDrift, GravityModel, GravityRecord, StillSettings},
    },
    tip_force::{Fallback, ForceModel, LiveTipForce},
};
use nima_machine::{
    messages::{LoopState, Tick},
    ready::ReadyPoint,
    rig::{Prompt, Side},
    runtime::WristChange,
    teleop::{Calibrations, GravityCheck},
};
use nima_recording::{
    store::{CalibrationAge, LoadedRecord, ReadyRecord, Store, WristId, utc_now},
    tip_force::{keep_model, kept_model},
};
use nima_words::{report_text::chain, text};

use super::in_use::InUse;
use crate::{
    CalibrationTarget, SaveRequest, WizardKind,
    overview::{CalibrationEntry, OverviewLine, found_since},
};

/// The sensor and tool whose calibrations are used on a side.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) enum SideBinding {
    /// No calibration is used: the force is measured at the tip, or there is no such arm.
    #[default]
    Nothing,
    /// The sensor has not reported its identity yet.
    Waiting,
    /// The sensor cannot report its identity: cause and remedy.
    Nameless(&'static str),
    /// This sensor with this tool.
    To(WristId),
}

/// The calibrations of a side, and problems with them.
#[derive(Debug, Default)]
pub(super) struct SideCalibrations {
    pub(super) bound: SideBinding,
    /// State of the sensor's connection for which these are valid.
    pub(super) since: Option<WristChange>,
    /// Last known sensor and tool.
    pub(super) last: Option<WristId>,
    pub(super) correspondence: Option<LoadedRecord<CorrespondenceRecord>>,
    /// Calibrations whose files cannot be used, with the reason.
    unusable: Vec<(WizardKind, String)>,
    /// Other sensors with a calibration for the same tool.
    others: Vec<String>,
    gravity: Option<LoadedRecord<GravityRecord>>,
    tip_force: Option<LoadedRecord<ForceModel>>,
    /// Result of the bias check since the loop started, and its time.
    drift: Option<(DriftCheck, String)>,
    /// Performance of the network since the loop started.
    in_use: InUse,
}

impl SideCalibrations {
    /// Loads the calibrations of this sensor and tool from the store; `last` are the sensor and tool known before.
    pub(super) fn load(store: Option<&Store>, bound: SideBinding, last: Option<WristId>) -> Self {
        let mut this = Self { bound, ..Self::default() };
        this.last = this.wrist().cloned().or(last);
        let (Some(store), SideBinding::To(wrist)) = (store, &this.bound) else { return this };
        let WristId { serial_number, tool } = wrist;
        let now = SystemTime::now();
        let bad = &mut this.unusable;
        this.tip_force = usable(WizardKind::TipForce, kept_model(store, serial_number, tool, now), bad);
        this.correspondence = usable(WizardKind::Correspondence, store.load(serial_number, tool, now), bad);
        this.gravity = usable(WizardKind::Gravity, store.load(serial_number, tool, now), bad);
        this.drift = this.gravity.as_ref().map(|LoadedRecord { record, .. }| {
            (DriftCheck::new(record.model, record.drift_limit_n(), StillSettings::default()), String::new())
        });
        this.others = store.other_sensors::<GravityRecord>(wrist);
        this
    }

    pub(super) const fn wrist(&self) -> Option<&WristId> {
        match &self.bound {
            SideBinding::To(wrist) => Some(wrist),
            _ => None,
        }
    }

    /// Returns the sensor and tool, if they are known and have no gravity calibration.
    pub(super) fn without_gravity(&self) -> Option<&WristId> {
        self.wrist().filter(|_| self.gravity.is_none())
    }

    /// Returns the gravity calibration, and the limit of the remaining force at rest, N.
    pub(super) fn gravity(&self) -> Option<(GravityModel, f64)> {
        self.gravity.as_ref().map(|loaded| (loaded.record.model, loaded.record.drift_limit_n()))
    }

    /// Returns the calibrations of the force, in the order of use; `last` is the last ready check.
    pub(super) fn kept(&self, side: Side, last: Option<&ReadyRecord>) -> Vec<OverviewLine> {
        let gravity = self.gravity.as_ref().map(|LoadedRecord { record, age, .. }| {
            kept_of(record, *age, text::overview::newton(record.residuals.held_out.mean_mae()))
        });
        let bias = gravity.as_ref().map(|kept| match self.drift() {
            Some(drift @ (GravityDrift::Fine { .. } | GravityDrift::Moved { .. })) => {
                nima_words::report_text::drift(drift)
            }
            drift => found_since(last, ReadyPoint::Bias(side), &kept.date)
                .or_else(|| drift.map(nima_words::report_text::drift))
                .unwrap_or_default(),
        });
        let correspondence = self.correspondence.as_ref().map(|LoadedRecord { record, age, .. }| {
            kept_of(record, *age, text::overview::newton(record.agreement.residuals.held_out.mean_mae()))
        });
        let tip_force = self.tip_force.as_ref().map(|LoadedRecord { record, age, .. }| {
            let check = record.origin.check.as_ref();
            CalibrationEntry {
                date: record.origin.date.clone(),
                age: *age,
                judgement: check.map(|check| check.judgement.clone()),
                error: check
                    .map_or_else(String::new, |check| text::overview::newton(check.mae_n.iter().sum::<f64>() / 3.0)),
            }
        });
        let of_correspondence = correspondence.as_ref().map(|_| text::overview::FOR_TRAINING_ONLY.get().to_owned());
        let of_tip_force = tip_force.as_ref().map(|_| match self.in_use.fractions() {
            Some(fractions) => text::overview::in_use(fractions.outside, fractions.without),
            None => text::overview::NOT_USED.get().to_owned(),
        });
        [
            (WizardKind::Gravity, gravity, bias),
            (WizardKind::Correspondence, correspondence, of_correspondence),
            (WizardKind::TipForce, tip_force, of_tip_force),
        ]
        .map(|(which, kept, since)| OverviewLine {
            wanted: CalibrationTarget { side, which, by_handle: false },
            kept: match (kept, self.unusable.iter().find(|(what, _)| *what == which)) {
                (None, Some((_, why))) => Err(why.clone()),
                (kept, _) => Ok(kept),
            },
            since: since.unwrap_or_default(),
        })
        .into()
    }

    /// Returns whether a calibration is dated in the future.
    pub(super) fn is_from_the_future(&self) -> bool {
        let ages = [
            self.gravity.as_ref().map(|loaded| loaded.age),
            self.correspondence.as_ref().map(|loaded| loaded.age),
            self.tip_force.as_ref().map(|loaded| loaded.age),
        ];
        ages.contains(&Some(CalibrationAge::Future))
    }

    /// Returns the names of the missing calibrations. The correspondence is needed only to train the network.
    pub(super) fn lacks(&self) -> Vec<&'static str> {
        let correspondence = self.correspondence.is_some() || self.tip_force.is_some();
        let needed = [
            (text::calibrations::GRAVITY.get(), self.gravity.is_some()),
            (text::calibrations::CORRESPONDENCE.get(), correspondence),
            (text::calibrations::TIP_FORCE.get(), self.tip_force.is_some()),
        ];
        needed.into_iter().filter(|(_, there)| !there).map(|(name, _)| name).collect()
    }

    /// Returns the sensor of this side, if it has no gravity calibration with the tool here and the other side's sensor
    /// has one.
    pub(super) fn is_exchanged_with(&self, across: &Self) -> Option<&WristId> {
        let other = &across.wrist()?.serial_number;
        self.without_gravity().filter(|_| self.others.contains(other))
    }

    /// Returns problems and remedies; `across` is the wrist sensor of the other arm.
    pub(super) fn report(&self, across: Option<&WristId>) -> Option<String> {
        let elsewhere = |sensor: &&str| across.is_none_or(|across| across.serial_number != *sensor);
        let others: Vec<_> = self.others.iter().map(String::as_str).filter(elsewhere).collect();
        let swapped = self.without_gravity().filter(|_| !others.is_empty());
        let unusable = self.unusable.iter().map(|(what, why)| text::calibrations::not_active(what.name(), why));
        let unusable = unusable.collect::<Vec<_>>();
        Some(unusable.join(". ")).filter(|words| !words.is_empty()).or_else(|| {
            swapped.map(|wrist| {
                text::calibrations::other_sensors_are_calibrated(&wrist.serial_number, &wrist.tool, &others.join(", "))
            })
        })
    }

    /// Adds one tick of this side. In the first seconds, idle and still, ticks show whether the bias has changed; engaged,
    /// whether the network fits the work.
    pub(super) fn watch(&mut self, tick: &Tick) {
        self.in_use.watch(tick);
        let Some((check, found_at)) = &mut self.drift else { return };
        let idle = match tick.state {
            LoopState::Idle if tick.guidance.prompt == Prompt::Rest => true,
            LoopState::Engaged => false,
            // A person is guiding the arm, or the sample is not new.
            _ => return,
        };
        let before = check.drift();
        if check.step(tick.calibration.wrist.as_ref(), idle, tick.t_s) != before {
            utc_now().get(11..16).unwrap_or_default().clone_into(found_at);
        }
    }

    /// Returns the result of the bias check; `None` if there is nothing to check.
    pub(super) fn drift(&self) -> Option<GravityDrift> {
        self.drift.as_ref().map(|(check, _)| check.drift())
    }

    /// Returns the calibrations in the form that the loop uses.
    pub(super) fn calibrations(&mut self, fallback: Fallback) -> Calibrations {
        let model = self.tip_force.as_ref().map(|loaded| loaded.record.clone());
        let tip_force = model.map(|model| LiveTipForce::new(model, fallback)).transpose();
        Calibrations {
            gravity: self.gravity.as_ref().map(|loaded| loaded.record.model),
            tip_force: usable(WizardKind::TipForce, tip_force, &mut self.unusable),
            gravity_check: self.gravity.as_ref().map(|loaded| GravityCheck::of(&loaded.record)),
        }
    }

    /// Saves a record and activates it; returns its path.
    pub(super) fn save(&mut self, store: &Store, saving: SaveRequest) -> Result<PathBuf, String> {
        let (saved, path) = match saving {
            SaveRequest::Gravity(record) => (WizardKind::Gravity, kept(store, *record, &mut self.gravity)?),
            SaveRequest::Correspondence(record) => {
                (WizardKind::Correspondence, kept(store, *record, &mut self.correspondence)?)
            }
            SaveRequest::TipForce(model) => {
                let path = keep_model(&model, store).map_err(|error| chain(&error))?;
                self.tip_force = Some(LoadedRecord { record: *model, age: CalibrationAge::Fresh, path: path.clone() });
                (WizardKind::TipForce, path)
            }
            SaveRequest::Frame(_) | SaveRequest::Camera(_) | SaveRequest::Undo(_) => {
                return Err(text::calibrations::NOT_OF_A_SENSOR.get().to_owned());
            }
        };
        self.unusable.retain(|(what, _)| *what != saved);
        Ok(path)
    }

    /// Returns one line for each calibration that this side requires, with the side's name if there are two sides.
    pub(super) fn lines(&self, side: Option<&str>) -> Vec<String> {
        let of_side = |words: String| side.map_or_else(|| words.clone(), |side| format!("{side}: {words}"));
        let wrist = match &self.bound {
            SideBinding::Nothing => return Vec::new(),
            SideBinding::Waiting => return vec![of_side(text::calibrations::SENSOR_NOT_CONNECTED.get().to_owned())],
            SideBinding::Nameless(why) => return vec![of_side((*why).to_owned())],
            SideBinding::To(wrist) => wrist,
        };
        let gravity =
            self.gravity.as_ref().map_or_else(|| text::calibrations::GRAVITY_NONE.get().to_owned(), line_of_gravity);
        let correspondence = self
            .correspondence
            .as_ref()
            .map_or_else(|| text::calibrations::CORRESPONDENCE_NONE.get().to_owned(), line_of_correspondence);
        let tip_force = self
            .tip_force
            .as_ref()
            .map_or_else(|| text::calibrations::TIP_FORCE_NONE.get().to_owned(), line_of_tip_force);
        let bound_to = text::calibrations::bound_to(&wrist.serial_number, &wrist.tool);
        let mut lines = vec![of_side(bound_to), gravity];
        lines.extend(self.drift.as_ref().map(line_of_drift));
        lines.extend([correspondence, tip_force]);
        lines
    }
}

fn kept_of(record: &impl CalibrationRecord, age: CalibrationAge, error: String) -> CalibrationEntry {
    CalibrationEntry { date: record.head().date.clone(), age, judgement: Some(record.judgement().clone()), error }
}

/// Returns the loaded record; if its file cannot be used, the reason is stored.
fn usable<R>(
    what: WizardKind,
    loaded: Result<Option<R>, impl std::error::Error>,
    unusable: &mut Vec<(WizardKind, String)>,
) -> Option<R> {
    loaded.unwrap_or_else(|error| {
        unusable.retain(|(known, _)| *known != what);
        unusable.push((what, chain(&error)));
        None
    })
}

/// Saves a record and activates it; returns its path.
fn kept<R: CalibrationRecord>(
    store: &Store,
    record: R,
    active: &mut Option<LoadedRecord<R>>,
) -> Result<PathBuf, String> {
    let path = store.save(&record).map_err(|error| chain(&error))?;
    *active = Some(LoadedRecord { record, age: CalibrationAge::Fresh, path: path.clone() });
    Ok(path)
}

fn line_of_gravity(loaded: &LoadedRecord<GravityRecord>) -> String {
    let GravityRecord { residuals, poses, judgement, .. } = &loaded.record;
    let day = day(&loaded.record);
    let remarks = remarks(loaded.age, judgement.override_by.as_deref());
    let error_n = residuals.held_out.mean_mae();
    text::calibrations::gravity(day, *poses, error_n, &remarks)
}

fn line_of_drift((check, found_at): &(DriftCheck, String)) -> String {
    let words = nima_words::report_text::drift(check.drift());
    match check.drift() {
        GravityDrift::Fine { .. } | GravityDrift::Moved { .. } => text::calibrations::bias_checked(found_at, &words),
        GravityDrift::Waiting | GravityDrift::NotChecked(_) => text::calibrations::bias(&words),
    }
}

fn line_of_correspondence(loaded: &LoadedRecord<CorrespondenceRecord>) -> String {
    let CorrespondenceRecord { agreement, pairs, uncertainty_deg, judgement, .. } = &loaded.record;
    let day = day(&loaded.record);
    let remarks = remarks(loaded.age, judgement.override_by.as_deref());
    let error_n = agreement.residuals.held_out.mean_mae();
    text::calibrations::correspondence(day, *pairs, error_n, *uncertainty_deg, &remarks)
}

fn line_of_tip_force(loaded: &LoadedRecord<ForceModel>) -> String {
    let origin = &loaded.record.origin;
    let Some(check) = &origin.check else { return text::calibrations::TIP_FORCE_UNCHECKED.get().to_owned() };
    let error_n = check.mae_n.iter().sum::<f64>() / 3.0;
    let remarks = remarks(loaded.age, check.judgement.override_by.as_deref());
    text::calibrations::tip_force(day_of(&origin.date), origin.rows, error_n, &remarks)
}

fn day(record: &impl CalibrationRecord) -> &str {
    day_of(&record.head().date)
}

fn day_of(date: &str) -> &str {
    date.split('T').next().unwrap_or_default()
}

/// Returns the warnings about a record; empty if there are none.
fn remarks(age: CalibrationAge, override_by: Option<&str>) -> String {
    let age = match age {
        CalibrationAge::Fresh => String::new(),
        CalibrationAge::Old { days } => text::calibrations::days_old(days),
        CalibrationAge::Future => text::calibrations::REMARK_FUTURE_DATE.get().to_owned(),
    };
    let overridden = override_by.map_or_else(String::new, text::calibrations::not_proven);
    age + &overridden
}
