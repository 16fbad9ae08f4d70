use proptest::prelude::*;

use crate::{
    CapReading,
    hid::{
        HidIdentity, HidSource, PedalSettings,
        cap_codec::{self, BadReport, CapReport, CapState, POSSIBLE, RELEASE_AFTER_S, counts_of, light},
        pedal_codec::{self, PedalLayout},
        spacenavd::{EVENT_LENGTH, SpacenavdEvent},
    },
};

const BITS: PedalLayout =
    PedalLayout::Bits { places: [Some([1, 0]), Some([0, 4]), Some([7, 7]), None, None, None, None, None] };
const KEYBOARD: PedalLayout = PedalLayout::Keyboard { keys: [5, 4, 6, 0, 0, 0, 0, 0] };

fn near(got: f64, expected: f64) -> bool {
    (got - expected).abs() < 1e-3
}

#[test]
fn a_switch_that_the_pedal_does_not_have_is_refused() {
    let pedal =
        |clutch, presence| PedalSettings { bits: vec![[0, 0], [0, 1]], clutch, presence, ..PedalSettings::default() };
    assert!(pedal(1, Some(0)).roles().is_ok());
    for (refused, key) in [(pedal(2, None), "clutch = 2"), (pedal(0, Some(5)), "presence = 5")] {
        let words = refused.roles().unwrap_err().to_string();
        assert!(words.contains(key) && words.contains("from 0 to 1"), "{words}");
    }
}

#[test]
fn the_golden_reports_of_a_split_cap_give_the_values_of_the_reference() {
    let mut state = CapState::default();
    for bytes in
        [&[0x01, 0x64, 0x00, 0x38, 0xff, 0x5e, 0x01][..], &[0x02, 0xa2, 0xfe, 0x32, 0x00, 0xe7, 0xff], &[3, 3, 0]]
    {
        assert!(state.take(&CapReport::decode(bytes).unwrap(), 0.0));
    }
    let CapReading { translation, rotation, buttons } = state.reading();
    // pyspacemouse gives x .2857, y .5714, z -1 and, in its old names, pitch 1 = -Rx, roll -.1429 = -Ry, yaw -.0714 = Rz.
    assert!(near(translation.x, 0.2857) && near(translation.y, 0.5714) && near(translation.z, -1.0));
    assert!(near(rotation.x, -1.0) && near(rotation.y, -0.1429) && near(rotation.z, 0.0714));
    assert_eq!(buttons, 0b11);
}

#[test]
fn a_combined_report_says_the_same_as_the_two_halves() {
    let counts = [100, -200, 350, -350, 50, -25];
    let mut buffer = [0; cap_codec::LENGTH_MAX];
    assert_eq!(CapReport::Motion(counts).encode(&mut buffer), 13);
    assert_eq!(buffer, [1, 0x64, 0, 0x38, 0xff, 0x5e, 0x01, 0xa2, 0xfe, 0x32, 0, 0xe7, 0xff]);
    let mut one = CapState::default();
    let mut two = CapState::default();
    one.take(&CapReport::decode(&buffer).unwrap(), 0.0);
    two.take(&CapReport::Translation([100, -200, 350]), 0.0);
    two.take(&CapReport::Rotation([-350, 50, -25]), 0.0);
    assert_eq!(one.reading(), two.reading());
    assert_eq!(counts_of(&one.reading()), counts);
}

#[test]
fn buttons_in_every_byte_are_seen_and_other_reports_are_let_pass() {
    // Bits of the SpaceMouse Pro's report (byte.bit): MENU 1.0, ESC 3.6, CTRL 4.1.
    assert_eq!(CapReport::decode(&[3, 0x01, 0, 0x40, 0x02]), Ok(CapReport::Buttons(1 | 1 << 22 | 1 << 25)));
    assert_eq!(CapReport::decode(&[0x17, 88, 1]), Ok(CapReport::Battery { percent: 88, charging: true }));
    assert_eq!(CapReport::decode(&[0x1c, 1, 2, 3]), Ok(CapReport::Other));
    assert_eq!((light(true), light(false)), ([4, 1], [4, 0]));
}

#[test]
fn what_is_no_report_is_refused() {
    for bad in [&[][..], &[1], &[1, 0, 0, 0, 0], &[2; 13], &[1; 9], &[3], &[0x17]] {
        assert_eq!(CapReport::decode(bad), Err(BadReport::Shape), "{bad:?}");
    }
    assert_eq!(CapReport::decode(&[1, 0xff, 0x7f, 0, 0, 0, 0]), Err(BadReport::Content));
    assert_eq!(
        CapReport::decode(&[1, 0x00, 0x80, 0, 0, 0, 0]),
        Err(BadReport::Content),
        "the lowest number has no opposite"
    );
    assert_eq!(CapReport::decode(&[0x17, 200, 0]), Err(BadReport::Content));
}

#[test]
fn a_half_that_is_not_renewed_lets_go_by_itself() {
    let mut state = CapState::default();
    state.take(&CapReport::Translation([350, 0, 0]), 0.0);
    state.take(&CapReport::Rotation([0, 350, 0]), 0.05);
    assert_eq!(state.release_stale(RELEASE_AFTER_S), 0);
    assert_eq!(state.release_stale(RELEASE_AFTER_S + 1e-6), 1);
    assert!(state.reading().translation.x.abs() < 1e-12);
    assert!(near(state.reading().rotation.y, -1.0));
    assert_eq!(state.release_stale(0.2), 1);
    assert_eq!(state.reading(), CapReading::default());
    assert_eq!(state.release_stale(9.0), 0, "what is let go is not let go again");
}

#[test]
fn pedals_give_their_switches_by_the_reference() {
    assert_eq!(KEYBOARD.decode(&[0, 0, 5, 0, 0, 0, 0, 0]), Ok(1));
    assert_eq!(KEYBOARD.decode(&[2, 0, 4, 6, 0, 0, 0, 0]), Ok(0b110));
    assert_eq!(KEYBOARD.decode(&[0; 8]), Ok(0));
    assert_eq!(KEYBOARD.decode(&[0, 0, 0x29, 0, 0, 0, 0, 0]), Ok(0), "another key presses nothing");
    assert_eq!(KEYBOARD.decode(&[0, 0, 1, 1, 1, 1, 1, 1]), Err(BadReport::Content));
    assert_eq!(KEYBOARD.decode(&[0, 0, 5]), Err(BadReport::Shape));
    assert_eq!(KEYBOARD.decode(&[0, 1, 5, 0, 0, 0, 0, 0]), Err(BadReport::Shape));
    for bits in 0..8 {
        assert_eq!(PedalLayout::Switches.decode(&[bits, 0]), Ok(u32::from(bits)));
    }
    assert_eq!(PedalLayout::Switches.decode(&[8, 0]), Err(BadReport::Content));
    assert_eq!(PedalLayout::Switches.decode(&[1]), Err(BadReport::Shape));
}

#[test]
fn the_daemons_axes_are_turned_into_ours() {
    let mut state = CapState::default();
    SpacenavdEvent::decode(&SpacenavdEvent::Motion([35, 70, 105, 140, 175, 210]).encode(8))
        .unwrap()
        .apply(&mut state, 0.0);
    SpacenavdEvent::Button { number: 1, pressed: true }.apply(&mut state, 0.0);
    SpacenavdEvent::Button { number: 99, pressed: true }.apply(&mut state, 0.0);
    let CapReading { translation, rotation, buttons } = state.reading();
    assert!(near(translation.x, 0.1) && near(translation.y, 0.3) && near(translation.z, 0.2));
    assert!(near(rotation.x, 0.4) && near(rotation.y, 0.6) && near(rotation.z, 0.5));
    assert_eq!(buttons, 2);
    assert_eq!(SpacenavdEvent::decode(&[0; 31]), Err(BadReport::Shape));
    assert_eq!(SpacenavdEvent::decode(&[7; EVENT_LENGTH]), Err(BadReport::Shape));
}

#[test]
fn sources_read_back_as_they_are_written() {
    for text in ["any", "046d:c626", "256f:c635:SN:1", "/dev/hidraw0", "emulated:/tmp/a.sock", "spacenavd:/run/s"] {
        assert_eq!(text.parse::<HidSource>().unwrap().to_string(), text);
    }
    assert!(matches!("spacenavd".parse(), Ok(HidSource::Spacenavd(_))));
    for text in ["", "emulated:", "046d", "46d:c626", "046d:c62g", "hidraw0"] {
        let trouble = text.parse::<HidSource>().unwrap_err();
        assert!(trouble.to_string().contains("source") && trouble.cure().contains("VENDOR:PRODUCT"), "{trouble}");
    }
}

#[test]
fn the_greeting_of_an_emulator_reads_back_and_noise_does_not() {
    for serial in ["", "A1"] {
        let identity = HidIdentity {
            vendor: 0x046d,
            product: 0xc626,
            serial: serial.to_owned(),
            name: "Space Navigator".to_owned(),
        };
        assert_eq!(HidIdentity::of_hello(identity.hello().as_bytes()), Some(identity));
    }
    for noise in [&b""[..], b"nima-hid", b"nima-hid 12 - x", b"nima-hid zz:zz - x", b"\xff\xff"] {
        assert_eq!(HidIdentity::of_hello(noise), None);
    }
}

proptest! {
    #[test]
    fn every_cap_report_comes_back(
        counts in prop::array::uniform6(-POSSIBLE.cast_signed()..=POSSIBLE.cast_signed()), bits: u32, percent in 0_u8..=100, charging: bool,
    ) {
        let [x, y, z, rx, ry, rz] = counts;
        for report in [
            CapReport::Translation([x, y, z]),
            CapReport::Rotation([rx, ry, rz]),
            CapReport::Motion(counts),
            CapReport::Buttons(bits),
            CapReport::Battery { percent, charging },
        ] {
            let mut buffer = [0; cap_codec::LENGTH_MAX];
            let length = report.encode(&mut buffer);
            prop_assert_eq!(CapReport::decode(&buffer[..length]), Ok(report));
        }
        let event = SpacenavdEvent::Motion(counts.map(i32::from));
        prop_assert_eq!(SpacenavdEvent::decode(&event.encode(3)), Ok(event));
        let event = SpacenavdEvent::Button { number: bits >> 1, pressed: charging };
        prop_assert_eq!(SpacenavdEvent::decode(&event.encode(0)), Ok(event));
    }

    #[test]
    fn every_pedal_report_comes_back(pressed in 0_u32..8) {
        for layout in [KEYBOARD, PedalLayout::Switches, BITS] {
            let mut buffer = [0; pedal_codec::LENGTH_MAX];
            let length = layout.encode(pressed, &mut buffer);
            prop_assert_eq!(layout.decode(&buffer[..length]), Ok(pressed));
        }
    }
}

/// Feeds random and mutated reports to every codec: readings stay within -1 to 1, switches within their number, and
/// nothing panics.
fn fuzz(rounds: u64, seed: u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut state = CapState::default();
    let good: [&[u8]; 6] = [
        &[1, 0x64, 0, 0x38, 0xff, 0x5e, 1],
        &[2, 0xa2, 0xfe, 0x32, 0, 0xe7, 0xff],
        &[1, 0x64, 0, 0x38, 0xff, 0x5e, 1, 0xa2, 0xfe, 0x32, 0, 0xe7, 0xff],
        &[3, 3, 0],
        &[0, 0, 5, 0, 0, 0, 0, 0],
        &[0; EVENT_LENGTH],
    ];
    let mut buffer = [0_u8; 65];
    let mut taken = 0_u64;
    for round in 0..rounds {
        let length = if random.bool() {
            let seed = good[random.usize(..good.len())];
            buffer[..seed.len()].copy_from_slice(seed);
            for _ in 0..random.usize(..3) {
                buffer[random.usize(..seed.len())] = random.u8(..);
            }
            if random.u8(..) < 64 { random.usize(..=seed.len()) } else { seed.len() }
        } else {
            let length = random.usize(..buffer.len());
            random.fill(&mut buffer[..length]);
            buffer[0] = random.u8(..5);
            length
        };
        let bytes = &buffer[..length];
        let now_s = round as f64 * 1e-3;
        if let Ok(report) = CapReport::decode(bytes) {
            taken += u64::from(state.take(&report, now_s));
        }
        if let Ok(event) = SpacenavdEvent::decode(bytes) {
            event.apply(&mut state, now_s);
            taken += 1;
        }
        for layout in [KEYBOARD, PedalLayout::Switches, BITS] {
            if let Ok(pressed) = layout.decode(bytes) {
                assert!(pressed < 8);
                taken += 1;
            }
        }
        state.release_stale(now_s);
        let CapReading { translation, rotation, .. } = state.reading();
        assert!(translation.iter().chain(rotation.iter()).all(|axis| (-1.0..=1.0).contains(axis)), "{bytes:?}");
    }
    assert!(taken > rounds / 20, "{taken} of {rounds} were taken: the noise never gets far");
}

#[test]
fn noise_of_a_hundred_thousand_reports_is_survived() {
    fuzz(200_000, 0x00f1_77e5);
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_reports() {
    nima_testing::fuzz::rounds(|seed| fuzz(1_000_000, seed));
}

#[test]
fn a_pedal_with_other_reports_is_read_at_the_places_in_the_rig_file() {
    assert_eq!(BITS.decode(&[0x10, 0, 0, 0, 0, 0, 0, 0]), Ok(0b010));
    assert_eq!(BITS.decode(&[0xEF, 0xFF, 0, 0, 0, 0, 0, 0x80, 9]), Ok(0b101));
    assert_eq!(BITS.decode(&[0x10, 0, 0]), Err(BadReport::Shape));
}
