//! State of the window, for tests and callers.

use nima_machine::{config::RigConfig, messages::Tick};
use nima_panels::{roles::Role, settings::ConsoleSettings};
use nima_screen::scene3d::extras::Extras;
use nima_session::objects::ObjectStates;
use nima_wizards::active_calibrations::ActiveCalibrations;

use super::ConsoleApp;

impl ConsoleApp {
    /// Returns the settings that are saved between sessions, for tests.
    pub const fn settings_mut(&mut self) -> &mut ConsoleSettings {
        &mut self.settings.now
    }

    /// Shows the same state until it is called again, for tests: a layout is judged on one state, not on a running loop.
    pub const fn freeze(&mut self, frozen: bool) {
        self.frozen = frozen;
    }

    pub const fn role(&self) -> Role {
        self.settings.now.role
    }

    /// Returns the newest tick that the window has received.
    pub fn tick(&self) -> Option<&Tick> {
        self.live.first_tick()
    }

    /// Returns the last report of the simulation about the objects of its scene.
    pub const fn objects(&self) -> Option<&ObjectStates> {
        self.live.objects.as_ref()
    }

    /// Returns the rig that the loop is running on.
    pub fn rig(&self) -> &RigConfig {
        &self.live.rig
    }

    /// Returns whether the Trade-off panel has results.
    pub fn is_tradeoff_measured(&self) -> bool {
        self.panels.tradeoff.as_ref().is_some_and(|tradeoff| tradeoff.is_measured())
    }

    /// Returns the optional objects in the 3-D view.
    pub const fn extras(&self) -> Extras {
        self.panels.scene.extras
    }

    /// Returns the interval of the traces, s, counted back from now.
    pub const fn traces_s(&self) -> (f64, f64) {
        self.panels.forces.view().view_s
    }

    /// Sets the time span of the traces, for tests.
    pub fn show_traces(&mut self, seconds: f64) {
        self.panels.forces.show_last(seconds);
    }

    /// Returns the marks set by the operator, s on the loop's clock.
    pub fn marks_s(&self) -> impl Iterator<Item = f64> {
        self.live.marks_s.iter().copied()
    }

    pub fn active(&self) -> &ActiveCalibrations {
        &self.active
    }
}
