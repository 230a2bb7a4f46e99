//! The map on the card is the map of the samples: each pixel's colour held against the palette.

#[macro_use]
#[path = "common/adapter.rs"]
mod adapter;

use flipmap::app::camera::{Camera, Screen};
use flipmap::app::canvas::colours::colours;
use flipmap::app::canvas::pipeline::{Canvas, Frame};
use flipmap::app::canvas::{Easel, LAYERS};
use flipmap::app::hover::outcome_at;
use flipmap::engine::choice::INSTALL_HINT;
use flipmap::engine::gpu::device::{Gpu, adapters};
use flipmap::engine::mock::MockEngine;
use flipmap::engine::{Method, Precision, Recipe};
use flipmap::physics::{Dd, Rule};
use flipmap::scene::palette::{Rgb, Tones};
use flipmap::scene::{Build, PictureTable, Question};
use flipmap::tiles::explorer::{Aim, Explorer, Physics};
use glam::DVec2;

/// Side of the canvas in pixels: two cells.
const SIDE: u32 = 256;
const LEVEL: u32 = 2;

needs_adapter! {
    checks:
    every_pixel_has_the_colour_of_its_sample
    other_colours_need_no_other_samples
    a_coarser_tile_stands_in_blurred_and_not_elsewhere
    a_lowered_budget_hides_late_flips
}

/// Two by two cells about a corner that they share, one sample a pixel.
fn screen() -> Screen {
    let center = [Dd::PI * Dd::new(0.5), Dd::new(0.0)];
    let width_rad = std::f64::consts::PI;
    let camera = Camera { center, width_rad, rotate_deg: 0.0, stretch: 1.0 };
    Screen { camera, size: DVec2::splat(f64::from(SIDE)), pixels_per_point: 1.0 }
}

fn explored(level: u32) -> Explorer {
    let recipe = Recipe { method: Method::LESSON, precision: Precision::F32 };
    let physics = Physics { build: Build::default(), rule: Rule::Second, recipe, verified: false };
    let region = screen().region().scaled(0.999);
    let mut explorer = Explorer::new(1 << 28);
    explorer.aim(Aim { physics, budget_secs: 30.0, region, level, pointer: None });
    explorer.work(&mut MockEngine::default(), None).unwrap();
    explorer
}

/// What the card draws of a screen, row by row.
struct Card {
    gpu: Gpu,
    canvas: Canvas,
    easel: Easel,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl Card {
    fn new() -> Self {
        let adapter = adapters().into_iter().next_back();
        let adapter = adapter.unwrap_or_else(|| {
            panic!("{INSTALL_HINT}; or declare its absence with FLIPMAP_NO_GPU=1")
        });
        let gpu = Gpu::open(adapter).unwrap();
        let canvas = Canvas::new(&gpu.device, FORMAT, LAYERS);
        Card { gpu, canvas, easel: Easel::default() }
    }

    fn picture(
        &mut self,
        explorer: &mut Explorer,
        picture: &PictureTable,
        budget: f64,
    ) -> (Vec<Rgb>, usize) {
        let question = Question { budget, ..Question::default() };
        let (uniforms, table) = colours(picture, &Build::default(), &question, true).unwrap();
        let frame = self.easel.frame(&screen(), explorer, uniforms, table);
        let uploads = frame.uploads.len();
        (self.draw(&frame), uploads)
    }

    fn draw(&mut self, frame: &Frame) -> Vec<Rgb> {
        let Gpu { device, queue, .. } = &self.gpu;
        self.canvas.load(device, queue, frame);
        let size = wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 };
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let bytes = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(4 * SIDE * SIDE),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let view = target.create_view(&Default::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
                depth_slice: None,
            })],
            ..Default::default()
        });
        let mut pass = pass.forget_lifetime();
        self.canvas.draw(&mut pass);
        drop(pass);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * SIDE),
            rows_per_image: None,
        };
        let into = wgpu::TexelCopyBufferInfo { buffer: &bytes, layout };
        encoder.copy_texture_to_buffer(target.as_image_copy(), into, size);
        queue.submit([encoder.finish()]);
        bytes.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let mapped = bytes.get_mapped_range(..).unwrap();
        mapped.chunks(4).map(|rgba| [rgba[0], rgba[1], rgba[2]]).collect()
    }
}

/// What the palette says of the samples under the pixels.
fn expected(explorer: &mut Explorer, picture: &PictureTable, level: u32) -> Vec<Rgb> {
    let build = Build::default();
    let tones = Tones::new(picture, build.unit_secs(), Question::default().budget).unwrap();
    let screen = screen();
    let middle = f64::from(SIDE) / 2.0;
    (0..SIDE * SIDE)
        .map(|index| {
            let pixel = DVec2::new(f64::from(index % SIDE), f64::from(index / SIDE));
            let angle = screen.angle_at(pixel + 0.5 - middle);
            let (outcome, _) = outcome_at(explorer, angle, level).expect("it is known");
            tones.colour(&outcome)
        })
        .collect()
}

/// Share of pixels whose channels are at most two steps apart.
fn alike(a: &[Rgb], b: &[Rgb]) -> f64 {
    let near = |(a, b): &(&Rgb, &Rgb)| a.iter().zip(*b).all(|(a, b)| a.abs_diff(*b) <= 2);
    a.iter().zip(b).filter(near).count() as f64 / a.len() as f64
}

mod checks {
    use super::*;

    pub fn every_pixel_has_the_colour_of_its_sample() {
        let (mut card, mut explorer) = (Card::new(), explored(LEVEL));
        // All the colours over the times of the mock, so that every pixel differs from the next.
        let picture = PictureTable { times: vec![10.0, 13.0], ..PictureTable::default() };
        let (drawn, uploads) = card.picture(&mut explorer, &picture, 30.0);
        let expected = expected(&mut explorer, &picture, LEVEL);
        // Half of the cells are drawn from their images; the table has steps of its own.
        assert!(alike(&drawn, &expected) > 0.99, "{}", alike(&drawn, &expected));
        assert!(uploads <= 9);
        let mut wrong = drawn.clone();
        wrong.rotate_left(7);
        let alike = alike(&wrong, &expected);
        assert!(alike < 0.9, "the comparison can fail: {alike}");
    }

    pub fn other_colours_need_no_other_samples() {
        let (mut card, mut explorer) = (Card::new(), explored(LEVEL));
        card.picture(&mut explorer, &PictureTable::default(), 30.0);
        let simulated = explorer.counts().simulated;
        let magma = PictureTable {
            palette: "magma".to_string(),
            reverse: true,
            cycles: 2.0,
            ..PictureTable::default()
        };
        let (drawn, uploads) = card.picture(&mut explorer, &magma, 30.0);
        let expected = expected(&mut explorer, &magma, LEVEL);
        assert!(alike(&drawn, &expected) > 0.98, "{}", alike(&drawn, &expected));
        assert_eq!((uploads, explorer.counts().simulated), (0, simulated));
    }

    pub fn a_coarser_tile_stands_in_blurred_and_not_elsewhere() {
        let (mut card, mut fine, mut coarse) = (Card::new(), explored(LEVEL), explored(LEVEL - 2));
        let picture = PictureTable::default();
        let expected = expected(&mut fine, &picture, LEVEL);
        let (drawn, _) = card.picture(&mut coarse, &picture, 30.0);
        let near = |(a, b): &(&Rgb, &Rgb)| a.iter().zip(*b).all(|(a, b)| a.abs_diff(*b) <= 24);
        let share = drawn.iter().zip(&expected).filter(near).count() as f64 / drawn.len() as f64;
        assert!(share > 0.9, "{share}");
        assert!(alike(&drawn, &expected) < 0.999, "it is the coarse one");
    }

    pub fn a_lowered_budget_hides_late_flips() {
        use flipmap::scene::palette::UNFLIPPED;
        let (mut card, mut explorer) = (Card::new(), explored(LEVEL));
        let white = |drawn: &[Rgb]| drawn.iter().filter(|rgb| **rgb == UNFLIPPED).count();
        let picture = PictureTable { times: vec![1.0, 30.0], ..PictureTable::default() };
        let (all, _) = card.picture(&mut explorer, &picture, 30.0);
        let (early, _) = card.picture(&mut explorer, &picture, 11.0);
        assert!(white(&early) > white(&all) + 1000, "{} {}", white(&early), white(&all));
    }
}
