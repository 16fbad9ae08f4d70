//! The calibrations in force for the scene's sensor and tool, as the screen tells them and as the loop gets them.

use crate::console::text;
use std::{
    path::{Path, PathBuf},
    time::SystemTime,
};

use nima::{
    calibration::{
        correspondence::{Correspondence, CorrespondenceRecord},
        gravity::{Drift, DriftCheck, GravityRecord, StillSettings},
        store::{Age, Loaded, Record, Store, utc_now},
    },
    config::{Rig, Scene},
    device::Prompt,
    runtime::Tick,
    teleop::{Calibrations, LoopState},
    tip_force::{Model, TipForce},
};

use super::wizards::{Binding, Saving};

/// What is in force, and what stood in the way.
#[derive(Debug, Default)]
pub struct InForce {
    store: Option<Store>,
    /// The sensor and tool that the calibrations are for; none where the force is measured at the tip.
    bound: Option<(String, String)>,
    gravity: Option<Loaded<GravityRecord>>,
    correspondence: Option<Loaded<CorrespondenceRecord>>,
    tip_force: Option<Loaded<Model>>,
    /// How gravity stands since the loop began, and when that was found.
    drift: Option<(DriftCheck, String)>,
    told: Option<String>,
}

impl InForce {
    /// What the store in `folder` (or the user's own) holds for the sensor and tool of `scene`.
    pub fn load(folder: Option<&Path>, scene: &Scene) -> Self {
        let store = folder.map_or_else(|| Store::of_user().ok(), |folder| Some(Store::open(folder)));
        let mut this = Self { store, ..Self::default() };
        this.bind(scene);
        this
    }

    /// Goes over to the sensor and tool of `scene`.
    pub fn bind(&mut self, scene: &Scene) {
        self.bound = scene.wrist.as_ref().map(|wrist| (wrist.serial.clone(), wrist.tool.clone()));
        let (Some(store), Some((sensor, tool))) = (&self.store, &self.bound) else {
            (self.gravity, self.correspondence, self.tip_force, self.drift) = (None, None, None, None);
            return;
        };
        let now = SystemTime::now();
        self.gravity = usable(text::calibrations::GRAVITY, store.load(sensor, tool, now), &mut self.told);
        self.correspondence = usable(text::calibrations::CORRESPONDENCE, store.load(sensor, tool, now), &mut self.told);
        self.tip_force = usable(text::calibrations::TIP_FORCE, Model::kept(store, sensor, tool, now), &mut self.told);
        self.drift = self.gravity.as_ref().map(|Loaded { record, .. }| {
            (DriftCheck::new(record.model, record.drift_limit_n(), StillSettings::default()), String::new())
        });
    }

    /// Takes in one tick of the loop: in the first seconds, idle and still, it shows whether the bias is where it was.
    pub fn watch(&mut self, tick: &Tick) {
        let Some((check, found_at)) = &mut self.drift else { return };
        let idle = match tick.state {
            LoopState::Idle if tick.prompt == Prompt::Rest => true,
            LoopState::Engaged => false,
            // Somebody guides the arm, or what is shown is not new.
            _ => return,
        };
        let before = check.drift();
        if check.step(tick.wrist.as_ref(), idle, tick.t_s) != before {
            utc_now().get(11..16).unwrap_or_default().clone_into(found_at);
        }
    }

    /// How gravity stands since the loop began; none where nothing is to be checked.
    pub fn drift(&self) -> Option<Drift> {
        self.drift.as_ref().map(|(check, _)| check.drift())
    }

    /// By how much the bias has moved, if it has, N.
    pub fn bias_moved_n(&self) -> Option<f64> {
        match self.drift() {
            Some(Drift::Moved { by_n }) => Some(by_n),
            _ => None,
        }
    }

    /// For the loop of this rig.
    pub fn calibrations(&mut self, rig: &Rig) -> Calibrations {
        let model = self.tip_force.as_ref().map(|loaded| loaded.record.clone());
        let tip_force = model.map(|model| TipForce::new(model, rig.tip_force.fallback)).transpose();
        Calibrations {
            gravity: self.gravity.as_ref().map(|loaded| loaded.record.model),
            tip_force: usable(text::calibrations::TIP_FORCE, tip_force, &mut self.told),
        }
    }

    /// How the sensor under the tissue is turned, if that is known.
    pub fn correspondence(&self) -> Option<Correspondence> {
        self.correspondence.as_ref().map(|loaded| loaded.record.correspondence())
    }

    /// What a new calibration would belong to.
    pub fn binding(&self) -> Binding {
        let (sensor, tool) = self.bound.clone().unwrap_or_default();
        Binding { sensor, tool, date: utc_now(), correspondence: self.correspondence(), store: self.store.clone() }
    }

    /// Keeps a record and takes it into force; words for the screen.
    pub fn save(&mut self, saving: Saving) -> Result<String, String> {
        let store = self.store.as_ref().ok_or(text::calibrations::NO_FOLDER_FOR_CALIBRATIONS)?;
        let path = match saving {
            Saving::Gravity(record) => kept(store, *record, &mut self.gravity)?,
            Saving::Correspondence(record) => kept(store, *record, &mut self.correspondence)?,
            Saving::TipForce(model) => {
                let path = model.keep(store).map_err(|error| in_one_line(&error))?;
                self.tip_force = Some(Loaded { record: *model, age: Age::Fresh, path: path.clone() });
                path
            }
        };
        self.told = None;
        Ok(text::calibrations::saved(&path))
    }

    /// Something that went wrong, for the card.
    pub fn tell(&mut self, words: String) {
        self.told = Some(words);
    }

    /// The last thing that went wrong.
    pub fn told(&self) -> Option<&str> {
        self.told.as_deref()
    }

    /// One line for each calibration that matters to this rig.
    pub fn lines(&self) -> Vec<String> {
        let Some((sensor, tool)) = &self.bound else {
            return vec![text::calibrations::THIS_SCENE_MEASURES_AT.to_owned()];
        };
        let gravity =
            self.gravity.as_ref().map_or_else(|| text::calibrations::GRAVITY_NONE.to_owned(), line_of_gravity);
        let correspondence = self
            .correspondence
            .as_ref()
            .map_or_else(|| text::calibrations::CORRESPONDENCE_NONE.to_owned(), line_of_correspondence);
        let tip_force =
            self.tip_force.as_ref().map_or_else(|| text::calibrations::TIP_FORCE_NONE.to_owned(), line_of_tip_force);
        let mut lines = vec![text::calibrations::bound_to(sensor, tool), gravity];
        lines.extend(self.drift.as_ref().map(line_of_drift));
        lines.extend([correspondence, tip_force]);
        lines
    }
}

/// What was loaded; a file that cannot be used is told.
fn usable<R>(what: &str, loaded: Result<Option<R>, impl std::error::Error>, told: &mut Option<String>) -> Option<R> {
    loaded.unwrap_or_else(|error| {
        *told = Some(text::calibrations::not_in_force(what, &in_one_line(&error)));
        None
    })
}

/// Saves and takes into force; gives the path.
fn kept<R: Record>(store: &Store, record: R, in_force: &mut Option<Loaded<R>>) -> Result<PathBuf, String> {
    let path = store.save(&record).map_err(|error| in_one_line(&error))?;
    *in_force = Some(Loaded { record, age: Age::Fresh, path: path.clone() });
    Ok(path)
}

fn line_of_gravity(loaded: &Loaded<GravityRecord>) -> String {
    let GravityRecord { residuals, poses, override_by, .. } = &loaded.record;
    let (day, remarks) = (day(&loaded.record), remarks(loaded.age, override_by.as_deref()));
    let error_n = residuals.held_out.mean_mae();
    text::calibrations::gravity(day, *poses, error_n, &remarks)
}

fn line_of_drift((check, found_at): &(DriftCheck, String)) -> String {
    let words = check.drift().words();
    match check.drift() {
        Drift::Fine { .. } | Drift::Moved { .. } => text::calibrations::bias_checked(found_at, &words),
        Drift::Waiting | Drift::NotChecked(_) => text::calibrations::bias(&words),
    }
}

fn line_of_correspondence(loaded: &Loaded<CorrespondenceRecord>) -> String {
    let CorrespondenceRecord { agreement, pairs, uncertainty_deg, override_by, .. } = &loaded.record;
    let (day, remarks) = (day(&loaded.record), remarks(loaded.age, override_by.as_deref()));
    let error_n = agreement.residuals.held_out.mean_mae();
    text::calibrations::correspondence(day, *pairs, error_n, *uncertainty_deg, &remarks)
}

fn line_of_tip_force(loaded: &Loaded<Model>) -> String {
    let origin = &loaded.record.origin;
    let Some(check) = &origin.check else { return text::calibrations::TIP_FORCE_NEVER_CHECKED.to_owned() };
    let error_n = check.mae_n.iter().sum::<f64>() / 3.0;
    let remarks = remarks(loaded.age, check.override_by.as_deref());
    text::calibrations::tip_force(day_of(&origin.date), origin.rows, error_n, &remarks)
}

fn day(record: &impl Record) -> &str {
    day_of(record.date())
}

fn day_of(date: &str) -> &str {
    date.split('T').next().unwrap_or_default()
}

/// What to know of a record before it is trusted; empty when there is nothing.
fn remarks(age: Age, override_by: Option<&str>) -> String {
    let age = match age {
        Age::Fresh => String::new(),
        Age::Old { days } => text::calibrations::days_old(days),
        Age::Future => text::calibrations::MADE_IN_THE_FUTURE.to_owned(),
    };
    let overridden = override_by.map_or_else(String::new, text::calibrations::not_proven);
    age + &overridden
}

fn in_one_line(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        words = format!("{words}: {cause}");
        source = cause.source();
    }
    words
}
