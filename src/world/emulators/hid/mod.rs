//! Emulated caps and pedals on a socket of packets, and an emulated `spacenavd` on its stream.
//!
//! A client gets one packet that tells who the device is, `nima-hid VVVV:PPPP SERIAL NAME`, then one packet per report, as from a hidraw
//! node; what it sends are output reports. Faults that a human interface device cannot have (checksums, status bits) do
//! nothing; "not a number" is an axis far beyond its range, or a keyboard that cannot tell its keys.

use std::{
    io::{self, Read as _, Write as _},
    os::unix::{
        fs::FileTypeExt as _,
        net::{UnixListener, UnixStream},
    },
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_devices::{
    CapReading, PedalReading,
    hid::{
        cap_codec::{self, CapReport, counts_of},
        pedal_codec::{self, Layout},
        seqpacket,
        source::HidIdentity,
        spacenavd::Event,
    },
};

use crate::emulators::{EmulatedFault, FaultSwitch, FaultyLine, Serving};

mod models;
#[cfg(test)]
mod tests;
pub use models::{CapBody, CapModel, PedalBody, PedalModel};
use models::{CapSide, PedalSide, SpacenavdSide};

/// Where an emulator listens.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Place {
    /// In a folder of its own, which goes away with it.
    #[default]
    Temporary,
    /// At this path. What a dead process left there is replaced; folders above it are made.
    Path(PathBuf),
}

/// One side of the wire: makes what the device sends.
trait Side: Send {
    /// Between two steps.
    fn period(&self) -> Duration;
    /// What a new client is told first.
    fn hello(&self) -> Option<String>;
    /// Packets or a stream.
    fn listen(&self, path: &std::path::Path) -> io::Result<UnixListener>;
    /// Makes the frames of this step.
    fn step(&mut self, now_s: f64, fault: EmulatedFault, send: &mut dyn FnMut(&[u8]));
    /// Takes what a client sent.
    fn command(&mut self, bytes: &[u8]);
}

/// Serves an emulated cap.
pub fn serve_cap(place: Place, model: CapModel, body: CapBody) -> io::Result<Serving> {
    serve(place, "spacemouse", "emulated:", CapSide::new(model, body))
}

/// Serves an emulated pedal.
pub fn serve_pedal(place: Place, model: PedalModel, body: PedalBody) -> io::Result<Serving> {
    serve(place, "pedal", "emulated:", PedalSide::new(model, body))
}

/// Serves an emulated `spacenavd` with one cap.
pub fn serve_spacenavd(place: Place, body: CapBody) -> io::Result<Serving> {
    serve(place, "spnav", "spacenavd:", SpacenavdSide::new(body))
}

fn serve(place: Place, name: &str, prefix: &str, side: impl Side + 'static) -> io::Result<Serving> {
    let (path, folder) = match place {
        Place::Path(path) => {
            clear(&path)?;
            (path, None)
        }
        Place::Temporary => {
            let folder = tempfile::Builder::new().prefix("nima-").tempdir()?;
            (folder.path().join(format!("{name}.sock")), Some(folder))
        }
    };
    let listener = Some(side.listen(&path)?);
    let faults = FaultSwitch::default();
    let endpoint = format!("{prefix}{}", path.display());
    let mut server = Server { path, listener, clients: Vec::new(), line: FaultyLine::default(), side };
    Serving::start(endpoint, faults.clone(), move |stop| {
        server.run(stop, &faults);
        drop(folder);
    })
}

/// Makes room for a socket: nothing may be there but one that nobody serves any more.
fn clear(path: &Path) -> io::Result<()> {
    let refuse = |kind, told: &str| Err(io::Error::new(kind, format!("{} {told}", path.display())));
    if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        nima_devices::own_folder::prepare(parent)?;
    }
    match std::fs::symlink_metadata(path) {
        Err(_) => Ok(()),
        Ok(there) if !there.file_type().is_socket() => {
            refuse(io::ErrorKind::AlreadyExists, "is no emulator's: take another place, or remove it")
        }
        Ok(_) => match seqpacket::connect(path) {
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => std::fs::remove_file(path),
            _ => refuse(io::ErrorKind::AddrInUse, "is served by another emulator: end it, or take another place"),
        },
    }
}

struct Server<S> {
    path: PathBuf,
    listener: Option<UnixListener>,
    clients: Vec<UnixStream>,
    line: FaultyLine,
    side: S,
}

impl<S: Side> Server<S> {
    fn run(&mut self, stop: &AtomicBool, faults: &FaultSwitch) {
        let begin = Instant::now();
        let mut due = begin;
        while !stop.load(Ordering::Acquire) {
            let fault = faults.get();
            if fault == EmulatedFault::Disconnect {
                self.unplug();
            } else {
                self.plug();
            }
            self.accept();
            self.step(begin.elapsed().as_secs_f64(), fault);
            self.hear();
            due += self.side.period();
            // After a pause of the whole machine: no burst.
            due = due.max(Instant::now());
            std::thread::sleep(due - Instant::now());
        }
        self.unplug();
    }

    fn plug(&mut self) {
        if self.listener.is_none() {
            self.listener = self.side.listen(&self.path).ok();
        }
    }

    fn unplug(&mut self) {
        self.clients.clear();
        if self.listener.take().is_some() {
            std::fs::remove_file(&self.path).ok();
        }
    }

    fn accept(&mut self) {
        while let Some((client, _)) = self.listener.as_ref().and_then(|listener| listener.accept().ok()) {
            let told = client.set_nonblocking(true).is_ok()
                && self.side.hello().is_none_or(|hello| (&client).write_all(hello.as_bytes()).is_ok());
            if told {
                self.clients.push(client);
            }
        }
    }

    fn step(&mut self, now_s: f64, fault: EmulatedFault) {
        let Self { clients, line, side, .. } = self;
        // A client that does not read loses reports, as with a real node; one that is gone is noticed when hearing.
        let mut out = |bytes: &[u8]| clients.iter_mut().for_each(|client| drop(client.write(bytes)));
        line.pass(now_s, &[], fault, &mut out);
        side.step(now_s, fault, &mut |frame| line.pass(now_s, frame, fault, &mut out));
    }

    fn hear(&mut self) {
        let Self { clients, side, .. } = self;
        let mut buffer = [0; 64];
        clients.retain_mut(|client| match client.read(&mut buffer) {
            Ok(0) => false,
            Ok(count) => {
                side.command(&buffer[..count]);
                true
            }
            Err(error) => matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted),
        });
    }
}
