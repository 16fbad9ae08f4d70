//! Known devices by their USB ids.
//!
//! Sources: `devices.toml` of pyspacemouse 2.1.0 for the caps, published descriptions for the pedals; reference
//! `hid.md`.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HidKind {
    /// A six-axis cap; the length of the reports decides between split and combined.
    Cap,
    /// A pedal that reports as a keyboard (boot protocol).
    KeyboardPedal,
    /// A pedal with one bit per switch.
    SwitchPedal,
}

impl HidKind {
    /// Returns the text for a message.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Cap => "SpaceMouse",
            Self::KeyboardPedal | Self::SwitchPedal => "foot pedal",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HidModel {
    pub vendor: u16,
    pub product: u16,
    pub name: &'static str,
    pub kind: HidKind,
}

const fn model(vendor: u16, product: u16, name: &'static str, kind: HidKind) -> HidModel {
    HidModel { vendor, product, name, kind }
}

pub const MODELS: [HidModel; 18] = [
    model(0x046d, 0xc625, "SpacePilot", HidKind::Cap),
    model(0x046d, 0xc626, "SpaceNavigator", HidKind::Cap),
    model(0x046d, 0xc627, "SpaceExplorer", HidKind::Cap),
    model(0x046d, 0xc628, "SpaceNavigator for Notebooks", HidKind::Cap),
    model(0x046d, 0xc629, "SpacePilot Pro", HidKind::Cap),
    model(0x046d, 0xc62b, "SpaceMouse Pro", HidKind::Cap),
    model(0x256f, 0xc62e, "SpaceMouse Wireless (cabled)", HidKind::Cap),
    model(0x256f, 0xc62f, "SpaceMouse Wireless", HidKind::Cap),
    model(0x256f, 0xc632, "SpaceMouse Pro Wireless", HidKind::Cap),
    model(0x256f, 0xc633, "SpaceMouse Enterprise", HidKind::Cap),
    model(0x256f, 0xc635, "SpaceMouse Compact", HidKind::Cap),
    model(0x256f, 0xc638, "SpaceMouse Wireless (Bluetooth)", HidKind::Cap),
    model(0x256f, 0xc63a, "SpaceMouse Wireless (new)", HidKind::Cap),
    model(0x256f, 0xc641, "SpaceMouse Compact (new)", HidKind::Cap),
    model(0x256f, 0xc652, "3Dconnexion Universal Receiver", HidKind::Cap),
    model(0x0c45, 0x7403, "PCsensor FootSwitch", HidKind::KeyboardPedal),
    model(0x3553, 0xb001, "PCsensor FootSwitch (new)", HidKind::KeyboardPedal),
    model(0x05f3, 0x00ff, "VEC Infinity IN-USB-2", HidKind::SwitchPedal),
];

pub fn known(vendor: u16, product: u16) -> Option<&'static HidModel> {
    MODELS.iter().find(|model| (model.vendor, model.product) == (vendor, product))
}
