//! A rig file that requires the ready check: the loop refuses to engage until a check has passed.
use nima_machine::{
    config::{ReadyCheck, RigConfig},
    messages::{Command, LoopState, Refusal},
    rig::{Outputs, Rig as _, Side},
    teleop::{Calibrations, Pair, Timing},
};
use nima_simulation::{Worlds, scene::Scene};

fn pair(ready_check: ReadyCheck) -> Pair {
    let rig = RigConfig { ready_check, ..RigConfig::load("simulated").unwrap() };
    let mut pair = Pair::new(&rig, Side::Right, &Calibrations::default()).unwrap();
    let mut worlds = Worlds::new(&Scene::load("peg_transfer").unwrap(), rig.rate_hz);
    for k in 0..50 {
        let now_s = f64::from(k) * 1e-3;
        let inputs = worlds.read(now_s);
        pair.step(false, inputs[0], &Timing { now_s, ..Timing::default() });
        worlds.write(now_s, &[Outputs::SAFE; 2]);
    }
    pair
}

#[test]
fn where_it_is_required_nothing_engages_before_it_has_passed_nor_after_it_is_no_longer_valid() {
    let mut pair = pair(ReadyCheck::Required);
    for engage in [Command::Engage, Command::EngageOne(Side::Right)] {
        assert_eq!(pair.obey(engage, 0.05), Err(Refusal::NotChecked));
    }
    assert_eq!(pair.state(), LoopState::Idle);
    for (passed, answer) in [(true, Ok(())), (false, Err(Refusal::NotChecked))] {
        pair.obey(Command::Checked(passed), 0.05).unwrap();
        assert_eq!(pair.obey(Command::Engage, 0.05), answer);
        pair.obey(Command::Rest, 0.05).ok();
    }
}

#[test]
fn where_it_is_told_only_it_forbids_nothing() {
    let mut pair = pair(ReadyCheck::default());
    pair.obey(Command::Checked(false), 0.05).unwrap();
    assert_eq!(pair.obey(Command::Engage, 0.05), Ok(()));
}

#[test]
fn a_rig_file_says_which() {
    let text = include_str!("../../config/rigs/simulated.toml");
    let rule = |line: &str| RigConfig::parse("rig.toml".as_ref(), &text.replace("[identification]", line));
    assert_eq!(rule("ready_check = \"required\"\n[identification]").unwrap().ready_check, ReadyCheck::Required);
    assert_eq!(rule("[identification]").unwrap().ready_check, ReadyCheck::Told);
    let error = rule("ready_check = \"always\"\n[identification]").unwrap_err().to_string();
    assert!(error.contains("always") && error.contains("required"), "{error}");
}
