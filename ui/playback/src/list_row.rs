//! One session of the list: its data, and its buttons.

use std::path::{Path, PathBuf};

use egui::{Button, Label, RichText, TextEdit, Ui};
use nima_screen::{
    theme,
    widgets::{small, weak},
};
use nima_session::{
    file::{RecordedFile, SessionInfo},
    session_store::{MAX_BYTES, SessionStore, StoredSession, note_of},
};
use nima_words::{
    report_text::{chain, mode_name, quoted},
    text::{self, of_files::of_file},
};

const BUTTON: egui::Vec2 = egui::vec2(74.0, 28.0);
/// Range of the width of a note, and the width of the other columns with their longest usual values.
const NOTE: std::ops::RangeInclusive<f32> = 80.0..=600.0;
const OTHERS: f32 = 990.0;
/// Width of a scene's name, which may have two lines.
const SCENE: f32 = 110.0;
/// The log of a larger file takes too long to read for a list.
const LOG_READ_MAX: u64 = 500_000_000;

#[derive(Debug)]
pub(super) struct SessionListRow {
    pub(super) shelved: StoredSession,
    pub(super) about: Result<SessionInfo, String>,
    /// Number of alarms; `None` until the log is read, or if it is too long.
    pub(super) alarms: Option<usize>,
    pub(super) note: String,
}

pub(super) enum SessionRequest {
    Open(PathBuf),
    Keep(PathBuf, bool),
    Ask(PathBuf),
    Delete(PathBuf),
    Report(PathBuf),
    Note(PathBuf, String),
}

/// A heading by which the list can be sorted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum SortBy {
    #[default]
    Time,
    Scene,
    Mode,
    Length,
    Size,
    Alarms,
    Note,
}

impl SortBy {
    pub(super) const ALL: [Self; 7] =
        [Self::Time, Self::Scene, Self::Mode, Self::Length, Self::Size, Self::Alarms, Self::Note];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Time => text::playback::TIME.get(),
            Self::Scene => text::playback::SCENE.get(),
            Self::Mode => text::playback::MODE.get(),
            Self::Length => text::playback::LENGTH.get(),
            Self::Size => text::playback::SIZE.get(),
            Self::Alarms => text::playback::ALARMS.get(),
            Self::Note => text::playback::NOTE.get(),
        }
    }

    /// Sorts rows that are in the order of time; the newest, longest and largest first, texts by the alphabet.
    pub(super) fn sort(self, rows: &mut [&mut SessionListRow]) {
        match self {
            Self::Time => {}
            Self::Scene => rows.sort_by_key(|row| row.scene().to_lowercase()),
            Self::Mode => rows.sort_by_key(|row| row.mode().to_lowercase()),
            Self::Length => rows.sort_by(|one, other| other.length_s().total_cmp(&one.length_s())),
            Self::Size => rows.sort_by_key(|row| std::cmp::Reverse(row.shelved.bytes)),
            Self::Alarms => rows.sort_by_key(|row| std::cmp::Reverse(row.alarms)),
            Self::Note => rows.sort_by_key(|row| (row.note.is_empty(), row.note.to_lowercase())),
        }
    }
}

impl SessionListRow {
    fn info(&self) -> Option<&SessionInfo> {
        self.about.as_ref().ok()
    }

    fn scene(&self) -> &str {
        of_file(self.info().and_then(|info| info.scene.as_deref()).unwrap_or_default())
    }

    /// Returns the mode by its name on the screen, or by that in the file if this version has no such mode.
    fn mode(&self) -> &str {
        let written = self.info().and_then(|info| info.mode.as_deref()).unwrap_or_default();
        match written.parse() {
            Ok(mode) => mode_name(mode),
            Err(_) => written,
        }
    }

    fn length_s(&self) -> f64 {
        self.info().map_or(f64::NEG_INFINITY, SessionInfo::length_s)
    }

    fn name(&self) -> String {
        self.shelved.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Returns whether every word is in what the row shows.
    pub(super) fn has(&self, words: &str) -> bool {
        let rig = self.info().and_then(|info| info.rig.as_deref()).unwrap_or_default();
        let began = text::playback::began(self.info().and_then(|info| info.started.as_deref()));
        let all = format!("{began} {rig} {} {} {} {}", self.scene(), self.mode(), self.note, self.name());
        let all = all.to_lowercase();
        words.to_lowercase().split_whitespace().all(|word| all.contains(word))
    }
}

/// Returns the sessions of this folder, newest first.
pub(super) fn read(folder: &Path) -> Result<Vec<SessionListRow>, String> {
    let shelf = SessionStore::new(folder, MAX_BYTES);
    let sessions = shelf.sessions().map_err(|error| text::sessions::no_folder(folder, &error))?;
    let about =
        |path: &Path| RecordedFile::open(path).and_then(|file| file.about()).map_err(|error| quoted(&chain(&error)));
    let row = |shelved: StoredSession| SessionListRow {
        about: about(&shelved.path),
        alarms: None,
        note: note_of(&shelved.path),
        shelved,
    };
    Ok(sessions.into_iter().rev().map(row).collect())
}

/// Returns the number of alarms in a session of this size; `None` if its log cannot be read, or not soon.
pub(super) fn alarms_in(path: &Path, bytes: u64) -> Option<usize> {
    (bytes <= LOG_READ_MAX).then(|| RecordedFile::open(path).ok()?.alarms().ok()).flatten()
}

/// Returns the width of the notes in a table of this width.
pub(super) fn note_width(table: f32) -> f32 {
    (table - OTHERS).clamp(*NOTE.start(), *NOTE.end())
}

/// Draws the session with its note in this width; `free`: a report may be written.
pub(super) fn row_ui(
    ui: &mut Ui,
    row: &mut SessionListRow,
    is_asked: bool,
    free: bool,
    note_width: f32,
) -> Option<SessionRequest> {
    about_ui(ui, row);
    let mut wish = note_ui(ui, row, note_width);
    let name = row.name();
    let SessionListRow { shelved: StoredSession { path, kept, writing, .. }, about, .. } = row;
    let mut button =
        |ui: &mut Ui, words: &str, enabled: bool, selected: bool, hover: [&str; 2], then: SessionRequest| {
            let button = Button::selectable(selected, words).frame_when_inactive(true).min_size(BUTTON);
            let response = ui.add_enabled(enabled, button).on_hover_text(hover[0]).on_disabled_hover_text(hover[1]);
            let of = format!("{words} {name}");
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, enabled, selected, &of));
            if response.clicked() {
                wish = Some(then);
            }
        };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let usable = about.is_ok();
        let hover = [text::playback::OPEN_HOVER.get(); 2];
        button(ui, text::playback::OPEN.get(), usable, false, hover, SessionRequest::Open(path.clone()));
        let keep = if *kept { text::playback::KEPT.get() } else { text::playback::KEEP.get() };
        let hover = [text::playback::KEEP_HOVER.get(); 2];
        button(ui, keep, true, *kept, hover, SessionRequest::Keep(path.clone(), !*kept));
        let hover = [text::playback::REPORT_HOVER.get(); 2];
        let report = SessionRequest::Report(path.clone());
        button(ui, text::playback::REPORT.get(), usable && free, false, hover, report);
        let why =
            if *writing { text::playback::DELETE_RUNNING_HOVER.get() } else { text::playback::DELETE_KEPT_HOVER.get() };
        let (words, hover, then) = if is_asked {
            (
                text::playback::DELETE_NOW.get(),
                text::playback::DELETE_NOW_HOVER.get(),
                SessionRequest::Delete(path.clone()),
            )
        } else {
            (text::playback::DELETE.get(), text::playback::DELETE_HOVER.get(), SessionRequest::Ask(path.clone()))
        };
        button(ui, words, !*kept && !*writing, is_asked, [hover, why], then);
    });
    wish
}

/// Draws the values below the headings.
fn about_ui(ui: &mut Ui, row: &SessionListRow) {
    let StoredSession { path, bytes, writing, .. } = &row.shelved;
    let strong = |words: String| RichText::new(words).font(theme::strong(14.0));
    match &row.about {
        Ok(about) => {
            let rig = about.rig.as_deref().unwrap_or_default();
            let hover = format!("{rig}\n{}", path.display());
            ui.label(strong(text::playback::began(about.started.as_deref()))).on_hover_text(hover);
            ui.scope(|ui| {
                ui.set_max_width(SCENE);
                ui.add(egui::Label::new(row.scene()).wrap());
            });
            ui.label(weak(row.mode()));
            let part = about.stretch_from_s.map(|from_s| format!(" {}", text::playback::stretch(from_s)));
            // The length of a session that is being recorded grows, but the list does not.
            let length = if *writing {
                text::playback::RECORDING.get().to_owned()
            } else {
                text::playback::short_clock(about.length_s())
            };
            ui.label(format!("{length}{}", part.unwrap_or_default()));
        }
        Err(why) => {
            ui.label(strong(row.name()));
            ui.add(Label::new(small(why)).wrap());
            ui.label("");
            ui.label("");
        }
    }
    ui.label(weak(text::playback::megabytes(*bytes)));
    ui.label(row.alarms.map_or_else(|| weak("\u{2013}"), |alarms| RichText::new(alarms.to_string())));
}

/// Draws the note, which is saved when the field is left.
fn note_ui(ui: &mut Ui, row: &mut SessionListRow, width: f32) -> Option<SessionRequest> {
    let name = text::playback::note_of(&row.name());
    // The cell of a grid has no width by itself.
    let field = ui.add_sized([width, BUTTON.y], TextEdit::singleline(&mut row.note).char_limit(200));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
    let is_done = field.lost_focus();
    field.on_hover_text(text::playback::NOTE_HOVER);
    is_done.then(|| SessionRequest::Note(row.shelved.path.clone(), row.note.trim().to_owned()))
}
