//! A person at mouse and keyboard of the real window, who plays with rings.
//!
//! The player is given the board and the camera pose, and sees the rest: the tip by the circle and the line below it, a ring
//! by its colour, and a ring in the jaws by a second circle.
#![cfg(target_os = "linux")]
use std::{
    path::PathBuf,
    process::Command,
    thread,
    time::{Duration, Instant},
};

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use nalgebra::Vector3;
use nima_machine::rig::{SIDES, Side};
use nima_screen::scene3d::SceneCamera;
use nima_simulation::scene::Scene;

use crate::{
    console::{Console, read},
    same_window::{SameWindow, WINDOW},
    server::Xvfb,
    sight::{Picture, around, is_green, is_of_ring},
};

/// Distance from its target within which the tip has arrived, points, and timeout of a player who waits for it.
const NEAR: f32 = 3.0;
const PATIENCE: Duration = Duration::from_secs(12);
const LOOKS_AGAIN: Duration = Duration::from_secs(2);
/// From the centre of a ring to the centre of its tube, m.
const RIM_M: f32 = 0.00725;
/// Heights of the tip, m: with an empty hand and with a ring above the pegs, above a ring in the other hand, at a ring on the
/// board, and at the release of a ring over its peg.
const PARKED_M: f32 = 0.060;
const CARRIED_M: f32 = 0.037;
const OVER_RING_M: f32 = 0.058;
const LOW_M: f32 = 0.001;
const LET_GO_M: f32 = 0.015;
/// Height of the centre of a ring on the board, m, and maximum distance from its peg's centre at which a ring is seen, m.
const LIES_M: f32 = 0.00175;
const AROUND_M: f32 = 0.0135;

pub(crate) struct Player<'a> {
    console: Console<'a>,
    scene: Scene,
    camera: SceneCamera,
    /// The operating field in the window.
    view: Rect,
    led: Side,
    /// Target positions of the tips, m, and the last drag positions.
    position_m: [Vector3<f32>; SIDES],
    goal: [Option<[f32; 2]>; SIDES],
    /// Pending commands for `xdotool`.
    steps: Vec<String>,
}

impl<'a> Player<'a> {
    pub(crate) fn begin(x: &'a Xvfb) -> Self {
        let mut same = SameWindow::open("rings", "technician", |app| app);
        let view = same.rect("Operating field");
        let engage = same.next_step();
        drop(same);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("console.json"), r#"{"toured":true}"#).unwrap();
        let rig = include_str!("../../../config/rigs/simulated.toml").replace("\"best\"", "\"matched\"");
        std::fs::write(folder.path().join("rig.toml"), rig).unwrap();
        let rig = folder.path().join("rig.toml").display().to_string();
        let options = ["--rig", &rig, "--scene", "rings", "--role", "technician", "--at-rest"];
        let console = Console::begin(x, folder, &options);
        let scene = Scene::load("rings").unwrap();
        let camera = SceneCamera::of(&scene);
        let position_m = [Vector3::zeros(); SIDES];
        let goal = [None; SIDES];
        let led = Side::Right;
        let steps = Vec::new();
        let mut player = Self { console, scene, camera, view, led, position_m, goal, steps };
        player.keys("m", 1);
        player.perform();
        thread::sleep(Duration::from_millis(300));
        player.console.click(engage);
        for _ in Side::ALL {
            player.find_tip();
            player.change();
            player.perform();
        }
        player
    }

    fn image(&self, part: Rect) -> Picture {
        let part = part.intersect(Rect::from_min_size(Pos2::ZERO, WINDOW.into()));
        let corner = part.min.round();
        let size = part.size().round();
        let crop = format!("{}x{}+{}+{}", size.x, size.y, corner.x, corner.y);
        let mut import = self.console.x.command("import");
        // Use one thread only, because the loop needs the other processors.
        import.env("MAGICK_THREAD_LIMIT", "1");
        let rgb = import.args(["-window", "root", "-crop", &crop, "-depth", "8", "rgb:-"]).output().unwrap().stdout;
        assert_eq!(rgb.len(), 3 * size.x as usize * size.y as usize, "{crop}");
        Picture { corner, width: size.x as usize, rgb }
    }

    fn place(&self, position_m: &Vector3<f32>) -> Pos2 {
        self.camera.project(position_m, self.view).unwrap()
    }

    fn level(&self, place: Pos2, height_m: f32) -> Vector3<f32> {
        self.camera.on_level(place, self.view, height_m).unwrap()
    }

    fn at(&self) -> Vector3<f32> {
        self.position_m[self.led.index()]
    }

    /// Finds the tip, which is on its own side: the line below it ends on the board.
    fn find_tip(&mut self) {
        let began = Instant::now();
        self.position_m[self.led.index()] = loop {
            let image = self.image(self.view);
            let green = image.places(is_green);
            let lowest = green.iter().copied().max_by(|one, other| one.y.total_cmp(&other.y));
            let is_right = self.led == Side::Right;
            let mark = image.mark().filter(|(tip, _)| (tip.x > self.view.center().x) == is_right);
            if let Some(((tip, _), lowest)) = mark.zip(lowest) {
                // Half of the mark below.
                let foot_m = self.level(lowest - vec2(0.0, 2.0), 0.0);
                let height = |z: f32| (self.place(&Vector3::new(foot_m.x, foot_m.y, z)).y - tip.y).abs();
                let heights = (0..1000).map(|i| 0.0001 * i as f32);
                let z = heights.min_by(|one, other| height(*one).total_cmp(&height(*other))).unwrap_or_default();
                break self.level(tip, z);
            }
            assert!(began.elapsed() < PATIENCE, "there is no circle around the tip of the {} side", self.led.word());
            thread::sleep(Duration::from_millis(100));
        };
    }

    /// Queues commands for `xdotool`, which [`Self::perform`] runs: one process, not dozens.
    fn tool(&mut self, steps: &[&str]) {
        self.steps.extend(steps.iter().map(|step| (*step).to_owned()));
    }

    fn keys(&mut self, key: &str, times: usize) {
        if times > 0 {
            self.tool(&["key", "--delay", "1"]);
            self.steps.extend(std::iter::repeat_n(key.to_owned(), times));
        }
    }

    fn perform(&mut self) {
        let steps = std::mem::take(&mut self.steps);
        if !steps.is_empty() {
            assert!(self.console.x.command("xdotool").args(&steps).status().unwrap().success(), "{steps:?}");
        }
    }

    /// Drives the other instrument.
    pub(crate) fn change(&mut self) {
        self.keys("h", 1);
        self.led = self.led.other();
    }

    /// Opens or closes the jaws.
    pub(crate) fn jaws(&mut self) {
        self.keys("g", 1);
    }

    fn height(&mut self, to_m: f32) {
        let steps = ((to_m - self.at().z) * 1e3).round();
        self.keys(if steps > 0.0 { "Page_Up" } else { "Page_Down" }, steps.abs() as usize);
        self.position_m[self.led.index()].z += steps * 1e-3;
    }

    /// Drags the tip to this position, at its height.
    pub(crate) fn drag(&mut self, [x, y]: [f32; 2]) {
        let position_m = self.at();
        self.goal[self.led.index()] = Some([x, y]);
        let from = self.place(&position_m);
        let way = (self.place(&Vector3::new(x, y, position_m.z)) - from).round();
        if way == Vec2::ZERO {
            return;
        }
        // Within the view, and away from its buttons.
        let inside = self.view.shrink(60.0);
        let room = Rect::from_min_max(inside.min - way.min(Vec2::ZERO), inside.max - way.max(Vec2::ZERO));
        let press = from.clamp(room.min, room.max).round();
        let to = press + way;
        let word = |number: f32| format!("{number:.0}");
        for (place, then) in [(press, "mousedown"), (press + 0.5 * way, ""), (to, "mouseup")] {
            self.tool(&["mousemove", &word(place.x), &word(place.y)]);
            if !then.is_empty() {
                self.tool(&[then, "1"]);
            }
        }
        self.position_m[self.led.index()] = self.level(from + way, position_m.z);
    }

    /// Performs the queued commands and waits until the tip has arrived, and holds a ring or not as expected.
    pub(crate) fn settle(&mut self, what: &str, holds: bool) {
        self.perform();
        let began = Instant::now();
        let mut looked = Instant::now();
        loop {
            let wanted = self.place(&self.at());
            let seen = self.image(Rect::from_center_size(wanted, Vec2::splat(80.0))).mark();
            if seen.is_some_and(|(tip, held)| held == holds && tip.distance(wanted) < NEAR) {
                return;
            }
            if looked.elapsed() > LOOKS_AGAIN {
                self.look_again();
                looked = Instant::now();
            }
            if began.elapsed() > PATIENCE {
                let anywhere = self.image(self.view).mark();
                self.keep_image();
                panic!(
                    "{what}, {} side: wanted at {wanted:?}, holding {holds}; seen there {seen:?}, anywhere {anywhere:?}",
                    self.led.word()
                );
            }
        }
    }

    /// Drags the tip once more if it is not at its drag position.
    fn look_again(&mut self) {
        let mark = self.image(self.view).mark();
        let goal = self.goal[self.led.index()];
        if let Some(((tip, _), goal)) = mark.zip(goal) {
            self.position_m[self.led.index()] = self.level(tip, self.at().z);
            self.drag(goal);
            self.perform();
        }
    }

    pub(crate) fn keep_image(&self) {
        self.console.keep_image("playing");
    }

    /// Returns the outer rim of a ring with its centre here, seen from a side.
    pub(crate) fn rim(side: Side, [x, y]: [f32; 2]) -> [f32; 2] {
        [if side == Side::Left { x - RIM_M } else { x + RIM_M }, y]
    }

    fn peg(&self, number: usize) -> [f32; 2] {
        self.scene.objects.as_ref().unwrap().pegs.position_m[number].map(|m| m as f32)
    }

    /// Returns the centre of the ring around this peg.
    fn ring_around(&mut self, peg: [f32; 2]) -> [f32; 2] {
        for _ in 0..4 {
            if let Some(ring) = self.sees_ring(peg) {
                return ring;
            }
            thread::sleep(Duration::from_millis(600));
        }
        self.keep_image();
        panic!("no ring lies around the peg at {peg:?} m");
    }

    fn sees_ring(&self, [x, y]: [f32; 2]) -> Option<[f32; 2]> {
        let foot_m = Vector3::new(x, y, LIES_M);
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
        let corners = corners.map(|[right, away]| self.place(&(foot_m + Vector3::new(right, away, 0.0) * AROUND_M)));
        let orange = self.image(Rect::from_points(&corners)).places(is_of_ring);
        let on_board = orange.iter().map(|place| self.level(*place, LIES_M) - foot_m);
        let near: Vec<Pos2> =
            on_board.filter(|from_foot_m| from_foot_m.norm() < AROUND_M).map(|from| pos2(from.x, from.y)).collect();
        let ring = around(&near).filter(|ring| (0.015..0.021).contains(&ring.width()))?;
        Some([x + ring.center().x, y + ring.center().y])
    }

    /// Takes a ring from its peg: with open jaws, from above the pegs.
    pub(crate) fn take(&mut self, side: Side, peg: usize) {
        assert_eq!(self.led, side);
        self.perform();
        let ring = self.ring_around(self.peg(peg));
        self.height(CARRIED_M);
        self.drag(Self::rim(side, ring));
        self.settle("above the ring", false);
        self.height(LOW_M);
        self.settle("around the ring", false);
        self.jaws();
        self.settle("closed", true);
        self.height(CARRIED_M);
        self.settle("lifted", true);
    }

    /// Passes a ring: the other hand waits in the middle with open jaws, and takes the ring that is brought there.
    fn hand_over(&mut self) {
        self.drag(Self::rim(self.led, [0.0, 0.0]));
        self.settle("in the middle", true);
        self.change();
        self.height(CARRIED_M);
        self.settle("around the ring in the middle", false);
        self.jaws();
        self.settle("closed in the middle", true);
        self.change();
        self.jaws();
        self.settle("let go in the middle", false);
        self.height(OVER_RING_M);
        self.settle("out of the way", false);
        self.change();
    }

    fn put(&mut self, peg: [f32; 2]) {
        self.drag(Self::rim(self.led, peg));
        self.settle("above the peg", true);
        self.height(LET_GO_M);
        self.settle("over the peg", true);
        self.jaws();
        self.settle("let go", false);
        self.height(CARRIED_M);
    }

    /// Moves both hands above the middle, with open jaws; the one of this side is driven.
    pub(crate) fn get_ready(&mut self, first: Side) {
        for side in [first.other(), first] {
            if self.led != side {
                self.change();
            }
            self.height(PARKED_M);
            self.settle("parked", false);
            self.drag(Self::rim(side, [0.0, 0.0]));
            self.height(OVER_RING_M);
            self.settle("ready", false);
        }
    }

    /// Moves a ring from a peg to another on the other side.
    pub(crate) fn over(&mut self, giver: Side, from: usize, to: usize) {
        if self.led != giver {
            self.change();
        }
        self.take(giver, from);
        self.hand_over();
        self.put(self.peg(to));
        // Move back to where it will take the next ring.
        let taker = giver.other();
        self.height(OVER_RING_M);
        self.drag(Self::rim(taker, [0.0, 0.0]));
        self.settle("back in the middle", false);
    }

    /// Closes the window and returns the score of the recorded session.
    pub(crate) fn end(mut self) -> serde_json::Value {
        thread::sleep(Duration::from_millis(1200));
        let summary = self.console.end();
        let states = summary["screen"]["states"].to_string();
        assert!(!states.contains("Fault"), "the loop ended in a fault: {states}");
        let sessions = self.console.folder.path().join("sessions");
        let paths = std::fs::read_dir(sessions).unwrap().map(|entry| entry.unwrap().path());
        let paths: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|of| of == "mcap")).collect();
        assert_eq!(paths.len(), 1, "{paths:?}");
        let score = Command::new(env!("CARGO_BIN_EXE_nima")).arg("score").args(&paths).arg("--json").output().unwrap();
        assert!(score.status.success(), "{}", String::from_utf8_lossy(&score.stderr));
        let out = self.console.folder.path().join("score.json");
        std::fs::write(&out, score.stdout).unwrap();
        read(&out)
    }
}
