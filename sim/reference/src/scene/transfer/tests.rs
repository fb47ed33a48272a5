//! Tests of transfer functions: interpolation, presets, the file format and its messages.

use super::*;
use crate::scene::damage_tests::{assert_refused, assert_refused_with};

const GOOD: &str = "
[[value]]
at = 10
colour = [0.0, 0.5, 1.0]
extinction = 0.0
[[value]]
at = 20.0
colour = [1.0, 0.5, 0.0]
extinction = 4.0
[[gradient]]
at = 0.0
multiplier = 0.0
[[gradient]]
at = 8.0
multiplier = 2.0
[shading]
ambient = 0.5
";

#[test]
fn control_points_are_joined_linearly_and_end_flat() {
    let transfer = Transfer::from_toml(GOOD).unwrap();
    assert_eq!(transfer.at_value(0.0), ([0.0, 0.5, 1.0], 0.0));
    assert_eq!(transfer.at_value(10.0), ([0.0, 0.5, 1.0], 0.0));
    assert_eq!(transfer.at_value(12.5), ([0.25, 0.5, 0.75], 1.0));
    assert_eq!(transfer.at_value(20.0), ([1.0, 0.5, 0.0], 4.0));
    assert_eq!(transfer.at_value(1e300), ([1.0, 0.5, 0.0], 4.0));
    assert_eq!(transfer.at_gradient(2.0), 0.5);
    assert_eq!(transfer.at_gradient(99.0), 2.0);
    assert_eq!(
        transfer.shading,
        Shading {
            ambient: 0.5,
            ..Shading::default()
        }
    );
}

#[test]
fn presets_and_ramp_are_well_formed() {
    for stem in ["brainsmall", "aneurism", "fuel", "nucleon", "headsq"] {
        assert_well_formed(&Transfer::preset(stem).unwrap());
    }
    assert!(Transfer::preset("teapot").is_none());
    assert_well_formed(&Transfer::ramp(-5.0, 100.0, 2.0));
    let ramp = Transfer::ramp(0.0, 100.0, 2.0);
    assert_eq!(ramp.at_value(20.0).1, 0.0);
    assert!(ramp.at_value(100.0).1 > ramp.at_value(50.0).1);
    // A constant volume has no range but still a ramp.
    assert!(Transfer::ramp(7.0, 7.0, 1.0).at_value(7.0).1.is_finite());
}

fn assert_well_formed(transfer: &Transfer) {
    assert!(
        transfer
            .values
            .windows(2)
            .all(|pair| pair[0].at < pair[1].at)
    );
    assert!(
        transfer
            .gradients
            .windows(2)
            .all(|pair| pair[0].at < pair[1].at)
    );
    assert_eq!(
        transfer.values[0].extinction, 0.0,
        "the background is transparent"
    );
    assert!(
        transfer
            .values
            .iter()
            .flat_map(|point| point.colour)
            .all(|channel| (0.0..=1.0).contains(&channel))
    );
}

#[test]
fn each_message_names_the_key_and_the_line() {
    let load = |text: &[u8]| Transfer::from_toml(&String::from_utf8_lossy(text));
    let table = r#"
        at = 20.0 => at = 5.0 => transfer line 7, key 'value.at': it is 5 after 10; order the control points
        at = 8.0 => at = nan => transfer line 14, key 'gradient.at': it is NaN after 0; order
        extinction = 4.0 => extinction = -4.0 => transfer line 9, key 'value.extinction': it is -4; write a number
        multiplier = 2.0 => multiplier = inf => transfer line 15, key 'gradient.multiplier': it is inf; write
        [1.0, 0.5, 0.0] => [1.0, 0.5, 2.0] => transfer line 8, key 'value.colour': it is [1.0, 0.5, 2.0]; write RGB
        ambient = 0.5 => ambient = -0.5 => transfer line 17, key 'shading.ambient': it is -0.5; write
        ambient = 0.5 => ambience = 0.5 => transfer line 17, 'ambience = 0.5': unknown field `ambience`
        at = 20.0 => at = "x" => transfer line 7, 'at = "x"': invalid type
        extinction = 4.0\n => => missing field `extinction`
    "#;
    assert_refused_with(GOOD.as_bytes(), table, load);
    let missing = "transfer, key 'value': it is missing; add [[value]] control points";
    assert_refused(&[("", missing)], load);
}
