//! Tests that concern more than one file.

#[macro_use]
#[path = "../../../../tests/common/adapter.rs"]
mod adapter;
mod canvas;
#[path = "../../../../tests/common/mod.rs"]
mod common;
mod picture_shader;
#[path = "../../../../tests/common/shader_structs.rs"]
mod shader_structs;
