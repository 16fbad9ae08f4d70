//! Addresses that are reserved for documentation (RFC 5737, 3849 and 6761). The rigs that come with the program have
//! such addresses; nothing is sent to them, because a router would pass it on.

use std::net::{IpAddr, SocketAddr};

use crate::DeviceError;

/// Returns whether a host, with or without a port, is an example.
pub fn is_example(place: &str) -> bool {
    let host = match place.parse::<SocketAddr>() {
        Ok(address) => return is_example_ip(address.ip()),
        Err(_) => place.rsplit_once(':').filter(|(host, _)| !host.contains(':')).map_or(place, |(host, _)| host),
    };
    if let Ok(ip) = host.trim_matches(['[', ']']).parse::<IpAddr>() {
        return is_example_ip(ip);
    }
    let host = host.trim_end_matches('.').to_ascii_lowercase();
    let names = ["example", "example.com", "example.net", "example.org", "invalid"];
    names.iter().any(|name| host == *name || host.strip_suffix(name).is_some_and(|rest| rest.ends_with('.')))
}

fn is_example_ip(ip: IpAddr) -> bool {
    match ip {
        IpAddr::V4(ip) => ip.is_documentation(),
        IpAddr::V6(ip) => ip.segments()[..2] == [0x2001, 0xdb8],
    }
}

/// Refuses an example before a name is looked up or a datagram is sent.
///
/// # Errors
/// [`DeviceError::Example`].
pub fn check_no_example(place: &str) -> Result<(), DeviceError> {
    if is_example(place) { Err(DeviceError::Example { place: place.to_owned() }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_recognised_with_and_without_a_port() {
        for place in
            ["192.0.2.10", "192.0.2.10:10000", "198.51.100.1", "203.0.113.7:23", "2001:db8::1", "[2001:db8::1]:80"]
        {
            assert!(is_example(place), "{place}");
        }
        assert!(is_example("arm.example:10000") && is_example("example.com") && is_example("cam.example.org."));
        for place in ["192.168.1.10", "127.0.0.1:1", "::1", "[::1]:80", "myexample.com", "localhost:80", ""] {
            assert!(!is_example(place), "{place}");
        }
    }
}
