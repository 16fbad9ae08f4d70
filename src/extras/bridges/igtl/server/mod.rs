//! A server that reports the state of a loop to clients. Data sent by a client never reach the loop.
//!
//! | thread | does |
//! |---|---|
//! | the recorder's | [`LoopWatcher`] copies the state into a bounded queue when a client is due or a state has changed; never waits |
//! | hub | writes messages for each client into its [`Mailbox`], where a newer bundle replaces the older one |
//! | listener | accepts clients, up to [`MAX_CLIENTS`] |
//! | reader, writer (per client) | receive its requests, limited in rate; send, and disconnect a client that reads nothing |

mod audience;
mod client;
mod hub;
mod image;
mod mailbox;
mod moment;
#[cfg(test)]
mod tests;

use std::{
    fmt, io,
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{Builder, JoinHandle, sleep},
    time::Duration,
};

use crossbeam_channel::{Receiver, Sender, bounded};
use nalgebra::Vector3;
use nima_machine::{messages::LoopState, rig::SIDES};
use nima_session::sinks::Audience;
use tracing::{info, warn};

pub use self::image::ImageProvider;
use self::{audience::LoopWatcher, client::IgtlClient, hub::Hub, moment::HubMessage};

/// The protocol's usual port. 3D Slicer and PLUS use it by default.
pub const PORT: u16 = 18_944;
/// Device name of the endoscope images.
pub const IMAGE_DEVICE: &str = "endoscope";
/// Maximum number of clients. More clients than a laboratory has programs are a fault or an attack.
const MAX_CLIENTS: usize = 8;
/// Maximum number of entries waiting for the hub: far more than arrive during a short delay.
const QUEUE: usize = 256;
/// Interval at which the listener checks for clients, and its pause after each.
const LISTEN_EVERY: Duration = Duration::from_millis(20);
const AFTER_CLIENT: Duration = Duration::from_millis(5);

/// Returns a sentence for a state: fault and remedy, or an empty text.
pub type StateText = fn(LoopState) -> String;

/// Information about a loop before it starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopOutline {
    /// The trocar of each side, m (`world`), through which its shaft passes; `None` if unknown.
    pub trocars_m: [Option<Vector3<f64>>; SIDES],
}

/// Why the server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum IgtlError {
    /// The address cannot be used.
    #[error(
        "OpenIGTLink: cannot listen on {address}: {source}; end the program that uses this port, or choose another port"
    )]
    Listen { address: SocketAddr, source: io::Error },
    /// The operating system gives no thread.
    #[error("OpenIGTLink: cannot start a thread: {0}; end other programs, then try again")]
    Thread(#[source] io::Error),
}

/// A server that runs until it is dropped, for successive loops.
pub struct IgtlServer {
    shared: Arc<IgtlShared>,
    address: SocketAddr,
    threads: Vec<JoinHandle<()>>,
}

/// State shared by the threads.
struct IgtlShared {
    report: Sender<HubMessage>,
    clients: Mutex<Vec<Arc<IgtlClient>>>,
    /// Loop time (s, as bits) at which the next data of a client are due; infinite if none are.
    due: AtomicU64,
    /// States that were dropped because the queue was full.
    dropped: AtomicU64,
    ends: AtomicBool,
    words: StateText,
    images: image::ImageSlot,
}

impl IgtlShared {
    fn clients(&self) -> MutexGuard<'_, Vec<Arc<IgtlClient>>> {
        self.clients.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn due_s(&self) -> f64 {
        f64::from_bits(self.due.load(Ordering::Relaxed))
    }

    fn set_due(&self, due_s: f64) {
        self.due.store(due_s.to_bits(), Ordering::Relaxed);
    }

    /// Requests data with the next tick.
    fn hurry(&self) {
        let _clients = self.clients();
        self.set_due(f64::NEG_INFINITY);
    }

    fn is_ending(&self) -> bool {
        self.ends.load(Ordering::Acquire)
    }
}

impl IgtlServer {
    /// Listens at this address; port 0 selects a free one. `words` returns the text of a status.
    ///
    /// # Errors
    /// [`IgtlError`] if the address is not this computer's or the port is in use.
    ///
    /// ```
    /// let server = nima_bridges::igtl::IgtlServer::start("127.0.0.1:0".parse()?, |_| String::new())?;
    /// assert_eq!(server.clients(), 0);
    /// assert!(std::net::TcpStream::connect(server.address()).is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn start(address: SocketAddr, words: StateText) -> Result<Self, IgtlError> {
        let refused = |source| IgtlError::Listen { address, source };
        let listener = TcpListener::bind(address).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let (report, receives) = bounded(QUEUE);
        let shared = Arc::new(IgtlShared {
            report,
            clients: Mutex::default(),
            due: AtomicU64::new(f64::INFINITY.to_bits()),
            dropped: AtomicU64::new(0),
            ends: AtomicBool::new(false),
            words,
            images: image::ImageSlot::default(),
        });
        let mut server = Self { shared, address, threads: Vec::new() };
        server.begin("igtl-hub", move |shared| Hub::new(shared).run(&receives))?;
        server.begin("igtl-listener", move |shared| listen(&listener, &shared))?;
        server.begin("igtl-pictures", |shared| image::serve(&shared))?;
        Ok(server)
    }

    fn begin(&mut self, name: &str, run: impl FnOnce(Arc<IgtlShared>) + Send + 'static) -> Result<(), IgtlError> {
        let shared = Arc::clone(&self.shared);
        let thread = Builder::new().name(name.to_owned()).spawn(move || run(shared)).map_err(IgtlError::Thread)?;
        self.threads.push(thread);
        Ok(())
    }

    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns the number of connected clients.
    pub fn clients(&self) -> usize {
        self.shared.clients().iter().filter(|client| !client.is_gone()).count()
    }

    /// Returns the number of states that clients did not get because this computer was too busy.
    pub fn dropped(&self) -> u64 {
        self.shared.dropped.load(Ordering::Relaxed)
    }

    /// Returns the audience for the recorder of the next loop.
    pub fn audience(&self, outline: LoopOutline) -> Box<dyn Audience> {
        Box::new(LoopWatcher::new(Arc::clone(&self.shared), outline))
    }

    /// Sets the source of images for clients that request them, or removes it.
    pub fn show(&self, source: Option<Box<dyn ImageProvider>>) {
        self.shared.images.put(source);
    }
}

impl Drop for IgtlServer {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        for client in self.shared.clients().iter() {
            client.leave();
        }
        for thread in self.threads.drain(..) {
            thread.join().ok();
        }
    }
}

impl fmt::Debug for IgtlServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Server").field("address", &self.address).finish_non_exhaustive()
    }
}

impl fmt::Debug for IgtlShared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Shared").field("dropped", &self.dropped).finish_non_exhaustive()
    }
}

/// Accepts clients until the server ends, then waits for their threads.
fn listen(listener: &TcpListener, shared: &Arc<IgtlShared>) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !shared.is_ending() {
        match listener.accept() {
            Ok((stream, from)) => {
                info!(%from, "a client connects");
                take_in(stream, shared, &mut threads);
                sleep(AFTER_CLIENT);
            }
            // No client, or the operating system has no room for another connection now.
            Err(_) => sleep(LISTEN_EVERY),
        }
        threads.retain(|thread| !thread.is_finished());
    }
    for client in shared.clients().iter() {
        client.leave();
    }
    for thread in threads {
        thread.join().ok();
    }
}

/// Accepts a client, or closes its connection if that is impossible.
fn take_in(stream: TcpStream, shared: &Arc<IgtlShared>, threads: &mut Vec<JoinHandle<()>>) {
    let mut clients = shared.clients();
    clients.retain(|client| !client.is_gone());
    if clients.len() >= MAX_CLIENTS {
        drop(clients);
        warn!("a client is refused: {MAX_CLIENTS} are connected");
        return client::refuse(&stream, MAX_CLIENTS);
    }
    let Ok(client) = IgtlClient::new(stream) else { return };
    let client = Arc::new(client);
    clients.push(Arc::clone(&client));
    shared.set_due(f64::NEG_INFINITY);
    drop(clients);
    let begin = |name: &str, run: Box<dyn FnOnce() + Send>| Builder::new().name(name.to_owned()).spawn(run);
    let writer = Arc::clone(&client);
    let reader = Arc::clone(&client);
    let hurried = Arc::clone(shared);
    let writes = begin("igtl-writer", Box::new(move || writer.write()));
    let reads = begin("igtl-reader", Box::new(move || reader.read(|| hurried.hurry(), &hurried.images)));
    if let Err(error) = writes.as_ref().and(reads.as_ref()) {
        warn!(%error, "a client is left: no thread");
        client.leave();
    }
    threads.extend([writes, reads].into_iter().flatten());
}

/// Input of the hub.
type HubReceiver = Receiver<HubMessage>;
