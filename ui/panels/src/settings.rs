//! Settings of the console that are saved between sessions: role and appearance. Nothing of the loop is saved: a rig always
//! starts with its own file.
//!
//! Saved as JSON next to the calibrations. An unreadable file is renamed and reported; it is never fatal.

use std::{
    io,
    path::{Path, PathBuf},
};

use nima_endoscope::Tone;
use nima_files::{PASSAGE, shortened, write_atomically};
use nima_recording::store::Store;
use nima_screen::{theme::Look, units::PlotUnits};
use nima_words::{language::Language, text};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{
    rig_choice::RigChoice,
    roles::Role,
    tiles::{Arrangement, PanelLayout},
};

const FILE: &str = "console.json";
const SET_ASIDE: &str = "console.corrupted.json";

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "switches of a menu")]
pub struct ConsoleSettings {
    pub role: Role,
    pub layout: PanelLayout,
    /// The user's own layouts.
    pub layouts: Vec<NamedLayout>,
    pub sound: bool,
    pub light: bool,
    /// Colours for colour-blind users.
    pub colour_blind: bool,
    /// Controls large enough for a finger.
    pub touch: bool,
    /// Whether sessions include the endoscope image.
    #[serde(rename = "records_picture")]
    pub records_image: bool,
    #[serde(rename = "picture")]
    pub image: ImageSettings,
    pub language: Language,
    /// Units of the plots.
    pub units: PlotUnits,
    pub toured: bool,
    /// Scale of the user interface, percent; [`SCALES`].
    pub scale_percent: u16,
    /// Rigs and scenes in order of last use, newest first.
    pub recent: Vec<RigChoice>,
    /// Folders of user studies outside the user's data.
    pub studies: Vec<PathBuf>,
}

/// A layout that the user has saved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedLayout {
    pub name: String,
    pub layout: PanelLayout,
}

/// Display settings of the endoscope image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ImageSettings {
    /// Added to every value, percent of white.
    pub brightness_percent: i16,
    /// Scales the distance of every value from middle grey.
    pub contrast_percent: u16,
    /// Above 100 brightens dark areas.
    pub gamma_percent: u16,
    /// Cut off at the left, top, right and bottom of the camera image.
    pub crop_percent: [u8; 4],
    /// Forces are drawn at the current tip positions, not at those of the image's time.
    pub forces_of_now: bool,
}

impl Default for ImageSettings {
    fn default() -> Self {
        let contrast_percent = 100;
        let gamma_percent = 100;
        Self { brightness_percent: 0, contrast_percent, gamma_percent, crop_percent: [0; 4], forces_of_now: false }
    }
}

impl ImageSettings {
    pub fn tone(&self) -> Tone {
        let fraction = |percent: u16| f64::from(percent) / 100.0;
        let brightness = f64::from(self.brightness_percent) / 100.0;
        Tone { brightness, contrast: fraction(self.contrast_percent), gamma: fraction(self.gamma_percent) }.limited()
    }

    /// Returns the parts cut off at the left, top, right and bottom, as fractions.
    pub fn crop(&self) -> [f32; 4] {
        self.crop_percent.map(|percent| f32::from(percent.min(CROP_MAX_PERCENT)) / 100.0)
    }
}

/// Maximum cut-off at an edge, percent.
pub const CROP_MAX_PERCENT: u8 = 40;

/// Smallest and largest scale, percent.
pub const SCALES: std::ops::RangeInclusive<u16> = 100..=200;
/// A step of the keys.
const STEP_PERCENT: i16 = 25;

impl ConsoleSettings {
    /// Returns the settings of a person who has never used the console.
    fn of_newcomer() -> Self {
        Self { layout: PanelLayout::built_in(Arrangement::Simple), ..Self::default() }
    }

    pub const fn look(&self) -> Look {
        Look { light: self.light, colour_blind: self.colour_blind, touch: self.touch }
    }

    /// Saves the present layout under this name; replaces an earlier one of the same name.
    pub fn save_layout(&mut self, name: &str) {
        self.layouts.retain(|saved| saved.name != name);
        self.layouts.push(NamedLayout { name: name.to_owned(), layout: self.layout.clone() });
    }

    pub fn scale_by(&mut self, steps: i16) {
        let wanted = self.scale_percent.saturating_add_signed(STEP_PERCENT * steps);
        self.scale_percent = wanted.clamp(*SCALES.start(), *SCALES.end());
    }
}

impl Default for ConsoleSettings {
    fn default() -> Self {
        Self {
            role: Role::default(),
            layout: PanelLayout::default(),
            layouts: Vec::new(),
            sound: false,
            light: false,
            colour_blind: false,
            touch: false,
            records_image: true,
            image: ImageSettings::default(),
            language: Language::default(),
            units: PlotUnits::default(),
            toured: false,
            scale_percent: 100,
            recent: Vec::new(),
            studies: Vec::new(),
        }
    }
}

/// Settings and the folder in which they are saved.
#[derive(Debug, Default)]
pub struct SettingsStore {
    folder: Option<PathBuf>,
    pub now: ConsoleSettings,
    saved: ConsoleSettings,
    report: Option<String>,
}

impl SettingsStore {
    /// Creates the user's settings, saved next to the calibrations.
    pub fn of_user() -> Self {
        let folder = Store::of_user().ok().and_then(|store| store.folder().parent().map(Path::to_path_buf));
        folder.map_or_else(Self::default, |folder| Self::open(&folder))
    }

    /// Creates the settings in this folder; those of a newcomer if there are none, the defaults if they cannot be read.
    pub fn open(folder: &Path) -> Self {
        let (now, report) = match nima_files::read_text(&folder.join(FILE), nima_files::CONFIG_MAX) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => (ConsoleSettings::of_newcomer(), None),
            Err(error) => (ConsoleSettings::default(), Some(text::settings::not_read(&error))),
            Ok(text) => {
                read(&text).unwrap_or_else(|error| (ConsoleSettings::default(), Some(set_aside(folder, &error))))
            }
        };
        Self { folder: Some(folder.to_path_buf()), saved: now.clone(), now, report }
    }

    /// Returns the folder of the user's data; `None` if there is none.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Saves the settings if they have changed.
    pub fn save(&mut self) {
        let Some(folder) = self.folder.as_ref().filter(|_| self.now != self.saved) else { return };
        self.saved = self.now.clone();
        let text = serde_json::to_vec_pretty(&self.now).map_err(io::Error::from);
        let written = std::fs::create_dir_all(folder)
            .and(text)
            .and_then(|text| write_atomically(&folder.join(FILE), |file| file.write_all(&text)));
        if let Err(error) = written {
            self.report = Some(text::settings::not_kept(&error));
        }
    }

    pub const fn is_first_run(&self) -> bool {
        self.folder.is_some() && !self.now.toured
    }

    /// Returns the error of the settings file, if there is one.
    pub fn report(&self) -> Option<&str> {
        self.report.as_deref()
    }
}

/// Parses settings; returns them with a message about problems. If only a layout cannot be read, the other settings are
/// still used. Unknown fields, written by a newer version, are ignored.
fn read(text: &str) -> Result<(ConsoleSettings, Option<String>), serde_json::Error> {
    let mut value: serde_json::Value = serde_json::from_str(text)?;
    let mut taken = |name: &str| value.as_object_mut().and_then(|fields| fields.remove(name));
    let layout = taken("layout");
    let layouts = taken("layouts");
    let mut settings: ConsoleSettings = serde_json::from_value(value)?;
    let trouble = put(layout, &mut settings.layout).or(put(layouts, &mut settings.layouts));
    Ok((settings, trouble))
}

/// Parses a layout, or several, into its place; returns a message if it cannot be read.
fn put<T: DeserializeOwned>(read: Option<serde_json::Value>, place: &mut T) -> Option<String> {
    match serde_json::from_value(read?) {
        Ok(layout) => {
            *place = layout;
            None
        }
        Err(error) => Some(text::settings::layout_lost(&shortened(&error.to_string(), PASSAGE))),
    }
}

fn set_aside(folder: &Path, error: &serde_json::Error) -> String {
    let error = &shortened(&error.to_string(), PASSAGE);
    match std::fs::rename(folder.join(FILE), folder.join(SET_ASIDE)) {
        Ok(()) => text::settings::set_aside(error, SET_ASIDE),
        Err(_) => text::settings::damaged(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_chosen_is_there_the_next_day() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("new");
        let mut kept = SettingsStore::open(&folder);
        assert_eq!((kept.now.clone(), kept.report()), (ConsoleSettings::of_newcomer(), None));
        kept.now.role = Role::Surgeon;
        kept.now.save_layout("Mine");
        kept.save();
        let again = SettingsStore::open(&folder);
        assert_eq!((again.now.role, again.report()), (Role::Surgeon, None));
        let names: Vec<&str> = again.now.layouts.iter().map(|saved| saved.name.as_str()).collect();
        assert_eq!((names, again.now.layout), (vec!["Mine"], PanelLayout::built_in(Arrangement::Simple)));
    }

    #[test]
    fn a_layout_of_a_name_replaces_the_one_before_it() {
        let mut settings = ConsoleSettings::default();
        for arrangement in [Arrangement::Simple, Arrangement::Calibration] {
            settings.layout = PanelLayout::built_in(arrangement);
            settings.save_layout("Mine");
        }
        let saved: Vec<Arrangement> = settings.layouts.iter().map(|saved| saved.layout.arrangement).collect();
        assert_eq!(saved, [Arrangement::Calibration]);
    }

    #[test]
    fn only_a_first_start_is_simple_and_a_user_of_an_earlier_version_sees_every_panel() {
        let folder = tempfile::tempdir().unwrap();
        let arrangement = || SettingsStore::open(folder.path()).now.layout.arrangement;
        assert_eq!(arrangement(), Arrangement::Simple);
        for before in [r#"{"toured":true}"#, r#"{"layout":{"places":null,"closed":["traces"],"front":[]}}"#] {
            std::fs::write(folder.path().join(FILE), before).unwrap();
            assert_eq!(arrangement(), Arrangement::Research, "{before}");
        }
    }

    #[test]
    fn a_damaged_file_is_set_aside_and_told() {
        let folder = tempfile::tempdir().unwrap();
        for damage in ["{\"role\":", "", "{\"role\":\"king\"}", "{\"light\":1}", "[]x"] {
            std::fs::write(folder.path().join(FILE), damage).unwrap();
            let mut kept = SettingsStore::open(folder.path());
            assert_eq!(kept.now, ConsoleSettings::default());
            assert!(kept.report().unwrap().contains(SET_ASIDE));
            assert_eq!(std::fs::read_to_string(folder.path().join(SET_ASIDE)).unwrap(), damage);
            kept.now.role = Role::Demo;
            kept.save();
            assert_eq!(SettingsStore::open(folder.path()).now.role, Role::Demo);
        }
    }

    #[test]
    fn the_english_message_of_a_library_is_quoted_in_german() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(FILE), "[]x").unwrap();
        let german = || SettingsStore::open(folder.path()).report().unwrap().to_owned();
        let report = nima_words::language::with(nima_words::language::Language::German, german);
        assert!(report.starts_with("Die Einstellungsdatei war beschädigt („") && report.contains("“)"), "{report}");
    }

    #[test]
    fn a_layout_that_cannot_be_read_is_told_and_costs_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        for layout in ["1", "{\"places\":{\"spiral\":[]}}", "{\"closed\":[\"tea_kitchen\"]}"] {
            let text = format!("{{\"role\":\"surgeon\",\"from_the_future\":1,\"layout\":{layout}}}");
            std::fs::write(folder.path().join(FILE), text).unwrap();
            let kept = SettingsStore::open(folder.path());
            assert_eq!((kept.now.role, &kept.now.layout), (Role::Surgeon, &PanelLayout::default()));
            assert!(kept.report().unwrap().starts_with(text::settings::LAYOUT_LOST.get()));
            let own = format!("{{\"role\":\"surgeon\",\"layouts\":[{{\"name\":\"a\",\"layout\":{layout}}}]}}");
            let (settings, trouble) = read(&own).unwrap();
            assert!(settings.role == Role::Surgeon && settings.layouts.is_empty() && trouble.is_some());
            assert!(folder.path().join(FILE).exists());
        }
    }

    #[test]
    fn what_cannot_be_written_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let in_the_way = folder.path().join("file");
        std::fs::write(&in_the_way, "").unwrap();
        let mut kept = SettingsStore::open(&in_the_way.join("folder"));
        kept.now.role = Role::Demo;
        kept.save();
        assert!(kept.report().is_some());
    }
}
