//! The line to the machine with the arm, as the window and the commands use it. What carries it is an extra.

use std::fmt::Debug;

use egui::Ui;
use nima_machine::{config::RigConfig, rig::Ends, runtime::Assembly};
use nima_simulation::scene::Scene;

/// How a machine with the arm is reached.
pub(crate) trait Way: Sync {
    /// Whether this host is this machine. One that cannot be found is another machine; opening the line reports it.
    fn is_loopback(&self, host: &str) -> bool;

    /// Opens the line to this host, and changes the rig to what is at this machine.
    fn open(&self, host: &str, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Box<dyn Line>>;
}

/// One end of a line, before the loop drives it.
pub(crate) trait Line {
    /// Which devices are at this end.
    fn here(&self) -> Ends;

    /// What other threads hold of it.
    fn door(&self) -> Box<dyn LineDoor>;

    /// The assembly with the other half of its rig at the other end.
    fn join(self: Box<Self>, assembly: Assembly) -> Assembly;
}

/// What the window and the commands hold of a line that the loop drives.
pub(crate) trait LineDoor: Debug + Send {
    /// Takes in what was reported; returns a change of the line's state in words.
    fn hear(&mut self) -> Option<String>;

    /// Whether anything was reported yet.
    fn has_reported(&self) -> bool;

    /// Draws what the line does, and the buttons by which a follower changes hands; `drives`: the arm is driven now.
    fn ui(&self, ui: &mut Ui, drives: bool);

    /// Cause and cure if nothing passes.
    fn trouble(&self) -> Option<[String; 2]>;

    /// Whether a message came over it.
    fn has_delivered(&self) -> bool;

    /// Cause and cure of a question that waits for the operator.
    fn question(&self) -> Option<[&'static str; 2]>;

    /// Names and values of the figures.
    fn rows(&self) -> Vec<[String; 2]>;

    /// The figures, as they are printed.
    fn figures(&self) -> Option<serde_json::Value>;
}

type Open = dyn Fn(&mut RigConfig, &Scene) -> anyhow::Result<Option<Box<dyn Line>>>;

/// Opens a line to the same follower again, for a loop that starts anew.
pub(crate) struct Reopen(Box<Open>);

impl Reopen {
    /// By this function.
    pub(crate) fn new(
        open: impl Fn(&mut RigConfig, &Scene) -> anyhow::Result<Option<Box<dyn Line>>> + 'static,
    ) -> Self {
        Self(Box::new(open))
    }

    /// The line for this rig, which is changed to what is at this machine.
    pub(crate) fn open(&self, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Option<Box<dyn Line>>> {
        (self.0)(rig, scene)
    }
}

impl Debug for Reopen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Reopen")
    }
}
