//! The line to the machine with the arm.

pub(in crate::console) const LINK: &str = "link to the follower's machine";
pub(in crate::console) const ONE_MACHINE: &str = "Handle and arm are at this machine";
pub(in crate::console) const HOW_TWO: &str = "For an arm at another machine start nima follower there and nima console --follower HOST here. The panel Feedback sets the delay of the simulated link.";
pub(in crate::console) const NOT_IN_SESSIONS: &str = "A session does not hold the figures of the network";
pub(in crate::console) const NOTHING_YET: &str = "The link has not reported yet";
pub(in crate::console) const HOLDS: &str = "This console holds the follower";
pub(in crate::console) const ASKED: &str = "Another console asks for the follower";
pub(in crate::console) const WAITS: &str = "This console does not hold the follower";
pub(in crate::console) const ASKS: &str = "Asked for control; waiting for the other console's answer";
pub(in crate::console) const DENIED: &str = "The other console keeps the follower";
pub(in crate::console) const CONTROL_HOVER: &str =
    "One console at a time commands the follower. Another one gets it only if the first consents.";
pub(in crate::console) const ASK: &str = "Ask for control";
pub(in crate::console) const ASK_HOVER: &str =
    "The user of the console that holds the follower is asked. Nothing moves: after consent you engage here.";
pub(in crate::console) const WITHDRAW: &str = "Withdraw the question";
pub(in crate::console) const WITHDRAW_HOVER: &str = "The other console is not asked any more";
pub(in crate::console) const GIVE: &str = "Give control";
pub(in crate::console) const GIVE_HOVER: &str =
    "The other console commands the follower from now on; this one can ask for it again";
pub(in crate::console) const GIVE_AT_REST: &str = "Stop and release first: an engaged arm stays here";
pub(in crate::console) const KEEP: &str = "Keep control";
pub(in crate::console) const KEEP_HOVER: &str = "The other console is told that you keep the follower";
pub(in crate::console) const CONTROL_ASKED_CAUSE: &str = "Another console asks for control of the follower";
pub(in crate::console) const CONTROL_ASKED_CURE: &str = "Answer in the panel Link";
pub(in crate::console) const DELAY_IS_MEASURED: &str =
    "The delay is that of the network to the other machine, as measured; it cannot be set";
pub(in crate::console) const ONE_RIG: &str = "This console uses the arm at another machine: close it, and start it without --follower to use another rig or scene";
