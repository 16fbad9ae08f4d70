//! An emulated sensor in the network: commands over TCP from one client at a time, readings as datagrams to a fixed address.
//!
//! A client holds the line once a command of its was answered. Until then the next one takes its place, and one that sends much and
//! asks nothing is cut off: whatever else knocks at the port keeps no client waiting.

use std::{
    io,
    net::{Ipv4Addr, SocketAddrV4, TcpListener, UdpSocket},
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use nima_devices::transport::{Bytes as _, Tcp};

use super::{Body, Emulated, Wire as _, frames::Frames, gen_a::GenA};
use crate::emulators::{EmulatedFault, FaultSwitch, Serving, places};

const NAP: Duration = Duration::from_micros(300);
/// Taken from a client in one turn, bytes.
const TURN_BYTES: usize = 4096;
/// Without a command among so many bytes what a client sends is garbage.
const GARBAGE_BYTES: usize = 4096;

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

/// Who asks.
struct Client {
    tcp: Tcp,
    /// A command of its was answered.
    known: bool,
    /// Bytes since the last one that was.
    unanswered: usize,
}

struct Sensor {
    wire: GenA,
    frames: Frames,
    stream: UdpSocket,
    destination: SocketAddrV4,
    client: Option<Client>,
    begin: Instant,
}

impl Sensor {
    fn exchange(&mut self, listener: &TcpListener, fault: EmulatedFault) {
        let now_s = self.begin.elapsed().as_secs_f64();
        if self.client.as_ref().is_none_or(|client| !client.known)
            && let Ok((stream, _)) = listener.accept()
        {
            self.client = Tcp::of(stream).ok().map(|tcp| Client { tcp, known: false, unanswered: 0 });
            self.wire.opened(now_s);
        }
        let mut answer = Vec::new();
        let mut alive = true;
        if let Some(client) = &mut self.client {
            let mut buffer = [0; TURN_BYTES];
            match client.tcp.receive(&mut buffer) {
                Ok(count) => {
                    self.wire.hear(&buffer[..count], now_s, &mut answer);
                    client.unanswered += count;
                }
                Err(_) => alive = false,
            }
        }
        self.wire.tick(now_s, &mut answer);
        if let Some(client) = &mut self.client {
            if !answer.is_empty() {
                (client.known, client.unanswered) = (true, 0);
                // One that does not take its answers is gone, or asks for the asking's sake.
                alive &= fault == EmulatedFault::Silence || client.tcp.send(&answer).is_ok();
            }
            alive &= client.unanswered < GARBAGE_BYTES;
        }
        if !alive {
            self.client = None;
        }
        // A closed port of the client answers with an error that concerns nobody here.
        let (stream, destination) = (&self.stream, self.destination);
        self.frames.due(now_s, &self.wire, fault, &mut |bytes| {
            stream.send_to(bytes, destination).ok();
        });
    }
}

#[cfg(test)]
mod tests {
    use std::{
        io::{ErrorKind, Read as _, Write as _},
        net::TcpStream,
    };

    use super::*;
    use crate::emulators::bota::slow_motion;

    /// Whoever is served gets its answer within milliseconds; this is for machines that are busy with others.
    const LONG: Duration = Duration::from_secs(20);

    fn sensor() -> Serving {
        let emulated = Emulated { tcp_port: 0, ..Emulated::default() };
        serve(&emulated, FaultSwitch::default(), slow_motion()).unwrap()
    }

    fn client(serving: &Serving) -> TcpStream {
        let stream = TcpStream::connect(&serving.endpoint).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream
    }

    /// Asks for the state, and waits for the answer.
    fn ask(client: &mut TcpStream) -> std::io::Result<String> {
        client.write_all(b"rh,1,2,\n")?;
        let mut buffer = [0; 64];
        let count = client.read(&mut buffer)?;
        Ok(String::from_utf8_lossy(&buffer[..count]).into_owned())
    }

    #[test]
    fn neither_garbage_nor_silence_keeps_the_next_client_waiting() {
        let serving = sensor();
        let mut garbage = client(&serving);
        garbage.set_nonblocking(true).unwrap();
        let mut random = fastrand::Rng::with_seed(3);
        let noise: Vec<u8> = (0..65536).map(|_| random.u8(..)).collect();
        // As much as the connection takes, and it stays open.
        let mut sent = 0;
        let stopped = loop {
            match garbage.write(&noise) {
                Ok(count) if sent < 64 << 20 => sent += count,
                Ok(_) => panic!("the emulator takes in everything"),
                Err(error) => break error.kind(),
            }
        };
        println!("{sent} bytes of garbage, then {stopped:?}");
        assert_eq!(ask(&mut client(&serving)).unwrap(), "rh,0,0\n");
        let silent = client(&serving);
        assert_eq!(ask(&mut client(&serving)).unwrap(), "rh,0,0\n");
        drop(silent);
    }

    #[test]
    fn a_client_that_was_answered_is_not_pushed_aside() {
        let serving = sensor();
        let mut first = client(&serving);
        assert_eq!(ask(&mut first).unwrap(), "rh,0,0\n");
        let mut second = client(&serving);
        second.write_all(b"rh,1,2,\n").unwrap();
        for _ in 0..20 {
            assert_eq!(ask(&mut first).unwrap(), "rh,0,0\n");
        }
        drop(first);
        let mut buffer = [0; 64];
        let count = second.read(&mut buffer).unwrap();
        assert_eq!(&buffer[..count], b"rh,0,0\n", "it is the next one's turn");
    }

    #[test]
    fn a_client_that_takes_no_answers_is_cut_off() {
        let serving = sensor();
        let mut deaf = client(&serving);
        deaf.set_write_timeout(Some(LONG)).unwrap();
        let questions = b"rh,24,1,\n".repeat(1000);
        let cut = std::iter::repeat_with(|| deaf.write(&questions)).take(7000).find_map(Result::err);
        let kind = cut.map(|error| error.kind());
        assert!(matches!(kind, Some(ErrorKind::ConnectionReset | ErrorKind::BrokenPipe)), "{kind:?}");
    }
}
