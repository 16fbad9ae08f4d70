//! Makes the pictures on a thread of its own, so that neither the emulator's clients nor, in an emulated rig, the other devices wait for it.

use std::{
    io,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::Builder,
    time::Duration,
};

use nima_endoscope::{jpeg, time_code};

use super::{Emulated, Instrument, draw::Painter};
use crate::{emulators::EmulatedFault, scene::Scene};

/// What stands between two pictures in the answer.
pub(super) const BOUNDARY: &str = "nima-endoscope";

/// A picture to be made.
pub(super) struct Order {
    /// The time that stands in it, since 1970: nothing in it is older.
    pub(super) since: Duration,
    pub(super) instruments: Vec<Instrument>,
    pub(super) fault: EmulatedFault,
}

/// The thread; it ends when this is dropped.
pub(super) struct Workshop {
    orders: SyncSender<Order>,
    made: Receiver<Vec<u8>>,
    /// An order is not done yet.
    pub(super) is_busy: bool,
}

impl Workshop {
    pub(super) fn start(emulated: Emulated, scene: &Scene) -> io::Result<Self> {
        let ((orders, ordered), (hand_over, made)) = (sync_channel(1), sync_channel(1));
        let scene = scene.clone();
        let work = move || {
            if emulated.gives_way {
                give_way();
            }
            let mut bench = Bench::new(emulated, &scene);
            while let Ok(order) = ordered.recv() {
                if hand_over.send(bench.part(&order)).is_err() {
                    return;
                }
            }
        };
        Builder::new().name("painter".to_owned()).spawn(work)?;
        Ok(Self { orders, made, is_busy: false })
    }

    /// Begins the next picture, unless one is still being made.
    pub(super) fn order(&mut self, order: Order) {
        self.is_busy |= self.orders.try_send(order).is_ok();
    }

    /// The part of the answer with the picture that was ordered, once it is made.
    pub(super) fn made(&mut self) -> Option<Vec<u8>> {
        let part = self.made.try_recv().ok()?;
        self.is_busy = false;
        Some(part)
    }
}

/// A picture takes milliseconds, and other devices need theirs a thousand times a second. No lock of theirs is ever taken on this thread.
fn give_way() {
    #[cfg(target_os = "linux")]
    #[expect(unsafe_code, reason = "std has no priorities")]
    // SAFETY: a plain system call without pointers. On Linux it concerns the calling thread alone; where it is refused, nothing changes.
    unsafe {
        libc::setpriority(libc::PRIO_PROCESS, 0, NICE);
    }
}

/// A third of an ordinary thread's share where both want a processor.
#[cfg(target_os = "linux")]
const NICE: libc::c_int = 5;

struct Bench {
    painter: Painter,
    encoder: jpeg::Encoder,
    quality: u8,
    square_px: usize,
}

impl Bench {
    fn new(Emulated { camera, quality, square_px, .. }: Emulated, scene: &Scene) -> Self {
        let painter = Painter::new(camera, scene);
        Self { encoder: jpeg::Encoder::new(painter.size_px(), quality), painter, quality, square_px }
    }

    /// One part of the answer with the picture of this order.
    fn part(&mut self, Order { since, instruments, fault }: &Order) -> Vec<u8> {
        let size_px @ [width, _] = self.painter.size_px();
        let rgb = self.painter.draw(instruments);
        if self.square_px > 0 {
            time_code::draw(since.as_micros() as u64, self.square_px, rgb, width);
        }
        let (kind, mut picture) = match fault {
            EmulatedFault::Black => {
                rgb.fill(0);
                ("image/jpeg", self.encoder.encode(rgb))
            }
            EmulatedFault::WrongSize => {
                let (half, half_px) = halved(rgb, size_px);
                ("image/jpeg", jpeg::encode(&half, half_px, self.quality))
            }
            EmulatedFault::OtherFormat => ("image/png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec()),
            _ => ("image/jpeg", self.encoder.encode(rgb)),
        };
        if *fault == EmulatedFault::Torn {
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
}

/// Every second pixel of every second row.
fn halved(rgb: &[u8], [width, height]: [usize; 2]) -> (Vec<u8>, [usize; 2]) {
    let half_px = [width / 2, height / 2];
    let rows = rgb.chunks_exact(3 * width).step_by(2).take(half_px[1]);
    let half = rows.flat_map(|row| row.chunks_exact(3).step_by(2).take(half_px[0]).flatten().copied()).collect();
    (half, half_px)
}
