//! Computes a map and writes its flip times as a NumPy array, NaN where nothing flips.
//!
//! `cargo run --release --example map_to_array` writes `map.npy`.

use flipmap::{Document, EngineKind, EngineRequest, NpyWriter, Renderer};
use std::fs::File;

const SIZE: [u32; 2] = [96, 64];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = "[view]\ncenter = [\"-1.66\", \"0.1\"]\nwidth = \"0.5\"";
    let scene = Document::parse(text)?.scene().checked()?;
    let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
    let mut renderer = Renderer::new(&request)?;
    let samples = renderer.render(&scene, SIZE)?;

    let mut array = NpyWriter::new(File::create("map.npy")?, SIZE, 0..1)?;
    array.write(&samples)?;
    let counts = renderer.counts();
    println!("{} of {} pixels flip within the budget", counts.flipped, counts.pixels);
    Ok(())
}
