//! Control of a follower, and its transfer by consent: one byte in every report, and in the next datagram after a
//! change.
//!
//! The byte describes a state, not an event, so that a lost datagram changes nothing: a console repeats its request for
//! as long as it wants, the follower forwards the request for as long as it is open, and the controller's answer
//! carries the number of the request.

/// Status of a console for its follower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ControlState {
    /// Not received yet.
    #[default]
    Unknown,
    /// The console controls the follower: its payloads count, and it gets the follower's payloads.
    Holds,
    /// Another console has control.
    Waits,
    /// No console has control: the first one to request it gets it.
    Free,
}

/// In the byte of either direction: the sender ends the session.
const GOODBYE: u8 = 0x80;

/// The byte of a follower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FromFollower {
    /// Status of the console.
    pub(crate) standing: ControlState,
    /// Another console requests control: the number of the request, 1 to 3.
    pub(crate) asked: u8,
    /// The controlling console has refused this console's request.
    pub(crate) is_denied: bool,
    pub(crate) goodbye: bool,
}

impl FromFollower {
    pub(crate) const fn byte(self) -> u8 {
        let standing = match self.standing {
            ControlState::Unknown => 0,
            ControlState::Holds => 1,
            ControlState::Waits => 2,
            ControlState::Free => 3,
        };
        standing | ((self.asked & 3) << 2) | ((self.is_denied as u8) << 4) | (self.goodbye as u8 * GOODBYE)
    }

    pub(crate) const fn from_byte(byte: u8) -> Self {
        let standing = match byte & 3 {
            1 => ControlState::Holds,
            2 => ControlState::Waits,
            3 => ControlState::Free,
            _ => ControlState::Unknown,
        };
        Self { standing, asked: (byte >> 2) & 3, is_denied: (byte >> 4) & 1 != 0, goodbye: byte & GOODBYE != 0 }
    }
}

/// The byte of a console.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FromConsole {
    /// Whether it requests control.
    pub(crate) asks: bool,
    /// Answer to the request with this number; 0 for none.
    pub(crate) answers: u8,
    /// The answer.
    pub(crate) consents: bool,
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

/// Reason why a link carries no payloads, or carries them imperfectly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkCause {
    /// The other side has ended the session: its program was closed.
    PeerClosed,
    /// No data for this long, s: a problem of the cable, the network, or a stalled machine.
    Silent {
        /// Since the last datagram, s.
        for_s: f64,
    },
    /// Datagrams of others fill the socket, so that those of the other side are lost.
    Flooded,
    /// One of the two clocks was set: their clock minus ours has changed by this, s. Reported for a second.
    ClockJumped {
        /// Change, s.
        by_s: f64,
    },
    /// Another console has control of this follower.
    HeldByAnother,
    /// No console has control of the follower: it was withdrawn from this one, or the controlling console is gone.
    NotAsked,
    /// The other side refuses a session.
    Refused(SessionRefusal),
}

/// Why a session was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionRefusal {
    /// The other side uses this different version of the protocol. Install the same version on both machines.
    Version(u8),
    /// The other side does not have this key, or has changed its own: pair the two machines.
    Key,
    /// Too many consoles at once.
    Full,
}

impl SessionRefusal {
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

impl std::fmt::Display for SessionRefusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Version(version) => write!(
                f,
                "the other machine speaks version {version} of the protocol, this one {}; install the same version of nima on both",
                crate::wire::VERSION
            ),
            Self::Key => f.write_str("the other machine does not have this machine's key; pair the two machines"),
            Self::Full => f.write_str("too many consoles are connected to this follower; close one"),
        }
    }
}

impl std::fmt::Display for LinkCause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::PeerClosed => f.write_str("the program on the other machine was closed"),
            Self::Silent { for_s } => {
                write!(f, "no data for {for_s:.1} s; check the cable, the network and the other machine")
            }
            Self::ClockJumped { by_s } => {
                write!(f, "the clock of one of the two machines jumped by {:.1} ms", by_s * 1e3)
            }
            Self::HeldByAnother => f.write_str("another console controls this follower; request control"),
            Self::NotAsked => f.write_str("no console controls this follower; request control"),
            Self::Flooded => f.write_str(
                "other computers send so much to this port that data are lost: restrict the firewall to the other machine's address",
            ),
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
        for refusal in [SessionRefusal::Version(7), SessionRefusal::Key, SessionRefusal::Full] {
            assert_eq!(SessionRefusal::from_bytes(refusal.bytes()), Some(refusal));
        }
    }
}
