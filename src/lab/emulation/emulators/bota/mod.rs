//! Emulated sensors on real wires: pseudo-terminals, TCP and UDP, so that the manufacturer's client takes them for real ones.
//!
//! What a sensor feels comes from its [`Body`], a closure of the emulator's time. Opening the line of a first-generation sensor
//! restarts it, as it does in reality. Line speeds are obeyed: a client with a wrong one reads garbage and is not understood.

pub(super) mod alone;
mod frames;
mod gen0;
mod gen_a;
mod sensor;
#[cfg(test)]
mod wire_tests;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use nima_core::frames::Wrench;
use nima_devices::{
    ForceReading,
    bota::{Transport, codec::Frame},
};

use crate::emulators::Emulator;

/// What the sensor feels at a time, s since the emulator began; readings of the inertial unit are used where frames have it.
pub type Body = Box<dyn FnMut(f64) -> ForceReading + Send>;

/// How an emulated sensor is.
#[derive(Clone, Debug, PartialEq)]
pub struct Emulated {
    /// Which generation, on which wire: a pseudo-terminal, or the network of this computer.
    pub transport: Transport,
    /// Product.
    pub product: String,
    /// Serial number, digits.
    pub serial: String,
    /// Firmware.
    pub firmware: String,
    /// Line speed, bit/s; `None` takes any, as a serial device on USB does.
    pub baud: Option<u32>,
    /// First generation: from opening of the line until it begins, s.
    pub boot_s: f64,
    /// First generation: so many starts leave it without its calibration.
    pub raw_starts: u32,
    /// Its clock when the emulator begins, us.
    pub first_timestamp_us: u32,
    /// Status bits that are always set.
    pub status: u16,
    /// Serial: the name of its line; a folder of its own where none is given.
    pub link: Option<std::path::PathBuf>,
    /// Socket: port for commands; 0 takes a free one.
    pub tcp_port: u16,
    /// Socket: where readings go.
    pub destination: std::net::SocketAddrV4,
}

impl Default for Emulated {
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

impl Emulated {
    /// With what it feels.
    pub fn with(self, body: Body) -> Box<dyn Emulator> {
        let wire: Box<dyn Wire> = match self.transport {
            Transport::Gen0 => Box::new(gen0::Gen0::new(&self)),
            Transport::GenA | Transport::Socket => Box::new(gen_a::GenA::new(&self)),
        };
        Box::new(sensor::Sensor::new(wire, self, body))
    }
}

/// What a generation of sensors makes of the bytes that it hears.
trait Wire: Send {
    /// Somebody opened the line.
    fn opened(&mut self, now_s: f64);
    /// Takes in bytes; what it answers is added to `answer`.
    fn hear(&mut self, bytes: &[u8], now_s: f64, answer: &mut Vec<u8>);
    /// Time passes: a start comes to its end, a command without an end is taken for whole.
    fn tick(&mut self, now_s: f64, answer: &mut Vec<u8>);
    /// Time between readings while it measures, s.
    fn period_s(&self) -> Option<f64>;
    /// Frames have the inertial unit.
    fn is_inertial(&self) -> bool;
    /// Offset, status bits: what the sensor itself makes of a reading.
    fn finish(&self, frame: &mut Frame);
}

/// A slow plausible motion for an emulator that runs alone: a tool of 0.4 kg being turned, and a slow pull.
pub fn slow_motion() -> Body {
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
