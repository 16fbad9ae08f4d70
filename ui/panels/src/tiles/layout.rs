//! Layout of the panels as saved in the settings.
//!
//! The format is simple: rows, columns and tabs of panels, with their parts of the space. Whatever a file contains, every
//! panel appears exactly once: a panel that is missing in the file is added as a tab, and a repeated one stays at its first
//! place.

use egui::{Id, Vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use super::{Arrangement, PanelId};

/// Sum of the parts of a row or column, see [`LayoutPart`].
pub(super) const WHOLE: f32 = 10_000.0;
/// Smallest part of a panel, relative to [`WHOLE`], so that its edge can still be dragged.
const MIN_FRACTION: f32 = 300.0;

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PanelLayout {
    /// The built-in layout that was chosen last.
    pub arrangement: Arrangement,
    /// Rows, columns and tabs; `None` is the built-in layout, which depends on the size of the window.
    pub places: Option<LayoutNode>,
    /// Closed panels; they keep their places.
    pub closed: Vec<PanelId>,
    /// Panels in separate windows; they keep their places.
    pub windows: Vec<PanelId>,
    /// Selected tabs, the latest first.
    pub front: Vec<PanelId>,
}

/// A panel, or a group of panels.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LayoutNode {
    Panel(PanelId),
    Tabs(Vec<LayoutNode>),
    /// Side by side.
    Row(Vec<LayoutPart>),
    /// One below the other.
    Column(Vec<LayoutPart>),
}

/// A member of a row or column.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LayoutPart {
    /// Part of the space; only ratios matter.
    #[serde(rename = "share")]
    pub fraction: u16,
    pub of: LayoutNode,
}

impl PanelLayout {
    pub fn built_in(arrangement: Arrangement) -> Self {
        Self { arrangement, ..Self::default() }
    }

    /// Returns whether panels are open and placed as in the other layout, whichever tabs are in front.
    pub fn looks_like(&self, other: &Self) -> bool {
        let look = |of: &Self| (of.arrangement, of.places.clone(), of.closed.clone(), of.windows.clone());
        look(self) == look(other)
    }

    pub fn is_open(&self, panel: PanelId) -> bool {
        !self.closed.contains(&panel)
    }

    /// Closes the panel, or reopens it at its former place in front.
    pub fn toggle(&mut self, panel: PanelId) {
        if self.is_open(panel) {
            self.closed.push(panel);
            self.closed.sort_unstable();
        } else {
            self.show(panel);
        }
    }

    pub fn is_window(&self, panel: PanelId) -> bool {
        self.windows.contains(&panel) && self.is_open(panel)
    }

    /// Returns the open panels in separate windows.
    pub fn windows(&self) -> impl Iterator<Item = PanelId> {
        PanelId::built().filter(|panel| self.is_window(*panel))
    }

    /// Opens the panel in its own window, or returns it to its place in front.
    pub fn toggle_window(&mut self, panel: PanelId) {
        let is_window = self.is_window(panel);
        self.show(panel);
        if !is_window {
            self.windows.push(panel);
            self.windows.sort_unstable();
        }
    }

    /// Opens the panel in this window, in front.
    pub fn show(&mut self, panel: PanelId) {
        self.closed.retain(|&closed| closed != panel);
        self.windows.retain(|&window| window != panel);
        self.front.retain(|&front| front != panel);
        self.front.insert(0, panel);
    }

    /// Returns the tiles of this layout for a desk of this size.
    pub(super) fn tree(&self, size: Vec2) -> Tree<PanelId> {
        let mut tiles = Tiles::default();
        let mut placed = Vec::new();
        let fallback = self.places.is_none().then(|| self.arrangement.places(size));
        let root = self.places.as_ref().or(fallback.as_ref()).and_then(|node| insert(&mut tiles, node, &mut placed));
        let missing: Vec<TileId> =
            PanelId::built().filter(|panel| !placed.contains(panel)).map(|panel| tiles.insert_pane(panel)).collect();
        let root = match root {
            _ if missing.is_empty() => root,
            Some(root) => Some(add_as_tabs(&mut tiles, root, missing)),
            None => Some(tiles.insert_tab_tile(missing)),
        };
        let id = Id::unique("desk");
        let mut tree = root.map_or_else(|| Tree::empty(id), |root| Tree::new(id, root, Tiles::default()));
        tree.tiles = tiles;
        for panel in self.closed.iter().chain(&self.windows) {
            if let Some(tile) = tree.tiles.find_pane(panel) {
                tree.set_visible(tile, false);
            }
        }
        // The first one listed must be in front, so it is selected last.
        for panel in self.front.iter().rev() {
            tree.make_active(|_, tile| matches!(tile, Tile::Pane(pane) if pane == panel));
        }
        tree
    }

    /// Creates the layout of these tiles; `seen` are the panels that were in front before. The default layout stays the
    /// default unless tiles were `moved`.
    pub(super) fn of(tree: &Tree<PanelId>, moved: bool, seen: &[PanelId], before: &Self) -> Self {
        let places = if moved { tree.root.and_then(|root| node(&tree.tiles, root)) } else { before.places.clone() };
        let mut front = in_front(tree);
        front.retain(|panel| !seen.contains(panel));
        front.extend(before.front.iter().filter(|panel| !front.contains(panel)).copied().collect::<Vec<_>>());
        Self { places, front, ..before.clone() }
    }
}

/// Returns the panels that are visible on the desk.
pub(super) fn in_front(tree: &Tree<PanelId>) -> Vec<PanelId> {
    let mut panels: Vec<PanelId> =
        tree.active_tiles().into_iter().filter_map(|id| tree.tiles.get_pane(&id).copied()).collect();
    panels.sort_unstable();
    panels
}

/// Inserts a node; `None` if all its panels have been placed already.
fn insert(tiles: &mut Tiles<PanelId>, node: &LayoutNode, placed: &mut Vec<PanelId>) -> Option<TileId> {
    match node {
        LayoutNode::Panel(panel) if placed.contains(panel) || !panel.is_built() => None,
        LayoutNode::Panel(panel) => {
            placed.push(*panel);
            Some(tiles.insert_pane(*panel))
        }
        LayoutNode::Tabs(of) => {
            let children: Vec<TileId> = of.iter().filter_map(|node| insert(tiles, node, placed)).collect();
            (!children.is_empty()).then(|| tiles.insert_tab_tile(children))
        }
        LayoutNode::Row(parts) => insert_parts(tiles, LinearDir::Horizontal, parts, placed),
        LayoutNode::Column(parts) => insert_parts(tiles, LinearDir::Vertical, parts, placed),
    }
}

fn insert_parts(
    tiles: &mut Tiles<PanelId>,
    dir: LinearDir,
    parts: &[LayoutPart],
    placed: &mut Vec<PanelId>,
) -> Option<TileId> {
    let whole: f32 = parts.iter().map(|part| f32::from(part.fraction)).sum::<f32>().max(1.0);
    let children: Vec<(TileId, f32)> = parts
        .iter()
        .filter_map(|part| {
            let fraction = (f32::from(part.fraction) / whole).max(MIN_FRACTION / WHOLE);
            insert(tiles, &part.of, placed).map(|tile| (tile, fraction))
        })
        .collect();
    if children.is_empty() {
        return None;
    }
    let mut linear = Linear::new(dir, children.iter().map(|(tile, _)| *tile).collect());
    for (tile, fraction) in children {
        linear.shares.set_share(tile, fraction);
    }
    Some(tiles.insert_container(linear))
}

/// Adds tiles as tabs to the first group of tabs; returns the root, which is new if there was no group.
fn add_as_tabs(tiles: &mut Tiles<PanelId>, root: TileId, missing: Vec<TileId>) -> TileId {
    let first = tiles
        .iter()
        .filter(|(_, tile)| matches!(tile, Tile::Container(Container::Tabs(_))))
        .map(|(id, _)| *id)
        .min_by_key(|id| id.0);
    if let Some(Tile::Container(Container::Tabs(tabs))) = first.and_then(|id| tiles.get_mut(id)) {
        tabs.children.extend(missing);
        return root;
    }
    let mut all = vec![root];
    all.extend(missing);
    tiles.insert_tab_tile(all)
}

/// This tile in the format of the file.
fn node(tiles: &Tiles<PanelId>, id: TileId) -> Option<LayoutNode> {
    let parts = |linear: &Linear| -> Vec<LayoutPart> {
        let whole: f32 = linear.children.iter().map(|child| linear.shares[*child]).sum::<f32>().max(f32::EPSILON);
        linear
            .children
            .iter()
            .filter_map(|child| {
                let fraction = (linear.shares[*child] / whole * WHOLE).round().clamp(0.0, WHOLE) as u16;
                node(tiles, *child).map(|of| LayoutPart { fraction, of })
            })
            .collect()
    };
    match tiles.get(id)? {
        Tile::Pane(panel) => Some(LayoutNode::Panel(*panel)),
        Tile::Container(Container::Linear(linear)) => Some(match linear.dir {
            LinearDir::Horizontal => LayoutNode::Row(parts(linear)),
            LinearDir::Vertical => LayoutNode::Column(parts(linear)),
        }),
        // Grids are never created by the console; convert the members of one into tabs.
        Tile::Container(container @ (Container::Tabs(_) | Container::Grid(_))) => {
            Some(LayoutNode::Tabs(container.children().filter_map(|child| node(tiles, *child)).collect()))
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    const SIZES: [[f32; 2]; 5] =
        [[1100.0, 608.0], [1280.0, 648.0], [1600.0, 928.0], [1920.0, 1008.0], [3840.0, 2088.0]];

    fn panels_of(tree: &Tree<PanelId>) -> Vec<PanelId> {
        fn walk(tree: &Tree<PanelId>, id: TileId, panels: &mut Vec<PanelId>) {
            match tree.tiles.get(id) {
                Some(Tile::Pane(panel)) => panels.push(*panel),
                Some(Tile::Container(container)) => {
                    container.children().for_each(|child| walk(tree, *child, panels));
                }
                None => {}
            }
        }
        let mut panels = Vec::new();
        tree.root.into_iter().for_each(|root| walk(tree, root, &mut panels));
        panels.sort_unstable();
        panels
    }

    fn all() -> Vec<PanelId> {
        // Without extras, which the program offers, fewer than `PanelId::ALL`.
        let mut all: Vec<PanelId> = PanelId::built().collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn every_size_of_every_built_in_layout_holds_every_panel_once() {
        for arrangement in Arrangement::ALL {
            for size in SIZES {
                let tree = PanelLayout::built_in(arrangement).tree(size.into());
                assert_eq!(panels_of(&tree), all(), "{arrangement:?} {size:?}");
            }
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let size = vec2(1600.0, 928.0);
        let tree = PanelLayout::default().tree(size);
        let kept = PanelLayout::of(&tree, true, &[], &PanelLayout::default());
        let text = serde_json::to_string(&kept).unwrap();
        let read: PanelLayout = serde_json::from_str(&text).unwrap();
        assert_eq!(read, kept);
        assert_eq!(PanelLayout::of(&read.tree(vec2(300.0, 300.0)), true, &[], &read), kept, "{text}");
    }

    #[test]
    fn a_layout_that_lacks_a_panel_or_names_one_twice_still_opens_with_all() {
        for text in [
            r#"{"places":{"panel":"field"}}"#,
            r#"{"places":{"tabs":[]}}"#,
            // A panel of an earlier version, now part of another one.
            r#"{"places":{"tabs":[{"panel":"gates"},{"panel":"safety"}]},"front":["gates"]}"#,
            r#"{"places":{"row":[{"share":0,"of":{"tabs":[{"panel":"timing"},{"panel":"timing"}]}}]}}"#,
            r#"{"places":{"column":[{"share":65535,"of":{"row":[]}},{"share":0,"of":{"panel":"traces"}}]}}"#,
        ] {
            let layout: PanelLayout = serde_json::from_str(text).unwrap();
            assert_eq!(panels_of(&layout.tree(vec2(1280.0, 648.0))), all(), "{text}");
        }
    }

    #[test]
    fn a_closed_panel_keeps_its_place_and_comes_back_in_front() {
        let size = vec2(1280.0, 648.0);
        let mut layout = PanelLayout::default();
        layout.toggle(PanelId::Safety);
        let tree = layout.tree(size);
        let safety = tree.tiles.find_pane(&PanelId::Safety).unwrap();
        assert!(!tree.is_visible(safety) && !layout.is_open(PanelId::Safety));
        layout.toggle(PanelId::Safety);
        let tree = layout.tree(size);
        let safety = tree.tiles.find_pane(&PanelId::Safety).unwrap();
        assert!(tree.active_tiles().contains(&safety));
        assert!(layout.places.is_none(), "opening and closing moves nothing");
    }
}
