//! The experimenter's page: progress, the next step of a participant, notes, exclusions, learning.

use egui::{Button, Label, RichText, Ui, vec2};
use nima_machine::config::RigConfig;
use nima_recording::store::utc_now;
use nima_screen::{
    theme,
    widgets::{card, next_button, small, weak},
};
use nima_user_study::{StudyError, StudyStep, UserStudy};

use super::{
    Leaves, break_page, column, curve::curve_ui, field_ui, questions, side_panel::SidePanel, trial::TrialScreen,
};
use crate::extras::user_studies::text;

/// Widths of the columns of participants and of the study.
const WHO: f32 = 250.0;
const ASIDE: f32 = 300.0;

/// Source of the instruments' motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HandSource {
    /// The participant, from the screen.
    Mouse,
    /// The simulation; marked as simulated.
    Simulated,
    /// The participant, with the handle of the rig.
    OfRig,
    /// The emulated handle; marked as simulated.
    Emulated,
}

impl HandSource {
    /// Returns whether no person takes part.
    pub(super) const fn is_simulated(self) -> bool {
        matches!(self, Self::Simulated | Self::Emulated)
    }

    fn of(rig: &RigConfig) -> Self {
        match &rig.devices {
            Some(devices) if devices.emulated => Self::Emulated,
            Some(_) => Self::OfRig,
            None if rig.desk.is_some() => Self::OfRig,
            None => Self::Mouse,
        }
    }
}

/// Displayed page of an open study.
#[derive(Debug, Default)]
enum StudyPage {
    #[default]
    Desk,
    Rest(break_page::BreakPage),
    Sheet,
}

#[derive(Debug)]
pub(super) struct OpenStudy {
    pub(super) study: UserStudy,
    /// The participant for the next step.
    chosen: String,
    hand: HandSource,
    page: StudyPage,
    /// Answers that were not submitted yet.
    sheet: Option<questions::QuestionnairePage>,
    /// Result of the last action.
    pub(super) report: Option<String>,
    note: String,
    reason: String,
    /// The trial to exclude; `None` for the participant.
    left_out: Option<u32>,
    aside: SidePanel,
}

impl OpenStudy {
    pub(super) fn new(mut study: UserStudy, report: Option<String>) -> Self {
        let report = study.take_trouble().or(report);
        let rig = RigConfig::load(&study.plan().rig);
        let hand = rig.as_ref().map_or(HandSource::OfRig, HandSource::of);
        // A participant who is in the middle of a session comes first.
        let plan = study.plan();
        let state = study.state();
        let goes_on = plan.participants.iter().find(|one| !matches!(state.next(plan, one), StudyStep::Done { .. }));
        let chosen = goes_on.or_else(|| plan.participants.first()).map_or_else(String::new, |one| one.name.clone());
        Self {
            study,
            chosen,
            hand,
            page: StudyPage::Desk,
            sheet: None,
            report: report.or_else(|| rig.err().map(|error| error.to_string())),
            note: String::new(),
            reason: String::new(),
            left_out: None,
            aside: SidePanel::default(),
        }
    }

    /// Records the result of a trial. The loop must have ended.
    pub(super) fn finish(&mut self, trial: TrialScreen) {
        let (words, notes) = trial.close(&mut self.study);
        for note in notes {
            self.study.note(Some(&self.chosen), &note, &utc_now()).ok();
        }
        let all = std::iter::once(words).chain(self.study.take_trouble());
        self.report = Some(all.collect::<Vec<_>>().join("\n"));
    }

    /// Draws the page; `closed` is the reason why no trial can start now.
    pub(super) fn ui(&mut self, ui: &mut Ui, closed: Option<&'static str>, starting: bool) -> Option<Leaves> {
        match &self.page {
            StudyPage::Desk => self.desk_ui(ui, closed, starting),
            StudyPage::Rest(rest) => {
                match rest.ui(ui) {
                    Some(break_page::BreakChoice::Back) => self.page = StudyPage::Desk,
                    Some(break_page::BreakChoice::Over(seconds)) => {
                        let taken = self.study.take_break(&self.chosen, seconds, false, &utc_now());
                        self.after(taken, text::studies::BREAK_DONE.get());
                    }
                    None => {}
                }
                None
            }
            StudyPage::Sheet => {
                match self.sheet.as_mut().and_then(|sheet| sheet.ui(ui)) {
                    Some(questions::QuestionChoice::Back) => self.page = StudyPage::Desk,
                    Some(questions::QuestionChoice::Submit(answers)) => {
                        let kept = self.study.answer(&self.chosen, answers, false, &utc_now());
                        self.sheet = None;
                        self.after(kept, text::questionnaires::SUBMITTED.get());
                        self.ask();
                    }
                    None => {}
                }
                None
            }
        }
    }

    /// Returns to the page, with the result of the action.
    fn after(&mut self, done: Result<(), StudyError>, words: &str) {
        self.page = StudyPage::Desk;
        self.report = Some(done.map_or_else(|error| error.to_string(), |()| words.to_owned()));
    }

    /// Shows the next questionnaire, if there is one.
    fn ask(&mut self) {
        let Ok(StudyStep::Questionnaire { questionnaire, after }) = self.study.next(&self.chosen) else { return };
        if !self.sheet.as_ref().is_some_and(|sheet| sheet.is(&self.chosen, questionnaire, after)) {
            self.sheet = Some(questions::QuestionnairePage::new(&self.chosen, questionnaire, after));
        }
        self.page = StudyPage::Sheet;
    }

    fn desk_ui(&mut self, ui: &mut Ui, closed: Option<&'static str>, starting: bool) -> Option<Leaves> {
        let mut wish = None;
        let room = ui.available_size();
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GAP;
            column(ui, "who", vec2(WHO, room.y), |ui| self.who_ui(ui));
            let width = room.x - WHO - ASIDE - 2.0 * theme::GAP;
            column(ui, "step", vec2(width, room.y), |ui| {
                wish = self.step_ui(ui, closed, starting);
                self.learning_ui(ui);
                self.note_ui(ui);
                self.leave_out_ui(ui);
            });
            column(ui, "study", vec2(ASIDE, room.y), |ui| {
                let close = Button::new(text::studies::CLOSE).min_size(vec2(ui.available_width(), 36.0));
                if ui.add_enabled(!starting, close).on_hover_text(text::studies::CLOSE_HOVER).clicked() {
                    wish = Some(Leaves::Closed);
                }
                ui.add_space(theme::GAP);
                let Self { study, aside, .. } = self;
                aside.ui(ui, study);
            });
        });
        wish
    }

    fn who_ui(&mut self, ui: &mut Ui) {
        let trials = self.study.plan().trials_of_each();
        let mut chosen = None;
        card(ui, text::studies::WHO, text::studies::WHO_HOVER, |ui| {
            for one in &self.study.plan().participants {
                let button = Button::selectable(self.chosen == one.name, &one.name).frame_when_inactive(true);
                if ui.add(button.min_size(vec2(ui.available_width(), 26.0))).clicked() {
                    chosen = Some(one.name.clone());
                }
                let step = self.study.state().next(self.study.plan(), one);
                ui.add(Label::new(small(text::studies::next(&step, trials))).wrap());
            }
        });
        if let Some(chosen) = chosen.filter(|chosen| *chosen != self.chosen) {
            self.chosen = chosen;
            self.report = None;
            self.left_out = None;
        }
    }

    fn step_ui(&mut self, ui: &mut Ui, closed: Option<&'static str>, starting: bool) -> Option<Leaves> {
        let participant = self.study.plan().participant(&self.chosen).ok()?.clone();
        let step = self.study.next(&self.chosen).ok()?;
        let mut begun = false;
        card(ui, text::studies::NEXT_STEP, text::studies::NEXT_STEP_HOVER, |ui| {
            ui.horizontal(|ui| {
                ui.label(RichText::new(&self.chosen).font(theme::strong(22.0)));
                ui.label(small(text::studies::order(&participant.order)));
            });
            let next = text::studies::next(&step, self.study.plan().trials_of_each());
            ui.add(Label::new(RichText::new(next).font(theme::strong(17.0))).wrap());
            self.done_ui(ui);
            let is_trial = matches!(step, StudyStep::Practice { .. } | StudyStep::Trial { .. });
            if is_trial {
                self.hand_ui(ui);
            }
            let why = if starting { Some(text::studies::STARTING.get()) } else { closed.filter(|_| is_trial) };
            if let Some(words) = text::studies::begin(&step) {
                let name = RichText::new(words).font(theme::strong(17.0));
                let button = next_button(name, why.is_none()).min_size(vec2(260.0, 48.0));
                begun = ui.add_enabled(why.is_none(), button).clicked();
            }
            // A separate line, so that the content below does not move.
            let report = why.map(str::to_owned).or_else(|| self.report.clone()).unwrap_or_default();
            ui.add(Label::new(report).wrap());
        });
        if begun { self.begin(&step) } else { None }
    }

    fn begin(&mut self, step: &StudyStep) -> Option<Leaves> {
        self.report = None;
        match step {
            StudyStep::Practice { .. } | StudyStep::Trial { .. } => {
                return Some(Leaves::Trial(self.chosen.clone(), self.hand));
            }
            StudyStep::Break { min_s } => self.page = StudyPage::Rest(break_page::BreakPage::begin(*min_s)),
            StudyStep::Questionnaire { .. } => self.ask(),
            StudyStep::Running { .. } | StudyStep::Done { .. } => {}
        }
        None
    }

    fn done_ui(&self, ui: &mut Ui) {
        let Some(progress) = self.study.state().progress(&self.chosen) else { return };
        let lost = progress.trials.iter().filter(|made| made.measures.is_none()).count();
        let practice = progress.practice_s.len();
        let breaks = progress.breaks_s.len();
        let words = text::studies::done(practice, progress.trials.len(), lost, progress.interruptions, breaks);
        ui.add(Label::new(weak(words)).wrap());
    }

    fn hand_ui(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label(weak(text::studies::HAND));
            match self.hand {
                HandSource::Mouse | HandSource::Simulated => {
                    for (hand, name, hover) in [
                        (HandSource::Mouse, text::studies::BY_MOUSE.get(), ""),
                        (
                            HandSource::Simulated,
                            text::studies::BY_SIMULATED.get(),
                            text::studies::BY_SIMULATED_HOVER.get(),
                        ),
                    ] {
                        let button = Button::selectable(self.hand == hand, name).frame_when_inactive(true);
                        let button = ui.add(button.min_size(vec2(96.0, 28.0)));
                        let button = if hover.is_empty() { button } else { button.on_hover_text(hover) };
                        if button.clicked() {
                            self.hand = hand;
                        }
                    }
                }
                HandSource::OfRig => {
                    ui.label(text::studies::BY_RIG);
                }
                HandSource::Emulated => {
                    ui.label(text::studies::BY_SIMULATED).on_hover_text(text::studies::BY_SIMULATED_HOVER);
                }
            }
        });
    }

    fn learning_ui(&self, ui: &mut Ui) {
        let all = self.study.learning();
        let learning = all.iter().find(|learning| learning.participant == self.chosen);
        card(ui, text::studies::LEARNING, text::studies::LEARNING_HOVER, |ui| curve_ui(ui, learning));
    }

    fn note_ui(&mut self, ui: &mut Ui) {
        let mut kept = false;
        card(ui, text::studies::NOTE, text::studies::NOTE_HOVER, |ui| {
            field_ui(ui, text::studies::NOTE_FIELD.get(), &mut self.note);
            let button = Button::new(text::studies::NOTE_KEEP).min_size(vec2(140.0, 30.0));
            kept = ui.add_enabled(!self.note.trim().is_empty(), button).clicked();
        });
        if kept {
            let noted = self.study.note(Some(&self.chosen), self.note.trim(), &utc_now());
            if noted.is_ok() {
                self.note.clear();
            }
            self.after(noted, text::studies::NOTE_KEPT.get());
        }
    }

    fn leave_out_ui(&mut self, ui: &mut Ui) {
        let made: Vec<u32> = self
            .study
            .state()
            .progress(&self.chosen)
            .map_or_else(Vec::new, |progress| progress.trials.iter().map(|made| made.number).collect());
        let mut pressed = false;
        card(ui, text::studies::LEAVE_OUT, text::studies::LEAVE_OUT_HOVER, |ui| {
            ui.horizontal_wrapped(|ui| {
                let choices = std::iter::once(None).chain(made.into_iter().map(Some));
                for choice in choices {
                    let name =
                        choice.map_or_else(|| text::studies::EVERYTHING.get().to_owned(), text::studies::of_trial);
                    let button = Button::selectable(self.left_out == choice, name).frame_when_inactive(true);
                    if ui.add(button).clicked() {
                        self.left_out = choice;
                    }
                }
            });
            field_ui(ui, text::studies::REASON.get(), &mut self.reason);
            let button = Button::new(text::studies::LEAVE_OUT_NOW).min_size(vec2(140.0, 30.0));
            pressed = ui.add_enabled(!self.reason.trim().is_empty(), button).clicked();
        });
        if pressed {
            let done = self.study.exclude(&self.chosen, self.left_out, self.reason.trim(), &utc_now());
            let words = text::studies::left_out(&self.chosen, self.left_out);
            if done.is_ok() {
                self.reason.clear();
            }
            self.after(done, &words);
        }
    }
}
