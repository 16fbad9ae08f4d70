//! The file of a recorded session: what it contains, and what can be read from it at any time.

use std::path::{Path, PathBuf};

use nima_machine::{
    config::RigConfig,
    messages::Tick,
    rig::{SIDES, Side},
    teleop::{Calibrations, Loop, Timing},
};
use nima_session::{
    file::RecordedFile,
    images,
    journal::JournalStart,
    objects::{self, ObjectStates},
    plot_channels,
};
use nima_simulation::scene::Scene;
use nima_words::{
    report_text::{chain, quoted},
    text,
};

use super::overview::OverviewTables;

pub(super) struct PlaybackFile {
    pub(super) path: PathBuf,
    pub(super) recorded: RecordedFile,
    pub(super) begin_ns: u64,
    /// Time of its last message, s.
    pub(super) end_s: f64,
    /// The arms with recorded plots.
    pub(super) arms: Vec<Side>,
    pub(super) rig: RigConfig,
    pub(super) scene: Scene,
    /// The start of its journal, or the reason why it cannot be replayed.
    pub(super) start: Result<JournalStart, String>,
    /// Contains rings or jaws.
    has_objects: bool,
    /// Contains endoscope images.
    pub(super) has_images: bool,
}

impl PlaybackFile {
    /// Returns one line as error if the session cannot be shown at all.
    pub(super) fn open(path: &Path) -> Result<Self, String> {
        let recorded = RecordedFile::open(path).map_err(|error| quoted(&chain(&error)))?;
        let begin_ns = plot_channels::beginning_ns(recorded.reader()).map_err(|error| quoted(&chain(&error)))?;
        let end_s = recorded.about().map_err(|error| quoted(&chain(&error)))?.seconds;
        let start = recorded.journal().map(|journal| journal.start().clone()).map_err(|error| quoted(&chain(&error)));
        let rig = match &start {
            Ok(start) => start.origin.rig.clone(),
            Err(_) => attached(&recorded, "rig.toml")?,
        };
        let scene = attached(&recorded, "scene.toml")?;
        let arms = plot_channels::arms(recorded.reader());
        let has_objects = objects::are_shown(recorded.reader());
        let has_images = images::are_recorded(recorded.reader());
        let path = path.to_owned();
        Ok(Self { path, recorded, begin_ns, end_s, arms, rig, scene, start, has_objects, has_images })
    }

    pub(super) fn t_s(&self, time_ns: u64) -> f64 {
        time_ns.saturating_sub(self.begin_ns) as f64 / 1e9
    }

    pub(super) fn time_ns(&self, t_s: f64) -> u64 {
        self.begin_ns + (t_s.max(0.0) * 1e9).round() as u64
    }

    /// Returns the objects of the scene at this time, s; none if they are not recorded or cannot be read.
    pub(super) fn objects(&self, t_s: f64) -> Option<ObjectStates> {
        let at = || objects::at(self.recorded.reader(), self.begin_ns, self.time_ns(t_s)).ok().flatten();
        self.has_objects.then(at)?
    }

    /// Returns the tables of the activated calibrations.
    pub(super) fn calibrations(&self) -> OverviewTables {
        let tables = self.recorded.reader().metadata().unwrap_or_default();
        let of = |name: &str| name.strip_prefix("calibrations ").map(str::to_owned);
        tables.into_iter().filter_map(|(name, table)| Some((of(&name)?, table))).collect()
    }

    /// Returns a tick of each arm with unknown values only.
    pub(super) fn blank(&self) -> Result<[Option<Tick>; SIDES], String> {
        let known = Side::ALL.map(|side| self.arms.contains(&side).then(Calibrations::default));
        let mut control = Loop::new(&self.rig, &known).map_err(|error| quoted(&chain(&error)))?;
        Ok(control.step([None; SIDES], &Timing::default()).1)
    }
}

/// Returns a settings table of a session from its file.
fn attached<T: serde::de::DeserializeOwned>(recorded: &RecordedFile, name: &str) -> Result<T, String> {
    let reader = recorded.reader();
    let place =
        reader.attachments().iter().find(|one| one.name == name).ok_or_else(|| text::playback::without(name))?;
    let bytes = reader.attachment(place).map_err(|error| quoted(&chain(&error)))?;
    nima_files::from_toml(&String::from_utf8_lossy(&bytes))
        .map_err(|misfit| text::playback::unusable(name, misfit.message()))
}
