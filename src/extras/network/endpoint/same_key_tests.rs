use nima_testing::unjudged;

use super::*;

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn a_second_console_with_the_same_key_does_not_take_a_follower_in_use() {
    let _alone = alone();
    judged(|| {
        let (time, mut far, mut near, theirs, ours) = pair();
        let address = far.endpoint.address().unwrap();
        time.run(&mut [&mut far, &mut near], 0.3);
        let mut copy = End::new(console(&ours, theirs.public(), address));
        let mut ends = [&mut far, &mut near, &mut copy];
        let waits = |ends: &[&mut End]| ends[2].endpoint.control() == ControlRole::Waits;
        time.until(&mut ends, waits).expect("it is admitted, and waits");
        let before = ends[1].got.len();
        time.run(&mut ends, 1.0);
        assert!(ends[1].got.len() > before + 500, "the first one continues");
        assert_eq!((ends[1].endpoint.control(), ends[1].endpoint.state()), (ControlRole::Holds, LinkState::Open));
        assert!(waits(&ends) && ends[2].got.is_empty());
        // It may ask for control, like any other console.
        ends[2].endpoint.ask_for_control();
        let asked = |ends: &[&mut End]| ends[1].endpoint.control() == ControlRole::HoldsAsked;
        time.until(&mut ends, asked).expect("the first one decides");
        drop(near);
        time.until(&mut [&mut far, &mut copy], are_open).expect("it is free now");
    });
}

#[test]
fn a_follower_listens_on_loopback_unless_told_otherwise() {
    let _alone = alone();
    let role = EndpointRole::Follower { at: None, consoles: Peers::default() };
    let Ok(endpoint) = Endpoint::open(EndpointConfig::new(role.clone(), keys())) else {
        unjudged::left_out("another program uses the port of the follower");
        return;
    };
    assert_eq!(endpoint.address().unwrap(), (Ipv4Addr::LOCALHOST, PORT).into());
    let taken = Endpoint::open(EndpointConfig::new(role, keys())).unwrap_err();
    assert!(taken.to_string().contains("127.0.0.1:47150"), "{taken}");
    assert_eq!(endpoint.state(), LinkState::Waiting);
}
