//! Who holds a follower, and its hand-over by consent: one byte in every report, and in the next datagram when it changes.
//!
//! The byte says what is, not what has happened, so that a lost datagram changes nothing: a console asks for as long as it wants, the
//! follower passes the question on for as long as it is open, and the holder's answer carries the question's number.

/// What a console is to its follower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Standing {
    /// Not told yet.
    #[default]
    Unknown,
    /// It holds the follower: its payloads count, and it gets the follower's.
    Holds,
    /// Another console holds it.
    Waits,
    /// Nobody holds it: it is free for the first who asks.
    Free,
}

/// In the byte of both directions: the sender ends the session.
const GOODBYE: u8 = 0x80;

/// The byte of a follower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FromFollower {
    /// What the console is.
    pub(crate) standing: Standing,
    /// Another console asks for control: the number of the question, 1 to 3.
    pub(crate) asked: u8,
    /// The holder has refused this console's question.
    pub(crate) is_denied: bool,
    /// The session ends.
    pub(crate) goodbye: bool,
}

impl FromFollower {
    pub(crate) const fn byte(self) -> u8 {
        let standing = match self.standing {
            Standing::Unknown => 0,
            Standing::Holds => 1,
            Standing::Waits => 2,
            Standing::Free => 3,
        };
        standing | ((self.asked & 3) << 2) | ((self.is_denied as u8) << 4) | (self.goodbye as u8 * GOODBYE)
    }

    pub(crate) const fn from_byte(byte: u8) -> Self {
        let standing = match byte & 3 {
            1 => Standing::Holds,
            2 => Standing::Waits,
            3 => Standing::Free,
            _ => Standing::Unknown,
        };
        Self { standing, asked: (byte >> 2) & 3, is_denied: (byte >> 4) & 1 != 0, goodbye: byte & GOODBYE != 0 }
    }
}

/// The byte of a console.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FromConsole {
    /// It asks for control.
    pub(crate) asks: bool,
    /// Its answer to the question with this number; 0 for none.
    pub(crate) answers: u8,
    /// What it answers.
    pub(crate) consents: bool,
    /// The session ends.
    pub(crate) goodbye: bool,
}

impl FromConsole {
    pub(crate) const fn byte(self) -> u8 {
        self.asks as u8 | ((self.consents as u8) << 1) | ((self.answers & 3) << 2) | (self.goodbye as u8 * GOODBYE)
    }

    pub(crate) const fn from_byte(byte: u8) -> Self {
        Self { asks: byte & 1 != 0, consents: byte & 2 != 0, answers: (byte >> 2) & 3, goodbye: byte & GOODBYE != 0 }
    }
}

/// Why a link does not carry payloads, or not as it should.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The other side has ended the session: its program was closed.
    PeerClosed,
    /// Nothing has come for this long, s: the cable, the network, or a machine that stands still.
    Silent {
        /// Since the last datagram, s.
        for_s: f64,
    },
    /// One of the two clocks was set: their clock minus ours has changed by this, s. It is told for a second.
    ClockJumped {
        /// Change, s.
        by_s: f64,
    },
    /// Another console holds this follower.
    HeldByAnother,
    /// Nobody holds the follower, this console neither: it was taken from it, or its holder has gone.
    NotAsked,
    /// The other side refuses a session.
    Refused(Refusal),
}

/// Why no session is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The other side speaks another version of the protocol: this one. Install the same version on both machines.
    Version(u8),
    /// The other side does not know this key, or has another one itself: pair the two machines.
    Key,
    /// Too many consoles at once.
    Full,
}

impl Refusal {
    pub(crate) const fn bytes(self) -> [u8; 2] {
        match self {
            Self::Version(version) => [1, version],
            Self::Key => [2, 0],
            Self::Full => [3, 0],
        }
    }

    pub(crate) const fn from_bytes(bytes: [u8; 2]) -> Option<Self> {
        match bytes {
            [1, version] => Some(Self::Version(version)),
            [2, _] => Some(Self::Key),
            [3, _] => Some(Self::Full),
            _ => None,
        }
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Version(version) => write!(
                f,
                "the other machine speaks version {version} of the protocol, this one {}; install the same version of nima on both",
                crate::wire::VERSION
            ),
            Self::Key => f.write_str("the other machine does not know this one's key; pair the two machines"),
            Self::Full => f.write_str("too many consoles are connected to this follower; close one"),
        }
    }
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::PeerClosed => f.write_str("the other side's program was closed"),
            Self::Silent { for_s } => {
                write!(f, "nothing has come for {for_s:.1} s; look at the cable, the network and the other machine")
            }
            Self::ClockJumped { by_s } => write!(f, "a clock jumped by {:.1} ms", by_s * 1e3),
            Self::HeldByAnother => f.write_str("another console holds this follower; ask for control"),
            Self::NotAsked => f.write_str("nobody holds this follower; ask for control"),
            Self::Refused(refusal) => refusal.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=u8::MAX {
            let used = byte & (GOODBYE | 0x1f);
            assert_eq!(FromFollower::from_byte(byte).byte(), used);
            assert_eq!(FromConsole::from_byte(byte).byte(), byte & (GOODBYE | 0xf));
        }
        for refusal in [Refusal::Version(7), Refusal::Key, Refusal::Full] {
            assert_eq!(Refusal::from_bytes(refusal.bytes()), Some(refusal));
        }
    }
}
