//! Keys that mean the same everywhere.

use egui::{Context, Event, Key};

use super::roles::Role;

/// Space and Escape stop, wherever the keyboard's focus is; nothing else sees them, so no button is pressed by them. While a name is
/// being written, Space is a letter and Escape alone stops.
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

/// This moment shall be marked.
pub(super) fn mark_pressed(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.key_pressed(Key::E))
}

/// Somebody has seen the alarms.
pub(super) fn acknowledge_pressed(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.modifiers.is_none() && input.key_pressed(Key::A))
}

/// The list of alarms shall be opened or closed.
pub(super) fn alarms_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F5))
}

/// The glossary shall be opened or closed.
pub(super) fn glossary_pressed(ctx: &Context) -> bool {
    ctx.input(|input| input.key_pressed(Key::F4))
}
