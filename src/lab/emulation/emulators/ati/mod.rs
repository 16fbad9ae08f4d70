//! An emulated Net F/T on this computer's network: records over UDP, and its page `netftapi2.xml` over HTTP.
//!
//! As with the real sensor, the newest client that asks for records receives them. Counts, units and rate are on the page.

pub(super) mod standalone;
#[cfg(test)]
mod tests;

use std::{io, net::SocketAddr};

use nima_devices::{
    ForceReading,
    ati::codec::{RdtCommand, RdtRecord},
};

use crate::emulators::{
    EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer,
    wires::{tcp, udp},
};

/// Function that returns the values that the sensor measures at a time, s since the emulator began.
pub type AtiBody = Box<dyn FnMut(f64) -> ForceReading + Send>;

/// Counts per newton and per newton metre, as on most real sensors.
const COUNTS: f64 = 1e6;
/// Measurements per second inside the sensor (ATI, 9620-05-NET FT).
const INSIDE_HZ: f64 = 7000.0;
/// Status of a sensor with a fault: the bit that summarises all of them.
const FAULTY: u32 = 0x8000_0000;
/// Maximum number of records made up after a pause; otherwise a paused process would flood its client.
const CATCH_UP: u32 = 50;
/// Maximum length of a request for a page, bytes.
const REQUEST_MAX: usize = 4096;

/// Properties of an emulated sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatedAti {
    pub serial: String,
    /// Records per second.
    pub rate_hz: f64,
    /// Ports; 0 selects a free one.
    pub rdt_port: u16,
    pub http_port: u16,
    /// Units on the page, in which the counts are given.
    pub units: [String; 2],
}

impl Default for EmulatedAti {
    fn default() -> Self {
        let units = ["N", "N-m"].map(str::to_owned);
        Self { serial: "FT00001".to_owned(), rate_hz: 1000.0, rdt_port: 0, http_port: 0, units }
    }
}

impl EmulatedAti {
    /// Makes the emulator with a source of values, N and Nm.
    pub fn with(self, body: AtiBody) -> Box<dyn Emulator> {
        let requests = Vec::new();
        Box::new(AtiSensor { of: self, body, client: None, number: 0, next_s: 0.0, frozen: None, requests })
    }

    fn page(&self) -> String {
        let Self { serial, rate_hz, units: [force, torque], .. } = self;
        let page = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<netft><prodname>Net F/T (emulated)</prodname><setserial>{serial}</setserial>\
             <setfwver>2.0</setfwver><cfgcpf>{COUNTS}</cfgcpf><cfgcpt>{COUNTS}</cfgcpt><scfgfu>{force}</scfgfu>\
             <scfgtu>{torque}</scfgtu><comrdte>Enabled</comrdte><comrdtrate>{rate_hz}</comrdtrate></netft>\n"
        );
        format!("HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\nContent-Length: {}\r\n\r\n{page}", page.len())
    }
}

struct AtiSensor {
    of: EmulatedAti,
    body: AtiBody,
    client: Option<SocketAddr>,
    /// Number of the newest record.
    number: u32,
    next_s: f64,
    frozen: Option<RdtRecord>,
    /// Incomplete requests of each connection.
    requests: Vec<(WirePeer, Vec<u8>)>,
}

impl AtiSensor {
    fn record(&mut self, now_s: f64, fault: EmulatedFault) -> RdtRecord {
        let ForceReading { wrench, .. } = (self.body)(now_s);
        let count = |value: f64| (value * COUNTS).clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        let [force_n, torque_nm] = [wrench.force_n, wrench.torque_nm];
        let values = [force_n.x, force_n.y, force_n.z, torque_nm.x, torque_nm.y, torque_nm.z];
        let measurement = (now_s * INSIDE_HZ) as u32;
        let status = if fault == EmulatedFault::DeviceFault { FAULTY } else { 0 };
        let record = RdtRecord { number: self.number, measurement, status, counts: values.map(count) };
        if fault == EmulatedFault::Freeze {
            return *self.frozen.get_or_insert(record);
        }
        self.frozen = None;
        record
    }

    fn ask_for_page(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        let Some(place) = self.requests.iter().position(|(peer, _)| *peer == from) else { return };
        let request = &mut self.requests[place].1;
        request.extend_from_slice(bytes);
        if request.windows(4).any(|end| end == b"\r\n\r\n") {
            let is_known = request.starts_with(b"GET /netftapi2.xml");
            request.clear();
            let answer = if is_known { self.of.page() } else { "HTTP/1.1 404 Not Found\r\n\r\n".to_owned() };
            if turn.fault != EmulatedFault::Silence {
                turn.send_unspoilt(from, answer.as_bytes());
            }
        } else if request.len() > REQUEST_MAX {
            request.clear();
        }
    }
}

impl Emulator for AtiSensor {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![udp(self.of.rdt_port), tcp(self.of.http_port)])
    }

    fn endpoint(&self, places: &[String]) -> String {
        let ports: Vec<&str> = places.iter().filter_map(|place| place.rsplit(':').next()).collect();
        format!("127.0.0.1 rdt={} http={}", ports[0], ports[1])
    }

    fn meet(&mut self, peer: WirePeer, _: &mut EmulatorTurn<'_>) {
        self.requests.push((peer, Vec::new()));
    }

    fn receive(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        let WirePeer::Address(client) = from else { return self.ask_for_page(from, bytes, turn) };
        match RdtCommand::decode(bytes) {
            Some(RdtCommand::StartRealTime) => {
                self.client = Some(client);
                self.number = 0;
                self.next_s = turn.now_s;
            }
            Some(RdtCommand::Stop) if self.client == Some(client) => self.client = None,
            Some(RdtCommand::Stop) | None => {}
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        let Some(client) = self.client else { return };
        let period_s = 1.0 / self.of.rate_hz;
        self.next_s = self.next_s.max(turn.now_s - f64::from(CATCH_UP) * period_s);
        while self.next_s <= turn.now_s {
            self.number = self.number.wrapping_add(1);
            let record = self.record(self.next_s, turn.fault).encode();
            self.next_s += period_s;
            // There is no checksum: a truncated datagram is the nearest equivalent.
            let is_cut = matches!(turn.fault, EmulatedFault::BadChecksum | EmulatedFault::WrongFrame);
            turn.send(WirePeer::Address(client), if is_cut { &record[..20] } else { &record });
        }
    }

    fn due_s(&self) -> Option<f64> {
        self.client.map(|_| self.next_s)
    }

    fn lose(&mut self, peer: WirePeer) {
        self.requests.retain(|(known, _)| *known != peer && peer != WirePeer::Everyone);
        if peer == WirePeer::Everyone {
            self.client = None;
        }
    }
}
