//! Emulated servos: their rules, their motion, and the driver's commands.

use nima_devices::{
    ConnectionState, Device as _, Loss,
    dynamixel::{
        DynamixelDriver, GoalResult, HardwareError, WaitClock as _,
        codec::{BROADCAST, IncomingPackets, OutgoingPackets},
        message::{Instruction as I, Keep},
    },
    transport::MemoryBytes,
};

use super::{
    super::{Bus, EmulatedDynamixel, ServoSurroundings},
    world::{Fixture, emulated, settings},
};
use crate::emulators::EmulatedFault;

/// A client without a driver.
struct Client {
    emulator: Bus,
    now_s: f64,
}

impl Client {
    fn new() -> Self {
        let still = |_: f64, _: usize, _: &_| ServoSurroundings { load_nm: 0.0, supply_v: 12.0, temperature_c: 30.0 };
        let settings = EmulatedDynamixel { ids: vec![1, 2], ..EmulatedDynamixel::default() };
        Self { emulator: Bus::new(&settings, Some(Box::new(still))).unwrap(), now_s: 0.0 }
    }

    /// Returns all packets received within 10 ms: id, error, parameters.
    fn ask(&mut self, id: u8, instruction: &I<'_>) -> Vec<(u8, u8, Vec<u8>)> {
        let mut out = OutgoingPackets::new(512);
        instruction.encode(id, &mut out);
        self.emulator.receive(self.now_s, out.bytes());
        self.wait(0.010)
    }

    fn wait(&mut self, length_s: f64) -> Vec<(u8, u8, Vec<u8>)> {
        let mut incoming = IncomingPackets::new(512);
        let mut answers = Vec::new();
        for _ in 0..(length_s * 1e3).round() as usize {
            self.now_s += 1e-3;
            self.emulator.send(self.now_s, EmulatedFault::None, &mut |bytes| {
                incoming.feed(bytes);
                while let Some(packet) = incoming.next() {
                    answers.push((packet.id, packet.body[0], packet.body[1..].to_vec()));
                }
            });
        }
        answers
    }

    fn write(&mut self, address: u16, data: &[u8]) -> u8 {
        self.ask(1, &I::Write { address, data })[0].1
    }

    fn read(&mut self, address: u16, count: u16) -> i32 {
        let answers = self.ask(1, &I::Read { address, count });
        assert_eq!(answers[0].1 & 0x7F, 0);
        let mut bytes = [if answers[0].2.last().unwrap() & 0x80 == 0 { 0 } else { 0xFF }; 4];
        bytes[..usize::from(count)].copy_from_slice(&answers[0].2);
        i32::from_le_bytes(bytes)
    }
}

#[test]
fn registers_keep_their_rules() {
    let mut client = Client::new();
    assert_eq!(client.write(0, &[1, 2]), 7, "read-only");
    assert_eq!(client.write(14, &[1]), 7, "no register");
    assert_eq!(client.write(116, &[0, 8]), 5, "half a register");
    assert_eq!(client.write(11, &[2]), 4, "no such mode");
    assert_eq!(client.write(98, &[200]), 4, "out of range");
    assert_eq!(client.write(116, &5000_i32.to_le_bytes()), 6, "beyond the position limit");
    assert_eq!(client.write(38, &[50, 0]), 0);
    assert_eq!(client.write(102, &[51, 0]), 6, "beyond the current limit");
    assert_eq!(client.write(64, &[1]), 0);
    assert_eq!(client.write(11, &[4]), 7, "EEPROM while the torque is on");
    assert_eq!(client.write(64, &[0]), 0);
    assert_eq!(client.write(11, &[4]), 0);
    assert_eq!(client.write(116, &5000_i32.to_le_bytes()), 0, "many turns have no limits");
    assert_eq!(client.ask(1, &I::Read { address: 660, count: 10 })[0].1, 7, "beyond the table");
    assert!(client.ask(1, &I::Write { address: 68, data: &[0] }).is_empty(), "from now on");
    assert!(client.ask(1, &I::Read { address: 0, count: 2 }).is_empty());
    assert_eq!(client.ask(1, &I::Ping).len(), 1);
}

#[test]
fn indirect_data_stands_for_other_registers() {
    let mut client = Client::new();
    // Bytes 1 to 4 refer to the goal position, byte 5 to the LED.
    for (k, target) in [116_u16, 117, 118, 119, 65].into_iter().enumerate() {
        assert_eq!(client.write(168 + 2 * k as u16, &target.to_le_bytes()), 0);
    }
    assert_eq!(client.write(224, &[0xE8, 3, 0, 0, 1]), 0);
    assert_eq!((client.read(116, 4), client.read(65, 1), client.read(224, 4)), (1000, 1, 1000));
    assert_eq!(client.write(578, &146_u16.to_le_bytes()), 0);
    assert_eq!(client.read(634, 1), 30);
    assert_eq!(client.write(634, &[1]), 7, "what it stands for is read-only");
    assert_eq!(client.write(168, &[10, 0]), 4, "the EEPROM is out of reach");
}

#[test]
fn instructions_for_several_do_what_they_say() {
    let mut client = Client::new();
    let pinged: Vec<u8> = client.ask(BROADCAST, &I::Ping).iter().map(|answer| answer.0).collect();
    assert_eq!(pinged, [1, 2]);
    assert!(client.ask(BROADCAST, &I::SyncWrite { address: 65, count: 1, items: &[1, 1, 2, 1] }).is_empty());
    let read = client.ask(BROADCAST, &I::SyncRead { address: 65, count: 1, ids: &[2, 1], fast: false });
    assert_eq!(read, [(2, 0, vec![1]), (1, 0, vec![1])], "in the order asked");
    assert!(client.ask(BROADCAST, &I::BulkWrite { items: &[1, 65, 0, 1, 0, 0, 2, 31, 0, 1, 0, 60] }).is_empty());
    let bulk = [2, 31, 0, 1, 0, 1, 65, 0, 1, 0];
    let read = client.ask(BROADCAST, &I::BulkRead { items: &bulk, fast: false });
    assert_eq!(read, [(2, 0, vec![60]), (1, 0, vec![0])]);
    let fast = client.ask(BROADCAST, &I::BulkRead { items: &bulk, fast: true });
    assert_eq!((fast.len(), fast[0].0, fast[0].1), (1, BROADCAST, 0));
    assert_eq!((&fast[0].2[..2], &fast[0].2[4..]), (&[2, 60][..], &[0, 1, 0][..]));
    let missing = client.ask(BROADCAST, &I::SyncRead { address: 65, count: 1, ids: &[1, 9, 2], fast: false });
    assert_eq!(missing.len(), 1);
    let kept = client.ask(1, &I::RegWrite { address: 65, data: &[1] });
    assert_eq!((kept[0].1, client.read(69, 1), client.read(65, 1)), (0, 1, 0));
    assert!(client.ask(BROADCAST, &I::Action).is_empty());
    assert_eq!((client.read(69, 1), client.read(65, 1)), (0, 1));
    assert_eq!(client.ask(1, &I::Action)[0].1, 1, "nothing is registered");
    // A servo obeys its shadow id without answering.
    assert_eq!(client.write(12, &[77]), 0);
    assert!(client.ask(77, &I::Write { address: 65, data: &[0] }).is_empty());
    assert_eq!(client.read(65, 1), 0);
}

#[test]
fn resets_and_backups_do_what_they_say() {
    let mut client = Client::new();
    assert_eq!(client.write(31, &[55]), 0);
    assert_eq!(client.ask(1, &I::Backup { restore: true })[0].1, 1, "there is none");
    assert_eq!(client.ask(1, &I::Backup { restore: false })[0].1, 0);
    assert_eq!((client.write(31, &[66]), client.read(147, 1)), (0, 1));
    assert_eq!(client.ask(1, &I::Backup { restore: true })[0].1, 0);
    client.wait(0.3);
    assert_eq!(client.read(31, 1), 55);
    assert!(client.ask(BROADCAST, &I::FactoryReset { keep: Keep::Nothing }).is_empty());
    assert_eq!(client.read(31, 1), 55, "the reset of all to one id is refused");
    assert_eq!(client.ask(1, &I::FactoryReset { keep: Keep::IdAndBaud })[0].1, 0);
    assert!(client.ask(1, &I::Ping).is_empty(), "it starts");
    client.wait(0.3);
    assert_eq!((client.read(31, 1), client.read(9, 1) as u8, client.read(8, 1)), (80, 250, 3));
}

#[test]
fn a_blocked_servo_shuts_down_until_it_restarts() {
    let mut client = Client::new();
    let blocked = |_: f64, _: usize, shaft: &super::super::ServoShaft| ServoSurroundings {
        load_nm: -10.0 * shaft.angle_rad - 0.5 * shaft.velocity_rad_s,
        supply_v: 12.0,
        temperature_c: 30.0,
    };
    client.emulator = Bus::new(&EmulatedDynamixel::default(), Some(Box::new(blocked))).unwrap();
    assert_eq!((client.write(64, &[1]), client.write(116, &4000_i32.to_le_bytes())), (0, 0));
    client.wait(3.0);
    let answer = client.ask(1, &I::Ping);
    assert_eq!(answer[0].1, 0x80);
    assert_eq!((client.read(70, 1), client.read(64, 1)), (0x20, 0));
    assert_eq!(client.write(64, &[1]) & 0x7F, 7, "only a reboot lets the torque on again");
    client.ask(1, &I::Reboot);
    client.wait(0.3);
    assert_eq!((client.read(70, 1), client.write(64, &[1])), (0, 0));
}

#[test]
fn the_watchdog_stops_a_servo_and_locks_its_goals() {
    let mut client = Client::new();
    assert_eq!((client.write(11, &[1]), client.write(64, &[1]), client.write(98, &[5])), (0, 0, 0));
    assert_eq!(client.write(104, &100_i32.to_le_bytes()), 0);
    let fastest = (0..50).map(|_| client.read(128, 4)).max();
    assert!(fastest > Some(80), "{fastest:?}");
    client.wait(0.5);
    assert_eq!(client.read(98, 1), -1);
    assert!(client.read(128, 4).abs() < 3);
    assert_eq!(client.write(104, &100_i32.to_le_bytes()), 4);
    assert_eq!(client.write(98, &[0]), 0);
    assert_eq!(client.write(104, &100_i32.to_le_bytes()), 0);
}

/// Returns the settling time within 1 % of a move of 1000 ticks, and the maximum overshoot, ticks.
fn response(registers: &[(u16, i32, usize)]) -> (f64, f64) {
    let mut client = Client::new();
    for (address, value, bytes) in registers {
        assert_eq!(client.write(*address, &value.to_le_bytes()[..*bytes]), 0);
    }
    client.write(64, &[1]);
    client.write(116, &3048_i32.to_le_bytes());
    let begin_s = client.now_s;
    let mut settled_s = 0.0;
    let mut highest = 0.0_f64;
    while client.now_s < begin_s + 3.0 {
        let position = f64::from(client.read(132, 4));
        highest = highest.max(position - 3048.0);
        if (position - 3048.0).abs() > 10.0 {
            settled_s = client.now_s - begin_s;
        }
    }
    (settled_s, highest)
}

#[test]
fn gains_and_profiles_have_their_effect() {
    let (usual_s, overshoot) = response(&[]);
    assert!(usual_s < 1.0 && overshoot > 10.0, "{usual_s} s, {overshoot}");
    let (weak_s, weak_overshoot) = response(&[(84, 100, 2)]);
    assert!(weak_s > 1.5 * usual_s || weak_overshoot < overshoot, "{weak_s} s, {weak_overshoot}");
    let (_, damped) = response(&[(80, 4000, 2)]);
    assert!(damped < 0.5 * overshoot, "{damped} of {overshoot}");
    // 1000 ticks take 3.07 s at 0.5 rad/s, and 0.77 s plus the ramps at 2 rad/s.
    let (slow_s, _) = response(&[(112, 21, 4)]);
    assert!(slow_s > 2.9, "{slow_s}");
    let (ramped_s, after) = response(&[(112, 83, 4), (108, 30, 4)]);
    assert!((0.8..1.3).contains(&ramped_s) && after < 0.5 * overshoot, "{ramped_s} s, {after}");
}

#[test]
fn a_position_that_is_off_under_load_comes_home_with_the_integral() {
    let sag = |gain: i32| {
        let mut client = Client::new();
        let loaded = |_: f64, _: usize, _: &_| ServoSurroundings { load_nm: -0.5, supply_v: 12.0, temperature_c: 30.0 };
        client.emulator = Bus::new(&EmulatedDynamixel::default(), Some(Box::new(loaded))).unwrap();
        client.write(82, &gain.to_le_bytes()[..2]);
        client.write(64, &[1]);
        client.write(116, &2048_i32.to_le_bytes());
        client.wait(3.0);
        f64::from(2048 - client.read(132, 4))
    };
    let without = sag(0);
    let with = sag(1000);
    assert!(without > 10.0 && with.abs() < 2.0, "{without} {with}");
}

fn held(bench: &mut Fixture) -> DynamixelDriver<MemoryBytes> {
    let mut driver = bench.open().unwrap();
    assert_eq!(driver.set_goals(&[0.0; 4]), GoalResult::Refused, "no goals without torque");
    bench.run(&mut driver, 0.1);
    driver.set_torque(true);
    bench.run(&mut driver, 0.1);
    driver
}

#[test]
fn goals_are_reached_in_radians_with_sign_and_offset() {
    let mut bench = Fixture::usual();
    bench.settings.servos[1].reverse = true;
    bench.settings.servos[2].homing_offset_rad = 0.3;
    let mut driver = held(&mut bench);
    let here = bench.run(&mut driver, 0.2).unwrap();
    let later = bench.run(&mut driver, 0.2).unwrap();
    for index in 0..4 {
        assert!((here.position_rad[index] - later.position_rad[index]).abs() < 0.02, "held where it was");
    }
    let goals = [0.5, 0.4, -0.3, 0.2];
    assert_eq!(driver.set_goals(&goals), GoalResult::AsAsked);
    let there = bench.run(&mut driver, 2.0).unwrap();
    for index in 0..4 {
        assert!((there.position_rad[index] - goals[index]).abs() < 0.01, "{there:?}");
    }
    let shaft = |index: usize| bench.world.borrow().emulator.shaft(index).unwrap().angle_rad;
    assert!((shaft(1) + 0.4).abs() < 0.01 && (shaft(2) + 0.6).abs() < 0.01, "{} {}", shaft(1), shaft(2));
    assert_eq!(driver.set_goals(&[9.0, 0.0, 0.0, 0.0]), GoalResult::Limited);
    assert!((bench.run(&mut driver, 2.0).unwrap().position_rad[0] - 1.5).abs() < 0.01);
    assert_eq!(driver.set_goals(&[f64::NAN, 0.0, 0.0, 0.0]), GoalResult::Refused);
    let conditions = driver.conditions().map(Option::unwrap);
    assert!(conditions.iter().all(|c| c.torque_on && (c.voltage_v - 12.0).abs() < 0.01 && c.temperature_c > 20.0));
    driver.set_torque(false);
    bench.run(&mut driver, 0.5);
    assert!((0..4).all(|index| !bench.world.borrow().emulator.shaft(index).unwrap().torque_on));
    assert_eq!(driver.health().standing, ConnectionState::Connected);
}

#[test]
fn the_current_of_a_load_is_read_in_ampere() {
    let loaded = |_: f64, _: usize, _: &_| ServoSurroundings { load_nm: -1.0, supply_v: 12.0, temperature_c: 30.0 };
    let emulator = Bus::new(&emulated(), Some(Box::new(loaded))).unwrap();
    let mut bench = Fixture::new(emulator, settings());
    let mut driver = held(&mut bench);
    let reading = bench.run(&mut driver, 1.0).unwrap();
    // 4.1 Nm take 2.3 A.
    assert!((reading.current_a[3] - 2.3 / 4.1).abs() < 0.01, "{reading:?}");
}

#[test]
fn dropping_the_driver_lets_the_torque_go() {
    let mut bench = Fixture::usual();
    let driver = held(&mut bench);
    assert!(bench.world.borrow().emulator.shaft(3).unwrap().torque_on);
    drop(driver);
    bench.world.borrow_mut().pass(1e-3);
    assert!((0..4).all(|index| !bench.world.borrow().emulator.shaft(index).unwrap().torque_on));
}

#[test]
fn a_lost_torque_command_is_given_again() {
    let mut bench = Fixture::usual();
    let mut driver = bench.open().unwrap();
    bench.run(&mut driver, 0.1);
    driver.set_torque(true);
    // Data sent from now on never arrive.
    let begin_s = bench.now_s();
    while !driver.is_torque_on() {
        bench.poll(&mut driver, 1e-3);
        assert!(bench.now_s() - begin_s < 0.1);
    }
    let mut lost = [0; 1024];
    nima_devices::transport::ByteStream::receive(&mut bench.world.borrow_mut().end, &mut lost).unwrap();
    bench.run(&mut driver, 0.5);
    assert!((0..4).all(|index| bench.world.borrow().emulator.shaft(index).unwrap().torque_on));
}

#[test]
fn a_reboot_by_command_leads_through_a_new_opening() {
    let mut bench = Fixture::usual();
    let mut driver = held(&mut bench);
    driver.reboot(2);
    bench.run(&mut driver, 0.05);
    assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Silent));
    drop(driver);
    let mut driver = bench.open().unwrap();
    assert!(!bench.reboots.is_any() && bench.run(&mut driver, 0.2).is_some());
    bench.world.borrow_mut().emulator.fail(0, HardwareError(0x01));
    bench.run(&mut driver, 0.02);
    assert!(matches!(driver.health().standing, ConnectionState::Lost(Loss::Device { .. })));
}
