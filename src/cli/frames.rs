//! Films made frame by frame: states at advancing times, for which every trajectory is computed
//! once, and a still per frame for any other question.

use std::path::Path;

use flipmap_engine::IntegratorConfig;
use flipmap_engine::run_settings::RunSpec;
use flipmap_render::film::{self, FilmRecipe, FilmRenderError};
use flipmap_render::tiles::Renderer;
use flipmap_scene::film::{Film, FilmKind};

use super::exit::Exit;
use super::render::warn_of_missing_digits;
use super::run_options::start;
use super::watch::CommandLine;
use super::{farm, stop, video};

/// Computes a film frame by frame and writes it to `output`; frames that are there already are not
/// made again.
pub(super) fn run(
    options: &video::Options,
    output: &Path,
    film: &Film,
    spec: &RunSpec,
) -> anyhow::Result<()> {
    check(options, film)?;
    let document = film.keys[0].scene.clone().checked()?;
    let recipe = FilmRecipe { film, document: &document, output };
    let encoding = farm::check(&recipe, options.quality.into())?;
    let request =
        options.film.run.engine.request(spec.setting, spec.verify).answering(&document.question);
    let chosen = start(&request)?;
    stop::listen()?;
    check_film(film, chosen.config)?;
    let mut renderer = Renderer::try_from(chosen)?;
    let watch = CommandLine::new(options.progress, "frames", None);
    let made = recipe.render(encoding, &mut renderer, &watch);
    drop(watch);
    made.map_err(|error| match error {
        FilmRenderError::Stopped => Exit::Again.into(),
        error => anyhow::Error::from(error),
    })?;
    farm::tell_made(film, &options.output);
    Ok(())
}

/// Rejects a film that the engine cannot compute, and warns of missing digits where each key is
/// computed as it is.
pub(super) fn check_film(film: &Film, config: IntegratorConfig) -> Result<(), Exit> {
    film::check_film(film, &config).map_err(|error| Exit::usage(&error))?;
    if film.kind() != FilmKind::Flips {
        let size = film::samples_of(film);
        film.keys.iter().for_each(|key| warn_of_missing_digits(&key.scene.scene(), size));
    }
    Ok(())
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
