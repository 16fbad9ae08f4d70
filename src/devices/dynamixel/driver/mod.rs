//! Driver of four servos. One exchange is in progress at a time, as fast as bus and caller allow; it never waits.
//!
//! An exchange is one `send`: a sync write of the goals (while the torque is on) and a sync read of clock, current,
//! velocity and position of all four. At intervals it requests the condition of one servo instead (torque, hardware
//! error, watchdog, voltage, temperature). An exchange that is not answered within a few milliseconds is abandoned and
//! the next one starts. The servos count as lost after `silence_s` without a reading (18 ms, more on slow lines: three
//! exchanges), and on impossible numbers, a hardware error, an expired watchdog, or a torque that went off by itself.
//! Times in s on the caller's clock.

mod exchange;

use std::time::{Duration, Instant};

use super::{
    clock::DeviceClock,
    codec::{IncomingPackets, OVERHEAD, OutgoingPackets},
    opening::{ANSWER_S, DynamixelSession, REST_READS, ServoProperties, SystemClock, WaitClock},
    protocol_1,
    reboots::Reboots,
    settings::{DynamixelSettings, silence_s},
    table::{BAUDS, EEPROM_BYTES, HardwareError, TEMPERATURE, ticks_from_rad},
};
use crate::{
    ConnectionState, Device, DeviceError, DeviceIdentity, Health, SERVOS, ServoReading, TimedReading,
    transport::{ByteStream, Serial, SerialSettings},
};

/// Bytes read from each servo: registers from the clock to the position.
pub(super) const MOTION_BYTES: usize = 16;
/// First address and length of a servo's condition: the RAM up to the temperature.
const CONDITION_FROM: u16 = EEPROM_BYTES;
const CONDITION_BYTES: usize = (TEMPERATURE.address + 1 - CONDITION_FROM) as usize;
/// Longest answer: a condition with the largest possible byte stuffing.
const LONGEST: usize = OVERHEAD + (CONDITION_BYTES + 1) * 4 / 3;
/// Interval between two condition reads, s: temperature, voltage and errors of each of the four servos are then read
/// five times per second, and the exchange of positions hardly loses time. Design choice.
const CONDITION_EVERY_S: f64 = 0.050;
/// Allowance for adapter, operating system and servo in addition to the transmission time, as a fraction of the time
/// until the servos count as silent; three attempts fit in.
const SLACK: f64 = 0.2;
/// A reading delayed by this much more than the fastest ones is old; as a fraction of the time until silence.
const LATE: f64 = 0.75;
/// Transmitted bytes in an ordinary exchange, including goals.
const WIRE_BYTES: f64 = 160.0;
/// Maximum plausible velocity, units of 0.229 rpm (98 rad/s).
const VELOCITY_MAX: i32 = 4095;
/// Maximum plausible position, ticks (256 turns and the largest homing offset).
const POSITION_MAX: i32 = 2_100_000;
/// Maximum plausible current, units.
const CURRENT_MAX: i16 = 4095;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoCondition {
    pub torque_on: bool,
    /// Hardware errors, and the state of the watchdog.
    pub error: HardwareError,
    pub voltage_v: f64,
    pub temperature_c: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalResult {
    AsAsked,
    /// Accepted after clamping to the range in the settings.
    Limited,
    /// Refused: the torque is off, or a number is not finite.
    Refused,
}

#[derive(Clone, Copy, Debug)]
struct ServoState {
    id: u8,
    current_unit_a: f64,
    limits_ticks: (f64, f64),
    condition: Option<ServoCondition>,
    /// Whether the torque has been reported as on since it was requested.
    driven: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct ServoMotion {
    tick: u16,
    current: i16,
    velocity: i32,
    position: i32,
}

#[derive(Clone, Copy, Debug)]
enum ServoQuestion {
    Motion { next: usize },
    Condition { index: usize },
}

#[derive(Clone, Copy, Debug)]
struct ServoExchange {
    question: ServoQuestion,
    until_s: f64,
}

/// The open servos. Dropping it switches their torque off.
#[derive(Debug)]
pub struct DynamixelDriver<T: ByteStream = Serial> {
    line: T,
    health: Health,
    identity: DeviceIdentity,
    reboots: Reboots,
    servos: [ServoState; SERVOS],
    fast: bool,
    byte_s: f64,
    silence_s: f64,
    watchdog: u8,
    incoming: IncomingPackets,
    outgoing: OutgoingPackets,
    exchange: Option<ServoExchange>,
    motions: [ServoMotion; SERVOS],
    clock: DeviceClock,
    goals: Option<[i32; SERVOS]>,
    torque: Torque,
    condition_due_s: f64,
    condition_next: usize,
    alert: Option<usize>,
    quiet: Quiet,
    wrong: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Torque {
    #[default]
    Off,
    /// Switched on in the exchange after the next reading.
    Wanted,
    On,
    /// Switched off in the next exchange.
    Ending,
}

/// Time without new data. Time in which the caller did not poll does not count.
#[derive(Clone, Copy, Debug, Default)]
struct Quiet {
    polled_s: Option<f64>,
    length_s: f64,
    damaged_before: u64,
    refused_before: u64,
}

/// Opens the line, finds the servos and configures them; the torque is off.
///
/// # Errors
/// [`DeviceError`] if the port cannot be opened, or a servo is missing, cannot be configured or reports a fault.
pub fn open(settings: &DynamixelSettings) -> Result<DynamixelDriver, DeviceError> {
    open_with(settings, &Reboots::default())
}

/// Opens the servos and restarts those requested in `reboots`; the driver handles later requests as well.
///
/// # Errors
/// The errors of [`open`].
pub fn open_with(settings: &DynamixelSettings, reboots: &Reboots) -> Result<DynamixelDriver, DeviceError> {
    settings.check()?;
    let mut line = Serial::open(&SerialSettings { port: settings.port.clone(), baud: settings.baud })?;
    let mut pace = SystemClock(Instant::now());
    let mut session = DynamixelSession::new(&mut line, &mut pace, &settings.port);
    match session.configure(settings, reboots) {
        Ok(opened) => return Ok(DynamixelDriver::new(line, settings, opened, reboots.clone())),
        Err(DeviceError::Silent { .. }) => {}
        Err(other) => return Err(other),
    }
    let received = session.received_anything();
    Err(why_silent(&mut line, &mut pace, &settings.port, settings.baud, received)?)
}

/// Returns ids and model numbers of the servos that answer on a line; writes nothing.
///
/// # Errors
/// [`DeviceError`] if the port cannot be opened or closes during the search, no servo answers, or the first one answers so
/// late that a rig would count it as lost.
pub fn who_is_there(port: &str, baud: u32) -> Result<Vec<(u8, u16)>, DeviceError> {
    if !BAUDS.contains(&baud) {
        let allowed = format!("one of {BAUDS:?}");
        return Err(DeviceError::Setting { key: "baud".to_owned(), value: baud.to_string(), allowed });
    }
    let mut line = Serial::open(&SerialSettings { port: port.to_owned(), baud })?;
    let mut pace = SystemClock(Instant::now());
    let mut session = DynamixelSession::new(&mut line, &mut pace, port);
    let servos = session.everybody()?;
    if let Some((id, _)) = servos.first() {
        let max_s = silence_limit_s(silence_s(), byte_s(baud));
        let is_late = session.answer_time_s(*id)?.is_some_and(|time_s| time_s > max_s);
        return if is_late { Err(DeviceError::Late { place: port.to_owned() }) } else { Ok(servos) };
    }
    let received = session.received_anything();
    Err(why_silent(&mut line, &mut pace, port, baud, received)?)
}

/// Returns the time of a byte on the line, s.
fn byte_s(baud: u32) -> f64 {
    10.0 / f64::from(baud)
}

/// Returns the time without a reading after which the servos count as lost, s: on a slow line three exchanges take longer
/// than the setting.
fn silence_limit_s(setting_s: f64, byte_s: f64) -> f64 {
    setting_s.max(3.0 * WIRE_BYTES / (1.0 - 3.0 * SLACK) * byte_s)
}

/// Determines whether servos that do not answer use another line speed or are missing.
fn why_silent(
    line: &mut Serial,
    pace: &mut SystemClock,
    port: &str,
    baud: u32,
    received: bool,
) -> Result<DeviceError, DeviceError> {
    let wrong = DeviceError::WrongBaud { place: port.to_owned(), baud };
    if let Some(found) = protocol_1::anybody(line, pace, port, ANSWER_S)? {
        return Ok(found);
    }
    if received {
        return Ok(wrong);
    }
    for other in BAUDS.into_iter().filter(|other| *other != baud) {
        // The servos cannot use a speed that the adapter does not support.
        if line.set_baud(other).is_err() {
            continue;
        }
        if DynamixelSession::new(line, pace, port).anybody()? {
            return Ok(wrong);
        }
        if let Some(found) = protocol_1::anybody(line, pace, port, ANSWER_S)? {
            return Ok(found);
        }
    }
    Ok(DeviceError::Silent { place: port.to_owned() })
}

/// Opens over an existing line with the caller's clock: runs emulated servos in simulated time.
///
/// # Errors
/// The errors of [`open`], except for opening the port.
pub fn open_over<T: ByteStream>(
    mut line: T,
    pace: &mut impl WaitClock,
    settings: &DynamixelSettings,
    reboots: &Reboots,
) -> Result<DynamixelDriver<T>, DeviceError> {
    settings.check()?;
    let opened = DynamixelSession::new(&mut line, pace, &settings.port).configure(settings, reboots)?;
    Ok(DynamixelDriver::new(line, settings, opened, reboots.clone()))
}

impl<T: ByteStream> DynamixelDriver<T> {
    fn new(line: T, settings: &DynamixelSettings, opened: ServoProperties, reboots: Reboots) -> Self {
        let servos = std::array::from_fn(|index| {
            let servo = &settings.servos[index];
            let current_unit_a = opened.models[index].current_unit_a;
            let limits_ticks = servo.limits_ticks();
            ServoState { id: servo.id, current_unit_a, limits_ticks, condition: None, driven: false }
        });
        let byte_s = byte_s(settings.baud);
        let silence_s = silence_limit_s(settings.silence_s, byte_s);
        Self {
            line,
            health: Health::opening(),
            identity: opened.identity,
            reboots,
            servos,
            fast: opened.fast,
            byte_s,
            silence_s,
            watchdog: settings.watchdog_units(),
            incoming: IncomingPackets::new(LONGEST),
            outgoing: OutgoingPackets::new(512),
            exchange: None,
            motions: [ServoMotion::default(); SERVOS],
            clock: DeviceClock::new(LATE * silence_s),
            goals: None,
            torque: Torque::Off,
            condition_due_s: 0.0,
            condition_next: 0,
            alert: None,
            quiet: Quiet::default(),
            wrong: 0,
        }
    }

    /// Switches the torque on, holding the current angles, or off. Takes effect with the next exchange.
    pub fn set_torque(&mut self, on: bool) {
        self.torque = match (on, self.torque) {
            (true, Torque::On) => Torque::On,
            (true, _) => Torque::Wanted,
            (false, Torque::Off) => Torque::Off,
            (false, _) => Torque::Ending,
        };
    }

    pub fn is_torque_on(&self) -> bool {
        self.torque == Torque::On
    }

    /// Sets the goals, rad; they are sent with every exchange.
    pub fn set_goals(&mut self, goal_rad: &[f64; SERVOS]) -> GoalResult {
        if self.torque != Torque::On || !goal_rad.iter().all(|goal| goal.is_finite()) {
            return GoalResult::Refused;
        }
        let mut taken = GoalResult::AsAsked;
        self.goals = Some(std::array::from_fn(|index| {
            let (low, high) = self.servos[index].limits_ticks;
            let ticks = ticks_from_rad(goal_rad[index]).round();
            if !(low..=high).contains(&ticks) {
                taken = GoalResult::Limited;
            }
            ticks.clamp(low, high) as i32
        }));
        taken
    }

    /// Restarts the servo with this index: the torque of all servos goes off, the driver reports itself lost, and the
    /// next opening with the same [`Reboots`] restarts the servo.
    pub fn reboot(&self, index: usize) {
        self.reboots.ask(index);
    }

    /// Returns the latest condition of each servo, updated about five times per second.
    pub fn conditions(&self) -> [Option<ServoCondition>; SERVOS] {
        self.servos.map(|servo| servo.condition)
    }

    /// Returns whether all four answer in one packet (fast sync read).
    pub const fn uses_fast_sync_read(&self) -> bool {
        self.fast
    }
}

impl<T: ByteStream> Device for DynamixelDriver<T> {
    type Reading = ServoReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ServoReading>> {
        if matches!(self.health.standing, ConnectionState::Lost(_)) {
            return None;
        }
        match self.turn(now_s) {
            Ok(reading) => reading,
            Err(loss) => {
                self.health.lose(loss);
                None
            }
        }
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl<T: ByteStream> Drop for DynamixelDriver<T> {
    /// Switches the torque off, three times, each time after the line is quiet, because a packet in transit would
    /// collide with the command.
    fn drop(&mut self) {
        self.outgoing.clear();
        self.put_torque_off();
        for _ in 0..3 {
            let mut buffer = [0; 256];
            std::thread::sleep(Duration::from_secs_f64((400.0 * self.byte_s + 0.002).min(0.5)));
            for _ in 0..REST_READS {
                if !self.line.receive(&mut buffer).is_ok_and(|count| count > 0) {
                    break;
                }
            }
            if self.line.send(self.outgoing.bytes()).is_err() {
                return;
            }
        }
    }
}
