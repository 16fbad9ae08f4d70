//! Serves the pictures: one answer that never ends for everyone who asks.

use std::{
    collections::VecDeque,
    io,
    time::{SystemTime, UNIX_EPOCH},
};

use nima_endoscope::{Board, jpeg, time_code};

use super::{
    Body, Emulated,
    board::{Drawn, Hands},
    draw::Painter,
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
const BOUNDARY: &str = "nima-endoscope";
/// What a browser or a player asks for.
const PATHS: [&str; 4] = ["/", "/stream", "/stream.mjpg", "/?action=stream"];

pub(super) struct Endoscope {
    emulated: Emulated,
    shown: Shown,
    clients: Vec<Client>,
    due_s: f64,
    /// The last picture as it was sent, which a frozen camera sends again.
    last: Option<Vec<u8>>,
    /// When each late picture leaves, s.
    late: VecDeque<(f64, Vec<u8>)>,
}

/// What is before the lens; how it is drawn is made when the first picture is wanted.
pub(super) enum Shown {
    /// A scene with its instruments.
    Scene(Box<Scene>, Body, Option<Painter>),
    /// A board for the calibration.
    Board(Board, Hands, Option<Drawn>),
}

impl Shown {
    /// The picture at a time, s.
    fn draw(&mut self, emulated: &Emulated, now_s: f64) -> &mut [u8] {
        let camera = emulated.camera;
        match self {
            Self::Scene(scene, body, painter) => {
                let instruments = body(now_s);
                painter.get_or_insert_with(|| Painter::new(camera, scene)).draw(&instruments)
            }
            Self::Board(board, hands, drawn) => {
                let camera_from_board = hands(now_s);
                drawn.get_or_insert_with(|| Drawn::new(*board, &camera.lens)).draw(&camera_from_board)
            }
        }
    }
}

struct Client {
    peer: Peer,
    request: Vec<u8>,
    watches: bool,
}

impl Endoscope {
    pub(super) fn new(emulated: Emulated, shown: Shown) -> Self {
        let (clients, late) = (Vec::new(), VecDeque::new());
        Self { emulated, shown, clients, due_s: 0.0, last: None, late }
    }

    fn is_watched(&self) -> bool {
        self.clients.iter().any(|client| client.watches)
    }

    /// One part of the answer with the picture of this time.
    fn part(&mut self, now_s: f64, fault: EmulatedFault) -> Vec<u8> {
        // Before it is looked: whoever reads this time knows that nothing in the picture is older.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let size_px @ [width, _] = self.emulated.camera.lens.size_px;
        let rgb = self.shown.draw(&self.emulated, now_s);
        let (quality, square_px) = (self.emulated.quality, self.emulated.square_px);
        if square_px > 0 {
            time_code::draw(since.as_micros() as u64, square_px, rgb, width);
        }
        let (kind, mut picture) = match fault {
            EmulatedFault::Black => {
                rgb.fill(0);
                ("image/jpeg", jpeg::encode(rgb, size_px, quality))
            }
            EmulatedFault::WrongSize => {
                let (half, half_px) = halved(rgb, size_px);
                ("image/jpeg", jpeg::encode(&half, half_px, quality))
            }
            EmulatedFault::OtherFormat => ("image/png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec()),
            _ => ("image/jpeg", jpeg::encode(rgb, size_px, quality)),
        };
        if fault == EmulatedFault::Torn {
            picture.truncate(picture.len() * 6 / 10);
        }
        let head = format!(
            "\r\n--{BOUNDARY}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nX-Timestamp: {}.{:06}\r\n\r\n",
            picture.len(),
            since.as_secs(),
            since.subsec_micros()
        );
        [head.as_bytes(), &picture].concat()
    }

    fn send(&self, part: &[u8], turn: &mut Turn<'_>) {
        for client in self.clients.iter().filter(|client| client.watches) {
            turn.send(client.peer, part);
        }
    }
}

/// Every second pixel of every second row.
fn halved(rgb: &[u8], [width, height]: [usize; 2]) -> (Vec<u8>, [usize; 2]) {
    let half_px = [width / 2, height / 2];
    let rows = rgb.chunks_exact(3 * width).step_by(2).take(half_px[1]);
    let half = rows.flat_map(|row| row.chunks_exact(3).step_by(2).take(half_px[0]).flatten().copied()).collect();
    (half, half_px)
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
        if !self.is_watched() || turn.now_s < self.due_s {
            return;
        }
        // What was missed is not caught up.
        let period_s = self.emulated.rate_hz.recip();
        self.due_s = (self.due_s + period_s).max(turn.now_s);
        let frozen = self.last.take().filter(|_| turn.fault == EmulatedFault::Freeze);
        let part = frozen.unwrap_or_else(|| self.part(turn.now_s, turn.fault));
        if turn.fault == EmulatedFault::Late {
            self.late.push_back((turn.now_s + LATE_S, part.clone()));
        } else {
            self.send(&part, turn);
        }
        self.last = Some(part);
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
