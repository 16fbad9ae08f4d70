//! Pairing: two machines exchange their keys, protected by a code that one person carries from screen to screen.
//!
//! The follower shows a code, and a person enters it at the console. Both run SPAKE2, a key exchange in which a third
//! party can test one guess of the code with each exchange and learns nothing else. Each side then proves that it has
//! the same result, together with its key. A stranger neither ends an offer nor keeps others out: exchanges are
//! independent of each other, begin only after a cookie, and are limited for each address.
//!
//! Pairing is not part of a loop: [`Pairing::ask`] and [`Pairing::offer`] block the caller's own thread until the other
//! side has answered. Threats and alternatives: `docs/decisions/pairing.md`.

mod attempts;
mod exchange;
mod offer;

use std::{
    fmt, io,
    net::SocketAddr,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
    thread::sleep,
    time::{Duration, Instant},
};

use crate::{
    endpoint::towards,
    keys::{KeyError, NetworkKeys, PublicKey},
    socket::Socket,
};
pub use attempts::{Attempts, PAUSE, WRONG_MAX};
use exchange::{Console, LEN, Step, datagram, read};
use offer::GUESSES_MAX;

/// Digits of a code. An offer ends after [`GUESSES_MAX`] guesses, so that a stranger has a chance of one in a million.
const DIGITS: usize = 9;
/// A request is repeated after this time.
const AGAIN: Duration = Duration::from_millis(200);
const NAP: Duration = Duration::from_millis(5);
/// An exchange without progress for this long begins again.
const STUCK: Duration = Duration::from_secs(3);
/// Usual time to wait for the other side; strangers cannot end an offer earlier.
pub const WAIT_USUAL: Duration = Duration::from_mins(2);
/// Maximum time to wait: enough to walk to the other machine.
pub const WAIT_MAX: Duration = Duration::from_mins(10);

/// Why pairing failed.
#[derive(Debug, thiserror::Error)]
pub enum PairingError {
    /// The address cannot be used.
    #[error("pairing: cannot use {address}: {source}; correct the address")]
    Address { address: SocketAddr, source: io::Error },
    /// No answer in time, or cancelled.
    #[error("pairing: no answer; start it on both machines, and check the address and the firewall")]
    Nobody,
    /// The entered code is wrong.
    #[error(
        "pairing: wrong code; nothing was saved. If you entered it correctly, a third party may be intercepting the connection: check the network, then pair again"
    )]
    WrongCode,
    /// The entered text is not a code.
    #[error("pairing: a code has {DIGITS} digits; enter the code on the other screen")]
    NoCode,
    /// Too many wrong codes.
    #[error("pairing: too many wrong codes; wait {wait_s:.0} s, then try again")]
    TooMany { wait_s: f64 },
    /// Too many wrong codes reached an offer.
    #[error(
        "pairing: {GUESSES_MAX} wrong codes arrived, so a third party is probably guessing; nothing was saved. Permit only the console's \
         address in the firewall, then start the offer again"
    )]
    Guessed,
    /// The system provides no random numbers, or the file of the wrong codes cannot be used.
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// The code of an offer.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Code([u8; DIGITS]);

impl Code {
    fn random() -> Result<Self, KeyError> {
        let mut digits = [0; DIGITS];
        for digit in &mut digits {
            // Bytes from 250 on would make the small digits more frequent.
            *digit = loop {
                let mut byte = [0];
                getrandom::fill(&mut byte).map_err(|_| KeyError::Random)?;
                if byte[0] < 250 {
                    break b'0' + byte[0] % 10;
                }
            };
        }
        Ok(Self(digits))
    }

    /// Reads a code as a person enters it: spaces and hyphens are ignored.
    ///
    /// # Errors
    /// [`PairingError::NoCode`].
    pub fn parse(text: &str) -> Result<Self, PairingError> {
        let digits: Vec<u8> = text.bytes().filter(|byte| !byte.is_ascii_whitespace() && *byte != b'-').collect();
        let digits = digits.try_into().map_err(|_| PairingError::NoCode)?;
        Some(Self(digits)).filter(|code| code.0.iter().all(u8::is_ascii_digit)).ok_or(PairingError::NoCode)
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, digit) in self.0.iter().enumerate() {
            let gap = if place > 0 && place % 3 == 0 { " " } else { "" };
            write!(f, "{gap}{}", char::from(*digit))?;
        }
        Ok(())
    }
}

impl fmt::Debug for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Code")
    }
}

/// The inputs of a pairing, for either side.
#[derive(Debug)]
pub struct Pairing<'a> {
    /// Keys.
    pub keys: &'a NetworkKeys,
    /// Time to wait for the other side.
    pub wait: Duration,
    /// Set to cancel the pairing.
    pub called_off: &'a AtomicBool,
}

impl Pairing<'_> {
    /// Runs the console's side: asks the follower at this address, whose screen shows this code. Returns the follower's
    /// key.
    ///
    /// # Errors
    /// [`PairingError`] if there is no answer, if the code is wrong, which is counted, or after too many wrong codes.
    pub fn ask(&self, follower: SocketAddr, code: Code, attempts: &mut Attempts) -> Result<PublicKey, PairingError> {
        let begin = Instant::now();
        attempts.may_begin()?;
        let address = |source| PairingError::Address { address: follower, source };
        let socket = Socket::open(towards(&follower), Some(follower)).map_err(address)?;
        let mut token = token()?;
        let mut exchange = Console::new(code, self.keys.public());
        let mut progress = begin;
        let mut asked = None;
        let mut buffer = [0; 2 * LEN];
        while self.goes_on(begin) {
            if progress.elapsed() > STUCK {
                // The follower has dropped the exchange, because others began in the meantime.
                token = self::token()?;
                exchange = Console::new(code, self.keys.public());
                progress = Instant::now();
            }
            if asked.is_none_or(|at: Instant| at.elapsed() >= AGAIN) {
                let (step, content) = exchange.question();
                socket.send(&datagram(token, step, &content), follower);
                asked = Some(Instant::now());
            }
            let Some((len, _)) = next(&socket, &mut buffer) else {
                sleep(NAP);
                continue;
            };
            let Some((_, step, content)) = read(&buffer[..len]).filter(|(number, ..)| *number == token) else {
                continue;
            };
            match exchange.take(step, content) {
                Step::Waits => {}
                Step::Continues => {
                    asked = None;
                    progress = Instant::now();
                }
                Step::Done(key) => return Ok(key),
                Step::Wrong => {
                    attempts.count()?;
                    return Err(PairingError::WrongCode);
                }
            }
        }
        Err(PairingError::Nobody)
    }

    fn goes_on(&self, begin: Instant) -> bool {
        begin.elapsed() < self.wait && !self.called_off.load(Relaxed)
    }
}

fn token() -> Result<u64, KeyError> {
    let mut bytes = [0; 8];
    getrandom::fill(&mut bytes).map_err(|_| KeyError::Random)?;
    Ok(u64::from_le_bytes(bytes))
}

fn next(socket: &Socket, buffer: &mut [u8; 2 * LEN]) -> Option<(usize, SocketAddr)> {
    let arrival = socket.receive(buffer)?;
    Some((arrival.len.min(buffer.len()), arrival.from))
}

#[cfg(test)]
mod tests;
