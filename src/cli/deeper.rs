//! `flipmap deeper`: descends from a scene along a filament, as far as there is structure.

use std::io::{self, Write};
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use flipmap_engine::choice::Chosen;
use flipmap_render::output::{Destination, SafeFile, is_stdout};
use flipmap_render::tiles::descent::{Descent, DescentStep};
use flipmap_scene::keys::{Easing, Keys};
use flipmap_scene::{MIN_WIDTH, Scene, location};

use super::exit::Exit;
use super::options::{SceneOptions, number_of};
use super::run_options::{RunOptions, start};
use super::same_file::keep_apart;
use super::stop;

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Width of the view in rad at which to stop, 1e-100 to 1
    #[arg(long, value_name = "RAD", default_value = "1e-20")]
    to: String,
    /// File for the views on the way, as keys of a film (- for standard output)
    #[arg(short, long, value_name = "KEYS.toml")]
    output: Option<PathBuf>,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    run: RunOptions,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    options.run.engine.check()?;
    let output = options.output.as_deref().map(|path| ("-o", path));
    keep_apart(options.scene.file().as_slice(), output.as_slice())?;
    let to = number_of("--to", &options.to, MIN_WIDTH..=1.0, "rad")?;
    if let Some(path) = &options.output {
        super::check_name(path, "-o", &["toml"])?;
        super::check(path, "-o")?;
    }
    let mut document = options.scene.document()?;
    let spec = options.run.settle(&mut document)?;
    let scene = document.scene();
    scene.require_flip_from_rest()?;
    let mut chosen = start(&options.run.engine.request(spec.setting, spec.verify))?;
    stop::listen()?;
    // A pipe that nobody reads is refused before the work.
    let destination = options.output.as_deref().map(Destination::from);
    let file = destination.as_ref().map(open).transpose()?;
    let path = descend(scene, &mut chosen, to)?;
    if let (Some(file), Some(destination)) = (file, &destination) {
        let mut keys = Keys::default();
        for scene in &path {
            // Linear, so that the film does not stop at each view on the way.
            keys.append(document.clone().with_scene(scene.clone()), Easing::Linear);
        }
        let written = write(file, &keys);
        written.with_context(|| format!("-o: cannot write {destination}"))?;
    }
    if !options.output.as_deref().is_some_and(is_stdout) {
        super::say(&location::text(&path[path.len() - 1]))?;
    }
    // What was found is kept, whatever ended the descent.
    match &options.output {
        _ if !stop::asked() => Ok(()),
        Some(file) if !is_stdout(file) => {
            let message = format!("stopped; {} holds the views found so far", file.display());
            Err(Exit::Partly(message).into())
        }
        _ => Err(Exit::Partly("stopped; the last view on the way is printed".to_string()).into()),
    }
}

fn open(destination: &Destination) -> anyhow::Result<SafeFile> {
    SafeFile::create(destination).with_context(|| format!("-o: cannot write {destination}"))
}

fn write(mut file: SafeFile, keys: &Keys) -> io::Result<()> {
    file.write_all(keys.text().as_bytes())?;
    file.finish()
}

/// Returns the scenes from the first one down to a width of `to` rad. Ends earlier if no structure
/// is left or the user stops it.
fn descend(scene: Scene, chosen: &mut Chosen, to: f64) -> anyhow::Result<Vec<Scene>> {
    let mut descent = Descent::new(scene.clone(), chosen.config, [0.0; 2]);
    let mut path = vec![scene];
    while width(&path[path.len() - 1]) > to {
        match descent.next(chosen.engine.as_mut(), &|| !stop::asked())? {
            DescentStep::Scene(scene) => {
                super::tell(&format!(
                    "flipmap: {} rad, budget {} s",
                    scene.view.width, scene.question.budget.secs
                ));
                path.push(*scene);
            }
            DescentStep::Stopped => break,
            DescentStep::End => {
                super::tell("flipmap: no structure is left nearby; the path ends here");
                break;
            }
        }
    }
    Ok(path)
}

fn width(scene: &Scene) -> f64 {
    scene.view.width_rad().hi
}
