//! The image of the rig's endoscope: both instruments of the simulated world at their true positions.

use nima_endoscope::{Address, Endpoint};
use nima_files::public_address;
use nima_machine::{
    config::EndoscopeConfig,
    rig::{RigSettings, Side},
};
use nima_simulation::{camera::camera_of, scene::Scene};

use super::{EmulatedDevice, EmulatedRig, EmulatedRigError, SideWorld, addresses};
use crate::emulators::endoscope::{BASELINE_M, EmulatedEndoscope, EndoscopeInstrument};

const NAME: &str = "endoscope";

impl EmulatedRig {
    /// Also serves the endoscope image at its address, seen by the rig file's camera, or by the scene's default camera.
    ///
    /// # Errors
    /// If the address is not on this computer, or its port is in use.
    pub fn show(
        &mut self,
        endoscope: &EndoscopeConfig,
        devices: &RigSettings,
        scene: &Scene,
    ) -> Result<(), EmulatedRigError> {
        let place = |wanted| {
            let place = public_address(&endoscope.url);
            EmulatedRigError::Place { device: NAME.to_owned(), place, wanted }
        };
        let Ok(Address::Http(Endpoint { host, port, .. })) = endoscope.url.parse() else {
            return Err(place("in [endoscope] of an emulated rig, set url = \"http://127.0.0.1:PORT/\""));
        };
        addresses::local(NAME, &host)?;
        let worlds: Vec<_> = Side::ALL
            .into_iter()
            .zip(&self.sides)
            .filter_map(|(side, shared)| Some((devices.arm(side)?.rcm.trocar_m, shared.clone()?)))
            .collect();
        let mut emulated = EmulatedEndoscope { gives_way: true, ..EmulatedEndoscope::of(scene, port) };
        if let Some(camera) = &endoscope.camera {
            emulated.camera = camera_of(camera);
        }
        emulated.baseline_m = endoscope.view.map(|_| endoscope.baseline_m.unwrap_or(BASELINE_M));
        let body = move |_: f64| {
            let seen = worlds.iter().map(|(trocar_m, world)| EndoscopeInstrument {
                tip_m: world.with(SideWorld::truth).tip_m,
                trocar_m: *trocar_m,
            });
            seen.collect()
        };
        let serving = emulated.with(scene, Box::new(body)).serve();
        let serving = serving.map_err(|source| EmulatedRigError::Serve { device: NAME.to_owned(), source })?;
        self.endoscope.set(serving.faults.clone()).ok();
        self.devices.push(EmulatedDevice { name: NAME.to_owned(), serving });
        Ok(())
    }
}
