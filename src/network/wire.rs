//! The format of a datagram.
//!
//! Every datagram begins with the version of the protocol and its kind. Those of a handshake go on with [`MAGIC`] and a number that
//! their sender chose, so that an answer can be told from one that somebody made up who cannot see the question; these twelve bytes and
//! a refusal stay the same in every version. Those of a session go on with the number of the session at the receiver and the lower half
//! of their own number; what follows is encrypted: a [`Head`] with the time stamps, then the payloads, newest first.
//!
//! Numbers are little-endian.

/// Version of the protocol. Two machines of different versions refuse each other.
pub const VERSION: u8 = 1;
/// Longest datagram, bytes: passes through every usual network in one piece.
pub const DATAGRAM_MAX: usize = 1200;
/// What stands before the encrypted part of a datagram of a session, bytes.
pub const OUTER_LEN: usize = 10;
/// What the encryption adds, bytes.
pub const TAG_LEN: usize = 16;
/// Length of a [`Head`], bytes.
pub const HEAD_LEN: usize = 24;
/// What stands before each payload, bytes.
pub const RECORD_LEN: usize = 4;
/// Longest payload, bytes.
pub const PAYLOAD_MAX: usize = DATAGRAM_MAX - OUTER_LEN - TAG_LEN - HEAD_LEN - RECORD_LEN;
/// What IPv4 and UDP add to each datagram, bytes; it counts for the limit of the rate.
pub const UDP_LEN: usize = 28;
/// Most payloads in one datagram.
pub const COPIES_MAX: usize = 32;
/// An older payload is not carried again, s.
pub const AGE_MAX_S: f64 = 0.65;

/// In every datagram of a handshake, after version and kind.
pub const MAGIC: [u8; 4] = *b"nima";
/// Where the number that a handshake's sender chose begins.
const TOKEN_AT: usize = 6;
/// What stands before the content of a datagram of a handshake, bytes.
pub const HANDSHAKE_LEN: usize = TOKEN_AT + 8;
/// Shortest first datagram of a handshake, bytes: longer than every answer to a stranger, so that nobody can use this machine to
/// send more to somebody else than he sends himself.
pub const HELLO_LEN: usize = 128;
/// Longest datagram of a handshake, bytes.
pub const HANDSHAKE_MAX: usize = 256;
/// Unit of a payload's age, s.
const AGE_UNIT_S: f64 = 1e-5;

/// What a datagram is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A console asks for a cookie.
    Hello,
    /// The cookie.
    Cookie,
    /// The first message of the handshake, with the cookie.
    Initiation,
    /// The second message of the handshake.
    Response,
    /// No session will be made, with the cause.
    Refusal,
    /// Part of a session.
    Data,
    /// Pairing: see [`crate::pairing`].
    Pairing,
}

impl Kind {
    const ALL: [Self; 7] =
        [Self::Hello, Self::Cookie, Self::Initiation, Self::Response, Self::Refusal, Self::Data, Self::Pairing];

    const fn number(self) -> u8 {
        match self {
            Self::Hello => 1,
            Self::Cookie => 2,
            Self::Initiation => 3,
            Self::Response => 4,
            Self::Refusal => 5,
            Self::Data => 6,
            Self::Pairing => 7,
        }
    }
}

/// Why a datagram was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unreadable {
    /// Not of this protocol, cut, or with numbers that contradict each other.
    Malformed,
    /// Of a handshake of another version of this protocol.
    ForeignVersion(u8),
    /// As long and of the kind as one of a session, but of another version. It is never answered.
    ForeignData(u8),
}

/// Version and kind of a datagram.
///
/// # Errors
/// [`Unreadable`] if it is none of this version. Only a datagram with [`MAGIC`] is of a handshake of another version: random bytes are not.
pub fn kind(datagram: &[u8]) -> Result<Kind, Unreadable> {
    let [version, kind, ..] = *datagram else { return Err(Unreadable::Malformed) };
    let kind = Kind::ALL.into_iter().find(|known| known.number() == kind);
    match kind {
        Some(Kind::Data) if datagram.len() < OUTER_LEN + TAG_LEN + HEAD_LEN => Err(Unreadable::Malformed),
        Some(Kind::Data) if version != VERSION => Err(Unreadable::ForeignData(version)),
        Some(Kind::Data) => Ok(Kind::Data),
        _ if datagram.get(2..TOKEN_AT) != Some(&MAGIC) || datagram.len() < HANDSHAKE_LEN => Err(Unreadable::Malformed),
        // A refusal can be read in every version.
        Some(Kind::Refusal) => Ok(Kind::Refusal),
        _ if version != VERSION => Err(Unreadable::ForeignVersion(version)),
        Some(kind) => Ok(kind),
        None => Err(Unreadable::Malformed),
    }
}

/// The number that the sender of a handshake's datagram chose.
pub fn token(datagram: &[u8]) -> Option<u64> {
    datagram.get(TOKEN_AT..HANDSHAKE_LEN)?.try_into().ok().map(u64::from_le_bytes)
}

/// The first bytes of a datagram of a handshake.
pub fn handshake(kind: Kind, token: u64) -> [u8; HANDSHAKE_LEN] {
    let mut bytes = [0; HANDSHAKE_LEN];
    bytes[0] = VERSION;
    bytes[1] = kind.number();
    bytes[2..TOKEN_AT].copy_from_slice(&MAGIC);
    bytes[TOKEN_AT..].copy_from_slice(&token.to_le_bytes());
    bytes
}

/// The first bytes of a datagram of a session: the number of the session at the receiver, and the datagram's.
pub fn outer(session: u32, counter: u64) -> [u8; OUTER_LEN] {
    let mut bytes = [0; OUTER_LEN];
    bytes[0] = VERSION;
    bytes[1] = Kind::Data.number();
    bytes[2..6].copy_from_slice(&session.to_le_bytes());
    bytes[6..].copy_from_slice(&(counter as u32).to_le_bytes());
    bytes
}

/// The number of the session, the lower half of the datagram's number, and the encrypted part.
pub fn open_outer(datagram: &[u8]) -> Option<(u32, u32, &[u8])> {
    let (outer, sealed) = datagram.split_at_checked(OUTER_LEN)?;
    let session = u32::from_le_bytes(outer.get(2..6)?.try_into().ok()?);
    let counter = u32::from_le_bytes(outer.get(6..)?.try_into().ok()?);
    Some((session, counter, sealed))
}

/// The number with these lower bits that is nearest to `near`.
pub const fn whole(near: u64, low: u32) -> u64 {
    let ahead = low.wrapping_sub(near as u32).cast_signed();
    near.saturating_add_signed(ahead as i64)
}

/// What stands before the payloads, encrypted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// When the datagram was sent, by its sender's clock, µs (48 bits).
    pub sent_us: u64,
    /// Lower half of `sent_us` of the last datagram that the sender received, and how long before `sent_us` it came, µs.
    pub echo: Option<(u32, u32)>,
    /// Share of the datagrams that its sender missed lately, in 255ths.
    pub loss: u8,
    /// Of the datagrams after a missed one, the share that was missed too, in 255ths.
    pub loss_again: u8,
    /// Who holds the follower, and what is asked or answered: [`crate::control`].
    pub control: u8,
    /// Number of the newest payload, lower half.
    pub newest: u32,
    /// Number of payloads.
    pub count: u8,
}

/// In the flags of a head: the echo is there.
const ECHOES: u8 = 1;

impl Head {
    /// Its bytes.
    pub fn bytes(&self) -> [u8; HEAD_LEN] {
        let mut bytes = [0; HEAD_LEN];
        let (echo_us, held_us) = self.echo.unwrap_or_default();
        bytes[..6].copy_from_slice(&self.sent_us.to_le_bytes()[..6]);
        bytes[6..10].copy_from_slice(&echo_us.to_le_bytes());
        bytes[10..14].copy_from_slice(&held_us.to_le_bytes());
        bytes[14] = u8::from(self.echo.is_some()) * ECHOES;
        bytes[15] = self.loss;
        bytes[16] = self.loss_again;
        bytes[17] = self.control;
        bytes[18..22].copy_from_slice(&self.newest.to_le_bytes());
        bytes[22] = self.count;
        bytes
    }

    /// From its bytes, with what follows them.
    pub fn from_bytes(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (head, records) = bytes.split_first_chunk::<HEAD_LEN>()?;
        let word = |at: usize| head.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
        let mut sent = [0; 8];
        sent[..6].copy_from_slice(&head[..6]);
        let echo = if head[14] & ECHOES == 0 { None } else { Some((word(6)?, word(10)?)) };
        let this = Self {
            sent_us: u64::from_le_bytes(sent),
            echo,
            loss: head[15],
            loss_again: head[16],
            control: head[17],
            newest: word(18)?,
            count: head[22],
        };
        (usize::from(this.count) <= COPIES_MAX).then_some((this, records))
    }
}

/// Length of a payload that stands in a datagram by its place only.
const LEFT_OUT: u16 = u16::MAX;

/// One payload as it stands in a datagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    /// How long before the datagram it was first sent, s.
    pub age_s: f64,
    /// Its content; `None` if it is left out here, because it was sent before and there is no room for it.
    pub bytes: Option<&'a [u8]>,
}

impl Record<'_> {
    /// Writes it at the beginning of `room`; the number of bytes, or `None` if it does not fit.
    pub fn write(&self, room: &mut [u8]) -> Option<usize> {
        let bytes = self.bytes.unwrap_or(&[]);
        let end = RECORD_LEN + bytes.len();
        let room = room.get_mut(..end)?;
        let len = if self.bytes.is_some() { u16::try_from(bytes.len()).ok()? } else { LEFT_OUT };
        let age = (self.age_s / AGE_UNIT_S).round().clamp(0.0, f64::from(u16::MAX)) as u16;
        room[..2].copy_from_slice(&len.to_le_bytes());
        room[2..RECORD_LEN].copy_from_slice(&age.to_le_bytes());
        room[RECORD_LEN..].copy_from_slice(bytes);
        Some(end)
    }
}

/// The first payload in these bytes, and what follows it.
pub fn record(bytes: &[u8]) -> Option<(Record<'_>, &[u8])> {
    let ([len0, len1, age0, age1], rest) = bytes.split_first_chunk::<RECORD_LEN>()?;
    let age_s = f64::from(u16::from_le_bytes([*age0, *age1])) * AGE_UNIT_S;
    let len = u16::from_le_bytes([*len0, *len1]);
    if len == LEFT_OUT {
        return Some((Record { age_s, bytes: None }, rest));
    }
    let (content, rest) = rest.split_at_checked(usize::from(len))?;
    Some((Record { age_s, bytes: Some(content) }, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_and_its_payloads_come_back_as_they_were() {
        let head = Head {
            sent_us: 0x1234_5678_9abc,
            echo: Some((7, 9)),
            loss: 3,
            loss_again: 4,
            control: 5,
            newest: 6,
            count: 2,
        };
        let mut bytes = [0; 200];
        bytes[..HEAD_LEN].copy_from_slice(&head.bytes());
        let mut end = HEAD_LEN;
        for (age_s, content) in [(0.0, Some(&b"newest"[..])), (0.0, None), (0.00123, Some(b""))] {
            end += Record { age_s, bytes: content }.write(&mut bytes[end..]).unwrap();
        }
        let (read, rest) = Head::from_bytes(&bytes[..end]).unwrap();
        assert_eq!(read, head);
        let (first, rest) = record(rest).unwrap();
        assert_eq!(first.bytes, Some(&b"newest"[..]));
        let (left_out, rest) = record(rest).unwrap();
        assert_eq!(left_out.bytes, None);
        let (last, rest) = record(rest).unwrap();
        assert!((last.age_s - 0.00123).abs() < 1e-9 && last.bytes == Some(&[]) && rest.is_empty());
        assert!(record(&bytes[HEAD_LEN..HEAD_LEN + 5]).is_none(), "cut");
    }

    #[test]
    fn numbers_are_completed_on_both_sides_of_an_overflow() {
        for near in [5_u64, 0xffff_fff0, 0x1_0000_0003, 0x7_ffff_ffff] {
            for ahead in [-1000_i64, -3, 0, 3, 1000, 100_000] {
                let true_number = near.saturating_add_signed(ahead);
                assert_eq!(whole(near, true_number as u32), true_number);
            }
        }
    }

    #[test]
    fn versions_and_kinds_are_told_apart() {
        let hello = handshake(Kind::Hello, 77);
        assert_eq!((kind(&hello), token(&hello)), (Ok(Kind::Hello), Some(77)));
        let mut foreign = hello;
        foreign[0] = VERSION + 1;
        assert_eq!(kind(&foreign), Err(Unreadable::ForeignVersion(VERSION + 1)));
        let mut refusal = handshake(Kind::Refusal, 1);
        refusal[0] = 99;
        assert_eq!(kind(&refusal), Ok(Kind::Refusal));
        assert_eq!(kind(b"GET / HTTP/1.1\r\n\r\n"), Err(Unreadable::Malformed));
        assert_eq!(kind(&[]), Err(Unreadable::Malformed));
        assert_eq!(kind(&outer(1, 2)), Err(Unreadable::Malformed), "nothing behind it");
        let mut data = [0; 100];
        data[..OUTER_LEN].copy_from_slice(&outer(1, 2));
        assert_eq!(kind(&data), Ok(Kind::Data));
        data[0] = VERSION + 1;
        assert_eq!(kind(&data), Err(Unreadable::ForeignData(VERSION + 1)));
    }

    #[test]
    fn random_bytes_never_panic() {
        let mut rng = fastrand::Rng::with_seed(4);
        for _ in 0..20_000 {
            let bytes: Vec<u8> = (0..rng.usize(..80)).map(|_| rng.u8(..)).collect();
            let _ = (kind(&bytes), token(&bytes), open_outer(&bytes));
            if let Some((_, rest)) = Head::from_bytes(&bytes) {
                let _ = record(rest);
            }
        }
    }
}
