//! Pairing: two machines exchange their keys, and two people verify with a code that no third party is between them.
//!
//! Each machine contributes its key and a secret that is used once. The console first sends a hash of its part (a
//! commitment), then receives the follower's part, then reveals its own: a third party would have to guess before the
//! inputs of the code are known, with a chance of one in a million. Each screen shows a code, computed from both keys
//! and both secrets, and each person enters the code of the other screen. A wrong code is refused, and after three of
//! them a machine refuses pairing for a minute. (Commitment and comparison as in ZRTP, RFC 6189, 4.)
//!
//! Pairing is not part of a loop: [`Pairing::ask`] and [`Pairing::offer`] block the caller's own thread until the other
//! person has pressed the button as well.

use std::{
    fmt, io,
    net::SocketAddr,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
    thread::sleep,
    time::{Duration, Instant},
};

use blake2::{Blake2s256, Digest as _};

use crate::{
    endpoint::towards,
    keys::{KeyError, NetworkKeys, PublicKey},
    socket::Socket,
    wire::{self, DatagramKind, HANDSHAKE_LEN},
};

/// Number of wrong codes before a pause, and its length.
pub const WRONG_MAX: usize = 3;
/// See [`WRONG_MAX`].
pub const PAUSE: Duration = Duration::from_mins(1);
/// Digits of a code.
const DIGITS: u32 = 6;
/// A request is repeated after this time.
const AGAIN: Duration = Duration::from_millis(200);
const NAP: Duration = Duration::from_millis(5);
/// The last answer is repeated for this long if its request is repeated, because it may have been lost.
const REPEATS: Duration = Duration::from_secs(1);
/// Maximum number of commitments that a follower answers in one pairing; more indicate an attack.
const TRIES_MAX: usize = 8;

/// Steps, in the first byte after the number of the pairing.
const COMMIT: u8 = 1;
const ANSWER: u8 = 2;
const REVEAL: u8 = 3;
const DONE: u8 = 4;

/// All datagrams of a pairing have the length of the longest, so that no answer is longer than its request.
const LEN: usize = HANDSHAKE_LEN + 1 + 64;

/// Why pairing failed.
#[derive(Debug, thiserror::Error)]
pub enum PairingError {
    /// The address cannot be used.
    #[error("pairing: cannot use {address}: {source}; correct the address")]
    Address { address: SocketAddr, source: io::Error },
    /// No answer in time, or cancelled.
    #[error("pairing: no answer; start it on both machines, and check the address and the firewall")]
    Nobody,
    /// The revealed part does not match its commitment: a third party is between the machines.
    #[error(
        "pairing: the other side's data contradict its commitment, so a third party may be between the two machines; check the network, then pair again"
    )]
    Contradiction,
    /// The entered code is wrong.
    #[error(
        "pairing: the codes differ, and nothing was saved. If neither was mistyped, a third party is between the two machines: check the network, then pair again"
    )]
    WrongCode,
    /// Too many wrong codes.
    #[error("pairing: too many wrong codes; wait {wait_s:.0} s, then try again")]
    TooMany { wait_s: f64 },
    /// The system provides no random numbers.
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// The displayed code: six digits, different on each machine, so that entering the code from the same screen is
/// detected.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Code(u32);

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:03} {:03}", self.0 / 1000, self.0 % 1000)
    }
}

impl fmt::Debug for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Counts wrong codes of this machine.
#[derive(Debug, Default)]
pub struct Attempts {
    wrong: Vec<Instant>,
}

impl Attempts {
    /// Checks whether another pairing may begin.
    ///
    /// # Errors
    /// [`PairingError::TooMany`] with the time to wait.
    pub fn may_begin(&mut self, now: Instant) -> Result<(), PairingError> {
        self.wrong.retain(|&at| now.saturating_duration_since(at) < PAUSE);
        match self.wrong.first() {
            Some(&first) if self.wrong.len() >= WRONG_MAX => {
                let wait = PAUSE.saturating_sub(now.saturating_duration_since(first));
                Err(PairingError::TooMany { wait_s: wait.as_secs_f64() })
            }
            _ => Ok(()),
        }
    }
}

/// A pairing that waits for the code of the other screen.
#[derive(Debug)]
pub struct PendingPairing {
    shown: Code,
    expected: Code,
    peer: PublicKey,
}

impl PendingPairing {
    /// Returns the code to show here, which must be entered on the other machine.
    pub const fn code(&self) -> Code {
        self.shown
    }

    /// Returns the other machine's key if `entered` is the code on its screen; spaces are ignored.
    ///
    /// # Errors
    /// [`PairingError::WrongCode`], which is counted.
    pub fn confirm(self, entered: &str, attempts: &mut Attempts) -> Result<PublicKey, PairingError> {
        let digits: String = entered.chars().filter(|c| !c.is_whitespace() && *c != '-').collect();
        let is_whole = digits.len() == DIGITS as usize && digits.bytes().all(|digit| digit.is_ascii_digit());
        if is_whole && digits.parse() == Ok(self.expected.0) {
            return Ok(self.peer);
        }
        attempts.wrong.push(Instant::now());
        Err(PairingError::WrongCode)
    }
}

/// A machine's part: its key and its secret.
#[derive(Clone, Copy)]
struct PairingPart {
    key: PublicKey,
    secret: [u8; 32],
}

impl PairingPart {
    fn new(keys: &NetworkKeys) -> Result<Self, KeyError> {
        let mut secret = [0; 32];
        getrandom::fill(&mut secret).map_err(|_| KeyError::Random)?;
        Ok(Self { key: keys.public(), secret })
    }

    fn bytes(&self) -> [u8; 64] {
        let mut bytes = [0; 64];
        bytes[..32].copy_from_slice(self.key.bytes());
        bytes[32..].copy_from_slice(&self.secret);
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (key, secret) = bytes.split_first_chunk()?;
        Some(Self { key: PublicKey::new(*key), secret: secret.try_into().ok()? })
    }

    fn commitment(&self) -> [u8; 32] {
        hash(&[b"nima pairing 1 commitment", &self.bytes()])
    }
}

fn hash(parts: &[&[u8]]) -> [u8; 32] {
    let mut hash = Blake2s256::new();
    for part in parts {
        hash.update(part);
    }
    hash.finalize().into()
}

/// Returns the codes for the console's and the follower's screen.
fn codes(console: &PairingPart, follower: &PairingPart) -> [Code; 2] {
    [&b"nima pairing 1 console"[..], b"nima pairing 1 follower"].map(|of| {
        let [a, b, c, d, e, f, g, h, ..] = hash(&[of, &console.bytes(), &follower.bytes()]);
        Code((u64::from_le_bytes([a, b, c, d, e, f, g, h]) % 10_u64.pow(DIGITS)) as u32)
    })
}

fn datagram(token: u64, step: u8, content: &[u8]) -> [u8; LEN] {
    let mut bytes = [0; LEN];
    bytes[..HANDSHAKE_LEN].copy_from_slice(&wire::handshake(DatagramKind::Pairing, token));
    bytes[HANDSHAKE_LEN] = step;
    for (byte, &value) in bytes[HANDSHAKE_LEN + 1..].iter_mut().zip(content) {
        *byte = value;
    }
    bytes
}

/// Returns number, step and content of a datagram of a pairing.
fn read(bytes: &[u8]) -> Option<(u64, u8, &[u8])> {
    let is_pairing = bytes.len() == LEN && wire::kind(bytes) == Ok(DatagramKind::Pairing);
    let (step, content) = bytes.get(HANDSHAKE_LEN..)?.split_first()?;
    Some((wire::token(bytes)?, *step, content)).filter(|_| is_pairing)
}

fn next(socket: &Socket, buffer: &mut [u8; 2 * LEN]) -> Option<(usize, SocketAddr)> {
    let arrival = socket.receive(buffer)?;
    Some((arrival.len.min(buffer.len()), arrival.from))
}

/// The inputs of a pairing, for either side.
#[derive(Debug)]
pub struct Pairing<'a> {
    /// Keys.
    pub keys: &'a NetworkKeys,
    /// The wrong codes entered on it.
    pub attempts: &'a mut Attempts,
    /// Time to wait for the other side.
    pub wait: Duration,
    /// Set to cancel the pairing.
    pub called_off: &'a AtomicBool,
}

impl Pairing<'_> {
    /// Returns the console's side: asks the follower at this address.
    ///
    /// # Errors
    /// [`PairingError`] if there is no answer, or too many wrong codes were entered before.
    pub fn ask(self, follower: SocketAddr) -> Result<PendingPairing, PairingError> {
        let begin = Instant::now();
        self.attempts.may_begin(begin)?;
        let address = |source| PairingError::Address { address: follower, source };
        let socket = Socket::open(towards(&follower), Some(follower)).map_err(address)?;
        let own = PairingPart::new(self.keys)?;
        let mut token = [0; 8];
        getrandom::fill(&mut token).map_err(|_| KeyError::Random)?;
        let token = u64::from_le_bytes(token);
        let mut question = datagram(token, COMMIT, &own.commitment());
        let mut theirs: Option<PairingPart> = None;
        let mut asked = None;
        let mut buffer = [0; 2 * LEN];
        while self.goes_on(begin) {
            if asked.is_none_or(|at: Instant| at.elapsed() >= AGAIN) {
                socket.send(&question, follower);
                asked = Some(Instant::now());
            }
            let Some((len, _)) = next(&socket, &mut buffer) else {
                sleep(NAP);
                continue;
            };
            match (read(&buffer[..len]).filter(|(number, ..)| *number == token), theirs) {
                (Some((_, ANSWER, content)), None) => {
                    theirs = PairingPart::from_bytes(content);
                    question = datagram(token, REVEAL, &own.bytes());
                    asked = None;
                }
                // The response differs from an earlier one.
                (Some((_, ANSWER, content)), Some(theirs)) if content != theirs.bytes() => {
                    return Err(PairingError::Contradiction);
                }
                (Some((_, DONE, _)), Some(theirs)) => {
                    let [shown, expected] = codes(&own, &theirs);
                    return Ok(PendingPairing { shown, expected, peer: theirs.key });
                }
                _ => {}
            }
        }
        Err(PairingError::Nobody)
    }

    /// Starts the follower's side: listens at this address. The first console that reveals its commitment is accepted;
    /// others are then ignored.
    ///
    /// # Errors
    /// [`PairingError`] if no console asks, or too many wrong codes were entered before.
    pub fn offer(self, at: SocketAddr) -> Result<PendingPairing, PairingError> {
        let begin = Instant::now();
        self.attempts.may_begin(begin)?;
        let socket = Socket::open(at, None).map_err(|source| PairingError::Address { address: at, source })?;
        let mut buffer = [0; 2 * LEN];
        // Address, number and commitment of each console, and our part, which differs for each.
        let mut asked: Vec<(SocketAddr, u64, [u8; 32], PairingPart)> = Vec::new();
        while self.goes_on(begin) {
            let Some((len, from)) = next(&socket, &mut buffer) else {
                sleep(NAP);
                continue;
            };
            let Some((token, step, content)) = read(&buffer[..len]) else { continue };
            let known = asked.iter().find(|(address, number, ..)| (*address, *number) == (from, token));
            match (step, known) {
                (COMMIT, Some((.., own))) => {
                    socket.send(&datagram(token, ANSWER, &own.bytes()), from);
                }
                (COMMIT, None) if asked.len() < TRIES_MAX => {
                    let own = PairingPart::new(self.keys)?;
                    let Some(&promised) = content.first_chunk() else { continue };
                    asked.push((from, token, promised, own));
                    socket.send(&datagram(token, ANSWER, &own.bytes()), from);
                }
                (REVEAL, Some((.., promised, own))) => {
                    let Some(console) = PairingPart::from_bytes(content) else { continue };
                    if console.commitment() != *promised {
                        return Err(PairingError::Contradiction);
                    }
                    repeat(&socket, &datagram(token, DONE, &[]), token, from);
                    let [expected, shown] = codes(&console, own);
                    return Ok(PendingPairing { shown, expected, peer: console.key });
                }
                _ => {}
            }
        }
        Err(PairingError::Nobody)
    }

    fn goes_on(&self, begin: Instant) -> bool {
        begin.elapsed() < self.wait && !self.called_off.load(Relaxed)
    }
}

/// Sends the last answer, and repeats it for each request that shows that it was lost.
fn repeat(socket: &Socket, answer: &[u8; LEN], token: u64, to: SocketAddr) {
    let begin = Instant::now();
    let mut buffer = [0; 2 * LEN];
    socket.send(answer, to);
    while begin.elapsed() < REPEATS {
        match next(socket, &mut buffer) {
            Some((len, from)) if from == to && read(&buffer[..len]).is_some_and(|(number, ..)| number == token) => {
                socket.send(answer, to);
            }
            Some(_) => {}
            None => sleep(NAP),
        }
    }
}

#[cfg(test)]
#[path = "pairing_tests.rs"]
mod tests;
