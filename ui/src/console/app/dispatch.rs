//! Effects of the commands: the same for menu, button, key and palette.

use egui::{Context, Event, Rect};
use nima_machine::messages::Command;
use nima_panels::{
    CalibrationWish,
    roles::Role,
    settings::{ConsoleSettings, ImageSettings},
    tiles::PanelLayout,
};

use super::{ConsoleApp, shown_page::ShownPage};
use crate::console::{
    commands::{Action, Availability, CommandEntry, table},
    help::Help,
    keys,
    undo::ScreenLook,
};

impl ConsoleApp {
    /// Runs the commands chosen in the palette or by keys.
    pub(super) fn obey_commands(&mut self, ctx: &Context) {
        let chosen = self.palette.take();
        let pressed = keys::pressed(ctx, |action| self.may(action) == Availability::Can);
        if pressed.iter().any(|action| *action != Action::Palette) {
            self.palette.close();
        }
        for action in chosen.into_iter().chain(pressed) {
            self.act(action, ctx);
        }
    }

    /// The palette with all commands that are available here.
    pub(super) fn palette_ui(&mut self, ctx: &Context, room: Rect) {
        if self.palette.is_open() {
            let rows = table().iter().map(|entry| (entry, self.may(entry.action)));
            let here = |(entry, reach): &(&CommandEntry, Availability)| {
                *reach != Availability::Absent && entry.action != Action::Palette
            };
            let rows: Vec<_> = rows.filter(here).collect();
            self.palette.ui(ctx, room, &rows);
        }
    }

    /// Runs the command if it is available.
    pub(super) fn act(&mut self, action: Action, ctx: &Context) {
        if self.may(action) != Availability::Can {
            return;
        }
        match action {
            Action::Stop => self.outbox.push(Command::Stop),
            // Leave it to the button, which waits a moment after every change of state.
            Action::Engage | Action::Release => self.top_bar.wants_step = Some(action),
            Action::View(role) => self.show_view(role, ctx),
            Action::Rig if matches!(self.shown, ShownPage::Start) => self.leave_page(),
            Action::Rig => self.open_start(),
            Action::Sessions => self.toggle_list(),
            Action::Studies => self.toggle_page(),
            Action::Alarms => self.top_bar.alarms.list ^= true,
            Action::Acknowledge => self.top_bar.alarms.log.acknowledge(),
            Action::Mark => self.live.mark(),
            Action::Keep => self.sessions.toggle_kept(),
            Action::Check => self.obey_calibrations(Some(CalibrationWish::Check)),
            Action::Calibrations => self.obey_calibrations(Some(CalibrationWish::List)),
            Action::Calibrate(which) => self.obey_calibrations(Some(CalibrationWish::Open(which))),
            Action::CloseWizard => self.obey_calibrations(Some(CalibrationWish::Close)),
            Action::LeavePast => self.leave_page(),
            Action::Play | Action::Step(_) => self.act_in_past(action),
            action if action.is_of_part() => press_key_of(action, ctx),
            action => self.act_on_screen(action),
        }
    }

    fn show_view(&mut self, role: Role, ctx: &Context) {
        self.settings.now.role = role;
        // A menu belongs to the view over which it was opened.
        egui::Popup::close_all(ctx);
        match self.shown.past_mut() {
            Some(past) => past.is_choosing = false,
            None if self.starting.is_none() => self.leave_page(),
            None => {}
        }
    }

    fn act_in_past(&mut self, action: Action) {
        let Some(past) = self.shown.past_mut() else { return };
        match action {
            Action::Step(ms) => past.show(past.shown_s() + 1e-3 * f64::from(ms)),
            _ => past.toggle(),
        }
    }

    /// Executes a command that only changes the screen.
    fn act_on_screen(&mut self, action: Action) {
        let settings = &mut self.settings.now;
        match action {
            Action::Undo => {
                let look = self.history.undo();
                self.show_as(look);
            }
            Action::Redo => {
                let look = self.history.redo();
                self.show_as(look);
            }
            Action::Glossary => self.help.glossary ^= true,
            Action::Tour => self.help.begin_tour(),
            Action::Palette => self.palette.toggle(),
            Action::Light(light) => settings.light = light,
            Action::ColourBlind => settings.colour_blind ^= true,
            Action::Touch => settings.touch ^= true,
            Action::Language(language) => settings.language = language,
            Action::Larger => settings.scale_by(1),
            Action::Smaller => settings.scale_by(-1),
            Action::Size(percent) => settings.scale_percent = percent,
            Action::Sound => settings.sound ^= true,
            Action::ForcesOfNow => settings.image.forces_of_now ^= true,
            Action::PlainPicture => {
                let forces_of_now = settings.image.forces_of_now;
                settings.image = ImageSettings { forces_of_now, ..ImageSettings::default() };
            }
            Action::RecordsPicture => settings.records_image ^= true,
            Action::Panel(panel) => settings.layout.toggle(panel),
            Action::Window(panel) => settings.layout.toggle_window(panel),
            Action::Arrange(arrangement) => settings.layout = PanelLayout::built_in(arrangement),
            Action::ResetLayout => settings.layout = PanelLayout::built_in(settings.layout.arrangement),
            action => self.act_on_view(action),
        }
    }

    /// Executes a command that changes the views.
    fn act_on_view(&mut self, action: Action) {
        let (live, panels) = match self.shown.past_mut() {
            Some(past) => (past.live.as_deref(), &mut past.panels),
            None => (Some(&self.live), &mut self.panels),
        };
        match action {
            Action::Pause => {
                if let Some(live) = live {
                    panels.forces.toggle_pause(live);
                }
            }
            Action::LastTenSeconds => panels.forces.show_last_ten(),
            Action::Draws(switch) => *panels.scene.extras.of(switch) ^= true,
            _ => {}
        }
    }

    /// Returns the layout and display settings, which can be undone.
    fn look(&self) -> ScreenLook {
        let ConsoleSettings { layout, language, scale_percent, image, .. } = &self.settings.now;
        let look = self.settings.now.look();
        let language = *language;
        let scale_percent = *scale_percent;
        let image = *image;
        let extras = self.panels.scene.extras;
        let traces = self.panels.forces.view();
        ScreenLook { layout: layout.clone(), look, language, scale_percent, image, extras, traces }
    }

    fn show_as(&mut self, look: Option<ScreenLook>) {
        let Some(look) = look else { return };
        let ScreenLook { layout, look, language, scale_percent, image, extras, traces } = look;
        let settings = &mut self.settings.now;
        settings.layout = layout;
        settings.light = look.light;
        settings.colour_blind = look.colour_blind;
        settings.touch = look.touch;
        settings.scale_percent = scale_percent;
        settings.image = image;
        settings.language = language;
        self.panels.scene.extras = extras;
        self.panels.forces.show(traces);
    }

    /// Records undoable changes at the end of a frame.
    pub(super) fn remember_look(&mut self, ctx: &Context) {
        let (time_s, held) = ctx.input(|input| (input.time, input.pointer.any_down()));
        self.history.watch(self.look(), time_s, held);
    }

    /// Closes windows that cover the view when a trial starts.
    pub(super) fn clear_for_trial(&mut self) {
        self.help = Help::default();
        self.top_bar.alarms.list = false;
        self.palette.close();
    }
}

/// Simulates the key press for the part of the window that reads the key itself.
fn press_key_of(action: Action, ctx: &Context) {
    let Some(stroke) = CommandEntry::of(action).and_then(|entry| entry.keys.first()) else { return };
    let event = Event::Key {
        key: stroke.key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: stroke.with.modifiers(),
    };
    ctx.input_mut(|input| input.events.push(event));
}

#[cfg(test)]
mod tests {
    use egui::{Key, Modifiers};
    use egui_kittest::Harness;
    use nima_simulation::SimulationPlan;

    use super::*;
    use crate::{
        console::{app::start_recorded, sessions::ConsoleSessions},
        watching::Servers,
    };

    /// Only the console itself can be given a recorder.
    #[test]
    fn a_session_is_kept_by_its_key_and_from_the_palette() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = ConsoleSessions::of_user(Some(folder.path()), Servers::default());
        let plan = SimulationPlan { engage: false, ..nima_tests::plan("free_motion") };
        let (handle, _) = start_recorded(&plan, &mut sessions, None).unwrap();
        let mut window = Harness::builder()
            .with_size([1280.0, 720.0])
            .build_eframe(move |cc| ConsoleApp::new(cc, handle, plan.rig, plan.scene).with_sessions(sessions));
        let is_kept = |window: &Harness<'_, ConsoleApp>| window.state().sessions.shown().unwrap().kept;
        window.run_steps(2);
        assert!(!is_kept(&window));
        window.key_press(Key::K);
        window.run_steps(2);
        assert!(is_kept(&window));
        window.key_press_modifiers(Modifiers::COMMAND, Key::P);
        window.run_steps(3);
        window.event(Event::Text("keep the session".to_owned()));
        window.run_steps(2);
        window.key_press(Key::Enter);
        window.run_steps(3);
        assert!(!is_kept(&window) && !window.state().palette.is_open());
    }
}
