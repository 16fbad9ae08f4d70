//! The follower's side: answers consoles until one of them has proved that it has the code.

use std::{
    net::{IpAddr, SocketAddr},
    thread::sleep,
    time::{Duration, Instant},
};

use super::{
    Code, NAP, Pairing, PairingError,
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
/// Number of guesses after which the code is replaced: a chance of one in a million.
pub(super) const GUESSES_MAX: u32 = 1000;
/// Maximum number of open exchanges, and of addresses whose rates are stored; the oldest are dropped.
const EXCHANGES: usize = 32;
const ADDRESSES: usize = 64;
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
            all: RateBucket::new(PER_S, 2.0 * PER_S),
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
    ) -> Result<Option<OfferAnswer>, KeyError> {
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

    fn begin(&mut self, token: u64, asked: &Content, from: SocketAddr) -> Result<Option<Content>, KeyError> {
        if self.guesses >= GUESSES_MAX {
            self.code = Code::random()?;
            self.guesses = 0;
            self.open.clear();
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
        self.addresses[at].1.spend(1.0, now_s) && self.all.spend(1.0, now_s)
    }
}

impl Pairing<'_> {
    /// Runs the follower's side: listens at this address, and calls `show` with the code to show, again when it is
    /// replaced. Returns the key of the console at which the code was entered.
    ///
    /// # Errors
    /// [`PairingError`] if the address cannot be used, or no console has the code.
    pub fn offer(&self, at: SocketAddr, mut show: impl FnMut(Code)) -> Result<PublicKey, PairingError> {
        let begin = Instant::now();
        let socket = Socket::open(at, None).map_err(|source| PairingError::Address { address: at, source })?;
        let mut offer = Offer::new(self.keys)?;
        let mut shown = None;
        let mut buffer = [0; 2 * LEN];
        while self.goes_on(begin) {
            if shown != Some(offer.code) {
                show(offer.code);
                shown = Some(offer.code);
            }
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
