//! The page with the user's recorded sessions.

use std::{
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, channel},
    thread,
};

use egui::{Button, CentralPanel, Context, Frame, Grid, Label, Margin, RichText, ScrollArea, TextEdit, Ui, vec2};
use nima_screen::{
    opener,
    picking::{Kind, Picking},
    theme,
    widgets::{Sign, sign_ui, small, weak},
};
use nima_session::session_store::{keep, remove, set_note};
use nima_words::text::current_session::DisplayState;
use nima_words::{language, text};

use super::{
    job::SessionJob,
    list_row::{SessionListRow, SessionRequest, SortBy, alarms_in, note_width, read, row_ui},
};

#[derive(Debug, Default)]
pub struct SessionList {
    /// A session is to be chosen for the comparison.
    pub for_beside: bool,
    folder: Option<PathBuf>,
    rows: Vec<SessionListRow>,
    reading: Option<Receiver<ReadStep>>,
    /// The rows are up to date with the folder.
    is_read: bool,
    search: String,
    sort: SortBy,
    /// The session that the next press deletes.
    asked: Option<PathBuf>,
    job: Option<SessionJob>,
    report: Option<String>,
    picking: Option<Picking>,
}

/// Choice of the user on the page.
#[derive(Debug)]
pub enum SessionListChoice {
    Open(PathBuf),
    Back,
}

/// Result of the thread that reads the folder.
#[derive(Debug)]
enum ReadStep {
    Rows(Vec<SessionListRow>),
    /// Alarms of a session.
    Alarms(PathBuf, usize),
    Failed(String),
}

impl SessionList {
    /// Reads the sessions for the page; the folder of sessions is in `data_folder`.
    pub fn open(&mut self, ctx: &Context, data_folder: Option<&Path>) {
        self.for_beside = false;
        self.report = None;
        self.folder = data_folder.map(|folder| folder.join("sessions"));
        self.read(ctx);
    }

    fn read(&mut self, ctx: &Context) {
        self.asked = None;
        let Some(folder) = self.folder.clone() else { return };
        let (give, rows) = channel();
        let ctx = ctx.clone();
        let work = move || {
            let rows = read(&folder);
            let files: Vec<_> =
                rows.iter().flatten().map(|row| (row.shelved.path.clone(), row.shelved.bytes)).collect();
            let first = rows.map_or_else(ReadStep::Failed, ReadStep::Rows);
            // The logs take longer than the headers; the receiver is gone when the list is read again.
            let alarms = files.into_iter().filter_map(|(path, bytes)| {
                let alarms = alarms_in(&path, bytes)?;
                Some(ReadStep::Alarms(path, alarms))
            });
            for step in std::iter::once(first).chain(alarms) {
                if give.send(step).is_err() {
                    return;
                }
                ctx.request_repaint();
            }
        };
        // If no thread can be created, the list stays unchanged.
        thread::Builder::new().name("sessions".to_owned()).spawn(language::carried(work)).ok();
        self.reading = Some(rows);
        self.is_read = false;
    }

    fn take_in(&mut self) {
        while let Some(step) = self.reading.as_ref().and_then(|reading| reading.try_recv().ok()) {
            match step {
                ReadStep::Rows(rows) => {
                    self.is_read = true;
                    self.rows = rows;
                }
                ReadStep::Failed(why) => {
                    self.is_read = true;
                    self.report = Some(why);
                }
                ReadStep::Alarms(path, alarms) => {
                    if let Some(row) = self.rows.iter_mut().find(|row| row.shelved.path == path) {
                        row.alarms = Some(alarms);
                    }
                }
            }
        }
        if let Some((words, over)) = self.job.as_ref().map(SessionJob::message) {
            self.report = Some(words);
            if over {
                self.job = None;
            }
        }
    }

    /// Draws the page, with the session that is being recorded; returns the choice.
    pub fn ui(&mut self, ui: &mut Ui, recorded: Option<&DisplayState>) -> Option<SessionListChoice> {
        self.take_in();
        let mut leaves = false;
        let mut wish = Picking::take(&mut self.picking).map(SessionRequest::Open);
        let frame = Frame::new().inner_margin(Margin::symmetric(18, 14));
        CentralPanel::default().frame(frame).show(ui, |ui| {
            ui.horizontal(|ui| {
                let back = Button::new(text::playback::BACK).min_size(vec2(150.0, 36.0));
                leaves = ui.add(back).clicked();
                let elsewhere = Button::new(text::playback::ELSEWHERE).min_size(vec2(150.0, 36.0));
                if ui
                    .add_enabled(self.picking.is_none(), elsewhere)
                    .on_hover_text(text::playback::ELSEWHERE_HOVER)
                    .clicked()
                {
                    let kind = Kind { name: text::playback::RECORDINGS.get(), endings: &["mcap", "csv", "txt", "tsv"] };
                    let folder = self.folder.as_deref();
                    self.picking = Some(Picking::open(ui.ctx(), text::playback::ELSEWHERE.get(), kind, folder));
                }
                ui.add_space(8.0);
                let heading = if self.for_beside { text::playback::BESIDE.get() } else { text::playback::LIST.get() };
                ui.label(RichText::new(heading).font(theme::strong(theme::TITLE)));
                let folder = self.folder.as_ref().map(|folder| folder.display().to_string());
                ui.add(
                    Label::new(small(folder.unwrap_or_else(|| text::playback::NO_SHELF.get().to_owned()))).truncate(),
                );
            });
            // A separate line, so that the content below never moves.
            ui.label(weak(self.report.clone().unwrap_or_default()));
            self.tools_ui(ui, recorded);
            ui.add_space(4.0);
            if self.rows.is_empty() && self.folder.is_some() {
                let words = if self.is_read { text::playback::EMPTY.get() } else { text::playback::LOOKING.get() };
                ui.label(weak(words));
            }
            let asked = self.rows_ui(ui);
            wish = wish.take().or(asked);
        });
        if leaves {
            return Some(SessionListChoice::Back);
        }
        self.obey(ui.ctx(), wish?).map(SessionListChoice::Open)
    }

    /// Draws search, the folder's button, and the recording that is running.
    fn tools_ui(&mut self, ui: &mut Ui, recorded: Option<&DisplayState>) {
        ui.horizontal(|ui| {
            let hint = text::playback::SEARCH.get();
            let field = ui.add(TextEdit::singleline(&mut self.search).hint_text(hint).desired_width(300.0));
            field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, hint));
            let folder = self.folder.clone().filter(|folder| folder.exists());
            let open = Button::new(text::playback::OPEN_FOLDER).min_size(vec2(130.0, 28.0));
            let open = ui.add_enabled(folder.is_some(), open);
            let pressed = open.on_disabled_hover_text(text::playback::EMPTY).clicked();
            if let (true, Some(folder)) = (pressed, folder) {
                // The program may run for a long time. If no thread can be created, nothing opens.
                thread::Builder::new().name("folder".to_owned()).spawn(move || opener::open(&folder)).ok();
            }
            if let Some(recorded) = recorded {
                ui.add_space(8.0);
                sign_ui(ui, Sign::Disc, 6.0, theme::now().alarm_high);
                ui.label(text::sessions::recording(recorded.seconds, recorded.free_bytes));
            }
        });
    }

    /// Draws the table; returns the requested action on a session.
    fn rows_ui(&mut self, ui: &mut Ui) -> Option<SessionRequest> {
        let mut wish = None;
        if self.rows.is_empty() {
            return None;
        }
        let mut shown: Vec<&mut SessionListRow> = self.rows.iter_mut().filter(|row| row.has(&self.search)).collect();
        self.sort.sort(&mut shown);
        if shown.is_empty() {
            ui.label(weak(text::playback::NOT_FOUND));
        }
        let note_width = note_width(ui.available_width());
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            Grid::new("sessions").spacing(vec2(8.0, 6.0)).striped(true).show(ui, |ui| {
                for by in SortBy::ALL {
                    let words = RichText::new(by.name()).text_style(egui::TextStyle::Small);
                    let heading = Button::selectable(self.sort == by, words);
                    let heading = ui.add(heading).on_hover_text(text::playback::SORT_HOVER);
                    let name = text::playback::sort_by(by.name());
                    let chosen = self.sort == by;
                    heading.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, chosen, &name));
                    if heading.clicked() {
                        self.sort = by;
                    }
                }
                ui.end_row();
                for row in shown {
                    let is_asked = self.asked.as_ref() == Some(&row.shelved.path);
                    wish = row_ui(ui, row, is_asked, self.job.is_none(), note_width).or(wish.take());
                    ui.end_row();
                }
            });
        });
        wish
    }

    fn obey(&mut self, ctx: &Context, wish: SessionRequest) -> Option<PathBuf> {
        match wish {
            SessionRequest::Open(path) => return Some(path),
            SessionRequest::Ask(path) => self.asked = Some(path),
            SessionRequest::Note(path, note) => {
                self.report = set_note(&path, &note).err().map(|error| text::playback::note_not_saved(&error));
            }
            SessionRequest::Report(path) => self.job = Some(SessionJob::report(ctx, &path)),
            SessionRequest::Keep(path, kept) => {
                self.report = keep(&path, kept).err().map(|error| text::sessions::not_kept(&path, &error));
                self.read(ctx);
            }
            SessionRequest::Delete(path) => {
                self.report = remove(&path).err().map(|error| text::playback::not_deleted(&path, &error));
                self.read(ctx);
            }
        }
        None
    }
}
