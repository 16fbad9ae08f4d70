//! Renders the images on its own thread, so that neither the emulator's clients nor, in an emulated rig, the other
//! devices wait for it.

use std::{
    io,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::Builder,
    time::Duration,
};

use nima_endoscope::{h264, jpeg};

use super::{
    EmulatedEndoscope,
    pipe::Pipe,
    render::{SceneRenderer, Shot, ShotState, ShotSubject},
};
use crate::emulators::EmulatedFault;

/// Separator between two images in the response.
pub(super) const BOUNDARY: &str = "nima-endoscope";

/// An image to be rendered.
pub(super) struct RenderOrder {
    /// Time in the image's time code, since 1970: nothing in the image is older.
    pub(super) since: Duration,
    pub(super) seen: ShotState,
    pub(super) fault: EmulatedFault,
    /// Whether a client watches over HTTP.
    pub(super) parts: bool,
    /// Whether a client watches over RTSP.
    pub(super) units: bool,
    /// Whether a player can start with this frame.
    pub(super) key: bool,
}

/// A finished image in the forms that its clients need; empty for the other forms.
#[derive(Default)]
pub(super) struct RenderedImage {
    /// A part of the HTTP response.
    pub(super) part: Vec<u8>,
    /// A frame of the RTSP stream.
    pub(super) unit: Vec<u8>,
    pub(super) since: Duration,
}

/// The rendering thread; it ends when this is dropped.
pub(super) struct RenderThread {
    orders: SyncSender<RenderOrder>,
    made: Receiver<RenderedImage>,
    /// Whether an order is pending.
    pub(super) is_busy: bool,
}

impl RenderThread {
    pub(super) fn start(emulated: EmulatedEndoscope, subject: ShotSubject, pipe: Option<Pipe>) -> io::Result<Self> {
        let (orders, ordered) = sync_channel::<RenderOrder>(1);
        let (hand_over, made) = sync_channel(1);
        let work = move || {
            if emulated.gives_way {
                give_way();
            }
            let mut bench = RenderState::new(emulated, &subject, pipe);
            while let Ok(order) = ordered.recv() {
                if hand_over.send(bench.make(&order)).is_err() {
                    return;
                }
            }
        };
        Builder::new().name("painter".to_owned()).spawn(work)?;
        Ok(Self { orders, made, is_busy: false })
    }

    /// Starts the next image, unless one is still being rendered.
    pub(super) fn order(&mut self, order: RenderOrder) {
        self.is_busy |= self.orders.try_send(order).is_ok();
    }

    /// Returns the ordered image once it is finished.
    pub(super) fn made(&mut self) -> Option<RenderedImage> {
        let sent = self.made.try_recv().ok()?;
        self.is_busy = false;
        Some(sent)
    }
}

/// Lowers the priority of this thread: rendering takes milliseconds, whereas the threads of other devices run a
/// thousand times per second. This thread never takes one of their locks.
fn give_way() {
    #[cfg(target_os = "linux")]
    #[expect(unsafe_code, reason = "std has no priorities")]
    // SAFETY: a plain system call without pointers. On Linux it affects only the calling thread; if it is refused,
    // nothing changes.
    unsafe {
        libc::setpriority(libc::PRIO_PROCESS, 0, NICE);
    }
}

/// At this nice value, the thread gets a third of the processor time of an ordinary thread when both compete.
#[cfg(target_os = "linux")]
const NICE: libc::c_int = 5;

struct RenderState {
    rate_hz: f64,
    studio: SceneRenderer,
    pipe: Option<Pipe>,
    coders: Coders,
}

/// Coders for all clients; that of H.264 is created for its first client.
struct Coders {
    quality: u8,
    h264: Option<h264::H264Encoder>,
}

impl RenderState {
    fn new(emulated: EmulatedEndoscope, subject: &ShotSubject, pipe: Option<Pipe>) -> Self {
        let coders = Coders { quality: emulated.quality, h264: None };
        Self { rate_hz: emulated.rate_hz, studio: SceneRenderer::new(emulated, subject), pipe, coders }
    }

    fn make(&mut self, &RenderOrder { since, ref seen, fault, parts, units, key }: &RenderOrder) -> RenderedImage {
        let shot = self.studio.take(since, seen, fault);
        if let Some(pipe) = &self.pipe {
            pipe.send(&shot, fault);
        }
        let mut sent = RenderedImage { since, ..RenderedImage::default() };
        if parts {
            sent.part = self.coders.part(&shot, since, fault);
        }
        // An encoder never repeats its bytes for an equal image, so a frozen stream sends no more images.
        if units && fault != EmulatedFault::Freeze {
            // An image that the encoder rejects is not sent; the client then reports that no data arrive.
            sent.unit = self.coders.unit(&shot, key, self.rate_hz).unwrap_or_default();
            if fault == EmulatedFault::Torn {
                sent.unit.truncate(sent.unit.len() * 6 / 10);
            }
        }
        sent
    }
}

impl Coders {
    fn part(&self, shot: &Shot<'_>, since: Duration, fault: EmulatedFault) -> Vec<u8> {
        let (kind, mut image) = if fault == EmulatedFault::OtherFormat {
            ("image/png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec())
        } else {
            ("image/jpeg", jpeg::encode(shot.rgb, shot.size_px, self.quality))
        };
        if fault == EmulatedFault::Torn {
            image.truncate(image.len() * 6 / 10);
        }
        let head = format!(
            "\r\n--{BOUNDARY}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nX-Timestamp: {}.{:06}\r\n\r\n",
            image.len(),
            since.as_secs(),
            since.subsec_micros()
        );
        [head.as_bytes(), &image].concat()
    }

    fn unit(&mut self, shot: &Shot<'_>, key: bool, rate_hz: f64) -> io::Result<Vec<u8>> {
        let encoder = match &mut self.h264 {
            Some(encoder) => encoder,
            none => none.insert(h264::H264Encoder::new(rate_hz)?),
        };
        encoder.encode(shot.rgb, shot.size_px, key)
    }
}
