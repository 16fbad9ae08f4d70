//! The line to the machine with the arm: whether messages pass, who holds the follower, and what the network takes.

use egui::{Button, RichText, Ui, vec2};
use nima_network::endpoint::Control;

use crate::{
    console::{
        alarms::sentence,
        live::Live,
        text, theme,
        widgets::{figure, small, weak},
    },
    line::{LineDoor, LineReport, LineWish},
    words::{link_rows, link_trouble},
};

/// The panel. It sends wishes to the line; who holds a follower is not the loop's matter.
pub fn link_ui(ui: &mut Ui, live: &Live) {
    let Some(door) = &live.line_door else {
        ui.label(text::link::ONE_MACHINE.get());
        ui.add_space(4.0);
        ui.label(weak(text::link::HOW_TWO.get()));
        return;
    };
    let Some(report) = &live.line else {
        ui.label(text::link::NOTHING_YET.get());
        return;
    };
    if let Some([cause, cure]) = link_trouble(report.state) {
        ui.label(RichText::new(sentence(&cause)).font(theme::strong(14.0)));
        ui.label(small(sentence(&cure)));
        ui.add_space(4.0);
    }
    control_ui(ui, report, live.state().permits().drives, door);
    ui.add_space(4.0);
    for row in link_rows(report) {
        figure(ui, row.name, row.value, row.meaning);
    }
}

/// Who holds the follower, and the buttons with which it changes hands.
fn control_ui(ui: &mut Ui, report: &LineReport, drives: bool, door: &LineDoor) {
    let words = match report.control {
        Control::None => return,
        Control::Holds => text::link::HOLDS.get(),
        Control::HoldsAsked => text::link::ASKED.get(),
        Control::Waits => text::link::WAITS.get(),
        Control::Asks => text::link::ASKS.get(),
        Control::Denied => text::link::DENIED.get(),
    };
    ui.label(words).on_hover_text(text::link::CONTROL_HOVER.get());
    let size = vec2(ui.available_width(), 28.0);
    let button = |ui: &mut Ui, enabled: bool, words: &str, meaning: &str| {
        ui.add_enabled(enabled, Button::new(words).min_size(size))
            .on_hover_text(meaning)
            .on_disabled_hover_text(text::link::GIVE_AT_REST.get())
            .clicked()
    };
    match report.control {
        Control::HoldsAsked => {
            // The arm must not change hands while it is driven: it would stop in a fault.
            if button(ui, !drives, text::link::GIVE.get(), text::link::GIVE_HOVER.get()) {
                door.wish(LineWish::Answer { consents: true });
            }
            if drives {
                ui.label(small(text::link::GIVE_AT_REST.get()));
            }
            if button(ui, true, text::link::KEEP.get(), text::link::KEEP_HOVER.get()) {
                door.wish(LineWish::Answer { consents: false });
            }
        }
        Control::Waits | Control::Denied => {
            if button(ui, true, text::link::ASK.get(), text::link::ASK_HOVER.get()) {
                door.wish(LineWish::Control);
            }
        }
        Control::Asks => {
            if button(ui, true, text::link::WITHDRAW.get(), text::link::WITHDRAW_HOVER.get()) {
                door.wish(LineWish::Nothing);
            }
        }
        Control::None | Control::Holds => {}
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;
    use std::time::{Duration, Instant};

    use egui_kittest::{Harness, kittest::Queryable as _};
    use nima_machine::{config::RigConfig, remote::Wire as _, rig::Ends};
    use nima_network::{
        endpoint::{Config, Endpoint, Role},
        keys::{Keys, Peers},
    };
    use nima_world::scene::Scene;

    use super::*;
    use crate::line::Line;

    /// A follower and two consoles over loopback.
    struct Three {
        _folder: tempfile::TempDir,
        ends: [Line; 3],
        /// How many of them run: who comes first holds the follower.
        running: usize,
        begun: Instant,
    }

    impl Three {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let keys = |name: &str| {
                let own = folder.path().join(name);
                std::fs::create_dir_all(&own).unwrap();
                Keys::open(&own).unwrap()
            };
            let (follower, first, second) = (keys("follower"), keys("first"), keys("second"));
            let mut consoles = Peers::open(&folder.path().join("follower")).unwrap();
            consoles.add("first", first.public()).unwrap();
            consoles.add("second", second.public()).unwrap();
            let key = follower.public();
            let role = Role::Follower { at: Some((Ipv4Addr::LOCALHOST, 0).into()), consoles };
            let follower = Endpoint::open(Config::new(role, follower)).unwrap();
            let at = follower.address().unwrap();
            let console = |keys| {
                let role = Role::Console { follower: at, key };
                Line::new(Endpoint::open(Config::new(role, keys)).unwrap(), Ends::Leader)
            };
            let ends = [Line::new(follower, Ends::Follower), console(first), console(second)];
            Self { _folder: folder, ends, running: 2, begun: Instant::now() }
        }

        /// Drives those that run until this console's report is as wanted, and shows it in the panel.
        fn until(&mut self, console: usize, window: &mut Harness<'_, Live>, control: Control) {
            let doors = self.ends.each_ref().map(Line::door);
            while window.state().line.is_none_or(|report| report.control != control) {
                assert!(self.begun.elapsed() < Duration::from_mins(1), "never {control:?}: {:?}", window.state().line);
                let now_s = self.begun.elapsed().as_secs_f64();
                for end in &mut self.ends[..self.running] {
                    end.receive(now_s, &mut |_| {});
                    end.send(now_s, b"payload");
                }
                if let Some(report) = doors[console].newest() {
                    window.state_mut().line = Some(report);
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            window.run_steps(2);
        }

        fn panel(&self, console: usize) -> Harness<'static, Live> {
            let mut live = Live::new(RigConfig::load("simulated").unwrap(), Scene::load("peg_transfer").unwrap());
            live.line_door = Some(self.ends[console].door());
            shown(live)
        }
    }

    fn shown(live: Live) -> Harness<'static, Live> {
        let panel = |ui: &mut Ui, live: &mut Live| {
            theme::apply(ui.ctx());
            link_ui(ui, live);
        };
        Harness::builder().with_size([330.0, 600.0]).build_ui_state(panel, live)
    }

    #[test]
    fn control_changes_hands_by_a_question_and_consent() {
        let mut three = Three::new();
        let (mut first, mut second) = (three.panel(1), three.panel(2));
        three.until(1, &mut first, Control::Holds);
        three.running = 3;
        three.until(2, &mut second, Control::Waits);
        second.get_by_label(text::link::ASK.get()).click();
        second.run_steps(2);
        three.until(2, &mut second, Control::Asks);
        three.until(1, &mut first, Control::HoldsAsked);
        first.get_by_label(text::link::KEEP.get()).click();
        first.run_steps(2);
        three.until(2, &mut second, Control::Denied);
        three.until(1, &mut first, Control::Holds);
        second.get_by_label(text::link::ASK.get()).click();
        second.run_steps(2);
        three.until(1, &mut first, Control::HoldsAsked);
        first.get_by_label(text::link::GIVE.get()).click();
        first.run_steps(2);
        three.until(2, &mut second, Control::Holds);
        three.until(1, &mut first, Control::Waits);
        first.get_by_label_contains("nother console holds the follower");
    }

    #[test]
    fn without_another_machine_the_panel_says_how_there_can_be_one() {
        let live = Live::new(RigConfig::load("simulated").unwrap(), Scene::load("peg_transfer").unwrap());
        let window = shown(live);
        window.get_by_label(text::link::ONE_MACHINE.get());
    }
}
