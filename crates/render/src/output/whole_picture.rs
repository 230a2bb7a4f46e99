//! Pictures in formats that are encoded as a whole: JPEG, WebP and TIFF.

use std::io::{self, Cursor, Write};
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageFormat};

use super::SafeFile;
use super::ending::check_ending;

/// JPEG quality, 1 to 100: high, because a map is full of thin filaments.
const JPEG_QUALITY: u8 = 95;

/// Extensions of pictures.
pub const PICTURES: &[&str] = &["png", "jpg", "jpeg", "webp", "tif", "tiff"];

/// A format other than PNG.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WholeFormat {
    Jpeg,
    WebP,
    Tiff,
}

/// The limits of a format.
struct WholeLimits {
    /// Extension of its files.
    ending: &'static str,
    /// Longest side that it can hold, in pixels.
    longest: u32,
    /// True if it can hold sixteen bits a channel.
    is_deep: bool,
}

impl WholeFormat {
    /// Returns the format that the extension of a picture's name asks for; `None` for PNG, which is
    /// also the format of names without an extension.
    pub(super) fn of(path: &Path) -> io::Result<Option<Self>> {
        check_ending(path, PICTURES)?;
        Ok(match ImageFormat::from_path(path) {
            Ok(ImageFormat::Jpeg) => Some(WholeFormat::Jpeg),
            Ok(ImageFormat::WebP) => Some(WholeFormat::WebP),
            Ok(ImageFormat::Tiff) => Some(WholeFormat::Tiff),
            _ => None,
        })
    }

    fn limits(self) -> WholeLimits {
        match self {
            WholeFormat::Jpeg => WholeLimits { ending: "jpg", longest: 65_535, is_deep: false },
            WholeFormat::WebP => WholeLimits { ending: "webp", longest: 16_383, is_deep: false },
            WholeFormat::Tiff => WholeLimits { ending: "tiff", longest: u32::MAX, is_deep: true },
        }
    }

    fn encoded(
        self,
        rgb: &[u8],
        [width, height]: [u32; 2],
        color: ExtendedColorType,
    ) -> image::ImageResult<Vec<u8>> {
        let mut bytes = Cursor::new(Vec::new());
        let mut encode =
            |format| image::write_buffer_with_format(&mut bytes, rgb, width, height, color, format);
        match self {
            WholeFormat::Jpeg => JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
                .write_image(rgb, width, height, color)?,
            WholeFormat::WebP => encode(ImageFormat::WebP)?,
            WholeFormat::Tiff => encode(ImageFormat::Tiff)?,
        }
        Ok(bytes.into_inner())
    }
}

/// Refuses a name whose format cannot hold sixteen bits a channel.
pub(super) fn check_depth(path: &Path) -> io::Result<()> {
    match WholeFormat::of(path)?.map(WholeFormat::limits) {
        Some(WholeLimits { ending, is_deep: false, .. }) => Err(io::Error::other(format!(
            ".{ending} has no 16 bits a channel: name a .png or a .tiff"
        ))),
        _ => Ok(()),
    }
}

/// A picture that is encoded when its last row has come.
pub(super) struct WholePicture {
    file: SafeFile,
    format: WholeFormat,
    size: [u32; 2],
    /// True for two bytes a channel, the high one first.
    deep: bool,
    rgb: Vec<u8>,
}

impl WholePicture {
    /// Begins a picture; refuses a size that the format cannot hold.
    pub(super) fn new(
        file: SafeFile,
        format: WholeFormat,
        size: [u32; 2],
        deep: bool,
    ) -> io::Result<Self> {
        let WholeLimits { ending, longest, .. } = format.limits();
        if size.into_iter().any(|side| side > longest) {
            return Err(io::Error::other(format!(
                ".{ending} holds at most {longest} pixels along a side: name a .png or a .tiff"
            )));
        }
        Ok(WholePicture { file, format, size, deep, rgb: Vec::new() })
    }

    /// Adds the next rows.
    pub(super) fn write(&mut self, rgb: &[u8]) {
        self.rgb.extend_from_slice(rgb);
    }

    /// Encodes the picture.
    pub(super) fn encode(mut self) -> io::Result<SafeFile> {
        let color = if self.deep { ExtendedColorType::Rgb16 } else { ExtendedColorType::Rgb8 };
        if self.deep {
            // The encoder takes numbers in the machine's byte order.
            for channel in self.rgb.as_chunks_mut::<2>().0 {
                *channel = u16::from_be_bytes(*channel).to_ne_bytes();
            }
        }
        let encoded = self.format.encoded(&self.rgb, self.size, color);
        let bytes = encoded.map_err(io::Error::other)?;
        self.file.write_all(&bytes)?;
        Ok(self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_holds_what_its_name_says() {
        let rgb: Vec<u8> = (0..16 * 8).flat_map(|k| [k, 255 - k, 90]).collect();
        for (name, apart) in [("a.jpg", 12), ("a.JPEG", 12), ("a.webp", 0), ("a.tif", 0)] {
            let format = WholeFormat::of(Path::new(name)).unwrap().expect(name);
            let bytes = format.encoded(&rgb, [16, 8], ExtendedColorType::Rgb8).unwrap();
            assert_eq!(image::guess_format(&bytes).ok(), ImageFormat::from_path(name).ok());
            let read = image::load_from_memory(&bytes).unwrap().into_rgb8();
            assert_eq!(read.dimensions(), (16, 8));
            let worst = read.iter().zip(&rgb).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(worst <= apart, "{name} is off by {worst}");
        }
    }

    #[test]
    fn other_names_are_png_or_refused() {
        for name in ["a.png", "a", "-", "/dev/full"] {
            assert_eq!(WholeFormat::of(Path::new(name)).unwrap(), None, "{name}");
        }
        for name in ["a.gif", "a.mp4", "a.npy", "a.pdf"] {
            let error = WholeFormat::of(Path::new(name)).unwrap_err().to_string();
            assert!(error.ends_with(".png, .jpg, .jpeg, .webp, .tif or .tiff"), "{error}");
        }
    }
}
