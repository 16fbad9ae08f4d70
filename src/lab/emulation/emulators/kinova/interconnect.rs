//! The module at the end of the arm: its expansion port, with nothing connected to it.

use nima_devices::kinova::messages::Number;
use prost::Message;

use super::{
    forms::Port,
    interface::{Answered, INVALID_PARAM, METHOD_TIMEOUT, Refused, UNSUPPORTED_METHOD, read},
    setting::Setting,
};

const PINS: usize = 4;
/// `GPIOMode`: the first is an input, the others are outputs.
const INPUT: u32 = 1;
/// `GPIOPull`.
const PULL_UP: u32 = 2;
/// `GPIOValue`.
const LOW: u32 = 1;
const HIGH: u32 = 2;

pub(super) struct Interconnect {
    /// UART, Ethernet and I2C.
    ports: [Setting; 3],
    /// Configuration and value of each pin.
    pins: [(Port, u32); PINS],
}

impl Interconnect {
    pub(super) fn new() -> Self {
        let port = Port { identifier: 1, ..Port::default() };
        let first = |port: &Port| port.identifier == 1;
        let pin =
            |index| (Port { identifier: index as u32 + 1, mode: INPUT, third: 1, fourth: LOW, ..Port::default() }, LOW);
        Self {
            ports: [(1, 2), (3, 4), (9, 10)].map(|(get, set)| Setting::new(get, set, &port, first)),
            pins: std::array::from_fn(pin),
        }
    }

    pub(super) fn answer(&mut self, function: u16, payload: &[u8]) -> Answered {
        if let Some(answered) = self.ports.iter_mut().find_map(|port| port.answer(function, payload)) {
            return answered;
        }
        match function {
            5 => Ok(self.pin(payload)?.0.encode_to_vec()),
            6 => {
                let wanted = read::<Port>(payload)?;
                *self.pin(payload)? = (wanted, wanted.fourth);
                Ok(Vec::new())
            }
            7 => {
                let (port, value) = *self.pin(payload)?;
                let open = if port.third == PULL_UP { HIGH } else { LOW };
                let value = if port.mode == INPUT { open } else { value };
                Ok(Port { identifier: port.identifier, mode: value, ..Port::default() }.encode_to_vec())
            }
            8 => {
                let value = read::<Port>(payload)?.mode;
                let pin = self.pin(payload)?;
                if pin.0.mode == INPUT || !matches!(value, LOW | HIGH) {
                    return Err(INVALID_PARAM);
                }
                pin.1 = value;
                Ok(Vec::new())
            }
            // Nothing on the I2C bus answers.
            11..=14 => Err(METHOD_TIMEOUT),
            _ => Err(UNSUPPORTED_METHOD),
        }
    }

    fn pin(&mut self, payload: &[u8]) -> Result<&mut (Port, u32), Refused> {
        let index = (read::<Number>(payload)?.value as usize).wrapping_sub(1);
        self.pins.get_mut(index).ok_or(INVALID_PARAM)
    }
}
