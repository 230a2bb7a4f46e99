//! The outputs of a render, written as its samples come.

use std::io::Write;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use super::csv::CsvWriter;
use super::ending::ends_in;
use super::failure::{OutputError, is_broken_pipe};
use super::npz::NpzWriter;
use super::paths::{OutputKind, Paths};
use super::{
    Destination, ExrWriter, NpyWriter, PictureFile, PngError, Pyramid, PyramidFolder, RowPainter,
    SafeFile, Spool, trust_colours,
};
use crate::tiles::{PlainPixels, Samples};
use flipmap_scene::palette::{Tint, rounded_channel};
use flipmap_scene::{Document, Sampling, Shown};

/// One run over the picture, for the outputs that need its samples.
pub struct SinkPass {
    /// Samples of each pixel.
    pub sampling: Sampling,
    /// True if the pass is for the painted outputs; the others need one sample at each pixel's
    /// centre.
    picture: bool,
    others: bool,
}

/// One output being written.
enum Sink {
    Picture(PictureFile),
    /// A picture of sixteen bits a channel.
    DeepPicture(PictureFile),
    Pyramid(Box<Pyramid>),
    Raw(NpyWriter<SafeFile>),
    /// Arrays with their coordinates.
    Arrays(Box<NpzWriter<SafeFile>>),
    Table(Box<CsvWriter<SafeFile>>),
    Exr(Box<ExrWriter<Spool>>),
    Trust(PictureFile),
}

/// Returns the channels that arrays hold: the chosen one, or all of the question.
fn channels_of(document: &Document) -> Range<usize> {
    let ask = document.question.ask;
    match document.picture.shown(ask) {
        Ok(Shown::Channel(channel)) => channel..channel + 1,
        _ => 0..ask.kind().channels.len(),
    }
}

/// An output that is complete, but not yet renamed to its destination.
enum Complete {
    File(SafeFile),
    Folder(PyramidFolder),
}

impl Sink {
    /// Begins an output; refuses at once one that cannot be created.
    fn begin(
        output: OutputKind,
        path: &Path,
        document: &Document,
        size: [u32; 2],
    ) -> Result<Self, OutputError> {
        let name = Destination::from(path);
        let (setting, deep) = (output.setting(), document.picture.bits == 16);
        let refused = |source| OutputError::Create { setting, name: name.clone(), source };
        let failed = |source: std::io::Error| write_error(&name, source.into());
        let file = || SafeFile::create(&name).map_err(refused);
        let picture = || PictureFile::create(path, size, Some(document)).map_err(refused);
        Ok(match output {
            OutputKind::Picture if deep => {
                Sink::DeepPicture(PictureFile::create_deep(path, size, document).map_err(refused)?)
            }
            OutputKind::Picture => Sink::Picture(picture()?),
            OutputKind::Trust => Sink::Trust(picture()?),
            OutputKind::Pyramid => {
                Sink::Pyramid(Box::new(Pyramid::create(path, size, document).map_err(refused)?))
            }
            OutputKind::Raw => {
                let (file, channels) = (file()?, channels_of(document));
                if ends_in(path, "npz") {
                    let npz = NpzWriter::new(file, size, document, channels);
                    Sink::Arrays(Box::new(npz.map_err(failed)?))
                } else if ends_in(path, "csv") {
                    let csv = CsvWriter::new(file, size, document, channels);
                    Sink::Table(Box::new(csv.map_err(refused)?))
                } else {
                    Sink::Raw(NpyWriter::new(file, size, channels).map_err(failed)?)
                }
            }
            OutputKind::Exr => {
                let spool = Spool::new(file()?).map_err(failed)?;
                Sink::Exr(Box::new(ExrWriter::new(spool, size, document).map_err(failed)?))
            }
        })
    }

    /// Returns true if the output consists of the picture's colours.
    fn is_painted(&self) -> bool {
        matches!(self, Sink::Picture(_) | Sink::DeepPicture(_) | Sink::Pyramid(_))
    }

    /// Writes samples, unless the output is painted.
    fn write(&mut self, samples: &Samples) -> Result<(), PngError> {
        match self {
            Sink::Raw(npy) => npy.write(samples)?,
            Sink::Arrays(npz) => npz.write(samples)?,
            Sink::Table(csv) => csv.write(samples)?,
            Sink::Exr(exr) => exr.write(samples)?,
            Sink::Trust(picture) => picture.write(&trust_colours(samples))?,
            Sink::Picture(_) | Sink::DeepPicture(_) | Sink::Pyramid(_) => {}
        }
        Ok(())
    }

    /// Writes painted rows, if the output is painted.
    fn write_painted(&mut self, painted: &Painted) -> Result<(), PngError> {
        match self {
            Sink::Picture(picture) => picture.write(&painted.rgb)?,
            Sink::DeepPicture(picture) => picture.write(&painted.deep)?,
            Sink::Pyramid(pyramid) => pyramid.write(&painted.rgb)?,
            Sink::Raw(_) | Sink::Arrays(_) | Sink::Table(_) | Sink::Exr(_) | Sink::Trust(_) => {}
        }
        Ok(())
    }

    fn complete(self) -> Result<Complete, PngError> {
        let mut file = match self {
            Sink::Pyramid(pyramid) => return Ok(Complete::Folder(pyramid.complete()?)),
            Sink::Picture(picture) | Sink::DeepPicture(picture) | Sink::Trust(picture) => {
                picture.complete()?
            }
            Sink::Raw(npy) => npy.into_inner(),
            Sink::Arrays(npz) => npz.finish()?,
            Sink::Table(csv) => csv.into_inner(),
            Sink::Exr(exr) => exr.finish()?.into_file()?,
        };
        file.flush()?;
        Ok(Complete::File(file))
    }
}

impl Complete {
    /// Renames the output to its destination.
    fn finish(self) -> std::io::Result<()> {
        match self {
            Complete::File(file) => file.finish(),
            Complete::Folder(folder) => folder.finish(),
        }
    }
}

/// Painted rows as bytes: eight bits a channel, and also sixteen if an output needs them.
#[derive(Default)]
struct Painted {
    rgb: Vec<u8>,
    /// The high byte of each channel first.
    deep: Vec<u8>,
}

impl Painted {
    /// Converts the next rows, overwriting the last ones.
    fn take(&mut self, tints: &[Tint], deep: bool) {
        self.rgb.resize(3 * tints.len(), 0);
        let shares = self.rgb.par_chunks_mut(SHARE).zip(tints.as_flattened().par_chunks(SHARE));
        shares.for_each(|(bytes, channels)| {
            let each = bytes.iter_mut().zip(channels);
            each.for_each(|(byte, channel)| *byte = rounded_channel(*channel));
        });
        if deep {
            let wide = |channel: &f32| ((channel * 257.0).round() as u16).to_be_bytes();
            self.deep.clear();
            self.deep.extend(tints.iter().flatten().flat_map(wide));
        }
    }
}

/// Number of channels that a thread rounds at a time.
const SHARE: usize = 3 << 14;
/// Number of samples that are painted at a time.
const STRIP: usize = 1 << 20;

/// The outputs being written.
pub struct Sinks {
    /// Painter shared by all outputs that are painted.
    painter: Option<RowPainter>,
    painted: Painted,
    open: Vec<(Sink, Destination)>,
}

impl Sinks {
    /// Opens every output.
    pub fn open(paths: &Paths, document: &Document, size: [u32; 2]) -> Result<Self, OutputError> {
        let begin = |(output, path): (OutputKind, &Path)| {
            Ok((Sink::begin(output, path, document, size)?, Destination::from(path)))
        };
        let open: Vec<_> = paths.outputs().map(begin).collect::<Result<_, OutputError>>()?;
        let paint = || RowPainter::new(&document.scene(), size, &document.picture);
        let painter = open.iter().any(|(sink, _)| sink.is_painted()).then(paint).transpose()?;
        Ok(Sinks { painter, painted: Painted::default(), open })
    }

    /// Returns the passes over a picture with these samples per pixel. Outputs that are not painted
    /// hold the samples in the pixels' middles; if pixels have several samples in a square, these
    /// come from a pass of their own.
    pub fn passes(&self, sampling: Sampling) -> Vec<SinkPass> {
        let is_painted = |(sink, _): &(Sink, _)| sink.is_painted();
        let picture = self.open.iter().any(is_painted);
        let others = !self.open.iter().all(is_painted);
        if sampling == Sampling::SINGLE || !picture {
            return vec![SinkPass { sampling: Sampling::SINGLE, picture, others }];
        }
        if sampling == Sampling::Corners {
            return vec![SinkPass { sampling, picture, others }];
        }
        let mut passes = vec![SinkPass { sampling, picture, others: false }];
        if others {
            passes.push(SinkPass { sampling: Sampling::SINGLE, picture: false, others });
        }
        passes
    }

    /// Passes the samples in the middles of all pixels to the outputs of a pass over their corners.
    pub(crate) fn write_middles(
        &mut self,
        pass: &SinkPass,
        plain: &Arc<PlainPixels>,
    ) -> Result<(), OutputError> {
        if let Some(painter) = &mut self.painter {
            painter.paint_corners(Arc::clone(plain));
        }
        if pass.others {
            write_each(&mut self.open, |sink| sink.write(plain.middles()))?;
        }
        Ok(())
    }

    /// Passes samples, rows from the top, to the outputs of a pass. An output whose reader has
    /// closed its pipe is dropped if there is another one.
    pub fn write(&mut self, pass: &SinkPass, samples: &Samples) -> Result<(), OutputError> {
        if pass.picture {
            self.paint(samples)?;
        }
        if pass.others && pass.sampling != Sampling::Corners {
            write_each(&mut self.open, |sink| sink.write(samples))?;
        }
        Ok(())
    }

    /// Paints samples in strips that fit into the processor's cache and reuse the same memory.
    fn paint(&mut self, samples: &Samples) -> Result<(), OutputError> {
        let Sinks { painter: Some(painter), painted, open } = self else { return Ok(()) };
        let is_deep = |(sink, _): &(Sink, _)| matches!(sink, Sink::DeepPicture(_));
        let deep = open.iter().any(is_deep);
        for first in (0..samples.len()).step_by(STRIP) {
            let strip = first..samples.len().min(first + STRIP);
            painted.take(painter.tints(samples, strip), deep);
            write_each(open, |sink| sink.write_painted(painted))?;
        }
        Ok(())
    }

    /// Completes every output, and only then renames them to their destinations.
    pub fn finish(self) -> Result<(), OutputError> {
        let mut others = self.open.len() - 1;
        let mut complete = Vec::new();
        for (sink, name) in self.open {
            match sink.complete().map_err(|source| write_error(&name, source)) {
                Err(error) if others > 0 && is_broken_pipe(&error) => others -= 1,
                output => complete.push((output?, name)),
            }
        }
        for (output, name) in complete {
            output.finish().map_err(|error| write_error(&name, error.into()))?;
        }
        Ok(())
    }
}

/// Writes to each output, and drops those whose readers have closed their pipes.
fn write_each(
    open: &mut Vec<(Sink, Destination)>,
    write: impl Fn(&mut Sink) -> Result<(), PngError>,
) -> Result<(), OutputError> {
    let mut others = open.len() - 1;
    let mut kept = Vec::new();
    for (mut sink, name) in std::mem::take(open) {
        match write(&mut sink).map_err(|source| write_error(&name, source)) {
            Err(error) if others > 0 && is_broken_pipe(&error) => others -= 1,
            Err(error) => return Err(error),
            Ok(()) => kept.push((sink, name)),
        }
    }
    *open = kept;
    Ok(())
}

fn write_error(name: &Destination, source: PngError) -> OutputError {
    OutputError::Write { name: name.clone(), source }
}
