//! Paints a map in custom colours: the logarithm of the flip time gives the hue.
//!
//! `cargo run --release --example custom_palette` writes `rainbow.png`.
use flipmap::{EngineKind, EngineRequest, Outcome, Renderer, Scene, Status};
use image::{Rgb, RgbImage};

const SIDE: u32 = 96;

/// One turn of the colour circle per tenfold time; black where nothing flips.
fn colour(outcome: Outcome) -> Rgb<u8> {
    if outcome.status != Status::Answered {
        return Rgb([0; 3]);
    }
    let hue = std::f64::consts::TAU * outcome.time.log10();
    let part = |turn: f64| (127.5 + 127.5 * (hue + std::f64::consts::TAU * turn).cos()) as u8;
    Rgb([part(0.0), part(-1.0 / 3.0), part(1.0 / 3.0)])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
    let samples = Renderer::new(&request)?.render(&Scene::default(), [SIDE; 2])?;
    let pixel = |x: u32, y: u32| colour(samples.get((y * SIDE + x) as usize));
    RgbImage::from_fn(SIDE, SIDE, pixel).save("rainbow.png")?;
    println!("wrote rainbow.png");
    Ok(())
}
