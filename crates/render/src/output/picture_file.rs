//! Pictures in the format that the name of their file asks for.
//!
//! PNG carries the scene and is written row by row, TIFF strip by strip; JPEG and WebP are encoded as
//! a whole.

use std::io::{self, Write};
use std::path::Path;

use super::tiff_stream::TiffStream;
use super::whole_picture::{PictureFormat, WholePicture, check_depth};
use super::{Destination, PngError, PngWriter, SafeFile};
use flipmap_scene::Document;

/// A picture being written to a file.
pub struct PictureFile(Encoding);

enum Encoding {
    Png(PngWriter<SafeFile>),
    Tiff(TiffStream),
    Whole(WholePicture),
}

impl PictureFile {
    /// Begins a picture of `size` pixels and eight bits a channel; a PNG carries the document, if
    /// there is one. Refuses an unsupported format, a file that cannot be created, and a size that
    /// the format cannot hold.
    pub fn create(path: &Path, size: [u32; 2], document: Option<&Document>) -> io::Result<Self> {
        let format = PictureFormat::of(path)?;
        let file = SafeFile::create(&Destination::from(path))?;
        Ok(PictureFile(match (format, document) {
            (PictureFormat::Whole(format), _) => {
                Encoding::Whole(WholePicture::new(file, format, size)?)
            }
            (PictureFormat::Tiff, _) => Encoding::Tiff(TiffStream::begin(file, size, false)?),
            (PictureFormat::Png, Some(document)) => {
                Encoding::Png(PngWriter::new(file, size, document).map_err(as_io)?)
            }
            (PictureFormat::Png, None) => {
                Encoding::Png(PngWriter::without_scene(file, size).map_err(as_io)?)
            }
        }))
    }

    /// Begins a picture of sixteen bits a channel, and otherwise works like
    /// [`PictureFile::create`].
    pub(crate) fn create_deep(
        path: &Path,
        size: [u32; 2],
        document: &Document,
    ) -> io::Result<Self> {
        check_depth(path)?;
        let format = PictureFormat::of(path)?;
        let file = SafeFile::create(&Destination::from(path))?;
        Ok(PictureFile(match format {
            PictureFormat::Tiff => Encoding::Tiff(TiffStream::begin(file, size, true)?),
            _ => Encoding::Png(PngWriter::deep(file, size, document).map_err(as_io)?),
        }))
    }

    /// Adds the next rows, three bytes per pixel, or six with each channel's high byte first.
    pub fn write(&mut self, rgb: &[u8]) -> io::Result<()> {
        match &mut self.0 {
            Encoding::Png(png) => png.write(rgb).map_err(as_io),
            Encoding::Tiff(tiff) => tiff.write(rgb),
            Encoding::Whole(picture) => {
                picture.write(rgb);
                Ok(())
            }
        }
    }

    /// Completes the picture; [`SafeFile::finish`] then renames the file to its destination.
    pub fn complete(self) -> io::Result<SafeFile> {
        let mut file = match self.0 {
            Encoding::Png(png) => png.finish().map_err(as_io)?,
            Encoding::Tiff(tiff) => tiff.finish()?,
            Encoding::Whole(picture) => picture.encode()?,
        };
        file.flush()?;
        Ok(file)
    }
}

/// Converts an error of a PNG that is being written; an error of its file stays as it is.
fn as_io(error: PngError) -> io::Error {
    match error {
        PngError::File(error) => error,
        other => io::Error::other(other),
    }
}
