//! The section of a scene file.

use crate::physics::{ObjectSettings, RingStart};

#[test]
fn an_empty_section_is_the_peg_transfer_of_fls_and_survives_a_file() {
    let setting: ObjectSettings = toml::from_str("").unwrap();
    assert_eq!(setting, ObjectSettings::default());
    setting.validate().unwrap();
    assert_eq!((setting.pegs.position_m.len(), setting.rings.len()), (12, 6));
    assert_eq!(toml::from_str::<ObjectSettings>(&toml::to_string(&setting).unwrap()).unwrap(), setting);
    let text = "rings = [{ peg = 3 }, { at_m = [0.0, 0.01, 0.02] }]\nfriction = { jaw_ring = 0.5 }";
    let setting: ObjectSettings = toml::from_str(text).unwrap();
    assert_eq!(setting.rings, [RingStart::Peg(3), RingStart::At([0.0, 0.01, 0.02])]);
    assert!(toml::from_str::<ObjectSettings>("colour = 3").is_err());
}

#[test]
fn a_value_out_of_range_is_named() {
    let refused = |text: &str| toml::from_str::<ObjectSettings>(text).unwrap().validate().unwrap_err().to_string();
    for (text, named) in [
        ("rings = [{ peg = 12 }]", "rings.peg = 12"),
        ("pegs = { radius_m = 0.006 }", "pegs.radius_m = 0.006"),
        ("ring = { mass_kg = nan }", "ring.mass_kg = NaN"),
        ("friction = { jaw_ring = 9.0 }", "friction.jaw_ring = 9"),
        ("contact = { ring_stiffness_n_m = 1e9 }", "contact.ring_stiffness_n_m"),
        ("view = { from_m = [0.5, 0.0, 0.0] }", "view.to_m = 0.06"),
        ("board = { size_m = [0.0, 0.1] }", "board.size_m = 0"),
    ] {
        let message = refused(text);
        assert!(message.contains(named) && message.contains("must be"), "{message}");
    }
}
