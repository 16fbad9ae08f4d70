//! Raw UDP: the lower limit for every engine.

use std::net::UdpSocket;

use crate::{Engine, HERE, Outcome, PORT, THERE, now_ns};

pub(crate) struct Raw(UdpSocket);

impl Raw {
    pub(crate) fn open(sends: bool) -> Outcome<Self> {
        let socket = UdpSocket::bind((if sends { HERE } else { THERE }, PORT))?;
        socket.set_nonblocking(true)?;
        Ok(Self(socket))
    }
}

impl Engine for Raw {
    fn is_ready(&mut self) -> bool {
        true
    }

    fn send(&mut self, payload: &[u8]) {
        self.0.send_to(payload, (THERE, PORT)).ok();
    }

    fn poll(&mut self, got: &mut dyn FnMut(&[u8], u64)) {
        let mut buffer = [0; 2048];
        while let Ok(len) = self.0.recv(&mut buffer) {
            got(&buffer[..len], now_ns());
        }
    }
}
