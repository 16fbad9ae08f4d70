//! `nima view`: what it refuses, before a window opens; without a display, only the window is missing.

use crate::{every_command::nima, one_line};

fn failed(arguments: &[&str]) -> String {
    let output = nima(arguments);
    assert!(!output.status.success(), "{arguments:?}");
    one_line(&output)
}

#[test]
fn a_recording_is_read_before_the_window_opens() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("forces.csv");
    std::fs::write(&path, "time;Kraft\n0;1,5\n0,01;1,6\n").unwrap();
    let name = path.to_str().unwrap();
    let view = |maps: &[&str]| failed(&[&["view", name], maps].concat());
    let none = view(&[]);
    assert!(none.contains("t_s") && none.contains("time, Kraft"), "{none}");
    let absent = view(&["--map", "t=time", "--map", "z=Weg"]);
    assert!(absent.contains("\"Weg\"") && absent.contains("--map"), "{absent}");
    assert!(view(&["--map", "t=time", "--map", "lx=Kraft"]).contains("omit it"));
    let shown = view(&["--map", "t=time", "--map", "fx=Kraft", "--exit-after", "1"]);
    assert!(shown.contains("cannot open a window"), "a table of forces only is accepted: {shown}");
    std::fs::write(&path, "t_s,fx_n\n1,2\n0,2\n").unwrap();
    assert!(view(&[]).contains("split the file before this line"));
}
