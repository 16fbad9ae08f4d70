//! Floods of a follower's port, which any computer can reach.

use super::*;

#[test]
fn a_link_that_a_flood_displaces_is_not_called_silent() {
    let _alone = alone();
    let (time, mut far, mut near, ..) = pair();
    let address = far.endpoint.address().unwrap();
    let others = UdpSocket::bind(HOME).unwrap();
    let begin_s = time.now_s();
    // Steps of 10 ms on the clocks of both ends. The follower's socket is soon full whenever its console sends; what was in
    // it before is read within 0.3 s.
    for step in 1..50 {
        for _ in 0..400 {
            // Smaller than any datagram of the console, which therefore finds no room either.
            others.send_to(&[0x5a; 8], address).ok();
        }
        let now_s = begin_s + f64::from(step) * 0.01;
        near.tick(now_s);
        far.tick(now_s);
    }
    assert_eq!(far.endpoint.state(), LinkState::Down(LinkCause::Flooded), "{:?}", far.endpoint.dropped());
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn a_flood_of_handshakes_and_noise_does_not_stop_the_stream() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, mut near, ..) = pair();
        let address = far.endpoint.address().unwrap();
        let number = far.endpoint.session().map(|session| session.ours).unwrap();
        let ends = AtomicBool::new(false);
        let sent = scope(|scope| {
            let flood = scope.spawn(|| {
                let sockets: Vec<UdpSocket> = (0..16).map(|_| UdpSocket::bind(HOME).unwrap()).collect();
                let mut rng = fastrand::Rng::with_seed(1);
                let mut sent = 0_u64;
                while !ends.load(Relaxed) {
                    // 20 000 per second.
                    for _ in 0..20 {
                        let mut datagram = [0; HELLO_LEN];
                        let kind = if rng.bool() { DatagramKind::Hello } else { DatagramKind::Initiation };
                        datagram[..wire::HANDSHAKE_LEN].copy_from_slice(&wire::handshake(kind, rng.u64(..)));
                        // Some look like datagrams of a session, and some of these like the open one.
                        if rng.u32(..4) == 0 {
                            let session = if rng.u32(..8) == 0 { number } else { rng.u32(..) };
                            datagram[..wire::OUTER_LEN].copy_from_slice(&wire::outer(session, rng.u64(..)));
                        }
                        sent += u64::from(sockets[rng.usize(..16)].send_to(&datagram, address).is_ok());
                    }
                    sleep(TICK);
                }
                sent
            });
            time.run(&mut [&mut far, &mut near], 1.5);
            ends.store(true, Relaxed);
            flood.join().unwrap()
        });
        time.run(&mut [&mut far, &mut near], 0.2);
        assert!(are_open(&[&mut far, &mut near]));
        let dropped = far.endpoint.dropped();
        let figures = far.endpoint.figures();
        assert!(
            dropped.flooded + dropped.refused > sent / 4 && dropped.unknown_session > sent / 8,
            "{dropped:?} of {sent}"
        );
        assert!(dropped.forged > 100, "{dropped:?}");
        assert!(figures.counts.lost < 20 && figures.counts.delivered > 800, "{:?}", figures.counts);
        assert_eq!(far.endpoint.sessions.iter().flatten().count(), 1, "no state");
    });
}
