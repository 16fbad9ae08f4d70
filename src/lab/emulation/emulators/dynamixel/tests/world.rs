//! A driver and emulated servos in one thread, in virtual time.

use std::{cell::RefCell, rc::Rc};

use nima_devices::{
    Device as _, ServoReading, Stamped, Trouble,
    dynamixel::{Driver, Gains, OperatingMode, Pace, Reboots, ServoSettings, Settings, open_over},
    transport::{Bytes as _, MemoryBytes},
};

use super::super::{Bus, Emulated};
use crate::emulators::{EmulatedFault, Peer, faults::FaultyLine};

pub(super) fn settings() -> Settings {
    let servo = |id| ServoSettings {
        id,
        model: None,
        reverse: false,
        homing_offset_rad: 0.0,
        operating_mode: OperatingMode::Position,
        position_min_rad: -1.5,
        position_max_rad: 1.5,
        current_limit_a: 2.0,
        goal_current_a: None,
        profile_velocity_rad_s: 4.0,
        profile_acceleration_rad_s2: 100.0,
        gains: Gains::default(),
    };
    Settings {
        port: "test".to_owned(),
        baud: 4_000_000,
        servos: [1, 2, 3, 4].map(servo),
        fast_sync_read: true,
        bus_watchdog_s: 0.1,
        silence_s: 0.020,
    }
}

pub(super) fn emulated() -> Emulated {
    Emulated { baud: 4_000_000, ..Emulated::default() }
}

pub(super) struct World {
    pub(super) emulator: Bus,
    pub(super) end: MemoryBytes,
    pub(super) now_s: f64,
    pub(super) fault: EmulatedFault,
    line: FaultyLine,
}

impl World {
    pub(super) fn pass(&mut self, step_s: f64) {
        self.now_s += step_s;
        let mut buffer = [0; 4096];
        if let Ok(count) = self.end.receive(&mut buffer)
            && count > 0
        {
            self.emulator.receive(self.now_s, &buffer[..count]);
        }
        let Self { emulator, end, now_s, fault, line } = self;
        let mut out = |_, bytes: &[u8]| end.send(bytes).unwrap_or_default();
        line.let_late_ones_go(*now_s, &mut out);
        emulator.send(*now_s, *fault, &mut |frame| line.pass(*now_s, Peer::Everyone, frame, *fault, &mut out));
    }
}

/// The common time of driver and servos.
#[derive(Clone)]
pub(super) struct Bench {
    pub(super) world: Rc<RefCell<World>>,
    pub(super) reboots: Reboots,
    pub(super) settings: Settings,
}

impl Pace for Bench {
    fn now_s(&self) -> f64 {
        self.world.borrow().now_s
    }

    fn nap(&mut self) {
        self.world.borrow_mut().pass(1e-3);
    }
}

impl Bench {
    pub(super) fn new(emulator: Bus, settings: Settings) -> Self {
        let end = MemoryBytes::pair()[0].clone();
        let world = World { emulator, end, now_s: 0.0, fault: EmulatedFault::None, line: FaultyLine::default() };
        Self { world: Rc::new(RefCell::new(world)), reboots: Reboots::default(), settings }
    }

    pub(super) fn usual() -> Self {
        Self::new(Bus::new(&emulated(), None).unwrap(), settings())
    }

    /// Plugs in a new cable and opens the driver.
    pub(super) fn open(&mut self) -> Result<Driver<MemoryBytes>, Trouble> {
        let [ours, theirs] = MemoryBytes::pair();
        self.world.borrow_mut().end = theirs;
        let settings = self.settings.clone();
        let reboots = self.reboots.clone();
        open_over(ours, self, &settings, &reboots)
    }

    pub(super) fn fault(&self, fault: EmulatedFault) {
        self.world.borrow_mut().fault = fault;
    }

    /// Polls the driver once after `step_s`.
    pub(super) fn poll(&self, driver: &mut Driver<MemoryBytes>, step_s: f64) -> Option<Stamped<ServoReading>> {
        self.world.borrow_mut().pass(step_s);
        let now_s = self.now_s();
        driver.poll(now_s)
    }

    /// Polls at 1 kHz for this long; returns the last reading.
    pub(super) fn run(&self, driver: &mut Driver<MemoryBytes>, length_s: f64) -> Option<ServoReading> {
        let count = (length_s * 1e3).round() as usize;
        (0..count).filter_map(|_| self.poll(driver, 1e-3)).last().map(|reading| reading.value)
    }
}
