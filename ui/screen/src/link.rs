//! The link to the machine with the arm, as used by the window and the commands. An extra implements it.

use std::fmt::Debug;

use egui::Ui;
use nima_machine::{config::RigConfig, rig::RigEnds, runtime::Assembly};
use nima_simulation::scene::Scene;

/// Opens links to a machine with the arm.
pub trait ArmLink: Sync {
    /// Returns whether this host is this machine. An unresolved host counts as another machine; opening the link
    /// reports the error.
    fn is_loopback(&self, host: &str) -> bool;

    /// Opens the link to this host, and reduces the rig to the parts at this machine.
    fn open(&self, host: &str, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Box<dyn RemoteLine>>;
}

/// One end of a link, before the loop drives it.
pub trait RemoteLine {
    /// Returns the devices at this end.
    fn here(&self) -> RigEnds;

    /// Returns the handle for other threads.
    fn door(&self) -> Box<dyn LineConnection>;

    /// Returns the assembly with the other half of its rig at the other end.
    fn join(self: Box<Self>, assembly: Assembly) -> Assembly;
}

/// Handle of the window and the commands for a link that the loop drives.
pub trait LineConnection: Debug + Send {
    /// Receives reports; returns the text of a state change.
    fn receive(&mut self) -> Option<String>;

    fn has_reported(&self) -> bool;

    /// Draws the state of the link, and the buttons that transfer control of the follower; `drives`: the arm is driven now.
    fn ui(&self, ui: &mut Ui, drives: bool);

    /// Returns the cause and remedy if no data pass.
    fn trouble(&self) -> Option<[String; 2]>;

    /// Returns whether a message was received.
    fn has_delivered(&self) -> bool;

    /// Returns the cause and remedy of a request that waits for the operator.
    fn question(&self) -> Option<[&'static str; 2]>;

    /// Returns the names and values of the link statistics.
    fn rows(&self) -> Vec<[String; 2]>;

    /// Returns the link statistics for JSON output.
    fn figures(&self) -> Option<serde_json::Value>;
}

type LineOpener = dyn Fn(&mut RigConfig, &Scene) -> anyhow::Result<Option<Box<dyn RemoteLine>>>;

/// Opens another link to the same follower, for a loop that restarts.
pub struct Reopen(Box<LineOpener>);

impl Reopen {
    pub fn new(open: impl Fn(&mut RigConfig, &Scene) -> anyhow::Result<Option<Box<dyn RemoteLine>>> + 'static) -> Self {
        Self(Box::new(open))
    }

    /// Opens the link for this rig, which is reduced to the parts at this machine.
    pub fn open(&self, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Option<Box<dyn RemoteLine>>> {
        (self.0)(rig, scene)
    }
}

impl Debug for Reopen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Reopen")
    }
}
