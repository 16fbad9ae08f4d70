//! The follower's side: answers consoles until one of them has proved that it has the code.

use std::{
    net::{IpAddr, SocketAddr},
    thread::sleep,
    time::{Duration, Instant},
};

use super::{
    Code, NAP, Pairing, PairingError, WAIT_USUAL,
    exchange::{ANSWER, ASK, COOKIE, Content, DONE, Follower, HELLO, LEN, PROVE, content, datagram, read},
    next,
};
use crate::{
    keys::{KeyError, NetworkKeys, PublicKey},
    rate::RateBucket,
    secure::{COOKIE_LEN, Cookies},
    socket::Socket,
};

/// Maximum exchanges per second, in total and for one address, and the maximum burst. Each exchange is one guess of the
/// code.
const PER_S: f64 = 8.0;
const PER_S_ADDRESS: f64 = 1.0;
const AT_ONCE: f64 = 4.0;
/// Number of guesses after which an offer ends: a chance of one in a million, however long the offer lasts. The code is
/// never replaced, because that would give further guesses, and would change the code while a person enters it.
pub(super) const GUESSES_MAX: u32 = 1000;
/// Maximum number of open exchanges, and of addresses whose rates are stored; the oldest are dropped.
const EXCHANGES: usize = 32;
const ADDRESSES: usize = 64;
/// Exchanges that can begin at once, in total.
const ALL_AT_ONCE: f64 = 2.0 * PER_S;
// A stranger at many addresses cannot end an offer within the usual time.
const _: () = assert!((ALL_AT_ONCE + PER_S * WAIT_USUAL.as_secs() as f64) as u32 <= GUESSES_MAX);
/// The last answer is repeated for this long if its request is repeated, because it may have been lost.
const REPEATS: Duration = Duration::from_secs(1);

struct Exchange {
    from: SocketAddr,
    token: u64,
    follower: Follower,
}

/// A datagram, and the key of a console that has proved that it has the code.
type OfferAnswer = ([u8; LEN], Option<PublicKey>);

/// A follower that offers pairing: computes the answers, without socket and clock.
pub(super) struct Offer<'a> {
    keys: &'a NetworkKeys,
    pub(super) code: Code,
    pub(super) guesses: u32,
    cookies: Cookies,
    all: RateBucket,
    addresses: Vec<(IpAddr, RateBucket)>,
    open: Vec<Exchange>,
}

impl<'a> Offer<'a> {
    pub(super) fn new(keys: &'a NetworkKeys) -> Result<Self, KeyError> {
        Ok(Self {
            keys,
            code: Code::random()?,
            guesses: 0,
            cookies: Cookies::new(0.0)?,
            all: RateBucket::new(PER_S, ALL_AT_ONCE),
            addresses: Vec::new(),
            open: Vec::new(),
        })
    }

    /// Returns the answer to a datagram, and the key of a console that has proved that it has the code.
    pub(super) fn take(
        &mut self,
        (token, step, asked): (u64, u8, &Content),
        from: SocketAddr,
        now_s: f64,
    ) -> Result<Option<OfferAnswer>, PairingError> {
        let known = self.open.iter().position(|open| (open.from, open.token) == (from, token));
        let (step, answer, console) = match (step, known) {
            (HELLO, _) => (COOKIE, content(&[&self.cookies.make(from, token, now_s)]), None),
            (ASK, Some(at)) => (ANSWER, *self.open[at].follower.answer(), None),
            (ASK, None) if self.cookies.is_ours(from, token, &asked[..COOKIE_LEN]) && self.may(from.ip(), now_s) => {
                let Some(answer) = self.begin(token, asked, from)? else { return Ok(None) };
                (ANSWER, answer, None)
            }
            (PROVE, Some(at)) => match self.open[at].follower.verify(asked) {
                Some((console, end)) => (DONE, end, Some(console)),
                None => return Ok(None),
            },
            _ => return Ok(None),
        };
        Ok(Some((datagram(token, step, &answer), console)))
    }

    fn begin(&mut self, token: u64, asked: &Content, from: SocketAddr) -> Result<Option<Content>, PairingError> {
        if self.guesses >= GUESSES_MAX {
            return Err(PairingError::Guessed);
        }
        let Some(follower) = Follower::new(self.code, self.keys.public(), asked) else { return Ok(None) };
        self.guesses += 1;
        let answer = *follower.answer();
        if self.open.len() == EXCHANGES {
            self.open.remove(0);
        }
        self.open.push(Exchange { from, token, follower });
        Ok(Some(answer))
    }

    /// Returns whether another exchange with this address may begin now.
    fn may(&mut self, ip: IpAddr, now_s: f64) -> bool {
        let known = self.addresses.iter().position(|(known, _)| *known == ip);
        let at = known.unwrap_or_else(|| {
            if self.addresses.len() == ADDRESSES {
                self.addresses.remove(0);
            }
            self.addresses.push((ip, RateBucket::new(PER_S_ADDRESS, AT_ONCE)));
            self.addresses.len() - 1
        });
        let (_, own) = &mut self.addresses[at];
        // An address loses nothing if the others have left nothing: it gets the next exchange that may begin.
        own.level(now_s) >= 1.0 && self.all.spend(1.0, now_s) && own.spend(1.0, now_s)
    }
}

impl Pairing<'_> {
    /// Runs the follower's side: listens at this address, and calls `show` with the code to show. Returns the key of the
    /// console at which the code was entered.
    ///
    /// # Errors
    /// [`PairingError`] if the address cannot be used, if no console has the code, or after too many guesses.
    pub fn offer(&self, at: SocketAddr, show: impl FnOnce(Code)) -> Result<PublicKey, PairingError> {
        let begin = Instant::now();
        let socket = Socket::open(at, None).map_err(|source| PairingError::Address { address: at, source })?;
        let mut offer = Offer::new(self.keys)?;
        show(offer.code);
        let mut buffer = [0; 2 * LEN];
        while self.goes_on(begin) {
            let Some((len, from)) = next(&socket, &mut buffer) else {
                sleep(NAP);
                continue;
            };
            let Some(asked) = read(&buffer[..len]) else { continue };
            let Some((answer, console)) = offer.take(asked, from, begin.elapsed().as_secs_f64())? else { continue };
            socket.send(&answer, from);
            if let Some(console) = console {
                repeat(&socket, &answer, asked.0, from);
                return Ok(console);
            }
        }
        Err(PairingError::Nobody)
    }
}

/// Repeats the last answer for each request that shows that it was lost.
fn repeat(socket: &Socket, answer: &[u8; LEN], token: u64, to: SocketAddr) {
    let begin = Instant::now();
    let mut buffer = [0; 2 * LEN];
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
