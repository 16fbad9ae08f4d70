//! The connection to the console's `OpenIGTLink` server.

use std::{
    io::{self, Read as _, Write as _},
    net::{SocketAddr, TcpStream},
    time::Duration,
};

use nima_bridges::igtl::{Content, ContentKind, ContentStream, IgtlHeader, IgtlMessage, Verb};

const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum body that is read, bytes; ours are shorter.
const LONGEST: u64 = 1 << 16;

#[derive(Debug)]
pub struct Ros2Link(TcpStream);

impl Ros2Link {
    /// Connects, and requests poses with quaternions, forces and states at this rate.
    pub fn open(address: SocketAddr, rate_hz: u32) -> io::Result<Self> {
        let stream = TcpStream::connect_timeout(&address, PATIENCE)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        let mut link = Self(stream);
        let interval = ContentStream { interval_ms: 1000 / rate_hz, frame: "world".to_owned() };
        link.ask(Verb::Start, ContentKind::Tracking, Some(interval))?;
        for kind in [ContentKind::Tracking, ContentKind::Transform, ContentKind::Text] {
            link.ask(Verb::Stop, kind, None)?;
        }
        link.ask(Verb::Start, ContentKind::Position, None)?;
        Ok(link)
    }

    fn ask(&mut self, verb: Verb, kind: ContentKind, stream: Option<ContentStream>) -> io::Result<()> {
        self.0.write_all(&IgtlMessage::new("", 0, Content::Request(verb, kind, stream)).encode())
    }

    /// Waits for the next message. A status arrives once per second.
    pub fn next(&mut self) -> io::Result<IgtlMessage> {
        let wrong = |error| io::Error::new(io::ErrorKind::InvalidData, error);
        let mut head = [0; IgtlHeader::BYTES];
        self.0.read_exact(&mut head)?;
        let header = IgtlHeader::read(&head).map_err(wrong)?;
        if header.body_bytes > LONGEST {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a message that is too long"));
        }
        let mut body = vec![0; header.body_bytes as usize];
        self.0.read_exact(&mut body)?;
        IgtlMessage::read(&header, &body).map_err(wrong)
    }
}
