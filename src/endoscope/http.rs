//! Motion JPEG over HTTP/1.1, as sent by cameras: an endless response whose parts are images.
//!
//! Our own client, because little is needed: one request, no redirection, no password, no encryption. Everything that
//! the other end determines is limited: the length of heads and images, and their duration.

mod answer;
mod chunked;
mod head;

use std::{
    collections::VecDeque,
    io::{ErrorKind, Read as _, Write as _},
    net::{TcpStream, ToSocketAddrs as _},
    time::{Duration, Instant},
};

use self::answer::{Answer, Part, Wrong};
use crate::{Compressed, Source, Trouble};

/// Time for connecting to one address of the camera, and maximum number of addresses tried.
const CONNECT: Duration = Duration::from_millis(500);
const ADDRESSES_MOST: usize = 4;
/// After this time without data the connection is closed and opened again.
const SILENT: Duration = Duration::from_secs(2);
/// Maximum time for a head or an image; a camera that sends byte after byte would otherwise block the screen for ever.
const SLOW: Duration = Duration::from_secs(5);
/// Interval at which the thread checks whether images are still needed.
const PATIENCE: Duration = Duration::from_millis(100);
const READ_BYTES: usize = 64 << 10;

/// A camera that is sending.
pub(crate) struct Http {
    place: String,
    stream: TcpStream,
    answer: Answer,
    parts: VecDeque<Part>,
    buffer: Vec<u8>,
    /// When the last byte arrived, and when the last image was complete.
    heard: Instant,
    whole: Instant,
    ended: bool,
}

impl Http {
    pub(crate) fn open(host: &str, port: u16, path: &str) -> Result<Self, Trouble> {
        let place = format!("{host}:{port}");
        let mut stream = connect(host, port, &place)?;
        let told = |error: std::io::Error| Trouble::of_network(&place, &error);
        stream.set_nodelay(true).map_err(told)?;
        stream.set_write_timeout(Some(CONNECT)).map_err(told)?;
        stream.set_read_timeout(Some(PATIENCE)).map_err(told)?;
        let name = if host.contains(':') { format!("[{host}]:{port}") } else { place.clone() };
        let request = format!(
            "GET {path} HTTP/1.1\r\nHost: {name}\r\nUser-Agent: nima\r\nAccept: multipart/x-mixed-replace, image/jpeg\r\nConnection: close\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).map_err(told)?;
        let now = Instant::now();
        let answer = Answer::default();
        let parts = VecDeque::new();
        let buffer = vec![0; READ_BYTES];
        Ok(Self { place, stream, answer, parts, buffer, heard: now, whole: now, ended: false })
    }

    fn trouble(&self, wrong: Wrong) -> Trouble {
        let place = self.place.clone();
        match wrong {
            Wrong::Status(status) => Trouble::Refused { place, status },
            Wrong::Format(found) => Trouble::OtherFormat { place, found, wanted: "motion JPEG" },
            Wrong::Unreadable(reason) => Trouble::Unreadable { place, reason: reason.to_owned() },
            Wrong::Ended => Trouble::Closed { place },
        }
    }

    /// Reads the available data; false if there are none.
    fn read(&mut self) -> Result<bool, Trouble> {
        match self.stream.read(&mut self.buffer) {
            Ok(0) => Err(Trouble::Closed { place: self.place.clone() }),
            Ok(count) => {
                self.heard = Instant::now();
                // Images that were complete before a failure are still shown.
                let taken = self.answer.take(&self.buffer[..count], &mut self.parts);
                taken.map_err(|wrong| self.trouble(wrong))?;
                Ok(true)
            }
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) =>
            {
                Ok(false)
            }
            Err(error) => Err(Trouble::of_network(&self.place, &error)),
        }
    }
}

/// Connects to the first address of the camera that responds.
pub(crate) fn connect(host: &str, port: u16, place: &str) -> Result<TcpStream, Trouble> {
    let addresses = (host, port).to_socket_addrs().map_err(|_| Trouble::NoSuchName { place: place.to_owned() })?;
    let mut last = Trouble::NoSuchName { place: place.to_owned() };
    for address in addresses.take(ADDRESSES_MOST) {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = Trouble::of_network(place, &error),
        }
    }
    Err(last)
}

impl Source for Http {
    fn next(&mut self) -> Result<Option<Compressed>, Trouble> {
        let begin = Instant::now();
        loop {
            if let Some(part) = self.parts.pop_front() {
                self.whole = self.heard;
                return Ok(Some(Compressed::jpeg(part.body, self.heard, part.stamp_s)));
            }
            if self.ended {
                return Err(Trouble::Closed { place: self.place.clone() });
            }
            match self.read() {
                Ok(true) => {}
                Ok(false) if self.heard.elapsed() > SILENT => {
                    return Err(Trouble::Silent { place: self.place.clone() });
                }
                Ok(false) => return Ok(None),
                Err(Trouble::Closed { .. }) => self.ended = true,
                Err(trouble) => return Err(trouble),
            }
            if self.parts.is_empty() && self.whole.elapsed() > SLOW {
                let reason = format!("a picture took longer than {} s", SLOW.as_secs());
                return Err(Trouble::Unreadable { place: self.place.clone(), reason });
            }
            if begin.elapsed() > PATIENCE && self.parts.is_empty() {
                return Ok(None);
            }
        }
    }
}

#[cfg(test)]
mod tests;
