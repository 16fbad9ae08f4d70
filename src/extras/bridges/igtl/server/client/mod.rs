//! A client: its requests, its reader thread and its writer thread.

mod requests;
mod subscriptions;

use std::{
    fmt, io,
    io::{ErrorKind, Read as _, Write as _},
    net::{Shutdown, TcpStream},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::sleep,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use socket2::SockRef;

pub(super) use self::subscriptions::EARLY_S;
use self::{requests::Requests, subscriptions::Wants};
use super::{
    super::{Content, ContentKind, ContentStatus, IgtlFormatError, IgtlMessage, StatusCode, Verb},
    image::ImageSlot,
    mailbox::Mailbox,
    moment::BUNDLE,
};

/// A client that accepts no data for this long is disconnected. Longer than a viewer pauses to draw; a client that
/// hangs would otherwise keep its queue and one of the few places.
const PATIENCE: Duration = Duration::from_secs(2);
/// Interval at which the reader checks whether the connection has ended: on Windows, closing it does not wake a waiting
/// reader.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// Maximum number of bytes in transit; small, so that a slow client gets recent data.
const SEND_BUFFER: usize = 1 << 16;
/// Maximum amount read from a client in this interval: 200 kB/s, more than 3000 requests per second. The rest waits on
/// the client's side.
const CHUNK: usize = 1024;
const READ_EVERY: Duration = Duration::from_millis(5);
const WORLD: &str = "world";

pub(super) struct IgtlClient {
    stream: TcpStream,
    pub(super) mailbox: Mailbox,
    wants: Mutex<Wants>,
    gone: AtomicBool,
}

impl IgtlClient {
    pub(super) fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(LOOK_EVERY))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        SockRef::from(&stream).set_send_buffer_size(SEND_BUFFER)?;
        Ok(Self { stream, mailbox: Mailbox::default(), wants: Mutex::default(), gone: AtomicBool::new(false) })
    }

    pub(super) fn wants(&self) -> MutexGuard<'_, Wants> {
        self.wants.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn is_gone(&self) -> bool {
        self.gone.load(Ordering::Acquire)
    }

    /// Closes the connection, which ends both threads.
    pub(super) fn leave(&self) {
        self.gone.store(true, Ordering::Release);
        // The other side may have closed it.
        self.stream.shutdown(Shutdown::Both).ok();
        self.mailbox.end();
    }

    /// Writes data until the connection ends.
    pub(super) fn write(&self) {
        while let Some(bytes) = self.mailbox.next() {
            if (&self.stream).write_all(&bytes).is_err() {
                break;
            }
        }
        self.leave();
    }

    /// Reads requests until the connection ends. `hurry` requests the loop's next tick.
    pub(super) fn read(&self, hurry: impl Fn(), desk: &ImageSlot) {
        let mut requests = Requests::default();
        let mut chunk = [0; CHUNK];
        while !self.is_gone() {
            match (&self.stream).read(&mut chunk) {
                Ok(count) if count > 0 => {
                    let received =
                        requests.take(&chunk[..count], |kind, message| self.receive(kind, message, &hurry, desk));
                    if let Err(error) = received {
                        // The writer closes the connection once the client has the reason.
                        let reason = refusal(StatusCode::ILLEGAL, &error.to_string());
                        self.mailbox.end_with(IgtlMessage::new(BUNDLE, now_ns(), reason).encode());
                        return;
                    }
                    sleep(READ_EVERY);
                }
                Err(error) if is_nothing_yet(error.kind()) => {}
                Ok(_) | Err(_) => break,
            }
        }
        self.leave();
    }

    fn receive(&self, name: &str, message: Result<IgtlMessage, IgtlFormatError>, hurry: &impl Fn(), desk: &ImageSlot) {
        match message {
            Ok(IgtlMessage { content: Content::Request(verb, kind, stream), .. }) => match verb {
                Verb::Get => self.once(kind, hurry, desk),
                Verb::Start => {
                    let known_frame = stream.as_ref().is_none_or(|stream| ["", WORLD].contains(&stream.frame.as_str()));
                    let can = known_frame
                        && kind != ContentKind::Capability
                        && (kind != ContentKind::Image || desk.is_taken());
                    if can {
                        self.wants().start(kind, stream.map(|stream| stream.interval_ms));
                        hurry();
                    }
                    self.answer(Content::Answer(kind, u8::from(!can)));
                }
                Verb::Stop => {
                    self.wants().stop(kind);
                    self.answer(Content::Answer(kind, 0));
                }
            },
            // Messages other than requests are ignored.
            Ok(_) => {}
            Err(error) => {
                // A client waits for the answer to its request, whatever is wrong with it.
                if let Some(kind) = Content::answered_kind(name) {
                    self.answer(Content::Answer(kind, 1));
                }
                self.answer(refusal(StatusCode::ILLEGAL, &error.to_string()));
            }
        }
    }

    fn once(&self, kind: ContentKind, hurry: &impl Fn(), desk: &ImageSlot) {
        match kind {
            ContentKind::Capability => self.answer(Content::Capability(capabilities())),
            ContentKind::Image if !desk.is_taken() => {
                self.answer(refusal(StatusCode::NOT_FOUND, "no picture of an endoscope is read here"));
            }
            kind => {
                self.wants().ask(kind);
                hurry();
            }
        }
    }

    fn answer(&self, content: Content) {
        self.mailbox.report(IgtlMessage::new(BUNDLE, now_ns(), content).encode());
    }
}

/// Returns whether the connection is still open.
const fn is_nothing_yet(error: ErrorKind) -> bool {
    matches!(error, ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

impl fmt::Debug for IgtlClient {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Client").field("wants", &self.wants).field("gone", &self.gone).finish_non_exhaustive()
    }
}

/// Closes a connection for which there is no room, after sending a message.
pub(super) fn refuse(mut stream: &TcpStream, max: usize) {
    let text = format!("{max} clients are already connected: disconnect one of them");
    let bytes = IgtlMessage::new(BUNDLE, now_ns(), refusal(StatusCode::BUSY, &text)).encode();
    stream.set_nonblocking(true).ok();
    // A new connection has room for this; if it does not, there is no client to inform.
    stream.write_all(&bytes).ok();
    stream.shutdown(Shutdown::Write).ok();
}

pub(super) fn refusal(code: StatusCode, text: &str) -> Content {
    Content::Status(ContentStatus { code, subcode: 0, name: String::new(), text: text.to_owned() })
}

/// Returns the supported message types.
fn capabilities() -> Vec<String> {
    let report = ContentKind::ALL.map(|kind| kind.name().to_owned());
    let asked = [Verb::Get, Verb::Start, Verb::Stop].into_iter().flat_map(|verb| {
        let has = move |kind: &ContentKind| verb == Verb::Get || *kind != ContentKind::Capability;
        ContentKind::ALL.into_iter().filter(has).map(move |kind| Content::Request(verb, kind, None).kind())
    });
    report.into_iter().chain(asked).collect()
}

/// Returns the current time, ns since 1970.
pub(super) fn now_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}
