//! Tests of a foot pedal over its emulated interface.

use super::*;

#[test]
fn both_kinds_of_pedal_tell_presses_and_releases_in_time() {
    judged(|| {
        for model in [PedalModel::Keyboard, PedalModel::Switches] {
            let (serving, foot) = pedal(model);
            let settings = PedalSettings { presence: Some(1), ..pedal_settings(&serving) };
            let mut driver = PedalDriver::open(&settings).unwrap();
            let roles = driver.roles();
            std::thread::sleep(Duration::from_millis(30));
            for pressed in [0b01, 0b11, 0b10, 0b100, 0] {
                foot.store(pressed, Ordering::Release);
                let report = |_: &mut PedalDriver, reading: Option<TimedReading<PedalReading>>| {
                    reading.is_some_and(|reading| {
                        let PedalReading { pressed: got } = reading.value;
                        assert_eq!(roles.clutch(reading.value), got & 1 == 1);
                        assert_eq!(roles.presence(reading.value), Some(got & 2 == 2));
                        got == pressed
                    })
                };
                assert!(until(&mut driver, report).is_some(), "{model:?}: {pressed:#b}");
            }
            assert_eq!(driver.health().damaged + driver.health().refused + driver.health().lost, 0);
        }
    });
}

#[test]
fn a_pressed_pedal_that_is_unplugged_or_broken_is_released_and_stays_so_until_it_speaks_again() {
    judged(|| {
        for (fault, loss) in [
            (EmulatedFault::Disconnect, Loss::Disconnected),
            (EmulatedFault::WrongFrame, Loss::Corrupt),
            (EmulatedFault::NotANumber, Loss::Implausible),
        ] {
            let (serving, foot) = pedal(PedalModel::Keyboard);
            let settings = pedal_settings(&serving);
            let mut slot = DeviceSlot::start("pedal", move || PedalDriver::open(&settings)).unwrap();
            let begin = Instant::now();
            let mut held = HeldValue::<PedalReading>::default();
            assert!(until_slot(&mut slot, begin, |health, _| health.standing == ConnectionState::Connected));
            foot.store(1, Ordering::Release);
            assert!(until_slot(&mut slot, begin, |health, reading| held.update(reading, health).pressed == 1));
            serving.faults.set(fault);
            let mut lost = false;
            assert!(
                until_slot(&mut slot, begin, |health, reading| {
                    lost |= health.standing == ConnectionState::Lost(loss);
                    lost && held.update(reading, health).pressed == 0
                }),
                "{fault:?}: {:?}",
                slot.health()
            );
            serving.faults.set(EmulatedFault::None);
            assert!(until_slot(&mut slot, begin, |health, reading| {
                assert_eq!(held.update(reading, health).pressed, 0, "it must be pressed again");
                health.standing == ConnectionState::Connected
            }));
            foot.store(0, Ordering::Release);
            std::thread::sleep(Duration::from_millis(30));
            foot.store(1, Ordering::Release);
            assert!(
                until_slot(&mut slot, begin, |health, reading| held.update(reading, health).pressed == 1),
                "{fault:?}"
            );
        }
    });
}

#[test]
fn one_report_that_is_not_understood_releases_everything_at_once() {
    judged(|| {
        let [here, mut there] = MemoryDatagrams::pair();
        let identity = HidIdentity { vendor: 0x05f3, product: 0x00ff, ..HidIdentity::default() };
        let mut driver = PedalDriver::over(Box::new(here), &identity, &PedalSettings::default()).unwrap();
        there.send(&[1, 0]).unwrap();
        assert_eq!(driver.poll(0.0).unwrap().value.pressed, 1);
        assert!(driver.poll(0.1).is_none(), "a foot that does not move says nothing");
        there.send(&[0xf1, 0]).unwrap();
        assert_eq!(driver.poll(0.2).unwrap().value.pressed, 0);
        assert_eq!((driver.health().refused, driver.health().standing), (1, ConnectionState::Connected));
        there.send(&[1, 0]).unwrap();
        assert_eq!(driver.poll(0.3).unwrap().value.pressed, 1);
        there.cut();
        assert_eq!(driver.poll(0.4).unwrap().value.pressed, 0, "gone is released");
        assert!(driver.poll(0.5).is_none());
        assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Disconnected));
    });
}

#[test]
fn a_pedal_with_other_reports_has_its_switches_where_the_rig_file_says() {
    let settings: PedalSettings =
        toml::from_str("source = \"1234:abcd\"\nbits = [[1, 0], [0, 4]]\npresence = 1").unwrap();
    let [here, mut there] = MemoryDatagrams::pair();
    let identity = HidIdentity { vendor: 0x1234, product: 0xabcd, ..HidIdentity::default() };
    let mut driver = PedalDriver::over(Box::new(here), &identity, &settings).unwrap();
    let roles = driver.roles();
    for (report, clutch, present) in [
        ([0x00, 0x01, 0xff], true, false),
        ([0x10, 0x00, 0xff], false, true),
        ([0xef, 0xfe, 0x00], false, false),
        ([0x10, 0x01, 0x00], true, true),
    ] {
        there.send(&report).unwrap();
        let reading = driver.poll(0.0).unwrap().value;
        assert_eq!((roles.clutch(reading), roles.presence(reading)), (clutch, Some(present)), "{report:?}");
    }
    there.send(&[0x10]).unwrap();
    assert_eq!(driver.poll(0.1).unwrap().value.pressed, 0, "a report without the byte of a switch releases all");
    assert_eq!((driver.health().damaged, driver.health().standing), (1, ConnectionState::Connected));
    for bits in [vec![[8, 0]], vec![[0, 8]], vec![[0, 0]; 9]] {
        let refused = PedalSettings { bits, ..PedalSettings::default() }.check().unwrap_err().to_string();
        assert!(refused.contains("bits = [[") && refused.contains("at most eight pairs"), "{refused}");
    }
}

#[test]
fn any_device_is_a_pedal_once_the_rig_file_places_its_switches() {
    judged(|| {
        let (serving, foot) = pedal(PedalModel::Switches);
        // The pedal's own places, in another order.
        let settings = PedalSettings { bits: vec![[0, 2], [0, 0]], ..pedal_settings(&serving) };
        let mut driver = PedalDriver::open(&settings).unwrap();
        std::thread::sleep(Duration::from_millis(30));
        for (pressed, expected) in [(0b001, 0b10), (0b100, 0b01), (0b010, 0), (0b101, 0b11)] {
            foot.store(pressed, Ordering::Release);
            let is_expected = |_: &mut PedalDriver, reading: Option<TimedReading<PedalReading>>| {
                reading.is_some_and(|reading| reading.value.pressed == expected)
            };
            assert!(until(&mut driver, is_expected).is_some(), "{pressed:#b}");
        }
        let cap = still_cap(CapModel::Split);
        let unknown = PedalSettings { source: cap.endpoint.clone(), ..PedalSettings::default() };
        let refused = PedalDriver::open(&unknown).err().unwrap();
        assert!(
            matches!(&refused, DeviceError::WrongProduct { found, .. } if found.contains("046d:c626")),
            "{refused}"
        );
        assert!(PedalDriver::open(&PedalSettings { bits: vec![[0, 0]], ..unknown }).is_ok());
    });
}
