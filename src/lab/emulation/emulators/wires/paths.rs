//! Connections at a path of this computer.

use std::{
    fs, io,
    os::unix::net::{UnixListener, UnixStream},
    path::{Path, PathBuf},
};

use super::{
    WireEnd,
    connections::{ConnectionPlace, Connections},
};
use crate::emulators::addresses::socket_path;

type Listen = fn(&Path) -> io::Result<UnixListener>;

/// Returns a socket at `path`, opened by `listen`; without a path, at `name` in a temporary folder. Data that a client
/// does not read are dropped.
pub(in crate::emulators) fn socket(path: Option<&Path>, name: &str, listen: Listen) -> io::Result<Box<dyn WireEnd>> {
    let (path, folder) = socket_path(path, name)?;
    Ok(Box::new(Connections::new(SocketPath { path, _folder: folder, listen }, false)))
}

struct SocketPath {
    path: PathBuf,
    /// Own folder, if no path was requested.
    _folder: Option<tempfile::TempDir>,
    listen: Listen,
}

impl ConnectionPlace for SocketPath {
    type Listener = UnixListener;
    type Stream = UnixStream;
    const LOSES: bool = true;

    fn endpoint(&self) -> String {
        self.path.display().to_string()
    }

    fn listen(&mut self) -> io::Result<UnixListener> {
        let listener = (self.listen)(&self.path)?;
        listener.set_nonblocking(true)?;
        Ok(listener)
    }

    fn accept(listener: &UnixListener) -> io::Result<UnixStream> {
        let (stream, _) = listener.accept()?;
        stream.set_nonblocking(true)?;
        Ok(stream)
    }

    fn leave(&self) {
        fs::remove_file(&self.path).ok();
    }
}
