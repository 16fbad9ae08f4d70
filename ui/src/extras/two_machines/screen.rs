//! The Link panel: whether messages pass, which console controls the follower, and the network statistics.

use egui::{Button, RichText, Ui, vec2};
use nima_network::endpoint::ControlRole;
use nima_screen::{
    theme,
    widgets::{figure, small},
};
use nima_words::report_text::sentence;

use super::{
    line::{LineReport, LineWish, NetworkDoor},
    link_text::{link_rows, link_trouble},
    text,
};

/// Draws the state of a link. It sends requests to the link; control of a follower does not concern the loop.
pub(super) fn link_ui(ui: &mut Ui, door: &NetworkDoor, drives: bool) {
    let Some(report) = door.newest() else {
        ui.label(text::NOTHING_YET);
        return;
    };
    if let Some([cause, cure]) = link_trouble(report.state) {
        ui.label(RichText::new(sentence(&cause)).font(theme::strong(14.0)));
        ui.label(small(sentence(&cure)));
        ui.add_space(4.0);
    }
    control_ui(ui, report, drives, door);
    ui.add_space(4.0);
    for row in link_rows(report) {
        figure(ui, row.name, row.value, row.meaning);
    }
}

/// Draws the console in control of the follower, and the buttons that transfer control.
fn control_ui(ui: &mut Ui, report: &LineReport, drives: bool, door: &NetworkDoor) {
    let words = match report.control {
        ControlRole::None => return,
        ControlRole::Holds => text::HOLDS.get(),
        ControlRole::HoldsAsked => text::ASKED.get(),
        ControlRole::Waits => text::WAITS.get(),
        ControlRole::Asks => text::ASKS.get(),
        ControlRole::Denied => text::DENIED.get(),
    };
    ui.label(words).on_hover_text(text::CONTROL_HOVER);
    let size = vec2(ui.available_width(), 28.0);
    let button = |ui: &mut Ui, enabled: bool, words: &str, meaning: &str| {
        ui.add_enabled(enabled, Button::new(words).min_size(size))
            .on_hover_text(meaning)
            .on_disabled_hover_text(text::GIVE_AT_REST)
            .clicked()
    };
    match report.control {
        ControlRole::HoldsAsked => {
            // Control must not change while the arm is driven: the arm would stop in a fault.
            if button(ui, !drives, text::GIVE.get(), text::GIVE_HOVER.get()) {
                door.wish(LineWish::Answer { consents: true });
            }
            if drives {
                ui.label(small(text::GIVE_AT_REST));
            }
            if button(ui, true, text::KEEP.get(), text::KEEP_HOVER.get()) {
                door.wish(LineWish::Answer { consents: false });
            }
        }
        ControlRole::Waits | ControlRole::Denied => {
            if button(ui, true, text::ASK.get(), text::ASK_HOVER.get()) {
                door.wish(LineWish::Control);
            }
        }
        ControlRole::Asks => {
            if button(ui, true, text::WITHDRAW.get(), text::WITHDRAW_HOVER.get()) {
                door.wish(LineWish::Nothing);
            }
        }
        ControlRole::None | ControlRole::Holds => {}
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;
    use std::time::{Duration, Instant};

    use egui_kittest::{Harness, kittest::Queryable as _};
    use nima_machine::{remote::RemoteWire as _, rig::RigEnds};
    use nima_network::{
        endpoint::{Endpoint, EndpointConfig, EndpointRole},
        keys::{NetworkKeys, Peers},
    };

    use super::*;
    use crate::extras::two_machines::line::NetworkLine;
    use nima_screen::link::LineConnection as _;

    /// A follower and two consoles over loopback.
    struct Three {
        _folder: tempfile::TempDir,
        ends: [NetworkLine; 3],
        /// Number of running consoles: the first one controls the follower.
        running: usize,
        begun: Instant,
    }

    impl Three {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let keys = |name: &str| {
                let own = folder.path().join(name);
                std::fs::create_dir_all(&own).unwrap();
                NetworkKeys::open(&own).unwrap()
            };
            let follower = keys("follower");
            let first = keys("first");
            let second = keys("second");
            let mut consoles = Peers::open(&folder.path().join("follower")).unwrap();
            consoles.add("first", first.public()).unwrap();
            consoles.add("second", second.public()).unwrap();
            let key = follower.public();
            let role = EndpointRole::Follower { at: Some((Ipv4Addr::LOCALHOST, 0).into()), consoles };
            let follower = Endpoint::open(EndpointConfig::new(role, follower)).unwrap();
            let at = follower.address().unwrap();
            let console = |keys| {
                let role = EndpointRole::Console { follower: at, key };
                NetworkLine::new(Endpoint::open(EndpointConfig::new(role, keys)).unwrap(), RigEnds::Leader)
            };
            let ends = [NetworkLine::new(follower, RigEnds::Follower), console(first), console(second)];
            Self { _folder: folder, ends, running: 2, begun: Instant::now() }
        }

        /// Drives the running consoles until this console's report matches, and shows it in the panel.
        fn until(&mut self, window: &mut Harness<'_, NetworkDoor>, control: ControlRole) {
            while window.state().newest().is_none_or(|report| report.control != control) {
                assert!(self.begun.elapsed() < Duration::from_mins(1), "never {control:?}: {:?}", window.state());
                let now_s = self.begun.elapsed().as_secs_f64();
                for end in &mut self.ends[..self.running] {
                    end.receive(now_s, &mut |_| {});
                    end.send(now_s, b"payload");
                }
                window.state_mut().receive();
                std::thread::sleep(Duration::from_millis(1));
            }
            window.run_steps(2);
        }

        fn panel(&self, console: usize) -> Harness<'static, NetworkDoor> {
            let panel = |ui: &mut Ui, door: &mut NetworkDoor| {
                theme::apply(ui.ctx());
                link_ui(ui, door, false);
            };
            let door = self.ends[console].network_door();
            Harness::builder().with_size([330.0, 600.0]).build_ui_state(panel, door)
        }
    }

    #[test]
    fn control_changes_hands_by_a_question_and_consent() {
        let mut three = Three::new();
        let mut first = three.panel(1);
        let mut second = three.panel(2);
        three.until(&mut first, ControlRole::Holds);
        three.running = 3;
        three.until(&mut second, ControlRole::Waits);
        second.get_by_label(text::ASK.get()).click();
        second.run_steps(2);
        three.until(&mut second, ControlRole::Asks);
        three.until(&mut first, ControlRole::HoldsAsked);
        first.get_by_label(text::KEEP.get()).click();
        first.run_steps(2);
        three.until(&mut second, ControlRole::Denied);
        three.until(&mut first, ControlRole::Holds);
        second.get_by_label(text::ASK.get()).click();
        second.run_steps(2);
        three.until(&mut first, ControlRole::HoldsAsked);
        first.get_by_label(text::GIVE.get()).click();
        first.run_steps(2);
        three.until(&mut second, ControlRole::Holds);
        three.until(&mut first, ControlRole::Waits);
        first.get_by_label_contains("nother console controls the follower");
    }
}
