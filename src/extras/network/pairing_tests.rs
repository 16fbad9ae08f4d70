use std::{net::Ipv4Addr, net::UdpSocket, thread::scope};

use super::*;
use crate::{
    impairment::{ImpairmentSettings, LossModel},
    relay::{Relay, RelaySettings},
};

const WAIT: Duration = Duration::from_secs(10);

/// Returns an address whose port was free a moment ago.
fn free_address() -> SocketAddr {
    UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap()
}

/// Returns a pairing of a machine without earlier wrong codes.
fn offered(keys: &NetworkKeys, at: SocketAddr, called_off: &AtomicBool) -> Result<PendingPairing, PairingError> {
    Pairing { keys, attempts: &mut Attempts::default(), wait: WAIT, called_off }.offer(at)
}

/// Runs both sides; the console reaches the follower through `reached`.
fn both(
    console: &NetworkKeys,
    follower: &NetworkKeys,
    at: SocketAddr,
    reached: SocketAddr,
) -> [Result<PendingPairing, PairingError>; 2] {
    let stop = AtomicBool::new(false);
    scope(|scope| {
        let theirs = scope.spawn(|| offered(follower, at, &stop));
        let attempts = &mut Attempts::default();
        let ours = Pairing { keys: console, attempts, wait: WAIT, called_off: &stop }.ask(reached);
        [ours, theirs.join().unwrap()]
    })
}

#[test]
fn the_code_of_the_other_screen_gives_the_keys_and_that_of_ones_own_does_not() {
    let console = NetworkKeys::random().unwrap();
    let follower = NetworkKeys::random().unwrap();
    let mut codes = Vec::new();
    for _ in 0..2 {
        let at = free_address();
        let [ours, theirs] = both(&console, &follower, at, at).map(Result::unwrap);
        let [here, there] = [ours.code().to_string(), theirs.code().to_string()];
        let mut attempts = Attempts::default();
        assert_ne!(here, there);
        assert_eq!(here.len(), 7);
        codes.push(here.clone());
        let own = PendingPairing { shown: ours.shown, expected: ours.expected, peer: ours.peer };
        assert!(own.confirm(&here, &mut attempts).is_err());
        assert_eq!(ours.confirm(&there, &mut attempts).unwrap(), follower.public());
        assert_eq!(theirs.confirm(&here.replace(' ', ""), &mut attempts).unwrap(), console.public());
    }
    assert_ne!(codes[0], codes[1], "for one time only");
}

#[test]
fn lost_datagrams_are_sent_again() {
    let console = NetworkKeys::random().unwrap();
    let follower = NetworkKeys::random().unwrap();
    let at = free_address();
    let bad = ImpairmentSettings { loss: LossModel::Independent { fraction: 0.3 }, ..ImpairmentSettings::default() };
    let home = (Ipv4Addr::LOCALHOST, 0).into();
    let relay = Relay::start(RelaySettings { at: home, to: at, there: bad, back: bad, seed: 4 }).unwrap();
    let [ours, theirs] = both(&console, &follower, at, relay.address()).map(Result::unwrap);
    assert_eq!([ours.shown, ours.expected], [theirs.expected, theirs.shown]);
}

#[test]
fn a_wrong_code_is_refused_and_the_third_makes_a_pause() {
    let mut attempts = Attempts::default();
    for wrong in ["123 457", "12345", "+23456"] {
        assert!(attempts.may_begin(Instant::now()).is_ok());
        let pending =
            PendingPairing { shown: Code(0), expected: Code(123_456), peer: NetworkKeys::random().unwrap().public() };
        assert!(matches!(pending.confirm(wrong, &mut attempts), Err(PairingError::WrongCode)), "{wrong}");
    }
    let report = attempts.may_begin(Instant::now()).unwrap_err();
    assert!(report.to_string().contains("wait 60 s"), "{report}");
    let stop = AtomicBool::new(false);
    let keys = NetworkKeys::random().unwrap();
    let pairing = Pairing { keys: &keys, attempts: &mut attempts, wait: WAIT, called_off: &stop };
    let report = pairing.offer(free_address()).unwrap_err();
    assert!(matches!(report, PairingError::TooMany { .. }));
    assert!(attempts.may_begin(Instant::now() + PAUSE).is_ok());
}

#[test]
fn who_stands_between_is_seen() {
    // An attacker pairs with both sides under other keys, so the codes differ.
    let [console, follower, between] = [0; 3].map(|_| PairingPart::new(&NetworkKeys::random().unwrap()).unwrap());
    let [[at_console, _], [_, at_follower]] = [codes(&console, &between), codes(&between, &follower)];
    let [[_, expected_there], [expected_here, _]] = [codes(&console, &between), codes(&between, &follower)];
    assert_ne!(at_console, expected_here);
    assert_ne!(at_follower, expected_there);
    // An attacker must commit before it has the follower's part, so a part other than the committed one is detected.
    let at = free_address();
    let stop = AtomicBool::new(false);
    let keys = NetworkKeys::random().unwrap();
    let report = scope(|scope| {
        let theirs = scope.spawn(|| offered(&keys, at, &stop));
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
        let mut answer = [0; 2 * LEN];
        let commitment = datagram(1, COMMIT, &console.commitment());
        while socket.send_to(&commitment, at).is_err() || socket.recv(&mut answer).is_err() {}
        socket.send_to(&datagram(1, REVEAL, &between.bytes()), at).unwrap();
        theirs.join().unwrap()
    });
    assert!(matches!(report, Err(PairingError::Contradiction)));
}

#[test]
fn nobody_and_called_off_are_told() {
    let keys = NetworkKeys::random().unwrap();
    let stop = AtomicBool::new(false);
    let wait = Duration::from_millis(50);
    let pairing = Pairing { keys: &keys, attempts: &mut Attempts::default(), wait, called_off: &stop };
    assert!(matches!(pairing.ask(free_address()), Err(PairingError::Nobody)));
    stop.store(true, Relaxed);
    assert!(matches!(offered(&keys, free_address(), &stop), Err(PairingError::Nobody)));
}

#[test]
fn random_bytes_are_no_pairing() {
    let mut rng = fastrand::Rng::with_seed(8);
    for _ in 0..5000 {
        let bytes: Vec<u8> = (0..rng.usize(..2 * LEN)).map(|_| rng.u8(..)).collect();
        assert!(read(&bytes).is_none());
    }
}
