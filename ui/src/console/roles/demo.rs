//! The demonstration: a script that shows the modes at a long and a short delay, explains them, and invites the
//! audience to try. Only for simulated and emulated rigs; afterwards mode and delay are restored.

use egui::{Button, CentralPanel, Frame, Label, Margin, Panel, RichText, Ui, vec2};
use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::messages::{Command, LoopState, Tick};

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
use crate::language::Text;

/// With less width than this the chapters need two rows.
const ONE_ROW: f32 = 1270.0;
/// With less height than this the force-space plot is left out.
const LEAST_SPACE: f32 = 190.0;

/// The hand lets go when it presses at least so hard, N, and takes the handle again after this time, s.
const LET_GO_N: f64 = 1.5;
const OPEN_S: f64 = 2.5;
/// Then it works on for this time, s, before it lets go once more.
const CLOSED_S: f64 = 2.5;

/// One step of the script.
#[derive(Debug)]
pub struct Step {
    /// Name on its button.
    pub name: Text,
    /// What can be seen, and why.
    pub words: Text,
    /// Rendering mode.
    pub mode: Mode,
    /// Delay of the link, s.
    pub delay_s: f64,
    /// Whether the hand lets go while it presses, and if so, with the governor or without.
    pub lets_go: Option<Governor>,
    /// Duration, s.
    pub seconds: f64,
}

/// What the governor does while the hand lets go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Governor {
    /// It watches, as ever.
    Watches,
    /// It is left out, to show what it is for.
    LeftOut,
}

/// The script.
pub const SCRIPT: [Step; 9] = [
    Step {
        name: text::roles::DEMO_START,
        words: text::roles::DEMO_START_CAPTION,
        mode: Mode::Best,
        delay_s: 0.05,
        lets_go: None,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_DIRECT,
        words: text::roles::DEMO_DIRECT_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        lets_go: None,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_LINEAR,
        words: text::roles::DEMO_LINEAR_CAPTION,
        mode: Mode::Linear,
        delay_s: 0.3,
        lets_go: None,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_LITERAL,
        words: text::roles::DEMO_LITERAL_CAPTION,
        mode: Mode::Literal,
        delay_s: 0.3,
        lets_go: None,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_ANCHORED,
        words: text::roles::DEMO_ANCHORED_CAPTION,
        mode: Mode::Anchored,
        delay_s: 0.3,
        lets_go: None,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_MATCHED,
        words: text::roles::DEMO_MATCHED_CAPTION,
        mode: Mode::Matched,
        delay_s: 0.3,
        lets_go: None,
        seconds: 14.0,
    },
    Step {
        name: text::roles::DEMO_LET_GO,
        words: text::roles::DEMO_LET_GO_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        lets_go: Some(Governor::LeftOut),
        seconds: 16.0,
    },
    Step {
        name: text::roles::DEMO_GOVERNOR,
        words: text::roles::DEMO_GOVERNOR_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        lets_go: Some(Governor::Watches),
        seconds: 16.0,
    },
    Step {
        name: text::roles::DEMO_YOUR_TURN,
        words: text::roles::DEMO_YOUR_TURN_CAPTION,
        mode: Mode::Best,
        delay_s: 0.05,
        lets_go: None,
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
    before: Option<Before>,
    letting_go: LettingGo,
}

/// What was set before the demonstration.
#[derive(Clone, Copy, Debug)]
struct Before {
    mode: Mode,
    delay_s: f64,
    compares: bool,
    static_hold: bool,
}

/// A hand that lets go again and again.
#[derive(Clone, Copy, Debug, Default)]
struct LettingGo {
    /// Where the handle was when the hand opened, m; `None` while it is closed.
    from_m: Option<Vector3<f64>>,
    /// When it opened or closed, s on the loop's clock.
    since_s: Option<f64>,
    /// The governor found nobody at the handle and ended the engagement.
    gone: bool,
    /// How far the handle went the last time, m.
    travel_m: Option<f64>,
}

impl LettingGo {
    /// Opens the hand when it presses, closes it a while later, and engages again if the governor had to end that.
    fn play(&mut self, tick: &Tick, outbox: &mut Outbox) {
        let for_s = tick.t_s - *self.since_s.get_or_insert(tick.t_s);
        let Some(from_m) = self.from_m else {
            let presses = tick.state == LoopState::Engaged && tick.rendered_n.z > LET_GO_N;
            if presses && for_s > CLOSED_S {
                *self = Self {
                    from_m: Some(tick.leader_m),
                    since_s: Some(tick.t_s),
                    travel_m: Some(0.0),
                    ..Self::default()
                };
                outbox.push(Command::LetGo(true));
            }
            return;
        };
        if tick.state == LoopState::Engaged {
            // Behind the end of the engagement the hand's place is not on the same scale.
            self.travel_m = self.travel_m.map(|most_m| most_m.max((tick.leader_m - from_m).norm()));
        }
        self.gone |= tick.state == LoopState::Idle;
        if for_s > OPEN_S {
            self.close(outbox);
        }
    }

    fn close(&mut self, outbox: &mut Outbox) {
        if self.from_m.is_some() {
            outbox.push(Command::LetGo(false));
            if self.gone {
                outbox.push(Command::Engage);
            }
        }
        *self = Self { travel_m: self.travel_m, ..Self::default() };
    }
}

impl DemoState {
    /// Restores what was set before.
    pub fn leave(&mut self, outbox: &mut Outbox) {
        self.told = None;
        self.letting_go.close(outbox);
        if let Some(Before { mode, delay_s, compares, static_hold }) = self.before.take() {
            outbox.push(Command::SetGovernor(true));
            outbox.push(Command::SetStaticHold(static_hold));
            outbox.push(Command::SetMode(mode));
            outbox.push(Command::SetDelay(delay_s));
            outbox.push(Command::Compare(compares));
        }
    }

    /// Advances by `dt_s`; paused while a visitor leads the instrument, by the pause button, or while the loop does not
    /// run.
    fn play(&mut self, live: &Live, leading: bool, dt_s: f64, outbox: &mut Outbox) {
        let Some(tick) = live.first_tick() else { return };
        // An engagement that the governor ended for the open hand is part of the show.
        if live.state() != LoopState::Engaged && self.letting_go.from_m.is_none() {
            return;
        }
        let before = *self.before.get_or_insert_with(|| {
            outbox.push(Command::Compare(true));
            let static_hold = live.gate_settings().static_hold;
            Before { mode: live.mode(), delay_s: live.delay_s(), compares: live.compares(), static_hold }
        });
        if !self.held && !leading {
            self.shown_s += dt_s;
        }
        if SCRIPT[self.step].lets_go.is_some() && !leading {
            self.letting_go.play(tick, outbox);
        }
        if self.shown_s >= SCRIPT[self.step].seconds {
            let following = (1..=SCRIPT.len()).map(|ahead| (self.step + ahead) % SCRIPT.len());
            let possible = following.into_iter().find(|step| may_show(live, &SCRIPT[*step]));
            self.go_to(possible.unwrap_or_default());
        }
        if self.told != Some(self.step) {
            let Step { mode, delay_s, lets_go, .. } = SCRIPT[self.step];
            self.letting_go.close(outbox);
            self.letting_go = LettingGo::default();
            // The chapter before left the governor out, or the next one must find it.
            if may_let_go(live) {
                outbox.push(Command::SetGovernor(lets_go != Some(Governor::LeftOut)));
            }
            // A force that fades at standstill would leave nothing to let go.
            outbox.push(Command::SetStaticHold(lets_go.is_some() || before.static_hold));
            outbox.push(Command::SetMode(mode));
            outbox.push(Command::SetDelay(delay_s));
            self.told = Some(self.step);
        }
    }

    const fn go_to(&mut self, step: usize) {
        self.step = step;
        self.shown_s = 0.0;
    }
}

/// Whether the rig is simulated or emulated, so that nobody can be hurt.
fn may_play(live: &Live) -> bool {
    live.rig.is_harmless()
}

/// Whether the hand is simulated, so that it may let go.
fn may_let_go(live: &Live) -> bool {
    live.rig.has_simulated_hand()
}

fn may_show(live: &Live, step: &Step) -> bool {
    may_play(live) && (step.lets_go.is_none() || may_let_go(live))
}

/// Draws the view.
pub(super) fn demo_ui(ui: &mut Ui, live: &mut Live, panels: &mut Panels, outbox: &mut Outbox) {
    if may_play(live) && !live.is_shown_only() {
        let dt_s = f64::from(ui.input(|input| input.stable_dt)).min(0.1);
        panels.demo.play(live, panels.scene.is_led(), dt_s, outbox);
    }
    let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
    let height = if ui.available_width() < ONE_ROW { 176.0 } else { 140.0 };
    // The script is not what happened in the past.
    if !live.is_shown_only() {
        let frame = side.inner_margin(Margin::symmetric(18, 12));
        let caption = Panel::bottom("caption").exact_size(height).resizable(false).frame(frame);
        caption.show(ui, |ui| caption_ui(ui, live, &mut panels.demo));
    }
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
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
        for (i, step) in SCRIPT.iter().enumerate() {
            let name = format!("{}. {}", i + 1, step.name);
            let button = Button::selectable(demo.step == i, name).frame_when_inactive(true).min_size(vec2(0.0, 30.0));
            if ui.add_enabled(may_show(live, step), button).on_hover_text(step.words.get()).clicked() {
                demo.go_to(i);
            }
        }
        ui.add_space(10.0);
        let (name, meaning) = if demo.held {
            (text::roles::PLAY.get(), text::roles::PLAY_HOVER.get())
        } else {
            (text::roles::HOLD.get(), text::roles::HOLD_HOVER.get())
        };
        if ui.add_enabled(plays, Button::new(name).min_size(vec2(64.0, 30.0))).on_hover_text(meaning).clicked() {
            demo.held = !demo.held;
        }
    });
    ui.add_space(4.0);
    let words = match live.state() {
        _ if !plays => text::roles::NOTE_REAL_RIG.get(),
        LoopState::Engaged => SCRIPT[demo.step].words.get(),
        LoopState::Idle if demo.letting_go.from_m.is_some() => SCRIPT[demo.step].words.get(),
        LoopState::Idle => text::roles::NOTE_IDLE.get(),
        LoopState::Stopped | LoopState::Faulted(_) => text::roles::NOTE_STOPPED.get(),
        LoopState::Ready | LoopState::Clutched | LoopState::Disconnected => text::roles::NOTE_NOT_ENGAGED.get(),
    };
    let went = demo.letting_go.travel_m.filter(|_| plays).map(|travel_m| text::roles::handle_went(1e3 * travel_m));
    let words = went.map_or_else(|| words.to_owned(), |went| format!("{words} {went}"));
    ui.add(Label::new(RichText::new(words).font(theme::regular(18.0))).wrap());
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 4.0), egui::Sense::hover());
    if plays && live.state() == LoopState::Engaged {
        bar(ui.painter(), rect, demo.shown_s / SCRIPT[demo.step].seconds, theme::now().reference);
    }
    if !plays {
        ui.label(small(text::roles::NOTE_CHOOSE_SIMULATED.get()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::{self, Language};

    #[test]
    fn every_chapter_is_long_enough_to_be_read() {
        for step in &SCRIPT {
            for language in Language::CHOICES {
                let words = language::with(language, || step.words.get().split_whitespace().count() as f64);
                assert!(step.seconds >= words / 4.0, "{}: {words} words in {} s", step.name, step.seconds);
            }
        }
    }

    #[test]
    fn the_modes_of_the_paper_and_ours_are_all_shown() {
        for mode in [Mode::Literal, Mode::Linear, Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Best] {
            assert!(SCRIPT.iter().any(|step| step.mode == mode), "{mode}");
        }
    }
}
