//! Availability of each command for the person at this screen, with the reason if it is not available.

use nima_machine::messages::LoopState;
use nima_panels::{
    roles::{Panels, Role},
    settings::ImageSettings,
    tiles::PanelId,
};
use nima_wizards::WizardKind;
use nima_words::text;

use super::{ConsoleApp, shown_page::ShownPage};
use crate::console::commands::{Action, Availability};

impl ConsoleApp {
    /// A person guides the arm, or a study is open: the views are locked, and the arm cannot be engaged.
    pub(super) fn is_calibrating(&self) -> bool {
        self.shown.guides_a_person() || self.is_held() && !self.in_trial()
    }

    pub(super) fn may(&self, action: Action) -> Availability {
        if self.in_trial() && !action.is_of_participant() {
            return Availability::Absent;
        }
        match action {
            Action::Engage | Action::Release => self.may_step(action),
            Action::View(_) => {
                Availability::unless(self.is_calibrating().then_some(text::roles::SWITCH_DISABLED_HOVER.get()))
            }
            Action::Rig | Action::Sessions | Action::Studies => self.may_turn_to(action),
            Action::Acknowledge => {
                let is_quiet = !self.top_bar.alarms.log.has_unseen();
                Availability::unless(is_quiet.then_some(text::commands::NO_ALARM.get()))
            }
            Action::Mark => Availability::unless(self.shown.is_past().then_some(text::playback::BLOCKED.get())),
            Action::Keep => {
                let nothing = self.sessions.shown().is_none();
                Availability::unless(nothing.then_some(text::commands::NOTHING_RECORDED.get()))
            }
            Action::Undo => {
                Availability::unless((!self.history.can_undo()).then_some(text::commands::NOTHING_TO_UNDO.get()))
            }
            Action::Redo => {
                Availability::unless((!self.history.can_redo()).then_some(text::commands::NOTHING_TO_REDO.get()))
            }
            Action::PlainPicture => {
                Availability::unless(self.shows_image_plain().then_some(text::commands::IS_PLAIN.get()))
            }
            Action::Panel(_) | Action::Window(_) | Action::Arrange(_) | Action::ResetLayout => {
                Availability::Can.only_if(self.role() == Role::Technician)
            }
            Action::Check | Action::Calibrations | Action::Calibrate(_) | Action::CloseWizard => {
                self.may_calibrate(action)
            }
            Action::Pause | Action::LastTenSeconds | Action::Draws(_) => self.may_draw(action),
            action if action.is_of_part() => self.may_in_part(action),
            Action::LeavePast => Availability::Can.only_if(self.shown.is_past()),
            Action::Play | Action::Step(_) => {
                let opening = self.shown.past().is_some_and(|past| past.live.is_none());
                Availability::unless(opening.then_some(text::playback::OPENING.get())).only_if(self.shown.is_past())
            }
            _ => Availability::Can,
        }
    }

    fn may_step(&self, action: Action) -> Availability {
        let state = self.live.state();
        let latched = state.is_latched();
        let short_stall = matches!(state, LoopState::Faulted(fault) if fault.is_short_stall(self.live.rig.rate_hz));
        let why = match (action, state) {
            (Action::Release, _) if !latched => Some(text::commands::NOT_STOPPED.get()),
            (Action::Engage, _) if latched && !short_stall => Some(text::commands::RELEASE_FIRST.get()),
            (Action::Engage, LoopState::Disconnected) => text::calibrations::closed(state),
            (Action::Engage, LoopState::Engaged | LoopState::Ready | LoopState::Clutched) => {
                Some(text::commands::IS_ENGAGED.get())
            }
            _ if self.shown.is_past() => Some(text::playback::BLOCKED.get()),
            (Action::Engage, _) if matches!(self.shown, ShownPage::Check(_)) => Some(text::ready::ENGAGE_CLOSED.get()),
            (Action::Engage, _) if self.is_calibrating() => Some(text::start::OPEN_DISABLED_HOVER.get()),
            _ => None,
        };
        Availability::unless(why)
    }

    fn may_turn_to(&self, action: Action) -> Availability {
        let why = if self.shown.is_past() {
            Some(text::playback::BLOCKED.get())
        } else if self.is_held() && action == Action::Studies {
            Some(text::commands::STUDY_IS_OPEN.get())
        } else if self.is_calibrating() {
            Some(text::start::OPEN_DISABLED_HOVER.get())
        } else {
            // The page itself shows its progress.
            let may_look = action == Action::Rig && !matches!(self.shown, ShownPage::Start);
            (self.starting.is_some() && !may_look).then_some(text::commands::IS_STARTING.get())
        };
        Availability::unless(why)
    }

    /// Returns the availability as on the Calibration panel, which is in the Technician view and next to the wizards.
    fn may_calibrate(&self, action: Action) -> Availability {
        let page = &self.shown;
        let is_beside = matches!(page, ShownPage::Check(_) | ShownPage::Setup(_) | ShownPage::Wizard(_));
        if action == Action::CloseWizard {
            return Availability::Can.only_if(is_beside);
        }
        let rig = &self.live.rig;
        let (is_open, is_offered) = match action {
            Action::Check => (matches!(page, ShownPage::Check(_)), true),
            Action::Calibrations => (matches!(page, ShownPage::Setup(_)), true),
            Action::Calibrate(which) => {
                let is_open = page.wizard() == Some(which);
                let is_offered = match which {
                    WizardKind::Camera => rig.endoscope.is_some(),
                    _ => rig.devices.is_some() || which.scene().is_some(),
                };
                (is_open, is_offered)
            }
            _ => (false, false),
        };
        let closed = match action {
            Action::Calibrations => None,
            Action::Calibrate(_) => text::calibrations::closed(self.live.state_for(self.active.side())),
            _ => text::calibrations::closed(self.live.state()),
        };
        let why = is_open.then_some(text::calibrations::IS_OPEN.get()).or(closed);
        let why = self.shown.is_past().then_some(text::playback::BLOCKED.get()).or(why);
        let of_technician = self.role() == Role::Technician && matches!(page, ShownPage::Monitor | ShownPage::Past(_));
        Availability::unless(why).only_if(is_offered && (is_beside || of_technician))
    }

    /// Traces and field are in the Technician and Demo views.
    fn may_draw(&self, action: Action) -> Availability {
        let is_here = self.role() != Role::Surgeon && self.panels_in_view().is_some();
        let of_technician = self.role() == Role::Technician;
        let why = match action {
            Action::Draws(_) => {
                let seen = self.panels_in_view().is_some_and(|panels| panels.scene.is_seen);
                (!seen).then_some(text::commands::FIELD_IS_HIDDEN.get())
            }
            _ if of_technician && !self.settings.now.layout.is_open(PanelId::Traces) => {
                Some(text::commands::PANEL_IS_CLOSED.get())
            }
            _ => None,
        };
        Availability::unless(why).only_if(is_here)
    }

    /// Returns the availability as in the part of the window that reads its keys.
    fn may_in_part(&self, action: Action) -> Availability {
        if matches!(action, Action::HideForces | Action::Lens) {
            let eyes = self.panels_in_view().map(|panels| &panels.eyes);
            let eyes = eyes.filter(|eyes| eyes.is_on() && self.role() == Role::Surgeon);
            let has = eyes.is_some_and(|eyes| action == Action::HideForces || eyes.has_two_lenses());
            return Availability::Can.only_if(has);
        }
        let scene = &self.live.scene;
        let view = &self.panels.scene;
        let is_searched = scene.is_searched();
        let is_offered = match action {
            Action::OtherHand => self.live.is_bimanual(),
            Action::Jaws => scene.objects.is_some(),
            Action::MarkPlace | Action::EndTrial => is_searched,
            Action::BeginTrial => is_searched || scene.wire.is_some() || scene.objects.is_some(),
            _ => true,
        };
        let runs = matches!(self.live.state(), LoopState::Idle | LoopState::Engaged);
        let has_simulated_hand = self.live.rig.has_simulated_hand();
        let why = if !has_simulated_hand {
            Some(text::commands::SIMULATED_HAND_ONLY.get())
        } else if !view.is_seen {
            Some(text::commands::FIELD_IS_HIDDEN.get())
        } else if !runs {
            Some(text::commands::NOT_NOW.get())
        } else {
            (!matches!(action, Action::Drive | Action::BeginTrial) && !view.is_led())
                .then_some(text::commands::DRIVE_FIRST.get())
        };
        let is_here = match self.shown {
            ShownPage::OfExtra => self.in_trial(),
            ShownPage::Monitor => self.role() != Role::Surgeon || view.is_seen && has_simulated_hand,
            _ => false,
        };
        Availability::unless(why).only_if(is_offered && is_here)
    }

    /// Returns the panels of the views on the screen: of the machine, or of the recorded session.
    fn panels_in_view(&self) -> Option<&Panels> {
        match &self.shown {
            ShownPage::Past(past) if past.beside.is_none() && !past.is_choosing && !past.is_foreign() => {
                Some(&past.panels)
            }
            ShownPage::Monitor => Some(&self.panels),
            _ => None,
        }
    }

    fn shows_image_plain(&self) -> bool {
        let image = self.settings.now.image;
        image == ImageSettings { forces_of_now: image.forces_of_now, ..ImageSettings::default() }
    }
}
