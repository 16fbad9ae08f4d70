//! Commands of a part of the window: the endoscope image, a recorded session.

use egui::Key;
use nima_console::console::commands::Action;
use nima_machine::config::{EndoscopeConfig, StereoView};
use nima_wizards::WizardKind;

use super::{
    SIZE, alike, by_key, choose, entry, rows,
    wizards::{back, open_pages},
};
use crate::{
    bench::{Console, TIMEOUT, comes, console_of, pick, shows, wait},
    endoscope_view, playback,
};

#[test]
fn the_endoscope_has_its_commands_where_its_picture_is() {
    let (_serving, endoscope) = endoscope_view::lenses(Some(0.004));
    let endoscope = EndoscopeConfig { view: Some(StereoView::Left), baseline_m: Some(0.004), ..endoscope };
    let mut console = endoscope_view::surgeon(endoscope, [1280.0, 720.0]);
    endoscope_view::report(&mut console, "Endoscope image: live");
    let is = |console: &mut Console, words: &str| {
        assert!(
            comes(console, TIMEOUT, |console| endoscope_view::is_painted(console, words)),
            "never painted: {words}"
        );
    };
    is(&mut console, "Left image");
    choose(&mut console, Action::Lens);
    is(&mut console, "Right image");
    by_key(&mut console, Action::Lens);
    is(&mut console, "Both images");
    is(&mut console, "O hides them");
    choose(&mut console, Action::HideForces);
    is(&mut console, "Forces are hidden; O draws them at the tips");
    by_key(&mut console, Action::HideForces);
    is(&mut console, "O hides them");
    console.key_press(Key::F2);
    console.run_steps(3);
    let camera = Action::Calibrate(WizardKind::Camera);
    let title = &entry(camera).title;
    let opened = |console: &mut Console| {
        pick(console, "Calibration");
        pick(console, title);
    };
    alike(&mut console, camera, back, opened, open_pages);
    let rows = rows(&mut console);
    assert!(rows.iter().all(|(title, _)| *title != entry(Action::Lens).title), "the technician has no picture");
}

#[test]
fn the_past_is_played_and_left() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    playback::record(&path, "peg_transfer", "6");
    let mut console = console_of("peg_transfer", SIZE, move |app| app.with_session(&path));
    playback::until_whole(&mut console);
    let shown_ms = |console: &mut Console| console.state().past().map(|(_, t_s)| (t_s * 1e3).round() as i64);
    let at_three = |console: &mut Console| {
        console.state_mut().show_past(3.0);
        console.step();
        playback::until_whole(console);
    };
    for ms in [-1000, 1000, -10, 10] {
        for by_palette in [true, false] {
            at_three(&mut console);
            let action = Action::Step(ms);
            if by_palette {
                choose(&mut console, action);
            } else {
                by_key(&mut console, action);
            }
            playback::until_whole(&mut console);
            assert_eq!(shown_ms(&mut console), Some(3000 + i64::from(ms)), "{action:?} {by_palette}");
        }
    }
    at_three(&mut console);
    choose(&mut console, Action::Play);
    wait(&mut console, "it plays", |console| shows(console, "Pause") && console.state().past().unwrap().1 > 3.05);
    by_key(&mut console, Action::Play);
    let greyed = rows(&mut console);
    for blocked in [Action::Mark, Action::Rig, Action::Sessions, Action::Check] {
        assert!(greyed.contains(&(entry(blocked).title.clone(), false)), "{blocked:?}: {greyed:?}");
    }
    choose(&mut console, Action::LeavePast);
    assert!(console.state().past().is_none());
}
