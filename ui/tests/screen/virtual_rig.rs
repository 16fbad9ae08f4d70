//! A calibrated simulated rig on the virtual clock, for tests that need minutes of work.

use std::{
    sync::{
        OnceLock,
        mpsc::{Receiver, Sender, channel},
    },
    thread,
};

use nima_core::calibration::{
    Verdict,
    correspondence::{self, CorrespondenceRecord, CorrespondenceSession},
    gravity::{Compensator, DEFAULT_TIME_CONSTANT_S, GravityRecord, GravitySession, GravitySessionSettings},
};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Tick},
    rig::{Outputs, Prompt, SensedForce, Side},
    teleop::Calibrations,
};
use nima_recording::store::utc_now;
use nima_simulation::{SimulationPlan, World, run_virtual, scene::Scene};

/// Returns the samples of a calibration scene, each under the next prompt of `session`; ends with `None`.
fn calibrate(scene: &Scene, mut session: impl FnMut(&nima_core::frames::WristSample, f64) -> Option<Prompt>) {
    let mut world = World::new(scene, 1000.0);
    let mut prompt = Prompt::Rest;
    for tick in 1..200_000 {
        let t_s = f64::from(tick) * 1e-3;
        let SensedForce::AtWrist(sample) = world.exchange(t_s, &Outputs { prompt, ..Outputs::SAFE }).unwrap().sensed
        else {
            panic!("a calibration scene without a wrist");
        };
        let Some(next) = session(&sample, t_s) else { return };
        prompt = next;
    }
    panic!("the calibration never ended");
}

/// Gravity and correspondence of the simulated wrist, recorded once by their own sessions.
pub(crate) fn records() -> &'static (GravityRecord, CorrespondenceRecord) {
    static RECORDS: OnceLock<(GravityRecord, CorrespondenceRecord)> = OnceLock::new();
    RECORDS.get_or_init(|| {
        let scene = Scene::load("gravity").unwrap();
        let mut session = GravitySession::new(GravitySessionSettings::default());
        calibrate(&scene, |sample, t_s| {
            session.step(sample, t_s);
            session.target().map(|target| Prompt::Hold { world_from_s1: target.world_from_s1() })
        });
        let wrist = RigConfig::load("simulated").unwrap().simulated_wrist(Side::Right).cloned().unwrap();
        let gravity = session.report().unwrap().record(&wrist.serial_number, &wrist.tool, &utc_now()).unwrap();
        let scene = Scene::load("correspondence").unwrap();
        let mut session = CorrespondenceSession::new(correspondence::CorrespondenceSessionSettings::default());
        let mut compensator = Compensator::new(gravity.model, DEFAULT_TIME_CONSTANT_S, 1e-3);
        calibrate(&scene, |sample, t_s| {
            let force_n = compensator.step(sample).map(|wrench| wrench.force_n);
            session.step(force_n, sample, t_s);
            let pushing = |target: correspondence::PushTarget| Prompt::Push {
                direction: nalgebra::UnitVector3::new_normalize(target.push_in_world),
            };
            // Zero the sensors first: both are unloaded.
            if t_s < 2.0 { Some(Prompt::Rest) } else { session.target().map(pushing) }
        });
        let report = session.report().unwrap();
        let correspondence =
            CorrespondenceRecord::of(&report, [&wrist.serial_number, &wrist.tool], false, &utc_now()).unwrap();
        assert_eq!(correspondence.judgement.verdict, Verdict::Accepted);
        (gravity, correspondence)
    })
}

/// A simulated rig on the virtual clock, in a separate thread; it advances only on request.
pub(crate) struct VirtualRig {
    orders: Sender<(usize, Prompt)>,
    ticks: Receiver<Vec<Tick>>,
}

impl VirtualRig {
    pub(crate) fn start(scene: Scene, calibrations: Calibrations) -> Self {
        let (orders, ordered) = channel();
        let (give, ticks) = channel();
        let plan = SimulationPlan {
            rig: RigConfig::load("simulated").unwrap(),
            scene,
            calibrations: [calibrations, Calibrations::default()],
            engage: false,
        };
        thread::spawn(move || {
            let mut left = 1;
            let mut batch = Vec::new();
            run_virtual(&plan, 1e5, |tick| {
                batch.push(*tick);
                left -= 1;
                if left > 0 {
                    return None;
                }
                give.send(std::mem::take(&mut batch)).ok();
                let Ok((count, prompt)) = ordered.recv() else { return Some(Command::Shutdown) };
                left = count;
                Some(Command::Prompt(Side::Right, prompt))
            })
        });
        Self { orders, ticks }
    }

    /// Returns the ticks of the previous request; requests this many more under this prompt.
    pub(crate) fn go_on(&self, count: usize, prompt: Prompt) -> Vec<Tick> {
        let ticks = self.ticks.recv().unwrap();
        self.orders.send((count, prompt)).unwrap();
        ticks
    }
}
