//! User studies in the window: the list of studies, the form of a new one, the experimenter's page, and a participant's trials, breaks and
//! questionnaires.
//!
//! Of a blind study nothing here shows a mode, a gain or a delay: the form of a new study knows them and is dropped when the study is made,
//! and a trial hands its condition to the loop alone. While a trial runs the window shows [`trial`] and nothing else.

mod aside;
mod curve;
mod desk;
mod draft;
mod form;
mod list;
mod measures;
mod questions;
mod rest;
pub(super) mod trial;

use std::path::{Path, PathBuf};

use egui::{Align, CentralPanel, Frame, Layout, Margin, Response, ScrollArea, TextEdit, Ui, vec2};
use nima_user_study::Study;

pub(super) use desk::{Desk, Hand};
pub(super) use trial::Trial;

use super::{start::Choice, text};

/// The pages, and the study that is open.
#[derive(Debug, Default)]
pub(super) struct Studies {
    /// Whether the page is shown.
    pub(super) is_shown: bool,
    list: list::List,
    form: Option<form::Form>,
    pub(super) desk: Option<Desk>,
    pub(super) trial: Option<Trial>,
    /// A trial that begins as soon as the rig of the study runs.
    pub(super) wanted: Option<Wanted>,
    /// What ran before the study.
    pub(super) before: Option<Choice>,
}

/// A trial that is to begin.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) participant: String,
    pub(super) hand: Hand,
    /// The rig of the study was started for it.
    pub(super) is_starting: bool,
}

/// What the pages are drawn from.
pub(super) struct Room<'a> {
    /// The user's data.
    pub(super) folder: Option<&'a Path>,
    /// Studies elsewhere that were opened before.
    pub(super) known: &'a mut Vec<PathBuf>,
    /// Why no trial can begin now.
    pub(super) closed: Option<&'static str>,
    /// A rig is being started.
    pub(super) is_starting: bool,
}

/// What is to be done outside of the pages.
#[derive(Debug)]
pub(super) enum Wish {
    /// Begin the next trial of this participant.
    Trial(String, Hand),
    /// The study was closed.
    Closed,
}

impl Studies {
    /// Shows the list, or the study that is open.
    pub(super) fn open(&mut self, folder: Option<&Path>, known: &[PathBuf]) {
        self.is_shown = true;
        self.list.read(folder, known);
    }

    /// Whether a study is open: then the rest of the screen is closed.
    pub(super) const fn has_study(&self) -> bool {
        self.desk.is_some()
    }

    fn take_study(&mut self, study: Study, told: Option<String>, room: &mut Room<'_>) {
        let folder = study.folder().to_owned();
        if !list::is_in(room.folder, &folder) && !room.known.contains(&folder) {
            room.known.push(folder);
        }
        self.desk = Some(Desk::new(study, told));
        self.form = None;
    }

    /// Draws the page.
    pub(super) fn ui(&mut self, ui: &mut Ui, mut room: Room<'_>) -> Option<Wish> {
        let frame = Frame::new().inner_margin(Margin::symmetric(14, 12));
        CentralPanel::default()
            .frame(frame)
            .show(ui, |ui| {
                if let Some(desk) = &mut self.desk {
                    let starting = room.is_starting || self.wanted.is_some();
                    let wish = desk.ui(ui, room.closed, starting);
                    if matches!(wish, Some(Wish::Closed)) {
                        self.desk = None;
                        self.list.read(room.folder, room.known);
                    }
                    return wish;
                }
                if let Some(form) = &mut self.form {
                    match form.ui(ui, room.folder) {
                        Some(form::Done::Back) => self.form = None,
                        Some(form::Done::Made(study)) => {
                            let told = text::study_form::made(study.folder());
                            self.take_study(*study, Some(told), &mut room);
                        }
                        None => {}
                    }
                    return None;
                }
                match self.list.ui(ui) {
                    Some(list::Done::Back) => self.is_shown = false,
                    Some(list::Done::New) => self.form = form::Form::new(),
                    Some(list::Done::Open(study)) => self.take_study(*study, None, &mut room),
                    None => {}
                }
                None
            })
            .inner
    }
}

/// A column of this size that scrolls.
fn column<R>(ui: &mut Ui, name: &str, size: egui::Vec2, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        let area = ScrollArea::vertical().id_salt(name).auto_shrink(false).max_height(size.y);
        area.show(ui, |ui| {
            ui.set_width(size.x - 12.0);
            content(ui)
        })
        .inner
    })
    .inner
}

/// A field with its name above it.
fn field_ui(ui: &mut Ui, name: &str, value: &mut String) -> Response {
    let label = ui.label(super::widgets::small(name));
    let field = TextEdit::singleline(value).char_limit(200);
    ui.add_sized(vec2(ui.available_width(), 26.0), field).labelled_by(label.id)
}
