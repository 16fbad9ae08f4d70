//! An emulated sensor in the network: commands over TCP from one client at a time, readings as datagrams to a fixed address.

use std::{
    io,
    net::{Ipv4Addr, SocketAddrV4, TcpListener, UdpSocket},
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use super::{Body, Emulated, Wire as _, frames::Frames, gen_a::GenA};
use crate::device::{
    emulation::{EmulatedFault, FaultSwitch, Serving, places},
    transport::{Bytes as _, Tcp},
};

const NAP: Duration = Duration::from_micros(300);

pub(super) fn serve(emulated: &Emulated, faults: FaultSwitch, body: Body) -> io::Result<Serving> {
    let listener = listen(SocketAddrV4::new(Ipv4Addr::LOCALHOST, emulated.tcp_port))?;
    let address = listener.local_addr()?;
    let stream = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
    stream.set_nonblocking(true)?;
    let mut sensor = Sensor {
        wire: GenA::new(emulated),
        frames: Frames::new(body, emulated.first_timestamp_us, emulated.status),
        stream,
        destination: emulated.destination,
        client: None,
        begin: Instant::now(),
    };
    let switch = faults.clone();
    Serving::start(address.to_string(), faults, move |stop| {
        let mut listener = Some(listener);
        while !stop.load(Ordering::Acquire) {
            let fault = switch.get();
            if fault == EmulatedFault::Disconnect {
                (listener, sensor.client) = (None, None);
            } else if let Some(listener) = &listener {
                sensor.exchange(listener, fault);
            } else if let std::net::SocketAddr::V4(address) = address {
                listener = listen(address).ok();
            }
            std::thread::sleep(NAP);
        }
    })
}

fn listen(address: SocketAddrV4) -> io::Result<TcpListener> {
    let listener = places::taken(address.port(), "TCP", TcpListener::bind(address))?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

struct Sensor {
    wire: GenA,
    frames: Frames,
    stream: UdpSocket,
    destination: SocketAddrV4,
    client: Option<Tcp>,
    begin: Instant,
}

impl Sensor {
    fn exchange(&mut self, listener: &TcpListener, fault: EmulatedFault) {
        let now_s = self.begin.elapsed().as_secs_f64();
        if self.client.is_none()
            && let Ok((stream, _)) = listener.accept()
        {
            self.client = Tcp::of(stream).ok();
            self.wire.opened(now_s);
        }
        let mut answer = Vec::new();
        if let Some(client) = &mut self.client {
            let mut buffer = [0; 256];
            match client.receive(&mut buffer) {
                Ok(count) => self.wire.hear(&buffer[..count], now_s, &mut answer),
                Err(_) => self.client = None,
            }
        }
        self.wire.tick(now_s, &mut answer);
        if let Some(client) = &mut self.client
            && !answer.is_empty()
            && fault != EmulatedFault::Silence
        {
            client.send(&answer).ok();
        }
        // A closed port of the client answers with an error that concerns nobody here.
        let (stream, destination) = (&self.stream, self.destination);
        self.frames.due(now_s, &self.wire, fault, &mut |bytes| {
            stream.send_to(bytes, destination).ok();
        });
    }
}
