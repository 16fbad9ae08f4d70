//! The frame around playback: a header with the moment on the screen, and the time line below every view.

use egui::{
    Align, Button, Color32, FontId, Frame, Label, Layout, Margin, Panel, Rect, Response, RichText, Sense, Stroke,
    TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use nima_machine::messages::LoopState;
use nima_screen::{
    alarms::judge,
    theme,
    widgets::{Sign, fitting_style, sign, weak},
};
use nima_session::file::LineKind;
use nima_words::{report_text::newtons, text};

use super::{
    Playback, SPEEDS,
    overview::{BUCKET_S, EventNote, Overview, OverviewBucket},
    signals_view::known,
};

const HEAD: f32 = 54.0;
const BAR: f32 = 118.0;
const STRIP: f32 = 54.0;
/// Minimum width of a message at the end of a row.
const MESSAGE: f32 = 60.0;
/// Height of the states at the bottom of the strip.
const STATES: f32 = 7.0;
/// Height of the marks at its top.
const MARKS: f32 = 10.0;
const BUTTON: f32 = 30.0;
/// A mark is under the pointer within this distance, points.
const NEAR: f32 = 5.0;
/// Width that a time on the ruler needs.
const LABEL: f32 = 90.0;
/// Width of the frame.
pub const FRAME: f32 = 4.0;

/// Draws the header; returns true when the operator returns to the machine.
pub fn head_ui(ui: &mut Ui, past: &Playback) -> bool {
    let mut live_again = false;
    let colours = theme::now();
    let frame = Frame::new().fill(colours.past).inner_margin(Margin::symmetric(14, 0));
    Panel::top("past").exact_size(HEAD).resizable(false).frame(frame).show(ui, |ui| {
        let ink = colours.background;
        ui.horizontal_centered(|ui| {
            let word = RichText::new(text::playback::PAST).font(theme::strong(20.0)).color(ink);
            ui.label(word).on_hover_text(text::playback::PAST_HOVER);
            ui.add_space(8.0);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let words = RichText::new(text::playback::LIVE_AGAIN).font(theme::strong(16.0));
                let button = Button::new(words).min_size(vec2(150.0, 40.0)).corner_radius(theme::CORNER);
                live_again = ui.add(button).on_hover_text(text::playback::LIVE_AGAIN_HOVER).clicked();
                ui.add_space(12.0);
                machine_ui(ui, ink);
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| words_ui(ui, past, ink));
            });
        });
    });
    live_again
}

/// Draws the part of the screen that is not recorded.
fn machine_ui(ui: &mut Ui, ink: Color32) {
    let words = RichText::new(text::playback::MACHINE).font(theme::strong(13.0)).color(ink);
    ui.label(words).on_hover_text(text::playback::PAST_HOVER);
    let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
    let points = [vec2(0.0, -6.0), vec2(6.0, 4.0), vec2(-6.0, 4.0)].map(|point| rect.center() + point);
    ui.painter().add(egui::Shape::convex_polygon(points.to_vec(), ink, Stroke::NONE));
}

/// Draws the time of the moment, the extent of its replay, and its alarm.
fn words_ui(ui: &mut Ui, past: &Playback, ink: Color32) {
    ui.vertical(|ui| {
        ui.add_space(6.0);
        ui.spacing_mut().item_spacing.y = 1.0;
        let line = |ui: &mut Ui, words: String, font: FontId| {
            ui.add(Label::new(RichText::new(&words).font(font).color(ink)).truncate()).on_hover_text(words);
        };
        let name = past.path.file_name().unwrap_or_default().to_string_lossy();
        let when = past.about.map(|about| text::playback::when(about.begin_ns + (past.shown_s() * 1e9) as u64));
        let when = when.unwrap_or_else(|| text::playback::OPENING.get().to_owned());
        // The date of another program's recording is not known.
        let words = if past.is_foreign() { name.into_owned() } else { text::playback::of_session(&when, &name) };
        line(ui, words, theme::strong(16.0));
        let shown = past.live.as_ref().filter(|_| !past.is_foreign());
        let alarm = shown.and_then(|live| judge(&live.signs(false, None)).into_iter().next());
        let words = match (&past.report.refused, alarm) {
            (Some(refused), _) => refused.clone(),
            (None, Some(alarm)) => text::playback::alarm_then(alarm.priority.word(), &alarm.cause),
            (None, None) => past.signals.as_ref().map_or_else(|| extent(past).to_owned(), |signals| known(signals)),
        };
        line(ui, words, theme::regular(13.0));
    });
}

/// Returns the text about the extent of the replay.
fn extent(past: &Playback) -> &'static str {
    if past.is_whole() {
        text::playback::WHOLE.get()
    } else if past.report.limited.is_some() {
        text::playback::PLOTTED_ONLY.get()
    } else {
        text::playback::PLOTTED.get()
    }
}

/// Draws the time line and its buttons.
pub fn bar_ui(ui: &mut Ui, past: &mut Playback) {
    let frame = Frame::new().fill(theme::now().panel).inner_margin(Margin::symmetric(14, 6));
    Panel::bottom("timeline").exact_size(BAR).resizable(false).frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.horizontal(|ui| buttons_ui(ui, past));
        strip_ui(ui, past);
    });
}

fn buttons_ui(ui: &mut Ui, past: &mut Playback) {
    let ctx = ui.ctx().clone();
    let name = if past.play.runs { text::playback::PAUSE.get() } else { text::playback::PLAY.get() };
    let play = Button::new(RichText::new(name).font(theme::strong(14.0))).min_size(vec2(70.0, BUTTON));
    let play = ui.add_enabled(past.live.is_some(), play).on_hover_text(text::playback::PLAY_HOVER);
    let blocked = past.blocked();
    let blocked = blocked.as_deref();
    if play.on_disabled_hover_text(blocked.unwrap_or(text::playback::OPENING.get())).clicked() {
        past.toggle();
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for speed in SPEEDS {
            let chosen = (past.play.speed - speed).abs() < 1e-9;
            let button = Button::selectable(chosen, text::playback::speed(speed)).frame_when_inactive(true);
            if ui.add(button.min_size(vec2(40.0, BUTTON))).on_hover_text(text::playback::SPEED_HOVER).clicked() {
                past.play.speed = speed;
            }
        }
    });
    let end_s = past.about.map_or(0.0, |about| about.end_s);
    ui.add_space(6.0);
    let place = RichText::new(text::playback::position(past.shown_s(), end_s)).font(theme::strong(15.0));
    ui.add_sized(vec2(176.0, BUTTON), Label::new(place));
    for (at, name, meaning) in [
        (0, text::playback::FROM.get(), text::playback::FROM_HOVER.get()),
        (1, text::playback::TO.get(), text::playback::TO_HOVER.get()),
    ] {
        let set = past.stretch_s[at].is_some();
        let button = Button::selectable(set, name).frame_when_inactive(true).min_size(vec2(50.0, BUTTON));
        let button = ui.add_enabled(past.live.is_some() && blocked.is_none(), button).on_hover_text(meaning);
        if button.on_disabled_hover_text(blocked.unwrap_or(text::playback::OPENING.get())).clicked() {
            past.stretch_s[at] = Some(past.shown_s());
        }
    }
    let free = past.job.is_none() && blocked.is_none();
    let save = Button::new(text::playback::SAVE).min_size(vec2(112.0, BUTTON));
    let save = ui.add_enabled(free && past.stretch_s().is_some(), save).on_hover_text(text::playback::SAVE_HOVER);
    if save.on_disabled_hover_text(blocked.unwrap_or(text::playback::SAVE_DISABLED_HOVER.get())).clicked() {
        past.save(&ctx);
    }
    let report = Button::new(text::playback::REPORT).min_size(vec2(64.0, BUTTON));
    let report = ui.add_enabled(free, report).on_hover_text(text::playback::REPORT_HOVER);
    let why = blocked.map(str::to_owned).or_else(|| past.report.job.clone()).unwrap_or_default();
    if report.on_disabled_hover_text(why).clicked() {
        past.report(&ctx);
    }
    let other = past.beside.is_some();
    let compare = Button::selectable(other, text::playback::COMPARE).frame_when_inactive(true);
    let compare = ui.add(compare.min_size(vec2(80.0, BUTTON))).on_hover_text(text::playback::COMPARE_HOVER);
    if compare.clicked() {
        past.wants_beside = !other;
        past.beside = None;
    }
    let fraction = past.read_share();
    let reading = (fraction < 0.999 && past.report.refused.is_none()).then(|| text::playback::read(fraction));
    let words = past.report.job.clone().or_else(|| past.report.trouble()).or(reading);
    if let Some(words) = words {
        // If the row has no room for it, the time line alone shows the reading progress.
        if ui.available_width() < MESSAGE {
            return;
        }
        let first = words.lines().next().unwrap_or_default();
        let font = fitting_style(ui, first, &TextStyle::Small, ui.available_width());
        ui.add(Label::new(weak(first).font(font)).truncate()).on_hover_text(words);
    }
}

fn strip_ui(ui: &mut Ui, past: &mut Playback) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), STRIP + 16.0), Sense::click_and_drag());
    let strip = Rect::from_min_size(rect.min, vec2(rect.width(), STRIP));
    let Some(end_s) = past.about.map(|about| about.end_s).filter(|end_s| *end_s > 0.0) else { return };
    let shown_s = past.shown_s();
    response.widget_info(|| WidgetInfo::slider(true, shown_s, text::playback::TIMELINE.get()));
    let painter = ui.painter_at(rect.expand(2.0));
    painter.rect_filled(strip, 3.0, theme::now().groove);
    let x_of = |t_s: f64| strip.left() + (t_s / end_s).clamp(0.0, 1.0) as f32 * strip.width();
    forces(&painter, strip, &past.overview, end_s);
    if let Some(stretch_s) = past.stretch_s() {
        let [from, to] = [stretch_s.start, stretch_s.end].map(x_of);
        let stretch = Rect::from_min_max(pos2(from, strip.top()), pos2(to, strip.bottom()));
        painter.rect_filled(stretch, 0.0, theme::now().past.gamma_multiply(0.25));
    }
    for edge_s in past.stretch_s.iter().flatten() {
        painter.vline(x_of(*edge_s), strip.y_range(), Stroke::new(1.5, theme::now().past));
    }
    // Draw the most urgent ones last, on top of the others.
    for kind in [LineKind::Told, LineKind::Happening, LineKind::Warning, LineKind::Mark, LineKind::Fault] {
        for note in past.overview.notes.iter().filter(|note| note.kind == kind) {
            mark(&painter, strip, x_of(note.t_s), kind);
        }
    }
    let x = x_of(shown_s);
    painter.vline(x, strip.y_range(), Stroke::new(2.5, theme::now().text));
    sign(&painter, Sign::Disc, pos2(x, strip.top()), 5.0, theme::now().text);
    for t_s in round_times(end_s, f64::from(strip.width() / LABEL)) {
        let align = if t_s > 0.0 { egui::Align2::CENTER_TOP } else { egui::Align2::LEFT_TOP };
        let place = pos2(x_of(t_s), strip.bottom() + 2.0);
        painter.text(place, align, text::playback::short_clock(t_s), theme::regular(12.0), theme::now().text_weak);
        painter.vline(x_of(t_s), strip.bottom() - 4.0..=strip.bottom(), Stroke::new(1.0, theme::now().text_weak));
    }
    point(past, response, strip, end_s);
}

/// Returns the round times of the ruler, s: at most this many, and none so close to the end that its number would be cut.
fn round_times(end_s: f64, most: f64) -> Vec<f64> {
    const STEPS_S: [f64; 14] =
        [1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0];
    let fits = |step_s: &f64| end_s / step_s <= most;
    let step_s = STEPS_S.into_iter().find(fits).unwrap_or((end_s / most / 7200.0).ceil() * 7200.0);
    let last = ((end_s - 0.35 * end_s / most) / step_s).max(0.0) as u32;
    (0..=last).map(|number| f64::from(number) * step_s).collect()
}

/// Shows the moment under a pressed pointer, and the text of a mark under a hovering one.
fn point(past: &mut Playback, response: Response, strip: Rect, end_s: f64) {
    let Some(pointer) = response.interact_pointer_pos().or(response.hover_pos()) else { return };
    let t_s = f64::from((pointer.x - strip.left()) / strip.width()) * end_s;
    if response.is_pointer_button_down_on() || response.clicked() {
        if (t_s.clamp(0.0, end_s) - past.wanted_s).abs() > 1e-9 {
            past.show(t_s);
        }
        return;
    }
    let near_s = f64::from(NEAR / strip.width()) * end_s;
    let near = |note: &&EventNote| (note.t_s - t_s).abs() < near_s;
    let mut notes: Vec<&EventNote> = past.overview.notes.iter().filter(near).collect();
    notes.sort_by_key(|note| note.kind);
    let lines: Vec<String> = notes.iter().take(6).map(|note| text::playback::at(note.t_s, &note.words)).collect();
    let bucket = past.overview.buckets.get((t_s / BUCKET_S) as usize).copied().unwrap_or_default();
    let words = if lines.is_empty() {
        let of = |force_n: Option<f32>| newtons(force_n.map(f64::from), 2);
        text::playback::largest(t_s, &of(bucket.measured_n), &of(bucket.rendered_n))
    } else {
        lines.join("\n")
    };
    response.on_hover_ui_at_pointer(|ui| {
        ui.label(weak(words));
    });
}

fn mark(painter: &egui::Painter, strip: Rect, x: f32, kind: LineKind) {
    let colour = match kind {
        LineKind::Fault => theme::now().alarm_high,
        LineKind::Warning => theme::now().alarm_medium,
        LineKind::Mark | LineKind::Happening => theme::now().text,
        LineKind::Told => theme::now().text_weak,
    };
    // The operator's marks span the strip, as in the traces.
    let foot = if kind == LineKind::Mark { strip.bottom() } else { strip.top() + MARKS };
    painter.vline(x, strip.top()..=foot, Stroke::new(2.0, colour));
}

/// Draws the maximum forces and the states, one column per point of the strip.
fn forces(painter: &egui::Painter, strip: Rect, overview: &Overview, end_s: f64) {
    let forces_n = overview.buckets.iter().flat_map(|one| [one.measured_n, one.rendered_n]).flatten();
    let largest_n = forces_n.fold(0.5, f32::max);
    let room = strip.height() - STATES - MARKS - 2.0;
    let foot = strip.bottom() - STATES;
    let columns = strip.width() as usize;
    for column in 0..columns {
        let [from, to] = [column, column + 1].map(|at| at as f64 / columns as f64 * end_s / BUCKET_S);
        let last = (to.ceil() as usize).max(from as usize + 1).min(overview.buckets.len());
        let Some(buckets) = overview.buckets.get(from as usize..last) else { break };
        let mut max = OverviewBucket::default();
        for one in buckets {
            max.merge(one);
        }
        let x = strip.left() + column as f32 + 0.5;
        let top = |force_n: f32| foot - room * force_n / largest_n;
        if let Some(measured_n) = max.measured_n {
            painter.vline(x, top(measured_n)..=foot, Stroke::new(1.0, theme::now().measured.gamma_multiply(0.6)));
        }
        // Draw the rendered force as a line over the measured force, as in the traces.
        if let Some(rendered_n) = max.rendered_n.filter(|rendered_n| *rendered_n > 0.0) {
            let rendered = top(rendered_n);
            painter.vline(x, rendered - 1.0..=rendered + 1.0, Stroke::new(1.0, theme::now().rendered));
        }
        if let Some(state) = max.state {
            painter.vline(x, foot + 1.0..=strip.bottom(), Stroke::new(1.0, colour_of(state)));
        }
    }
}

fn colour_of(state: LoopState) -> Color32 {
    match state {
        LoopState::Engaged | LoopState::Ready | LoopState::Clutched => theme::now().engaged,
        LoopState::Idle => theme::now().at_rest.gamma_multiply(0.5),
        LoopState::Disconnected => theme::now().line,
        LoopState::Stopped => theme::now().stop,
        LoopState::Faulted(_) => theme::now().alarm_high,
    }
}

#[cfg(test)]
mod tests {
    use super::round_times;

    #[test]
    fn the_ruler_has_round_times_with_room_for_each() {
        for (end_s, most, step_s, count) in [(7.3, 8.0, 1.0, 7), (75.0, 8.0, 10.0, 8), (4000.0, 10.0, 600.0, 7)] {
            let times_s = round_times(end_s, most);
            assert_eq!(times_s.len(), count, "{end_s} {times_s:?}");
            assert!(times_s.iter().enumerate().all(|(number, t_s)| (t_s - number as f64 * step_s).abs() < 1e-9));
        }
        assert!(round_times(1e6, 5.0).len() <= 6);
        assert_eq!(round_times(0.4, 8.0).len(), 1);
    }
}
