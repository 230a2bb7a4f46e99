//! The window and `render` draw by different code: the same starts have the same colours at every
//! depth, and the same light from the side.

use crate::camera::Screen;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::BALANCED;
use flipmap_engine::{Engine, IntegratorConfig};
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::Status;
use flipmap_render::output::{RowOrder, RowPainter};
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_render::tiles::{Samples, Work};
use flipmap_scene::lattice::{Cell, pitch_rad, side_rad};
use flipmap_scene::palette::equalised;
use flipmap_scene::{BuiltIn, PictureTable, Scene};

use crate::tests::canvas::offscreen::{Paint, SIZE, Studio};
use crate::tests::canvas::{PLAIN, beyond};

needs_adapter! {
    checks:
    a_render_has_the_colours_of_the_window_wide_and_deep
}

fn engine() -> DepthEngine<'static> {
    DepthEngine::new(Box::new(CpuEngine::new(None).unwrap()), None).unwrap()
}

/// Returns a screen with one sample per pixel, about as wide as a scene's view, around a common
/// corner of cells near the centre of the view.
fn aligned(scene: &Scene) -> Screen {
    let pixel = scene.view.width_rad().hi / f64::from(SIZE[0]);
    let level = (0..).find(|&level| pitch_rad(level) <= pixel).unwrap();
    let half = Exact::from_f64(side_rad(level) / 2.0);
    let cell = Cell::around(scene.view.center_rad(), level);
    crate::tests::canvas::screen(cell.center().map(|theta| theta + half), level)
}

fn rendered(scene: &Scene, config: IntegratorConfig, engine: &mut dyn Engine) -> Samples {
    let mut work = Work::new(scene, SIZE, config, 1 << 14);
    let (mut rows, mut all) = (RowOrder::default(), Samples::unflipped(0));
    while !work.is_done() {
        for tile in work.work(engine, None).unwrap() {
            rows.push(tile).into_iter().for_each(|samples| all.append(samples));
        }
    }
    all
}

fn painted(scene: &Scene, picture: &PictureTable, samples: &Samples) -> Vec<[u8; 3]> {
    let mut painter = RowPainter::new(scene, SIZE, picture).unwrap();
    painter.paint(samples).as_chunks::<3>().0.to_vec()
}

mod checks {
    use super::*;

    pub(crate) fn a_render_has_the_colours_of_the_window_wide_and_deep() {
        for (name, width) in [("tip", "0.5"), ("abyss", "2e-9"), ("abyss", "1e-12")] {
            let mut scene = BuiltIn::named(name).unwrap().document().settled().scene();
            scene.view.width = width.to_string();
            let screen = aligned(&scene);
            scene.view = screen.camera.view();
            let mut explorer = Explorer::new(1000 * TILE_BYTES);
            explorer.target(&ViewTarget {
                physics: Physics::of(&scene, BALANCED, false),
                budget_secs: scene.question.budget.secs,
                region: screen.region(),
                level: screen.level(),
                pointer: None,
                refinements: 0,
            });
            explorer.work(&mut engine(), None).unwrap();
            let samples = rendered(&scene, BALANCED, &mut engine());
            let flipped = samples.iter().filter(|outcome| outcome.status == Status::Answered);
            let times = equalised(flipped.map(|outcome| outcome.time), 64);
            let picture =
                &PictureTable { times, curve: false, denoise: false, ..PictureTable::default() };
            let truth = painted(&scene, picture, &samples);
            let paint = Paint { picture, scene: &scene, trust: false };
            let pixels = Studio::new(PLAIN).draw(&screen, &mut explorer, &paint);
            let colours = truth.iter().collect::<std::collections::HashSet<_>>().len();
            let [inexact, wrong] = [1, 24].map(|least| beyond(least, &pixels, &truth));
            println!("{name} {width}: {inexact} {wrong} {colours}");
            assert!(colours > 150, "{name} {width}: it is no plain: {colours}");
            assert!(inexact <= 0.01 && wrong <= 0.01, "{name} {width}: {inexact} {wrong}");
        }
    }
}
