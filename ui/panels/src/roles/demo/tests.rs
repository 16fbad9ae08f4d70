//! Tests of the demonstration on synthetic ticks: its timing, its faults, and who may end a stop.

use nima_core::safety::TransitionCause;
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, Tick},
    rig::Side,
};
use nima_screen::{live::LiveState, outbox::Outbox};
use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};

use super::{DemoState, script::SCRIPT, state::why_not_shown};

const FAULT: Fault = Fault::SourceSilent;
const RATE_HZ: f64 = 30.0;

struct Show {
    live: LiveState,
    demo: DemoState,
    outbox: Outbox,
    tick: Tick,
    rate_hz: f64,
}

impl Show {
    fn of(rig: &str) -> Self {
        let rig = RigConfig::load(rig).unwrap();
        let scene = Scene::load("peg_transfer").unwrap();
        let simulated = RigConfig::load("simulated").unwrap();
        let plan =
            SimulationPlan { rig: simulated, scene: scene.clone(), calibrations: Default::default(), engage: false };
        let mut first = None;
        run_virtual(&plan, 0.01, |tick| {
            first.get_or_insert(*tick);
            None
        })
        .unwrap();
        let tick = Tick { t_s: 0.0, ..first.unwrap() };
        let mut show = Self {
            live: LiveState::new(rig, scene),
            demo: DemoState::default(),
            outbox: Outbox::default(),
            tick,
            rate_hz: RATE_HZ,
        };
        show.enters(LoopState::Engaged, TransitionCause::Agreed);
        show
    }

    fn enters(&mut self, to: LoopState, why: TransitionCause) {
        let side = Side::Right;
        let t_s = self.tick.t_s;
        let from = self.tick.state;
        let raised = match to {
            LoopState::Faulted(fault) => Some(Event::FaultRaised { t_s, side, fault }),
            _ => None,
        };
        let changed = Event::StateChanged { t_s, side, from, to, why };
        self.tick.state = to;
        self.live.replay(raised.iter().chain([&changed]), &[Some(self.tick), None]);
    }

    /// Returns the commands sent in one frame.
    fn frame(&mut self) -> Vec<Command> {
        self.tick.t_s += 1.0 / self.rate_hz;
        self.live.replay([].iter(), &[Some(self.tick), None]);
        self.demo.play(&self.live, false, &mut self.outbox);
        self.outbox.sent()
    }

    /// Returns the commands sent in this time, s.
    fn frames(&mut self, seconds: f64) -> Vec<Command> {
        (0..(seconds * self.rate_hz).round() as usize).flat_map(|_| self.frame()).collect()
    }

    /// Returns a loop that follows commands: its commands within this time, s.
    fn obeyed(&mut self, seconds: f64) -> Vec<(f64, Command)> {
        let began_s = self.tick.t_s;
        let mut asked = Vec::new();
        while self.tick.t_s < began_s + seconds {
            for command in self.frame() {
                asked.push((self.tick.t_s - began_s, command));
                match (command, self.tick.state) {
                    (Command::ReleaseStop, LoopState::Faulted(_) | LoopState::Stopped) => {
                        self.enters(LoopState::Idle, TransitionCause::Asked);
                    }
                    (Command::Engage, LoopState::Idle) => {
                        self.enters(LoopState::Ready, TransitionCause::Asked);
                        self.enters(LoopState::Engaged, TransitionCause::Agreed);
                    }
                    _ => {}
                }
            }
        }
        asked
    }

    fn caption(&self) -> String {
        self.demo.caption(&self.live)
    }

    fn person_stops(&mut self) {
        self.outbox.push(Command::Stop);
        assert_eq!(self.frame(), [Command::Stop], "nothing goes with a stop");
        if !self.tick.state.is_latched() {
            self.enters(LoopState::Stopped, TransitionCause::Asked);
        }
    }

    /// A person presses Release stop, then Engage.
    fn person_engages(&mut self) {
        self.frames(1.0);
        self.enters(LoopState::Idle, TransitionCause::Asked);
        assert!(resumes(&self.frames(30.0)).is_empty(), "it does not engage for a person who has only released a stop");
        self.enters(LoopState::Ready, TransitionCause::Asked);
        self.enters(LoopState::Engaged, TransitionCause::Agreed);
    }
}

/// Returns the commands that lead out of a latch or into an engagement.
fn resumes(commands: &[Command]) -> Vec<Command> {
    let is_way_back =
        |command: &&Command| matches!(command, Command::ReleaseStop | Command::Engage | Command::EngageOne(_));
    commands.iter().filter(is_way_back).copied().collect()
}

/// Returns the start of each chapter of a whole round.
fn began_s(rate_hz: f64) -> Vec<f64> {
    let mut show = Show { rate_hz, ..Show::of("simulated") };
    let mut began_s = Vec::new();
    let mut step = None;
    while began_s.len() <= SCRIPT.len() {
        show.frame();
        if step.replace(show.demo.step) != Some(show.demo.step) {
            began_s.push(show.tick.t_s);
        }
        assert!(show.tick.t_s < 300.0, "{began_s:?}");
    }
    began_s
}

#[test]
fn the_chapters_take_the_same_time_at_every_frame_rate() {
    for rate_hz in [10.0, 32.0, 60.0] {
        let began_s = began_s(rate_hz);
        let round_s: f64 = SCRIPT.iter().map(|step| step.seconds).sum();
        let took_s = began_s[SCRIPT.len()] - began_s[0];
        assert!((took_s - round_s).abs() <= 1.0 / rate_hz + 1e-6, "{rate_hz} Hz: a round of {took_s} s");
        for (step, times_s) in SCRIPT.iter().zip(began_s.windows(2)) {
            let took_s = times_s[1] - times_s[0];
            let off_s = (took_s - step.seconds).abs();
            assert!(off_s <= 1.0 / rate_hz + 1e-6, "{}, {rate_hz} Hz: {took_s} s", step.name);
        }
    }
}

#[test]
fn a_fault_in_each_chapter_is_explained_and_the_chapter_restarts() {
    for (i, step) in SCRIPT.iter().enumerate() {
        let mut show = Show::of("simulated");
        show.demo.go_to(i);
        show.frames(5.0);
        assert!(show.demo.progress() > 0.2 && show.caption().starts_with(step.words.get()), "{}", step.name);
        show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
        show.frame();
        assert!(show.caption().contains("The rig sent no valid data for 20 ms"), "{}", show.caption());
        assert!(show.caption().contains("the chapter restarts in 8 s"), "{}", show.caption());
        let asked = show.obeyed(10.0);
        let at_s = |wanted: Command| asked.iter().find(|(_, command)| *command == wanted).map(|(at_s, _)| *at_s);
        let released_s = at_s(Command::ReleaseStop).unwrap();
        let engaged_s = at_s(Command::Engage).unwrap();
        assert!((7.9..8.1).contains(&released_s) && (released_s..8.3).contains(&engaged_s), "{asked:?}");
        assert!(
            at_s(Command::SetMode(step.mode)).unwrap() > engaged_s && at_s(Command::SetDelay(step.delay_s)).is_some()
        );
        assert_eq!((show.demo.step, show.tick.state), (i, LoopState::Engaged), "{}", step.name);
        assert!(show.demo.progress() < 2.0 / step.seconds, "from its beginning");
        assert!(show.caption().starts_with(step.words.get()), "{}", show.caption());
    }
}

#[test]
fn a_cause_that_is_still_present_is_asked_about_again_and_a_second_fault_is_explained_too() {
    let mut show = Show::of("simulated");
    show.frames(3.0);
    show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
    let refused = resumes(&show.frames(19.0));
    assert_eq!(refused, [Command::ReleaseStop; 6], "every other second from the eighth on");
    assert!(show.caption().contains("as soon as the loop permits it"), "{}", show.caption());
    show.obeyed(3.0);
    assert_eq!(show.tick.state, LoopState::Engaged);
    show.enters(LoopState::Faulted(Fault::SamplesLost), TransitionCause::Fault);
    show.frame();
    assert!(show.caption().contains("the chapter restarts in 8 s"), "{}", show.caption());
}

#[test]
fn a_persons_stop_stays() {
    let mut show = Show::of("simulated");
    show.frames(3.0);
    show.person_stops();
    assert!(resumes(&show.frames(60.0)).is_empty());
    assert!(show.caption().contains("waits until you press Release stop"), "{}", show.caption());
    show.person_engages();
    show.frames(3.0);
    show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
    assert_eq!(resumes(&show.frames(8.1)), [Command::ReleaseStop], "a fault after that is one again");
}

#[test]
fn a_stop_under_a_fault_stays_although_the_loop_still_tells_the_fault() {
    for before_s in [0.1, 4.0, 7.9, 9.0] {
        let mut show = Show::of("simulated");
        show.frames(3.0);
        show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
        show.frames(before_s);
        show.person_stops();
        assert!(resumes(&show.frames(60.0)).is_empty(), "{before_s} s");
        assert!(show.caption().contains("Stop was pressed"), "{}", show.caption());
        show.person_engages();
        show.frames(3.0);
        show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
        assert_eq!(resumes(&show.frames(8.1)), [Command::ReleaseStop]);
    }
}

#[test]
fn a_stop_in_the_moment_of_the_fault_stays() {
    let mut show = Show::of("simulated");
    show.frames(3.0);
    show.outbox.push(Command::Stop);
    show.frame();
    show.frame();
    show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
    assert!(resumes(&show.frames(60.0)).is_empty());
}

#[test]
fn what_a_person_put_to_rest_rests_and_what_the_governor_ended_restarts() {
    let mut show = Show::of("simulated");
    show.frames(3.0);
    show.enters(LoopState::Idle, TransitionCause::Asked);
    assert!(resumes(&show.frames(60.0)).is_empty());
    for (why, cause) in
        [(TransitionCause::Absent, "no hand on the handle"), (TransitionCause::Late, "did not engage in time")]
    {
        let mut show = Show::of("simulated");
        show.frames(3.0);
        show.enters(LoopState::Idle, why);
        show.frame();
        assert!(show.caption().contains(cause), "{}", show.caption());
        show.obeyed(10.0);
        assert_eq!(show.tick.state, LoopState::Engaged);
    }
}

#[test]
fn no_other_rig_and_no_fault_from_before_is_released() {
    for rig in ["emulated", "desk", "haply-desk", "paper"] {
        let mut show = Show::of(rig);
        show.frames(3.0);
        show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
        assert!(resumes(&show.frames(60.0)).is_empty(), "{rig}");
    }
    let mut show = Show::of("emulated");
    show.frames(3.0);
    show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
    show.frame();
    assert!(show.caption().contains("20 ms") && show.caption().contains("Press Release stop"), "{}", show.caption());
    let mut show = Show::of("simulated");
    show.enters(LoopState::Faulted(FAULT), TransitionCause::Fault);
    assert!(show.frames(60.0).is_empty(), "a technician may be looking at it");
}

#[test]
fn chapters_that_need_a_simulated_hand_are_skipped_on_a_rig_with_devices() {
    let mut show = Show::of("emulated");
    let mut steps = vec![show.demo.step];
    // Less than the shortest chapter, for more than a whole round.
    for _ in 0..150 {
        show.frames(1.0);
        if !steps.contains(&show.demo.step) {
            steps.push(show.demo.step);
        }
    }
    assert_eq!(steps, [0, 1, 2, 3, 4, 5], "neither letting go nor driving by mouse");
    let your_turn = &SCRIPT[SCRIPT.len() - 1];
    assert!(why_not_shown(&show.live, your_turn).is_some_and(|why| why.contains("simulated hand")));
    assert_eq!(why_not_shown(&Show::of("simulated").live, your_turn), None);
}

#[test]
fn a_pause_of_the_window_shows_the_next_chapter_and_no_later_one() {
    let mut show = Show::of("simulated");
    show.frames(5.0);
    show.tick.t_s += 100.0;
    show.frames(13.0);
    assert_eq!(show.demo.step, 1);
    show.frames(2.0);
    assert_eq!(show.demo.step, 2);
}
