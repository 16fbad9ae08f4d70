//! The messages of a pairing, and what each side computes from them.

use blake2::{Blake2s256, Digest as _};
use spake2::{Ed25519Group, Identity, Password, Spake2};

use super::Code;
use crate::{
    keys::PublicKey,
    secure::COOKIE_LEN,
    wire::{self, DatagramKind, HANDSHAKE_LEN},
};

/// Steps, in the first byte after the number of the pairing.
pub(super) const HELLO: u8 = 1;
pub(super) const COOKIE: u8 = 2;
pub(super) const ASK: u8 = 3;
pub(super) const ANSWER: u8 = 4;
pub(super) const PROVE: u8 = 5;
pub(super) const DONE: u8 = 6;

/// Length of a message of SPAKE2, bytes.
const SHARE: usize = 33;
const KEY: usize = 32;
/// All datagrams of a pairing have the length of the longest, so that no answer is longer than its request.
const CONTENT: usize = SHARE + 2 * KEY;
pub(super) const LEN: usize = HANDSHAKE_LEN + 1 + CONTENT;

pub(super) type Content = [u8; CONTENT];

pub(super) fn datagram(token: u64, step: u8, content: &Content) -> [u8; LEN] {
    let mut bytes = [0; LEN];
    bytes[..HANDSHAKE_LEN].copy_from_slice(&wire::handshake(DatagramKind::Pairing, token));
    bytes[HANDSHAKE_LEN] = step;
    bytes[HANDSHAKE_LEN + 1..].copy_from_slice(content);
    bytes
}

/// Returns number, step and content of a datagram of a pairing.
pub(super) fn read(bytes: &[u8]) -> Option<(u64, u8, &Content)> {
    let is_pairing = bytes.len() == LEN && wire::kind(bytes) == Ok(DatagramKind::Pairing);
    let (step, content) = bytes.get(HANDSHAKE_LEN..)?.split_first()?;
    Some((wire::token(bytes)?, *step, content.try_into().ok()?)).filter(|_| is_pairing)
}

/// Writes these parts one after the other.
pub(super) fn content(parts: &[&[u8]]) -> Content {
    let mut content = [0; CONTENT];
    let all = parts.iter().copied().flatten();
    content.iter_mut().zip(all).for_each(|(byte, value)| *byte = *value);
    content
}

fn names() -> [Identity; 2] {
    [Identity::new(b"nima pairing 2 console"), Identity::new(b"nima pairing 2 follower")]
}

/// Proves that the sender has this result of the key exchange, and with which keys.
fn proof(of: &[u8], secret: &[u8], keys: &[PublicKey]) -> [u8; KEY] {
    let mut hash = Blake2s256::new_with_prefix(b"nima pairing 2 proof of the ");
    hash.update(of);
    hash.update(secret);
    for key in keys {
        hash.update(key.bytes());
    }
    hash.finalize().into()
}

/// Compares in the same time wherever the first difference is.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (a, b)| all | (a ^ b)) == 0
}

fn key(bytes: &[u8]) -> Option<PublicKey> {
    bytes.try_into().ok().map(PublicKey::new)
}

/// Progress of the console's side.
pub(super) enum Step {
    /// The datagram was not the expected one.
    Waits,
    /// There is another question.
    Continues,
    /// The follower's key.
    Done(PublicKey),
    /// The follower has another code.
    Wrong,
}

/// The console's side.
pub(super) struct Console {
    key: PublicKey,
    share: Vec<u8>,
    stage: Stage,
}

enum Stage {
    Hello(Spake2<Ed25519Group>),
    Asks(Spake2<Ed25519Group>, [u8; COOKIE_LEN]),
    Proves { secret: Vec<u8>, follower: PublicKey },
    Over,
}

impl Console {
    pub(super) fn new(code: Code, key: PublicKey) -> Self {
        let [console, follower] = names();
        let (state, share) = Spake2::start_a(&Password::new(code.0), &console, &follower);
        Self { key, share, stage: Stage::Hello(state) }
    }

    /// Returns step and content of the datagram to send.
    pub(super) fn question(&self) -> (u8, Content) {
        match &self.stage {
            Stage::Hello(_) | Stage::Over => (HELLO, content(&[])),
            Stage::Asks(_, cookie) => (ASK, content(&[cookie, &self.share])),
            Stage::Proves { secret, follower } => {
                let proof = proof(b"console", secret, &[self.key, *follower]);
                (PROVE, content(&[self.key.bytes(), &proof]))
            }
        }
    }

    pub(super) fn take(&mut self, step: u8, content: &Content) -> Step {
        match (step, std::mem::replace(&mut self.stage, Stage::Over)) {
            (COOKIE, Stage::Hello(state)) => {
                let mut cookie = [0; COOKIE_LEN];
                cookie.copy_from_slice(&content[..COOKIE_LEN]);
                self.stage = Stage::Asks(state, cookie);
                Step::Continues
            }
            (ANSWER, Stage::Asks(state, _)) => {
                let Ok(secret) = state.finish(&content[..SHARE]) else { return Step::Wrong };
                let (follower, told) = content[SHARE..].split_at(KEY);
                let Some(follower) = key(follower) else { return Step::Wrong };
                if !is_same(told, &proof(b"follower", &secret, &[follower])) {
                    return Step::Wrong;
                }
                self.stage = Stage::Proves { secret, follower };
                Step::Continues
            }
            (DONE, Stage::Proves { secret, follower })
                if is_same(&content[..KEY], &proof(b"end", &secret, &[self.key, follower])) =>
            {
                Step::Done(follower)
            }
            (_, stage) => {
                self.stage = stage;
                Step::Waits
            }
        }
    }
}

/// The follower's side of one exchange.
pub(super) struct Follower {
    key: PublicKey,
    secret: Vec<u8>,
    answer: Content,
}

impl Follower {
    /// Answers a console; `None` if its message is not one of SPAKE2.
    pub(super) fn new(code: Code, own: PublicKey, asked: &Content) -> Option<Self> {
        let [console, follower] = names();
        let (state, share) = Spake2::<Ed25519Group>::start_b(&Password::new(code.0), &console, &follower);
        let secret = state.finish(&asked[COOKIE_LEN..][..SHARE]).ok()?;
        let answer = content(&[&share, own.bytes(), &proof(b"follower", &secret, &[own])]);
        Some(Self { key: own, secret, answer })
    }

    pub(super) const fn answer(&self) -> &Content {
        &self.answer
    }

    /// Returns the console's key and the last datagram's content, if the console has proved that it has the code.
    pub(super) fn verify(&self, proved: &Content) -> Option<(PublicKey, Content)> {
        let (console, told) = proved[..2 * KEY].split_at(KEY);
        let console = key(console)?;
        let keys = [console, self.key];
        is_same(told, &proof(b"console", &self.secret, &keys))
            .then(|| (console, content(&[&proof(b"end", &self.secret, &keys)])))
    }
}
