//! Motion JPEG over HTTP/1.1, as sent by cameras: an endless response whose parts are images.
//!
//! A separate client, because little is needed: one request, more where the camera asks for a password or redirects
//! within itself, no encryption. Everything that the other end decides is limited: the length of heads and pictures, and
//! how long they take.

mod answer;
mod chunked;
mod head;

use std::{
    collections::VecDeque,
    io::{self, ErrorKind, Read as _, Write as _},
    net::{TcpStream, ToSocketAddrs as _},
    time::{Duration, Instant},
};

use http_auth::{PasswordClient, PasswordParams};
use nima_files::public_address;

use self::answer::{HttpAnswer, HttpFault, ImagePart};
use crate::{Address, CompressedFrame, EndoscopeError, Endpoint, ImageSource};

/// Time for connecting to one address of the camera, and maximum number of addresses tried.
const CONNECT: Duration = Duration::from_millis(500);
const ADDRESSES_MAX: usize = 4;
/// After this time without data, the connection is closed and reopened.
const SILENT: Duration = Duration::from_secs(2);
/// Maximum time for a head or an image; otherwise a camera that sends single bytes would block the screen forever.
const SLOW: Duration = Duration::from_secs(5);
/// Interval at which the thread checks whether images are still needed.
const PATIENCE: Duration = Duration::from_millis(100);
/// Maximum number of redirects, as in a loop.
const REDIRECTS_MAX: usize = 3;
const READ_BYTES: usize = 64 << 10;

/// A camera that is sending.
pub(crate) struct Http {
    endpoint: Endpoint,
    place: String,
    stream: TcpStream,
    has_logged_in: bool,
    /// Number of redirects that were followed.
    redirects: usize,
    answer: HttpAnswer,
    parts: VecDeque<ImagePart>,
    buffer: Vec<u8>,
    /// When the last byte arrived, and when the last image was complete.
    received: Instant,
    whole: Instant,
    ended: bool,
}

impl Http {
    pub(crate) fn open(endpoint: &Endpoint) -> Result<Self, EndoscopeError> {
        let stream = ask(endpoint, None)?;
        let now = Instant::now();
        let buffer = vec![0; READ_BYTES];
        Ok(Self {
            endpoint: endpoint.clone(),
            place: endpoint.place(),
            stream,
            has_logged_in: false,
            redirects: 0,
            answer: HttpAnswer::default(),
            parts: VecDeque::new(),
            buffer,
            received: now,
            whole: now,
            ended: false,
        })
    }

    /// Repeats the request once with user and password; returns false if the address has none, or if the camera's
    /// authentication method is not supported.
    fn log_in(&mut self, challenges: &[String]) -> Result<bool, EndoscopeError> {
        let Some(login) = self.endpoint.login.as_ref().filter(|_| !self.has_logged_in) else { return Ok(false) };
        let Ok(mut client) = PasswordClient::try_from(challenges.join(", ").as_str()) else { return Ok(false) };
        let parameters = PasswordParams {
            username: &login.user,
            password: &login.password,
            uri: &self.endpoint.path,
            method: "GET",
            body: None,
        };
        let Ok(authorization) = client.respond(&parameters) else { return Ok(false) };
        self.stream = ask(&self.endpoint, Some(&authorization))?;
        self.answer = HttpAnswer::default();
        self.has_logged_in = true;
        Ok(true)
    }

    /// Requests the images at another address of the same camera. A camera that was typed in must not lead to another
    /// host, which would also receive the password.
    fn follow(&mut self, location: &str) -> Result<bool, EndoscopeError> {
        let refused = || EndoscopeError::Redirected { place: self.place.clone(), to: shown(location) };
        let target = redirected(&self.endpoint, location).filter(|_| self.redirects < REDIRECTS_MAX);
        let target = target.ok_or_else(refused)?;
        self.stream = ask(&target, None)?;
        self.place = target.place();
        self.endpoint = target;
        self.answer = HttpAnswer::default();
        self.has_logged_in = false;
        self.redirects += 1;
        Ok(true)
    }

    fn trouble(&self, wrong: HttpFault) -> EndoscopeError {
        let place = self.place.clone();
        match wrong {
            HttpFault::Status(status) => EndoscopeError::Refused { place, status },
            HttpFault::Locked(_) => EndoscopeError::Refused { place, status: 401 },
            HttpFault::Moved(location) => EndoscopeError::Redirected { place, to: shown(&location) },
            HttpFault::Format(found) => EndoscopeError::OtherFormat { place, found, wanted: "motion JPEG" },
            HttpFault::Unreadable(reason) => EndoscopeError::Unreadable { place, reason: reason.to_owned() },
            HttpFault::Ended => EndoscopeError::Closed { place },
        }
    }

    /// Reads the available data; false if there are none.
    fn read(&mut self) -> Result<bool, EndoscopeError> {
        match self.stream.read(&mut self.buffer) {
            Ok(0) => Err(EndoscopeError::Closed { place: self.place.clone() }),
            Ok(count) => {
                self.received = Instant::now();
                // Images that were complete before a failure are still shown.
                match self.answer.take(&self.buffer[..count], &mut self.parts) {
                    Ok(()) => Ok(true),
                    Err(HttpFault::Locked(challenges)) if self.log_in(&challenges)? => Ok(true),
                    Err(HttpFault::Moved(location)) => self.follow(&location),
                    Err(wrong) => Err(self.trouble(wrong)),
                }
            }
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) =>
            {
                Ok(false)
            }
            Err(error) => Err(EndoscopeError::of_network(&self.place, &error)),
        }
    }
}

/// Returns the endpoint to which a camera redirects; `None` if it is another host, encrypted or not an address.
fn redirected(from: &Endpoint, location: &str) -> Option<Endpoint> {
    let location = location.split('#').next().unwrap_or_default();
    let sound = location.len() <= 2000 && location.chars().all(|letter| letter.is_ascii_graphic());
    if !sound || location.is_empty() {
        return None;
    }
    if location.contains("://") || location.starts_with("//") {
        let whole = if location.starts_with("//") { format!("http:{location}") } else { location.to_owned() };
        let Ok(Address::Http(target)) = whole.parse() else { return None };
        let is_same = target.host.eq_ignore_ascii_case(&from.host) && target.login.is_none();
        return is_same.then(|| Endpoint { login: from.login.clone(), ..target });
    }
    let folder = from.path.split('?').next().and_then(|path| path.rsplit_once('/')).map_or("", |(folder, _)| folder);
    let path = if location.starts_with('/') { location.to_owned() } else { format!("{folder}/{location}") };
    Some(Endpoint { path, ..from.clone() })
}

/// Returns an address from the other end for a message: short, and without passwords.
fn shown(location: &str) -> String {
    public_address(location).chars().filter(char::is_ascii_graphic).take(100).collect()
}

/// Connects to the camera and requests its images.
fn ask(endpoint: &Endpoint, authorization: Option<&str>) -> Result<TcpStream, EndoscopeError> {
    let mut stream = connect(endpoint)?;
    let place = endpoint.place();
    let report = |error: io::Error| EndoscopeError::of_network(&place, &error);
    stream.set_nodelay(true).map_err(report)?;
    stream.set_write_timeout(Some(CONNECT)).map_err(report)?;
    stream.set_read_timeout(Some(PATIENCE)).map_err(report)?;
    let authorization = authorization.map(|value| format!("Authorization: {value}\r\n")).unwrap_or_default();
    let request = format!(
        "GET {} HTTP/1.1\r\nHost: {place}\r\nUser-Agent: nima\r\nAccept: multipart/x-mixed-replace, image/jpeg\r\n{authorization}Connection: close\r\n\r\n",
        endpoint.path
    );
    stream.write_all(request.as_bytes()).map_err(report)?;
    Ok(stream)
}

/// Connects to the first address of the camera that responds.
pub(crate) fn connect(endpoint: &Endpoint) -> Result<TcpStream, EndoscopeError> {
    let place = endpoint.place();
    let no_such_name = || EndoscopeError::NoSuchName { place: place.clone() };
    let addresses = (endpoint.host.as_str(), endpoint.port).to_socket_addrs().map_err(|_| no_such_name())?;
    let mut last = no_such_name();
    for address in addresses.take(ADDRESSES_MAX) {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = EndoscopeError::of_network(&place, &error),
        }
    }
    Err(last)
}

impl ImageSource for Http {
    fn next(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        let begin = Instant::now();
        loop {
            if let Some(part) = self.parts.pop_front() {
                self.whole = self.received;
                return Ok(Some(CompressedFrame::jpeg(part.body, self.received, part.stamp_s)));
            }
            if self.ended {
                return Err(EndoscopeError::Closed { place: self.place.clone() });
            }
            match self.read() {
                Ok(true) => {}
                Ok(false) if self.received.elapsed() > SILENT => {
                    return Err(EndoscopeError::Silent { place: self.place.clone() });
                }
                Ok(false) => return Ok(None),
                Err(EndoscopeError::Closed { .. }) => self.ended = true,
                Err(trouble) => return Err(trouble),
            }
            if self.parts.is_empty() && self.whole.elapsed() > SLOW {
                let reason = format!("an image took longer than {} s", SLOW.as_secs());
                return Err(EndoscopeError::Unreadable { place: self.place.clone(), reason });
            }
            if begin.elapsed() > PATIENCE && self.parts.is_empty() {
                return Ok(None);
            }
        }
    }
}

#[cfg(test)]
mod tests;
