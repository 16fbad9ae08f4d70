//! The module at the end of the arm: its expansion port, with nothing connected to it.

use nima_devices::kinova::messages::KinovaNumber;
use prost::Message;

use super::{
    forms::PortForm,
    interface::{AnswerPayload, INVALID_PARAM, InterfaceError, METHOD_TIMEOUT, UNSUPPORTED_METHOD, read},
    setting::KinovaSetting,
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
    ports: [KinovaSetting; 3],
    /// Configuration and value of each pin.
    pins: [(PortForm, u32); PINS],
}

impl Interconnect {
    pub(super) fn new() -> Self {
        let port = PortForm { identifier: 1, ..PortForm::default() };
        let first = |port: &PortForm| port.identifier == 1;
        let pin = |index| {
            (PortForm { identifier: index as u32 + 1, mode: INPUT, third: 1, fourth: LOW, ..PortForm::default() }, LOW)
        };
        Self {
            ports: [(1, 2), (3, 4), (9, 10)].map(|(get, set)| KinovaSetting::new(get, set, &port, first)),
            pins: std::array::from_fn(pin),
        }
    }

    pub(super) fn answer(&mut self, function: u16, payload: &[u8]) -> AnswerPayload {
        if let Some(answered) = self.ports.iter_mut().find_map(|port| port.answer(function, payload)) {
            return answered;
        }
        match function {
            5 => Ok(self.pin(payload)?.0.encode_to_vec()),
            6 => {
                let wanted = read::<PortForm>(payload)?;
                *self.pin(payload)? = (wanted, wanted.fourth);
                Ok(Vec::new())
            }
            7 => {
                let (port, value) = *self.pin(payload)?;
                let open = if port.third == PULL_UP { HIGH } else { LOW };
                let value = if port.mode == INPUT { open } else { value };
                Ok(PortForm { identifier: port.identifier, mode: value, ..PortForm::default() }.encode_to_vec())
            }
            8 => {
                let value = read::<PortForm>(payload)?.mode;
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

    fn pin(&mut self, payload: &[u8]) -> Result<&mut (PortForm, u32), InterfaceError> {
        let index = (read::<KinovaNumber>(payload)?.value as usize).wrapping_sub(1);
        self.pins.get_mut(index).ok_or(INVALID_PARAM)
    }
}
