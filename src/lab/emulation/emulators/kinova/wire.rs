//! The emulated base on its interfaces: calls over TCP, the cycle over UDP.

use std::io;

use nima_devices::kinova::{
    frame::{self, KinovaFrame, KinovaHeader, PacketReader, REQUEST, RESPONSE},
    messages::{ERROR_SERVER, ErrorInfo, Rpc, sub},
};
use prost::Message as _;

use super::{EmulatedKinova, KinovaBody, calls::Base};
use crate::emulators::{
    EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer,
    wires::{tcp, udp},
};

pub(super) struct KinovaServer {
    base: Base,
    /// Data received from each connection.
    packets: Vec<(WirePeer, PacketReader)>,
    frozen: Option<Vec<u8>>,
}

impl KinovaServer {
    pub(super) fn new(arm: EmulatedKinova, body: Box<dyn KinovaBody>) -> Self {
        Self { base: Base::new(arm, body), packets: Vec::new(), frozen: None }
    }

    fn calls(&mut self, from: WirePeer, mut bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        let Some((_, packets)) = self.packets.iter_mut().find(|(peer, _)| *peer == from) else { return };
        while !bytes.is_empty() {
            let room = packets.room();
            let (now, later) = bytes.split_at(bytes.len().min(room.len()));
            room[..now.len()].copy_from_slice(now);
            packets.filled(now.len());
            bytes = later;
            while let Some(asked) = packets.next_frame() {
                let (header, payload) = answer(&mut self.base, from, &asked, turn.now_s, turn.fault);
                send_packed(from, &header, &payload, turn);
            }
        }
    }

    /// Returns the answer on the cyclic connection, modified by the fault.
    fn datagram(&mut self, from: WirePeer, asked: &KinovaFrame<'_>, turn: &EmulatorTurn<'_>) -> Vec<u8> {
        let (mut header, payload) = answer(&mut self.base, from, asked, turn.now_s, turn.fault);
        let cyclic = header.service == Rpc::REFRESH.service && header.error == 0;
        if cyclic && turn.fault == EmulatedFault::WrongFrame {
            header.kind = 7;
        }
        let mut out = Vec::new();
        frame::encode_written(&header, &payload, &mut out);
        if !cyclic {
            return out;
        }
        match turn.fault {
            // There is no checksum; a truncated datagram is the nearest equivalent.
            EmulatedFault::BadChecksum => out.truncate(out.len() - 1),
            EmulatedFault::Freeze => return self.frozen.get_or_insert(out).clone(),
            _ => self.frozen = None,
        }
        out
    }
}

/// Over TCP, where bytes are neither lost nor late.
fn send_packed(to: WirePeer, header: &KinovaHeader, payload: &[u8], turn: &mut EmulatorTurn<'_>) {
    if turn.fault != EmulatedFault::Silence {
        let mut out = Vec::new();
        frame::packed(&mut out, |out| frame::encode_written(header, payload, out));
        turn.send_unspoilt(to, &out);
    }
}

impl Emulator for KinovaServer {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![tcp(self.base.arm.tcp_port), udp(self.base.arm.udp_port)])
    }

    fn endpoint(&self, places: &[String]) -> String {
        let ports: Vec<&str> = places.iter().filter_map(|place| place.rsplit(':').next()).collect();
        format!("127.0.0.1 tcp={} udp={}", ports[0], ports[1])
    }

    fn meet(&mut self, peer: WirePeer, _: &mut EmulatorTurn<'_>) {
        self.packets.push((peer, PacketReader::default()));
    }

    fn receive(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        self.base.advance(turn.now_s, turn.fault);
        if !matches!(from, WirePeer::Address(_)) {
            self.calls(from, bytes, turn);
        } else if let Ok(asked) = KinovaFrame::decode(bytes) {
            let out = self.datagram(from, &asked, turn);
            turn.send(from, &out);
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        self.base.advance(turn.now_s, turn.fault);
        // Notifications about a call follow its answer.
        for notice in self.base.notices() {
            send_packed(notice.link, &notice.header, &notice.payload, turn);
        }
    }

    fn lose(&mut self, peer: WirePeer) {
        let gone = |link| peer == WirePeer::Everyone || peer == link;
        self.packets.retain(|(link, _)| !gone(*link));
        self.base.forget(gone);
    }
}

/// Returns header and payload of the answer to a frame.
fn answer(
    base: &mut Base,
    link: WirePeer,
    asked: &KinovaFrame<'_>,
    now_s: f64,
    fault: EmulatedFault,
) -> (KinovaHeader, Vec<u8>) {
    let answered = if asked.header.kind == REQUEST {
        base.answer(link, asked, now_s, fault)
    } else {
        Err((ERROR_SERVER, sub::UNSUPPORTED_FRAME))
    };
    let mut header = KinovaHeader { kind: RESPONSE, ..asked.header };
    match answered {
        Ok((session, payload)) => {
            header.session = session;
            (header, payload)
        }
        Err((error, code)) => {
            header.error = error;
            header.sub_error = code;
            let text = sub::words(code).to_owned();
            let report = ErrorInfo { code: u32::from(error), sub_code: u32::from(code), text };
            (header, report.encode_to_vec())
        }
    }
}
