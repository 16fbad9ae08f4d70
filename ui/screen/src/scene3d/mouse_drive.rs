//! Drives an instrument with mouse and keyboard, for demonstrations and training tasks without a haptic device.
//!
//! The window sends positions (m, workspace). The simulated hand moves there and yields to the rendered force. With two
//! instruments, one is driven and the other one stays where it was left, including its jaws, until a key swaps them. Driving
//! ends when the loop stops.

use egui::{Button, Event, Id, Key, PointerButton, Pos2, Rect, Response, RichText, Ui, UiBuilder, Vec2, vec2};
use nalgebra::Vector3;
use nima_machine::{
    messages::{Command, LoopState},
    rig::{SIDES, Side, TaskAction},
};
use nima_words::text;

use super::{LiveState, Outbox, SceneCamera, training};
use crate::{steady_button::SteadyButton, theme};

/// Motion per press of an arrow key, m.
const STEP_M: f32 = 0.001;
/// Opening angle of the jaws when a key is pressed, rad; jaws closed below this fraction of it hold a ring.
const OPEN_RAD: f64 = 0.6;
const OPEN_FRACTION: f64 = 0.8;
/// Change of height per point of the wheel, m: 4 mm per notch.
const WHEEL_M: f32 = 0.00005;
/// Space in which the instrument may be driven: half width, half depth, lowest and highest, m.
const SIDE_M: f32 = 0.055;
const HEIGHT_M: std::ops::RangeInclusive<f32> = -0.02..=0.095;
/// Maximum depth into a board, m: the simulated hand then presses on it with 2 N.
const INTO_BOARD_M: f32 = 0.002;

/// The driven instrument, and its target position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MouseDrive {
    /// Target position of each instrument, m; `None` without mouse control.
    position_m: [Option<Vector3<f32>>; SIDES],
    /// The instrument that mouse and keys move.
    side: Side,
    /// The jaws are held open; unknown before the first press of the key.
    open: [Option<bool>; SIDES],
    /// Last pointer position while it drags the instrument.
    drag: Option<Pos2>,
    /// Minimum height, m.
    lowest_m: f32,
    /// Always driven, without an end: the hand of a study's participant.
    pub(super) is_held: bool,
    /// The trial was restarted in this frame.
    begins: bool,
}

impl MouseDrive {
    /// Returns whether an instrument is driven.
    pub(super) fn is_on(self) -> bool {
        self.position_m.iter().any(Option::is_some)
    }

    pub(super) fn side(self) -> Option<Side> {
        self.is_on().then_some(self.side)
    }

    /// Returns the instrument whose tip is marked, even before the first tick of a participant's trial.
    pub(super) fn marked(self) -> Option<Side> {
        (self.is_on() || self.is_held).then_some(self.side)
    }

    /// Returns whether the trial was restarted since the last call.
    pub(super) const fn takes_begin(&mut self) -> bool {
        std::mem::replace(&mut self.begins, false)
    }

    /// Ends mouse control.
    pub(super) fn let_go(&mut self, outbox: &mut Outbox) {
        for side in Side::ALL {
            if self.position_m[side.index()].is_some() {
                outbox.push(Command::Guide(side, None));
            }
            if self.open[side.index()].is_some() {
                outbox.push(Command::Grip(side, None));
            }
        }
        self.forget();
    }

    /// The loop has already ended mouse control.
    fn forget(&mut self) {
        *self = Self { side: self.side, is_held: self.is_held, ..Self::default() };
    }

    /// Starts mouse control: every instrument stays where its hand is, and one of them is driven.
    fn take(&mut self, live: &LiveState, outbox: &mut Outbox) {
        let board_m = training::board_of(&live.scene).map(|board| board.z_m as f32 - INTO_BOARD_M);
        self.lowest_m = board_m.unwrap_or(*HEIGHT_M.start());
        for side in live.sides() {
            let position_m = live.tick_of(side).map(|tick| tick.positions.leader_m.cast());
            self.position_m[side.index()] = position_m;
            if let Some(position_m) = position_m {
                outbox.push(Command::Guide(side, Some(position_m.cast())));
            }
        }
        if self.position_m[self.side.index()].is_none() {
            self.side = self.side.other();
        }
    }

    /// Opens the jaws of a participant: the simulated hand must not move them, so they stay open until the participant
    /// closes them.
    fn open_jaws_of_participant(&mut self, live: &LiveState, outbox: &mut Outbox) {
        if !self.is_held || live.scene.objects.is_none() {
            return;
        }
        for side in live.sides() {
            self.open[side.index()] = Some(true);
            outbox.push(Command::Grip(side, Some(OPEN_RAD)));
        }
    }

    /// Drives the other instrument, if there is one.
    fn change_side(&mut self) {
        if self.position_m[self.side.other().index()].is_some() {
            self.side = self.side.other();
            self.drag = None;
        }
    }

    fn jaws(&mut self, live: &LiveState, outbox: &mut Outbox) {
        let i = self.side.index();
        let opening_rad = live.objects.as_ref().and_then(|objects| objects.jaws[i]).map(|jaws| jaws.opening_rad);
        // The simulated hand may have opened the jaws before mouse control started.
        let was_open = self.open[i].unwrap_or_else(|| opening_rad.is_some_and(|rad| rad > OPEN_FRACTION * OPEN_RAD));
        self.open[i] = Some(!was_open);
        outbox.push(Command::Grip(self.side, Some(if was_open { 0.0 } else { OPEN_RAD })));
    }

    /// Draws the switch in the view, and handles mouse and keys while it is on. Returns true while it is on.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        view: &Response,
        live: &LiveState,
        camera: &SceneCamera,
        outbox: &mut Outbox,
    ) -> bool {
        let runs = matches!(live.state(), LoopState::Idle | LoopState::Engaged) && !live.is_shown_only();
        if self.is_on() && !runs {
            // A loop that has stopped guides no hand, so there is nothing to send.
            self.forget();
        }
        let place = Rect::from_min_size(rect.right_bottom() - vec2(250.0, 46.0), vec2(150.0, 34.0));
        let text = if self.is_on() { text::field::LEAD_END.get() } else { text::field::LEAD.get() };
        let is_on = self.is_on();
        let look = |text: String, _: bool| {
            let text = RichText::new(text).font(theme::strong(14.0));
            Button::selectable(is_on, text).frame_when_inactive(true).min_size(place.size())
        };
        let asked = if self.is_held {
            !self.is_on() && live.first_tick().is_some()
        } else {
            let may = if live.is_shown_only() {
                Err(live.of.blocked())
            } else if runs {
                Ok(())
            } else {
                Err(text::commands::NOT_NOW.get())
            };
            let by_key = !ui.ctx().text_edit_focused() && ui.input(|input| input.key_pressed(Key::M));
            let button = SteadyButton { id: Id::unique("drive"), label: text, meaning: "", may, waits_s: 0.0 };
            let room = UiBuilder::new().max_rect(rect.intersect(place));
            ui.scope_builder(room, |ui| button.ui_by_key(ui, by_key, look)).inner
        };
        if runs && asked {
            if self.is_on() {
                self.let_go(outbox);
            } else {
                self.take(live, outbox);
                self.open_jaws_of_participant(live, outbox);
            }
        }
        if self.is_on() {
            self.steer(ui, rect, view, live, camera, outbox);
        }
        self.is_on()
    }

    /// Restarts the trial by its key, whether or not the mouse drives an instrument; a participant of a study cannot.
    pub(super) fn restart_by_key(&mut self, ui: &Ui, live: &LiveState, outbox: &mut Outbox) {
        let runs = matches!(live.state(), LoopState::Idle | LoopState::Engaged);
        if !self.restarts(live) || !runs || ui.ctx().text_edit_focused() {
            return;
        }
        if ui.input(|input| input.modifiers.is_none() && input.key_pressed(Key::N)) {
            self.begins = true;
            outbox.push(Command::Task(self.side, TaskAction::Begin));
        }
    }

    /// Returns whether the scene has a trial that the operator can restart.
    pub(super) fn restarts(self, live: &LiveState) -> bool {
        let scene = &live.scene;
        let has_trial = scene.is_searched() || scene.wire.is_some() || scene.objects.is_some();
        has_trial && !self.is_held && !live.is_shown_only() && live.rig.has_simulated_hand()
    }

    /// Applies mouse and keys in their order: at a low frame rate many of them arrive at once.
    fn steer(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &Response,
        live: &LiveState,
        camera: &SceneCamera,
        outbox: &mut Outbox,
    ) {
        let before_m = self.position_m;
        let takes = view.contains_pointer() || view.is_pointer_button_down_on();
        // While a person writes, the keys belong to the text.
        let writes = ui.ctx().text_edit_focused();
        for event in ui.input(|input| input.events.clone()) {
            match event {
                Event::Key { key, pressed: true, repeat, modifiers, .. } if !writes && modifiers.is_none() => {
                    self.key(key, repeat, live, camera, outbox);
                }
                Event::PointerButton { pos, button: PointerButton::Primary, pressed, .. } => {
                    self.drag_to(pos, camera, rect);
                    self.drag = (pressed && takes && rect.contains(pos)).then_some(pos);
                }
                Event::PointerMoved(pos) => self.drag_to(pos, camera, rect),
                Event::PointerGone => self.drag = None,
                _ => {}
            }
        }
        if view.contains_pointer() {
            self.step(Vector3::z() * (WHEEL_M * ui.input(|input| input.smooth_scroll_delta().y)));
        }
        for side in Side::ALL {
            if let Some(position_m) =
                self.position_m[side.index()].filter(|position_m| before_m[side.index()] != Some(*position_m))
            {
                outbox.push(Command::Guide(side, Some(position_m.cast())));
            }
        }
    }

    fn key(&mut self, key: Key, repeat: bool, live: &LiveState, camera: &SceneCamera, outbox: &mut Outbox) {
        let is_searched = live.scene.is_searched();
        match key {
            Key::ArrowLeft => self.step(-camera.right() * STEP_M),
            Key::ArrowRight => self.step(camera.right() * STEP_M),
            Key::ArrowUp => self.step(camera.away() * STEP_M),
            Key::ArrowDown => self.step(-camera.away() * STEP_M),
            Key::PageUp => self.step(Vector3::z() * STEP_M),
            Key::PageDown => self.step(-Vector3::z() * STEP_M),
            // A key that is held repeats movements only.
            _ if repeat => {}
            Key::H => self.change_side(),
            Key::G if live.scene.objects.is_some() => self.jaws(live, outbox),
            Key::X if is_searched => outbox.push(Command::Task(self.side, TaskAction::Mark)),
            Key::D if is_searched => outbox.push(Command::Task(self.side, TaskAction::End)),
            _ => {}
        }
    }

    /// Moves the driven instrument by this vector, m.
    fn step(&mut self, travel_m: Vector3<f32>) {
        if let Some(position_m) = &mut self.position_m[self.side.index()] {
            *position_m = within(*position_m + travel_m, self.lowest_m);
        }
    }

    /// Moves the dragged instrument with the pointer. egui's `dragged` is not used: it takes the first points of a drag as a
    /// click and omits the motion that arrives with the release.
    fn drag_to(&mut self, pos: Pos2, camera: &SceneCamera, rect: Rect) {
        let (Some(from), Some(position_m)) = (&mut self.drag, &mut self.position_m[self.side.index()]) else { return };
        *position_m = within(moved_m(position_m, pos - std::mem::replace(from, pos), camera, rect), self.lowest_m);
    }
}

fn within(position_m: Vector3<f32>, lowest_m: f32) -> Vector3<f32> {
    Vector3::new(
        position_m.x.clamp(-SIDE_M, SIDE_M),
        position_m.y.clamp(-SIDE_M, SIDE_M),
        position_m.z.min(*HEIGHT_M.end()).max(lowest_m),
    )
}

/// Returns the position at the same height, this many points away on the screen: the tip stays under the pointer.
fn moved_m(position_m: &Vector3<f32>, way: Vec2, camera: &SceneCamera, rect: Rect) -> Vector3<f32> {
    if way == Vec2::ZERO {
        return *position_m;
    }
    let to_m = camera.project(position_m, rect).and_then(|at| camera.on_level(at + way, rect, position_m.z));
    to_m.unwrap_or_else(|| {
        // The line of sight is too flat to hit that level: move in the image plane instead.
        let travel_m = way * camera.metres_per_point(rect.height());
        position_m + camera.right() * travel_m.x - camera.away() * travel_m.y
    })
}

#[cfg(test)]
mod tests {
    use egui::pos2;
    use nima_simulation::scene::Scene;

    use super::*;

    #[test]
    fn the_tip_stays_under_the_pointer_and_within_the_space_where_it_may_be_led() {
        let rect = Rect::from_min_max(pos2(100.0, 50.0), pos2(900.0, 650.0));
        let camera = SceneCamera::of(&Scene::load("rings").unwrap());
        let position_m = Vector3::new(0.01, -0.01, 0.03);
        let way = vec2(37.0, -21.0);
        let to_m = moved_m(&position_m, way, &camera, rect);
        let went = camera.project(&to_m, rect).unwrap() - camera.project(&position_m, rect).unwrap();
        assert!((went - way).length() < 0.05 && (to_m.z - position_m.z).abs() < 1e-6, "{went:?}");
        let flat = SceneCamera { pitch: 0.05, ..camera };
        assert!(
            (moved_m(&position_m, way, &flat, rect) - position_m).norm() < 0.03,
            "seen flat, a point is no more than it was"
        );
        let low = within(Vector3::new(0.2, -0.2, -0.1), -0.002);
        assert_eq!(low, Vector3::new(SIDE_M, -SIDE_M, -0.002));
        assert!((within(Vector3::z(), -0.002).z - HEIGHT_M.end()).abs() < 1e-9);
    }
}
