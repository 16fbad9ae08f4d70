//! Layout faults of a screen: texts that are cut or overlap, controls that overlap or leave the window, a stop button in the
//! wrong place.

use egui::{Pos2, Rect, Shape, accesskit};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_panels::roles::Role;
use nima_words::language::{Language, pseudo};

/// Tolerance for rounding, points.
const SLACK: f32 = 1.5;
/// Minimum distance between the texts of a button and its edge, points.
const EDGE: f32 = 0.5;

/// A text on the screen: its characters, its position, and its allowed area.
pub(crate) struct Text {
    words: String,
    place: Rect,
    clip: Rect,
    cut: bool,
}

/// Returns all texts of the last frame.
pub(crate) fn texts<A>(harness: &Harness<'_, A>) -> Vec<Text> {
    fn add(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, clip, texts)),
            Shape::Text(text) if text.angle == 0.0 && !text.galley.text().trim().is_empty() => texts.push(Text {
                words: text.galley.text().to_owned(),
                place: text.galley.mesh_bounds.translate(text.pos.to_vec2()),
                clip,
                cut: text.galley.elided,
            }),
            _ => {}
        }
    }
    let mut texts = Vec::new();
    for clipped in &harness.output().shapes {
        add(&clipped.shape, clipped.clip_rect, &mut texts);
    }
    texts
}

/// Returns the faults of the texts in this frame; `field` is the operating field, where labels move with objects.
pub(crate) fn faults_of_texts(
    texts: &[Text],
    window: Rect,
    field: Option<Rect>,
    scrolls: bool,
    overlaid: bool,
) -> Vec<String> {
    let mut faults = Vec::new();
    let seen = |text: &Text| text.place.intersect(text.clip).intersect(window).is_positive();
    let on_field = |text: &Text| {
        field.is_some_and(|field| {
            (text.clip.min - field.min).length() < SLACK && (text.clip.max - field.max).length() < SLACK
        })
    };
    let texts: Vec<&Text> = texts.iter().filter(|text| seen(text) && !on_field(text)).collect();
    for text in &texts {
        let room = text.clip.intersect(window).expand(SLACK);
        let sideways = text.place.left() < room.left() || text.place.right() > room.right();
        let up_or_down = text.place.top() < room.top() || text.place.bottom() > room.bottom();
        // In a long column that scrolls, text cut off at the end can be scrolled into view.
        if text.cut || sideways || (up_or_down && !scrolls) {
            faults.push(format!("cut: \"{}\" at {:?}", text.words, text.place));
        }
    }
    for (i, one) in texts.iter().enumerate().filter(|_| !overlaid) {
        for other in &texts[i + 1..] {
            let shared = one.place.intersect(one.clip).intersect(other.place.intersect(other.clip)).shrink(SLACK);
            if shared.is_positive() {
                faults.push(format!("\"{}\" lies on \"{}\" at {:?}", one.words, other.words, shared.center()));
            }
        }
    }
    faults
}

/// Returns the rows of tabs that are longer than their group and scroll sideways: a tab cut there can be scrolled into
/// view.
fn scrolled_tabs<A>(harness: &Harness<'_, A>) -> Vec<Rect> {
    let is_arrow = |name: Option<String>| name.is_some_and(|name| name.starts_with("Scroll tabs"));
    harness.query_all_by(move |node| is_arrow(node.label())).map(|node| node.rect()).collect()
}

/// Returns whether this is in one of these rows of tabs.
fn is_among(rows: &[Rect], place: Rect) -> bool {
    rows.iter().any(|row| row.y_range().contains(place.center().y))
}

/// Returns the controls that overlap, or that leave the window sideways. A control scrolled out of view is recognised
/// by its text.
pub(crate) fn faults_of_controls<A>(harness: &Harness<'_, A>, texts: &[Text], window: Rect) -> Vec<String> {
    let seen = |name: &str, place: Rect| {
        let words = texts.iter().find(|text| text.words.trim() == name && place.contains(text.place.center()));
        words.map_or(place, |words| place.intersect(words.clip))
    };
    let is_control = |role: accesskit::Role| {
        use accesskit::Role;
        matches!(role, Role::Button | Role::CheckBox | Role::SpinButton | Role::TextInput | Role::RadioButton)
    };
    let scrolled = scrolled_tabs(harness);
    let controls: Vec<(String, Rect)> = harness
        .query_all_by(move |node| is_control(node.role()))
        .map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect()))
        .map(|(name, place)| (name.clone(), seen(&name, place)))
        .filter(|(_, place)| place.is_positive() && !is_among(&scrolled, *place))
        .collect();
    let mut faults = Vec::new();
    for (i, (name, place)) in controls.iter().enumerate() {
        if place.left() < -SLACK || place.right() > window.right() + SLACK {
            faults.push(format!("\"{name}\" leaves the window: {place:?}"));
        }
        for (other, there) in &controls[i + 1..] {
            if place.intersect(*there).shrink(SLACK).is_positive() {
                faults.push(format!("\"{name}\" overlaps \"{other}\" at {place:?}"));
            }
        }
    }
    faults
}

/// Returns the buttons that are narrower than their text.
pub(crate) fn too_wide<A>(harness: &Harness<'_, A>) -> Vec<String> {
    let buttons = harness.query_all_by(|node| node.role() == accesskit::Role::Button);
    let buttons: Vec<(String, Rect)> =
        buttons.filter_map(|node| Some((node.accesskit_node().label()?, node.rect()))).collect();
    let leaves = |Text { words, place, .. }: &Text| {
        let words = words.trim();
        let (_, button) = buttons.iter().find(|(name, button)| name == words && button.intersects(*place))?;
        let beyond = place.left() < button.left() - EDGE || place.right() > button.right() + EDGE;
        beyond.then(|| format!("\"{words}\" is wider than its button: {place:?} in {button:?}"))
    };
    texts(harness).iter().filter_map(leaves).collect()
}

/// Kind of check for a page.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Page {
    /// Everything must be visible.
    Whole,
    /// A long column may be scrolled.
    Scrolls,
    /// Controls may also be scrolled out of view, and then have no position.
    Form,
    /// Drawn over something else.
    Over,
}

impl Page {
    /// Returns how a view is checked: the technician's panels scroll.
    pub(crate) fn of_view(role: Role) -> Self {
        if role == Role::Technician { Self::Scrolls } else { Self::Whole }
    }
}

/// All faults in a window of this size.
pub(crate) fn faults(harness: &mut Harness<'_, ConsoleApp>, size: [f32; 2], page: Page) -> Vec<String> {
    let (texts, window, field) = seen(harness, size);
    let mut faults = faults_of_texts(&texts, window, field, page != Page::Whole, page == Page::Over);
    if matches!(page, Page::Whole | Page::Scrolls) {
        faults.extend(faults_of_controls(harness, &texts, window));
    }
    faults
}

/// Returns the content of a window of this size: its texts, the window, the operating field.
fn seen(harness: &mut Harness<'_, ConsoleApp>, size: [f32; 2]) -> (Vec<Text>, Rect, Option<Rect>) {
    // On a busy machine the loop would change the texts between the frames in which the sizes settle.
    harness.state_mut().freeze(true);
    harness.set_size(size.into());
    // Sizes settle within a few frames.
    harness.run_steps(4);
    harness.state_mut().freeze(false);
    harness.check_accessibility();
    let window = Rect::from_min_size(Pos2::ZERO, size.into());
    let [stop, field] = match harness.state_mut().settings_mut().language {
        Language::English => ["Stop", "Operating field"].map(str::to_owned),
        Language::German => ["Halt", "OP-Feld"].map(str::to_owned),
        Language::Pseudo => ["Stop", "Operating field"].map(pseudo),
    };
    let stop = harness.get_by_role_and_label(accesskit::Role::Button, &stop).rect();
    assert!(stop.width() >= 48.0 && stop.height() >= 48.0 && window.contains_rect(stop), "{stop:?}");
    let field = harness.query_by_label(&field).map(|field| field.rect());
    let scrolled = scrolled_tabs(harness);
    let mut texts = texts(harness);
    texts.retain(|text| !is_among(&scrolled, text.place));
    (texts, window, field)
}

/// Panics with the list of faults, if there are any.
pub(crate) fn none(faults: &[String]) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}
