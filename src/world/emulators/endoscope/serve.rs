//! Serves the pictures: one answer that never ends for everyone who asks.

use std::{
    collections::VecDeque,
    io,
    time::{SystemTime, UNIX_EPOCH},
};

use super::{
    Body, Emulated,
    workshop::{BOUNDARY, Order, Workshop},
};
use crate::{
    emulators::{
        EmulatedFault, Emulator, Peer, Turn,
        wires::{End, tcp},
    },
    scene::Scene,
};

/// Longest request that is read.
const REQUEST_MOST: usize = 8 << 10;
/// How late a late picture leaves, s.
const LATE_S: f64 = 0.4;
/// It is looked so often whether a picture is made, s.
const LOOK_S: f64 = 1e-3;
/// What a browser or a player asks for.
const PATHS: [&str; 4] = ["/", "/stream", "/stream.mjpg", "/?action=stream"];

pub(super) struct Endoscope {
    emulated: Emulated,
    scene: Scene,
    body: Body,
    /// Made when the first picture is wanted.
    workshop: Option<Workshop>,
    clients: Vec<Client>,
    due_s: f64,
    /// When it is looked whether a picture is made, s.
    looks_s: f64,
    /// The last picture as it was sent, which a frozen camera sends again.
    last: Option<Vec<u8>>,
    /// When each late picture leaves, s.
    late: VecDeque<(f64, Vec<u8>)>,
}

struct Client {
    peer: Peer,
    request: Vec<u8>,
    watches: bool,
}

impl Endoscope {
    pub(super) fn new(emulated: Emulated, scene: &Scene, body: Body) -> Self {
        let (clients, late) = (Vec::new(), VecDeque::new());
        Self {
            emulated,
            scene: scene.clone(),
            body,
            workshop: None,
            clients,
            due_s: 0.0,
            looks_s: 0.0,
            last: None,
            late,
        }
    }

    fn is_watched(&self) -> bool {
        self.clients.iter().any(|client| client.watches)
    }

    /// Orders the picture of this time.
    fn order(&mut self, now_s: f64, fault: EmulatedFault) {
        // Before it is looked: whoever reads this time knows that nothing in the picture is older.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let instruments = (self.body)(now_s);
        if self.workshop.is_none() {
            // Without a thread there is no picture; it is tried again for the next one.
            self.workshop = Workshop::start(self.emulated, &self.scene).ok();
        }
        if let Some(workshop) = &mut self.workshop {
            workshop.order(Order { since, instruments, fault });
        }
    }

    /// Sends a picture, or keeps it for later.
    fn deliver(&mut self, part: Vec<u8>, turn: &mut Turn<'_>) {
        if turn.fault == EmulatedFault::Late {
            self.late.push_back((turn.now_s + LATE_S, part.clone()));
        } else {
            self.send(&part, turn);
        }
        self.last = Some(part);
    }

    fn send(&self, part: &[u8], turn: &mut Turn<'_>) {
        for client in self.clients.iter().filter(|client| client.watches) {
            turn.send(client.peer, part);
        }
    }
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

impl Emulator for Endoscope {
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>> {
        Ok(vec![tcp(self.emulated.port)])
    }

    fn endpoint(&self, places: &[String]) -> String {
        format!("http://{}/", places[0])
    }

    fn meet(&mut self, peer: Peer, _: &mut Turn<'_>) {
        self.clients.push(Client { peer, request: Vec::new(), watches: false });
    }

    fn hear(&mut self, from: Peer, bytes: &[u8], turn: &mut Turn<'_>) {
        let Some(client) = self.clients.iter_mut().find(|client| client.peer == from && !client.watches) else {
            return;
        };
        client.request.extend_from_slice(bytes);
        let is_whole = client.request.windows(4).any(|four| four == b"\r\n\r\n");
        if is_whole || client.request.len() > REQUEST_MOST {
            let (answer, watches) = answer(&client.request);
            client.request.clear();
            client.watches = watches;
            turn.send(from, answer.as_bytes());
            // The first picture comes at once.
            self.due_s = turn.now_s;
        }
    }

    fn pass(&mut self, turn: &mut Turn<'_>) {
        if turn.fault != EmulatedFault::Late {
            self.late.clear();
        }
        while let Some((_, part)) = self.late.pop_front_if(|(leaves_s, _)| *leaves_s <= turn.now_s) {
            self.send(&part, turn);
        }
        if let Some(part) = self.workshop.as_mut().and_then(Workshop::made) {
            self.deliver(part, turn);
        }
        let is_busy = self.workshop.as_ref().is_some_and(|workshop| workshop.is_busy);
        if self.is_watched() && turn.now_s >= self.due_s && !is_busy {
            // What was missed is not caught up.
            self.due_s = (self.due_s + self.emulated.rate_hz.recip()).max(turn.now_s);
            match self.last.take().filter(|_| turn.fault == EmulatedFault::Freeze) {
                Some(frozen) => self.deliver(frozen, turn),
                None => self.order(turn.now_s, turn.fault),
            }
        }
        self.looks_s = turn.now_s + LOOK_S;
    }

    fn due_s(&self) -> Option<f64> {
        let late_s = self.late.front().map(|(leaves_s, _)| *leaves_s);
        let is_busy = self.workshop.as_ref().is_some_and(|workshop| workshop.is_busy);
        let due_s = if is_busy { Some(self.looks_s) } else { self.is_watched().then_some(self.due_s) };
        [late_s, due_s].into_iter().flatten().reduce(f64::min).or(Some(f64::INFINITY))
    }

    fn lose(&mut self, peer: Peer) {
        self.clients.retain(|client| client.peer != peer && peer != Peer::Everyone);
        if self.clients.is_empty() {
            self.late.clear();
        }
    }
}
