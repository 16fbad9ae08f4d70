//! The interlock: one explicit state machine per arm pair. Only this machine permits force and motion.
//!
//! Input: the operator's requests ([`InterlockRequest`]), observations of the machine ([`InterlockInput`]), faults.
//! Out: the [`InterlockState`], its permissions ([`Permits`]) and every [`StateChange`] with its reason. Time (s) is an
//! argument. The types encode the legal transitions: each state is a value with methods for its legal successors only,
//! so that an illegal transition does not compile.
//!
//! ```text
//! Disconnected ⇄ Idle → Ready → Engaged ⇄ Clutched        from everywhere: Stopped
//!                  ↑______|________|__________|           from Idle on:    Faulted
//!                  └── release ── Stopped, Faulted
//! ```
//! Nothing resumes by itself: a device that returns leads to `Idle`, regardless of earlier requests; leaving a stop or
//! a fault requires a release and a new engagement. The clutch is the only exception, because the operator's own foot
//! controls it.

/// Maximum time for the drives to respond, s, before `Ready` gives up. Design choice.
/// A larger value keeps the drives on longer without a hand that agrees; a smaller one fails arms that release their
/// brakes slowly.
pub const READY_WITHIN_S: f64 = 2.0;

/// State of an arm pair; `F` is the cause of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InterlockState<F> {
    /// A device of the force path is missing.
    Disconnected,
    /// All devices deliver data. Drives off.
    Idle,
    /// Drives on, at rest and without force, until hand and tip agree.
    Ready,
    /// Following and rendering.
    Engaged,
    /// The hand moves freely, the follower is at rest, without force.
    Clutched,
    Stopped,
    /// Stopped by a fault; latched.
    Faulted(F),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Permits {
    pub drives: bool,
    /// The follower may move, the hand may feel force.
    pub coupled: bool,
}

impl<F: Copy> InterlockState<F> {
    pub const fn permits(self) -> Permits {
        Permits {
            // A clutched follower stays in place with its drives on.
            drives: matches!(self, Self::Ready | Self::Engaged | Self::Clutched),
            coupled: matches!(self, Self::Engaged),
        }
    }

    /// Returns whether leaving this state requires a release.
    pub const fn is_latched(self) -> bool {
        matches!(self, Self::Stopped | Self::Faulted(_))
    }

    /// Returns the word for the screen.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Disconnected => "No device",
            Self::Idle => "Idle",
            Self::Ready => "Ready",
            Self::Engaged => "Engaged",
            Self::Clutched => "Clutched",
            Self::Stopped => "Stopped",
            Self::Faulted(_) => "Fault",
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each with its own reader")]
pub struct InterlockInput {
    pub connected: bool,
    pub powered: bool,
    /// Hand and tip agree, and the force at the tip is known.
    pub agreed: bool,
    /// A hand holds the handle; true if that cannot be detected.
    pub present: bool,
    pub clutch: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InterlockRequest {
    Engage,
    /// End motion and force, without a latch.
    Rest,
    /// Enter the safe state, latched.
    Stop,
    /// Leave the latch.
    Release,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransitionCause {
    Asked,
    Connected,
    Disconnected,
    /// The drives respond, and hand and tip agree.
    Agreed,
    Clutch,
    Late,
    Absent,
    /// A check or a device failed; the new state names the cause.
    Fault,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateChange<F> {
    pub from: InterlockState<F>,
    pub to: InterlockState<F>,
    pub why: TransitionCause,
}

/// States as values with methods for their legal successors.
mod legal {
    macro_rules! state {
        ($name:ident $(, $method:ident => $next:ident)*) => {
            #[derive(Clone, Copy, Debug)]
            pub(super) struct $name(());
            impl $name {
                $(pub(super) const fn $method(self) -> $next { $next(()) })*
            }
        };
    }
    state!(Disconnected, connect => Idle, stop => Stopped);
    state!(Idle, disconnect => Disconnected, power => Ready, stop => Stopped, fail => Faulted);
    state!(Ready, disconnect => Disconnected, rest => Idle, engage => Engaged, stop => Stopped, fail => Faulted);
    state!(Engaged, rest => Idle, clutch => Clutched, stop => Stopped, fail => Faulted);
    state!(Clutched, rest => Idle, unclutch => Engaged, stop => Stopped, fail => Faulted);
    state!(Stopped, release => Idle);
    state!(Faulted, release => Idle);

    /// The initial state, and the only one that can be constructed.
    pub(super) const BEGIN: Idle = Idle(());
}

#[derive(Clone, Copy, Debug)]
enum InterlockPhase<F> {
    Disconnected(legal::Disconnected),
    Idle(legal::Idle),
    Ready(legal::Ready),
    Engaged(legal::Engaged),
    Clutched(legal::Clutched),
    Stopped(legal::Stopped),
    Faulted(legal::Faulted, F),
}

/// The state machine of one arm pair.
///
/// ```
/// use nima_core::safety::{Interlock, InterlockInput, InterlockState, InterlockRequest};
///
/// let mut machine = Interlock::<&str>::default();
/// let healthy = InterlockInput { connected: true, powered: true, agreed: true, present: true, clutch: false };
/// machine.ask(InterlockRequest::Engage, 0.0)?;
/// machine.step(&healthy, 0.001);
/// assert_eq!(machine.state(), InterlockState::Engaged);
///
/// machine.fail("the sensor is silent");
/// machine.step(&healthy, 0.002);
/// assert_eq!(machine.state(), InterlockState::Faulted("the sensor is silent"), "nothing resumes by itself");
/// assert!(machine.ask(InterlockRequest::Engage, 0.003).is_err());
/// machine.ask(InterlockRequest::Release, 0.004)?;
/// assert_eq!(machine.state(), InterlockState::Idle);
/// # Ok::<(), nima_core::safety::InvalidRequest>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Interlock<F> {
    at: InterlockPhase<F>,
    ready_until_s: f64,
}

impl<F: Copy> Default for Interlock<F> {
    fn default() -> Self {
        Self { at: InterlockPhase::Idle(legal::BEGIN), ready_until_s: 0.0 }
    }
}

impl<F: Copy> Interlock<F> {
    pub const fn state(&self) -> InterlockState<F> {
        match self.at {
            InterlockPhase::Disconnected(_) => InterlockState::Disconnected,
            InterlockPhase::Idle(_) => InterlockState::Idle,
            InterlockPhase::Ready(_) => InterlockState::Ready,
            InterlockPhase::Engaged(_) => InterlockState::Engaged,
            InterlockPhase::Clutched(_) => InterlockState::Clutched,
            InterlockPhase::Stopped(_) => InterlockState::Stopped,
            InterlockPhase::Faulted(_, fault) => InterlockState::Faulted(fault),
        }
    }

    const fn go(&mut self, at: InterlockPhase<F>, why: TransitionCause) -> StateChange<F> {
        let from = self.state();
        self.at = at;
        StateChange { from, to: self.state(), why }
    }

    /// Carries out a request, if this state allows it.
    ///
    /// # Errors
    /// [`InvalidRequest`] if the state does not allow the request.
    pub fn ask(&mut self, wish: InterlockRequest, now_s: f64) -> Result<Option<StateChange<F>>, InvalidRequest> {
        let next = match (wish, self.at) {
            // The safe state is reachable from everywhere; a fault stays visible under a latched stop.
            (InterlockRequest::Stop, InterlockPhase::Stopped(_) | InterlockPhase::Faulted(..)) => return Ok(None),
            // No request for a stop is refused, whatever the state; the machine then needs a release.
            (InterlockRequest::Stop, InterlockPhase::Disconnected(at)) => InterlockPhase::Stopped(at.stop()),
            (InterlockRequest::Stop, InterlockPhase::Idle(at)) => InterlockPhase::Stopped(at.stop()),
            (InterlockRequest::Stop, InterlockPhase::Ready(at)) => InterlockPhase::Stopped(at.stop()),
            (InterlockRequest::Stop, InterlockPhase::Engaged(at)) => InterlockPhase::Stopped(at.stop()),
            (InterlockRequest::Stop, InterlockPhase::Clutched(at)) => InterlockPhase::Stopped(at.stop()),
            (InterlockRequest::Engage, InterlockPhase::Idle(at)) => {
                self.ready_until_s = now_s + READY_WITHIN_S;
                InterlockPhase::Ready(at.power())
            }
            (InterlockRequest::Rest, InterlockPhase::Ready(at)) => InterlockPhase::Idle(at.rest()),
            (InterlockRequest::Rest, InterlockPhase::Engaged(at)) => InterlockPhase::Idle(at.rest()),
            (InterlockRequest::Rest, InterlockPhase::Clutched(at)) => InterlockPhase::Idle(at.rest()),
            // Both lead to `Idle`, never to `Engaged`: nothing resumes by itself.
            (InterlockRequest::Release, InterlockPhase::Stopped(at)) => InterlockPhase::Idle(at.release()),
            (InterlockRequest::Release, InterlockPhase::Faulted(at, _)) => InterlockPhase::Idle(at.release()),
            (InterlockRequest::Engage | InterlockRequest::Rest | InterlockRequest::Release, _) => {
                return Err(InvalidRequest);
            }
        };
        Ok(Some(self.go(next, TransitionCause::Asked)))
    }

    /// Reports a fault. The first fault is kept; a stop remains a stop.
    pub const fn fail(&mut self, fault: F) -> Option<StateChange<F>> {
        let next = match self.at {
            InterlockPhase::Idle(at) => at.fail(),
            InterlockPhase::Ready(at) => at.fail(),
            InterlockPhase::Engaged(at) => at.fail(),
            InterlockPhase::Clutched(at) => at.fail(),
            // A missing device is not faulty, and a second fault would hide the first cause.
            InterlockPhase::Disconnected(_) | InterlockPhase::Stopped(_) | InterlockPhase::Faulted(..) => return None,
        };
        Some(self.go(InterlockPhase::Faulted(next, fault), TransitionCause::Fault))
    }

    /// Evaluates the observations of a tick.
    ///
    /// The loss of a device while engaged is a fault that the caller reports with its cause through
    /// [`Interlock::fail`]; the same applies to drives that no longer respond.
    pub fn step(&mut self, seen: &InterlockInput, now_s: f64) -> Option<StateChange<F>> {
        let in_time = now_s <= self.ready_until_s;
        let (next, why) = match self.at {
            InterlockPhase::Disconnected(at) if seen.connected => {
                (InterlockPhase::Idle(at.connect()), TransitionCause::Connected)
            }
            InterlockPhase::Idle(at) if !seen.connected => {
                (InterlockPhase::Disconnected(at.disconnect()), TransitionCause::Disconnected)
            }
            InterlockPhase::Ready(at) if !seen.connected => {
                (InterlockPhase::Disconnected(at.disconnect()), TransitionCause::Disconnected)
            }
            // Not while the clutch is pressed: the agreement of hand and tip would end with its release.
            InterlockPhase::Ready(at) if seen.powered && seen.agreed && seen.present && !seen.clutch => {
                (InterlockPhase::Engaged(at.engage()), TransitionCause::Agreed)
            }
            // NaN does not count as in time.
            InterlockPhase::Ready(at) if !in_time => (InterlockPhase::Idle(at.rest()), TransitionCause::Late),
            // A hand that left is not a fault: the operator engages again without a release.
            InterlockPhase::Engaged(at) if !seen.present => (InterlockPhase::Idle(at.rest()), TransitionCause::Absent),
            InterlockPhase::Engaged(at) if seen.clutch => {
                (InterlockPhase::Clutched(at.clutch()), TransitionCause::Clutch)
            }
            InterlockPhase::Clutched(at) if !seen.present => (InterlockPhase::Idle(at.rest()), TransitionCause::Absent),
            InterlockPhase::Clutched(at) if !seen.clutch && seen.agreed && seen.powered => {
                (InterlockPhase::Engaged(at.unclutch()), TransitionCause::Clutch)
            }
            _ => return None,
        };
        Some(self.go(next, why))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidRequest;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ALL_WELL: InterlockInput =
        InterlockInput { connected: true, powered: true, agreed: true, present: true, clutch: false };

    fn engaged() -> Interlock<u8> {
        let mut interlock = Interlock::default();
        interlock.ask(InterlockRequest::Engage, 0.0).unwrap();
        interlock.step(&ALL_WELL, 0.0);
        assert_eq!(interlock.state(), InterlockState::Engaged);
        interlock
    }

    #[test]
    fn the_way_back_from_a_latch_takes_a_release_and_a_new_engagement() {
        for fault in [false, true] {
            let mut interlock = engaged();
            if fault {
                interlock.fail(7);
                assert_eq!(interlock.fail(8), None, "the first cause stays");
                assert_eq!(interlock.ask(InterlockRequest::Stop, 0.0), Ok(None));
                assert_eq!(interlock.state(), InterlockState::Faulted(7), "also under a stop");
            } else {
                interlock.ask(InterlockRequest::Stop, 0.0).unwrap();
                assert_eq!(interlock.fail(7), None);
            }
            assert_eq!(interlock.ask(InterlockRequest::Engage, 0.0), Err(InvalidRequest));
            for _ in 0..5000 {
                assert_eq!(interlock.step(&ALL_WELL, 1.0), None);
            }
            interlock.ask(InterlockRequest::Release, 1.0).unwrap();
            assert_eq!(interlock.step(&ALL_WELL, 1.0), None);
            assert_eq!(interlock.state(), InterlockState::Idle);
        }
    }

    #[test]
    fn what_went_away_comes_back_as_idle() {
        let mut interlock = Interlock::<u8>::default();
        interlock.ask(InterlockRequest::Engage, 0.0).unwrap();
        interlock.step(&InterlockInput { connected: false, ..ALL_WELL }, 0.0);
        assert_eq!(interlock.state(), InterlockState::Disconnected);
        assert_eq!(interlock.ask(InterlockRequest::Engage, 0.0), Err(InvalidRequest));
        interlock.step(&ALL_WELL, 0.1);
        assert_eq!(interlock.step(&ALL_WELL, 0.2), None);
        assert_eq!(interlock.state(), InterlockState::Idle);
    }

    #[test]
    fn drives_that_do_not_obey_in_time_are_given_up() {
        let mut interlock = Interlock::<u8>::default();
        interlock.ask(InterlockRequest::Engage, 1.0).unwrap();
        let asleep = InterlockInput { powered: false, ..ALL_WELL };
        assert_eq!(interlock.step(&asleep, 1.0 + READY_WITHIN_S), None);
        let change = interlock.step(&asleep, 1.001 + READY_WITHIN_S).unwrap();
        assert_eq!((change.to, change.why), (InterlockState::Idle, TransitionCause::Late));
    }

    #[test]
    fn the_clutch_uncouples_and_couples_and_an_absent_hand_ends_it() {
        let mut interlock = engaged();
        let pressed = InterlockInput { clutch: true, ..ALL_WELL };
        interlock.step(&pressed, 0.0);
        assert_eq!(interlock.state().permits(), Permits { drives: true, coupled: false });
        interlock.step(&ALL_WELL, 0.0);
        assert_eq!(interlock.state(), InterlockState::Engaged);
        let change = interlock.step(&InterlockInput { present: false, ..ALL_WELL }, 0.0).unwrap();
        assert_eq!((change.to, change.why), (InterlockState::Idle, TransitionCause::Absent));
    }

    proptest! {
        #[test]
        fn force_and_motion_follow_an_engagement_only(steps in prop::collection::vec((0_u8..7, any::<[bool; 5]>()), 1..300)) {
            let mut interlock = Interlock::<u8>::default();
            // Whether engagement has been requested since the last event that ends it.
            let mut wanted = false;
            for (k, (what, seen)) in steps.into_iter().enumerate() {
                let now_s = k as f64;
                match what {
                    0 => wanted |= interlock.ask(InterlockRequest::Engage, now_s).is_ok(),
                    1 => { interlock.ask(InterlockRequest::Rest, now_s).ok(); }
                    2 => { interlock.ask(InterlockRequest::Stop, now_s).ok(); }
                    3 => { interlock.ask(InterlockRequest::Release, now_s).ok(); }
                    4 => { interlock.fail(1); }
                    _ => {
                        let [connected, powered, agreed, present, clutch] = seen;
                        interlock.step(&InterlockInput { connected, powered, agreed, present, clutch }, now_s);
                    }
                }
                let state = interlock.state();
                wanted &= matches!(state, InterlockState::Ready | InterlockState::Engaged | InterlockState::Clutched);
                prop_assert!(!state.permits().drives || wanted, "{state:?} without being asked");
                if what == 2 {
                    prop_assert!(state.is_latched());
                }
            }
        }
    }
}
