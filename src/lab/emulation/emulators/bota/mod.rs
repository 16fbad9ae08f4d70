//! Emulated sensors on real interfaces: pseudo-terminals, TCP and UDP, so that the manufacturer's client accepts them
//! like real ones.
//!
//! The measured values come from a [`BotaBody`], a closure of the emulator's time. Opening the port of a first-generation
//! sensor restarts it, as in reality. Baud rates are emulated: a client with a wrong one reads garbage and is not
//! understood.

mod frames;
mod gen0;
mod gen_a;
mod sensor;
pub(super) mod standalone;
#[cfg(test)]
mod wire_tests;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use nima_core::frames::Wrench;
use nima_devices::{
    ForceReading,
    bota::{Transport, codec::BotaFrame},
};

use crate::emulators::Emulator;

/// Function that returns the values that the sensor measures at a time, s since the emulator began; readings of the
/// inertial unit are used if frames contain them.
pub type BotaBody = Box<dyn FnMut(f64) -> ForceReading + Send>;

/// Properties of an emulated sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatedBota {
    /// Generation and interface: a pseudo-terminal, or the network of this computer.
    pub transport: Transport,
    pub product: String,
    /// Digits.
    pub serial: String,
    pub firmware: String,
    /// Baud rate, bit/s; `None` accepts any, like a serial device on USB.
    pub baud: Option<u32>,
    /// First generation: time from opening the port to the start, s.
    pub boot_s: f64,
    /// First generation: number of starts after which the calibration is not active.
    pub raw_starts: u32,
    /// Clock when the emulator begins, us.
    pub first_timestamp_us: u32,
    /// Status bits that are always set.
    pub status: u16,
    /// Serial interface: name of the port; by default in a temporary folder.
    pub link: Option<std::path::PathBuf>,
    /// Socket: TCP port for commands; 0 selects a free one.
    pub tcp_port: u16,
    /// Socket: address to which readings are sent.
    pub destination: std::net::SocketAddrV4,
}

impl Default for EmulatedBota {
    fn default() -> Self {
        Self {
            transport: Transport::GenA,
            product: "BFT-SENS-SER-M8".to_owned(),
            serial: "853".to_owned(),
            firmware: "1.0.9".to_owned(),
            baud: Some(460_800),
            boot_s: 0.8,
            raw_starts: 0,
            first_timestamp_us: 0,
            status: 0,
            link: None,
            tcp_port: 23,
            destination: std::net::SocketAddrV4::new(std::net::Ipv4Addr::LOCALHOST, 50_001),
        }
    }
}

impl EmulatedBota {
    /// Makes the emulator with a source of values.
    pub fn with(self, body: BotaBody) -> Box<dyn Emulator> {
        let wire: Box<dyn BotaWire> = match self.transport {
            Transport::Gen0 => Box::new(gen0::Gen0::new(&self)),
            Transport::GenA | Transport::Socket => Box::new(gen_a::GenA::new(&self)),
        };
        Box::new(sensor::EmulatedSensor::new(wire, self, body))
    }
}

/// The protocol of a generation of sensors.
trait BotaWire: Send {
    /// Called when a client has opened the port.
    fn opened(&mut self, now_s: f64);
    /// Processes received bytes; appends the response to `answer`.
    fn receive(&mut self, bytes: &[u8], now_s: f64, answer: &mut Vec<u8>);
    /// Called when time has passed: completes a start, or a command without a terminator.
    fn tick(&mut self, now_s: f64, answer: &mut Vec<u8>);
    /// Returns the time between readings while it measures, s.
    fn period_s(&self) -> Option<f64>;
    /// Returns whether frames contain the inertial unit.
    fn is_inertial(&self) -> bool;
    /// Applies the sensor's own offset and status bits to a reading.
    fn finish(&self, frame: &mut BotaFrame);
}

/// Returns a slow, plausible motion for a standalone emulator: a tool of 0.4 kg being rotated, and a slow pull.
pub fn slow_motion() -> BotaBody {
    Box::new(|t_s| {
        let turn = (0.5 * (TAU * 0.10 * t_s).sin(), 0.3 * (TAU * 0.07 * t_s).cos());
        let up = Vector3::new(turn.0.sin() * turn.1.cos(), turn.1.sin(), turn.0.cos() * turn.1.cos());
        let acceleration_m_s2 = up * 9.806_65;
        let weight_n = acceleration_m_s2 * -0.4;
        let pull_n = Vector3::new(1.5 * (TAU * 0.25 * t_s).sin(), 1.0 * (TAU * 0.2 * t_s).cos(), 0.0);
        let to_mass_m = Vector3::new(0.002, -0.001, 0.05);
        let torque_nm = to_mass_m.cross(&weight_n) + Vector3::new(0.0, 0.0, 0.12).cross(&pull_n);
        ForceReading {
            wrench: Wrench { force_n: weight_n + pull_n, torque_nm },
            acceleration_m_s2: Some(acceleration_m_s2),
            angular_velocity_rad_s: Some(Vector3::new(
                -0.3 * TAU * 0.07 * (TAU * 0.07 * t_s).sin(),
                0.5 * TAU * 0.10 * (TAU * 0.10 * t_s).cos(),
                0.0,
            )),
            temperature_c: 30.0 + 2.0 * (TAU * 0.01 * t_s).sin(),
            ..ForceReading::default()
        }
    })
}
