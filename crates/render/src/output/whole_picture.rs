//! Pictures in formats other than PNG; JPEG and WebP are encoded as a whole.

use std::io::{self, Cursor, Write};
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageFormat};

use super::SafeFile;
use super::ending::check_ending;

/// JPEG quality, 1 to 100: high, because a map is full of thin filaments.
const JPEG_QUALITY: u8 = 95;

/// Extensions of pictures.
pub const PICTURES: &[&str] = &["png", "jpg", "jpeg", "webp", "tif", "tiff"];

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureFormat {
    /// Written row by row.
    Png,
    /// Written strip by strip.
    Tiff,
    /// Encoded as a whole.
    Whole(WholeFormat),
}

/// A format whose encoder takes a whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WholeFormat {
    Jpeg,
    WebP,
}

/// The limits of a format.
struct WholeLimits {
    /// Extension of its files.
    ending: &'static str,
    /// Longest side that it can hold, in pixels.
    longest: u32,
}

impl PictureFormat {
    /// Returns the format that the extension of a picture's name asks for; PNG is also the format of
    /// names without an extension.
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        check_ending(path, PICTURES)?;
        Ok(match ImageFormat::from_path(path) {
            Ok(ImageFormat::Jpeg) => PictureFormat::Whole(WholeFormat::Jpeg),
            Ok(ImageFormat::WebP) => PictureFormat::Whole(WholeFormat::WebP),
            Ok(ImageFormat::Tiff) => PictureFormat::Tiff,
            _ => PictureFormat::Png,
        })
    }
}

impl WholeFormat {
    fn limits(self) -> WholeLimits {
        match self {
            WholeFormat::Jpeg => WholeLimits { ending: "jpg", longest: 65_535 },
            WholeFormat::WebP => WholeLimits { ending: "webp", longest: 16_383 },
        }
    }

    fn encoded(self, rgb: &[u8], [width, height]: [u32; 2]) -> image::ImageResult<Vec<u8>> {
        let (mut bytes, color) = (Cursor::new(Vec::new()), ExtendedColorType::Rgb8);
        match self {
            WholeFormat::Jpeg => JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
                .write_image(rgb, width, height, color)?,
            WholeFormat::WebP => {
                WebPEncoder::new_lossless(&mut bytes).write_image(rgb, width, height, color)?;
            }
        }
        Ok(bytes.into_inner())
    }
}

/// Refuses a name whose format cannot hold sixteen bits a channel.
pub(super) fn check_depth(path: &Path) -> io::Result<()> {
    match PictureFormat::of(path)? {
        PictureFormat::Whole(format) => {
            let ending = format.limits().ending;
            Err(io::Error::other(format!(
                ".{ending} has no 16 bits a channel: name a .png or a .tiff"
            )))
        }
        PictureFormat::Png | PictureFormat::Tiff => Ok(()),
    }
}

/// A picture that is encoded when its last row has come.
pub(super) struct WholePicture {
    file: SafeFile,
    format: WholeFormat,
    size: [u32; 2],
    rgb: Vec<u8>,
}

impl WholePicture {
    /// Returns the memory that a picture takes: its pixels, and at most as many bytes for the file.
    fn bytes(size: [u32; 2]) -> u64 {
        6 * size.map(u64::from).iter().product::<u64>()
    }

    /// Begins a picture; refuses a size that the format or the memory cannot hold.
    pub(super) fn new(file: SafeFile, format: WholeFormat, size: [u32; 2]) -> io::Result<Self> {
        let WholeLimits { ending, longest, .. } = format.limits();
        if size.into_iter().any(|side| side > longest) {
            return Err(io::Error::other(format!(
                ".{ending} holds at most {longest} pixels along a side: name a .png or a .tiff"
            )));
        }
        let needed = WholePicture::bytes(size);
        if let Some(free) = available_bytes().filter(|free| needed > *free) {
            return Err(io::Error::other(format!(
                ".{ending} is encoded as a whole, for which {:.1} GiB of memory are needed and {:.1} \
                 are free: name a .png or a .tiff",
                gib(needed),
                gib(free)
            )));
        }
        Ok(WholePicture { file, format, size, rgb: Vec::new() })
    }

    /// Adds the next rows.
    pub(super) fn write(&mut self, rgb: &[u8]) {
        self.rgb.extend_from_slice(rgb);
    }

    /// Encodes the picture.
    pub(super) fn encode(mut self) -> io::Result<SafeFile> {
        let encoded = self.format.encoded(&self.rgb, self.size);
        let bytes = encoded.map_err(io::Error::other)?;
        self.file.write_all(&bytes)?;
        Ok(self.file)
    }
}

/// Returns the memory in bytes that a picture of this name takes if its format is encoded as a whole;
/// 0 if it is written as its rows come.
pub fn whole_bytes(path: &Path, size: [u32; 2]) -> u64 {
    match PictureFormat::of(path) {
        Ok(PictureFormat::Whole(_)) => WholePicture::bytes(size),
        Ok(PictureFormat::Png | PictureFormat::Tiff) | Err(_) => 0,
    }
}

fn gib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}

/// Returns the memory in bytes that the system can still give; only Linux tells.
fn available_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_holds_what_its_name_says() {
        let rgb: Vec<u8> = (0..16 * 8).flat_map(|k| [k, 255 - k, 90]).collect();
        for (name, apart) in [("a.jpg", 12), ("a.JPEG", 12), ("a.webp", 0)] {
            let PictureFormat::Whole(format) = PictureFormat::of(Path::new(name)).unwrap() else {
                panic!("{name}")
            };
            let bytes = format.encoded(&rgb, [16, 8]).unwrap();
            assert_eq!(image::guess_format(&bytes).ok(), ImageFormat::from_path(name).ok());
            let read = image::load_from_memory(&bytes).unwrap().into_rgb8();
            assert_eq!(read.dimensions(), (16, 8));
            let worst = read.iter().zip(&rgb).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(worst <= apart, "{name} is off by {worst}");
        }
        assert_eq!(PictureFormat::of(Path::new("a.tif")).unwrap(), PictureFormat::Tiff);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn pictures_larger_than_memory_are_refused_before_the_work() {
        let file = SafeFile::create(&super::super::Destination::from(Path::new("/dev/null")));
        let refused = WholePicture::new(file.unwrap(), WholeFormat::Jpeg, [65_535; 2]);
        let why = refused.err().map_or(String::new(), |error| error.to_string());
        let free = available_bytes().unwrap();
        assert_eq!(
            why.contains("24.0 GiB of memory are needed"),
            free < 6 * 65_535 * 65_535,
            "{why}"
        );
    }

    #[test]
    fn other_names_are_png_or_refused() {
        for name in ["a.png", "a", "-", "/dev/full"] {
            assert_eq!(PictureFormat::of(Path::new(name)).unwrap(), PictureFormat::Png, "{name}");
        }
        for name in ["a.gif", "a.mp4", "a.npy", "a.pdf"] {
            let error = PictureFormat::of(Path::new(name)).unwrap_err().to_string();
            assert!(error.ends_with(".png, .jpg, .jpeg, .webp, .tif or .tiff"), "{error}");
        }
    }
}
