//! The column of the devices on the start page: missing ones, the endoscope, and what is plugged into this computer.

use egui::{Button, Label, RichText, Ui, vec2};
use nima_devices::discovery::{DiscoveryDiagnosis, FoundDevice, PluggedDevices, TestOutcome};
use nima_panels::rig_choice::RigChoice;
use nima_screen::{
    theme,
    widgets::{Sign, card, sign_ui, small, weak},
};
use nima_words::text::{self, of_files::of_file};

use super::{StartInputs, StartPage, looking};

impl StartPage {
    /// Draws the column of the devices.
    pub(super) fn devices_ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) {
        card(ui, text::start::MISSING, text::start::MISSING_HOVER, |ui| self.missing_ui(ui, now));
        card(ui, text::start::ENDOSCOPE, text::start::ENDOSCOPE_HOVER, |ui| self.endoscope_ui(ui, now));
        card(ui, text::start::PLUGGED, text::start::PLUGGED_HOVER, |ui| {
            let ctx = ui.ctx().clone();
            if let Some(plugged) = self.plugged.now(&ctx) {
                plugged_ui(ui, plugged);
            }
        });
    }

    fn endoscope_ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) {
        let runs = now.live.rig.endoscope.as_ref().zip(now.image.as_ref());
        let running = runs.map(|(endoscope, report)| (endoscope.url.as_str(), report));
        if !self.endoscope.ui(ui, running) {
            return;
        }
        match self.endoscope.write(&self.chosen.rig, self.folder.as_deref()) {
            Ok(rig) => {
                self.report = Some(text::start::endoscope_written(&rig));
                self.read(now.running, now.recent);
                self.is_stale = true;
                self.choose(RigChoice { rig, ..self.chosen.clone() });
            }
            Err(report) => self.report = Some(report),
        }
    }

    /// Draws the missing devices: for the running rig, from its list of devices; devices of another rig are opened
    /// briefly.
    fn missing_ui(&mut self, ui: &mut Ui, now: &StartInputs<'_>) {
        let Some(rig) = self.rig.as_ref().filter(|rig| rig.devices.is_some() || rig.has_real_hand()) else {
            ui.label(text::start::SIMULATED);
            return;
        };
        if self.chosen.rig == now.running.rig {
            let missing: Vec<_> = now.live.missing().collect();
            if missing.is_empty() {
                answer_ui(ui, true, text::start::ALL_THERE.get());
            }
            for one in missing {
                trouble_ui(ui, &one.name, &one.cause, &one.cure);
            }
            return;
        }
        if rig.is_harmless() {
            ui.label(text::start::EMULATED);
            return;
        }
        if self.addresses.ui(ui, &self.chosen.rig, rig) {
            self.is_stale = true;
            return self.choose(self.chosen.clone());
        }
        let checking = self.answers.is_running();
        let button = Button::new(if checking { text::start::CHECKING.get() } else { text::start::CHECK.get() });
        let button = ui.add_enabled(!checking, button.min_size(vec2(ui.available_width(), 32.0)));
        let button = button.on_hover_text(text::start::CHECK_HOVER);
        if button.on_disabled_hover_text(text::start::CHECK_RUNS).clicked() {
            let ctx = ui.ctx().clone();
            looking::check(&mut self.answers, &ctx, rig);
        }
        for DiscoveryDiagnosis { name, outcome, .. } in self.answers.found().into_iter().flatten() {
            match outcome {
                TestOutcome::Connected(FoundDevice { identity, .. }) => {
                    answer_ui(ui, true, &text::start::answers(name, &identity.product, &identity.serial));
                }
                TestOutcome::Trouble { cause, cure, .. } => trouble_ui(ui, name, cause, cure),
            }
        }
    }
}

pub(super) fn answer_ui(ui: &mut Ui, good: bool, words: &str) {
    let (what, colour) =
        if good { (Sign::Disc, theme::now().engaged) } else { (Sign::Triangle, theme::now().alarm_medium) };
    ui.horizontal(|ui| {
        sign_ui(ui, what, 5.0, colour);
        ui.add(Label::new(RichText::new(words).font(theme::strong(14.0))).wrap());
    });
}

pub(super) fn trouble_ui(ui: &mut Ui, name: &str, cause: &str, cure: &str) {
    answer_ui(ui, false, name);
    ui.add(Label::new(cause).wrap());
    ui.add(Label::new(small(cure)).wrap());
}

fn plugged_ui(ui: &mut Ui, plugged: &PluggedDevices) {
    let lines = plugged.lines();
    if lines.is_empty() {
        ui.label(weak(text::start::NOTHING_PLUGGED));
    }
    for [place, used, ids] in lines {
        let [place, used, ids] = [&place, &used, &ids].map(|words| of_file(words));
        ui.label(RichText::new(used).font(theme::strong(14.0)));
        ui.add(Label::new(small(format!("{place}, {ids}"))).wrap());
    }
}
