//! Films made frame by frame: states at advancing times, for which every trajectory is computed
//! once, and a still per frame for any other question.

use flipmap_engine::run_settings::RunSpec;
use flipmap_engine::{Cells, IntegratorConfig};
use flipmap_render::farm::merge::FilmSink;
use flipmap_render::output::RowPainter;
use flipmap_render::tiles::Renderer;
use flipmap_render::tiles::moments::Moments;
use flipmap_scene::film::{Film, Shot};

use super::exit::Exit;
use super::progress::Progress;
use super::render::check_numbers;
use super::run_options::start;
use super::{farm, stop, video};

/// Computes and writes a film frame by frame; frames that are there already are not made again.
pub(super) fn run(options: &video::Options, film: &Film, spec: &RunSpec) -> anyhow::Result<()> {
    check(options, film)?;
    farm::check_output(&options.output)?;
    let mut document = film.keys[0].scene.clone();
    options.film.picture.apply(&mut document)?;
    let document = document.checked()?;
    let request =
        options.film.run.engine.request(spec.setting, spec.verify).answering(&document.question);
    let chosen = start(&request)?;
    stop::listen()?;
    let size = film.size.map(|side| side * document.picture.samples.along());
    check_film(film, size, chosen.config)?;
    let mut renderer = Renderer::try_from(chosen)?;
    let config = renderer.config();
    let mut sink = FilmSink::open(&options.output, film, &document)?;
    let mut moments = Moments::can_make(film, spec.verify, &config).then(|| {
        let job_size = renderer.engine().job_size();
        Moments::new(&film.shot(0).scene, size, config, job_size)
    });
    let mut progress = Progress::of(options.progress, u64::from(film.frames), "frames");
    for frame in 0..film.frames {
        let shot: Shot = film.shot(frame);
        if sink.has(frame, &shot) {
            continue;
        }
        let mut painter = RowPainter::new(&shot.scene, film.size, &document.picture)?;
        let rgb = match &mut moments {
            Some(moments) => {
                let at = shot.scene.question.end_secs();
                let samples = moments.at(renderer.engine(), at, &|| !stop::asked())?;
                painter.paint(samples.ok_or(Exit::Again)?)
            }
            None => {
                let samples = renderer.render_while(&shot.scene, size, &|_| !stop::asked())?;
                painter.paint(&samples.ok_or(Exit::Again)?)
            }
        };
        sink.write(frame, &shot, &rgb)?;
        progress.set(u64::from(frame) + 1, None);
    }
    drop(progress);
    sink.finish()?;
    let [width, height] = film.size;
    super::tell(&format!(
        "flipmap: {} frames of {width}x{height} at {} per second in {}",
        film.frames,
        film.fps,
        options.output.display()
    ));
    Ok(())
}

/// Checks each key of a film as [`check_numbers`] checks a scene.
pub(super) fn check_film(
    film: &Film,
    size: [u32; 2],
    config: IntegratorConfig,
) -> Result<(), Exit> {
    film.keys
        .iter()
        .try_for_each(|key| check_numbers(&key.scene.scene(), size, config, Cells::Auto))
}

/// Rejects `--cache`: a film made frame by frame keeps no samples.
fn check(options: &video::Options, film: &Film) -> Result<(), Exit> {
    if options.cache.is_none() {
        return Ok(());
    }
    Err(Exit::Usage(format!(
        "a film of the question {} cannot be made like this: it keeps no samples, only its frames: \
         omit --cache",
        film.keys[0].scene.question.ask
    )))
}
