//! The window that only shows a rig at another machine.

use std::{sync::mpsc, time::Duration};

use egui::Key;
use egui_kittest::Harness;
use nalgebra::Isometry3;
use nima_console::console::monitor::{Heard, Monitor, Options, Teller};
use nima_machine::{messages::Command, rig::SIDES, runtime};
use nima_session::{
    objects::{Jaws, Objects, Standing},
    watched::{Moment, MomentWriter, read},
};
use nima_simulation::Plan;
use nima_tests::plan;

use crate::bench::{can_press, read as reads, shows, texts};

fn window() -> (Harness<'static, Monitor>, Teller) {
    let (to, teller) = mpsc::channel();
    let harness = Harness::builder().with_size([1600.0, 1000.0]).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
        let (monitor, teller) = Monitor::new(cc, "theatre-1", Options::default());
        to.send(teller).unwrap();
        monitor
    });
    (harness, teller.recv().unwrap())
}

/// Data that the rig of this plan sends in its first seconds over the network; it is stopped after six.
fn sent(plan: &Plan) -> Vec<Moment> {
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
    let (mut window, teller) = window();
    let plan = plan("rings");
    teller.tell(Heard::Runs(Box::new(plan.rig.clone()), Box::new(plan.scene.clone())));
    let mut writer = MomentWriter::default();
    let mut objects =
        Objects { t_s: 0.1, rings: vec![Some(Isometry3::translation(0.01, 0.02, 0.03)), None], ..Objects::default() };
    objects.jaws[0] = Some(Jaws { opening_rad: 0.5, ..Jaws::default() });
    objects.task = Some(Standing { passed: 3, placed: 2, ..Standing::default() });
    writer.objects(&objects);
    runtime::run_virtual(plan.simulated().unwrap(), 0.2, |tick| {
        let mut ticks = [None; SIDES];
        ticks[tick.side.index()] = Some(*tick);
        writer.tick(tick.t_s, &ticks, &[]);
        None
    });
    teller.tell(Heard::Shows(read(&writer.take()).unwrap()));
    window.run_steps(3);
    assert_eq!(window.state().live().unwrap().objects.as_ref(), Some(&objects));
    reads(&mut window, "Rings: passed 3, placed 2, dropped 0");
    // The next batch contains no new objects.
    teller.tell(Heard::Shows(sent(&plan).drain(..20).collect()));
    window.run_steps(3);
    assert_eq!(window.state().live().unwrap().objects.as_ref(), Some(&objects));
}

#[test]
fn a_rig_elsewhere_is_shown_in_every_view_and_nothing_acts_on_it() {
    let (mut window, teller) = window();
    reads(&mut window, "Connecting to the rig");
    assert!(teller.tell(Heard::Rests));
    reads(&mut window, "no loop is running there");

    let plan = plan("peg_transfer");
    let moments = sent(&plan);
    let (engaged, stopped) =
        moments.split_at(moments.iter().position(|moment| moment.ticks[0].unwrap().t_s > 5.0).unwrap());
    teller.tell(Heard::Runs(Box::new(plan.rig.clone()), Box::new(plan.scene.clone())));
    teller.tell(Heard::Shows(engaged.to_vec()));
    reads(&mut window, "Engaged");
    assert!(shows(&window, "WATCHING") && shows(&window, "theatre-1, "), "{:?}", texts(&window));
    let live = window.state().live().unwrap();
    assert!((live.first_tick().unwrap().t_s - 5.0).abs() < 0.02);
    assert!(live.history[0].latest_s() > 4.9, "the traces are there");

    for key in [Key::F1, Key::F2] {
        window.key_press(key);
        window.run_steps(3);
        for act in ["Engage", "STOP", "Release stop", "Mark", "Compare all modes"] {
            assert!(!can_press(&window, act), "{act} can be pressed at a screen that only shows");
        }
    }
    teller.tell(Heard::Shows(stopped.to_vec()));
    reads(&mut window, "Stopped");
    // A display that is out of date is labelled.
    reads(&mut window, "No data from the rig for");
    assert!(!shows(&window, "Stopped"), "a state that may be another by now");
    teller.tell(Heard::Trouble("rig theatre-1 does not answer".to_owned()));
    reads(&mut window, "does not answer");
    std::thread::sleep(Duration::from_millis(50));
    drop(window);
    assert!(!teller.tell(Heard::Rests), "the window is closed");
}
