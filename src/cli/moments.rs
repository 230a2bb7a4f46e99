//! Films of states: one view as its time goes on, every trajectory computed once.

use flipmap::engine::choice::Chosen;
use flipmap::engine::run_settings::RunSpec;
use flipmap::farm::merge::FilmSink;
use flipmap::output::RowPainter;
use flipmap::scene::film::{Film, Shot};
use flipmap::tiles::moments::Moments;

use super::exit::Exit;
use super::progress::Progress;
use super::run_options::{check_steps, start};
use super::{stop, video};

/// Computes and writes a film of states.
pub(super) fn run(options: &video::Options, film: &Film, spec: &RunSpec) -> anyhow::Result<()> {
    check(options, spec)?;
    let mut document = film.keys[0].scene.clone();
    options.film.picture.apply(&mut document)?;
    let document = document.checked()?;
    stop::listen()?;
    let Chosen { mut engine, config, .. } = start(&options.film.run.engine.request(spec.setting))?;
    check_steps(&film.keys[0].scene.scene(), config)?;
    let mut sink = FilmSink::open(&options.output, film, &document)?;
    let size = film.size.map(|side| side * document.picture.samples);
    let first = film.shot(0).scene;
    let mut moments = Moments::new(&first, size, config, engine.job_size());
    let mut progress = Progress::of(options.progress, u64::from(film.frames), "frames");
    for frame in 0..film.frames {
        let shot: Shot = film.shot(frame);
        if sink.has(frame, &shot) {
            continue;
        }
        let at = shot.scene.question.end_secs();
        let samples = moments.at(engine.as_mut(), at, &|| !stop::asked())?;
        let samples = samples.ok_or(Exit::Again)?;
        let rgb = RowPainter::new(&shot.scene, film.size, &document.picture)?.paint(samples);
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

/// Rejects what such a film does not have.
fn check(options: &video::Options, spec: &RunSpec) -> Result<(), Exit> {
    let why = if options.cache.is_some() {
        "it keeps no samples, only its frames: omit --cache"
    } else if spec.verify {
        "it is not checked: omit --verify and --accuracy exact"
    } else {
        return Ok(());
    };
    Err(Exit::Usage(format!("a film of states cannot be made like this: {why}")))
}
