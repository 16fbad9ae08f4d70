//! User studies in the window: the list of studies, the form of a new one, the experimenter's page, and a participant's
//! trials, breaks and questionnaires.
//!
//! For a blind study nothing here shows a mode, a gain or a delay. Only the form of a new study contains them, and it is
//! dropped when the study is created; a trial passes its condition only to the loop. While a trial runs the window shows
//! [`trial`] and nothing else.

mod break_page;
mod curve;
mod draft;
mod form;
mod list;
mod measures;
mod open_study;
mod questions;
mod side_panel;
mod trial;

use std::path::Path;

use egui::{Align, CentralPanel, Frame, Layout, Margin, Response, ScrollArea, TextEdit, Ui, vec2};
use nima_machine::config::RigConfig;
use nima_panels::rig_choice::RigChoice;
use nima_recording::store::utc_now;
use nima_user_study::UserStudy;
use nima_words::report_text::chain;

use crate::{
    console::page::{LeftPage, Page, PageContext, PageRequest, PageRun, PreparedRun, Room, RunBreak},
    extras::user_studies::{study, text},
};
use open_study::{HandSource, OpenStudy};
use trial::TrialScreen;

/// The pages, and the open study.
#[derive(Debug, Default)]
pub(super) struct Studies {
    list: list::StudyList,
    form: Option<form::StudyForm>,
    desk: Option<OpenStudy>,
    trial: Option<TrialScreen>,
    /// A trial that starts as soon as the rig of the study runs.
    wanted: Option<TrialRequest>,
    /// Rig and scene that ran before the study.
    before: Option<RigChoice>,
}

/// A trial that is about to start.
#[derive(Clone, Debug)]
struct TrialRequest {
    participant: String,
    hand: HandSource,
    /// The rig of the study was started for it.
    is_starting: bool,
}

/// Reason for leaving the page of a study.
#[derive(Debug)]
enum Leaves {
    /// Start the next trial of this participant.
    Trial(String, HandSource),
    Closed,
    List,
}

impl Studies {
    fn take_study(&mut self, study: UserStudy, report: Option<String>, room: &mut Room<'_>) {
        let folder = study.folder().to_owned();
        if !list::is_in(room.folder, &folder) && !room.known.contains(&folder) {
            room.known.push(folder);
        }
        self.desk = Some(OpenStudy::new(study, report));
        self.form = None;
    }

    /// Draws the list, the form, or the open study.
    fn page_ui(&mut self, ui: &mut Ui, mut room: Room<'_>) -> Option<Leaves> {
        if let Some(desk) = &mut self.desk {
            let closed = if room.is_over_a_line { Some(text::studies::NOT_OVER_A_LINE.get()) } else { room.closed };
            let starting = room.is_starting || self.wanted.is_some();
            let leaves = desk.ui(ui, closed, starting);
            if matches!(leaves, Some(Leaves::Closed)) {
                self.desk = None;
                self.list.read(room.folder, room.known);
            }
            return leaves;
        }
        if let Some(form) = &mut self.form {
            match form.ui(ui, room.folder) {
                Some(form::FormChoice::Back) => self.form = None,
                Some(form::FormChoice::Made(study)) => {
                    let report = text::study_form::made(study.folder());
                    self.take_study(*study, Some(report), &mut room);
                }
                None => {}
            }
            return None;
        }
        match self.list.ui(ui) {
            Some(list::StudyListChoice::Back) => return Some(Leaves::List),
            Some(list::StudyListChoice::New) => self.form = form::StudyForm::new(),
            Some(list::StudyListChoice::Open(study)) => self.take_study(*study, None, &mut room),
            None => {}
        }
        None
    }

    /// Starts a trial when the rig of its study runs.
    fn begin(&mut self, now: &PageContext<'_>) -> Option<PageRequest> {
        let wanted = self.wanted.as_mut().filter(|_| !now.is_starting)?;
        let Some(desk) = &mut self.desk else {
            self.wanted = None;
            return None;
        };
        let scene = study::scene_file(&desk.study).display().to_string();
        let choice = RigChoice { rig: desk.study.plan().rig.clone(), scene };
        if *now.running == choice {
            return Some(PageRequest::Run);
        }
        if wanted.is_starting {
            self.wanted = None;
            desk.report = Some(text::studies::NOT_STARTED.get().to_owned());
            return None;
        }
        wanted.is_starting = true;
        self.before.get_or_insert_with(|| now.running.clone());
        Some(PageRequest::Start(choice))
    }
}

impl Page for Studies {
    fn name(&self) -> [&'static str; 2] {
        [text::studies::OPEN.get(), text::studies::OPEN_HOVER.get()]
    }

    fn read(&mut self, folder: Option<&Path>, known: &[std::path::PathBuf]) {
        self.list.read(folder, known);
    }

    fn holds_machine(&self) -> bool {
        self.desk.is_some()
    }

    fn ui(&mut self, ui: &mut Ui, room: Room<'_>) -> Option<LeftPage> {
        let frame = Frame::new().inner_margin(Margin::symmetric(14, 12));
        let leaves = CentralPanel::default().frame(frame).show(ui, |ui| self.page_ui(ui, room)).inner?;
        match leaves {
            Leaves::Trial(participant, hand) => {
                self.wanted = Some(TrialRequest { participant, hand, is_starting: false });
                None
            }
            Leaves::Closed => Some(LeftPage::Machine(self.before.take())),
            Leaves::List => Some(LeftPage::Page),
        }
    }

    fn go_on(&mut self, now: &PageContext<'_>) -> Option<PageRequest> {
        let Some(trial) = &mut self.trial else { return self.begin(now) };
        if let Some(why) = now.ended {
            trial.break_off(why);
            return Some(PageRequest::End { again: why == RunBreak::LoopEnded });
        }
        (trial.is_over() && !now.is_latched).then_some(PageRequest::End { again: true })
    }

    fn notify(&mut self, why: Option<String>) {
        self.wanted = None;
        if let Some(desk) = &mut self.desk {
            desk.report = why;
        }
    }

    fn prepare(&mut self) -> Result<PreparedRun, String> {
        let (Some(desk), Some(wanted)) = (&mut self.desk, self.wanted.take()) else {
            return Err(text::studies::NOT_STARTED.get().to_owned());
        };
        let participant = wanted.participant.as_str();
        let of = &mut desk.study;
        let rig = RigConfig::load(&of.plan().rig).map_err(|error| chain(&error))?;
        let hand = study::plain_hand(of, participant).map_err(|error| format!("{error:#}"))?;
        let (scene, task) = study::scene_for(of, &rig, &hand).map_err(|error| format!("{error:#}"))?;
        let running = of.begin_trial(participant, wanted.hand.is_simulated(), &utc_now());
        let running = running.map_err(|error| error.to_string())?;
        // A reason why a rig does not permit a condition would reveal the condition.
        let rig = study::under(rig, running.condition()).ok();
        let trial = TrialScreen::new(participant, running, task, wanted.hand, of.plan().trials_of_each());
        let is_by_mouse = trial.is_by_mouse();
        self.trial = Some(trial);
        Ok(PreparedRun { rig, scene, is_by_mouse })
    }

    fn run(&self) -> Option<&dyn PageRun> {
        self.trial.as_ref().map(|trial| trial as &dyn PageRun)
    }

    fn run_mut(&mut self) -> Option<&mut (dyn PageRun + 'static)> {
        self.trial.as_mut().map(|trial| trial as &mut dyn PageRun)
    }

    fn finish_run(&mut self) {
        if let (Some(trial), Some(desk)) = (self.trial.take(), &mut self.desk) {
            desk.finish(trial);
        }
    }
}

/// Draws a column of this size that scrolls.
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

/// Draws a field with its name above it.
fn field_ui(ui: &mut Ui, name: &str, value: &mut String) -> Response {
    let label = ui.label(nima_screen::widgets::small(name));
    let field = TextEdit::singleline(value).char_limit(200);
    ui.add_sized(vec2(ui.available_width(), 26.0), field).labelled_by(label.id)
}
