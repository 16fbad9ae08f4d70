use std::net::{Ipv4Addr, SocketAddr};

use super::*;
use crate::{
    control::SessionRefusal,
    keys::{NetworkKeys, Peers},
    wire::{self, DatagramKind, HANDSHAKE_LEN, HANDSHAKE_MAX, HELLO_LEN, VERSION},
};

type Datagram = [u8; HANDSHAKE_MAX];

/// Returns a follower with one paired console, that console, and one that is not paired.
fn machines() -> (Reception, Approach, Approach) {
    let follower = NetworkKeys::random().unwrap();
    let console = NetworkKeys::random().unwrap();
    let stranger = NetworkKeys::random().unwrap();
    let mut peers = Peers::default();
    peers.add("console", console.public()).unwrap();
    let key = follower.public();
    let reception = Reception::new(follower, peers, 0.0).unwrap();
    (reception, Approach::new(console, key).unwrap(), Approach::new(stranger, key).unwrap())
}

fn from(number: u32) -> SocketAddr {
    (Ipv4Addr::from(0x0a00_0000 + number), 4000).into()
}

/// Exchanges datagrams at `now_s`; returns the datagrams sent, and the console's final result.
fn talk(
    reception: &mut Reception,
    console: &mut Approach,
    from: SocketAddr,
    now_s: f64,
) -> (usize, bool, Option<HandshakeError>) {
    let mut there: Datagram = [0; HANDSHAKE_MAX];
    let mut back: Datagram = [0; HANDSHAKE_MAX];
    let mut len = console.due(now_s, &mut there);
    let mut sent = 0;
    while len > 0 {
        sent += 1;
        let received = reception.receive(&there[..len], from, now_s, &mut back);
        assert!(received.answer <= len, "no sender gets more than it sent");
        if received.answer == 0 {
            return (sent, false, received.trouble);
        }
        sent += 1;
        let report = console.receive(&back[..received.answer], now_s, &mut there);
        if received.is_agreed() && report.is_agreed() {
            let ours = received.agreed.unwrap();
            let theirs = report.agreed.unwrap();
            assert_eq!((ours.ours, ours.theirs), (theirs.theirs, theirs.ours));
            return (sent, true, None);
        }
        if report.trouble.is_some() {
            return (sent, false, report.trouble);
        }
        len = report.answer;
    }
    (sent, false, None)
}

#[test]
fn a_session_takes_two_round_trips() {
    let (mut reception, mut console, _) = machines();
    assert_eq!(talk(&mut reception, &mut console, from(1), 0.0), (4, true, None));
    // And again, later.
    assert_eq!(talk(&mut reception, &mut console, from(1), 2.0), (4, true, None));
}

#[test]
fn a_stranger_is_told_so_and_leaves_nothing() {
    let (mut reception, _, mut stranger) = machines();
    assert_eq!(
        talk(&mut reception, &mut stranger, from(1), 0.0),
        (4, false, Some(HandshakeError::TheyRefuse(SessionRefusal::Key)))
    );
    let (_, mut console, _) = machines();
    let report = talk(&mut reception, &mut console, from(2), 0.0);
    assert_eq!(report, (4, false, Some(HandshakeError::TheyRefuse(SessionRefusal::Key))), "another follower's key");
}

#[test]
fn another_version_is_told_so() {
    let (mut reception, mut console, _) = machines();
    let mut there = [0; HANDSHAKE_MAX];
    let mut back = [0; HANDSHAKE_MAX];
    let len = console.due(0.0, &mut there);
    there[0] = VERSION + 1;
    let received = reception.receive(&there[..len], from(1), 0.0, &mut back);
    assert_eq!(received.trouble, Some(HandshakeError::ForeignVersion));
    let report = console.receive(&back[..received.answer], 0.0, &mut there);
    assert_eq!(report.trouble, Some(HandshakeError::TheyRefuse(SessionRefusal::Version(VERSION))));
}

#[test]
fn who_is_full_says_so() {
    let (mut reception, mut console, _) = machines();
    reception.is_full = true;
    let report = talk(&mut reception, &mut console, from(1), 0.0);
    assert_eq!(report.2, Some(HandshakeError::TheyRefuse(SessionRefusal::Full)));
}

#[test]
fn lost_datagrams_are_asked_for_again() {
    let (mut reception, mut console, _) = machines();
    let mut rng = fastrand::Rng::with_seed(2);
    let mut there = [0; HANDSHAKE_MAX];
    let mut back = [0; HANDSHAKE_MAX];
    let mut now_s = 0.0;
    let agreed = (0..200).any(|_| {
        now_s += 0.1;
        let mut len = console.due(now_s, &mut there);
        while len > 0 && rng.bool() {
            let answer = reception.receive(&there[..len], from(1), now_s, &mut back).answer;
            if answer == 0 || rng.bool() {
                break;
            }
            let report = console.receive(&back[..answer], now_s, &mut there);
            if report.is_agreed() {
                return true;
            }
            len = report.answer;
        }
        false
    });
    assert!(agreed && now_s < 15.0, "{now_s}");
}

#[test]
fn a_flood_of_half_open_handshakes_costs_no_memory_and_few_key_agreements() {
    let (mut reception, mut console, mut stranger) = machines();
    let mut out = [0; HANDSHAKE_MAX];
    let mut answers = 0;
    let mut flooded = 0;
    for i in 0..50_000_u32 {
        let mut hello = [0; HELLO_LEN];
        hello[..HANDSHAKE_LEN].copy_from_slice(&wire::handshake(DatagramKind::Hello, u64::from(i)));
        let received = reception.receive(&hello, from(i), f64::from(i) * 1e-5, &mut out);
        assert!(!received.is_agreed());
        answers += u32::from(received.answer > 0);
        flooded += u32::from(received.trouble == Some(HandshakeError::Flooded));
        // Some initiations have invented cookies.
        let mut initiation = [7; 200];
        initiation[..HANDSHAKE_LEN].copy_from_slice(&wire::handshake(DatagramKind::Initiation, u64::from(i)));
        let received = reception.receive(&initiation, from(i), f64::from(i) * 1e-5, &mut out);
        assert_eq!((received.answer, received.trouble), (0, Some(HandshakeError::Refused)));
    }
    assert_eq!(answers + flooded, 50_000);
    assert!(answers < 1500, "half a second at 2000 per second, and what was saved up: {answers}");
    assert_eq!(reception.remembered(), 0, "no state");
    // A sender that can receive is limited per address: eight at once, then four per second.
    let computed = (0..1000).filter(|&i| {
        let report = talk(&mut reception, &mut stranger, from(7), 10.0 + f64::from(i) * 1.001);
        report.2 == Some(HandshakeError::TheyRefuse(SessionRefusal::Key))
    });
    assert!(computed.count() > 100);
    assert_eq!(reception.remembered(), 1);
    assert!(talk(&mut reception, &mut console, from(8), 2000.0).1, "the console comes in all the same");
}

#[test]
fn random_and_mutated_datagrams_lead_to_nothing() {
    let (mut reception, mut console, _) = machines();
    let mut rng = fastrand::Rng::with_seed(11);
    let mut there = [0; HANDSHAKE_MAX];
    let mut back = [0; HANDSHAKE_MAX];
    let mut waste = [0; HANDSHAKE_MAX];
    let hello = console.due(0.0, &mut there);
    let cookie = reception.receive(&there[..hello], from(1), 0.0, &mut back).answer;
    let initiation = console.receive(&back[..cookie], 0.0, &mut there).answer;
    for i in 0..2000_u32 {
        let mut mutated = there;
        let at = rng.usize(..initiation);
        mutated[at] ^= 1 << rng.u32(..8);
        let received = reception.receive(&mutated[..initiation], from(1), f64::from(i), &mut waste);
        assert!(!received.is_agreed(), "byte {at}");
        let cut = rng.usize(..initiation);
        assert!(!reception.receive(&there[..cut], from(1), f64::from(i), &mut waste).is_agreed());
        assert!(!console.receive(&mutated[..cut], f64::from(i), &mut waste).is_agreed());
        assert!(
            !reception.receive(&there[..initiation], from(2), f64::from(i), &mut waste).is_agreed(),
            "another address"
        );
    }
}
