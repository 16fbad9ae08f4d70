//! A driver and emulated servos in one thread, in virtual time.

use std::{cell::RefCell, rc::Rc};

use nima_devices::{
    Device as _, DeviceError, ServoReading, TimedReading,
    dynamixel::{
        DynamixelDriver, DynamixelSettings, Gains, OperatingMode, Reboots, ServoSettings, WaitClock, open_over,
        table::{self, ServoModel},
    },
    transport::{ByteStream as _, MemoryBytes},
};

use super::super::{Bus, EmulatedDynamixel};
use crate::emulators::{EmulatedFault, WirePeer, faults::FaultyLine};

pub(super) fn settings() -> DynamixelSettings {
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
    DynamixelSettings {
        port: "test".to_owned(),
        baud: 4_000_000,
        servos: [1, 2, 3, 4].map(servo),
        fast_sync_read: true,
        bus_watchdog_s: 0.1,
        silence_s: 0.020,
    }
}

pub(super) fn emulated() -> EmulatedDynamixel {
    EmulatedDynamixel { baud: 4_000_000, ..EmulatedDynamixel::default() }
}

/// Returns servos of which the third has protocol 2, but another control table than the X series.
pub(super) fn with_unsupported(settings: &EmulatedDynamixel) -> Bus {
    /// Model number from the ROBOTIS e-manual.
    static XL_320: ServoModel = ServoModel { number: 350, name: "XL-320", current_unit_a: f64::NAN, current_max: 0 };
    let mut bus = Bus::new(settings, None).unwrap();
    let servo = &mut bus.servos[2];
    servo.model = &XL_320;
    servo.set(table::MODEL, XL_320.number.into());
    bus
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
        emulator.send(*now_s, *fault, &mut |frame| line.pass(*now_s, WirePeer::Everyone, frame, *fault, &mut out));
    }
}

/// The common time of driver and servos.
#[derive(Clone)]
pub(super) struct Fixture {
    pub(super) world: Rc<RefCell<World>>,
    pub(super) reboots: Reboots,
    pub(super) settings: DynamixelSettings,
}

impl WaitClock for Fixture {
    fn now_s(&self) -> f64 {
        self.world.borrow().now_s
    }

    fn nap(&mut self) {
        self.world.borrow_mut().pass(1e-3);
    }
}

impl Fixture {
    pub(super) fn new(emulator: Bus, settings: DynamixelSettings) -> Self {
        let end = MemoryBytes::pair()[0].clone();
        let world = World { emulator, end, now_s: 0.0, fault: EmulatedFault::None, line: FaultyLine::default() };
        Self { world: Rc::new(RefCell::new(world)), reboots: Reboots::default(), settings }
    }

    pub(super) fn usual() -> Self {
        Self::new(Bus::new(&emulated(), None).unwrap(), settings())
    }

    /// Plugs in a new cable and opens the driver.
    pub(super) fn open(&mut self) -> Result<DynamixelDriver<MemoryBytes>, DeviceError> {
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
    pub(super) fn poll(
        &self,
        driver: &mut DynamixelDriver<MemoryBytes>,
        step_s: f64,
    ) -> Option<TimedReading<ServoReading>> {
        self.world.borrow_mut().pass(step_s);
        let now_s = self.now_s();
        driver.poll(now_s)
    }

    /// Polls at 1 kHz for this long; returns the last reading.
    pub(super) fn run(&self, driver: &mut DynamixelDriver<MemoryBytes>, length_s: f64) -> Option<ServoReading> {
        let count = (length_s * 1e3).round() as usize;
        (0..count).filter_map(|_| self.poll(driver, 1e-3)).last().map(|reading| reading.value)
    }
}
