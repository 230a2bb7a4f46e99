//! The options that name the output files of a still.

use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

use clap::Args;
use flipmap_render::output::{Paths, is_stdout};
use flipmap_scene::BuiltIn;

use super::exit::Exit;
use super::option_names::by_option;
use super::same_file::{Named, keep_apart, one_stream};

/// Name of the scene that is rendered if none is named.
const HOME: &str = "home";
/// Name of the picture of a scene without a name.
const NAMELESS: &str = "map";

/// Options that name the output files.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputOptions {
    /// Picture to write (- for standard output); render names it after the scene if no
    /// output is given
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
    /// Folder for the picture as tiles, with a page that shows them
    #[arg(hide_short_help = true, long, value_name = "FOLDER")]
    pyramid: Option<PathBuf>,
    /// Flip times to write: a NumPy array (.npy, - for standard output), arrays with coordinates,
    /// status and trust (.npz), or a table of a small map (.csv)
    #[arg(long, value_name = "FILE.npy|.npz|.csv")]
    raw: Option<PathBuf>,
    /// OpenEXR image of flip times, statuses and doubts to write
    #[arg(hide_short_help = true, long, value_name = "FILE.exr")]
    exr: Option<PathBuf>,
    /// Picture of how certain each pixel is, if pixels are checked
    #[arg(hide_short_help = true, long, value_name = "FILE.png")]
    trust: Option<PathBuf>,
}

impl OutputOptions {
    /// Paths of all the outputs.
    pub(super) fn paths(&self) -> Paths {
        Paths {
            picture: self.output.clone(),
            pyramid: self.pyramid.clone(),
            raw: self.raw.clone(),
            exr: self.exr.clone(),
            trust: self.trust.clone(),
        }
    }

    /// Returns true if an output shows samples as colours.
    pub(super) fn are_painted(&self) -> bool {
        self.output.is_some() || self.pyramid.is_some()
    }

    /// Returns the outputs or, if there are none, a new picture named after the scene.
    pub(super) fn or_picture_of(&self, scene: Option<&str>) -> Result<Self, Exit> {
        if !self.paths().named().is_empty() {
            return Ok(self.clone());
        }
        let scene = scene.unwrap_or(HOME);
        // Standard input and locations have no name.
        let is_named = BuiltIn::named(scene).is_some() || Path::new(scene).is_file();
        let name = Path::new(scene).file_stem().filter(|_| is_named);
        let picture = Path::new(name.unwrap_or(NAMELESS.as_ref())).with_added_extension("png");
        if picture.exists() {
            let file = picture.display();
            return Err(Exit::Usage(format!("{file} is there already: name the picture with -o")));
        }
        Ok(OutputOptions { output: Some(picture), ..self.clone() })
    }

    /// Rejects outputs that cannot be written, or that would replace one of `inputs`. With `json`,
    /// standard output is already in use; `state` is a further output.
    pub(super) fn check(
        &self,
        json: bool,
        verified: bool,
        state: Option<&Path>,
        inputs: &[Named],
    ) -> Result<(), Exit> {
        let usage = |message: String| Err(Exit::Usage(message));
        let paths = self.paths();
        let named = by_option(&paths);
        if named.is_empty() {
            let message = "nothing to write: give one or more of -o FILE.png, --pyramid FOLDER, \
                           --raw FILE.npy and --exr FILE.exr";
            return usage(message.to_string());
        }
        one_stream(&named, json)?;
        let stream = named.iter().find(|(_, path)| is_stdout(path));
        if let (Some((stream, _)), true) = (stream, stdout().is_terminal()) {
            return usage(format!(
                "{stream} - would write to a terminal: redirect it, or name a file"
            ));
        }
        let state_named = state.map(|path| ("--state", path));
        let files: Vec<Named> = named.iter().copied().chain(state_named).collect();
        keep_apart(inputs, &files)?;
        if self.trust.is_some() && !verified {
            let message = "--trust shows the results of checks: add --verify or --accuracy exact";
            return usage(message.to_string());
        }
        self.check_pyramid(&named, state)
    }

    /// Rejects other outputs in a pyramid's folder, which is replaced as a whole.
    fn check_pyramid(&self, named: &[(&str, &Path)], state: Option<&Path>) -> Result<(), Exit> {
        let Some(folder) = self.pyramid.as_deref() else { return Ok(()) };
        if folder.as_os_str() == "-" {
            let message = "--pyramid writes a folder, not standard output: name one";
            return Err(Exit::Usage(message.to_string()));
        }
        let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        let inside = |path: &Path| path != folder && whole(path).starts_with(whole(folder));
        let state = state.map(|path| ("--state", path));
        match named.iter().copied().chain(state).find(|(_, path)| inside(path)) {
            Some((option, _)) => Err(Exit::Usage(format!(
                "{option} lies in the folder of --pyramid, which is replaced as a whole: name a \
                 file elsewhere"
            ))),
            None => Ok(()),
        }
    }
}
