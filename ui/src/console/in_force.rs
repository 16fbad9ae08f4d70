//! The calibrations in force for the scene's sensor and tool, as the screen tells them and as the loop gets them.

use std::{path::Path, time::SystemTime};

use nima::{
    calibration::{
        gravity::GravityRecord,
        store::{Age, Loaded, Record, Store, utc_now},
    },
    config::Scene,
    teleop::Calibrations,
};

use super::wizards::{Binding, Saving};

/// What is in force, and what stood in the way.
#[derive(Debug, Default)]
pub struct InForce {
    store: Option<Store>,
    /// The sensor and tool that the calibrations are for; none where the force is measured at the tip.
    bound: Option<(String, String)>,
    gravity: Option<Loaded<GravityRecord>>,
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
            self.gravity = None;
            return;
        };
        match store.load(sensor, tool, SystemTime::now()) {
            Ok(loaded) => self.gravity = loaded,
            Err(error) => {
                self.gravity = None;
                self.told = Some(format!("Gravity is not in force: {error}"));
            }
        }
    }

    /// For the loop.
    pub fn calibrations(&self) -> Calibrations {
        Calibrations { gravity: self.gravity.as_ref().map(|loaded| loaded.record.model) }
    }

    /// What a new calibration would belong to.
    pub fn binding(&self) -> Binding {
        let (sensor, tool) = self.bound.clone().unwrap_or_default();
        Binding { sensor, tool, date: utc_now() }
    }

    /// Keeps a record and takes it into force; words for the screen.
    pub fn save(&mut self, saving: Saving) -> Result<String, String> {
        let store = self.store.as_ref().ok_or("no folder for calibrations is known; set NIMA_DATA_DIR")?;
        let Saving::Gravity(record) = saving;
        let path = store.save(&record).map_err(|error| in_one_line(&error))?;
        let words = format!("Saved and in force: {}.", path.display());
        self.gravity = Some(Loaded { record, age: Age::Fresh, path });
        self.told = None;
        Ok(words)
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
            return vec!["This scene measures at the tip; a wrist sensor needs calibrations.".to_owned()];
        };
        let gravity = self.gravity.as_ref().map_or_else(|| "Gravity: none".to_owned(), line_of_gravity);
        vec![format!("Sensor {sensor}, {tool}"), gravity]
    }
}

fn line_of_gravity(loaded: &Loaded<GravityRecord>) -> String {
    let GravityRecord { residuals, poses, override_by, .. } = &loaded.record;
    let day = loaded.record.date().split('T').next().unwrap_or_default();
    let age = match loaded.age {
        Age::Fresh => String::new(),
        Age::Old { days } => format!("; {days} days old, repeat it"),
        Age::Future => "; made in the future, check the clock".to_owned(),
    };
    let overridden = override_by.as_ref().map_or_else(String::new, |name| format!("; NOT PROVEN, kept by {name}"));
    let error_n = residuals.held_out.mean_mae();
    format!("Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{age}{overridden}")
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
