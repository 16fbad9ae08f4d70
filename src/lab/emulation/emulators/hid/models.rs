//! The emulated devices themselves: content and timing of their reports.

use super::{
    CapReading, CapReport, Duration, EmulatedFault, HidIdentity, PedalLayout, PedalReading, SpacenavdEvent, Vector3,
    WireSide, cap_codec, counts_of, pedal_codec,
};

/// Zero reports before a cap falls silent at rest. Real caps send a few, so that a lost report does not leave the
/// motion running.
const ZEROS: u32 = 3;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CapModel {
    /// `SpaceNavigator`: translation and rotation in turn, one report every 8 ms.
    #[default]
    Split,
    /// `SpaceMouse Wireless` on its cable: both parts in one report every 16 ms.
    Combined,
}

/// Motion and light of an emulated cap.
pub struct CapBody {
    /// Returns the state of the cap at a time since the start, s.
    pub now: Box<dyn FnMut(f64) -> CapReading + Send>,
    /// Called when the light is switched.
    pub light: Box<dyn FnMut(bool) + Send>,
}

impl CapBody {
    /// Creates a slow motion through all axes with a rest in every cycle of 8 s; the first button blinks.
    pub fn alone() -> Self {
        Self { now: Box::new(demonstration), light: Box::new(|_| {}) }
    }

    /// Moved by a function of time.
    pub fn moved_by(now: impl FnMut(f64) -> CapReading + Send + 'static) -> Self {
        Self { now: Box::new(now), light: Box::new(|_| {}) }
    }
}

fn demonstration(now_s: f64) -> CapReading {
    const CYCLE_S: f64 = 8.0;
    const MOVING_S: f64 = 6.0;
    let phase_s = now_s.rem_euclid(CYCLE_S);
    let buttons = u32::from(phase_s < 1.0);
    if phase_s > MOVING_S {
        return CapReading { buttons, ..CapReading::default() };
    }
    let wave = |turns: f64| 0.8 * (std::f64::consts::TAU * turns * phase_s / MOVING_S).sin();
    CapReading {
        translation: Vector3::new(wave(1.0), wave(2.0), wave(3.0)),
        rotation: Vector3::new(wave(4.0), wave(5.0), wave(6.0)) * 0.5,
        buttons,
    }
}

/// Part common to all emulated caps: the times at which they send, and the reading that a fault may freeze.
struct Mover {
    body: CapBody,
    reading: CapReading,
    zeros_left: u32,
    reported_buttons: u32,
}

impl Mover {
    const fn new(body: CapBody) -> Self {
        let reading = CapReading { translation: ZERO, rotation: ZERO, buttons: 0 };
        Self { body, reading, zeros_left: 0, reported_buttons: 0 }
    }

    /// Advances; returns whether axes must be sent, and the buttons if they changed.
    fn step(&mut self, now_s: f64, fault: EmulatedFault) -> (bool, Option<u32>) {
        if fault != EmulatedFault::Freeze {
            self.reading = (self.body.now)(now_s);
        }
        let deflected = counts_of(&self.reading) != [0; 6];
        let speaks = deflected || self.zeros_left > 0;
        self.zeros_left = if deflected { ZEROS } else { self.zeros_left.saturating_sub(1) };
        let buttons = self.reading.buttons;
        let changed = buttons != self.reported_buttons;
        self.reported_buttons = buttons;
        (speaks, changed.then_some(buttons))
    }
}

const ZERO: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

pub(super) struct CapSide {
    model: CapModel,
    mover: Mover,
    second_half: bool,
}

impl CapSide {
    pub(super) const fn new(model: CapModel, body: CapBody) -> Self {
        Self { model, mover: Mover::new(body), second_half: false }
    }

    fn report(&mut self, counts: [i16; 6]) -> CapReport {
        let [x, y, z, rx, ry, rz] = counts;
        match self.model {
            CapModel::Combined => CapReport::Motion(counts),
            CapModel::Split => {
                self.second_half = !self.second_half;
                if self.second_half { CapReport::Translation([x, y, z]) } else { CapReport::Rotation([rx, ry, rz]) }
            }
        }
    }
}

impl WireSide for CapSide {
    const NAME: &'static str = "spacemouse.sock";

    fn period(&self) -> Duration {
        Duration::from_millis(match self.model {
            CapModel::Split => 8,
            CapModel::Combined => 16,
        })
    }

    fn hello(&self) -> Option<String> {
        let (vendor, product, name) = match self.model {
            CapModel::Split => (0x046d, 0xc626, "SpaceNavigator"),
            CapModel::Combined => (0x256f, 0xc62e, "SpaceMouse Wireless"),
        };
        Some(HidIdentity { vendor, product, serial: "EMULATED".to_owned(), name: name.to_owned() }.hello())
    }

    fn step(&mut self, now_s: f64, fault: EmulatedFault, send: &mut dyn FnMut(&[u8])) {
        let (speaks, buttons) = self.mover.step(now_s, fault);
        let mut buffer = [0; cap_codec::LENGTH_MAX];
        if let Some(buttons) = buttons {
            let length = CapReport::Buttons(buttons).encode(&mut buffer);
            send(&buffer[..length]);
        }
        if !speaks {
            return;
        }
        let mut counts = counts_of(&self.mover.reading);
        if fault == EmulatedFault::NotANumber {
            counts = [i16::MAX; 6];
        }
        let length = self.report(counts).encode(&mut buffer);
        // No report type has a length between the two.
        let length = if fault == EmulatedFault::WrongFrame { 5 } else { length };
        send(&buffer[..length]);
    }

    fn command(&mut self, bytes: &[u8]) {
        for on in [false, true] {
            if *bytes == cap_codec::light(on) {
                (self.mover.body.light)(on);
            }
        }
    }
}

/// The daemon with one cap.
pub(super) struct SpacenavdSide {
    mover: Mover,
}

impl SpacenavdSide {
    pub(super) const fn new(body: CapBody) -> Self {
        Self { mover: Mover::new(body) }
    }
}

/// Time between two events of the daemon, ms.
const SPACENAVD_MS: u8 = 16;

impl WireSide for SpacenavdSide {
    const NAME: &'static str = "spnav.sock";

    fn period(&self) -> Duration {
        Duration::from_millis(u64::from(SPACENAVD_MS))
    }

    fn hello(&self) -> Option<String> {
        None
    }

    fn step(&mut self, now_s: f64, fault: EmulatedFault, send: &mut dyn FnMut(&[u8])) {
        let before = self.mover.reported_buttons;
        let (speaks, buttons) = self.mover.step(now_s, fault);
        let mut changed = buttons.map_or(0, |now| now ^ before);
        while changed != 0 {
            let number = changed.trailing_zeros();
            changed &= changed - 1;
            let pressed = self.mover.reported_buttons >> number & 1 == 1;
            send(&SpacenavdEvent::Button { number, pressed }.encode(0));
        }
        if speaks {
            let [x, y, z, rx, ry, rz] = counts_of(&self.mover.reading).map(i32::from);
            // Converts the device's axes to the daemon's.
            let mut event = SpacenavdEvent::Motion([x, -z, -y, rx, -rz, -ry]).encode(i32::from(SPACENAVD_MS));
            if fault == EmulatedFault::WrongFrame {
                event[..4].copy_from_slice(&99_i32.to_ne_bytes());
            }
            if fault == EmulatedFault::NotANumber {
                event[4..8].copy_from_slice(&i32::MAX.to_ne_bytes());
            }
            send(&event);
        }
    }

    fn command(&mut self, _: &[u8]) {
        // Ignore the request for protocol 1: without an answer, the client uses protocol 0.
    }
}

/// Model of a pedal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PedalModel {
    /// `PCsensor`, three switches: keys `b`, `a`, `c`.
    #[default]
    Keyboard,
    /// VEC Infinity, three switches.
    Switches,
}

/// Returns the pressed switches of an emulated pedal at a time since the start, s.
pub struct PedalBody(pub Box<dyn FnMut(f64) -> PedalReading + Send>);

impl PedalBody {
    /// Returns a pedal on which the first switch is pressed for one second in three, and the second switch after it for
    /// half a second.
    pub fn alone() -> Self {
        Self::pressed_by(|now_s| {
            let phase_s = now_s.rem_euclid(3.0);
            PedalReading { pressed: u32::from(phase_s < 1.0) | u32::from((1.5..2.0).contains(&phase_s)) << 1 }
        })
    }

    /// Pressed by a function of time.
    pub fn pressed_by(now: impl FnMut(f64) -> PedalReading + Send + 'static) -> Self {
        Self(Box::new(now))
    }
}

pub(super) struct PedalSide {
    model: PedalModel,
    layout: PedalLayout,
    body: PedalBody,
    reading: PedalReading,
    report: PedalReading,
}

impl PedalSide {
    pub(super) const fn new(model: PedalModel, body: PedalBody) -> Self {
        let layout = match model {
            PedalModel::Keyboard => PedalLayout::Keyboard { keys: [5, 4, 6, 0, 0, 0, 0, 0] },
            PedalModel::Switches => PedalLayout::Switches,
        };
        let released = PedalReading { pressed: 0 };
        Self { model, layout, body, reading: released, report: released }
    }
}

impl WireSide for PedalSide {
    const NAME: &'static str = "pedal.sock";

    fn period(&self) -> Duration {
        Duration::from_millis(8)
    }

    fn hello(&self) -> Option<String> {
        let (vendor, product, name) = match self.model {
            PedalModel::Keyboard => (0x0c45, 0x7403, "FootSwitch"),
            PedalModel::Switches => (0x05f3, 0x00ff, "VEC USB Footpedal"),
        };
        Some(HidIdentity { vendor, product, serial: String::new(), name: name.to_owned() }.hello())
    }

    fn step(&mut self, now_s: f64, fault: EmulatedFault, send: &mut dyn FnMut(&[u8])) {
        use EmulatedFault::{Garbage, NotANumber, Reorder, WrongFrame};
        if fault != EmulatedFault::Freeze {
            self.reading = (self.body.0)(now_s);
        }
        // A faulty device sends reports even when no foot is on it.
        let chatters = matches!(fault, Garbage | NotANumber | Reorder | WrongFrame);
        if self.reading == self.report && !chatters {
            return;
        }
        self.report = self.reading;
        let mut buffer = [0; pedal_codec::LENGTH_MAX];
        let mut length = self.layout.encode(self.reading.pressed, &mut buffer);
        match (fault, self.model) {
            (WrongFrame, _) => length = 5,
            (NotANumber, PedalModel::Keyboard) => buffer[2..].fill(1),
            (NotANumber, PedalModel::Switches) => buffer[0] = 0xff,
            _ => {}
        }
        send(&buffer[..length]);
    }

    fn command(&mut self, _: &[u8]) {}
}
