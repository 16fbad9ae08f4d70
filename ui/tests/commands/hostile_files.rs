//! Files named by a careless or hostile user: an input may not be a regular file, and an output path may point to something
//! else.
#![cfg(unix)]
use std::{
    fmt::Write as _,
    fs,
    io::Write as _,
    os::unix::fs::{MetadataExt as _, PermissionsExt as _, symlink},
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

/// Long enough for a busy machine; a hang would last for ever.
const HANGS: Duration = Duration::from_mins(2);
/// Maximum length of an error line of ours with a long path in it.
const LINE_MAX: usize = 2500;

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nima"));
    command
        .args(arguments)
        .env("NIMA_DATA_DIR", "/dev/null/no/such/folder")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY");
    command
}

fn nima(arguments: &[&str]) -> Output {
    let mut child =
        command(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > HANGS {
            child.kill().unwrap();
            panic!("{arguments:?} hangs");
        }
        thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap()
}

/// Returns the one line of a command that must fail.
fn refused(arguments: &[&str]) -> String {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?} succeeded");
    assert!(text.lines().count() == 1 && text.len() < LINE_MAX, "{arguments:?}: {} bytes", text.len());
    assert!(!text.contains("panicked") && !text.trim_end().contains(char::is_control), "{arguments:?}: {text}");
    text
}

fn accepted(arguments: &[&str]) {
    let output = nima(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn place(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.place(name).to_str().unwrap().to_owned()
    }

    fn write(&self, name: &str, text: &str) -> String {
        fs::write(self.place(name), text).unwrap();
        self.text(name)
    }

    fn fifo(&self, name: &str) -> String {
        assert!(Command::new("mkfifo").arg(self.place(name)).status().unwrap().success());
        self.text(name)
    }

    fn link(&self, name: &str, to: &str) -> String {
        symlink(to, self.place(name)).unwrap();
        self.text(name)
    }

    fn hard_link(&self, name: &str, to: &str) -> String {
        fs::hard_link(to, self.place(name)).unwrap();
        self.text(name)
    }
}

fn recording() -> String {
    let mut text = "t_s,x_m,fx_n\n".to_owned();
    for i in 0..2000 {
        let t = f64::from(i) * 1e-3;
        let x = 0.01 * (12.6 * t).sin();
        writeln!(text, "{t},{x},{}", 300.0 * x.max(0.0)).unwrap();
    }
    text
}

/// Returns the directions over the whole sphere.
fn directions(count: i32) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let r = (1.0 - z * z).sqrt();
        let turn = 2.4 * f64::from(i);
        [r * turn.cos(), r * turn.sin(), z]
    })
}

/// Returns still poses of a tool of this mass.
fn poses(mass_kg: f64) -> String {
    let mut text = "fx_n,fy_n,fz_n,ax,ay,az\n".to_owned();
    for down in directions(12) {
        let [fx, fy, fz] = down.map(|d| mass_kg * 9.80665 * d);
        let [ax, ay, az] = down.map(|d| -9.80665 * d);
        writeln!(text, "{fx},{fy},{fz},{ax},{ay},{az}").unwrap();
    }
    text
}

fn pairs() -> String {
    let mut text = "f1x_n,f1y_n,f1z_n,f2x_n,f2y_n,f2z_n\n".to_owned();
    for [x, y, z] in directions(12) {
        writeln!(text, "{x},{y},{z},{y},{},{z}", -x).unwrap();
    }
    text
}

fn data_set() -> String {
    let mut text = "fx_n,fz_n,tip_fx_n,tip_fy_n,tip_fz_n\n".to_owned();
    for i in 0..400 {
        let t = f64::from(i) * 0.01;
        let x = (7.0 * t).sin();
        let z = (5.0 * t).cos();
        writeln!(text, "{x},{z},{},{},{}", 0.9 * x, 0.1 * z, 0.8 * z).unwrap();
    }
    text
}

const TRAIN: [&str; 8] = ["train", "tip-force", "--members", "1", "--hidden", "4", "--epochs", "5"];

#[test]
fn inputs_that_are_no_files_or_have_no_end_are_refused_in_one_short_line() {
    let folder = Folder::new();
    let out = folder.text("out");
    fs::File::create(folder.place("hole")).unwrap().set_len(2 << 30).unwrap();
    fs::File::create(folder.place("zeros")).unwrap().set_len(64 << 20).unwrap();
    let long = "\u{1b}[31mx".repeat(100_000);
    let mut inputs = vec![
        folder.fifo("fifo"),
        "/dev/zero".to_owned(),
        folder.text("."),
        folder.text("absent"),
        folder.link("dangling", "nowhere"),
        folder.text("hole"),
        folder.text("zeros"),
        folder.write("header", &format!("{long}\n1\n")),
        folder.write("field", &format!("t_s,x_m,fx_n\n0,{long},0\n")),
        folder.write("key", &format!("{} = 1\n", "k".repeat(900_000))),
        folder.write("variant", &format!("name = \"{}\"\nmode = \"{0}\"\n", "v".repeat(400_000))),
        folder.write("bytes", "\0\u{7f}\u{1b}[2J"),
    ];
    inputs.push(folder.link("to a fifo", &inputs[0]));
    for input in &inputs {
        let input = input.as_str();
        let model = format!("{out}.safetensors");
        let commands: [&[&str]; 9] = [
            &["identify", input, "--out", &out],
            &["calibrate", "gravity", input, "--out", &out],
            &["calibrate", "correspondence", input, "--out", &out],
            &["train", "tip-force", input, "--out", &model],
            &["evaluate", "tip-force", input, input, "--out", &out],
            &["study", "tradeoff", "--quick", "--recording", input, "--out", &out],
            &["study", "tradeoff", "--quick", "--scene", input, "--out", &out],
            &["run", "--virtual", "--seconds", "1", "--scene", input],
            &["run", "--virtual", "--seconds", "1", "--rig", input],
        ];
        for arguments in commands {
            refused(arguments);
            assert!(!Path::new(&out).exists() && !Path::new(&model).exists(), "{arguments:?} wrote something");
        }
    }
}

#[test]
fn a_recording_may_come_through_a_pipe() {
    let run = |text: &str| {
        let mut child = command(&["identify", "/dev/stdin", "--json"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The command may already have rejected the input.
        child.stdin.take().unwrap().write_all(text.as_bytes()).ok();
        child.wait_with_output().unwrap()
    };
    let output = run(&recording());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(figures["samples"], 2000);
    // A pipe with no line breaks.
    let output = run(&"y".repeat(8 << 20));
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("more than 1 MiB"));
}

#[test]
fn no_command_overwrites_what_it_reads() {
    let folder = Folder::new();
    let cases: [(&str, String, &[&str]); 4] = [
        ("r.csv", recording(), &["identify"]),
        ("poses.csv", poses(0.4), &["calibrate", "gravity"]),
        ("pairs.csv", pairs(), &["calibrate", "correspondence"]),
        ("d.csv", data_set(), &TRAIN),
    ];
    for (name, text, arguments) in cases {
        let input = folder.write(name, &text);
        let run = |input: &str, out: &str| {
            [arguments, &[input, "--out", out]].concat().iter().map(|a| (*a).to_owned()).collect::<Vec<_>>()
        };
        let linked = folder.link(&format!("link to {name}"), &input);
        let hard = folder.hard_link(&format!("hard link to {name}"), &input);
        for (input, out) in [(&input, &input), (&input, &linked), (&linked, &input), (&input, &hard)] {
            let all = run(input, out);
            let line = refused(&all.iter().map(String::as_str).collect::<Vec<_>>());
            assert!(line.contains("is the input") && line.contains("itself"), "{line}");
        }
        assert_eq!(fs::read_to_string(&input).unwrap(), text, "{name}");
        // With another output name it succeeds, so the input was good.
        let all = run(&input, &folder.text(&format!("{name}.out")));
        accepted(&all.iter().map(String::as_str).collect::<Vec<_>>());
    }
    // A calibration renames the old file to `.previous`, which may also be the input.
    let previous = folder.write("g.toml.previous", &poses(0.4));
    let out = folder.write("g.toml", "old");
    refused(&["calibrate", "gravity", &previous, "--out", &out]);
    assert_eq!(
        (fs::read_to_string(&previous).unwrap(), fs::read_to_string(&out).unwrap()),
        (poses(0.4), "old".to_owned())
    );
}

#[test]
fn a_folder_of_results_spares_the_inputs_in_it() {
    let folder = Folder::new();
    let data = folder.write("predictions.csv", &data_set());
    let model = folder.text("m.safetensors");
    accepted(&[&TRAIN[..], &[&data, "--out", &model]].concat());
    let line = refused(&["evaluate", "tip-force", &model, &data, "--out", &folder.text(".")]);
    assert!(line.contains("itself"), "{line}");
    assert_eq!(fs::read_to_string(&data).unwrap(), data_set());
    // Write the model through a link that is named like an image.
    let elsewhere = folder.write("e.csv", &data_set());
    fs::create_dir(folder.place("results")).unwrap();
    let before = fs::read(&model).unwrap();
    folder.link("results/regression.svg", &model);
    refused(&["evaluate", "tip-force", &model, &elsewhere, "--out", &folder.text("results")]);
    assert_eq!(fs::read(&model).unwrap(), before);
    let recorded = folder.write("tradeoff.csv", &recording());
    let line = refused(&["study", "tradeoff", "--quick", "--recording", &recorded, "--out", &folder.text(".")]);
    assert!(line.contains("itself"), "{line}");
    assert_eq!(fs::read_to_string(&recorded).unwrap(), recording());
}

#[test]
fn an_existing_output_is_refused_followed_or_keeps_its_mode() {
    let folder = Folder::new();
    let input = folder.write("r.csv", &recording());
    let identify = |out: &str| ["identify", &input, "--out", out].map(str::to_owned);
    let refuse = |out: &str| refused(&identify(out).each_ref().map(String::as_str));
    let fifo = folder.fifo("fifo");
    assert!(refuse(&fifo).contains("a pipe exists and is never replaced"));
    assert!(refuse(&folder.link("to nothing", "nowhere")).contains("a link to a file that does not exist"));
    assert!(refuse(&folder.text(".")).contains("a folder exists"));
    // Only root can create a device like /dev/null.
    let device = folder.text("null");
    if Command::new("mknod")
        .args([&device, "c", "1", "3"])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|made| made.success())
    {
        let before = fs::metadata(&device).unwrap();
        assert!(refuse(&device).contains("a device exists"));
        let after = fs::metadata(&device).unwrap();
        assert_eq!((before.ino(), before.mode()), (after.ino(), after.mode()));
    }
    let target = folder.write("target.csv", "old");
    fs::set_permissions(&target, fs::Permissions::from_mode(0o600)).unwrap();
    let link = folder.link("link.csv", &target);
    accepted(&identify(&link).each_ref().map(String::as_str));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&target).unwrap().mode() & 0o777, 0o600);
    assert!(fs::read_to_string(&target).unwrap().starts_with("t_s,fx_n"));
}

#[test]
fn poses_without_a_weight_make_no_calibration() {
    let folder = Folder::new();
    let out = folder.text("g.toml");
    for mass_kg in [0.0, 0.001] {
        let input = folder.write("poses.csv", &poses(mass_kg));
        let output = nima(&["calibrate", "gravity", &input, "--out", &out]);
        let line = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && line.contains("Poor data: no weight was measured"), "{mass_kg} kg: {line}");
        assert!(!Path::new(&out).exists());
    }
}
