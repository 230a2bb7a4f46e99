//! The options that name the files of a still.

use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};

use clap::Args;
use flipmap::output::Paths;

use super::exit::Exit;

/// Where it goes.
#[derive(Args, Debug)]
pub struct OutputOptions {
    /// The picture to write (- for standard output)
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
    /// The picture as tiles in a folder, with a page that shows them
    #[arg(long, value_name = "FOLDER")]
    pyramid: Option<PathBuf>,
    /// Flip times to write as a NumPy array (- for standard output)
    #[arg(long, value_name = "FILE.npy")]
    raw: Option<PathBuf>,
    /// Flip times, statuses and doubts to write as an OpenEXR image
    #[arg(long, value_name = "FILE.exr")]
    exr: Option<PathBuf>,
    /// A picture of how sure each pixel is, when they are checked
    #[arg(long, value_name = "FILE.png")]
    trust: Option<PathBuf>,
}

impl OutputOptions {
    /// Each with its option.
    pub fn paths(&self) -> Paths {
        Paths {
            picture: self.output.clone(),
            pyramid: self.pyramid.clone(),
            raw: self.raw.clone(),
            exr: self.exr.clone(),
            trust: self.trust.clone(),
        }
    }

    /// Refuses what cannot be written; `json` is written to standard output too, and `state` is a
    /// file besides.
    pub fn check(&self, json: bool, verified: bool, state: Option<&Path>) -> Result<(), Exit> {
        let usage = |message: String| Err(Exit::Usage(message));
        let paths = self.paths();
        let named = paths.named();
        if named.is_empty() {
            let message = "nothing to write: give -o FILE.png, --pyramid FOLDER, --raw FILE.npy, \
                           --exr FILE.exr or more";
            return usage(message.to_string());
        }
        let is_stream = |(_, path): &&(&str, &Path)| path.as_os_str() == "-";
        let streams: Vec<&str> = named.iter().filter(is_stream).map(|(name, _)| *name).collect();
        if streams.len() + usize::from(json) > 1 {
            return usage("only one of the outputs and --json can use standard output".to_string());
        }
        if let ([stream], true) = (&streams[..], stdout().is_terminal()) {
            return usage(format!(
                "{stream} - writes to a terminal here: redirect it, or name a file"
            ));
        }
        for (k, (option, path)) in named.iter().enumerate() {
            if let Some((other, _)) = named[..k].iter().find(|(_, earlier)| earlier == path) {
                return usage(format!(
                    "{other} and {option} name the same file; give each its own"
                ));
            }
        }
        if self.trust.is_some() && !verified {
            let message = "--trust shows what checks found: add --verify, or --accuracy exact";
            return usage(message.to_string());
        }
        self.check_pyramid(&named, state)
    }

    /// A pyramid's folder is one of its own: it is replaced as a whole.
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
