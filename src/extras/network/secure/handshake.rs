//! Both sides of the handshake, without their own socket or clock.

use std::net::{IpAddr, SocketAddr};

use snow::{Builder, HandshakeState, StatelessTransportState};

use super::cookie::{COOKIE_LEN, Cookies};
use crate::{
    control::SessionRefusal,
    keys::{KeyError, NetworkKeys, Peers, PublicKey},
    rate::RateBucket,
    wire::{self, DatagramKind, HANDSHAKE_LEN, HANDSHAKE_MAX, HELLO_LEN, Unreadable},
};

/// The protocol's name in the Noise framework.
pub const NOISE: &str = "Noise_IK_25519_ChaChaPoly_BLAKE2s";
/// Both sides mix this into the handshake, so that another version fails even if its bytes look alike.
const PROLOGUE: &[u8] = b"nima network 1";
/// Length of the session number that each side sends within the handshake, bytes.
const NUMBER_LEN: usize = 4;
/// Handshakes computed per second: in total, and for one address.
const PER_S: f64 = 32.0;
const PER_S_ADDRESS: f64 = 4.0;
/// Answers to strangers per second: cookies and refusals.
const ANSWERS_PER_S: f64 = 2000.0;
/// Number of addresses whose rates are stored.
const ADDRESSES: usize = 64;
/// Interval before a request is repeated, s; it doubles each time, up to the second value.
const AGAIN_S: f64 = 0.1;
const AGAIN_MAX_S: f64 = 1.0;

/// Result of a handshake.
#[derive(Debug)]
pub(crate) struct AgreedKeys {
    pub(crate) keys: StatelessTransportState,
    pub(crate) peer: PublicKey,
    /// Numbers of the session at the other side and here.
    pub(crate) theirs: u32,
    pub(crate) ours: u32,
}

/// Result of processing a handshake's datagram. `answer` is the number of bytes written to `out`.
#[derive(Debug)]
pub struct HandshakeResult {
    /// Length of the answer, bytes; 0 for none.
    pub answer: usize,
    /// Reason for the rejection.
    pub trouble: Option<HandshakeError>,
    pub(crate) agreed: Option<Box<AgreedKeys>>,
}

/// Why a datagram of a handshake was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandshakeError {
    /// Truncated, or unexpected.
    Malformed,
    /// The datagram has another version; the sender has been informed.
    ForeignVersion,
    /// Beyond the rate limits.
    Flooded,
    /// A cookie that is not ours, an unknown key, or a message that cannot be decrypted.
    Refused,
    /// The other side refuses a session.
    TheyRefuse(SessionRefusal),
}

impl HandshakeResult {
    const fn trouble(trouble: HandshakeError) -> Self {
        Self { answer: 0, trouble: Some(trouble), agreed: None }
    }

    /// Returns whether a session was created.
    pub const fn is_agreed(&self) -> bool {
        self.agreed.is_some()
    }
}

fn number() -> Result<[u8; NUMBER_LEN], KeyError> {
    let mut bytes = [0; NUMBER_LEN];
    getrandom::fill(&mut bytes).map_err(|_| KeyError::Random)?;
    Ok(bytes)
}

fn builder(keys: &NetworkKeys) -> Result<Builder<'_>, snow::Error> {
    Builder::new(NOISE.parse()?).local_private_key(keys.private())?.prologue(PROLOGUE)
}

/// Writes a datagram of a handshake; returns its length.
fn write(out: &mut [u8; HANDSHAKE_MAX], kind: DatagramKind, token: u64, content: &[u8]) -> usize {
    let end = HANDSHAKE_LEN + content.len();
    out[..HANDSHAKE_LEN].copy_from_slice(&wire::handshake(kind, token));
    match out.get_mut(HANDSHAKE_LEN..end) {
        Some(room) => room.copy_from_slice(content),
        None => return 0,
    }
    end
}

/// The follower's side.
#[derive(Debug)]
pub struct Reception {
    keys: NetworkKeys,
    peers: Peers,
    cookies: Cookies,
    all: RateBucket,
    answers: RateBucket,
    addresses: Vec<(IpAddr, RateBucket)>,
    /// Whether no more consoles are admitted now.
    pub is_full: bool,
}

impl Reception {
    /// Admits these machines.
    ///
    /// # Errors
    /// [`KeyError::Random`] if the system provides no random numbers.
    pub fn new(keys: NetworkKeys, peers: Peers, now_s: f64) -> Result<Self, KeyError> {
        Ok(Self {
            keys,
            peers,
            cookies: Cookies::new(now_s)?,
            all: RateBucket::new(PER_S, PER_S),
            answers: RateBucket::new(ANSWERS_PER_S, ANSWERS_PER_S / 10.0),
            addresses: Vec::with_capacity(ADDRESSES),
            is_full: false,
        })
    }

    /// Returns the number of addresses about which it stores anything.
    pub fn remembered(&self) -> usize {
        self.addresses.len()
    }

    /// Processes a datagram of a handshake from this address; writes the answer to `out`.
    pub fn receive(
        &mut self,
        datagram: &[u8],
        from: SocketAddr,
        now_s: f64,
        out: &mut [u8; HANDSHAKE_MAX],
    ) -> HandshakeResult {
        let Some(token) = wire::token(datagram) else { return HandshakeResult::trouble(HandshakeError::Malformed) };
        let kind = wire::kind(datagram);
        if matches!(kind, Ok(DatagramKind::Hello) | Err(Unreadable::ForeignVersion(_))) {
            // The answer is shorter than the request, so that it cannot be used to amplify an attack.
            if datagram.len() < HELLO_LEN {
                return HandshakeResult::trouble(HandshakeError::Malformed);
            }
            if !self.answers.spend(1.0, now_s) {
                return HandshakeResult::trouble(HandshakeError::Flooded);
            }
        }
        match kind {
            Ok(DatagramKind::Hello) => {
                let cookie = self.cookies.make(from, token, now_s);
                HandshakeResult {
                    answer: write(out, DatagramKind::Cookie, token, &cookie),
                    trouble: None,
                    agreed: None,
                }
            }
            Ok(DatagramKind::Initiation) => self.initiate(&datagram[HANDSHAKE_LEN..], token, from, now_s, out),
            Err(Unreadable::ForeignVersion(_)) => {
                let answer = write(out, DatagramKind::Refusal, token, &SessionRefusal::Version(wire::VERSION).bytes());
                HandshakeResult { answer, ..HandshakeResult::trouble(HandshakeError::ForeignVersion) }
            }
            _ => HandshakeResult::trouble(HandshakeError::Malformed),
        }
    }

    fn initiate(
        &mut self,
        content: &[u8],
        token: u64,
        from: SocketAddr,
        now_s: f64,
        out: &mut [u8; HANDSHAKE_MAX],
    ) -> HandshakeResult {
        let Some((cookie, message)) = content.split_at_checked(COOKIE_LEN) else {
            return HandshakeResult::trouble(HandshakeError::Malformed);
        };
        if !self.cookies.is_ours(from, token, cookie) {
            return HandshakeResult::trouble(HandshakeError::Refused);
        }
        if !self.may_compute(from.ip(), now_s) {
            return HandshakeResult::trouble(HandshakeError::Flooded);
        }
        if self.is_full {
            let answer = write(out, DatagramKind::Refusal, token, &SessionRefusal::Full.bytes());
            return HandshakeResult { answer, ..HandshakeResult::trouble(HandshakeError::Refused) };
        }
        if let Some((agreed, response, len)) = self.agree(message) {
            let answer = write(out, DatagramKind::Response, token, &response[..len]);
            HandshakeResult { answer, trouble: None, agreed: Some(Box::new(agreed)) }
        } else {
            let answer = write(out, DatagramKind::Refusal, token, &SessionRefusal::Key.bytes());
            HandshakeResult { answer, ..HandshakeResult::trouble(HandshakeError::Refused) }
        }
    }

    fn agree(&self, message: &[u8]) -> Option<(AgreedKeys, [u8; HANDSHAKE_MAX], usize)> {
        let mut noise = builder(&self.keys).ok()?.build_responder().ok()?;
        let mut theirs = [0; HANDSHAKE_MAX];
        let len = noise.read_message(message, &mut theirs).ok()?;
        let theirs: [u8; NUMBER_LEN] = theirs[..len].try_into().ok()?;
        let peer = PublicKey::new(noise.get_remote_static()?.try_into().ok()?);
        self.peers.with_key(&peer)?;
        let ours = number().ok()?;
        let mut response = [0; HANDSHAKE_MAX];
        let len = noise.write_message(&ours, &mut response).ok()?;
        let keys = noise.into_stateless_transport_mode().ok()?;
        let agreed = AgreedKeys { keys, peer, theirs: u32::from_le_bytes(theirs), ours: u32::from_le_bytes(ours) };
        Some((agreed, response, len))
    }

    /// Returns whether another handshake of this address may be computed now.
    fn may_compute(&mut self, ip: IpAddr, now_s: f64) -> bool {
        let known = self.addresses.iter().position(|(known, _)| *known == ip);
        let index = known.unwrap_or_else(|| {
            if self.addresses.len() == ADDRESSES {
                self.addresses.remove(0);
            }
            self.addresses.push((ip, RateBucket::new(PER_S_ADDRESS, 2.0 * PER_S_ADDRESS)));
            self.addresses.len() - 1
        });
        let own = self.addresses.get_mut(index).is_some_and(|(_, bucket)| bucket.spend(1.0, now_s));
        own && self.all.spend(1.0, now_s)
    }
}

/// The answer that a console is waiting for.
#[derive(Debug)]
enum Waits {
    Cookie,
    Response { noise: Box<HandshakeState>, ours: u32, sent: Box<[u8; HANDSHAKE_MAX]>, len: usize },
}

/// The console's side: repeats attempts until a session is created.
#[derive(Debug)]
pub struct Approach {
    keys: NetworkKeys,
    follower: PublicKey,
    token: u64,
    waits: Waits,
    next_s: f64,
    pause_s: f64,
}

impl Approach {
    /// Connects to the follower with this key.
    ///
    /// # Errors
    /// [`KeyError::Random`] if the system provides no random numbers.
    pub fn new(keys: NetworkKeys, follower: PublicKey) -> Result<Self, KeyError> {
        let mut this = Self { keys, follower, token: 0, waits: Waits::Cookie, next_s: f64::MIN, pause_s: AGAIN_S };
        this.begin_again()?;
        Ok(this)
    }

    fn begin_again(&mut self) -> Result<(), KeyError> {
        let mut token = [0; 8];
        getrandom::fill(&mut token).map_err(|_| KeyError::Random)?;
        self.token = u64::from_le_bytes(token);
        self.waits = Waits::Cookie;
        Ok(())
    }

    /// Writes the datagram to be sent now: the repeated request, or one with a new number if no answer has arrived.
    /// Returns 0 for none.
    pub fn due(&mut self, now_s: f64, out: &mut [u8; HANDSHAKE_MAX]) -> usize {
        if now_s < self.next_s {
            return 0;
        }
        // Repeat the same initiation for as long as the follower's cookie is valid, because its response may have been
        // lost; then start again.
        self.next_s = now_s + self.pause_s;
        self.pause_s = (2.0 * self.pause_s).min(AGAIN_MAX_S);
        if self.pause_s >= AGAIN_MAX_S && self.begin_again().is_err() {
            return 0;
        }
        match &self.waits {
            Waits::Cookie => write(out, DatagramKind::Hello, self.token, &[0; HELLO_LEN - HANDSHAKE_LEN]),
            Waits::Response { sent, len, .. } => {
                out.copy_from_slice(&sent[..]);
                *len
            }
        }
    }

    /// Processes a datagram of a handshake; writes the answer to `out`.
    pub fn receive(&mut self, datagram: &[u8], now_s: f64, out: &mut [u8; HANDSHAKE_MAX]) -> HandshakeResult {
        if wire::token(datagram) != Some(self.token) {
            return HandshakeResult::trouble(HandshakeError::Malformed);
        }
        let content = &datagram[HANDSHAKE_LEN..];
        match (wire::kind(datagram), &mut self.waits) {
            (Ok(DatagramKind::Cookie), Waits::Cookie) => match self.initiate(content, out) {
                Some(answer) => {
                    self.next_s = now_s + AGAIN_S;
                    self.pause_s = AGAIN_S;
                    HandshakeResult { answer, trouble: None, agreed: None }
                }
                None => HandshakeResult::trouble(HandshakeError::Malformed),
            },
            (Ok(DatagramKind::Response), Waits::Response { .. }) => match self.finish(content) {
                Some(agreed) => {
                    // Give the loop time to adopt the session before another one is requested.
                    self.next_s = now_s + AGAIN_MAX_S;
                    self.pause_s = AGAIN_S;
                    HandshakeResult { answer: 0, trouble: None, agreed: Some(Box::new(agreed)) }
                }
                None => HandshakeResult::trouble(HandshakeError::Refused),
            },
            (Ok(DatagramKind::Refusal), _) => {
                let refusal = content.first_chunk().and_then(|&bytes| SessionRefusal::from_bytes(bytes));
                self.next_s = now_s + AGAIN_MAX_S;
                self.pause_s = AGAIN_MAX_S;
                HandshakeResult::trouble(refusal.map_or(HandshakeError::Malformed, HandshakeError::TheyRefuse))
            }
            _ => HandshakeResult::trouble(HandshakeError::Malformed),
        }
    }

    fn initiate(&mut self, cookie: &[u8], out: &mut [u8; HANDSHAKE_MAX]) -> Option<usize> {
        if cookie.len() != COOKIE_LEN {
            return None;
        }
        let remote = self.follower;
        let noise = builder(&self.keys).ok()?.remote_public_key(remote.bytes()).ok()?;
        let mut noise = noise.build_initiator().ok()?;
        let ours = number().ok()?;
        let mut content = [0; HANDSHAKE_MAX];
        content[..COOKIE_LEN].copy_from_slice(cookie);
        let len = COOKIE_LEN + noise.write_message(&ours, &mut content[COOKIE_LEN..]).ok()?;
        let answer = write(out, DatagramKind::Initiation, self.token, &content[..len]);
        let ours = u32::from_le_bytes(ours);
        self.waits = Waits::Response { noise: Box::new(noise), ours, sent: Box::new(*out), len: answer };
        Some(answer)
    }

    fn finish(&mut self, message: &[u8]) -> Option<AgreedKeys> {
        let Waits::Response { noise, ours, .. } = &mut self.waits else { return None };
        let mut theirs = [0; HANDSHAKE_MAX];
        let ours = *ours;
        // A message that fails leaves the state unchanged, because the genuine one may still arrive.
        let len = noise.read_message(message, &mut theirs).ok()?;
        let theirs: [u8; NUMBER_LEN] = theirs[..len].try_into().ok()?;
        let Waits::Response { noise, .. } = std::mem::replace(&mut self.waits, Waits::Cookie) else { return None };
        let keys = noise.into_stateless_transport_mode().ok()?;
        self.begin_again().ok()?;
        Some(AgreedKeys { keys, peer: self.follower, theirs: u32::from_le_bytes(theirs), ours })
    }
}
