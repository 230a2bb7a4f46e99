//! Pictures in the format that the name of their file asks for.
//!
//! PNG carries the scene and is written row by row; JPEG, WebP and TIFF are encoded as a whole.

use std::io::{self, Cursor, Write};
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageFormat};

use super::{Destination, PngError, PngWriter, SafeFile};
use flipmap_scene::Document;

/// JPEG quality, 1 to 100: high, because a map is full of thin filaments.
const JPEG_QUALITY: u8 = 95;

/// Returns the format that the extension of a picture's name asks for; `None` for PNG, which is
/// also the format of names without a known extension.
pub(super) fn format_of(path: &Path) -> io::Result<Option<ImageFormat>> {
    match ImageFormat::from_path(path) {
        Err(_) | Ok(ImageFormat::Png) => Ok(None),
        Ok(format @ (ImageFormat::Jpeg | ImageFormat::WebP | ImageFormat::Tiff)) => {
            Ok(Some(format))
        }
        Ok(_) => Err(io::Error::other("pictures are written as .png, .jpg, .webp or .tiff")),
    }
}

/// Refuses a name whose format cannot hold sixteen bits a channel.
pub(super) fn check_depth(path: &Path) -> io::Result<()> {
    match format_of(path)? {
        Some(format @ (ImageFormat::Jpeg | ImageFormat::WebP)) => {
            let ending = format.extensions_str()[0];
            let why = format!(".{ending} has no 16 bits a channel: name a .png or a .tiff");
            Err(io::Error::other(why))
        }
        _ => Ok(()),
    }
}

/// Returns the longest side that a format can hold, in pixels.
fn longest_side(format: ImageFormat) -> u32 {
    match format {
        ImageFormat::Jpeg => 65_535,
        ImageFormat::WebP => 16_383,
        _ => u32::MAX,
    }
}

/// A picture being written to a file.
pub struct PictureFile(Encoding);

enum Encoding {
    ByRows(PngWriter<SafeFile>),
    Whole(WholePicture),
}

impl PictureFile {
    /// Begins a picture of `size` pixels and eight bits a channel; a PNG carries the document, if
    /// there is one. Refuses an unsupported format, a file that cannot be created, and a size that
    /// the format cannot hold.
    pub fn create(path: &Path, size: [u32; 2], document: Option<&Document>) -> io::Result<Self> {
        let format = format_of(path)?;
        let file = SafeFile::create(&Destination::from(path))?;
        Ok(PictureFile(match (format, document) {
            (Some(format), _) => Encoding::Whole(WholePicture::new(file, format, size, false)?),
            (None, Some(document)) => {
                Encoding::ByRows(PngWriter::new(file, size, document).map_err(as_io)?)
            }
            (None, None) => Encoding::ByRows(PngWriter::without_scene(file, size).map_err(as_io)?),
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
        let format = format_of(path)?;
        let file = SafeFile::create(&Destination::from(path))?;
        Ok(PictureFile(match format {
            Some(format) => Encoding::Whole(WholePicture::new(file, format, size, true)?),
            None => Encoding::ByRows(PngWriter::deep(file, size, document).map_err(as_io)?),
        }))
    }

    /// Adds the next rows, three bytes per pixel, or six with each channel's high byte first.
    pub fn write(&mut self, rgb: &[u8]) -> io::Result<()> {
        match &mut self.0 {
            Encoding::ByRows(png) => png.write(rgb).map_err(as_io),
            Encoding::Whole(picture) => {
                picture.rgb.extend_from_slice(rgb);
                Ok(())
            }
        }
    }

    /// Completes the picture; [`SafeFile::finish`] then renames the file to its destination.
    pub fn complete(self) -> io::Result<SafeFile> {
        let mut file = match self.0 {
            Encoding::ByRows(png) => png.finish().map_err(as_io)?,
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

/// A picture that is encoded when its last row has come.
struct WholePicture {
    file: SafeFile,
    format: ImageFormat,
    size: [u32; 2],
    /// True for two bytes a channel, the high one first.
    deep: bool,
    rgb: Vec<u8>,
}

impl WholePicture {
    fn new(file: SafeFile, format: ImageFormat, size: [u32; 2], deep: bool) -> io::Result<Self> {
        let longest = longest_side(format);
        if size.into_iter().any(|side| side > longest) {
            let ending = format.extensions_str()[0];
            return Err(io::Error::other(format!(
                ".{ending} holds at most {longest} pixels along a side: name a .png or a .tiff"
            )));
        }
        Ok(WholePicture { file, format, size, deep, rgb: Vec::new() })
    }

    fn encode(mut self) -> io::Result<SafeFile> {
        let color = if self.deep { ExtendedColorType::Rgb16 } else { ExtendedColorType::Rgb8 };
        if self.deep {
            // The encoder takes numbers in the machine's byte order.
            for channel in self.rgb.as_chunks_mut::<2>().0 {
                *channel = u16::from_be_bytes(*channel).to_ne_bytes();
            }
        }
        let encoded = encoded(&self.rgb, self.size, color, self.format);
        let bytes = encoded.map_err(io::Error::other)?;
        self.file.write_all(&bytes)?;
        Ok(self.file)
    }
}

fn encoded(
    rgb: &[u8],
    [width, height]: [u32; 2],
    color: ExtendedColorType,
    format: ImageFormat,
) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    match format {
        ImageFormat::Jpeg => JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
            .write_image(rgb, width, height, color)?,
        _ => image::write_buffer_with_format(&mut bytes, rgb, width, height, color, format)?,
    }
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_holds_what_its_name_says() {
        let rgb: Vec<u8> = (0..16 * 8).flat_map(|k| [k, 255 - k, 90]).collect();
        for (name, apart) in [("a.jpg", 12), ("a.JPEG", 12), ("a.webp", 0), ("a.tif", 0)] {
            let format = format_of(Path::new(name)).unwrap().expect(name);
            let bytes = encoded(&rgb, [16, 8], ExtendedColorType::Rgb8, format).unwrap();
            assert_eq!(image::guess_format(&bytes).unwrap(), format, "{name}");
            let read = image::load_from_memory(&bytes).unwrap().into_rgb8();
            assert_eq!(read.dimensions(), (16, 8));
            let worst = read.iter().zip(&rgb).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(worst <= apart, "{name} is off by {worst}");
        }
    }

    #[test]
    fn other_names_are_png_or_refused() {
        for name in ["a.png", "a", "-", "/dev/full"] {
            assert_eq!(format_of(Path::new(name)).unwrap(), None, "{name}");
        }
        let error = format_of(Path::new("a.gif")).unwrap_err().to_string();
        assert!(error.contains(".png, .jpg, .webp or .tiff"), "{error}");
    }
}
