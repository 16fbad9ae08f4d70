//! Lists the servos on a bus without configuring them.

use std::time::{Duration, Instant};

use super::{FoundDevice, Probe};
use crate::{ConnectionState, DeviceError, DeviceIdentity, dynamixel};

#[derive(Debug)]
pub(super) struct BusProbe {
    port: String,
    baud: u32,
}

impl BusProbe {
    pub(super) fn new(port: &str, baud: u32) -> Self {
        Self { port: port.to_owned(), baud }
    }
}

impl Probe for BusProbe {
    fn name(&self) -> &str {
        &self.port
    }

    fn extra(&self) -> Duration {
        super::probes::SERVOS
    }

    fn probe(&mut self, _: Duration) -> Result<FoundDevice, DeviceError> {
        let begin = Instant::now();
        let servos = dynamixel::who_is_there(&self.port, self.baud)?;
        let model = |(id, number): &(u8, u16)| {
            let known = dynamixel::table::ServoModel::numbered(*number).map(|model| model.name.to_owned());
            known.ok_or_else(|| dynamixel::table::unsupported(format!("servo {id} on {}", self.port), *number))
        };
        let models = servos.iter().map(model).collect::<Result<Vec<_>, _>>()?;
        let list = |words: Vec<String>| words.join(" ");
        let identity = DeviceIdentity {
            product: list(models),
            serial: format!("ids {}", list(servos.iter().map(|(id, _)| id.to_string()).collect())),
            firmware: String::new(),
        };
        let latency_s = Some(begin.elapsed().as_secs_f64());
        Ok(FoundDevice { identity, standing: ConnectionState::Connected, latency_s, ..FoundDevice::default() })
    }
}
