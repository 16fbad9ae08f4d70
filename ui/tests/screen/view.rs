//! The view and the traces under the pointer, and a window at rest.

use std::time::{Duration, Instant};

use egui::{Event, Pos2, ViewportId, pos2};
use egui_kittest::{Harness, kittest::Queryable as _};
use nima_console::console::ConsoleApp;
use nima_machine::messages::LoopState;
use nima_screen::scene3d::extras::{CEILING, Extras, FRAMES, SHOW};
use nima_testing::real_time::judged;

use crate::bench::{console_of, press, until};

const SIZE: [f32; 2] = [1600.0, 1000.0];

/// Holds the pointer here until the hover text appears.
fn point_at(harness: &mut Harness<'_, ConsoleApp>, place: Pos2) {
    harness.input_mut().events.push(Event::PointerMoved(place));
    harness.run_steps(20);
}

#[test]
fn the_cursor_of_one_plot_is_read_in_all() {
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "some data", |tick| tick.t_s > 1.0);
    point_at(&mut harness, pos2(900.0, 790.0));
    let report = |axis: &str| harness.query_by_label_contains(&format!("At the cursor, {axis}: measured")).is_some();
    let report = ["x", "y", "z"].map(report);
    assert_eq!(report.iter().filter(|report| **report).count(), 2, "all but the one under the pointer: {report:?}");
}

#[test]
fn the_object_under_the_pointer_is_described() {
    let mut harness = console_of("bimanual", SIZE, |app| app);
    until(&mut harness, "some data", |tick| tick.t_s > 0.2);
    point_at(&mut harness, pos2(760.0, 395.0));
    let report = harness.query_by_label_contains("mm (world)").is_some()
        || harness.query_by_label_contains("N (world)").is_some();
    assert!(report);
    point_at(&mut harness, pos2(400.0, 450.0));
    assert!(harness.query_by_label_contains("(world)").is_none(), "there is nothing");
}

#[test]
fn ceiling_and_frames_are_drawn_on_request() {
    let mut harness = console_of("bimanual", SIZE, |app| app);
    until(&mut harness, "any tick", |_| true);
    assert_eq!(harness.state().extras(), Extras::default());
    press(&mut harness, SHOW.get());
    for switch in [CEILING, FRAMES] {
        harness.get_by_label(switch.get()).click();
        harness.run_steps(2);
    }
    assert_eq!(harness.state().extras(), Extras { ceiling: true, frames: true, ..Extras::default() });
}

#[test]
fn a_stopped_window_comes_to_rest_and_a_running_one_does_not() {
    judged(|| {
        let mut harness = console_of("peg_transfer", SIZE, |app| app);
        until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
        let delay =
            |harness: &Harness<'_, ConsoleApp>| harness.output().viewport_output[&ViewportId::ROOT].repaint_delay;
        harness.run_steps(10);
        assert!(delay(&harness) <= Duration::from_millis(32));
        press(&mut harness, "Stop");
        until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
        let began = Instant::now();
        while delay(&harness) < Duration::from_millis(100) {
            assert!(began.elapsed() < Duration::from_mins(2), "it never rests");
            std::thread::sleep(Duration::from_millis(20));
            harness.step();
        }
    });
}
