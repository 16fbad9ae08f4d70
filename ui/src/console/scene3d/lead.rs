//! Leads the instrument with mouse and keyboard, for demonstrations without a haptic device.
//!
//! The window sends positions (m, workspace). The simulated hand moves there and yields to the rendered force. Leading
//! ends when the loop stops.

use egui::{Button, Key, Rect, Response, RichText, Ui, vec2};
use nalgebra::Vector3;
use nima_machine::{
    messages::{Command, LoopState},
    rig::Act,
};

use super::{Camera, Live, Outbox};
use crate::console::{text, theme};

/// Motion per press of an arrow key, m.
const STEP_M: f32 = 0.001;
/// How far the key opens the jaws, rad.
const OPEN_RAD: f64 = 0.6;
/// Change of height per point of the wheel, m.
const WHEEL_M: f32 = 0.0001;
/// Space in which the instrument may be led: half width, half depth, lowest and highest, m.
const SIDE_M: f32 = 0.055;
const HEIGHT_M: std::ops::RangeInclusive<f32> = -0.02..=0.06;

/// Whether the instrument is led, and to which position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lead {
    at_m: Option<Vector3<f32>>,
    /// The jaws are held open; not known before the first press of the key.
    open: Option<bool>,
    /// It is led all the time and cannot be let go: the hand of a study's participant.
    pub(super) is_held: bool,
}

impl Lead {
    /// Whether the instrument is led.
    pub(super) const fn is_on(self) -> bool {
        self.at_m.is_some()
    }

    /// Ends the leading.
    pub(super) fn let_go(&mut self, outbox: &mut Outbox) {
        if self.at_m.take().is_some() {
            outbox.push(Command::Guide(None));
        }
        self.leave_jaws(outbox);
    }

    fn leave_jaws(&mut self, outbox: &mut Outbox) {
        if self.open.take().is_some() {
            outbox.push(Command::Grip(None));
        }
    }

    /// Opens and closes the jaws by a key.
    fn jaws(&mut self, ui: &Ui, live: &Live, outbox: &mut Outbox) {
        let pressed = !ui.ctx().text_edit_focused() && ui.input(|input| input.key_pressed(Key::G));
        if pressed && live.scene.objects.is_some() {
            let open = !self.open.unwrap_or(false);
            self.open = Some(open);
            outbox.push(Command::Grip(Some(if open { OPEN_RAD } else { 0.0 })));
        }
    }

    /// What else is done in a training task, by keys.
    fn acts(&self, ui: &Ui, live: &Live, outbox: &mut Outbox) {
        if ui.ctx().text_edit_focused() {
            return;
        }
        let pressed = |key: Key| ui.input(|input| input.modifiers.is_none() && input.key_pressed(key));
        let (is_searched, on_wire) = (live.scene.is_searched(), live.scene.wire.is_some());
        for (key, act, has) in [
            (Key::X, Act::Mark, is_searched),
            (Key::D, Act::End, is_searched),
            (Key::N, Act::Begin, (is_searched || on_wire) && !self.is_held),
        ] {
            if has && pressed(key) {
                outbox.push(Command::Task(act));
            }
        }
    }

    /// The switch in the view, and the handling of mouse and keys while it is on. Returns true while it is on.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        view: &Response,
        live: &Live,
        camera: &Camera,
        outbox: &mut Outbox,
    ) -> bool {
        let runs = matches!(live.state(), LoopState::Idle | LoopState::Engaged) && !live.is_shown_only();
        if self.is_on() && !runs {
            // The loop has ended the leading already.
            (self.at_m, self.open) = (None, None);
        }
        let place = Rect::from_min_size(rect.right_bottom() - vec2(250.0, 46.0), vec2(150.0, 34.0));
        let text = if self.is_on() { text::field::LEAD_END } else { text::field::LEAD };
        let button =
            Button::selectable(self.is_on(), RichText::new(text).font(theme::strong(14.0))).frame_when_inactive(true);
        let asked = if self.is_held {
            !self.is_on() && live.first_tick().is_some()
        } else {
            let clicked = ui.add_enabled_ui(runs, |ui| ui.put(rect.intersect(place), button).clicked()).inner;
            clicked || !ui.ctx().text_edit_focused() && ui.input(|input| input.key_pressed(Key::M))
        };
        if runs && asked {
            self.at_m = match self.at_m {
                Some(_) => None,
                None => live.first_tick().map(|tick| tick.leader_m.cast()),
            };
            outbox.push(Command::Guide(self.at_m.map(Vector3::cast)));
            if self.at_m.is_none() {
                self.leave_jaws(outbox);
            } else if self.is_held && live.scene.objects.is_some() {
                // A simulated hand must not move the jaws of a participant.
                self.open = Some(true);
                outbox.push(Command::Grip(Some(OPEN_RAD)));
            }
        }
        if self.at_m.is_some() {
            self.jaws(ui, live, outbox);
            self.acts(ui, live, outbox);
        }
        let Some(at_m) = &mut self.at_m else { return false };
        let before_m = *at_m;
        if view.dragged() {
            let drag = view.drag_delta() * camera.metres_per_point(rect.height());
            *at_m += camera.right() * drag.x - camera.away() * drag.y;
        }
        *at_m += keys_m(ui, camera);
        if view.contains_pointer() {
            at_m.z += WHEEL_M * ui.input(|input| input.smooth_scroll_delta().y);
        }
        *at_m = Vector3::new(
            at_m.x.clamp(-SIDE_M, SIDE_M),
            at_m.y.clamp(-SIDE_M, SIDE_M),
            at_m.z.clamp(*HEIGHT_M.start(), *HEIGHT_M.end()),
        );
        if *at_m != before_m {
            outbox.push(Command::Guide(Some(at_m.cast())));
        }
        true
    }
}

/// Small steps by keys, in the axes of the screen.
fn keys_m(ui: &Ui, camera: &Camera) -> Vector3<f32> {
    if ui.ctx().text_edit_focused() {
        return Vector3::zeros();
    }
    let ways = [
        (Key::ArrowLeft, -camera.right()),
        (Key::ArrowRight, camera.right()),
        (Key::ArrowUp, camera.away()),
        (Key::ArrowDown, -camera.away()),
        (Key::PageUp, Vector3::z()),
        (Key::PageDown, -Vector3::z()),
    ];
    ui.input(|input| ways.iter().filter(|(key, _)| input.key_pressed(*key)).map(|(_, way)| way * STEP_M).sum())
}
