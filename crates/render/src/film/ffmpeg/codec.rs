//! The codecs of films, and ffmpeg's options for each.

use std::path::Path;

use super::FfmpegError;
use flipmap_scene::SceneError;

/// Codec of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Codec {
    /// H.264 in an `.mp4`, which anyone can play.
    Mp4,
    /// FFV1 in an `.mkv`, without loss.
    Ffv1,
    /// A `.gif` that repeats, with 256 colours for each frame.
    Gif,
    /// An animated `.webp` that repeats.
    WebP,
}

/// A name that no film can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a film is an .mp4, an .mkv (lossless), a .gif, a .webp, or a folder of numbered pictures \
         (with / at the end if its name has a dot)"
)]
pub struct NoFilmName;

/// How well a lossy film keeps its frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmQuality {
    /// Quality from 1 to 100; none for the codec's default.
    pub level: Option<u8>,
    /// True if colours have the full resolution (4:4:4), which fewer players show.
    pub full_chroma: bool,
}

/// A codec, the encoder of ffmpeg that makes it, and its quality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoding {
    /// The codec.
    pub codec: Codec,
    /// Name of the encoder.
    pub encoder: &'static str,
    /// Quality of lossy codecs.
    pub quality: FilmQuality,
}

/// Quality of H.264 by default: almost no loss to the eye.
const CRF: f64 = 16.0;
/// Worst value of that quality.
const MAX_CRF: f64 = 51.0;
/// Quality of WebP by default.
const WEBP_QUALITY: u8 = 90;

impl Codec {
    /// Returns the codec of a film by its name, or `None` for a folder of numbered pictures; refuses
    /// other names. `/` and `..`, beside which no samples could lie, name no film.
    pub fn of_film(path: &Path) -> Result<Option<Codec>, NoFilmName> {
        let codec = Codec::of(path);
        let is_folder = path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/");
        let is_other = (path.extension().is_some() || path.exists()) && !is_folder;
        let is_nameless = path.file_name().is_none() || path.as_os_str() == "-";
        if codec.is_none() && (is_other || is_nameless) { Err(NoFilmName) } else { Ok(codec) }
    }

    /// Returns the codec for the extension of a film's name.
    pub fn of(path: &Path) -> Option<Codec> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "mp4" => Some(Codec::Mp4),
            "mkv" => Some(Codec::Ffv1),
            "gif" => Some(Codec::Gif),
            "webp" => Some(Codec::WebP),
            _ => None,
        }
    }

    /// Returns ffmpeg's encoders for the codec, the best first. Without H.264, an `.mp4` has the
    /// older MPEG-4.
    pub(super) fn encoders(self) -> &'static [&'static str] {
        match self {
            Codec::Mp4 => &["libx264", "libopenh264", "mpeg4"],
            Codec::Ffv1 => &["ffv1"],
            Codec::Gif => &["gif"],
            Codec::WebP => &["libwebp"],
        }
    }

    pub(super) fn instead(self) -> &'static str {
        match self {
            Codec::Mp4 => "an .mkv or a folder of numbered pictures",
            Codec::Ffv1 | Codec::Gif | Codec::WebP => "an .mp4 or a folder of numbered pictures",
        }
    }

    /// Name of the container, which the temporary file's name does not reveal.
    pub(super) fn container(self) -> &'static str {
        match self {
            Codec::Mp4 => "mp4",
            Codec::Ffv1 => "matroska",
            Codec::Gif => "gif",
            Codec::WebP => "webp",
        }
    }

    /// Refuses a size or quality that the codec does not have.
    pub fn check(self, size: [u32; 2], quality: FilmQuality) -> Result<(), FfmpegError> {
        let refuse = |setting, value: String, why: &str| {
            Err(FfmpegError::from(SceneError::new(setting, value, why)))
        };
        if size.contains(&1) {
            let why = "a film needs 2 pixels a side or more, a folder takes any";
            return refuse("size", format!("{}x{}", size[0], size[1]), why);
        }
        let is_lossy = matches!(self, Codec::Mp4 | Codec::WebP);
        match quality.level {
            Some(level) if !is_lossy => {
                let why = "only an .mp4 and a .webp have a quality; this format keeps all it can";
                refuse("quality", level.to_string(), why)
            }
            _ if quality.full_chroma && self != Codec::Mp4 => {
                refuse("full-chroma", "given".to_string(), "only an .mp4 has a choice")
            }
            _ => Ok(()),
        }
    }
}

impl Encoding {
    /// Returns ffmpeg's options for frames of this size.
    pub(super) fn options(&self, size: [u32; 2]) -> String {
        let Encoding { codec, encoder, quality } = self;
        match codec {
            Codec::Mp4 => self.mp4_options(size),
            Codec::Ffv1 => {
                "-c:v ffv1 -pix_fmt bgr0 -level 3 -g 1 -slices 4 -slicecrc 1".to_string()
            }
            // A palette for each frame: one for all of them would keep the whole film in memory.
            Codec::Gif => {
                "-vf split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1 \
                           -c:v gif -loop 0"
                    .to_string()
            }
            // Every frame is whole: differences between frames leave blocks behind in smooth areas.
            Codec::WebP => {
                let level = quality.level.unwrap_or(WEBP_QUALITY);
                format!("-c:v {encoder} -pix_fmt yuv420p -quality {level} -loop 0")
            }
        }
    }

    fn mp4_options(&self, size: [u32; 2]) -> String {
        let Encoding { encoder, quality, .. } = self;
        let pixels = if quality.full_chroma { "yuv444p" } else { "yuv420p" };
        // Colours at half the resolution need even sides: the last row or column is repeated.
        let is_odd = !quality.full_chroma && size.iter().any(|side| side % 2 == 1);
        let pad = if is_odd { padded(size) } else { String::new() };
        let crf = quality.level.map_or(CRF, |level| {
            (MAX_CRF * (100.0 - f64::from(level)) / 99.0 * 10.0).round() / 10.0
        });
        let how = match *encoder {
            "libx264" => format!("-preset medium -crf {crf} -threads 4"),
            // Scales of 2 to 31, with 2 the best.
            "mpeg4" => format!("-qscale:v {}", (2.0 + 29.0 * crf / MAX_CRF - 9.0).max(2.0).round()),
            _ => format!("-b:v {}k", (size[0] * size[1]) / 40 + 500),
        };
        format!(
            "-vf {pad}scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,\
             format={pixels} -c:v {encoder} {how} -colorspace bt709 -color_primaries bt709 \
             -color_trc bt709 -movflags +faststart"
        )
    }
}

/// Returns the filter that makes the sides of frames even, by repeating the last column and row.
fn padded([width, height]: [u32; 2]) -> String {
    let [right, bottom] = [width % 2, height % 2];
    format!(
        "pad={}:{},fillborders=right={right}:bottom={bottom}:mode=smear,",
        width + right,
        height + bottom
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(codec: Codec, size: [u32; 2], level: Option<u8>) -> String {
        let quality = FilmQuality { level, full_chroma: false };
        Encoding { codec, encoder: codec.encoders()[0], quality }.options(size)
    }

    #[test]
    fn qualities_become_those_of_the_encoders() {
        assert!(options(Codec::Mp4, [64, 64], None).contains("-crf 16 "));
        assert!(options(Codec::Mp4, [64, 64], Some(100)).contains("-crf 0 "));
        assert!(options(Codec::Mp4, [64, 64], Some(1)).contains("-crf 51 "));
        assert!(options(Codec::WebP, [64, 64], Some(40)).contains("-quality 40 "));
        let level = FilmQuality { level: Some(40), full_chroma: false };
        for codec in [Codec::Gif, Codec::Ffv1] {
            assert!(
                codec.check([64, 64], level).unwrap_err().to_string().contains("`quality` is 40")
            );
        }
        assert!(Codec::Mp4.check([1, 64], FilmQuality::default()).is_err());
    }

    #[test]
    fn odd_sides_are_made_even() {
        assert!(!options(Codec::Mp4, [64, 48], None).contains("pad="));
        let odd = options(Codec::Mp4, [63, 48], None);
        assert!(odd.contains("pad=64:48,fillborders=right=1:bottom=0:mode=smear,"), "{odd}");
    }
}
