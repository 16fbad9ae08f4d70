//! `nima-bridge-ros2`: poses, forces and states of a loop as ROS 2 topics. A client of the console's `OpenIGTLink`
//! server (`--igtl`), which only sends. This program subscribes to no topic. Its topics are described in
//! `docs/bridges.md`.

mod link;
mod publish;
mod topics;

use std::{
    io,
    net::{Ipv4Addr, SocketAddr, UdpSocket},
    process::ExitCode,
    thread::sleep,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use clap::Parser;

use crate::{link::Ros2Link, publish::Publisher};

/// Interval between two attempts to connect to the console.
const AGAIN: Duration = Duration::from_secs(1);

/// Publishes poses, forces and states of a running loop of NIMA Console as ROS 2 topics with the names of CRTK
#[derive(Debug, Parser)]
#[command(version)]
struct Ros2Arguments {
    /// Address at which `nima run --igtl` or `nima console --igtl` listens
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:18944")]
    from: SocketAddr,
    /// Addresses of this computer in the networks that may read, separated by commas; 127.0.0.1: this computer only,
    /// 0.0.0.0: every network
    #[arg(long, value_name = "ADDRESSES", default_value = "127.0.0.1", value_delimiter = ',', value_parser = own_address)]
    network: Vec<Ipv4Addr>,
    /// ROS 2 domain
    #[arg(long, value_name = "N", env = "ROS_DOMAIN_ID", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=232))]
    domain: u16,
    /// Namespace of the topics
    #[arg(long, value_name = "NAME", default_value = "nima", value_parser = namespace)]
    namespace: String,
    /// Poses and forces per second, 1 to 100
    #[arg(long, value_name = "HZ", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100))]
    rate: u32,
}

/// Checks a name by the rules of ROS 2: letters, digits, underscores, parts between slashes.
fn namespace(text: &str) -> Result<String, String> {
    let is_part = |part: &str| {
        part.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
            && part.chars().all(|one| one.is_ascii_alphanumeric() || one == '_')
    };
    let name = text.trim_matches('/');
    if name.split('/').all(is_part) {
        Ok(name.to_owned())
    } else {
        Err("use letters, digits and underscores, with slashes between parts: nima or lab/nima".to_owned())
    }
}

/// DDS would accept a foreign address too, but no reader would receive anything.
fn own_address(text: &str) -> Result<Ipv4Addr, String> {
    let address: Ipv4Addr = text.parse().map_err(|_| "enter an address such as 192.168.1.5".to_owned())?;
    UdpSocket::bind((address, 0)).map(|_| address).map_err(|_| "this computer does not have this address".to_owned())
}

/// Explains a lost connection, with the remedy.
fn words(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
            "no data for 5 s; check that this is the console's address".to_owned()
        }
        io::ErrorKind::UnexpectedEof => "the run has ended; waiting for the next run".to_owned(),
        io::ErrorKind::InvalidData => format!("{error}; use the address of `--igtl`"),
        _ => format!("{error}; start `nima run --igtl` or `nima console --igtl`"),
    }
}

fn now_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}

fn main() -> ExitCode {
    let arguments = Ros2Arguments::parse();
    let publisher = match Publisher::new(arguments.domain, &arguments.network, &arguments.namespace) {
        Ok(publisher) => publisher,
        Err(error) => {
            eprintln!("nima-bridge-ros2: no DDS in domain {}: {error}; check the network", arguments.domain);
            return ExitCode::FAILURE;
        }
    };
    eprintln!("nima-bridge-ros2: publishes /{}/... in domain {}", arguments.namespace, arguments.domain);
    let mut report = String::new();
    loop {
        let ended = Ros2Link::open(arguments.from, arguments.rate).and_then(|mut link| {
            eprintln!("nima-bridge-ros2: reads from {}", arguments.from);
            report.clear();
            loop {
                let message = link.next()?;
                publisher.publish(&topics::samples(&message));
            }
        });
        publisher.publish(&topics::unknown(now_ns()));
        // Report the same reason only once.
        if let Err::<(), _>(error) = ended {
            let words = words(&error);
            if words != report {
                eprintln!("nima-bridge-ros2: {}: {words}", arguments.from);
                report = words;
            }
        }
        sleep(AGAIN);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_ros_refuses_are_refused_here() {
        assert_eq!(namespace("/lab_2/nima/").as_deref(), Ok("lab_2/nima"));
        for bad in ["", "2nima", "a//b", "a b", "nima!", "~/x"] {
            assert!(namespace(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_command_line_is_sound() {
        use clap::CommandFactory as _;
        Ros2Arguments::command().debug_assert();
        assert!(Ros2Arguments::try_parse_from(["x", "--rate", "0"]).is_err());
        assert!(Ros2Arguments::try_parse_from(["x", "--domain", "233"]).is_err());
    }

    #[test]
    fn it_is_this_computer_alone_unless_another_of_its_addresses_is_named() {
        let network = |arguments: &[&str]| Ros2Arguments::try_parse_from(arguments).map(|all| all.network);
        assert_eq!(network(&["x"]).unwrap(), [Ipv4Addr::LOCALHOST]);
        assert_eq!(network(&["x", "--network", "127.0.0.1,127.0.0.2"]).unwrap().len(), 2);
        // An address reserved for documentation (RFC 5737), which no computer has.
        for foreign in ["203.0.113.77", "lo"] {
            assert!(network(&["x", "--network", foreign]).is_err(), "{foreign}");
        }
    }

    #[test]
    fn a_lost_connection_is_told_with_what_to_do() {
        assert!(
            words(&io::ErrorKind::ConnectionRefused.into())
                .ends_with("start `nima run --igtl` or `nima console --igtl`")
        );
        assert!(words(&io::ErrorKind::UnexpectedEof.into()).starts_with("the run has ended"));
        assert!(words(&io::ErrorKind::WouldBlock.into()).starts_with("no data for 5 s"));
        assert!(words(&io::Error::new(io::ErrorKind::InvalidData, "x")).contains("address of `--igtl`"));
    }
}
