//! The watcher's end: finds rigs and shows their screens.

use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use nima_session::{
    monitor_stream::{MonitorMoment, WatchError, read},
    remote_copy::SessionHead,
};
use zenoh::{Session, Wait as _, bytes::ZBytes, liveliness::LivelinessToken, pubsub::Subscriber, sample::SampleKind};

use crate::{DepartmentError, MachineIdentity, config, keys};

/// Timeout for a rig's answer.
const ANSWER: Duration = Duration::from_secs(3);

/// Description of a rig and its running session.
#[derive(Clone, PartialEq, prost::Message)]
pub struct RigInfo {
    #[prost(string, tag = "1")]
    pub department: String,
    /// Name there.
    #[prost(string, tag = "2")]
    pub name: String,
    /// Name and version of its program; empty before the first session.
    #[prost(string, tag = "3")]
    pub program: String,
    /// Identifies its running session; 0 if there is none.
    #[prost(uint64, tag = "4")]
    pub session: u64,
    /// Start of the session, ns since 1970 (UTC).
    #[prost(fixed64, tag = "5")]
    pub started_ns: u64,
    /// Rig file.
    #[prost(string, tag = "6")]
    pub rig: String,
    /// Scene file.
    #[prost(string, tag = "7")]
    pub scene: String,
}

impl RigInfo {
    pub(crate) fn of(own: &MachineIdentity) -> Self {
        Self { department: own.department.clone(), name: own.name.clone(), ..Self::default() }
    }

    pub(crate) fn begins(&mut self, head: &SessionHead) {
        let SessionHead { session, program, started_ns, .. } = head;
        self.session = *session;
        self.program.clone_from(program);
        self.started_ns = *started_ns;
        self.rig = String::new();
        self.scene = String::new();
    }

    pub(crate) fn file(&mut self, name: &str, text: String) {
        match name {
            "rig.toml" => self.rig = text,
            "scene.toml" => self.scene = text,
            _ => {}
        }
    }

    pub(crate) const fn ends(&mut self) {
        self.session = 0;
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct FoundRig {
    /// The first of its addresses that answered.
    pub address: String,
    /// Description.
    pub about: RigInfo,
    /// Number of its watchers.
    pub watchers: usize,
}

/// Finds the rigs of this department that answer in the local network within this time, sorted by name.
///
/// # Errors
/// [`DepartmentError`] if the network cannot be used.
pub fn find(own: &MachineIdentity, wait: Duration) -> Result<Vec<FoundRig>, DepartmentError> {
    let unsent =
        |why: zenoh::Error| DepartmentError::Connect { address: "any address".to_owned(), why: why.to_string() };
    let (to, came) = crossbeam_channel::unbounded();
    let answered = move |hello: zenoh::scouting::Hello| drop(to.send(hello));
    let scout = zenoh::scout(zenoh::config::WhatAmI::Router, config::scout()?).callback(answered).wait();
    let scout = scout.map_err(unsent)?;
    std::thread::sleep(wait);
    scout.stop();
    let mut hellos: Vec<_> = came.try_iter().collect();
    hellos.sort_by_key(|hello| hello.zid().to_string());
    hellos.dedup_by_key(|hello| hello.zid().to_string());
    let at = |hello: &zenoh::scouting::Hello| {
        let addresses = hello.locators().iter().filter_map(|at| at.as_str().strip_prefix("tls/").map(str::to_owned));
        // Others may answer too: rigs of another department, and programs that are not rigs.
        addresses.into_iter().find_map(|address| find_at(own, &address).ok())
    };
    let mut found: Vec<FoundRig> = hellos.iter().filter_map(at).collect();
    found.sort_by(|a, b| a.about.name.cmp(&b.about.name));
    Ok(found)
}

/// Returns the rig at this address.
///
/// # Errors
/// [`DepartmentError`] if no rig of this department answers there.
pub fn find_at(own: &MachineIdentity, address: &str) -> Result<FoundRig, DepartmentError> {
    let rig = RemoteRig::connect(own, address)?;
    Ok(FoundRig { address: address.to_owned(), about: rig.about()?, watchers: rig.watchers() })
}

pub struct RemoteRig {
    pub(crate) session: Session,
    pub(crate) name: String,
    address: String,
    /// Announces the watcher to the rig.
    token: Option<LivelinessToken>,
}

impl RemoteRig {
    /// Connects to the rig at this address (`HOST:PORT`), to watch it.
    ///
    /// # Errors
    /// [`DepartmentError`] if no rig of this department answers there.
    pub fn open(own: &MachineIdentity, address: &str) -> Result<Self, DepartmentError> {
        let mut rig = Self::connect(own, address)?;
        let key = keys::watcher(&rig.name, &format!("{}-{}", own.name, rig.session.zid()));
        rig.token = rig.session.liveliness().declare_token(key).wait().ok();
        Ok(rig)
    }

    fn connect(own: &MachineIdentity, address: &str) -> Result<Self, DepartmentError> {
        let failed = |why: String| DepartmentError::Connect { address: address.to_owned(), why };
        let session = zenoh::open(config::watcher(own, address)?).wait().map_err(|error| failed(error.to_string()))?;
        let present = session.liveliness().get(keys::PRESENCES).timeout(ANSWER).wait();
        let replies = present.map_err(|error| failed(error.to_string()))?;
        let mut names = replies.into_iter().filter_map(|reply| {
            let sample = reply.into_result().ok()?;
            keys::rig_of(sample.key_expr().as_str()).map(str::to_owned)
        });
        let name = names.next().ok_or_else(|| failed("the program there shares no rig".to_owned()))?;
        Ok(Self { session, name, address: address.to_owned(), token: None })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn address(&self) -> &str {
        &self.address
    }

    /// Returns its description.
    ///
    /// # Errors
    /// [`DepartmentError`] if it does not answer.
    pub fn about(&self) -> Result<RigInfo, DepartmentError> {
        let answer = self.ask(&keys::about(&self.name))?;
        let answer = answer.ok_or_else(|| self.silent("no answer in time"))?;
        prost::Message::decode(answer.to_bytes().as_ref()).map_err(|error| self.silent(&error.to_string()))
    }

    pub(crate) fn silent(&self, why: &str) -> DepartmentError {
        DepartmentError::Silent { rig: self.name.clone(), why: why.to_owned() }
    }

    pub(crate) fn ask(&self, key: &str) -> Result<Option<ZBytes>, DepartmentError> {
        let replies = self.session.get(key).timeout(ANSWER).wait().map_err(|error| self.silent(&error.to_string()))?;
        Ok(replies.into_iter().find_map(|reply| Some(reply.into_result().ok()?.payload().clone())))
    }

    fn watchers(&self) -> usize {
        let replies = self.session.liveliness().get(keys::watchers(&self.name)).timeout(ANSWER).wait();
        replies.map_or(0, |replies| replies.into_iter().filter(|reply| reply.result().is_ok()).count())
    }

    /// Calls `each` with the content of its screen, until the returned value is dropped; `each` must not block. The
    /// number identifies the session, as in [`RigInfo`].
    ///
    /// # Errors
    /// [`DepartmentError`] if the rig cannot be queried.
    pub fn watch(
        &self,
        each: impl Fn(u64, Result<Vec<MonitorMoment>, WatchError>) + Send + Sync + 'static,
    ) -> Result<RigWatcher, DepartmentError> {
        let received = move |sample: zenoh::sample::Sample| {
            if sample.kind() == SampleKind::Delete {
                return;
            }
            let message = sample.payload().to_bytes();
            let Some((session, packed)) = message.split_first_chunk::<8>() else { return each(0, read(&[])) };
            let moments = read(&keys::unpack(packed).unwrap_or_default());
            each(u64::from_le_bytes(*session), moments);
        };
        let watching = self.session.declare_subscriber(keys::moments(&self.name)).callback(received).wait();
        Ok(RigWatcher(watching.map_err(|error| self.silent(&error.to_string()))?))
    }

    /// Monitors whether it is reachable.
    ///
    /// # Errors
    /// [`DepartmentError`] if this cannot be monitored.
    pub fn presence(&self) -> Result<Presence, DepartmentError> {
        let there = Arc::new(AtomicU64::new(1));
        let report = Arc::clone(&there);
        let changed = move |sample: zenoh::sample::Sample| {
            report.store(u64::from(sample.kind() == SampleKind::Put), Ordering::Relaxed);
        };
        let key = keys::presence(&self.name);
        let subscriber = self.session.liveliness().declare_subscriber(key).history(true).callback(changed).wait();
        Ok(Presence { there, _subscriber: subscriber.map_err(|error| self.silent(&error.to_string()))? })
    }
}

impl Drop for RemoteRig {
    fn drop(&mut self) {
        self.session.close().wait().ok();
    }
}

impl fmt::Debug for RemoteRig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rig").field("name", &self.name).field("address", &self.address).finish_non_exhaustive()
    }
}

/// A rig is watched while this exists.
#[derive(Debug)]
pub struct RigWatcher(#[expect(dead_code, reason = "its drop ends it")] Subscriber<()>);

/// Whether a rig is reachable.
#[derive(Debug)]
pub struct Presence {
    there: Arc<AtomicU64>,
    _subscriber: Subscriber<()>,
}

impl Presence {
    pub fn is_there(&self) -> bool {
        self.there.load(Ordering::Relaxed) != 0
    }
}
