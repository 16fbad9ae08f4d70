//! The file in playback: a session, or the signals of another program's recording.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use nima_machine::{
    config::{ConfigError, EndoscopeConfig, RigConfig},
    messages::Tick,
    rig::{DeviceName, SIDES, Side},
    teleop::{Calibrations, Loop, Timing},
};
use nima_recording::csv::{ColumnMapping, Signals};
use nima_session::{
    OpenSignalsError,
    file::{LogLine, RecordedFile},
    images,
    journal::JournalStart,
    objects::{self, ObjectStates},
    open_signals, plot_channels,
    replay::Keyframe,
};
use nima_simulation::scene::Scene;
use nima_words::{
    report_text::{chain, quoted},
    text,
};

use super::{feed::TickFeed, overview::OverviewTables};

pub(super) struct PlaybackFile {
    pub(super) path: PathBuf,
    pub(super) contents: PlaybackContents,
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
    has_images: bool,
}

pub(super) enum PlaybackContents {
    Session(RecordedFile),
    /// Of another program: shown as signals of the right arm.
    Signals(Arc<Signals>),
}

impl PlaybackFile {
    /// Opens a session, or shows the signals of another program's recording: these, or those that have the usual names.
    /// Returns one line as error if it cannot be shown at all.
    pub(super) fn open(path: &Path, signals: Option<Arc<Signals>>) -> Result<Self, String> {
        let of_signals = |signals| Self::of_signals(path, signals).map_err(|error| quoted(&chain(&error)));
        if let Some(signals) = signals {
            return of_signals(signals);
        }
        match open_signals(path, &ColumnMapping::default(), false).map_err(|error| unopened(&error))? {
            Some(signals) => of_signals(Arc::new(signals)),
            None => Self::of_session(path),
        }
    }

    fn of_session(path: &Path) -> Result<Self, String> {
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
        let contents = PlaybackContents::Session(recorded);
        let path = path.to_owned();
        Ok(Self { path, contents, begin_ns, end_s, arms, rig, scene, start, has_objects, has_images })
    }

    /// The rig and the scene only complete the state of a window: nothing of them is shown.
    fn of_signals(path: &Path, signals: Arc<Signals>) -> Result<Self, ConfigError> {
        Ok(Self {
            path: path.to_owned(),
            begin_ns: 0,
            end_s: signals.end_s(),
            arms: vec![Side::Right],
            rig: RigConfig::load("simulated")?,
            scene: Scene::load("peg_transfer")?,
            start: Err(text::playback::OF_ANOTHER_PROGRAM.get().to_owned()),
            has_objects: false,
            has_images: false,
            contents: PlaybackContents::Signals(signals),
        })
    }

    pub(super) const fn session(&self) -> Option<&RecordedFile> {
        match &self.contents {
            PlaybackContents::Session(recorded) => Some(recorded),
            PlaybackContents::Signals(_) => None,
        }
    }

    /// Returns the signals of another program's recording.
    pub(super) const fn signals(&self) -> Option<&Arc<Signals>> {
        match &self.contents {
            PlaybackContents::Session(_) => None,
            PlaybackContents::Signals(signals) => Some(signals),
        }
    }

    /// Returns the replay from this loop on; `None` if it cannot be replayed.
    pub(super) fn feed(&self, keyframe: &Keyframe) -> Option<TickFeed> {
        let start = self.start.as_ref().ok()?;
        Some(TickFeed::Replay(self.session()?.cursor(start, keyframe.clone(), self.begin_ns)))
    }

    pub(super) fn t_s(&self, time_ns: u64) -> f64 {
        time_ns.saturating_sub(self.begin_ns) as f64 / 1e9
    }

    pub(super) fn time_ns(&self, t_s: f64) -> u64 {
        self.begin_ns + (t_s.max(0.0) * 1e9).round() as u64
    }

    /// Returns the log between these times, ns; nothing if it cannot be read.
    pub(super) fn log(&self, times_ns: Range<u64>) -> Vec<LogLine> {
        self.session().and_then(|recorded| recorded.log(times_ns).ok()).unwrap_or_default()
    }

    /// Returns the objects of the scene at this time, s; none if they are not recorded or cannot be read.
    pub(super) fn objects(&self, t_s: f64) -> Option<ObjectStates> {
        let recorded = self.session().filter(|_| self.has_objects)?;
        objects::at(recorded.reader(), self.begin_ns, self.time_ns(t_s)).ok().flatten()
    }

    /// Returns the tables of the activated calibrations.
    pub(super) fn calibrations(&self) -> OverviewTables {
        let tables = self.session().and_then(|recorded| recorded.reader().metadata().ok()).unwrap_or_default();
        let of = |name: &str| name.strip_prefix("calibrations ").map(str::to_owned);
        tables.into_iter().filter_map(|(name, table)| Some((of(&name)?, table))).collect()
    }

    pub(super) fn devices(&self) -> Vec<DeviceName> {
        self.session().map(|_| self.rig.device_names()).unwrap_or_default()
    }

    /// Returns the endoscope whose images are in it.
    pub(super) fn endoscope(&self) -> Option<EndoscopeConfig> {
        self.has_images.then(|| self.rig.endoscope.clone().unwrap_or_default())
    }

    /// Returns a tick of each arm with unknown values only.
    pub(super) fn blank(&self) -> Result<[Option<Tick>; SIDES], String> {
        let known = Side::ALL.map(|side| self.arms.contains(&side).then(Calibrations::default));
        let mut control = Loop::new(&self.rig, &known).map_err(|error| quoted(&chain(&error)))?;
        Ok(control.step([None; SIDES], &Timing::default()).1)
    }
}

/// Returns why a recording is not shown, with the command that selects its signals if that helps.
fn unopened(error: &OpenSignalsError) -> String {
    let cause = quoted(&chain(error));
    if error.needs_mapping() { text::playback::unnamed(&cause) } else { cause }
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
