//! Leads a simulated rig from a desk with an emulated cap and an emulated pedal.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering::Relaxed},
    },
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_core::task::TaskEvent;
use nima_devices::{
    CapReading, ConnectionState, PedalReading,
    hid::{CapSettings, PedalSettings},
};
use nima_machine::{
    config::RigConfig,
    rig::{DeskSettings, Inputs, Outputs, Rig as _, SIDES, Side},
};
use nima_simulation::{InputDevices, ObjectFeed, Worlds, scene::Scene};
use nima_testing::real_time::judged;

use crate::emulators::{
    EmulatorThread,
    hid::{CapBody, CapModel, PedalBody, PedalModel, cap, pedal},
};

fn source(endpoint: &str) -> String {
    if endpoint.starts_with("emulated:") { endpoint.to_owned() } else { format!("emulated:{endpoint}") }
}

/// The rig `desk` in a scene, with a cap whose buttons a test presses.
struct Pressed {
    desk: InputDevices,
    watched: ObjectFeed,
    buttons: Arc<AtomicU32>,
    inputs: [Option<Inputs>; SIDES],
    begin: Instant,
    _cap: EmulatorThread,
}

impl Pressed {
    fn begin(scene: &str) -> Self {
        let buttons = Arc::new(AtomicU32::new(0));
        let now = Arc::clone(&buttons);
        let moved = move |_| CapReading { buttons: now.load(Relaxed), ..CapReading::default() };
        let cap = cap(None, CapModel::default(), CapBody::moved_by(moved)).serve().unwrap();
        let mut settings = RigConfig::load("desk").unwrap().desk.unwrap();
        settings.cap.as_mut().unwrap().source = source(&cap.endpoint);
        settings.pedal = None;
        let (worlds, watched) = Worlds::watched(&Scene::load(scene).unwrap(), 1000.0);
        let (desk, _) = InputDevices::start(&settings, worlds).unwrap();
        let inputs = [None; SIDES];
        let begin = Instant::now();
        let mut this = Self { desk, watched: watched.unwrap(), buttons, inputs, begin, _cap: cap };
        this.run(|this| this.desk.health().devices[0].standing == ConnectionState::Connected);
        this.for_s(0.3);
        this
    }

    /// Runs the loop as if engaged until `wanted`, for at most 6 s.
    fn run(&mut self, wanted: impl Fn(&Self) -> bool) -> bool {
        let until = Instant::now() + Duration::from_secs(6);
        while Instant::now() < until {
            let now_s = self.begin.elapsed().as_secs_f64();
            let outputs = Side::ALL.map(|side| Outputs { tip_command_m: Some(self.hand_m(side)), ..Outputs::SAFE });
            self.desk.write(now_s, &outputs);
            self.inputs = self.desk.read(now_s);
            if wanted(self) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        false
    }

    fn for_s(&mut self, seconds: f64) {
        let until_s = self.begin.elapsed().as_secs_f64() + seconds;
        self.run(|this| this.begin.elapsed().as_secs_f64() > until_s);
    }

    /// Holds a button down for a while.
    fn press(&mut self, button: u32) {
        self.buttons.store(1 << button, Relaxed);
        self.for_s(0.2);
        self.buttons.store(0, Relaxed);
        self.for_s(0.2);
    }

    fn hand_m(&self, side: Side) -> Vector3<f64> {
        self.inputs[side.index()].map_or_else(Vector3::zeros, |inputs| inputs.hand.position_m)
    }

    fn gripper_rad(&self, side: Side) -> f64 {
        self.inputs[side.index()].and_then(|inputs| inputs.gripper_rad).unwrap_or_default()
    }
}

#[test]
fn the_second_button_of_a_cap_marks_where_lumps_are_looked_for() {
    judged(|| {
        let mut pressed = Pressed::begin("find_lumps");
        let marks = |pressed: &Pressed| {
            pressed.watched.happenings().filter(|of| matches!(of.event, TaskEvent::LumpMarked { .. })).count()
        };
        assert_eq!(marks(&pressed), 0);
        for _ in 0..2 {
            pressed.press(1);
        }
        assert_eq!(marks(&pressed), 2, "each press once, however long it is");
        pressed.press(0);
        assert_eq!(marks(&pressed), 0, "the first button lets the hand resume its task");
    });
}

#[test]
fn the_second_button_of_a_cap_opens_and_closes_jaws_and_the_other_hand_waits() {
    judged(|| {
        let mut pressed = Pressed::begin("rings");
        let mut left_m = None;
        for open in [true, false, true] {
            pressed.press(1);
            let is_so = pressed.run(|pressed| (pressed.gripper_rad(Side::Right) > 0.5) == open);
            assert!(is_so, "{open}: {} rad", pressed.gripper_rad(Side::Right));
            left_m.get_or_insert(pressed.hand_m(Side::Left));
        }
        let moved_m = (pressed.hand_m(Side::Left) - left_m.unwrap()).norm();
        pressed.press(0);
        assert_eq!(pressed.desk.led_to_m(), None);
        pressed.for_s(1.0);
        let goes_on_m = (pressed.hand_m(Side::Left) - left_m.unwrap()).norm();
        assert!(moved_m < 0.002 && goes_on_m > 0.01, "{moved_m} m, and then {goes_on_m} m");
    });
}

#[test]
fn a_cap_leads_the_hand_and_a_pedal_is_the_clutch() {
    judged(|| {
        let push = CapReading { translation: Vector3::new(0.5, 0.0, 0.0), ..CapReading::default() };
        // The cap is released for a while, then pushed to the right.
        let cap = cap(
            None,
            CapModel::default(),
            CapBody::moved_by(move |t_s| if t_s > 1.0 { push } else { CapReading::default() }),
        )
        .serve()
        .unwrap();
        let pedal = pedal(
            None,
            PedalModel::default(),
            PedalBody::pressed_by(|t_s| PedalReading { pressed: u32::from(t_s > 1.0) }),
        )
        .serve()
        .unwrap();
        let settings = DeskSettings {
            cap: Some(CapSettings { source: source(&cap.endpoint), ..CapSettings::default() }),
            pedal: Some(PedalSettings { source: source(&pedal.endpoint), ..PedalSettings::default() }),
            ..DeskSettings::default()
        };
        let worlds = Worlds::new(&Scene::load("free_motion").unwrap(), 1000.0);
        let (mut desk, roster) = InputDevices::start(&settings, worlds).unwrap();
        assert_eq!(roster.len(), 2);
        let begin = Instant::now();
        let mut first_m = None;
        let mut led_s = 0.0;
        let mut clutched = false;
        let mut hand_m = Vector3::zeros();
        while begin.elapsed() < Duration::from_secs(6) && led_s < 0.8 {
            let now_s = begin.elapsed().as_secs_f64();
            let outputs = Outputs { tip_command_m: Some(hand_m), ..Outputs::SAFE };
            desk.write(now_s, &[outputs; SIDES]);
            let inputs = desk.read(now_s);
            hand_m = inputs[0].map_or(hand_m, |inputs| inputs.hand.position_m);
            clutched |= inputs[0].is_some_and(|inputs| inputs.switches.clutch);
            if let Some(position_m) = desk.led_to_m() {
                let (from_s, from_m): (f64, Vector3<f64>) = *first_m.get_or_insert((now_s, position_m));
                led_s = now_s - from_s;
                // Half deflection: 30 mm/s to the right, no motion along the other axes.
                let travel_m = position_m - from_m;
                assert!(
                    travel_m.y.abs() < 1e-9 && (travel_m.x - 0.03 * led_s).abs() < 6e-3,
                    "{travel_m} after {led_s} s"
                );
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(led_s >= 0.8 && clutched, "led for {led_s} s, clutch {clutched}");
    });
}
