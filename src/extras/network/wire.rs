//! The format of a datagram.
//!
//! Every datagram starts with the version of the protocol and its kind. A datagram of a handshake continues with
//! [`MAGIC`] and a number chosen by its sender, so that an answer cannot be forged without seeing the request; these
//! fourteen bytes and a refusal stay the same in every version. A datagram of a session continues with the session's
//! number at the receiver and the lower half of its sequence number; the rest is encrypted: a [`DatagramHead`] with the
//! time stamps, then the payloads, newest first.
//!
//! Numbers are little-endian.

/// Version of the protocol. Two machines with different versions refuse each other.
pub const VERSION: u8 = 3;
/// Maximum datagram, bytes: passes through every usual network in one piece.
pub const DATAGRAM_MAX: usize = 1200;
/// Length of the unencrypted part of a session's datagram, bytes.
pub const OUTER_LEN: usize = 10;
/// Length added by the encryption, bytes.
pub const TAG_LEN: usize = 16;
/// Length of the shortest [`DatagramHead`], bytes: without a report.
pub const HEAD_MIN: usize = 8;
/// Length of the longest, with report and echo, bytes.
pub const HEAD_MAX: usize = 22;
/// Maximum length of a payload's header, bytes.
pub const RECORD_MAX: usize = 4;
/// Maximum payload, bytes.
pub const PAYLOAD_MAX: usize = DATAGRAM_MAX - OUTER_LEN - TAG_LEN - HEAD_MAX - RECORD_MAX;
/// Length that IPv4 and UDP add to each datagram, bytes; it counts for the rate limit.
pub const UDP_LEN: usize = 28;
/// Maximum number of payloads in one datagram.
pub const COPIES_MAX: usize = 32;
/// An older payload is not sent again, s.
pub const AGE_MAX_S: f64 = 0.65;

/// Present in every datagram of a handshake, after version and kind.
pub const MAGIC: [u8; 4] = *b"nima";
/// Offset of the number chosen by a handshake's sender.
const TOKEN_AT: usize = 6;
/// Length of the header of a handshake's datagram, bytes.
pub const HANDSHAKE_LEN: usize = TOKEN_AT + 8;
/// Minimum first datagram of a handshake, bytes: longer than every answer to a stranger, so that this machine cannot be
/// abused to amplify an attack on a third party.
pub const HELLO_LEN: usize = 128;
/// Maximum datagram of a handshake, bytes.
pub const HANDSHAKE_MAX: usize = 256;
/// Unit of a payload's age, s.
const AGE_UNIT_S: f64 = 2e-5;

/// Kind of a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DatagramKind {
    /// A console requests a cookie.
    Hello,
    /// The cookie.
    Cookie,
    /// The first message of the handshake, with the cookie.
    Initiation,
    /// The second message of the handshake.
    Response,
    /// No session will be created, with the cause.
    Refusal,
    /// Part of a session.
    Data,
    /// Pairing: see [`crate::pairing`].
    Pairing,
}

impl DatagramKind {
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

/// Why a datagram was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unreadable {
    /// Not of this protocol, truncated, or inconsistent.
    Malformed,
    /// A handshake of another version of this protocol.
    ForeignVersion(u8),
    /// Like a datagram of a session in length and kind, but of another version. It is never answered.
    ForeignData(u8),
}

/// Returns the kind of a datagram.
///
/// # Errors
/// [`Unreadable`] if it is not of this version. Only a datagram with [`MAGIC`] counts as a handshake of another
/// version: random bytes do not.
pub fn kind(datagram: &[u8]) -> Result<DatagramKind, Unreadable> {
    let [version, kind, ..] = *datagram else { return Err(Unreadable::Malformed) };
    let kind = DatagramKind::ALL.into_iter().find(|known| known.number() == kind);
    match kind {
        Some(DatagramKind::Data) if datagram.len() < OUTER_LEN + TAG_LEN + HEAD_MIN => Err(Unreadable::Malformed),
        Some(DatagramKind::Data) if version != VERSION => Err(Unreadable::ForeignData(version)),
        Some(DatagramKind::Data) => Ok(DatagramKind::Data),
        _ if datagram.get(2..TOKEN_AT) != Some(&MAGIC) || datagram.len() < HANDSHAKE_LEN => Err(Unreadable::Malformed),
        // A refusal can be read in every version.
        Some(DatagramKind::Refusal) => Ok(DatagramKind::Refusal),
        _ if version != VERSION => Err(Unreadable::ForeignVersion(version)),
        Some(kind) => Ok(kind),
        None => Err(Unreadable::Malformed),
    }
}

/// Returns the number chosen by the sender of a handshake's datagram.
pub fn token(datagram: &[u8]) -> Option<u64> {
    datagram.get(TOKEN_AT..HANDSHAKE_LEN)?.try_into().ok().map(u64::from_le_bytes)
}

/// Returns the header of a handshake's datagram.
pub fn handshake(kind: DatagramKind, token: u64) -> [u8; HANDSHAKE_LEN] {
    let mut bytes = [0; HANDSHAKE_LEN];
    bytes[0] = VERSION;
    bytes[1] = kind.number();
    bytes[2..TOKEN_AT].copy_from_slice(&MAGIC);
    bytes[TOKEN_AT..].copy_from_slice(&token.to_le_bytes());
    bytes
}

/// Returns the header of a session's datagram: the number of the session at the receiver, and the datagram's number.
pub fn outer(session: u32, counter: u64) -> [u8; OUTER_LEN] {
    let mut bytes = [0; OUTER_LEN];
    bytes[0] = VERSION;
    bytes[1] = DatagramKind::Data.number();
    bytes[2..6].copy_from_slice(&session.to_le_bytes());
    bytes[6..].copy_from_slice(&(counter as u32).to_le_bytes());
    bytes
}

/// Returns the number of the session, the lower half of the datagram's number, and the encrypted part.
pub fn open_outer(datagram: &[u8]) -> Option<(u32, u32, &[u8])> {
    let (outer, sealed) = datagram.split_at_checked(OUTER_LEN)?;
    let session = u32::from_le_bytes(outer.get(2..6)?.try_into().ok()?);
    let counter = u32::from_le_bytes(outer.get(6..)?.try_into().ok()?);
    Some((session, counter, sealed))
}

/// Returns the number with these lower bits that is nearest to `near`.
pub const fn whole(near: u64, low: u32) -> u64 {
    let ahead = low.wrapping_sub(near as u32).cast_signed();
    near.saturating_add_signed(ahead as i64)
}

/// Returns the same for numbers of which the lower 24 bits are sent.
pub const fn whole24(near: u64, low: u32) -> u64 {
    let ahead = (low.wrapping_sub(near as u32) << 8).cast_signed() >> 8;
    near.saturating_add_signed(ahead as i64)
}

/// The encrypted header before the payloads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DatagramHead {
    /// When the datagram was sent, by its sender's clock, µs: 48 bits with a report, otherwise the lower 32.
    pub sent_us: u64,
    /// Present only in some datagrams.
    pub report: Option<WireReport>,
    /// Number of the newest payload, lower 24 bits.
    pub newest: u32,
    pub count: u8,
}

/// Data that only some datagrams contain: for comparing the clocks, and the losses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WireReport {
    /// Lower half of `sent_us` of the last datagram that the sender received, and the time between its arrival and
    /// `sent_us`, µs.
    pub echo: Option<(u32, u32)>,
    /// Fraction of the datagrams that its sender recently missed, in 255ths.
    pub loss: u8,
    /// Fraction of the datagrams after a missed one that were missed too, in 255ths.
    pub loss_again: u8,
    /// Fraction of the datagrams that arrived after a later one, in 255ths.
    pub overtaken: u8,
    /// Control of the follower, requests and answers: [`crate::control`].
    pub control: u8,
}

/// Flag in the first byte of a head, next to the number of payloads.
const REPORTS: u8 = 0x80;
const ECHOES: u8 = 0x40;

impl DatagramHead {
    /// Returns the length in bytes.
    pub fn length(&self) -> usize {
        let echo = |report: &WireReport| if report.echo.is_some() { 8 } else { 0 };
        HEAD_MIN + self.report.as_ref().map_or(0, |report| 6 + echo(report))
    }

    /// Returns its bytes; only the first [`length`](Self::length) are used.
    pub fn bytes(&self) -> [u8; HEAD_MAX] {
        let mut bytes = [0; HEAD_MAX];
        let mut end = 1;
        let mut add = |more: &[u8]| {
            bytes[end..end + more.len()].copy_from_slice(more);
            end += more.len();
        };
        add(&self.sent_us.to_le_bytes()[..4]);
        add(&self.newest.to_le_bytes()[..3]);
        let mut first = self.count;
        if let Some(WireReport { echo, loss, loss_again, overtaken, control }) = self.report {
            first |= REPORTS;
            add(&self.sent_us.to_le_bytes()[4..6]);
            add(&[loss, loss_again, overtaken, control]);
            if let Some((echo_us, held_us)) = echo {
                first |= ECHOES;
                add(&echo_us.to_le_bytes());
                add(&held_us.to_le_bytes());
            }
        }
        bytes[0] = first;
        bytes
    }

    /// Parses a head; also returns the bytes after it.
    pub fn from_bytes(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let ([first, sent0, sent1, sent2, sent3, newest @ ..], mut rest) = bytes.split_first_chunk::<HEAD_MIN>()?;
        let mut sent_us = u64::from(u32::from_le_bytes([*sent0, *sent1, *sent2, *sent3]));
        let mut report = None;
        if first & REPORTS != 0 {
            let ([high0, high1, loss, loss_again, overtaken, control], more) = rest.split_first_chunk::<6>()?;
            sent_us |= u64::from(u16::from_le_bytes([*high0, *high1])) << 32;
            rest = more;
            let mut echo = None;
            if first & ECHOES != 0 {
                let (echo_us, more) = rest.split_first_chunk::<4>()?;
                let (held_us, more) = more.split_first_chunk::<4>()?;
                echo = Some((u32::from_le_bytes(*echo_us), u32::from_le_bytes(*held_us)));
                rest = more;
            }
            report = Some(WireReport {
                echo,
                loss: *loss,
                loss_again: *loss_again,
                overtaken: *overtaken,
                control: *control,
            });
        }
        let count = first & !(REPORTS | ECHOES);
        let newest = u32::from_le_bytes([newest[0], newest[1], newest[2], 0]);
        (usize::from(count) <= COPIES_MAX).then_some((Self { sent_us, report, newest, count }, rest))
    }
}

/// Length value of a payload that is left out of the datagram.
const LEFT_OUT: u16 = 0x7fff;

/// Returns the length of a number below 2^15, bytes: below 128 one byte, otherwise two, the first with its highest bit
/// set.
const fn number_len(number: u16) -> usize {
    if number < 0x80 { 1 } else { 2 }
}

fn write_number(number: u16, room: &mut [u8]) {
    match room {
        [one] => *one = number as u8,
        [high, low] => [*high, *low] = (number | 0x8000).to_be_bytes(),
        _ => {}
    }
}

fn number(bytes: &[u8]) -> Option<(u16, &[u8])> {
    let (&first, rest) = bytes.split_first()?;
    if first < 0x80 {
        return Some((u16::from(first), rest));
    }
    let (&low, rest) = rest.split_first()?;
    Some((u16::from_be_bytes([first & 0x7f, low]), rest))
}

/// One payload in a datagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadRecord<'a> {
    /// Time between its first sending and the datagram, s.
    pub age_s: f64,
    /// Content; `None` if it is left out, because it was sent before and there is no room for it.
    pub bytes: Option<&'a [u8]>,
}

impl PayloadRecord<'_> {
    /// Returns the length of a record with a payload of this length and age, bytes.
    pub fn length(payload: usize, age_s: f64) -> usize {
        let len = u16::try_from(payload).unwrap_or(LEFT_OUT);
        number_len(len) + number_len(age(age_s)) + payload
    }

    /// Writes it at the beginning of `room`; returns the number of bytes, or `None` if it does not fit.
    pub fn write(&self, room: &mut [u8]) -> Option<usize> {
        let bytes = self.bytes.unwrap_or(&[]);
        let len = if self.bytes.is_some() { u16::try_from(bytes.len()).ok()? } else { LEFT_OUT };
        let age = age(self.age_s);
        let first = number_len(len);
        let second = number_len(age);
        let end = first + second + bytes.len();
        let (head, content) = room.get_mut(..end)?.split_at_mut(first + second);
        let (one, other) = head.split_at_mut(first);
        write_number(len, one);
        write_number(age, other);
        content.copy_from_slice(bytes);
        Some(end)
    }
}

fn age(age_s: f64) -> u16 {
    (age_s / AGE_UNIT_S).round().clamp(0.0, f64::from(LEFT_OUT)) as u16
}

/// Returns the first payload in these bytes, and the bytes after it.
pub fn record(bytes: &[u8]) -> Option<(PayloadRecord<'_>, &[u8])> {
    let (len, rest) = number(bytes)?;
    let (age, rest) = number(rest)?;
    let age_s = f64::from(age) * AGE_UNIT_S;
    if len == LEFT_OUT {
        return Some((PayloadRecord { age_s, bytes: None }, rest));
    }
    let (content, rest) = rest.split_at_checked(usize::from(len))?;
    Some((PayloadRecord { age_s, bytes: Some(content) }, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_and_its_payloads_come_back_as_they_were() {
        let report = WireReport { echo: Some((7, 9)), loss: 3, loss_again: 4, overtaken: 6, control: 5 };
        for (sent_us, report, len) in [
            (0x1234_5678_9abc, Some(report), HEAD_MAX),
            (0x1234_5678_9abc, Some(WireReport { echo: None, ..report }), 14),
            (0x5678_9abc, None, HEAD_MIN),
        ] {
            let head = DatagramHead { sent_us, report, newest: 0x12_3456, count: 2 };
            let mut bytes = [0; 300];
            let mut end = head.length();
            assert_eq!(end, len);
            bytes[..end].copy_from_slice(&head.bytes()[..end]);
            let long = [8; 150];
            let payloads = [(0.0, Some(&b"newest"[..])), (0.0, None), (0.00124, Some(b"")), (0.65, Some(&long))];
            for (age_s, content) in payloads {
                let len = PayloadRecord { age_s, bytes: content }.write(&mut bytes[end..]).unwrap();
                assert!(content.is_none_or(|content| PayloadRecord::length(content.len(), age_s) == len));
                end += len;
            }
            let (read, mut rest) = DatagramHead::from_bytes(&bytes[..end]).unwrap();
            assert_eq!(read, head);
            for (age_s, content) in payloads {
                let (got, more) = record(rest).unwrap();
                assert!((got.age_s - age_s).abs() < 1e-9 && got.bytes == content, "{got:?}");
                rest = more;
            }
            assert!(rest.is_empty());
            assert!(record(&bytes[len..len + 5]).is_none(), "cut");
            assert!((0..len).all(|cut| DatagramHead::from_bytes(&bytes[..cut]).is_none()), "cut");
        }
    }

    #[test]
    fn numbers_are_completed_on_both_sides_of_an_overflow() {
        for near in [5_u64, 0xffff_fff0, 0x1_0000_0003, 0x7_ffff_ffff] {
            for ahead in [-1000_i64, -3, 0, 3, 1000, 100_000] {
                let true_number = near.saturating_add_signed(ahead);
                assert_eq!(whole(near, true_number as u32), true_number);
                assert_eq!(whole24(near, true_number as u32 & 0xff_ffff), true_number);
            }
        }
    }

    #[test]
    fn versions_and_kinds_are_told_apart() {
        let hello = handshake(DatagramKind::Hello, 77);
        assert_eq!((kind(&hello), token(&hello)), (Ok(DatagramKind::Hello), Some(77)));
        let mut foreign = hello;
        foreign[0] = VERSION + 1;
        assert_eq!(kind(&foreign), Err(Unreadable::ForeignVersion(VERSION + 1)));
        let mut refusal = handshake(DatagramKind::Refusal, 1);
        refusal[0] = 99;
        assert_eq!(kind(&refusal), Ok(DatagramKind::Refusal));
        assert_eq!(kind(b"GET / HTTP/1.1\r\n\r\n"), Err(Unreadable::Malformed));
        assert_eq!(kind(&[]), Err(Unreadable::Malformed));
        assert_eq!(kind(&outer(1, 2)), Err(Unreadable::Malformed), "nothing behind it");
        let mut data = [0; 100];
        data[..OUTER_LEN].copy_from_slice(&outer(1, 2));
        assert_eq!(kind(&data), Ok(DatagramKind::Data));
        data[0] = VERSION + 1;
        assert_eq!(kind(&data), Err(Unreadable::ForeignData(VERSION + 1)));
    }

    #[test]
    fn random_bytes_never_panic() {
        let mut rng = fastrand::Rng::with_seed(4);
        for _ in 0..20_000 {
            let bytes: Vec<u8> = (0..rng.usize(..80)).map(|_| rng.u8(..)).collect();
            let _ = (kind(&bytes), token(&bytes), open_outer(&bytes));
            if let Some((_, rest)) = DatagramHead::from_bytes(&bytes) {
                let _ = record(rest);
            }
        }
    }
}
