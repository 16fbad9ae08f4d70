//! Where a picture comes from, as a rig file has it.

use std::{fmt, path::PathBuf, str::FromStr};

/// Longest address.
const LENGTH_MOST: usize = 2000;

/// Where a picture comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// Motion JPEG over HTTP: host, port, path with its query.
    Http {
        /// Name or number.
        host: String,
        /// TCP port.
        port: u16,
        /// What is asked for, beginning with a slash.
        path: String,
    },
    /// A `.mjpeg`, a folder of JPEGs, or one JPEG.
    File(PathBuf),
}

/// An address that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{address}\" is not an address of a picture: {why}")]
pub struct AddressError {
    /// As it was given.
    pub address: String,
    /// What is wrong, and what is possible.
    pub why: &'static str,
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        // In a message it must stay one short line.
        let shown = || text.chars().take(80).filter(|c| !c.is_control()).collect();
        let wrong = |why| Err(AddressError { address: shown(), why });
        if text.is_empty() {
            return wrong("give http://HOST:PORT/PATH, or the path of a file or folder");
        }
        if text.len() > LENGTH_MOST || text.chars().any(char::is_control) {
            return wrong("it is too long, or has characters that no address has");
        }
        let Some((scheme, rest)) = text.split_once("://") else { return Ok(Self::File(text.into())) };
        match scheme.to_ascii_lowercase().as_str() {
            "http" => http(rest).or_else(wrong),
            "file" => Ok(Self::File(rest.into())),
            _ => wrong("only http:// and files are supported"),
        }
    }
}

fn http(rest: &str) -> Result<Address, &'static str> {
    let (authority, path) = rest.find(['/', '?']).map_or((rest, "/"), |at| rest.split_at(at));
    if authority.contains('@') {
        return Err("a user or password is not supported");
    }
    let bad_port = "the port must be 1 to 65535";
    let (host, port) = match authority.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((host, port)) => (host, port.strip_prefix(':')),
        None => authority.split_once(':').map_or((authority, None), |(host, port)| (host, Some(port))),
    };
    let port = port.map_or(Ok(80), |port| port.parse().map_err(|_| bad_port))?;
    if port == 0 {
        return Err(bad_port);
    }
    let sound = |text: &str| text.chars().all(|c| c.is_ascii_graphic());
    if host.is_empty() || !sound(host) || !sound(path) {
        return Err("give http://HOST:PORT/PATH, without blanks");
    }
    let path = if path.starts_with('/') { path.to_owned() } else { format!("/{path}") };
    Ok(Address::Http { host: host.to_owned(), port, path })
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Http { host, port, path } if host.contains(':') => write!(f, "http://[{host}]:{port}{path}"),
            Self::Http { host, port, path } => write!(f, "http://{host}:{port}{path}"),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn http_of(text: &str) -> (String, u16, String) {
        match text.parse().unwrap() {
            Address::Http { host, port, path } => (host, port, path),
            Address::File(path) => panic!("{}", path.display()),
        }
    }

    #[test]
    fn what_people_write_is_understood() {
        assert_eq!(http_of("http://10.0.0.7/stream"), ("10.0.0.7".to_owned(), 80, "/stream".to_owned()));
        assert_eq!(http_of("HTTP://cam:8080"), ("cam".to_owned(), 8080, "/".to_owned()));
        assert_eq!(http_of("http://cam:8080?action=stream").2, "/?action=stream");
        assert_eq!(http_of("http://[::1]:81/a?b=c"), ("::1".to_owned(), 81, "/a?b=c".to_owned()));
        for path in ["/data/case.mjpeg", "pictures", "file:///data/case.mjpeg"] {
            assert!(matches!(path.parse(), Ok(Address::File(_))), "{path}");
        }
    }

    #[test]
    fn what_cannot_be_used_is_told_in_one_line() {
        for (text, word) in [
            ("", "give http"),
            ("rtsp://cam/stream", "only http"),
            ("https://cam/", "only http"),
            ("http://user:secret@cam/", "password"),
            ("http://cam:0/", "1 to 65535"),
            ("http://cam:70000/", "1 to 65535"),
            ("http:///stream", "HOST"),
            ("http://cam/a b", "blanks"),
            ("http://cam/a\r\nX: y", "characters"),
        ] {
            let told = text.parse::<Address>().unwrap_err().to_string();
            assert!(told.contains(word) && !told.contains('\n'), "{text}: {told}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_an_address_or_an_error_and_an_address_reads_as_itself(text in "(http://)?.{0,40}") {
            if let Ok(address) = text.parse::<Address>() && matches!(address, Address::Http { .. }) {
                prop_assert_eq!(address.to_string().parse::<Address>(), Ok(address));
            }
        }
    }
}
