//! The rig's end: a thread that publishes the recorder's data, and answers late watchers.

use std::{
    fmt,
    net::SocketAddr,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::Duration,
};

use crossbeam_channel::{Receiver, Sender, bounded};
use nima_session::sinks::Audience;
use prost::Message as _;
use zenoh::{
    Session, Wait as _,
    key_expr::KeyExpr,
    liveliness::LivelinessToken,
    qos::{CongestionControl, Priority},
    query::{Query, Queryable},
};

use crate::{
    DepartmentError, MachineIdentity,
    config::{self, ScoutingMode},
    feed::{DepartmentFeed, FeedMessage},
    keys,
    retention::RetainedSession,
    watch::RigInfo,
};

/// Maximum backlog of the publishing thread: some seconds.
const BACKLOG: usize = 256;
/// Interval at which the thread checks whether to end.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// Approximate bytes of bundles in one answer. Small enough that current data are not delayed behind old ones.
const ANSWER_BYTES: usize = 512 << 10;

/// A rig that is shared with its department until this is dropped, for successive sessions.
pub struct SharedRig {
    to: Sender<FeedMessage>,
    dropped: Arc<AtomicU64>,
    session: Session,
    address: SocketAddr,
    name: String,
    watchers: Arc<AtomicU64>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    /// Dropped to withdraw the rig's declarations from zenoh.
    _offers: Offers,
}

struct Offers {
    _presence: LivelinessToken,
    _answers: [Queryable<()>; 3],
    _watchers: zenoh::pubsub::Subscriber<()>,
}

/// The state sent to late watchers.
#[derive(Debug)]
struct ShareState {
    about: RigInfo,
    kept: Option<RetainedSession>,
}

impl SharedRig {
    /// Shares this rig at this address.
    ///
    /// # Errors
    /// [`DepartmentError`] if this machine may only watch, or the address cannot be used.
    pub fn start(own: &MachineIdentity, address: SocketAddr, scouting: bool) -> Result<Self, DepartmentError> {
        let own = own.as_rig()?;
        let scouting = if scouting { ScoutingMode::Answers } else { ScoutingMode::Silent };
        let refused =
            |why: &dyn fmt::Display| DepartmentError::Listen { address: address.to_string(), why: why.to_string() };
        // Zenoh reports neither a port that is in use nor the free port that it selected.
        let address = free(address).map_err(|error| refused(&error))?;
        let session = zenoh::open(config::rig(own, &address.to_string(), scouting)?).wait();
        let session = session.map_err(|error| refused(&error))?;
        let state = Arc::new(Mutex::new(ShareState { about: RigInfo::of(own), kept: None }));
        let watchers = Arc::new(AtomicU64::new(0));
        let offers = offer(&session, &own.name, &state, &watchers).map_err(|error| refused(&error))?;
        let (to, report) = bounded(BACKLOG);
        let ends = Arc::new(AtomicBool::new(false));
        let thread = {
            let (session, state, name, ends) =
                (session.clone(), Arc::clone(&state), own.name.clone(), Arc::clone(&ends));
            let run = move || publish(&session, &name, &state, &report, &ends);
            std::thread::Builder::new().name("department".to_owned()).spawn(run).map_err(|error| refused(&error))?
        };
        Ok(Self {
            to,
            dropped: Arc::new(AtomicU64::new(0)),
            session,
            address,
            name: own.name.clone(),
            watchers,
            ends,
            thread: Some(thread),
            _offers: offers,
        })
    }

    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the number of connected watchers.
    pub fn watchers(&self) -> usize {
        usize::try_from(self.watchers.load(Ordering::Relaxed)).unwrap_or(usize::MAX)
    }

    /// Returns the number of entries that could not be published in time.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Returns the audience for the recorder of the next session.
    pub fn audience(&self) -> Box<dyn Audience> {
        Box::new(DepartmentFeed::new(self.to.clone(), Arc::clone(&self.dropped)))
    }
}

impl Drop for SharedRig {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
        self.session.close().wait().ok();
    }
}

impl fmt::Debug for SharedRig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Share").field("name", &self.name).field("address", &self.address).finish_non_exhaustive()
    }
}

/// Returns the address, with a free port if none is given.
fn free(address: SocketAddr) -> std::io::Result<SocketAddr> {
    std::net::TcpListener::bind(address)?.local_addr()
}

fn locked(state: &Mutex<ShareState>) -> std::sync::MutexGuard<'_, ShareState> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn offer(
    session: &Session,
    name: &str,
    state: &Arc<Mutex<ShareState>>,
    watchers: &Arc<AtomicU64>,
) -> zenoh::Result<Offers> {
    let answer = |key: String, answer: fn(&Query, &str, &Mutex<ShareState>)| {
        let state = Arc::clone(state);
        let name = name.to_owned();
        session.declare_queryable(key).callback(move |query| answer(&query, &name, &state)).wait()
    };
    let answers = [
        answer(keys::about(name), answer_about)?,
        answer(keys::head(name), answer_head)?,
        answer(keys::bundles(name), answer_bundles)?,
    ];
    let count = Arc::clone(watchers);
    let came_or_went = move |sample: zenoh::sample::Sample| {
        let change = |count: u64| match sample.kind() {
            zenoh::sample::SampleKind::Put => Some(count + 1),
            zenoh::sample::SampleKind::Delete => Some(count.saturating_sub(1)),
        };
        count.fetch_update(Ordering::Relaxed, Ordering::Relaxed, change).ok();
    };
    let watchers = session.liveliness().declare_subscriber(keys::watchers(name)).callback(came_or_went).wait()?;
    let presence = session.liveliness().declare_token(keys::presence(name)).wait()?;
    Ok(Offers { _presence: presence, _answers: answers, _watchers: watchers })
}

/// Answers this watcher on zenoh's thread: a slow reader does not delay others.
fn reply(query: &Query, key: String, payload: Vec<u8>) {
    let Ok(key) = KeyExpr::try_from(key) else { return };
    query.reply(key, payload).wait().ok();
}

fn answer_about(query: &Query, name: &str, state: &Mutex<ShareState>) {
    let about = locked(state).about.encode_to_vec();
    reply(query, keys::about(name), about);
}

fn answer_head(query: &Query, name: &str, state: &Mutex<ShareState>) {
    let head = locked(state).kept.as_ref().map(RetainedSession::head);
    if let Some(head) = head {
        reply(query, keys::head(name), head);
    }
}

fn answer_bundles(query: &Query, name: &str, state: &Mutex<ShareState>) {
    let Some(from) = query.parameters().get("from").and_then(|from| from.parse().ok()) else { return };
    let bundles = locked(state).kept.as_ref().map(|kept| kept.from(from, ANSWER_BYTES)).unwrap_or_default();
    for (number, packed) in bundles {
        reply(query, keys::bundle(name, number), packed.to_vec());
    }
}

/// Publishes until the end.
fn publish(
    session: &Session,
    name: &str,
    state: &Mutex<ShareState>,
    report: &Receiver<FeedMessage>,
    ends: &AtomicBool,
) {
    let put = |key: String, payload: Vec<u8>, priority| {
        session.put(key, payload).congestion_control(CongestionControl::Drop).priority(priority).wait().ok();
    };
    loop {
        let next = match report.recv_timeout(LOOK_EVERY) {
            Ok(next) => next,
            // A recorder may keep sending although no watcher is left.
            Err(_) if ends.load(Ordering::Relaxed) => return,
            Err(_) => continue,
        };
        match next {
            FeedMessage::Begins(head) => {
                let mut state = locked(state);
                state.about.begins(&head);
                state.kept = Some(RetainedSession::new(head));
            }
            FeedMessage::File(file, text) => locked(state).about.file(&file, text),
            FeedMessage::Bundle(bundle) => {
                let mut state = locked(state);
                // This is the end of a session that has already been followed by another one.
                let Some(kept) = state.kept.as_mut().filter(|kept| kept.session() == bundle.session) else { continue };
                let packed = kept.add(&bundle).to_vec();
                if bundle.closes {
                    state.about.ends();
                }
                drop(state);
                put(keys::bundle(name, bundle.number), packed, Priority::Background);
            }
            FeedMessage::Moments(session, moments) => {
                let mut message = session.to_le_bytes().to_vec();
                message.extend(keys::pack(&moments));
                put(keys::moments(name), message, Priority::InteractiveLow);
            }
        }
    }
}
