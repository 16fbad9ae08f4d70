//! Keys with the same function in every view.

use egui::{Context, Event, Key};

use super::roles::Role;

/// Space and Escape stop, wherever the keyboard focus is; the key press is consumed, so that it triggers no button.
/// While a text is being entered, Space is a letter and only Escape stops.
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

/// The role whose key was pressed.
pub(super) fn role_pressed(ctx: &Context) -> Option<Role> {
    ctx.input(|input| Role::ALL.into_iter().find(|role| input.key_pressed(role.key())))
}

/// Whether the key that sets a mark was pressed.
pub(super) fn mark_pressed(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.key_pressed(Key::E))
}

/// Whether the key that keeps the session, or no longer keeps it, was pressed.
pub(super) fn keep_pressed(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.modifiers.is_none() && input.key_pressed(Key::K))
}

/// Whether the key that acknowledges alarms was pressed.
pub(super) fn acknowledge_pressed(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.modifiers.is_none() && input.key_pressed(Key::A))
}

/// Whether the key for the list of alarms was pressed.
pub(super) fn alarms_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F5))
}

/// Whether the key for the start page was pressed.
pub(super) fn start_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F6))
}

/// Whether the key for the list of recorded sessions was pressed.
pub(super) fn sessions_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F7))
}

/// Whether the key for user studies was pressed.
pub(super) fn studies_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F8))
}

/// Whether the key that leaves the past was pressed.
pub(super) fn live_pressed(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.modifiers.is_none() && input.key_pressed(Key::L))
}

/// Whether the key for the glossary was pressed.
pub(super) fn glossary_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F4))
}
