//! Tests of the rig of a Haply handle: the handle is emulated on its port, and the hand feels the simulated tissue.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_devices::{
    ConnectionState, Loss,
    haply::{HaplySettings, codec::HaplyState},
};
use nima_emulation::emulators::{
    EmulatedFault, EmulatorThread,
    haply::{EmulatedHaply, HapticForce},
};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, LoopState, Tick},
    rig::LeaderSettings,
    runtime::LoopHandle,
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::real_time::{alone, judged};

/// Depth of the hand's motion into the tissue, m, and its speed, m/s.
const DEEP_M: f64 = 0.08;
const SPEED_M_S: f64 = 0.02;
const WAIT: Duration = Duration::from_secs(15);

/// Returns a hand that rests for two seconds and then moves down, held by a stiff spring.
fn pressing(felt: &HapticForce, begins: std::sync::Arc<std::sync::atomic::AtomicBool>) -> EmulatorThread {
    let mut body = felt.on_a_circle();
    let mut since_s = None;
    let emulated = EmulatedHaply::default().with(Box::new(move |now_s, force_n| {
        let mut state: HaplyState = body(0.0, force_n);
        let down_m = if begins.load(std::sync::atomic::Ordering::Relaxed) {
            (SPEED_M_S * (now_s - *since_s.get_or_insert(now_s))).min(DEEP_M)
        } else {
            0.0
        };
        state.position_m[2] -= down_m as f32;
        state.velocity_m_s = [0.0; 3];
        state
    }));
    emulated.serve().unwrap()
}

struct Fixture {
    handle: LoopHandle,
    newest: Option<Tick>,
    lost: Vec<Loss>,
}

impl Fixture {
    fn until(&mut self, what: &str, good: impl Fn(&Self) -> bool) {
        let begin = Instant::now();
        while !good(self) {
            assert!(
                begin.elapsed() < WAIT,
                "never came: {what}; {:?}",
                self.newest.map(|tick| (tick.state, tick.positions.tip_m))
            );
            std::thread::sleep(Duration::from_millis(1));
            let newest = &mut self.newest;
            let lost = &mut self.lost;
            self.handle.drain_ticks(|tick| *newest = Some(*tick));
            self.handle.drain_events(|event| {
                if let Event::Device(event) = event
                    && let ConnectionState::Lost(loss) = event.standing
                {
                    assert_eq!(event.of_side, [true, false], "the right force needs the handle");
                    lost.push(loss);
                }
            });
        }
    }

    fn is(&self, state: LoopState) -> bool {
        self.newest.is_some_and(|tick| tick.state == state)
    }
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_haply_handle_feels_the_simulated_tissue_and_a_silent_one_takes_the_force_away() {
    let _alone = alone();
    judged(|| {
        let felt = HapticForce::default();
        let begins = std::sync::Arc::default();
        let serving = pressing(&felt, std::sync::Arc::clone(&begins));
        let mut rig = RigConfig::load("haply-desk").unwrap();
        assert!(!rig.is_harmless() && !rig.has_simulated_hand(), "only a person engages it");
        rig.desk.as_mut().unwrap().handle = Some(LeaderSettings::Haply(HaplySettings::at(serving.endpoint.as_str())));
        rig.validate().unwrap();
        assert_eq!(rig.device_names()[0].to_string(), "right handle (Haply)");
        rig.mode = Mode::Dfr;
        rig.gates.static_hold = true;
        let scene = Scene::load("peg_transfer").unwrap();
        // The request to engage is refused, because a person's hand may be on the handle.
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
        let handle = nima_simulation::start(&plan).unwrap();
        assert_eq!(handle.roster()[0].name(), "right handle");
        let mut bench = Fixture { handle, newest: None, lost: Vec::new() };
        bench.until("half a second", |bench| bench.newest.is_some_and(|tick| tick.t_s > 0.5));
        assert!(bench.is(LoopState::Idle) && felt.force_n() == Vector3::zeros());
        bench.until("connected", |bench| {
            bench.handle.healths().is_none_or(|h| h.devices[0].standing == ConnectionState::Connected)
        });
        let connected_s = bench.newest.unwrap().t_s;
        bench.until("half a second more", |bench| bench.newest.is_some_and(|tick| tick.t_s > connected_s + 0.5));
        assert!(bench.is(LoopState::Idle), "only a person engages it");
        assert!(bench.handle.send(Command::Engage));
        bench.until("engaged", |bench| bench.is(LoopState::Engaged));
        begins.store(true, std::sync::atomic::Ordering::Relaxed);
        bench.until("a force", |_| felt.force_n().z > 0.3);
        // The hand feels the output of the gates.
        let rendered_n = bench.newest.unwrap().rendering.rendered_n;
        assert!((rendered_n - felt.force_n()).norm() < 0.5, "{rendered_n} and {}", felt.force_n());
        serving.faults.set(EmulatedFault::Silence);
        bench.until("a fault", |bench| matches!(bench.newest.unwrap().state, LoopState::Faulted(_)));
        bench.until("the loss", |bench| bench.lost == [Loss::Silent]);
        bench.until("no force", |_| felt.force_n() == Vector3::zeros());
    });
}
