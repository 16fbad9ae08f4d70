//! Adapts a scene to one side of an emulated rig: the rig determines the equipment between arm and tissue.
//!
//! With `sensor_at = "tip"`, a sensor measures only the tissue, whatever the scene has at the wrist. With `"wrist"` a
//! scene without a wrist gets the paper's: sensor, tool, trocar with friction, and the sensor under the tissue, as in
//! the scene `isolation`. No two sensors are alike: the left one has its own bias, gains and accelerometer.

use nalgebra::Vector3;
use nima_machine::rig::{ArmSet, SensorPlace, Side};
use nima_simulation::scene::{Imu, Scene, WristModel};

use super::EmulatedRigError;

/// The scene that describes the paper's rig.
const PAPER: &str = "isolation";

/// Returns the scene as seen by this side: mirrored for a left side without its own part, with the rig's trocar, shaft
/// and marker.
pub(super) fn of_side(scene: &Scene, side: Side, set: &ArmSet) -> Result<Scene, EmulatedRigError> {
    let mut scene = scene.clone().with_left_hand().of_side(side).unwrap_or_else(|| scene.clone());
    scene.trocar_m = set.rcm.trocar_m;
    match set.sensor_at {
        SensorPlace::Tip => {
            scene.wrist = None;
            scene.trocar = None;
            scene.tissue_sensor = None;
            scene.person = None;
        }
        SensorPlace::Wrist => at_wrist(&mut scene, side, set)?,
    }
    Ok(scene)
}

fn at_wrist(scene: &mut Scene, side: Side, set: &ArmSet) -> Result<(), EmulatedRigError> {
    let paper = Scene::load(PAPER)?;
    if scene.wrist.is_none() {
        scene.wrist = paper.wrist;
        scene.trocar = paper.trocar;
    }
    scene.tissue_sensor = scene.tissue_sensor.or(paper.tissue_sensor);
    if let Some(wrist) = &mut scene.wrist {
        wrist.shaft_m = set.mount.shaft_m;
        if side == Side::Left {
            another_sensor(wrist);
        }
    }
    if let Some(sensor) = &mut scene.tissue_sensor {
        sensor.s1_from_m_deg = set.s1_from_m_deg.unwrap_or_else(Vector3::zeros);
    }
    Ok(())
}

fn another_sensor(wrist: &mut WristModel) {
    wrist.force_bias_n = Vector3::new(-2.4, 1.1, 3.7);
    wrist.torque_bias_nm = Vector3::new(-0.04, 0.06, -0.03);
    wrist.gain = Vector3::new(0.996, 1.003, 0.998);
    wrist.imu = wrist.imu.map(|imu| Imu {
        s1_from_imu_deg: Vector3::new(-1.5, 2.5, 88.0),
        bias_m_s2: Vector3::new(-0.05, 0.03, 0.04),
        ..imu
    });
}
