//! A tick of a hand that looks for lumps, and of one that leads a loop along a wire, allocates nothing.

use nima_core::task::TaskEvent;
use nima_machine::rig::{Outputs, Rig as _, SIDES, SensedForce, Side};
use nima_simulation::{Worlds, scene::Scene};
use nima_testing::real_time::alone;

use crate::counting::calls;

#[test]
fn a_tick_of_a_training_task_allocates_nothing_until_its_end() {
    let _alone = alone();
    let right = Side::Right.index();
    for (scene, seconds) in [("find_lumps", 110), ("wire", 40)] {
        let (mut worlds, watched) = Worlds::watched(&Scene::load(scene).unwrap(), 1000.0);
        let watched = watched.unwrap();
        let mut outputs = [Outputs::SAFE; SIDES];
        let mut happened = 0;
        let mut ended = false;
        let before = calls();
        for tick in 0..seconds * 1000 {
            let now_s = f64::from(tick) * 1e-3;
            if let Some(inputs) = worlds.read(now_s)[right] {
                outputs[right].tip_command_m = Some(inputs.hand.position_m);
                // Ideal force feedback.
                if let SensedForce::AtTip(force_n) = inputs.sensed {
                    outputs[right].hand_force_n = force_n;
                }
            }
            worlds.write(now_s, &outputs);
            for happening in watched.happenings() {
                happened += 1;
                ended |= happening.event == TaskEvent::Ended;
            }
        }
        assert_eq!(calls() - before, 0, "{scene}");
        assert!(ended && happened >= 2, "{scene}: {happened} events");
    }
}
