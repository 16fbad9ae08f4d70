//! The demonstration: a script that shows the modes at a long and a short delay, explains them, and invites the
//! audience to try. Only for simulated and emulated rigs; afterwards mode and delay are restored.

use egui::{Button, CentralPanel, Frame, Label, Margin, Panel, RichText, Ui, vec2};
use nima_core::impedance::Mode;
use nima_machine::messages::{Command, LoopState};

use super::Panels;
use crate::console::{
    desk,
    live::Live,
    outbox::Outbox,
    panels::{force_space_ui, forces_ui, horizon_ui},
    scene3d::scene_ui,
    text, theme,
    widgets::{bar, card, small},
};

/// With less height than this the force-space plot is left out.
const LEAST_SPACE: f32 = 190.0;

/// One step of the script.
#[derive(Debug)]
pub struct Step {
    /// Name on its button.
    pub name: &'static str,
    /// What can be seen, and why.
    pub words: &'static str,
    /// Rendering mode.
    pub mode: Mode,
    /// Delay of the link, s.
    pub delay_s: f64,
    /// Duration, s.
    pub seconds: f64,
}

/// The script.
pub const SCRIPT: [Step; 7] = [
    Step {
        name: text::roles::DEMO_START,
        words: text::roles::DEMO_START_CAPTION,
        mode: Mode::Anchored,
        delay_s: 0.05,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_DIRECT,
        words: text::roles::DEMO_DIRECT_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_LINEAR,
        words: text::roles::DEMO_LINEAR_CAPTION,
        mode: Mode::Linear,
        delay_s: 0.3,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_LITERAL,
        words: text::roles::DEMO_LITERAL_CAPTION,
        mode: Mode::Literal,
        delay_s: 0.3,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_ANCHORED,
        words: text::roles::DEMO_ANCHORED_CAPTION,
        mode: Mode::Anchored,
        delay_s: 0.3,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_MATCHED,
        words: text::roles::DEMO_MATCHED_CAPTION,
        mode: Mode::Matched,
        delay_s: 0.3,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_YOUR_TURN,
        words: text::roles::DEMO_YOUR_TURN_CAPTION,
        mode: Mode::Anchored,
        delay_s: 0.05,
        seconds: 20.0,
    },
];

/// State of the script.
#[derive(Clone, Copy, Debug, Default)]
pub struct DemoState {
    step: usize,
    shown_s: f64,
    held: bool,
    /// The last step whose settings were sent to the loop.
    told: Option<usize>,
    /// Mode, delay (s), and whether all modes were compared before the demonstration.
    before: Option<(Mode, f64, bool)>,
}

impl DemoState {
    /// Restores what was set before.
    pub fn leave(&mut self, outbox: &mut Outbox) {
        self.told = None;
        if let Some((mode, delay_s, compares)) = self.before.take() {
            outbox.push(Command::SetMode(mode));
            outbox.push(Command::SetDelay(delay_s));
            outbox.push(Command::Compare(compares));
        }
    }

    /// Advances by `dt_s`; paused while a visitor leads the instrument, by the pause button, or while the loop does not
    /// run.
    fn play(&mut self, live: &Live, leading: bool, dt_s: f64, outbox: &mut Outbox) {
        if live.first_tick().is_none() || live.state() != LoopState::Engaged {
            return;
        }
        if self.before.is_none() {
            self.before = Some((live.mode(), live.delay_s(), live.compares()));
            outbox.push(Command::Compare(true));
        }
        if !self.held && !leading {
            self.shown_s += dt_s;
        }
        if self.shown_s >= SCRIPT[self.step].seconds {
            self.go_to((self.step + 1) % SCRIPT.len());
        }
        if self.told != Some(self.step) {
            self.told = Some(self.step);
            outbox.push(Command::SetMode(SCRIPT[self.step].mode));
            outbox.push(Command::SetDelay(SCRIPT[self.step].delay_s));
        }
    }

    const fn go_to(&mut self, step: usize) {
        self.step = step;
        self.shown_s = 0.0;
    }
}

/// Whether the rig is simulated or emulated, so that nobody can be hurt.
fn may_play(live: &Live) -> bool {
    live.rig.devices.as_ref().is_none_or(|devices| devices.emulated)
}

/// Draws the view.
pub(super) fn demo_ui(ui: &mut Ui, live: &mut Live, panels: &mut Panels, outbox: &mut Outbox) {
    if may_play(live) {
        let dt_s = f64::from(ui.input(|input| input.stable_dt)).min(0.1);
        panels.demo.play(live, panels.scene.is_led(), dt_s, outbox);
    }
    let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
    Panel::bottom("caption")
        .exact_size(140.0)
        .resizable(false)
        .frame(side.inner_margin(Margin::symmetric(18, 12)))
        .show(ui, |ui| {
            caption_ui(ui, live, &mut panels.demo);
        });
    Panel::right("figures").exact_size(348.0).resizable(false).frame(side).show(ui, |ui| {
        let panel = desk::Panel::Horizon;
        card(ui, panel.title(), panel.meaning(), |ui| horizon_ui(ui, live, outbox));
        let Panels { forces, space, .. } = panels;
        let room = vec2(ui.available_width(), ui.available_height().min(380.0));
        if room.y < LEAST_SPACE {
            return;
        }
        ui.allocate_ui(room, |ui| force_space_ui(ui, live, forces.side(), space, forces.cursor_at_s(live)));
    });
    CentralPanel::no_frame().show(ui, |ui| {
        let frame = Frame::new().inner_margin(Margin::symmetric(12, 8));
        Panel::bottom("trace").exact_size(200.0).resizable(false).frame(frame).show(ui, |ui| {
            forces_ui(ui, live, &mut panels.forces, &[2]);
        });
        scene_ui(ui, live, &mut panels.scene, outbox);
    });
}

/// The steps, the present text, and the progress.
fn caption_ui(ui: &mut Ui, live: &Live, demo: &mut DemoState) {
    let plays = may_play(live);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        for (i, step) in SCRIPT.iter().enumerate() {
            let name = format!("{}. {}", i + 1, step.name);
            let button = Button::selectable(demo.step == i, name).frame_when_inactive(true).min_size(vec2(0.0, 30.0));
            if ui.add_enabled(plays, button).on_hover_text(step.words).clicked() {
                demo.go_to(i);
            }
        }
        ui.add_space(10.0);
        let (name, meaning) = if demo.held {
            (text::roles::PLAY, text::roles::PLAY_HOVER)
        } else {
            (text::roles::HOLD, text::roles::HOLD_HOVER)
        };
        if ui.add_enabled(plays, Button::new(name).min_size(vec2(64.0, 30.0))).on_hover_text(meaning).clicked() {
            demo.held = !demo.held;
        }
    });
    ui.add_space(4.0);
    let words = match live.state() {
        _ if !plays => text::roles::NOTE_REAL_RIG,
        LoopState::Engaged => SCRIPT[demo.step].words,
        LoopState::Idle => text::roles::NOTE_IDLE,
        LoopState::Stopped | LoopState::Faulted(_) => text::roles::NOTE_STOPPED,
        LoopState::Ready | LoopState::Clutched | LoopState::Disconnected => text::roles::NOTE_NOT_ENGAGED,
    };
    ui.add(Label::new(RichText::new(words).font(theme::regular(18.0))).wrap());
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 4.0), egui::Sense::hover());
    if plays && live.state() == LoopState::Engaged {
        bar(ui.painter(), rect, demo.shown_s / SCRIPT[demo.step].seconds, theme::now().reference);
    }
    if !plays {
        ui.label(small(text::roles::NOTE_CHOOSE_SIMULATED));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chapter_is_long_enough_to_be_read() {
        for step in &SCRIPT {
            let words = step.words.split_whitespace().count() as f64;
            assert!(step.seconds >= words / 4.0, "{}: {words} words in {} s", step.name, step.seconds);
        }
    }

    #[test]
    fn the_modes_of_the_paper_and_ours_are_all_shown() {
        for mode in [Mode::Literal, Mode::Linear, Mode::Dfr, Mode::Anchored, Mode::Matched] {
            assert!(SCRIPT.iter().any(|step| step.mode == mode), "{mode}");
        }
    }
}
