//! Both ends of a link between two machines allocate nothing once their session is open: neither while payloads pass,
//! nor while unknown programs send datagrams, another console comes and goes, or the other side is silent.

use std::{
    net::{Ipv4Addr, SocketAddr, UdpSocket},
    thread::{scope, sleep},
    time::{Duration, Instant},
};

use nima_network::{
    endpoint::{Endpoint, EndpointConfig, EndpointRole, LinkState},
    keys::{NetworkKeys, Peers, PublicKey},
};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

const TICK: Duration = Duration::from_millis(1);

fn console(keys: &NetworkKeys, follower: SocketAddr, key: PublicKey) -> Endpoint {
    Endpoint::open(EndpointConfig::new(EndpointRole::Console { follower, key }, keys.clone())).unwrap()
}

/// Runs one tick: takes the due payloads and sends one.
fn tick(end: &mut Endpoint, now_s: f64) -> usize {
    let mut received = end.poll(now_s);
    let mut got = 0;
    while received.next_due().is_some() {
        got += 1;
    }
    end.send(now_s, &[1; 40]);
    got
}

#[test]
fn a_tick_of_an_open_link_allocates_nothing() {
    let _alone = alone();
    judged(|| {
        let [theirs, ours, others] = [0; 3].map(|_| NetworkKeys::random().unwrap());
        let mut consoles = Peers::default();
        consoles.add("first", ours.public()).unwrap();
        consoles.add("second", others.public()).unwrap();
        let at = Some((Ipv4Addr::LOCALHOST, 0).into());
        let mut far =
            Endpoint::open(EndpointConfig::new(EndpointRole::Follower { at, consoles }, theirs.clone())).unwrap();
        let address = far.address().unwrap();
        let mut near = console(&ours, address, theirs.public());
        let begin = Instant::now();
        let now_s = || begin.elapsed().as_secs_f64();
        while near.state() != LinkState::Open || far.state() != LinkState::Open {
            assert!(now_s() < 10.0, "{:?} {:?}", near.state(), far.state());
            tick(&mut near, now_s());
            tick(&mut far, now_s());
            sleep(TICK);
        }
        scope(|scope| {
            // Another console connects and disconnects; unknown programs send foreign datagrams.
            scope.spawn(|| {
                let mut other = console(&others, address, theirs.public());
                let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
                for _ in 0..300 {
                    other.poll(now_s());
                    other.ask_for_control();
                    socket.send_to(b"GET / HTTP/1.1", address).ok();
                    sleep(2 * TICK);
                }
            });
            let before = calls();
            let mut got = 0;
            for count in 0..1500 {
                got += tick(&mut near, now_s());
                // The console stops sending for a quarter of a second.
                if !(1000..1250).contains(&count) {
                    got += tick(&mut far, now_s());
                }
                near.figures();
                near.answer(false);
                sleep(TICK);
            }
            assert_eq!(calls() - before, 0);
            assert!(got > 1500, "{got} payloads");
            assert!(far.dropped().malformed > 100, "{:?}", far.dropped());
        });
    });
}
