//! The link to the machine with the arm.

use egui::Ui;
use nima_screen::{
    live::{LiveState, ScreenSource},
    widgets::weak,
};
use nima_words::{language::Text, text};

use crate::{
    PanelExtras,
    panel::{Panel, PanelContext, PanelSize},
};

#[derive(Debug, Default)]
pub struct LinkPanel;

impl Panel for LinkPanel {
    const NAME: Text = text::link::NAME;
    const MEANING: Text = text::link::MEANING;
    const SIZE: PanelSize = PanelSize::FIGURES;

    fn is_built() -> bool {
        PanelExtras::offered().has_link
    }

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        match at.live.of {
            ScreenSource::Now => link_ui(ui, at.live),
            ScreenSource::Past => drop(ui.label(weak(text::link::NOT_IN_SESSIONS))),
            ScreenSource::Elsewhere => drop(ui.label(weak(text::monitor::NO_LINK))),
        }
    }
}

fn link_ui(ui: &mut Ui, live: &LiveState) {
    if let Some(line) = &live.line {
        return line.ui(ui, live.state().permits().drives);
    }
    ui.label(text::link::ONE_MACHINE);
    ui.add_space(4.0);
    ui.label(weak(text::link::HOW_TWO));
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable as _};
    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;
    use nima_screen::theme;

    #[test]
    fn without_another_machine_the_panel_says_how_there_can_be_one() {
        let live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load("peg_transfer").unwrap());
        let panel = |ui: &mut Ui, live: &mut LiveState| {
            theme::apply(ui.ctx());
            link_ui(ui, live);
        };
        let window = Harness::builder().with_size([330.0, 600.0]).build_ui_state(panel, live);
        window.get_by_label(text::link::ONE_MACHINE.get());
    }
}
