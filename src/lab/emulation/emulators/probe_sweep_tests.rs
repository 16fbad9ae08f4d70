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
    haply::{HaplyDriver, HaplySettings},
    hid::{CapDriver, CapSettings, PedalDriver, PedalSettings},
    kinova::{self, KinovaSettings},
    ndi::{NdiDriver, NdiSettings},
};
use nima_testing::real_time::judged;

use super::{ALONE, EmulatedFault, EmulatorSettings};

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

/// Opens the servos with a setting for each, as a rig file has.
fn dynamixel(place: &str) -> bool {
    let servo = "position_min_rad = -1.5, position_max_rad = 1.5, profile_velocity_rad_s = 4.0, profile_acceleration_rad_s2 = 100.0, current_limit_a = 2.0";
    let servos: Vec<String> = (1..=4).map(|id| format!("{{ id = {id}, {servo} }}")).collect();
    let text = format!("port = \"{place}\"\nbaud = 1000000\nservos = [{}]", servos.join(", "));
    works(dynamixel::open(&toml::from_str(&text).unwrap()), true)
}

/// Name of the emulator, name of the probe, and what a rig makes of the device at a place.
type Kind = (&'static str, &'static str, fn(&str) -> bool);

const KINDS: [Kind; 12] = [
    ("ati", "ati", |place| works(AtiDriver::open(&AtiSettings::at(place).unwrap()), true)),
    ("bota-gen0", "bota-gen0", |place| bota(Transport::Gen0, place)),
    ("bota-gen-a", "bota-gen-a", |place| bota(Transport::GenA, place)),
    ("bota-socket", "bota-socket", |place| bota(Transport::Socket, place)),
    ("external-arm", "external-arm", |place| {
        works(ExternalArm::open(&ExternalSettings::at(place.parse().unwrap()), &ArmModel::GEN3), true)
    }),
    ("dynamixel", "dynamixel", dynamixel),
    ("haply", "haply", |place| works(HaplyDriver::open(&HaplySettings::at(place)), true)),
    ("kinova", "kinova", |place| works(kinova::open(&KinovaSettings::at(place).unwrap()), true)),
    ("ndi", "ndi", |place| ndi(NdiSettings { address: Some(place.to_owned()), ..NdiSettings::default() })),
    ("ndi-serial", "ndi", |place| ndi(NdiSettings { port: Some(place.to_owned()), ..NdiSettings::default() })),
    ("pedal", "pedal", |place| {
        works(PedalDriver::open(&PedalSettings { source: place.to_owned(), ..PedalSettings::default() }), false)
    }),
    ("spacemouse", "spacemouse", |place| {
        works(CapDriver::open(&CapSettings { source: place.to_owned(), ..CapSettings::default() }), false)
    }),
];

/// Settings and fault of an emulator.
const CASES: [(&[&str], EmulatedFault); 5] = [
    (&[], EmulatedFault::None),
    // The time that a sensor of the first generation takes to start.
    (&["boot_s=0.8"], EmulatedFault::None),
    (&["boot_s=2.5"], EmulatedFault::None),
    (&[], EmulatedFault::Delay),
    (&[], EmulatedFault::Silence),
];

fn same_verdict((emulator, probe, rig): Kind, set: &[&str], fault: EmulatedFault) {
    let texts: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let (_, make) = ALONE.iter().find(|(name, _)| *name == emulator).unwrap();
    let serving = make(&EmulatorSettings::new(&texts).unwrap()).unwrap().serve().unwrap();
    serving.faults.set(fault);
    let by_probe = diagnose(vec![probe_named(&format!("{probe}={}", serving.endpoint)).unwrap()], TIMEOUT).remove(0);
    // Delayed frames for the probe would reach the rig, with a gap after them.
    std::thread::sleep(Duration::from_millis(100));
    let by_rig = rig(&serving.endpoint);
    let works = matches!(by_probe.outcome, TestOutcome::Connected(_));
    println!("| {emulator} | {} | {} | {works} | {by_rig} |", set.join(" "), fault.name());
    assert_eq!(works, by_rig, "{emulator} {set:?} {}: {:?}", fault.name(), by_probe.outcome);
    if (emulator, fault) == ("external-arm", EmulatedFault::Delay) {
        let late = matches!(by_probe.outcome, TestOutcome::Trouble { trouble: DeviceError::Late { .. }, .. });
        assert!(late, "its readings come, but too late: {:?}", by_probe.outcome);
    }
    if fault == EmulatedFault::None {
        assert!(works, "{emulator} {set:?}: {:?}", by_probe.outcome);
    }
}

#[test]
#[ignore = "real devices' times, half a minute: `./dev test` runs it alone"]
fn a_probe_and_a_rig_come_to_the_same_verdict() {
    judged(|| {
        println!("| device | settings | fault | probe | rig |\n|---|---|---|---|---|");
        std::thread::scope(|scope| {
            for kind in KINDS {
                scope.spawn(move || {
                    for (set, fault) in CASES {
                        // Only this generation has a start that takes time.
                        if set.is_empty() || kind.0 == "bota-gen0" {
                            same_verdict(kind, set, fault);
                        }
                    }
                });
            }
        });
    });
}
