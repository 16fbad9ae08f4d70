//! The Trade-off panel: computing time against accuracy, in a build with the extra that measures it.

use egui::Ui;
use nima_words::{language::Text, text};

use crate::{
    PanelExtras,
    panel::{Panel, PanelContext, PanelSize},
};

#[derive(Debug, Default)]
pub(crate) struct TradeoffPanel;

impl Panel for TradeoffPanel {
    const NAME: Text = text::tradeoff::NAME;
    const MEANING: Text = text::tradeoff::MEANING;
    const SIZE: PanelSize = PanelSize::FIGURES;
    const ACTS: bool = true;

    fn is_built() -> bool {
        PanelExtras::offered().tradeoff.is_some()
    }

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        if let Some(tradeoff) = &mut at.panels.tradeoff {
            at.wishes.restart = tradeoff.ui(ui, at.live, at.outbox);
        }
    }
}
