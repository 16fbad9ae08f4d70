//! Serves the pictures: one answer that never ends for everyone who asks, as parts over HTTP or as packets over RTSP.

use std::{collections::VecDeque, io};

use nima_endoscope::{
    h264::{self, Encoder},
    jpeg,
};

use super::{
    Emulated,
    pipe::Pipe,
    rtsp::{self, Reply},
    shot::{Shot, Shown, Studio},
};
use crate::emulators::{
    EmulatedFault, Emulator, Peer, Turn,
    wires::{End, tcp},
};

/// Longest request that is read.
const REQUEST_MOST: usize = 8 << 10;
/// How late a late picture leaves, s.
const LATE_S: f64 = 0.4;
const BOUNDARY: &str = "nima-endoscope";
/// What a browser or a player asks for.
const PATHS: [&str; 4] = ["/", "/stream", "/stream.mjpg", "/?action=stream"];

pub(super) struct Endoscope {
    emulated: Emulated,
    studio: Studio,
    /// For all who watch over RTSP; made when the first one does.
    encoder: Option<Encoder>,
    /// The next picture is one with which a player can begin.
    wants_key: bool,
    pipe: Option<Pipe>,
    clients: Vec<Client>,
    due_s: f64,
    /// When each late picture leaves, s.
    late: VecDeque<(f64, Sent)>,
}

struct Client {
    peer: Peer,
    request: Vec<u8>,
    watches: Watches,
}

enum Watches {
    /// It has not asked yet.
    Nothing,
    Parts,
    Packets(rtsp::Session),
}

/// A picture on its way, as those who watch want it.
#[derive(Default)]
struct Sent {
    part: Vec<u8>,
    unit: Vec<u8>,
    since: std::time::Duration,
}

impl Client {
    fn wants_unit(&self) -> bool {
        matches!(&self.watches, Watches::Packets(session) if session.plays)
    }
}

impl Endoscope {
    pub(super) fn new(emulated: Emulated, shown: Shown) -> Self {
        let studio = Studio::new(emulated.clone(), shown);
        let (clients, late) = (Vec::new(), VecDeque::new());
        Self { emulated, studio, encoder: None, wants_key: true, pipe: None, clients, due_s: 0.0, late }
    }

    fn is_watched(&self) -> bool {
        let watches = |client: &Client| client.wants_unit() || matches!(client.watches, Watches::Parts);
        self.pipe.is_some() || self.clients.iter().any(watches)
    }

    /// The picture of this time.
    fn take(&mut self, now_s: f64, fault: EmulatedFault) -> Sent {
        let is_frozen = fault == EmulatedFault::Freeze;
        let shot = if is_frozen { self.studio.again(now_s) } else { self.studio.take(now_s, fault) };
        if let Some(pipe) = &self.pipe {
            pipe.send(&shot, fault);
        }
        let mut sent = Sent { since: shot.since, ..Sent::default() };
        if self.clients.iter().any(|client| matches!(client.watches, Watches::Parts)) {
            sent.part = part(&shot, self.emulated.quality, fault);
        }
        // An encoder never makes the same bytes of the same picture: a stream that hangs has no more pictures.
        if !is_frozen && self.clients.iter().any(Client::wants_unit) {
            let encoder = match self.encoder.take() {
                Some(encoder) => Ok(encoder),
                None => Encoder::new(self.emulated.rate_hz),
            };
            let unit = encoder.and_then(|mut encoder| {
                let unit = encoder.encode(shot.rgb, shot.size_px, self.wants_key);
                self.encoder = Some(encoder);
                unit
            });
            // A picture that the library does not take is not sent: the client tells that nothing comes.
            sent.unit = unit.unwrap_or_default();
            self.wants_key = false;
            if fault == EmulatedFault::Torn {
                sent.unit.truncate(sent.unit.len() * 6 / 10);
            }
        }
        sent
    }

    fn send(&mut self, sent: &Sent, turn: &mut Turn<'_>) {
        for client in &mut self.clients {
            match &mut client.watches {
                Watches::Parts => turn.send(client.peer, &sent.part),
                Watches::Packets(session) if session.plays => {
                    turn.send(client.peer, &session.packets(&sent.unit, sent.since));
                }
                Watches::Nothing | Watches::Packets(_) => {}
            }
        }
    }

    /// An answer to what a player asks.
    fn replied(&mut self, from: Peer, replies: &[Reply], turn: &mut Turn<'_>) {
        for reply in replies {
            turn.send(from, reply.text.as_bytes());
            if reply.begins {
                self.wants_key = true;
                self.due_s = turn.now_s;
            }
            if reply.ends {
                self.lose(from);
            }
        }
    }
}

/// One part of the answer over HTTP.
fn part(shot: &Shot<'_>, quality: u8, fault: EmulatedFault) -> Vec<u8> {
    let (kind, mut picture) = if fault == EmulatedFault::OtherFormat {
        ("image/png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec())
    } else {
        ("image/jpeg", jpeg::encode(shot.rgb, shot.size_px, quality))
    };
    if fault == EmulatedFault::Torn {
        picture.truncate(picture.len() * 6 / 10);
    }
    let head = format!(
        "\r\n--{BOUNDARY}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nX-Timestamp: {}.{:06}\r\n\r\n",
        picture.len(),
        shot.since.as_secs(),
        shot.since.subsec_micros()
    );
    [head.as_bytes(), &picture].concat()
}

/// Answer to a whole request, and whether pictures follow.
fn answer(request: &[u8]) -> (String, bool) {
    let first = String::from_utf8_lossy(request.split(|byte| *byte == b'\r').next().unwrap_or_default()).into_owned();
    let mut words = first.split(' ');
    let short = |status: &str| (format!("HTTP/1.1 {status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"), false);
    match (words.next(), words.next()) {
        (Some("GET"), Some(path)) if PATHS.contains(&path) => {
            let kind = format!("multipart/x-mixed-replace; boundary={BOUNDARY}");
            (
                format!(
                    "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n"
                ),
                true,
            )
        }
        (Some("GET"), Some(_)) => short("404 Not Found"),
        (Some("HEAD" | "POST" | "PUT" | "DELETE" | "OPTIONS"), Some(_)) => short("405 Method Not Allowed"),
        _ => short("400 Bad Request"),
    }
}

/// What the camera says it sends over RTSP; nothing in a program that was built without it.
fn announces(fault: EmulatedFault) -> String {
    match fault {
        _ if !h264::IS_BUILT => String::new(),
        EmulatedFault::OtherFormat => rtsp::announcement("H265"),
        _ => rtsp::announcement("H264"),
    }
}

impl Emulator for Endoscope {
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>> {
        Ok(vec![tcp(self.emulated.port)])
    }

    fn endpoint(&self, places: &[String]) -> String {
        format!("http://{}/", places[0])
    }

    fn begin(&mut self) {
        let Some(path) = self.emulated.pipe.clone() else { return };
        // Whether it can be written was tried when it was asked for.
        self.pipe = Pipe::start(path, self.emulated.rate_hz, self.emulated.quality).ok();
    }

    fn meet(&mut self, peer: Peer, _: &mut Turn<'_>) {
        self.clients.push(Client { peer, request: Vec::new(), watches: Watches::Nothing });
    }

    fn hear(&mut self, from: Peer, bytes: &[u8], turn: &mut Turn<'_>) {
        let Some(client) = self.clients.iter_mut().find(|client| client.peer == from) else { return };
        if let Watches::Packets(session) = &mut client.watches {
            let replies = session.hear(bytes, &announces(turn.fault));
            self.replied(from, &replies, turn);
            return;
        }
        if matches!(client.watches, Watches::Parts) {
            return;
        }
        client.request.extend_from_slice(bytes);
        let is_whole = client.request.windows(4).any(|four| four == b"\r\n\r\n");
        if is_whole && rtsp::is_rtsp(&client.request) {
            let mut session = rtsp::Session::default();
            let replies = session.hear(&std::mem::take(&mut client.request), &announces(turn.fault));
            client.watches = Watches::Packets(session);
            self.replied(from, &replies, turn);
        } else if is_whole || client.request.len() > REQUEST_MOST {
            let (answer, watches) = answer(&client.request);
            client.request.clear();
            client.watches = if watches { Watches::Parts } else { Watches::Nothing };
            turn.send(from, answer.as_bytes());
            // The first picture comes at once.
            self.due_s = turn.now_s;
        }
    }

    fn pass(&mut self, turn: &mut Turn<'_>) {
        if turn.fault != EmulatedFault::Late {
            self.late.clear();
        }
        while let Some((_, sent)) = self.late.pop_front_if(|(leaves_s, _)| *leaves_s <= turn.now_s) {
            self.send(&sent, turn);
        }
        // What a player is told at the beginning holds to the end: a camera that changes it hangs up.
        if turn.fault == EmulatedFault::OtherFormat && self.clients.iter().any(Client::wants_unit) {
            turn.hang_up();
            self.lose(Peer::Everyone);
        }
        if !self.is_watched() || turn.now_s < self.due_s {
            return;
        }
        // What was missed is not caught up.
        let period_s = self.emulated.rate_hz.recip();
        self.due_s = (self.due_s + period_s).max(turn.now_s);
        let sent = self.take(turn.now_s, turn.fault);
        if turn.fault == EmulatedFault::Late {
            self.late.push_back((turn.now_s + LATE_S, sent));
        } else {
            self.send(&sent, turn);
        }
    }

    fn due_s(&self) -> Option<f64> {
        let late_s = self.late.front().map(|(leaves_s, _)| *leaves_s);
        let due_s = self.is_watched().then_some(self.due_s);
        [late_s, due_s].into_iter().flatten().reduce(f64::min).or(Some(f64::INFINITY))
    }

    fn lose(&mut self, peer: Peer) {
        self.clients.retain(|client| client.peer != peer && peer != Peer::Everyone);
        if self.clients.is_empty() {
            self.late.clear();
        }
    }
}
