//! The visible behaviour of the first generation's firmware: start, modes, one-letter commands.
//!
//! Unknown for the real sensor and chosen here: every command in a wrong mode and every value out of range is answered
//! with code 1.

use nima_devices::bota::{
    codec::BotaFrame,
    gen0::{COMMAND_BYTES, SINC, rate_hz},
};

use super::{BotaWire, EmulatedBota};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Gen0Mode {
    /// Starting; does not receive until then, s.
    Booting(f64),
    Init,
    Config,
    Run,
}

#[derive(Clone, Copy, Debug)]
struct Gen0Config {
    sinc: u16,
    offset: [f32; 6],
}

#[derive(Debug)]
pub(super) struct Gen0 {
    mode: Gen0Mode,
    config: Gen0Config,
    saved: Gen0Config,
    pending: Vec<u8>,
    received_s: f64,
    boot_s: f64,
    raw_starts: u32,
    raw: bool,
    product: String,
    serial: String,
    firmware: String,
}

/// A command with parameters has no terminator; it is complete after this much silence, s. Longer than the gap between
/// two bytes at the slowest line speed, so that a command is not cut in two.
const IDLE_S: f64 = 0.020;
/// Raw gauge value per newton without the calibration, approximately.
const RAW_PER_UNIT: f32 = 4321.0;

impl Gen0 {
    pub(super) fn new(emulated: &EmulatedBota) -> Self {
        let config = Gen0Config { sinc: 512, offset: [0.0; 6] };
        Self {
            mode: Gen0Mode::Init,
            config,
            saved: config,
            pending: Vec::new(),
            received_s: 0.0,
            boot_s: emulated.boot_s,
            raw_starts: emulated.raw_starts,
            raw: false,
            product: emulated.product.clone(),
            serial: emulated.serial.clone(),
            firmware: emulated.firmware.clone(),
        }
    }

    fn start(&mut self) {
        self.config = self.saved;
        self.raw = self.raw_starts > 0;
        self.raw_starts = self.raw_starts.saturating_sub(1);
    }

    fn letter(&mut self, letter: u8, now_s: f64, answer: &mut Vec<u8>) {
        let good = match letter {
            b'C' => {
                self.mode = Gen0Mode::Config;
                true
            }
            b'R' => {
                self.mode = Gen0Mode::Run;
                true
            }
            b'I' => {
                self.start();
                self.mode = Gen0Mode::Init;
                true
            }
            b'#' => {
                self.opened(now_s);
                return;
            }
            b's' if self.mode == Gen0Mode::Config => {
                self.saved = self.config;
                true
            }
            b'l' if self.mode == Gen0Mode::Config => {
                self.config = self.saved;
                true
            }
            _ => false,
        };
        acknowledge(letter, good, answer);
    }

    /// Handles a command with parameters.
    fn command(&mut self, answer: &mut Vec<u8>) {
        let line = String::from_utf8_lossy(&self.pending).into_owned();
        self.pending.clear();
        let Some(letter) = line.bytes().next() else { return };
        if line == "p?" {
            // The two fields between are unknown.
            answer.extend(format!("p,0,{},0,0,{}\r\n", self.serial, self.product).bytes());
            acknowledge(b'p', self.mode == Gen0Mode::Config, answer);
            return;
        }
        let values: Option<Vec<f32>> = line.split(',').skip(1).map(|field| field.parse().ok()).collect();
        let good = self.mode == Gen0Mode::Config && values.is_some_and(|values| self.set(letter, &values));
        acknowledge(letter, good, answer);
    }

    fn set(&mut self, letter: u8, values: &[f32]) -> bool {
        match (letter, values) {
            (b'f', [sinc, _, _, _]) if sinc.fract() == 0.0 && SINC.contains(&(*sinc as u16)) => {
                self.config.sinc = *sinc as u16;
                true
            }
            (b'b', offset) if offset.iter().all(|x| x.is_finite()) => match offset.try_into() {
                Ok(offset) => {
                    self.config.offset = offset;
                    true
                }
                Err(_) => false,
            },
            // It supports only binary frames with the calibration applied.
            (b'c', [_, calibrated, format, index]) => {
                *calibrated > 0.5 && format.abs() < 0.5 && (0.0..=5.0).contains(index)
            }
            (b'm', [_, _, _, _, _, _]) => true,
            _ => false,
        }
    }
}

fn acknowledge(letter: u8, good: bool, answer: &mut Vec<u8>) {
    answer.extend(format!("r,0,{},{}\r\n", char::from(letter), u8::from(!good)).bytes());
}

impl BotaWire for Gen0 {
    fn opened(&mut self, now_s: f64) {
        self.mode = Gen0Mode::Booting(now_s + self.boot_s);
        self.pending.clear();
    }

    fn receive(&mut self, bytes: &[u8], now_s: f64, answer: &mut Vec<u8>) {
        if matches!(self.mode, Gen0Mode::Booting(_)) {
            return;
        }
        for byte in bytes {
            match byte {
                b'\r' | b'\n' => self.command(answer),
                b'C' | b'R' | b'I' | b'#' | b's' | b'l' | b'w' if self.pending.is_empty() => {
                    self.letter(*byte, now_s, answer);
                }
                b'c' | b'f' | b'b' | b'm' | b'p' if self.pending.is_empty() => self.pending.push(*byte),
                _ if self.pending.is_empty() => {}
                _ if self.pending.len() >= COMMAND_BYTES => self.pending.clear(),
                _ => self.pending.push(*byte),
            }
        }
        self.received_s = now_s;
    }

    fn tick(&mut self, now_s: f64, answer: &mut Vec<u8>) {
        match self.mode {
            Gen0Mode::Booting(until_s) if now_s >= until_s => {
                self.start();
                self.mode = Gen0Mode::Run;
                let name = &self.product;
                let serial = &self.serial;
                let firmware = &self.firmware;
                answer
                    .extend(format!("App Init\r\nname: {name}\r\nS/N: {serial}\r\nFW version: {firmware}\r\n").bytes());
            }
            _ if !self.pending.is_empty() && now_s - self.received_s > IDLE_S => self.command(answer),
            _ => {}
        }
    }

    fn period_s(&self) -> Option<f64> {
        (self.mode == Gen0Mode::Run).then(|| 1.0 / rate_hz(self.config.sinc))
    }

    fn is_inertial(&self) -> bool {
        false
    }

    fn finish(&self, frame: &mut BotaFrame) {
        let values = frame.force_n.iter_mut().chain(&mut frame.torque_nm);
        for (value, offset) in values.zip(self.config.offset) {
            *value = if self.raw { *value * RAW_PER_UNIT } else { *value + offset };
        }
        if self.raw {
            frame.status |= 1 << 3;
        }
    }
}
