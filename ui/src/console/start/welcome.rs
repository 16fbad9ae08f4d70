//! The page for newcomers: purpose, restrictions, and three ways to continue. The running rig is visible around it.

use egui::{Align2, Button, Context, Label, Rect, RichText, Window, vec2};
use nima_screen::{
    theme,
    widgets::{next_button, small},
};
use nima_words::text::start as words;

/// Ways to continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::console) enum WelcomeChoice {
    Demo,
    /// The running rig.
    Simulated,
    Own,
}

/// Closed until it is opened.
#[derive(Debug, Default)]
pub(in crate::console) struct Welcome {
    is_open: bool,
}

impl Welcome {
    pub(in crate::console) const fn open(&mut self) {
        self.is_open = true;
    }

    pub(in crate::console) const fn is_open(&self) -> bool {
        self.is_open
    }

    pub(in crate::console) const fn close(&mut self) {
        self.is_open = false;
    }

    /// Draws it into `room`, which does not cover the stop button; returns the chosen way and closes.
    pub(in crate::console) fn ui(&mut self, ctx: &Context, room: Rect) -> Option<WelcomeChoice> {
        if !self.is_open {
            return None;
        }
        let mut chosen = None;
        let window = Window::new(words::WELCOME_WINDOW.get()).title_bar(false).resizable(false).movable(false);
        let window = window.constrain_to(room).anchor(Align2::CENTER_TOP, vec2(0.0, room.top() + 12.0));
        window.fixed_size(vec2(460.0, 0.0)).show(ctx, |ui| {
            ui.label(RichText::new(words::WELCOME).font(theme::strong(18.0)));
            ui.add(Label::new(RichText::new(words::WELCOME_WHAT).font(theme::regular(15.0))).wrap());
            ui.add(Label::new(RichText::new(words::WELCOME_NOT).font(theme::strong(15.0))).wrap());
            ui.add_space(6.0);
            for (way, name, about) in [
                (WelcomeChoice::Simulated, words::WELCOME_SIMULATED.get(), words::WELCOME_SIMULATED_ABOUT.get()),
                (WelcomeChoice::Demo, words::WELCOME_DEMO.get(), words::WELCOME_DEMO_ABOUT.get()),
                (WelcomeChoice::Own, words::WELCOME_OWN.get(), words::WELCOME_OWN_ABOUT.get()),
            ] {
                let button = if way == WelcomeChoice::Simulated { next_button(name, true) } else { Button::new(name) };
                if ui.add(button.min_size(vec2(ui.available_width(), 36.0))).clicked() {
                    chosen = Some(way);
                }
                ui.add(Label::new(small(about)).wrap());
                ui.add_space(4.0);
            }
        });
        self.is_open = chosen.is_none();
        chosen
    }
}
