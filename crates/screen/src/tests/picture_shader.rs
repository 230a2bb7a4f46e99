//! The shader that draws the map, against its counterparts in Rust.

use std::mem::offset_of;

use super::shader_structs::members;
use crate::canvas::atlas::SLOTS_ALONG;
use crate::canvas::pipeline::{self, Uniforms};
use flipmap_engine::Trust;
use flipmap_pendulum::Status;
use flipmap_scene::lattice::SIDE;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// The value of a shader constant, as written in the shader.
fn constant<'a>(shader: &'a str, name: &str) -> &'a str {
    let line = shader.lines().find_map(|line| line.strip_prefix(&format!("const {name}: ")));
    let value = line.and_then(|line| line.split(" = ").nth(1)).expect("the constant is there");
    value.trim_end_matches(';').trim_end_matches('u')
}

#[test]
fn the_picture_shader_is_valid_and_has_the_same_counterparts() {
    let shader = pipeline::shader();
    let module = naga::front::wgsl::parse_str(&shader).unwrap();
    Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).unwrap();
    let uniforms = [
        ("value_bias", offset_of!(Uniforms, value_bias)),
        ("value_step", offset_of!(Uniforms, value_step)),
        ("first_value", offset_of!(Uniforms, first_value)),
        ("entries_per_unit", offset_of!(Uniforms, entries_per_unit)),
        ("until_value", offset_of!(Uniforms, until_value)),
        ("trust", offset_of!(Uniforms, trust)),
        ("coloured", offset_of!(Uniforms, coloured)),
        ("relief", offset_of!(Uniforms, relief)),
        ("unflipped", offset_of!(Uniforms, unflipped)),
        ("forbidden", offset_of!(Uniforms, forbidden)),
        ("failed", offset_of!(Uniforms, failed)),
        ("toward", offset_of!(Uniforms, toward)),
    ];
    let counterpart: Vec<_> = uniforms.iter().map(|(name, at)| (name.to_string(), *at)).collect();
    assert_eq!(members(&module, "Canvas"), counterpart);
    let names: Vec<String> = members(&module, "Quad").into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["corner", "right", "down", "texel", "span", "side", "slot", "alpha"]);
    let number = |name| constant(&shader, name).parse::<f64>().unwrap();
    for (name, counterpart) in [
        ("SIDE", f64::from(SIDE)),
        ("SLOTS_ALONG", f64::from(SLOTS_ALONG)),
        ("TABLE_ENTRIES", pipeline::TABLE_ENTRIES as f64),
        ("ANSWERED", f64::from(Status::Answered as u8)),
        ("FORBIDDEN", f64::from(Status::Forbidden as u8)),
        ("FAILED", f64::from(Status::Failed as u8)),
        ("UNCERTAIN", f64::from(Trust::Uncertain as u8)),
    ] {
        assert_eq!(number(name), counterpart, "{name}");
    }
}
