//! The console while the page of the ready check is open: runs the check, shows instructions at the arms, saves the record.

use std::time::{Duration, Instant, SystemTime};

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};
use nima_machine::{
    messages::{Command, LoopState, Watchdog},
    ready::{PersonRequest, ReadyEntry, ReadyPoint, ReadyState},
    rig::Roster,
};
use nima_panels::{CalibrationPage, CalibrationWish, calibrations_ui, tiles::PanelId};
use nima_screen::{theme, widgets::card};
use nima_simulation::scene::Scene;
use nima_wizards::ready::{ReadyRequest, ReadyRun, devices_of, ready_ui, record, subject};
use nima_words::{report_text::chain, text};

use super::{
    ConsoleApp,
    shown_page::{ShownPage, WayBack},
};

/// The scene with a simulated person at the arm.
const SCENE: &str = "correspondence";
/// Timeout for the serial numbers of the force sensors.
const SENSORS_WITHIN: Duration = Duration::from_secs(15);
/// Interval at which the existence of a valid check is tested.
const LOOK_EVERY: Duration = Duration::from_secs(5);

#[derive(Debug, Default)]
pub(super) struct CheckPage {
    run: Option<ReadyRun>,
    by: String,
    /// Path of the record, or the reason why it was not saved.
    saved: Option<String>,
    /// Whether a check of today exists for these devices, and the time of this test.
    valid: Option<(bool, Instant)>,
}

impl CheckPage {
    pub(super) const fn run_mut(&mut self) -> Option<&mut ReadyRun> {
        self.run.as_mut()
    }

    /// Returns the current instruction of the check.
    pub(super) fn ask(&self) -> Option<PersonRequest> {
        self.run.as_ref().map(|run| run.session.ask())
    }

    /// Returns the watchdog that the check is testing.
    pub(super) fn tested(&self) -> Option<Watchdog> {
        let tested = |entry: &ReadyEntry| match (entry.check, &entry.state) {
            (ReadyPoint::Watchdog(watchdog), ReadyState::Asking(_)) => Some(watchdog),
            _ => None,
        };
        self.run.as_ref()?.session.list().iter().find_map(tested)
    }

    /// Discards the results, because they belong to the previous loop.
    pub(super) fn forget(&mut self) {
        self.begin_anew();
        self.valid = None;
    }

    /// Discards unfinished points.
    fn begin_anew(&mut self) {
        self.run = None;
        self.saved = None;
    }
}

impl ConsoleApp {
    /// Opens the page; a simulated rig changes to a scene with a person at the arm.
    pub(super) fn open_check(&mut self) {
        let rests = matches!(self.live.state(), LoopState::Idle | LoopState::Disconnected);
        let rig = self.live.rig.clone();
        let scene = self.live.scene.clone();
        let opened = if self.live.rig.devices.is_none() && scene.person.is_none() {
            Scene::load(SCENE)
                .map_err(|error| nima_words::report_text::quoted(&error))
                .and_then(|scene| self.restart_in(scene))
        } else if rests {
            Ok(())
        } else {
            self.restart(rig, scene)
        };
        match opened {
            Ok(()) => {
                self.checking.begin_anew();
                self.shown = ShownPage::Check(Instant::now());
                if self.checking.by.is_empty() {
                    self.checking.by = std::env::var("USER").unwrap_or_default();
                }
            }
            Err(reason) => self.active.notify(text::calibrations::not_opened(&reason)),
        }
    }

    fn roster(&self) -> Roster {
        self.door.as_ref().map_or_else(Roster::new, |door| door.handle().roster().clone())
    }

    pub(super) fn go_on_checking(&mut self) {
        self.look_for_a_check();
        let ShownPage::Check(since) = self.shown else {
            self.checking.begin_anew();
            return;
        };
        if self.checking.run.is_none() {
            if self.active.is_waiting() && since.elapsed() < SENSORS_WITHIN {
                return;
            }
            let roster = self.roster();
            let subject = subject(&self.running.rig, &self.live.rig, &self.live.scene, &roster, &self.active);
            self.checking.run = Some(ReadyRun::new(subject));
        }
        let Some(run) = &mut self.checking.run else { return };
        run.session.healths(&self.live.healths);
        if let Some(command) = run.look() {
            self.outbox.push(command);
        }
        self.live.ticks.iter().flatten().filter_map(|tick| run.prompt_for(tick)).for_each(|it| self.outbox.push(it));
        if let Some(reader) = &self.reader {
            reader.show(run.screen(), &mut self.read);
        }
        if run.session.is_finished() && self.checking.saved.is_none() {
            self.keep_check();
        }
    }

    fn keep_check(&mut self) {
        let (Some(run), roster) = (&self.checking.run, self.roster()) else { return };
        let record = record(&run.session, &self.running.rig, &self.checking.by, &roster);
        let saved = self.active.store().map(|store| store.save_check(&record));
        self.checking.saved = Some(match saved {
            Some(Ok(path)) => text::ready::saved(&path),
            Some(Err(error)) => text::ready::not_saved(&nima_words::report_text::quoted(&chain(&error))),
            None => text::ready::not_saved(text::calibrations::NO_FOLDER.get()),
        });
        self.checking.valid = None;
    }

    /// Tests whether a passed check of today exists; a simulated rig needs none.
    fn look_for_a_check(&mut self) {
        if self.live.rig.devices.is_none() || self.checking.valid.is_some_and(|(_, at)| at.elapsed() < LOOK_EVERY) {
            return;
        }
        let last = self.active.store().and_then(|store| store.last_check(&self.live.rig.name));
        let valid = last.is_some_and(|record| record.is_valid(&devices_of(&self.roster()), SystemTime::now()));
        self.checking.valid = Some((valid, Instant::now()));
        self.live.is_unchecked = !valid;
        if self.live.rig.requires_check() {
            self.outbox.push(Command::Checked(valid));
        }
    }

    /// Lays out the page next to the active calibrations.
    pub(super) fn check_layout(&mut self, ui: &mut Ui) {
        let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
        let mut wish = None;
        Panel::left("calibrations").exact_size(316.0).resizable(false).frame(side).show(ui, |ui| {
            let panel = PanelId::Calibrations;
            wish = card(ui, panel.title(), panel.meaning(), |ui| {
                calibrations_ui(ui, &self.live, &self.active, Some(CalibrationPage::Check), self.way_back())
            });
        });
        let mut wanted = None;
        let roster = self.roster();
        let CheckPage { run, by, saved, .. } = &mut self.checking;
        CentralPanel::default().frame(Frame::new().inner_margin(Margin::symmetric(18, 14))).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.set_max_width(ui.available_width().min(760.0));
                wanted = ready_ui(ui, run.as_ref(), by, saved.as_deref(), &roster);
            });
        });
        match wanted {
            Some(ReadyRequest::Again) => {
                *saved = None;
                if let Some(run) = run {
                    run.session.again();
                }
            }
            Some(ReadyRequest::Whole) => self.checking.begin_anew(),
            Some(ReadyRequest::Close) => {
                self.top_bar.leads_to_engage = true;
                // From the set-up page too: its button leads to Engage, which is at the monitor.
                self.way_back = WayBack::Monitor;
                wish = Some(CalibrationWish::Close);
            }
            None => {}
        }
        self.obey_calibrations(wish);
    }
}
