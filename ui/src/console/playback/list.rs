//! The page with the user's recorded sessions.

use std::{
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, channel},
    thread,
};

use egui::{Button, CentralPanel, Context, Frame, Grid, Label, Margin, RichText, ScrollArea, Ui, vec2};
use nima_session::{
    file::{RecordedFile, SessionInfo},
    session_store::{MAX_BYTES, SessionStore, StoredSession, keep},
};

use super::job::SessionJob;
use crate::console::{
    chain,
    picking::Picking,
    text, theme,
    widgets::{small, weak},
};
use crate::{language, report_text::quoted};

const BUTTON: egui::Vec2 = vec2(74.0, 28.0);

#[derive(Debug, Default)]
pub(crate) struct SessionList {
    pub(crate) is_open: bool,
    /// A session is to be chosen for the comparison.
    pub(crate) for_beside: bool,
    folder: Option<PathBuf>,
    rows: Vec<SessionListRow>,
    reading: Option<Receiver<Result<Vec<SessionListRow>, String>>>,
    /// The session that the next press deletes.
    asked: Option<PathBuf>,
    job: Option<SessionJob>,
    report: Option<String>,
    picking: Option<Picking>,
}

#[derive(Debug)]
struct SessionListRow {
    shelved: StoredSession,
    about: Result<SessionInfo, String>,
}

enum SessionRequest {
    Open(PathBuf),
    Keep(PathBuf, bool),
    Ask(PathBuf),
    Delete(PathBuf),
    Report(PathBuf),
}

impl SessionList {
    /// Shows the page; the folder of sessions is in `data_folder`.
    pub(crate) fn open(&mut self, ctx: &Context, data_folder: Option<&Path>) {
        self.is_open = true;
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
            give.send(read(&folder)).ok();
            ctx.request_repaint();
        };
        // If no thread can be created, the list stays unchanged.
        thread::Builder::new().name("sessions".to_owned()).spawn(language::carried(work)).ok();
        self.reading = Some(rows);
    }

    fn take_in(&mut self) {
        if let Some(read) = self.reading.as_ref().and_then(|reading| reading.try_recv().ok()) {
            self.reading = None;
            match read {
                Ok(rows) => self.rows = rows,
                Err(why) => self.report = Some(why),
            }
        }
        if let Some((words, over)) = self.job.as_ref().map(SessionJob::message) {
            self.report = Some(words);
            if over {
                self.job = None;
            }
        }
    }

    /// Draws the page; returns the session to open.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> Option<PathBuf> {
        self.take_in();
        let mut wish = Picking::take(&mut self.picking).map(SessionRequest::Open);
        let frame = Frame::new().inner_margin(Margin::symmetric(18, 14));
        CentralPanel::default().frame(frame).show(ui, |ui| {
            ui.horizontal(|ui| {
                let back = Button::new(text::playback::BACK.get()).min_size(vec2(150.0, 36.0));
                if ui.add(back).clicked() {
                    self.is_open = false;
                }
                let elsewhere = Button::new(text::playback::ELSEWHERE.get()).min_size(vec2(150.0, 36.0));
                if ui
                    .add_enabled(self.picking.is_none(), elsewhere)
                    .on_hover_text(text::playback::ELSEWHERE_HOVER.get())
                    .clicked()
                {
                    let kind = [text::playback::SESSIONS.get(), "mcap"];
                    let folder = self.folder.as_deref();
                    self.picking = Some(Picking::open(ui.ctx(), text::playback::ELSEWHERE.get(), kind, folder));
                }
                ui.add_space(8.0);
                let heading = if self.for_beside { text::playback::BESIDE.get() } else { text::playback::LIST.get() };
                ui.label(RichText::new(heading).font(theme::strong(19.0)));
                let folder = self.folder.as_ref().map(|folder| folder.display().to_string());
                ui.add(
                    Label::new(small(folder.unwrap_or_else(|| text::playback::NO_SHELF.get().to_owned()))).truncate(),
                );
            });
            // A separate line, so that the content below never moves.
            ui.label(weak(self.report.clone().unwrap_or_default()));
            ui.add_space(4.0);
            if self.rows.is_empty() && self.folder.is_some() {
                let words =
                    if self.reading.is_some() { text::playback::LOOKING.get() } else { text::playback::EMPTY.get() };
                ui.label(weak(words));
            }
            ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                Grid::new("sessions").spacing(vec2(16.0, 6.0)).striped(true).show(ui, |ui| {
                    for row in &self.rows {
                        let is_asked = self.asked.as_ref() == Some(&row.shelved.path);
                        wish = row_ui(ui, row, is_asked, self.job.is_none()).or(wish.take());
                        ui.end_row();
                    }
                });
            });
        });
        self.obey(ui.ctx(), wish?)
    }

    fn obey(&mut self, ctx: &Context, wish: SessionRequest) -> Option<PathBuf> {
        match wish {
            SessionRequest::Open(path) => {
                self.is_open = false;
                return Some(path);
            }
            SessionRequest::Ask(path) => self.asked = Some(path),
            SessionRequest::Report(path) => self.job = Some(SessionJob::report(ctx, &path)),
            SessionRequest::Keep(path, kept) => {
                self.report = keep(&path, kept).err().map(|error| text::sessions::not_kept(&path, &error));
                self.read(ctx);
            }
            SessionRequest::Delete(path) => {
                self.report = std::fs::remove_file(&path).err().map(|error| text::playback::not_deleted(&path, &error));
                self.read(ctx);
            }
        }
        None
    }
}

/// Returns the sessions of this folder, newest first.
fn read(folder: &Path) -> Result<Vec<SessionListRow>, String> {
    let shelf = SessionStore::new(folder, MAX_BYTES);
    let sessions = shelf.sessions().map_err(|error| text::sessions::no_folder(folder, &error))?;
    let about =
        |path: &Path| RecordedFile::open(path).and_then(|file| file.about()).map_err(|error| quoted(&chain(&error)));
    Ok(sessions.into_iter().rev().map(|shelved| SessionListRow { about: about(&shelved.path), shelved }).collect())
}

fn row_ui(ui: &mut Ui, row: &SessionListRow, is_asked: bool, free: bool) -> Option<SessionRequest> {
    let SessionListRow { shelved: StoredSession { path, kept, writing, .. }, about } = row;
    about_ui(ui, row);
    let mut wish = None;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
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
        button(
            ui,
            text::playback::OPEN.get(),
            usable,
            false,
            [text::playback::OPEN_HOVER.get(); 2],
            SessionRequest::Open(path.clone()),
        );
        let keep = if *kept { text::playback::KEPT.get() } else { text::playback::KEEP.get() };
        button(ui, keep, true, *kept, [text::playback::KEEP_HOVER.get(); 2], SessionRequest::Keep(path.clone(), !kept));
        let report = SessionRequest::Report(path.clone());
        button(
            ui,
            text::playback::REPORT.get(),
            usable && free,
            false,
            [text::playback::REPORT_HOVER.get(); 2],
            report,
        );
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
        button(ui, words, !kept && !writing, is_asked, [hover, why], then);
    });
    wish
}

/// Draws date, duration and rig.
fn about_ui(ui: &mut Ui, SessionListRow { shelved, about }: &SessionListRow) {
    let StoredSession { path, bytes, writing, .. } = shelved;
    let strong = |words: String| RichText::new(words).font(theme::strong(14.0));
    match about {
        Ok(about @ SessionInfo { started, rig, .. }) => {
            ui.label(strong(text::playback::began(started.as_deref()))).on_hover_text(path.display().to_string());
            ui.label(text::playback::short_clock(about.length_s()));
            ui.label(rig.as_deref().unwrap_or_default());
        }
        Err(why) => {
            ui.label(strong(path.file_name().unwrap_or_default().to_string_lossy().into_owned()));
            ui.label("");
            ui.label(small(why));
        }
    }
    ui.label(weak(text::playback::megabytes(*bytes)));
    let stretch_from_s = about.as_ref().ok().and_then(|about| about.stretch_from_s);
    ui.label(weak(match stretch_from_s {
        _ if *writing => text::playback::RECORDING.get().to_owned(),
        Some(from_s) => text::playback::stretch(from_s),
        None => String::new(),
    }));
}
