//! Every kind of device, its emulator at default and at slow settings: a probe (`nima devices --probe`) and the driver
//! that a rig opens must come to the same verdict.
#![cfg(target_os = "linux")]

use std::time::{Duration, Instant};

use nima_core::kinematics::ArmModel;
use nima_devices::{
    Device, DeviceError,
    ati::{AtiDriver, AtiSettings},
    bota::{BotaDriver, BotaSettings, Transport},
    discovery::{TIMEOUT, TestOutcome, diagnose, probe_named},
    dynamixel,
    external::{ExternalArm, ExternalSettings},
    force_dimension::{self, ForceDimensionSettings},
    haply::{HaplyDriver, HaplySettings},
    hid::{CapDriver, CapSettings, PedalDriver, PedalSettings},
    kinova::{self, FaultClearing, KinovaSettings},
    ndi::{NdiDriver, NdiSettings},
};
use nima_testing::real_time::judged;

use super::{ALONE, EmulatedFault, EmulatorSettings, kinova::opening_tests::six_joints};

/// Time in which a rig's device must deliver, once it is open, and during which it must not be lost: as long as a probe
/// listens.
const DELIVERS: Duration = Duration::from_millis(400);

/// Returns whether the device can be used as a rig would use it: it opens, delivers or answers, and is not lost.
fn works<D: Device>(opened: Result<D, DeviceError>, must_deliver: bool) -> bool {
    let mut device = match opened {
        Ok(device) => device,
        Err(error) => {
            println!("{error}");
            return false;
        }
    };
    let begin = Instant::now();
    let mut delivers = !must_deliver;
    while begin.elapsed() < DELIVERS {
        delivers |= device.poll(begin.elapsed().as_secs_f64()).is_some();
        std::thread::sleep(Duration::from_millis(1));
    }
    let lost = matches!(device.health().standing, nima_devices::ConnectionState::Lost(_));
    delivers && !lost
}

fn bota(transport: Transport, place: &str) -> bool {
    works(BotaDriver::open(&BotaSettings::new(transport, place)), true)
}

fn ndi(settings: NdiSettings) -> bool {
    works(NdiDriver::open(&NdiSettings { wired: true, ..settings }), false)
}

fn external_arm(place: &str, model: &ArmModel) -> bool {
    works(ExternalArm::open(&ExternalSettings::at(place.parse().unwrap()), model), true)
}

fn kinova(place: &str, model: &ArmModel) -> bool {
    works(kinova::open_clearing(&KinovaSettings::at(place).unwrap(), model, &FaultClearing::default()), true)
}

/// Opens the servos with a setting for each, as a rig file has.
fn dynamixel(place: &str, baud: u32) -> bool {
    let servo = "position_min_rad = -1.5, position_max_rad = 1.5, profile_velocity_rad_s = 4.0, profile_acceleration_rad_s2 = 100.0, current_limit_a = 2.0";
    let servos: Vec<String> = (1..=4).map(|id| format!("{{ id = {id}, {servo} }}")).collect();
    let text = format!("port = \"{place}\"\nbaud = {baud}\nservos = [{}]", servos.join(", "));
    works(dynamixel::open(&toml::from_str(&text).unwrap()), true)
}

/// A kind of device with the settings of one emulator.
struct SweptKind {
    emulator: &'static str,
    set: &'static [&'static str],
    /// Text for the probe at a place.
    probe: fn(&str) -> String,
    /// Returns whether a rig can use the device at a place.
    rig: fn(&str) -> bool,
}

const KINDS: &[SweptKind] = &[
    SweptKind {
        emulator: "ati",
        set: &[],
        probe: |place| format!("ati={place}"),
        rig: |place| works(AtiDriver::open(&AtiSettings::at(place).unwrap()), true),
    },
    SweptKind {
        emulator: "ati",
        set: &["rate_hz=100"],
        probe: |place| format!("ati={place}"),
        rig: |place| works(AtiDriver::open(&AtiSettings::at(place).unwrap()), true),
    },
    SweptKind {
        emulator: "bota-gen0",
        set: &[],
        probe: |place| format!("bota-gen0={place}"),
        rig: |place| bota(Transport::Gen0, place),
    },
    // The time that a sensor of the first generation takes to start.
    SweptKind {
        emulator: "bota-gen0",
        set: &["boot_s=0.8"],
        probe: |place| format!("bota-gen0={place}"),
        rig: |place| bota(Transport::Gen0, place),
    },
    SweptKind {
        emulator: "bota-gen0",
        set: &["boot_s=2.5"],
        probe: |place| format!("bota-gen0={place}"),
        rig: |place| bota(Transport::Gen0, place),
    },
    SweptKind {
        emulator: "bota-gen-a",
        set: &[],
        probe: |place| format!("bota-gen-a={place}"),
        rig: |place| bota(Transport::GenA, place),
    },
    SweptKind {
        emulator: "bota-socket",
        set: &[],
        probe: |place| format!("bota-socket={place}"),
        rig: |place| bota(Transport::Socket, place),
    },
    SweptKind {
        emulator: "dynamixel",
        set: &[],
        probe: |place| format!("dynamixel={place}@1000000"),
        rig: |place| dynamixel(place, 1_000_000),
    },
    SweptKind {
        emulator: "dynamixel",
        set: &["baud=57600", "fast=false"],
        probe: |place| format!("dynamixel={place}@57600"),
        rig: |place| dynamixel(place, 57_600),
    },
    SweptKind {
        emulator: "external-arm",
        set: &["listen=127.0.0.1:47201"],
        probe: |place| format!("external-arm={place}"),
        rig: |place| external_arm(place, &ArmModel::GEN3),
    },
    SweptKind {
        emulator: "external-arm",
        set: &["listen=127.0.0.1:47202", "joints=6"],
        probe: |place| format!("external-arm={place}"),
        rig: |place| external_arm(place, &six_joints()),
    },
    SweptKind {
        emulator: "force-dimension",
        set: &[],
        probe: |place| format!("force-dimension=emulated:{}", address(place)),
        rig: |place| {
            let emulator = Some(address(place).parse().unwrap());
            works(force_dimension::open(&ForceDimensionSettings { emulator, ..Default::default() }), true)
        },
    },
    SweptKind {
        emulator: "haply",
        set: &[],
        probe: |place| format!("haply={place}"),
        rig: |place| works(HaplyDriver::open(&HaplySettings::at(place)), true),
    },
    SweptKind {
        emulator: "kinova",
        set: &[],
        probe: |place| format!("kinova={place}"),
        rig: |place| kinova(place, &ArmModel::GEN3),
    },
    SweptKind {
        emulator: "kinova",
        set: &["joints=6"],
        probe: |place| format!("kinova={place}"),
        rig: |place| kinova(place, &six_joints()),
    },
    SweptKind {
        emulator: "ndi",
        set: &[],
        probe: |place| format!("ndi={place}"),
        rig: |place| ndi(NdiSettings { address: Some(place.to_owned()), ..NdiSettings::default() }),
    },
    SweptKind {
        emulator: "ndi-serial",
        set: &[],
        probe: |place| format!("ndi={place}"),
        rig: |place| ndi(NdiSettings { port: Some(place.to_owned()), ..NdiSettings::default() }),
    },
    SweptKind {
        emulator: "pedal",
        set: &[],
        probe: |place| format!("pedal={place}"),
        rig: |place| {
            works(PedalDriver::open(&PedalSettings { source: place.to_owned(), ..PedalSettings::default() }), false)
        },
    },
    SweptKind { emulator: "spacemouse", set: &[], probe: |place| format!("spacemouse={place}"), rig: cap },
    SweptKind { emulator: "spacenavd", set: &[], probe: |place| format!("spacemouse={place}"), rig: cap },
];

/// Faults during probe and rig.
const FAULTS: [EmulatedFault; 3] = [EmulatedFault::None, EmulatedFault::Delay, EmulatedFault::Silence];

fn cap(place: &str) -> bool {
    works(CapDriver::open(&CapSettings { source: place.to_owned(), ..CapSettings::default() }), false)
}

/// Returns the address of an emulated handle, without the library that is shown behind it.
fn address(place: &str) -> &str {
    place.split_once(' ').map_or(place, |(address, _)| address)
}

/// Returns a row of the table.
fn same_verdict(SweptKind { emulator, set, probe, rig }: &SweptKind, fault: EmulatedFault) -> String {
    let texts: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let (_, make) = ALONE.iter().find(|(name, _)| name == emulator).unwrap();
    let serving = make(&EmulatorSettings::new(&texts).unwrap()).unwrap().serve().unwrap();
    serving.faults.set(fault);
    let by_probe = diagnose(vec![probe_named(&probe(&serving.endpoint)).unwrap()], TIMEOUT).remove(0);
    // Delayed frames for the probe would reach the rig, with a gap after them.
    std::thread::sleep(Duration::from_millis(100));
    let by_rig = rig(&serving.endpoint);
    let works = matches!(by_probe.outcome, TestOutcome::Connected(_));
    assert_eq!(works, by_rig, "{emulator} {set:?} {}: {:?}", fault.name(), by_probe.outcome);
    if (*emulator, fault) == ("external-arm", EmulatedFault::Delay) {
        let late = matches!(by_probe.outcome, TestOutcome::Trouble { trouble: DeviceError::Late { .. }, .. });
        assert!(late, "its readings come, but too late: {:?}", by_probe.outcome);
    }
    if fault == EmulatedFault::None {
        assert!(works, "{emulator} {set:?}: {:?}", by_probe.outcome);
    }
    let [by_probe, by_rig] = [works, by_rig].map(|works| if works { "works" } else { "does not work" });
    format!("| {emulator} | {} | {} | {by_probe} | {by_rig} |", set.join(" "), fault.name())
}

#[test]
#[ignore = "real devices' times, half a minute: `./dev test` runs it alone"]
fn a_probe_and_a_rig_come_to_the_same_verdict() {
    crate::emulated::provide_handles();
    judged(|| {
        println!("| device | settings | fault | probe | rig |\n|---|---|---|---|---|");
        // A few at a time: more would delay one another.
        for some in KINDS.chunks(7) {
            std::thread::scope(|scope| {
                let rows = |kind| move || FAULTS.map(|fault| same_verdict(kind, fault)).join("\n");
                let threads: Vec<_> = some.iter().map(|kind| scope.spawn(rows(kind))).collect();
                for thread in threads {
                    println!("{}", thread.join().unwrap());
                }
            });
        }
    });
}
