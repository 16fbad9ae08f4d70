//! Known devices by their USB ids.
//!
//! Sources: `devices.toml` of pyspacemouse 2.1.0 for the caps, published descriptions for the pedals; reference
//! `hid.md`.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A six-axis cap; the length of the reports decides between split and combined.
    Cap,
    /// A pedal that reports as a keyboard (boot protocol).
    KeyboardPedal,
    /// A pedal with one bit per switch.
    SwitchPedal,
}

impl Kind {
    /// Returns the text for a message.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Cap => "SpaceMouse",
            Self::KeyboardPedal | Self::SwitchPedal => "foot pedal",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Model {
    pub vendor: u16,
    pub product: u16,
    pub name: &'static str,
    pub kind: Kind,
}

const fn model(vendor: u16, product: u16, name: &'static str, kind: Kind) -> Model {
    Model { vendor, product, name, kind }
}

pub const MODELS: [Model; 18] = [
    model(0x046d, 0xc625, "SpacePilot", Kind::Cap),
    model(0x046d, 0xc626, "SpaceNavigator", Kind::Cap),
    model(0x046d, 0xc627, "SpaceExplorer", Kind::Cap),
    model(0x046d, 0xc628, "SpaceNavigator for Notebooks", Kind::Cap),
    model(0x046d, 0xc629, "SpacePilot Pro", Kind::Cap),
    model(0x046d, 0xc62b, "SpaceMouse Pro", Kind::Cap),
    model(0x256f, 0xc62e, "SpaceMouse Wireless (cabled)", Kind::Cap),
    model(0x256f, 0xc62f, "SpaceMouse Wireless", Kind::Cap),
    model(0x256f, 0xc632, "SpaceMouse Pro Wireless", Kind::Cap),
    model(0x256f, 0xc633, "SpaceMouse Enterprise", Kind::Cap),
    model(0x256f, 0xc635, "SpaceMouse Compact", Kind::Cap),
    model(0x256f, 0xc638, "SpaceMouse Wireless (Bluetooth)", Kind::Cap),
    model(0x256f, 0xc63a, "SpaceMouse Wireless (new)", Kind::Cap),
    model(0x256f, 0xc641, "SpaceMouse Compact (new)", Kind::Cap),
    model(0x256f, 0xc652, "3Dconnexion Universal Receiver", Kind::Cap),
    model(0x0c45, 0x7403, "PCsensor FootSwitch", Kind::KeyboardPedal),
    model(0x3553, 0xb001, "PCsensor FootSwitch (new)", Kind::KeyboardPedal),
    model(0x05f3, 0x00ff, "VEC Infinity IN-USB-2", Kind::SwitchPedal),
];

pub fn known(vendor: u16, product: u16) -> Option<&'static Model> {
    MODELS.iter().find(|model| (model.vendor, model.product) == (vendor, product))
}
