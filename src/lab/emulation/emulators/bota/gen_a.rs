//! The visible behaviour of the second generation's firmware: states and numbered parameters.
//!
//! Unknown for the real sensor and chosen here: it is idle until the start command, and continues after its client has
//! disconnected.

use nima_devices::bota::{
    codec::BotaFrame,
    gen_a::{INIT, MODE_INERTIAL, MODE_MAX, RATES_HZ, RUN, hex_of},
};

use super::{BotaWire, EmulatedBota};

#[derive(Debug)]
pub(super) struct GenA {
    state: u32,
    offset_bits: [u32; 6],
    temperature_bits: [u32; 6],
    mode: u32,
    submode: u32,
    output_rate: u32,
    destination: [u32; 4],
    destination_port: u32,
    texts: [String; 3],
    pending: Vec<u8>,
    received_s: f64,
}

/// A command without a terminator is complete after this much silence, s.
const IDLE_S: f64 = 0.020;
const COMMAND_BYTES: usize = 64;

// Status codes of an answer (reference, 1.3).
const WRONG_STATE: u32 = 1;
const SYNTAX: u32 = 2;
const READ_ONLY: u32 = 3;
const INVALID_VALUE: u32 = 16;
const UNKNOWN_PARAMETER: u32 = 18;
const UNKNOWN_PART: u32 = 19;

impl GenA {
    pub(super) fn new(emulated: &EmulatedBota) -> Self {
        let serial = format!("SN{:0>6}", emulated.serial);
        Self {
            state: INIT,
            offset_bits: [0; 6],
            temperature_bits: [0; 6],
            mode: 0,
            submode: 4,
            output_rate: 0,
            destination: emulated.destination.ip().octets().map(u32::from),
            destination_port: u32::from(emulated.destination.port()),
            texts: [&emulated.product, &serial, &emulated.firmware].map(|text| hex_of(text)),
            pending: Vec::new(),
            received_s: 0.0,
        }
    }

    fn command(&mut self, answer: &mut Vec<u8>) {
        let line = String::from_utf8_lossy(&self.pending).into_owned();
        self.pending.clear();
        let fields: Vec<&str> = line.split(',').collect();
        let (letters, report) = match fields[..] {
            ["wh", id, sub, value] => ("wh", self.write(id, sub, value)),
            ["rh", id, sub] | ["rh", id, sub, _] => ("rh", self.read(id, sub)),
            ["wh", ..] => ("wh", Err(SYNTAX)),
            ["rh", ..] => ("rh", Err(SYNTAX)),
            _ => return,
        };
        let (status, value) = report.map_or_else(|status| (status, "0".to_owned()), |value| (0, value));
        answer.extend(format!("{letters},{status},{value}\n").bytes());
    }

    fn read(&self, id: &str, sub: &str) -> Result<String, u32> {
        let id: u8 = id.parse().map_err(|_| SYNTAX)?;
        let sub: usize = sub.parse().map_err(|_| SYNTAX)?;
        let part = sub.checked_sub(1).ok_or(UNKNOWN_PART);
        let of = |values: &[u32]| part.and_then(|part| values.get(part).copied().ok_or(UNKNOWN_PART));
        let number = match (id, sub) {
            (1, 2) => Ok(self.state),
            (2, _) => of(&self.offset_bits),
            (3, _) => of(&[self.mode]),
            (4, _) => of(&[self.submode, RATES_HZ[self.submode as usize]]),
            (5, _) => of(&self.temperature_bits),
            (6, _) => of(&[self.output_rate]),
            (23..=25, 1) => return Ok(self.texts[usize::from(id - 23)].clone()),
            (30, _) => of(&self.destination),
            (31, _) => of(&[self.destination_port]),
            (1 | 23..=25, _) => Err(UNKNOWN_PART),
            _ => Err(UNKNOWN_PARAMETER),
        };
        number.map(|number| format!("{number:x}"))
    }

    fn write(&mut self, id: &str, sub: &str, value: &str) -> Result<String, u32> {
        let number = u32::from_str_radix(value, 16).map_err(|_| SYNTAX)?;
        // A parameter that cannot be read cannot be written either.
        self.read(id, sub)?;
        let id: u8 = id.parse().map_err(|_| SYNTAX)?;
        let sub: usize = sub.parse().map_err(|_| SYNTAX)?;
        if id != 1 && self.state == RUN {
            return Err(WRONG_STATE);
        }
        let (place, max) = match (id, sub) {
            (1, _) => (&mut self.state, RUN),
            (2, _) => (&mut self.offset_bits[sub - 1], u32::MAX),
            (3, _) => (&mut self.mode, u32::from(MODE_MAX)),
            (4, 1) => (&mut self.submode, RATES_HZ.len() as u32 - 1),
            (5, _) => (&mut self.temperature_bits[sub - 1], u32::MAX),
            (6, _) => (&mut self.output_rate, u32::MAX),
            (30, _) => (&mut self.destination[sub - 1], 255),
            (31, _) => (&mut self.destination_port, u32::from(u16::MAX)),
            _ => return Err(READ_ONLY),
        };
        if number > max {
            return Err(INVALID_VALUE);
        }
        *place = number;
        Ok(value.to_owned())
    }
}

impl BotaWire for GenA {
    fn opened(&mut self, _: f64) {
        self.pending.clear();
    }

    fn receive(&mut self, bytes: &[u8], now_s: f64, answer: &mut Vec<u8>) {
        for byte in bytes {
            match byte {
                b'\n' | 0 => self.command(answer),
                b'\r' => {}
                _ if self.pending.len() >= COMMAND_BYTES => self.pending.clear(),
                _ => self.pending.push(*byte),
            }
        }
        self.received_s = now_s;
    }

    fn tick(&mut self, now_s: f64, answer: &mut Vec<u8>) {
        if !self.pending.is_empty() && now_s - self.received_s > IDLE_S {
            self.command(answer);
        }
    }

    fn period_s(&self) -> Option<f64> {
        (self.state == RUN).then(|| 1.0 / f64::from(RATES_HZ[self.submode as usize]))
    }

    fn is_inertial(&self) -> bool {
        self.mode >= u32::from(MODE_INERTIAL)
    }

    fn finish(&self, frame: &mut BotaFrame) {
        let values = frame.force_n.iter_mut().chain(&mut frame.torque_nm);
        for (value, bits) in values.zip(self.offset_bits) {
            *value += f32::from_bits(bits);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_kept_and_refused_with_the_statuses_of_the_reference() {
        let mut wire = GenA::new(&EmulatedBota::default());
        let mut ask = |command: &str| {
            let mut answer = Vec::new();
            wire.receive(command.as_bytes(), 0.0, &mut answer);
            String::from_utf8(answer).unwrap()
        };
        assert_eq!(ask("wh,1,2,1\n"), "wh,0,1\n");
        assert_eq!(ask("wh,4,1,7\n"), "wh,0,7\n");
        assert_eq!(ask("rh,4,2,\0"), "rh,0,10e\n");
        assert_eq!(ask("rh,24,1,\n"), format!("rh,0,{}\n", hex_of("SN000853")));
        assert_eq!(ask("wh,3,1,4\n"), "wh,16,0\n");
        assert_eq!(ask("wh,4,2,4\n"), "wh,3,0\n");
        assert_eq!(ask("rh,99,1,\n"), "rh,18,0\n");
        assert_eq!(ask("rh,2,7,\n"), "rh,19,0\n");
        assert_eq!(ask("rh,2,0,\n"), "rh,19,0\n");
        assert_eq!(ask("wh,3,1,zz\n"), "wh,2,0\n");
        assert_eq!(ask("nonsense\n"), "");
        assert_eq!(ask("wh,1,2,2\n"), "wh,0,2\n");
        assert_eq!(ask("wh,3,1,0\n"), "wh,1,0\n", "not while it measures");
    }
}
