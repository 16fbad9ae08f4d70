//! Reports of caps and pedals, and events of spacenavd.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_devices::hid::{
    cap_codec::{CapReport, CapState},
    pedal_codec::PedalLayout,
    spacenavd::SpacenavdEvent,
};

fuzz_target!(|bytes: &[u8]| {
    let mut state = CapState::default();
    if let Ok(report) = CapReport::decode(bytes) {
        state.take(&report, 0.0);
    }
    if let Ok(event) = SpacenavdEvent::decode(bytes) {
        event.apply(&mut state, 1e-3);
    }
    let reading = state.reading();
    assert!(reading.translation.iter().chain(reading.rotation.iter()).all(|axis| (-1.0..=1.0).contains(axis)));
    for layout in [PedalLayout::Keyboard { keys: [5, 4, 6, 0, 0, 0, 0, 0] }, PedalLayout::Switches] {
        assert!(layout.decode(bytes).is_ok_and(|pressed| pressed < 8) || layout.decode(bytes).is_err());
    }
});
