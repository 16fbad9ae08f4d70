//! Diagnosis of the devices in a rig file.

use nima_devices::discovery::{
    Probe,
    probes::{pedal, servos, tracker},
};

use super::{RigSettings, Side};

/// Returns a probe for every device, named as in the rig: `right handle`, `right arm`, `right sensor`, `right servos`,
/// the same for the left side, `tissue sensor`, `tracker`, `pedal`.
pub fn rig_probes(settings: &RigSettings) -> Vec<Box<dyn Probe>> {
    let mut probes = Vec::new();
    for side in Side::ALL {
        let Some(set) = settings.arm(side) else { continue };
        let name = |part: &str| format!("{} {part}", side.word());
        let is_one_of_two = settings.arm(side.other()).is_some();
        let handle = if is_one_of_two { set.handle.for_hand_of(side) } else { set.handle.clone() };
        probes.push(handle.probe(&name("handle")));
        // A rig whose model is invalid is refused before its devices are probed.
        probes.extend(set.model().ok().map(|model| set.arm.probe(&name("arm"), &model)));
        probes.push(set.sensor.probe(&name("sensor")));
        probes.extend(set.servos.clone().map(|chosen| servos(&name("servos"), chosen)));
    }
    probes.extend(settings.tissue_sensor.as_ref().map(|chosen| chosen.probe("tissue sensor")));
    probes.extend(settings.tracker.clone().map(|chosen| tracker("tracker", chosen)));
    probes.extend(settings.pedal.clone().map(|chosen| pedal("pedal", chosen)));
    probes
}
