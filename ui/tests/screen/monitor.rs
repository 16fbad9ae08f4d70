//! The window that only shows a rig at another machine.

use std::{sync::mpsc, time::Duration};

use egui::Key;
use egui_kittest::Harness;
use nalgebra::Isometry3;
use nima_console::console::monitor::{Monitor, MonitorMessage, MonitorOptions, MonitorSender};
use nima_machine::{messages::Command, rig::SIDES, runtime};
use nima_session::{
    monitor_stream::{MomentWriter, MonitorMoment, read},
    objects::{JawState, ObjectStates, TaskProgress},
};
use nima_simulation::SimulationPlan;
use nima_tests::plan;

use crate::bench::{can_press, read as reads, shows, texts};

fn window() -> (Harness<'static, Monitor>, MonitorSender) {
    let (to, publisher) = mpsc::channel();
    let harness = Harness::builder().with_size([1600.0, 1000.0]).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
        let (monitor, publisher) = Monitor::new(cc, "theatre-1", MonitorOptions::default());
        to.send(publisher).unwrap();
        monitor
    });
    (harness, publisher.recv().unwrap())
}

/// Returns the data that the rig of this plan sends in its first seconds over the network; it is stopped after six.
fn sent(plan: &SimulationPlan) -> Vec<MonitorMoment> {
    let mut writer = MomentWriter::default();
    let mut moments = Vec::new();
    runtime::run_virtual(plan.simulated().unwrap(), 8.0, |tick| {
        let mut ticks = [None; SIDES];
        ticks[tick.side.index()] = Some(*tick);
        writer.tick(tick.t_s, &ticks, &[]);
        if writer.len() == 10 {
            moments.extend(read(&writer.take()).unwrap());
        }
        (tick.index == 6000).then_some(Command::Stop)
    });
    moments
}

#[test]
fn rings_and_jaws_of_a_rig_elsewhere_are_shown() {
    let (mut window, publisher) = window();
    let plan = plan("rings");
    publisher.notify(MonitorMessage::Runs(Box::new(plan.rig.clone()), Box::new(plan.scene.clone())));
    let mut writer = MomentWriter::default();
    let mut objects = ObjectStates {
        t_s: 0.1,
        rings: vec![Some(Isometry3::translation(0.01, 0.02, 0.03)), None],
        ..ObjectStates::default()
    };
    objects.jaws[0] = Some(JawState { opening_rad: 0.5, ..JawState::default() });
    objects.task = Some(TaskProgress { passed: 3, placed: 2, ..TaskProgress::default() });
    writer.objects(&objects);
    runtime::run_virtual(plan.simulated().unwrap(), 0.2, |tick| {
        let mut ticks = [None; SIDES];
        ticks[tick.side.index()] = Some(*tick);
        writer.tick(tick.t_s, &ticks, &[]);
        None
    });
    publisher.notify(MonitorMessage::Shows(read(&writer.take()).unwrap()));
    window.run_steps(3);
    assert_eq!(window.state().live().unwrap().objects.as_ref(), Some(&objects));
    reads(&mut window, "passed 3, placed 2, dropped 0");
    // The next batch contains no objects that are new.
    publisher.notify(MonitorMessage::Shows(sent(&plan).drain(..20).collect()));
    window.run_steps(3);
    assert_eq!(window.state().live().unwrap().objects.as_ref(), Some(&objects));
}

#[test]
fn a_rig_elsewhere_is_shown_in_every_view_and_nothing_acts_on_it() {
    let (mut window, publisher) = window();
    reads(&mut window, "Connecting to the rig");
    assert!(publisher.notify(MonitorMessage::Rests));
    reads(&mut window, "no loop is running there");

    let plan = plan("peg_transfer");
    let moments = sent(&plan);
    let (engaged, stopped) =
        moments.split_at(moments.iter().position(|moment| moment.ticks[0].unwrap().t_s > 5.0).unwrap());
    publisher.notify(MonitorMessage::Runs(Box::new(plan.rig.clone()), Box::new(plan.scene.clone())));
    publisher.notify(MonitorMessage::Shows(engaged.to_vec()));
    reads(&mut window, "Engaged");
    assert!(shows(&window, "WATCHING") && shows(&window, "theatre-1, "), "{:?}", texts(&window));
    let live = window.state().live().unwrap();
    assert!((live.first_tick().unwrap().t_s - 5.0).abs() < 0.02);
    assert!(live.history[0].latest_s() > 4.9, "the traces are shown");

    for key in [Key::F1, Key::F2] {
        window.key_press(key);
        window.run_steps(3);
        for act in ["Engage", "STOP", "Release stop", "Mark", "Compare all modes"] {
            assert!(!can_press(&window, act), "{act} can be pressed at a screen that only shows");
        }
    }
    publisher.notify(MonitorMessage::Shows(stopped.to_vec()));
    reads(&mut window, "Stopped");
    // A display that is out of date is labelled.
    reads(&mut window, "No data from the rig for");
    assert!(!shows(&window, "Stopped"), "a state that may be another by now");
    publisher.notify(MonitorMessage::Trouble("rig theatre-1 does not answer".to_owned()));
    reads(&mut window, "does not answer");
    std::thread::sleep(Duration::from_millis(50));
    drop(window);
    assert!(!publisher.notify(MonitorMessage::Rests), "the window is closed");
}
