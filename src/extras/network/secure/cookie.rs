//! Cookies: proof that a sender receives at its address, without storing any state about the sender.

use std::net::{IpAddr, SocketAddr};

use blake2::{
    Blake2sMac,
    digest::{KeyInit, Mac as _, consts::U16},
};

use crate::keys::KeyError;

/// Bytes.
pub(crate) const COOKIE_LEN: usize = 16;
/// A secret is replaced after this, s; the previous one remains valid.
const SECRET_S: f64 = 60.0;

/// Makes and checks cookies.
#[derive(Clone)]
pub struct Cookies {
    secrets: [[u8; 32]; 2],
    made_s: f64,
}

impl std::fmt::Debug for Cookies {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cookies").finish_non_exhaustive()
    }
}

fn random() -> Result<[u8; 32], KeyError> {
    let mut bytes = [0; 32];
    getrandom::fill(&mut bytes).map_err(|_| KeyError::Random)?;
    Ok(bytes)
}

fn mac(secret: &[u8; 32], from: SocketAddr, token: u64) -> Blake2sMac<U16> {
    let mut mac = <Blake2sMac<U16> as KeyInit>::new(secret.into());
    match from.ip() {
        IpAddr::V4(ip) => mac.update(&ip.octets()),
        IpAddr::V6(ip) => mac.update(&ip.octets()),
    }
    mac.update(&from.port().to_le_bytes());
    mac.update(&token.to_le_bytes());
    mac
}

impl Cookies {
    /// Starts with new secrets.
    ///
    /// # Errors
    /// [`KeyError::Random`] if the system provides no random numbers.
    pub fn new(now_s: f64) -> Result<Self, KeyError> {
        Ok(Self { secrets: [random()?, random()?], made_s: now_s })
    }

    /// Returns the cookie for a hello from this address with this number.
    pub fn make(&mut self, from: SocketAddr, token: u64, now_s: f64) -> [u8; COOKIE_LEN] {
        if now_s - self.made_s > SECRET_S
            && let Ok(secret) = random()
        {
            self.secrets = [secret, self.secrets[0]];
            self.made_s = now_s;
        }
        mac(&self.secrets[0], from, token).finalize().into_bytes().into()
    }

    /// Returns whether the cookie was made for this address and number in the last two minutes.
    pub fn is_ours(&self, from: SocketAddr, token: u64, cookie: &[u8]) -> bool {
        self.secrets.iter().any(|secret| mac(secret, from, token).verify_slice(cookie).is_ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cookie_is_good_for_its_address_and_number_for_a_minute_or_two() {
        let mut cookies = Cookies::new(0.0).unwrap();
        let from: SocketAddr = "127.0.0.1:4000".parse().unwrap();
        let cookie = cookies.make(from, 1, 1.0);
        assert!(cookies.is_ours(from, 1, &cookie));
        assert!(!cookies.is_ours(from, 2, &cookie));
        assert!(!cookies.is_ours("127.0.0.1:4001".parse().unwrap(), 1, &cookie));
        assert!(!cookies.is_ours("[::1]:4000".parse().unwrap(), 1, &cookie));
        assert!(!cookies.is_ours(from, 1, &cookie[..15]));
        cookies.make(from, 1, 61.5);
        assert!(cookies.is_ours(from, 1, &cookie));
        cookies.make(from, 1, 122.5);
        assert!(!cookies.is_ours(from, 1, &cookie));
    }
}
