//! The files that a render writes, as its samples come.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::failure::{OutputError, is_broken_pipe};
use super::{
    Destination, ExrWriter, NpyWriter, Painter, PngError, PngWriter, SafeFile, Spool, trust_colours,
};
use crate::scene::Document;
use crate::tiles::Samples;

/// Where what is asked to go, by option.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    /// `-o`.
    pub picture: Option<PathBuf>,
    /// `--raw`.
    pub raw: Option<PathBuf>,
    /// `--exr`.
    pub exr: Option<PathBuf>,
    /// `--trust`.
    pub trust: Option<PathBuf>,
}

impl Paths {
    /// Each path with its option.
    pub fn named(&self) -> Vec<(&'static str, &Path)> {
        let all = [
            ("-o", &self.picture),
            ("--raw", &self.raw),
            ("--exr", &self.exr),
            ("--trust", &self.trust),
        ];
        all.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?))).collect()
    }

    /// Refuses what could not be written, long before it is.
    pub fn check(&self) -> Result<(), OutputError> {
        self.named().into_iter().try_for_each(|(option, path)| create(option, path).map(drop))
    }
}

/// One run over the picture, for the outputs that want its samples.
pub struct Pass {
    /// Samples a pixel along each axis.
    pub along: u32,
    /// Whether it is the picture's; the other outputs want one sample at each pixel's centre.
    picture: bool,
    others: bool,
}

/// One file being written.
enum Sink {
    Picture(Box<(Painter, PngWriter<SafeFile>)>),
    Raw(NpyWriter<SafeFile>),
    Exr(ExrWriter<Spool>),
    Trust(PngWriter<SafeFile>),
}

impl Sink {
    /// Begins a file; a picture has its painter.
    fn begin(
        option: &str,
        file: SafeFile,
        painter: Option<Painter>,
        document: &Document,
        size: [u32; 2],
    ) -> Result<Self, PngError> {
        Ok(match (option, painter) {
            (_, Some(painter)) => {
                Sink::Picture(Box::new((painter, PngWriter::new(file, size, document)?)))
            }
            ("--raw", _) => Sink::Raw(NpyWriter::new(file, size)?),
            ("--exr", _) => Sink::Exr(ExrWriter::new(Spool::new(file)?, size, document)?),
            _ => Sink::Trust(PngWriter::new(file, size, document)?),
        })
    }

    fn write(&mut self, samples: &Samples) -> Result<(), PngError> {
        match self {
            Sink::Picture(picture) => {
                let (painter, png) = picture.as_mut();
                png.write(&painter.paint(samples))?;
            }
            Sink::Raw(npy) => npy.write(samples)?,
            Sink::Exr(exr) => exr.write(samples)?,
            Sink::Trust(png) => png.write(&trust_colours(samples))?,
        }
        Ok(())
    }

    /// The file with everything in it, not yet in its place.
    fn complete(self) -> Result<SafeFile, PngError> {
        let mut file = match self {
            Sink::Picture(picture) => picture.1.finish()?,
            Sink::Trust(png) => png.finish()?,
            Sink::Raw(npy) => npy.into_inner(),
            Sink::Exr(exr) => exr.finish()?.into_file()?,
        };
        file.flush()?;
        Ok(file)
    }
}

/// The files being written.
pub struct Sinks {
    open: Vec<(Sink, Destination)>,
}

impl Sinks {
    /// Opens every file.
    pub fn open(paths: &Paths, document: &Document, size: [u32; 2]) -> Result<Self, OutputError> {
        let mut open = Vec::new();
        for (option, path) in paths.named() {
            let name = Destination::from(path);
            let file = create(option, path)?;
            let painter = match option {
                "-o" => Some(Painter::new(&document.scene(), size, &document.picture)?),
                _ => None,
            };
            let begun = Sink::begin(option, file, painter, document, size);
            open.push((begun.map_err(|source| write_error(&name, source))?, name));
        }
        Ok(Sinks { open })
    }

    /// With several samples a pixel all but the picture still hold the samples at the pixels'
    /// centres, in a pass of their own.
    pub fn passes(&self, along: u32) -> Vec<Pass> {
        let is_picture = |(sink, _): &(Sink, _)| matches!(sink, Sink::Picture(..));
        let picture = self.open.iter().any(is_picture);
        let others = !self.open.iter().all(is_picture);
        if along == 1 || !picture {
            return vec![Pass { along: 1, picture, others }];
        }
        let mut passes = vec![Pass { along, picture, others: false }];
        if others {
            passes.push(Pass { along: 1, picture: false, others });
        }
        passes
    }

    /// Hands samples, rows from the top, to the outputs of a pass. An output whose reader has
    /// left is given up if there is another one.
    pub fn write(&mut self, pass: &Pass, samples: &Samples) -> Result<(), OutputError> {
        let mut others = self.open.len() - 1;
        let mut kept = Vec::new();
        for (mut sink, name) in std::mem::take(&mut self.open) {
            let wanted = match sink {
                Sink::Picture(..) => pass.picture,
                _ => pass.others,
            };
            let written = if wanted { sink.write(samples) } else { Ok(()) };
            match written.map_err(|source| write_error(&name, source)) {
                Err(error) if others > 0 && is_broken_pipe(&error) => others -= 1,
                Err(error) => return Err(error),
                Ok(()) => kept.push((sink, name)),
            }
        }
        self.open = kept;
        Ok(())
    }

    /// Completes every file before any takes its place.
    pub fn finish(self) -> Result<(), OutputError> {
        let mut others = self.open.len() - 1;
        let mut complete = Vec::new();
        for (sink, name) in self.open {
            match sink.complete().map_err(|source| write_error(&name, source)) {
                Err(error) if others > 0 && is_broken_pipe(&error) => others -= 1,
                file => complete.push((file?, name)),
            }
        }
        for (file, name) in complete {
            file.finish().map_err(|error| write_error(&name, error.into()))?;
        }
        Ok(())
    }
}

fn create(option: &'static str, path: &Path) -> Result<SafeFile, OutputError> {
    let name = Destination::from(path);
    SafeFile::create(&name).map_err(|source| OutputError::Create { option, name, source })
}

fn write_error(name: &Destination, source: PngError) -> OutputError {
    OutputError::Write { name: name.clone(), source }
}
