//! One end of the stream on the virtual clock: the endpoint's work without a socket.

use nima_machine::remote::RemoteWire;
use nima_network::{
    endpoint::ALIVE_S,
    stream::{NetworkStream, SendResult},
    wire::DATAGRAM_MAX,
};

/// A stream as the loop's link. Its datagrams wait in `out` until the bench takes them.
#[derive(Debug)]
pub(super) struct NetworkEnd {
    pub(super) stream: Box<NetworkStream>,
    pub(super) out: Vec<Vec<u8>>,
    /// Tick of the run.
    pub(super) tick: u32,
    /// When each payload was sent.
    pub(super) sent: Vec<u32>,
    /// Numbers of the payloads delivered in this tick.
    pub(super) taken: Vec<u64>,
    /// When a clock step was detected.
    pub(super) stepped: Option<u32>,
    sent_s: f64,
    datagram: [u8; DATAGRAM_MAX],
}

impl NetworkEnd {
    pub(super) fn new(stream: NetworkStream) -> Self {
        Self {
            stream: Box::new(stream),
            out: Vec::new(),
            tick: 0,
            sent: Vec::new(),
            taken: Vec::new(),
            stepped: None,
            sent_s: f64::MIN,
            datagram: [0; DATAGRAM_MAX],
        }
    }

    /// Processes a datagram that arrived at this time of this machine's clock, s.
    pub(super) fn arrive(&mut self, datagram: &[u8], came_s: f64) {
        // The link creates some duplicates; they are rejected.
        let accepted = self.stream.receive(datagram, came_s);
        if accepted.is_ok_and(|accepted| accepted.step.is_some()) {
            self.stepped.get_or_insert(self.tick);
        }
    }

    fn put(&mut self, now_s: f64, payload: Option<&[u8]>) {
        if let SendResult::Datagram(len) = self.stream.send(now_s, payload, 0, &mut self.datagram) {
            self.sent_s = now_s;
            self.out.push(self.datagram[..len].to_vec());
        }
    }
}

impl RemoteWire for NetworkEnd {
    fn send(&mut self, now_s: f64, message: &[u8]) {
        self.put(now_s, Some(message));
        self.sent.resize(self.stream.payloads() as usize, self.tick);
    }

    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8])) {
        if now_s - self.sent_s >= ALIVE_S {
            self.put(now_s, None);
        }
        self.stream.advance(now_s);
        self.taken.clear();
        while let Some(payload) = self.stream.take(now_s) {
            self.taken.push(payload.number);
            take(payload.bytes);
        }
    }
}
