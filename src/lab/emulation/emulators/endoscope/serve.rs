//! Serves the images: one endless response for every client, as parts over HTTP or as packets over RTSP.

use std::{
    collections::VecDeque,
    io,
    time::{SystemTime, UNIX_EPOCH},
};

use nima_endoscope::h264;

use super::{
    EmulatedEndoscope,
    pipe::Pipe,
    render::{ShotState, ShotSubject},
    render_thread::{BOUNDARY, RenderOrder, RenderThread, RenderedImage},
    rtsp::{self, RtspReply},
};
use crate::emulators::{
    EmulatedFault, Emulator, EmulatorTurn, WirePeer,
    wires::{WireEnd, tcp},
};

/// Maximum request, bytes. A client must not fill the memory by a request that never ends.
const REQUEST_MAX: usize = 8 << 10;
/// Delay of a late image, s.
const LATE_S: f64 = 0.4;
/// Interval at which a finished image is checked for, s.
const LOOK_S: f64 = 1e-3;
/// Paths that a browser or a player may request.
const PATHS: [&str; 4] = ["/", "/stream", "/stream.mjpg", "/?action=stream"];

pub(super) struct EndoscopeServer {
    emulated: EmulatedEndoscope,
    /// Returns the view at a time.
    seen: Box<dyn FnMut(f64) -> ShotState + Send>,
    subject: Option<ShotSubject>,
    /// Started when the first image is requested.
    workshop: Option<RenderThread>,
    /// Whether the next image must be one with which a player can begin.
    wants_key: bool,
    clients: Vec<EndoscopeClient>,
    due_s: f64,
    /// When to check next for a finished image, s.
    looks_s: f64,
    /// When to send each late image, s.
    late: VecDeque<(f64, RenderedImage)>,
}

struct EndoscopeClient {
    peer: WirePeer,
    request: Vec<u8>,
    watches: Watches,
}

enum Watches {
    /// Has not sent a request yet.
    Nothing,
    Parts,
    Packets(rtsp::RtspSession),
}

impl EndoscopeClient {
    fn wants_unit(&self) -> bool {
        matches!(&self.watches, Watches::Packets(session) if session.plays)
    }
}

impl EndoscopeServer {
    pub(super) fn new(
        emulated: EmulatedEndoscope,
        subject: ShotSubject,
        seen: Box<dyn FnMut(f64) -> ShotState + Send>,
    ) -> Self {
        Self {
            emulated,
            seen,
            subject: Some(subject),
            workshop: None,
            wants_key: true,
            clients: Vec::new(),
            due_s: 0.0,
            looks_s: 0.0,
            late: VecDeque::new(),
        }
    }

    fn is_watched(&self) -> bool {
        let watches = |client: &EndoscopeClient| client.wants_unit() || matches!(client.watches, Watches::Parts);
        self.emulated.pipe.is_some() || self.clients.iter().any(watches)
    }

    fn is_busy(&self) -> bool {
        self.workshop.as_ref().is_some_and(|workshop| workshop.is_busy)
    }

    /// Requests the image of this time.
    fn order(&mut self, now_s: f64, fault: EmulatedFault) {
        // Read the time before the view, so that a reader of this time can rely on nothing in the image being older.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let seen = (self.seen)(now_s);
        if let Some(subject) = self.subject.take() {
            let EmulatedEndoscope { pipe, rate_hz, quality, .. } = &self.emulated;
            // The pipe's path was checked when it was requested.
            let pipe = pipe.clone().and_then(|path| Pipe::start(path, *rate_hz, *quality).ok());
            // Without a thread there is no image, and the client reports that no data arrive.
            self.workshop = RenderThread::start(self.emulated.clone(), subject, pipe).ok();
        }
        let parts = self.clients.iter().any(|client| matches!(client.watches, Watches::Parts));
        let units = self.clients.iter().any(EndoscopeClient::wants_unit);
        let key = self.wants_key;
        if let Some(workshop) = &mut self.workshop {
            workshop.order(RenderOrder { since, seen, fault, parts, units, key });
            self.wants_key &= !units;
        }
    }

    fn send(&mut self, sent: &RenderedImage, turn: &mut EmulatorTurn<'_>) {
        for client in &mut self.clients {
            match &mut client.watches {
                // A client that connected while the image was rendered waits for the next one.
                Watches::Parts if !sent.part.is_empty() => turn.send(client.peer, &sent.part),
                Watches::Packets(session) if session.plays && !sent.unit.is_empty() => {
                    turn.send(client.peer, &session.packets(&sent.unit, sent.since));
                }
                Watches::Nothing | Watches::Parts | Watches::Packets(_) => {}
            }
        }
    }

    /// Answers a player's requests.
    fn replied(&mut self, from: WirePeer, replies: &[RtspReply], turn: &mut EmulatorTurn<'_>) {
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

/// Returns the response to a complete request, and whether images follow.
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

/// Returns the camera's description of its RTSP stream; empty in a program built without it.
fn announces(fault: EmulatedFault) -> String {
    match fault {
        _ if !h264::IS_BUILT => String::new(),
        EmulatedFault::OtherFormat => rtsp::announcement("H265"),
        _ => rtsp::announcement("H264"),
    }
}

impl Emulator for EndoscopeServer {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![tcp(self.emulated.port)])
    }

    fn endpoint(&self, places: &[String]) -> String {
        format!("http://{}/", places[0])
    }

    fn meet(&mut self, peer: WirePeer, _: &mut EmulatorTurn<'_>) {
        self.clients.push(EndoscopeClient { peer, request: Vec::new(), watches: Watches::Nothing });
    }

    fn receive(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        let Some(client) = self.clients.iter_mut().find(|client| client.peer == from) else { return };
        if let Watches::Packets(session) = &mut client.watches {
            let replies = session.receive(bytes, &announces(turn.fault));
            self.replied(from, &replies, turn);
            return;
        }
        if matches!(client.watches, Watches::Parts) {
            return;
        }
        client.request.extend_from_slice(bytes);
        let is_whole = client.request.windows(4).any(|four| four == b"\r\n\r\n");
        if is_whole && rtsp::is_rtsp(&client.request) {
            let mut session = rtsp::RtspSession::default();
            let replies = session.receive(&std::mem::take(&mut client.request), &announces(turn.fault));
            client.watches = Watches::Packets(session);
            self.replied(from, &replies, turn);
        } else if is_whole || client.request.len() > REQUEST_MAX {
            let (answer, watches) = answer(&client.request);
            client.request.clear();
            client.watches = if watches { Watches::Parts } else { Watches::Nothing };
            turn.send(from, answer.as_bytes());
            // The first image is rendered at once.
            self.due_s = turn.now_s;
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        if turn.fault != EmulatedFault::Late {
            self.late.clear();
        }
        while let Some((_, sent)) = self.late.pop_front_if(|(leaves_s, _)| *leaves_s <= turn.now_s) {
            self.send(&sent, turn);
        }
        // The description sent at the beginning must remain valid: a camera that changes it disconnects.
        if turn.fault == EmulatedFault::OtherFormat && self.clients.iter().any(EndoscopeClient::wants_unit) {
            turn.hang_up();
            self.lose(WirePeer::Everyone);
        }
        if let Some(sent) = self.workshop.as_mut().and_then(RenderThread::made) {
            if turn.fault == EmulatedFault::Late {
                self.late.push_back((turn.now_s + LATE_S, sent));
            } else {
                self.send(&sent, turn);
            }
        }
        if self.is_watched() && turn.now_s >= self.due_s && !self.is_busy() {
            // Missed images are skipped.
            self.due_s = (self.due_s + self.emulated.rate_hz.recip()).max(turn.now_s);
            self.order(turn.now_s, turn.fault);
        }
        self.looks_s = turn.now_s + LOOK_S;
    }

    fn due_s(&self) -> Option<f64> {
        let late_s = self.late.front().map(|(leaves_s, _)| *leaves_s);
        let due_s = if self.is_busy() { Some(self.looks_s) } else { self.is_watched().then_some(self.due_s) };
        [late_s, due_s].into_iter().flatten().reduce(f64::min).or(Some(f64::INFINITY))
    }

    fn lose(&mut self, peer: WirePeer) {
        self.clients.retain(|client| client.peer != peer && peer != WirePeer::Everyone);
        if self.clients.is_empty() {
            self.late.clear();
        }
    }
}
