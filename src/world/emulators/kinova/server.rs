//! Sockets and sessions of the emulated base.

use std::{
    net::{SocketAddr, TcpListener, UdpSocket},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use nima_devices::{
    kinova::{
        frame::{self, Frame, Header, PacketReader, REQUEST, RESPONSE},
        messages::{ERROR_SERVER, ErrorInfo, Rpc, sub},
        session::DATAGRAM_MAX,
    },
    transport::{Bytes as _, Tcp},
};
use prost::Message as _;

use super::{Body, EmulatedArm, calls::Base};
use crate::emulators::{EmulatedFault, FaultSwitch, FaultyLine};

/// Longest wait for a datagram: calls on TCP and the body go on at least so often.
const NAP: Duration = Duration::from_millis(1);

/// Who asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Link {
    Tcp(u64),
    Udp(SocketAddr),
}

struct Connection {
    number: u64,
    tcp: Tcp,
    packets: PacketReader,
}

pub(super) struct Server {
    listener: Option<TcpListener>,
    socket: Option<UdpSocket>,
    tcp_address: SocketAddr,
    udp_address: SocketAddr,
    connections: Vec<Connection>,
    accepted: u64,
    base: Base,
    faults: FaultSwitch,
    line: FaultyLine,
    peer: Option<SocketAddr>,
    frozen: Option<Vec<u8>>,
    begin: Instant,
}

impl Server {
    pub(super) fn new(
        listener: TcpListener,
        socket: UdpSocket,
        arm: EmulatedArm,
        body: Box<dyn Body>,
        faults: FaultSwitch,
    ) -> std::io::Result<Self> {
        listener.set_nonblocking(true)?;
        socket.set_read_timeout(Some(NAP))?;
        Ok(Self {
            tcp_address: listener.local_addr()?,
            udp_address: socket.local_addr()?,
            listener: Some(listener),
            socket: Some(socket),
            connections: Vec::new(),
            accepted: 0,
            base: Base::new(arm, body),
            faults,
            line: FaultyLine::default(),
            peer: None,
            frozen: None,
            begin: Instant::now(),
        })
    }

    pub(super) fn serve(mut self, stop: &AtomicBool) {
        let mut buffer = vec![0; DATAGRAM_MAX];
        while !stop.load(Ordering::Acquire) {
            let fault = self.faults.get();
            let now_s = self.begin.elapsed().as_secs_f64();
            self.base.advance(now_s, fault);
            self.open_or_close(fault);
            self.accept();
            self.serve_calls(now_s, fault);
            self.serve_cycle(&mut buffer, fault);
        }
    }

    /// Cut while the fault says so; at the same addresses afterwards.
    fn open_or_close(&mut self, fault: EmulatedFault) {
        if fault == EmulatedFault::Disconnect {
            (self.listener, self.socket) = (None, None);
            self.connections.clear();
            self.base.forget(|_| true);
            std::thread::sleep(NAP);
            return;
        }
        if self.listener.is_none() {
            let listener = TcpListener::bind(self.tcp_address);
            self.listener = listener.ok().filter(|listener| listener.set_nonblocking(true).is_ok());
        }
        if self.socket.is_none() {
            let socket = UdpSocket::bind(self.udp_address);
            self.socket = socket.ok().filter(|socket| socket.set_read_timeout(Some(NAP)).is_ok());
        }
    }

    fn accept(&mut self) {
        let Some(Ok((stream, _))) = self.listener.as_ref().map(TcpListener::accept) else { return };
        stream.set_nodelay(true).ok();
        if let Ok(tcp) = Tcp::of(stream) {
            self.accepted += 1;
            self.connections.push(Connection { number: self.accepted, tcp, packets: PacketReader::default() });
        }
    }

    fn serve_calls(&mut self, now_s: f64, fault: EmulatedFault) {
        let base = &mut self.base;
        let mut gone = Vec::new();
        // What happened before these calls; what they begin is told in the next turn, behind their answers.
        let mut notices = base.notices();
        if fault == EmulatedFault::Silence {
            notices.clear();
        }
        for connection in &mut self.connections {
            let Connection { number, tcp, packets } = connection;
            let link = Link::Tcp(*number);
            let mut alive = tcp.receive(packets.room()).map(|count| packets.took(count)).is_ok();
            while let Some(asked) = packets.next_frame() {
                let (header, payload) = answer(base, link, &asked, now_s, fault);
                if fault == EmulatedFault::Silence {
                    continue;
                }
                let mut out = Vec::new();
                frame::packed(&mut out, |out| frame::encode_written(&header, &payload, out));
                alive &= tcp.send(&out).is_ok();
            }
            for notice in notices.iter().filter(|notice| notice.link == link) {
                let mut out = Vec::new();
                frame::packed(&mut out, |out| frame::encode_written(&notice.header, &notice.payload, out));
                alive &= tcp.send(&out).is_ok();
            }
            if !alive {
                gone.push(*number);
            }
        }
        self.connections.retain(|connection| !gone.contains(&connection.number));
        if !gone.is_empty() {
            self.base.forget(|link| matches!(link, Link::Tcp(number) if gone.contains(&number)));
        }
    }

    /// Waits for one datagram only, so that calls and the switch of faults are never far away.
    fn serve_cycle(&mut self, buffer: &mut [u8], fault: EmulatedFault) {
        let Some(socket) = &self.socket else { return };
        let received = socket.recv_from(buffer);
        let now_s = self.begin.elapsed().as_secs_f64();
        let mut out = Vec::new();
        if let Ok((count, peer)) = received {
            self.peer = Some(peer);
            self.base.advance(now_s, fault);
            if let Ok(asked) = Frame::decode(&buffer[..count]) {
                out = self.datagram(Link::Udp(peer), &asked, now_s, fault);
            }
        }
        let (Some(socket), Some(peer)) = (&self.socket, self.peer) else { return };
        self.line.pass(now_s, &out, fault, &mut |bytes| {
            socket.send_to(bytes, peer).ok();
        });
    }

    /// The answer on the cyclic connection, spoilt as the fault has it.
    fn datagram(&mut self, link: Link, asked: &Frame<'_>, now_s: f64, fault: EmulatedFault) -> Vec<u8> {
        let (mut header, payload) = answer(&mut self.base, link, asked, now_s, fault);
        let cyclic = header.service == Rpc::REFRESH.service && header.error == 0;
        if cyclic && fault == EmulatedFault::WrongFrame {
            header.kind = 7;
        }
        let mut out = Vec::new();
        frame::encode_written(&header, &payload, &mut out);
        if !cyclic {
            return out;
        }
        match fault {
            // There is no checksum; a datagram cut short is the nearest.
            EmulatedFault::BadChecksum => out.truncate(out.len() - 1),
            EmulatedFault::Freeze => return self.frozen.get_or_insert(out).clone(),
            _ => self.frozen = None,
        }
        out
    }
}

/// Header and payload of the answer to a frame.
fn answer(base: &mut Base, link: Link, asked: &Frame<'_>, now_s: f64, fault: EmulatedFault) -> (Header, Vec<u8>) {
    let answered = if asked.header.kind == REQUEST {
        base.answer(link, asked, now_s, fault)
    } else {
        Err((ERROR_SERVER, sub::UNSUPPORTED_FRAME))
    };
    let mut header = Header { kind: RESPONSE, ..asked.header };
    match answered {
        Ok((session, payload)) => {
            header.session = session;
            (header, payload)
        }
        Err((error, code)) => {
            (header.error, header.sub_error) = (error, code);
            let text = sub::words(code).to_owned();
            let told = ErrorInfo { code: u32::from(error), sub_code: u32::from(code), text };
            (header, told.encode_to_vec())
        }
    }
}
