use std::{
    net::UdpSocket,
    sync::atomic::AtomicBool,
    thread::{scope, sleep},
    time::{Duration, Instant},
};

use nima_testing::real_time::{alone, judged};

use super::*;
use crate::{
    impairment::{ImpairmentSettings, LossModel},
    keys::{NetworkKeys, Peers},
    relay::{Relay, RelaySettings},
    wire::{self, DatagramKind, HELLO_LEN, VERSION},
};

const HOME: (Ipv4Addr, u16) = (Ipv4Addr::LOCALHOST, 0);
const TICK: Duration = Duration::from_millis(1);

/// Returns a follower that admits consoles with these keys.
fn follower(keys: &NetworkKeys, consoles: &[&NetworkKeys], at: SocketAddr) -> Endpoint {
    let mut peers = Peers::default();
    for (i, console) in consoles.iter().enumerate() {
        peers.add(&format!("console {i}"), console.public()).unwrap();
    }
    Endpoint::open(EndpointConfig::new(EndpointRole::Follower { at: Some(at), consoles: peers }, keys.clone())).unwrap()
}

fn console(keys: &NetworkKeys, key: PublicKey, follower: SocketAddr) -> Endpoint {
    Endpoint::open(EndpointConfig::new(EndpointRole::Console { follower, key }, keys.clone())).unwrap()
}

/// An endpoint and its received payloads.
struct End {
    endpoint: Endpoint,
    got: Vec<u64>,
    ages_s: Vec<f64>,
    sent: u64,
    /// Offset of its clock, s.
    ahead_s: f64,
}

impl End {
    fn new(endpoint: Endpoint) -> Self {
        Self { endpoint, got: Vec::new(), ages_s: Vec::new(), sent: 0, ahead_s: 0.0 }
    }

    fn tick(&mut self, now_s: f64) {
        let now_s = now_s + self.ahead_s;
        let mut received = self.endpoint.poll(now_s);
        while let Some(payload) = received.next_due() {
            self.got.push(u64::from_le_bytes(payload.bytes.try_into().unwrap()));
            self.ages_s.push(payload.age_s);
        }
        if self.endpoint.send(now_s, &self.sent.to_le_bytes()) != SendOutcome::NotOpen {
            self.sent += 1;
        }
    }
}

/// Real time, one tick after the other.
struct Time {
    begin: Instant,
}

impl Time {
    fn start() -> Self {
        Self { begin: Instant::now() }
    }

    fn now_s(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    /// Runs ticks until `done`, for at most five seconds; returns whether it succeeded, and after how long, s.
    fn until(&self, ends: &mut [&mut End], done: impl Fn(&[&mut End]) -> bool) -> Option<f64> {
        let from_s = self.now_s();
        while self.now_s() - from_s < 5.0 {
            for end in &mut *ends {
                end.tick(self.now_s());
            }
            if done(ends) {
                return Some(self.now_s() - from_s);
            }
            sleep(TICK);
        }
        None
    }

    fn run(&self, ends: &mut [&mut End], length_s: f64) {
        let to_s = self.now_s() + length_s;
        self.until(ends, |_| self.now_s() >= to_s);
    }
}

fn are_open(ends: &[&mut End]) -> bool {
    ends.iter().all(|end| end.endpoint.state() == LinkState::Open)
}

fn keys() -> NetworkKeys {
    NetworkKeys::random().unwrap()
}

/// Returns a follower and its console, connected.
fn pair() -> (Time, End, End, NetworkKeys, NetworkKeys) {
    let theirs = keys();
    let ours = keys();
    let mut far = End::new(follower(&theirs, &[&ours], HOME.into()));
    let address = far.endpoint.address().unwrap();
    let mut near = End::new(console(&ours, theirs.public(), address));
    let time = Time::start();
    time.until(&mut [&mut far, &mut near], are_open).expect("they find each other");
    (time, far, near, theirs, ours)
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn two_loops_exchange_payloads_at_a_thousand_per_second() {
    let _alone = alone();
    judged(|| {
        let theirs = keys();
        let ours = keys();
        let far = follower(&theirs, &[&ours], HOME.into());
        let near = console(&ours, theirs.public(), far.address().unwrap());
        let begin = Instant::now();
        let work = |endpoint: Endpoint| {
            let mut end = End::new(endpoint);
            let mut wake = begin;
            while begin.elapsed() < Duration::from_secs(3) {
                end.tick(begin.elapsed().as_secs_f64());
                wake = (wake + TICK).max(Instant::now());
                sleep(wake.saturating_duration_since(Instant::now()));
            }
            let figures = end.endpoint.figures();
            (figures, end.endpoint.state(), end.endpoint.handshake_datagrams(), end)
        };
        let ends = scope(|scope| [far, near].map(|end| scope.spawn(|| work(end))).map(|thread| thread.join().unwrap()));
        for (figures, state, handshake, end) in &ends {
            assert_eq!((*state, *handshake), (LinkState::Open, 2), "two datagrams from each side: two round trips");
            assert!(end.got.len() > 2600, "{}", end.got.len());
            assert!(end.got.windows(2).all(|pair| pair[1] == pair[0] + 1), "none lost");
            let clock = figures.clock.unwrap();
            assert!(clock.offset_s.abs() <= clock.bound_s + 1e-4 && clock.bound_s < 1e-3, "{clock:?}");
            assert_eq!(figures.counts.lost, 0);
        }
        assert!(ends.iter().all(|(.., end)| end.endpoint.dropped().total() == 0));
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn who_closes_says_so() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, near, theirs, ours) = pair();
        drop(near);
        let closed = |ends: &[&mut End]| ends[0].endpoint.state() == LinkState::Down(LinkCause::PeerClosed);
        assert!(time.until(&mut [&mut far], closed).expect("it is reported") < 0.1);
        let address = far.endpoint.address().unwrap();
        let mut near = End::new(console(&ours, theirs.public(), address));
        time.until(&mut [&mut far, &mut near], are_open).expect("and it comes back");
        drop(far);
        assert!(time.until(&mut [&mut near], closed).expect("it is reported") < 0.1);
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn silence_is_told_with_its_length_and_ends_without_a_new_session() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, mut near, ..) = pair();
        let before = near.endpoint.handshake_datagrams();
        time.run(&mut [&mut near], 0.3);
        let LinkState::Down(LinkCause::Silent { for_s }) = near.endpoint.state() else {
            panic!("{:?}", near.endpoint.state())
        };
        assert!((0.25..0.4).contains(&for_s), "{for_s}");
        assert!(time.until(&mut [&mut far, &mut near], are_open).expect("open again") < 0.1);
        assert_eq!(near.endpoint.handshake_datagrams(), before);
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn a_side_that_was_started_anew_is_back_within_a_second() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, mut near, theirs, ours) = pair();
        let address = far.endpoint.address().unwrap();
        // A killed console sends no goodbye.
        let mut anew = End::new(console(&ours, theirs.public(), address));
        let back_s = time.until(&mut [&mut far, &mut anew], are_open).expect("the same console");
        println!("console restarted: open after {back_s:.3} s");
        assert!(back_s < 0.5, "{back_s}");
        time.run(&mut [&mut far, &mut anew], 0.3);
        assert!(anew.got.len() > 50 && far.endpoint.peer() == Some(ours.public()));
        near.endpoint.active = None;
        drop(far);
        let mut far = End::new(follower(&theirs, &[&ours], address));
        let back_s = time.until(&mut [&mut far, &mut anew], are_open).expect("the same follower");
        println!("follower restarted: open after {back_s:.2} s");
        assert!(back_s < 1.0, "{back_s}");
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn one_console_holds_and_another_gets_control_only_by_consent() {
    let _alone = alone();
    judged(|| {
        let theirs = keys();
        let first = keys();
        let second = keys();
        let mut far = End::new(follower(&theirs, &[&first, &second], HOME.into()));
        let address = far.endpoint.address().unwrap();
        let mut holder = End::new(console(&first, theirs.public(), address));
        let time = Time::start();
        time.until(&mut [&mut far, &mut holder], are_open).expect("the first holds it");
        let mut other = End::new(console(&second, theirs.public(), address));
        let all = |control: [ControlRole; 2]| {
            move |ends: &[&mut End]| [ends[1].endpoint.control(), ends[2].endpoint.control()] == control
        };
        let mut ends = [&mut far, &mut holder, &mut other];
        time.until(&mut ends, all([ControlRole::Holds, ControlRole::Waits])).expect("the second is informed");
        assert_eq!(ends[2].endpoint.state(), LinkState::Down(LinkCause::HeldByAnother));
        assert_eq!(ends[2].endpoint.send(time.now_s(), b"?"), SendOutcome::NotOpen);
        for _ in 0..2 {
            ends[2].endpoint.ask_for_control();
            time.until(&mut ends, all([ControlRole::HoldsAsked, ControlRole::Asks]))
                .expect("the first gets the request for control");
            ends[1].endpoint.answer(false);
            time.until(&mut ends, all([ControlRole::Holds, ControlRole::Denied])).expect("it refuses");
        }
        assert_eq!(ends[0].endpoint.peer(), Some(first.public()));
        ends[2].endpoint.ask_for_control();
        time.until(&mut ends, all([ControlRole::HoldsAsked, ControlRole::Asks])).expect("asked again");
        ends[1].endpoint.answer(true);
        time.until(&mut ends, all([ControlRole::Waits, ControlRole::Holds])).expect("it consents");
        assert_eq!(ends[0].endpoint.peer(), Some(second.public()));
        let before = ends[2].got.len();
        time.run(&mut ends, 0.4);
        assert!(ends[2].got.len() > before + 50, "payloads go to the new holder");
        assert!(ends[0].got.windows(2).filter(|pair| pair[1] < pair[0]).count() <= 1, "one change of streams");
        // The controlling console leaves: no other console takes control by itself.
        ends[2].endpoint.close();
        drop(other);
        let mut ends = [&mut far, &mut holder];
        let free = |ends: &[&mut End]| ends[1].endpoint.state() == LinkState::Down(LinkCause::NotAsked);
        time.until(&mut ends, free).expect("told that it is free");
        ends[1].endpoint.ask_for_control();
        time.until(&mut ends, are_open).expect("no consent is needed");
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn a_stranger_and_another_version_are_refused() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, mut near, theirs, _) = pair();
        let address = far.endpoint.address().unwrap();
        let mut stranger = End::new(console(&keys(), theirs.public(), address));
        let refused =
            |ends: &[&mut End]| ends[2].endpoint.state() == LinkState::Down(LinkCause::Refused(SessionRefusal::Key));
        time.until(&mut [&mut far, &mut near, &mut stranger], refused).expect("told why");
        // A datagram of another version gets a response that says so.
        let socket = UdpSocket::bind(HOME).unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
        let mut hello = [0; HELLO_LEN];
        hello[..wire::HANDSHAKE_LEN].copy_from_slice(&wire::handshake(DatagramKind::Hello, 5));
        hello[0] = VERSION + 1;
        socket.send_to(&hello, address).unwrap();
        time.run(&mut [&mut far, &mut near], 0.1);
        let mut answer = [0; 100];
        let len = socket.recv(&mut answer).unwrap();
        assert_eq!(
            (wire::kind(&answer[..len]), &answer[wire::HANDSHAKE_LEN..len]),
            (Ok(DatagramKind::Refusal), &[1, VERSION][..])
        );
        let dropped = far.endpoint.dropped();
        assert!(dropped.foreign_version == 1 && dropped.refused > 0, "{dropped:?}");
        assert!(are_open(&[&mut far, &mut near]));
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn a_clock_that_jumps_is_named() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, mut near, ..) = pair();
        time.run(&mut [&mut far, &mut near], 2.0);
        near.ahead_s += 0.05;
        let named = |ends: &[&mut End]| {
            ends.iter().all(|end| matches!(end.endpoint.state(), LinkState::Down(LinkCause::ClockJumped { .. })))
        };
        let after_s = time.until(&mut [&mut far, &mut near], named).expect("named by both");
        assert!(after_s < 1.0, "{after_s}");
        let LinkState::Down(LinkCause::ClockJumped { by_s }) = near.endpoint.state() else { panic!() };
        assert!((by_s + 0.05).abs() < 2e-3, "their clock minus ours: {by_s}");
        time.until(&mut [&mut far, &mut near], are_open).expect("and then all is well");
    });
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn a_relay_makes_the_line_bad_and_repeated_datagrams_are_dropped() {
    let _alone = alone();
    judged(|| {
        let theirs = keys();
        let ours = keys();
        let mut far = End::new(follower(&theirs, &[&ours], HOME.into()));
        let to = far.endpoint.address().unwrap();
        let line = ImpairmentSettings {
            delay_s: 0.02,
            loss: LossModel::Independent { fraction: 0.05 },
            duplicate: 0.2,
            ..ImpairmentSettings::default()
        };
        let there = ImpairmentSettings { delay_s: 0.03, ..line };
        let relay = Relay::start(RelaySettings { at: HOME.into(), to, there, back: line, seed: 3 }).unwrap();
        let mut near = End::new(console(&ours, theirs.public(), relay.address()));
        let time = Time::start();
        let mut ends = [&mut far, &mut near];
        let after_s = time.until(&mut ends, are_open).expect("through the relay");
        assert!(after_s > 0.1, "two round trips of 50 ms: {after_s}");
        time.run(&mut ends, 2.5);
        for end in ends {
            let figures = end.endpoint.figures();
            let round_trip_s = figures.clock.unwrap().round_trip_s;
            assert!((0.05..0.056).contains(&round_trip_s), "{round_trip_s}");
            assert!((0.02..0.12).contains(&figures.loss), "{}", figures.loss);
            assert!(end.endpoint.dropped().replayed > 100, "{:?}", end.endpoint.dropped());
            assert!(end.got.windows(2).all(|pair| pair[0] < pair[1]), "each once, in order");
            assert!(figures.counts.lost * 100 < figures.counts.delivered, "{:?}", figures.counts);
        }
        let totals = relay.totals();
        assert!(totals.there > 1500 && totals.there_lost * 8 < totals.there && totals.there_lost > 20, "{totals:?}");
    });
}

#[path = "flood_tests.rs"]
mod flood_tests;
#[path = "same_key_tests.rs"]
mod same_key_tests;
