//! The layout of the Technician view: every panel is a tile with a title that can be dragged into tabs, rows and columns,
//! resized, closed and reopened. The layout is saved in the settings ([`PanelLayout`]); the tiles themselves are kept here between
//! frames.
//!
//! The tiles are limited to the space below the top bar, so that stop button, state and alarms stay visible.

mod arrangement;
mod layout;
mod window;

use egui::{
    Align, Button, Color32, Context, Frame, Layout as Flow, Margin, Rect, Response, RichText, ScrollArea, Stroke, Ui,
    UiBuilder, Vec2, Visuals, WidgetInfo, WidgetText, vec2,
};
use egui_tiles::{
    Behavior, EditAction, ResizeState, SimplificationOptions, TabState, Tabs, TileId, Tiles, Tree, UiResponse,
};
use nima_screen::{theme, widgets::weak};
use nima_words::text;

pub use arrangement::Arrangement;
pub use layout::{LayoutNode, LayoutPart, PanelLayout};

pub use window::window_ui;

pub use crate::panel::PanelId;

const TAB_BAR: f32 = 28.0;
const GAP: f32 = 6.0;
/// Space between a panel's edge and its content.
const PADDING: i8 = 10;
const TITLE: f32 = 13.5;
/// Size of the button that closes a panel.
const CLOSE: Vec2 = vec2(30.0, 26.0);

#[derive(Debug, Default)]
pub struct PanelTiles {
    /// The tiles, and their source: the layout, and the available size if the layout depends on it.
    shown: Option<(Tree<PanelId>, PanelLayout, Option<Vec2>)>,
    /// Tiles were moved or resized, or tabs selected, since the layout was last saved.
    moved: bool,
    turned: bool,
    /// Panels that were in front when the layout was last saved.
    seen: Vec<PanelId>,
    /// Whether the main window draws the panels that have their own windows.
    opens_windows: bool,
}

impl PanelTiles {
    /// Creates the tiles of a window that draws the panels with their own windows.
    pub fn with_windows() -> Self {
        Self { opens_windows: true, ..Self::default() }
    }

    /// Shows the layout with these contents, and updates it when the operator changes it.
    pub fn ui(&mut self, ui: &mut Ui, layout: &mut PanelLayout, contents: &mut dyn FnMut(&mut Ui, PanelId)) {
        let size = layout.places.is_none().then(|| ui.available_size());
        if !self.shown.as_ref().is_some_and(|(_, shown, at)| shown == layout && *at == size) {
            let tree = layout.tree(ui.available_size());
            self.seen = layout::in_front(&tree);
            self.shown = Some((tree, layout.clone(), size));
        }
        let Some((tree, shown, at)) = &mut self.shown else { return };
        if tree.active_tiles().is_empty() {
            ui.centered_and_justified(|ui| ui.label(weak(text::tiles::ALL_CLOSED)));
            return;
        }
        let mut tiles = DeskContents {
            draw: contents,
            opens_windows: self.opens_windows,
            closed: None,
            opened: None,
            button: None,
            moved: &mut self.moved,
            turned: &mut self.turned,
        };
        tree.ui(&mut tiles, ui);
        let DeskContents { closed, opened, .. } = tiles;
        if let Some(panel) = closed {
            layout.toggle(panel);
            return;
        }
        if let Some(panel) = opened {
            layout.toggle_window(panel);
            return;
        }
        // While a mouse button is down, the tiles are still being moved.
        if (self.moved || self.turned) && !ui.input(|input| input.pointer.any_down()) {
            *layout = PanelLayout::of(tree, self.moved, &self.seen, layout);
            self.seen = layout::in_front(tree);
            shown.clone_from(layout);
            if self.moved {
                *at = None;
            }
            self.moved = false;
            self.turned = false;
        }
    }
}

struct DeskContents<'a> {
    draw: &'a mut dyn FnMut(&mut Ui, PanelId),
    opens_windows: bool,
    closed: Option<PanelId>,
    /// The panel to open in its own window.
    opened: Option<PanelId>,
    /// Place of the close button, which is drawn after the panel's title so that the keyboard reaches it.
    button: Option<(Rect, PanelId)>,
    moved: &'a mut bool,
    turned: &'a mut bool,
}

impl Behavior<PanelId> for DeskContents<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, panel: &mut PanelId) -> UiResponse {
        if let Some((place, _)) = self.button.take_if(|(_, of)| *of == *panel) {
            self.close_ui(ui, place, *panel);
        }
        content_ui(ui, *panel, &mut |ui| (self.draw)(ui, *panel));
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, panel: &PanelId) -> WidgetText {
        RichText::new(panel.title()).font(theme::strong(TITLE)).into()
    }

    fn on_tab_button(&mut self, tiles: &mut Tiles<PanelId>, tile: TileId, tab: Response) -> Response {
        if tab.has_focus() {
            focus_ring(&tab.ctx, &tab);
        }
        let Some(panel) = tiles.get_pane(&tile) else { return tab };
        tab.context_menu(|ui| self.menu_ui(ui, *panel));
        tab.on_hover_text(format!("{}\n{}", panel.meaning(), text::tiles::DRAG_HOVER.get()))
    }

    fn top_bar_right_ui(&mut self, tiles: &Tiles<PanelId>, ui: &mut Ui, _tile: TileId, tabs: &Tabs, _scroll: &mut f32) {
        let Some(panel) = tabs.active.and_then(|active| tiles.get_pane(&active)) else { return };
        let (place, _) = ui.allocate_exact_size(CLOSE, egui::Sense::hover());
        self.button = Some((place, *panel));
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        TAB_BAR
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        GAP
    }

    fn min_size(&self) -> f32 {
        60.0
    }

    fn resize_stroke(&self, _style: &egui::Style, state: ResizeState) -> Stroke {
        match state {
            ResizeState::Idle => Stroke::NONE,
            ResizeState::Hovering => Stroke::new(2.0, theme::now().text_weak),
            ResizeState::Dragging => Stroke::new(3.0, theme::now().text),
        }
    }

    fn tab_bar_color(&self, _visuals: &Visuals) -> Color32 {
        theme::now().panel
    }

    fn tab_bg_color(&self, _visuals: &Visuals, _tiles: &Tiles<PanelId>, _tile: TileId, state: &TabState) -> Color32 {
        if state.active { theme::now().card } else { Color32::TRANSPARENT }
    }

    fn tab_outline_stroke(
        &self,
        _visuals: &Visuals,
        _tiles: &Tiles<PanelId>,
        _tile: TileId,
        _state: &TabState,
    ) -> Stroke {
        Stroke::NONE
    }

    fn tab_text_color(&self, _visuals: &Visuals, _tiles: &Tiles<PanelId>, _tile: TileId, state: &TabState) -> Color32 {
        if state.active { theme::now().text } else { theme::now().text_weak }
    }

    fn drag_preview_stroke(&self, _visuals: &Visuals) -> Stroke {
        Stroke::new(2.0, theme::now().text)
    }

    fn drag_preview_color(&self, _visuals: &Visuals) -> Color32 {
        theme::now().selected.gamma_multiply(0.5)
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn on_edit(&mut self, action: EditAction) {
        match action {
            EditAction::TileResized | EditAction::TileDropped => *self.moved = true,
            EditAction::TabSelected => *self.turned = true,
            EditAction::TileDragged => {}
        }
    }
}

impl DeskContents<'_> {
    /// Draws the menu of a tab.
    fn menu_ui(&mut self, ui: &mut Ui, panel: PanelId) {
        let entry = |ui: &mut Ui, name: &str| ui.add(Button::new(name).min_size(vec2(200.0, 26.0))).clicked();
        if self.opens_windows && entry(ui, text::tiles::OPEN_WINDOW.get()) {
            self.opened = Some(panel);
        }
        if entry(ui, &text::tiles::close(panel.title())) {
            self.closed = Some(panel);
        }
    }

    /// Draws the close button of a panel, in the tab bar.
    fn close_ui(&mut self, ui: &mut Ui, place: Rect, panel: PanelId) {
        let mut bar = ui.new_child(UiBuilder::new().max_rect(place).id_salt("close"));
        bar.set_clip_rect(place);
        // The bar has the same height with large controls for touch.
        let spacing = bar.spacing_mut();
        spacing.button_padding = spacing.button_padding.min(vec2(10.0, 5.0));
        spacing.interact_size.y = spacing.interact_size.y.min(CLOSE.y);
        let button = Button::new(RichText::new("\u{d7}").font(theme::regular(16.0))).frame_when_inactive(false);
        let button = bar.add(button.min_size(CLOSE));
        let name = text::tiles::close(panel.title());
        button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
        if button.on_hover_text(text::tiles::close_meaning(&name)).clicked() {
            self.closed = Some(panel);
        }
    }
}

/// Draws a panel over the available space, with scroll bars if it is larger.
pub fn content_ui(ui: &mut Ui, panel: PanelId, draw: &mut dyn FnMut(&mut Ui)) {
    let rect = ui.available_rect_before_wrap();
    let min = panel.min_size();
    if panel.fills() {
        if rect.width() >= min.x && rect.height() >= min.y {
            draw(ui);
        } else {
            scrolled(ui, rect.size().max(min), draw);
        }
        return;
    }
    ui.painter().rect_filled(rect, 0.0, theme::now().card);
    // The scroll bar floats over the panel.
    let scroll = ui.spacing().scroll;
    let bar = f32::from(PADDING).max(scroll.bar_width + scroll.bar_inner_margin);
    let frame = Frame::new().inner_margin(Margin { right: bar as i8, ..Margin::same(PADDING) });
    let width = (rect.width() - f32::from(PADDING) - bar).max(min.x);
    ScrollArea::both().id_salt(panel).auto_shrink(false).show(ui, |ui| {
        frame.show(ui, |ui| {
            ui.set_width(width);
            ui.spacing_mut().item_spacing.y = 4.0;
            draw(ui);
        });
    });
}

/// Shows a panel that is larger than its tile with scroll bars.
fn scrolled(ui: &mut Ui, size: Vec2, content: impl FnOnce(&mut Ui)) {
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
        ui.scope_builder(UiBuilder::new().max_rect(rect).layout(Flow::top_down(Align::Min)), content);
    });
}

/// Shows which tab has the keyboard focus.
fn focus_ring(ctx: &Context, tab: &Response) {
    let painter = ctx.layer_painter(tab.layer_id);
    painter.rect_stroke(tab.rect.shrink(1.0), 2.0, Stroke::new(2.0, theme::now().text), egui::StrokeKind::Inside);
}
