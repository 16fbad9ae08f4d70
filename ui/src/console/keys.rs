//! Keys with the same function in every view. The table of commands lists their functions.

use egui::{Context, Event, Key};
use nima_panels::roles::Role;

use crate::console::commands::{Action, CommandEntry, table};

/// Returns the space and Escape stop, wherever the keyboard focus is; the key press is consumed, so that it triggers no
/// button. In a text field, Space is a letter and only Escape stops.
pub(super) fn stop_pressed(ctx: &Context) -> bool {
    let writing = ctx.text_edit_focused();
    ctx.input_mut(|input| {
        let mut stop = false;
        input.events.retain(|event| match event {
            Event::Key { key: Key::Space, .. } if writing => true,
            Event::Key { key: Key::Space | Key::Escape, pressed, repeat, .. } => {
                stop |= *pressed && !*repeat;
                false
            }
            Event::Text(text) => writing || text != " ",
            _ => true,
        });
        stop
    })
}

/// Returns the role whose key was pressed, in a window that has no other commands.
pub(super) fn role_pressed(ctx: &Context) -> Option<Role> {
    ctx.input(|input| Role::ALL.into_iter().find(|role| input.key_pressed(role.key())))
}

/// Returns the commands whose keys were pressed, in their order; presses of those that `may` run are consumed. A key
/// with a function in the focused text field, or one that a part of the window reads itself, is left alone.
pub(super) fn pressed(ctx: &Context, may: impl Fn(Action) -> bool) -> Vec<Action> {
    let writing = ctx.text_edit_focused();
    let mut actions = Vec::new();
    let mut events = ctx.input(|input| input.events.clone());
    let came = events.len();
    events.retain(|event| {
        let Event::Key { key, pressed: true, repeat, modifiers, .. } = event else { return true };
        let strokes = |entry: &'static CommandEntry| entry.keys.iter().map(move |stroke| (entry.action, *stroke));
        let mut strokes = table().iter().filter(|entry| !entry.action.is_of_part()).flat_map(strokes);
        let Some((action, stroke)) = strokes.find(|(_, stroke)| stroke.key == *key && stroke.with.holds(*modifiers))
        else {
            return true;
        };
        if writing && stroke.writes() || !may(action) {
            return true;
        }
        if !*repeat || action.repeats() {
            actions.push(action);
        }
        false
    });
    if events.len() < came {
        ctx.input_mut(|input| input.events = events);
    }
    actions
}
