//! The console while a user study is open: its rig runs idle between the trials, and a trial has a loop of its own under its condition.
//!
//! The console's own recorder rests as long: a session holds the mode. What a study wants to keep it keeps itself, encrypted.

use egui::Ui;
use nima_machine::{config::RigConfig, messages::LoopState};
use nima_recording::store::utc_now;
use nima_simulation::scene::Scene;

use super::ConsoleApp;
use crate::{
    console::{
        chain,
        start::{Choice, is_real},
        studies::{Room, Trial, Wanted, Wish},
        text,
    },
    user_study,
};

impl ConsoleApp {
    /// Whether a trial of a study runs: then the window shows nothing else.
    pub const fn in_trial(&self) -> bool {
        self.studies.trial.is_some()
    }

    /// Whether a study is open.
    pub(super) const fn has_study(&self) -> bool {
        self.studies.has_study()
    }

    /// Shows the page. What the screen does to the machine by itself, a demonstration or leading by mouse, ends before.
    pub(super) fn open_studies(&mut self) {
        self.panels.demo.leave(&mut self.outbox);
        self.panels.scene.let_go(&mut self.outbox);
        (self.start.is_open, self.list.is_open) = (false, false);
        self.studies.open(self.settings.folder(), &self.settings.now.studies);
    }

    pub(super) fn studies_layout(&mut self, ui: &mut Ui) {
        let held = self.live.state() == LoopState::Engaged && is_real(&self.live.rig);
        let closed = match text::calibrations::closed(self.live.state()) {
            _ if self.reopen.is_some() => Some(text::studies::NOT_OVER_A_LINE.get()),
            None if held => Some(text::start::ENGAGED.get()),
            closed => closed,
        };
        let folder = self.settings.folder().map(std::path::Path::to_path_buf);
        let room = Room {
            folder: folder.as_deref(),
            known: &mut self.settings.now.studies,
            closed,
            is_starting: self.starting.is_some(),
        };
        match self.studies.ui(ui, room) {
            Some(Wish::Trial(participant, hand)) => {
                self.studies.wanted = Some(Wanted { participant, hand, is_starting: false });
            }
            Some(Wish::Closed) => self.close_study(),
            None => {}
        }
        self.sessions.rest(self.has_study());
    }

    /// The rig that ran before the study runs again.
    fn close_study(&mut self) {
        self.sessions.rest(false);
        if let Some(before) = self.studies.before.take() {
            let now = self.running.clone();
            self.begin(before, Some(now), None);
        }
    }

    /// Goes on with what a study asks of the loop. A stop or a fault that is latched keeps its loop until it is released.
    pub(super) fn go_on_studying(&mut self) {
        if self.door.as_ref().is_some_and(|door| !door.handle().is_running())
            && let Some(trial) = &mut self.studies.trial
        {
            let leaves = self.options.leave.is_asked();
            trial.break_off(if leaves { user_study::CLOSED } else { user_study::LOOP_ENDED });
            return self.finish_trial(!leaves);
        }
        let is_latched = self.live.state().is_latched();
        if self.studies.trial.as_ref().is_some_and(Trial::is_over) && !is_latched {
            return self.finish_trial(true);
        }
        let Some(wanted) = self.studies.wanted.clone().filter(|_| self.starting.is_none()) else { return };
        let Some(desk) = &mut self.studies.desk else {
            self.studies.wanted = None;
            return;
        };
        let scene = user_study::scene_file(&desk.study).display().to_string();
        let choice = Choice { rig: desk.study.plan().rig.clone(), scene };
        if self.running == choice {
            self.studies.wanted = None;
            if let Err(why) = self.start_trial(&wanted)
                && let Some(desk) = &mut self.studies.desk
            {
                desk.told = Some(why);
            }
        } else if wanted.is_starting {
            self.studies.wanted = None;
            desk.told = Some(text::studies::NOT_STARTED.get().to_owned());
        } else {
            self.studies.wanted = Some(Wanted { is_starting: true, ..wanted });
            self.studies.before.get_or_insert_with(|| self.running.clone());
            let before = self.running.clone();
            self.begin(choice, Some(before), None);
            if self.starting.is_none() {
                // The start page has the cause, which is told there when it is opened.
                self.studies.wanted = None;
                if let Some(desk) = &mut self.studies.desk {
                    desk.told = self.start.told().map(str::to_owned);
                }
            }
        }
    }

    /// The loop begins anew under the condition of the next trial, which nothing but the loop is told.
    fn start_trial(&mut self, wanted: &Wanted) -> Result<(), String> {
        self.take_in();
        if let Some(why) = text::calibrations::closed(self.live.state()) {
            return Err(why.to_owned());
        }
        let Some(desk) = &mut self.studies.desk else { return Ok(()) };
        let (study, participant) = (&mut desk.study, wanted.participant.as_str());
        let rig = RigConfig::load(&study.plan().rig).map_err(|error| chain(&error))?;
        let hand = user_study::plain_hand(study, participant).map_err(|error| format!("{error:#}"))?;
        let (scene, task) = user_study::scene_for(study, &rig, &hand).map_err(|error| format!("{error:#}"))?;
        let running = study.begin_trial(participant, wanted.hand.is_simulated(), &utc_now());
        let running = running.map_err(|error| error.to_string())?;
        let rig = user_study::under(rig, running.condition());
        let trial = Trial::new(participant, running, task, wanted.hand, study.plan().trials_of_each());
        self.panels.scene.be_of_participant(true, trial.is_by_mouse());
        self.studies.trial = Some(trial);
        self.clear_for_trial();
        // End the old loop first: a rig must have one controller only.
        drop(self.door.take());
        self.sessions.end();
        // Why a rig does not allow a condition would tell it.
        let started = rig.ok().and_then(|rig| self.start_loop(rig, scene).ok());
        if started.is_none() {
            if let Some(trial) = &mut self.studies.trial {
                trial.break_off(user_study::NOT_STARTED);
            }
            self.finish_trial(true);
        }
        Ok(())
    }

    /// Ends the loop of the trial, writes down how it ended, and starts the rig of the study again, idle, as its file has it.
    fn finish_trial(&mut self, again: bool) {
        let Some(trial) = self.studies.trial.take() else { return };
        self.panels.scene.let_go(&mut self.outbox);
        self.panels.scene.be_of_participant(false, false);
        drop(self.door.take());
        self.objects = None;
        let Some(desk) = &mut self.studies.desk else { return };
        desk.finish(trial);
        if !again {
            return;
        }
        let loaded = RigConfig::load(&self.running.rig).and_then(|rig| {
            let scene = Scene::load(&self.running.scene)?.mounted_at(&rig)?;
            Ok((rig, scene))
        });
        let started = loaded.map_err(|error| chain(&error)).and_then(|(rig, scene)| self.start_loop(rig, scene));
        if let (Err(why), Some(desk)) = (started, &mut self.studies.desk) {
            desk.told = Some(text::start::not_started(&why, None));
        }
    }

    /// The window is closed: a trial that runs is written down as broken off.
    pub(super) fn leave_study(&mut self) {
        if let Some(trial) = &mut self.studies.trial {
            trial.break_off(user_study::CLOSED);
            self.finish_trial(false);
        }
    }

    /// The participant's screen, below the top bar.
    pub(super) fn trial_layout(&mut self, ui: &mut Ui) {
        if let Some(trial) = &mut self.studies.trial {
            trial.ui(ui, &self.live, &mut self.panels.scene, &mut self.outbox);
        }
    }
}
