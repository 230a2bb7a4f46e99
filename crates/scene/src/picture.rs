//! The settings for painting a picture from its samples; none changes what is computed.

mod sampling;

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::SceneError;
use super::allowed::{between, in_a_row, named};
use super::palette::{Ground, GroundTable, Palette, rise};
use crate::question::{ChannelScale, Painted, QuestionName};
pub use sampling::Sampling;

/// The table `[picture]` of a scene's file. Keys added after the first release are written only
/// where they differ from their defaults, so that older pictures remain the same files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PictureTable {
    /// Name of the palette.
    pub palette: String,
    /// True if the energy curve is drawn.
    pub curve: bool,
    /// Samples of each pixel.
    pub samples: Sampling,
    /// True if a pixel that looks like all its neighbours gets only one of its several samples.
    #[serde(skip_serializing_if = "is_default")]
    pub adaptive: bool,
    /// True if the grain of unresolved chaos is smoothed along its bands.
    #[serde(skip_serializing_if = "is_true")]
    pub denoise: bool,
    /// True if late flips have the palette's first colour.
    #[serde(skip_serializing_if = "is_default")]
    pub reverse: bool,
    /// Number of runs through the palette.
    #[serde(skip_serializing_if = "is_once")]
    pub cycles: f64,
    /// True if every second run through the palette goes backwards, which avoids a seam.
    #[serde(skip_serializing_if = "is_default")]
    pub mirror: bool,
    /// Share of the palette that precedes the first time, from 0 to 1; 0 and 1 look the same.
    #[serde(skip_serializing_if = "is_default")]
    pub offset: f64,
    /// Scale between two entries of `times`.
    #[serde(skip_serializing_if = "is_default")]
    pub scale: Scale,
    /// Seconds at which equal steps of the palette lie: empty for the range from the pendulum's
    /// natural unit of time to the budget, two for another range, more for a stretched one.
    #[serde(skip_serializing_if = "is_default")]
    pub times: Vec<f64>,
    /// True if `times` were taken from the view's own, and would be again if it moved.
    #[serde(skip_serializing_if = "is_default")]
    pub of_view: bool,
    /// Name of the question's channel that is painted and written; `None` writes all channels and
    /// paints the question's natural colours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// True if a legend is drawn in the corner.
    #[serde(skip_serializing_if = "is_default")]
    pub legend: bool,
    /// True if a bar of round length, and the time that the picture shows, are drawn in the corner.
    #[serde(skip_serializing_if = "is_default")]
    pub caption: bool,
    /// Bits of each channel of a picture's colours, 8 or 16.
    #[serde(skip_serializing_if = "is_eight")]
    pub bits: u8,
    /// Share of the light that falls from the side on a landscape of times, from 0 to 1.
    #[serde(skip_serializing_if = "is_default")]
    pub relief: f64,
    /// Direction to the light from the side in degrees, anticlockwise from the right.
    #[serde(skip_serializing_if = "is_upper_left")]
    pub light: f64,
    /// Colours of pixels without an answer and of the energy curve.
    #[serde(skip_serializing_if = "is_default")]
    pub colours: GroundTable,
}

impl Default for PictureTable {
    fn default() -> Self {
        PictureTable {
            palette: Palette::DEFAULT.to_string(),
            curve: true,
            samples: Sampling::default(),
            adaptive: false,
            denoise: true,
            reverse: false,
            cycles: 1.0,
            mirror: false,
            offset: 0.0,
            scale: Scale::Log,
            times: Vec::new(),
            of_view: false,
            channel: None,
            legend: false,
            caption: false,
            bits: 8,
            relief: 0.0,
            light: UPPER_LEFT_DEG,
            colours: GroundTable::default(),
        }
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_true(value: &bool) -> bool {
    *value
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_once(cycles: &f64) -> bool {
    *cycles == 1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_eight(bits: &u8) -> bool {
    *bits == 8
}

/// Direction to the light in degrees from which hills look like hills and not like hollows.
const UPPER_LEFT_DEG: f64 = 135.0;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_upper_left(light: &f64) -> bool {
    *light == UPPER_LEFT_DEG
}

/// The scale that relates times to colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Equal ratios of times are equal steps of colour.
    #[default]
    Log,
    /// Equal differences of times are equal steps of colour.
    Linear,
    /// All times between two of the picture's times have one colour.
    Steps,
}

impl Scale {
    /// Every scale with its name.
    pub const ALL: [(&'static str, Scale); 3] =
        [("log", Scale::Log), ("linear", Scale::Linear), ("steps", Scale::Steps)];
}

impl FromStr for Scale {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        named("scales", &Self::ALL, text)
    }
}

/// The part of a question's answers that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The question's natural colours; arrays hold all channels.
    Natural,
    /// One channel, which is also the only one in arrays.
    Channel(usize),
    /// All channels, painted in another way.
    Tint(Painted),
}

impl PictureTable {
    /// Decades of a film's zoom above which its colours are spread over its own times.
    pub const SPREAD_FILM_DECADES: f64 = 1.0;
    /// Range of samples per pixel along each axis.
    pub const SAMPLES: std::ops::RangeInclusive<u32> = 1..=8;
    /// Samples per pixel along each axis where colours change, in adaptive sampling.
    pub const ADAPTIVE: u32 = 3;
    /// Samples per pixel along each axis up to which grain is smoothed.
    const DENOISED: u32 = 3;
    /// Largest number of pixels of a picture that is sampled adaptively, because all are held in
    /// memory at once.
    const MAX_ADAPTIVE_PIXELS: u64 = 1 << 25;
    /// Range of the number of times that the palette can be run through.
    pub const CYCLES: std::ops::RangeInclusive<f64> = 1.0..=100.0;
    /// Range of the palette's offset.
    pub const OFFSETS: std::ops::RangeInclusive<f64> = 0.0..=1.0;
    /// Range of the strength of the light from the side.
    pub const RELIEFS: std::ops::RangeInclusive<f64> = 0.0..=1.0;
    /// Range of the direction to the light from the side, in degrees.
    pub const LIGHTS_DEG: std::ops::RangeInclusive<f64> = -360.0..=360.0;
    /// Range of the times that colours can stand for, s.
    pub const SECS: std::ops::RangeInclusive<f64> = 1e-9..=1e6;
    /// Largest number of entries in `times`.
    pub const MAX_TIMES: usize = 257;

    /// Longest side of a picture in pixels.
    pub const MAX_SIDE: u32 = 1_000_000;
    /// Largest number of samples in a row of a picture.
    const MAX_ROW: u32 = 1 << 20;

    /// Checks that a picture of this size can be painted with these settings.
    pub fn check_size(&self, size: [u32; 2]) -> Result<(), SceneError> {
        let value = format!("{}x{}", size[0], size[1]);
        let refuse = |value: String, allowed: String| Err(SceneError::new("size", value, allowed));
        if !size.iter().all(|side| (1..=Self::MAX_SIDE).contains(side)) {
            let most = Self::MAX_SIDE;
            return refuse(value, format!("both sides must lie between 1 and {most} pixels"));
        }
        if size[0] * self.samples.along() > Self::MAX_ROW {
            let value = format!("{value} with samples {}", self.samples);
            return refuse(value, format!("at most {} samples fit in a row", Self::MAX_ROW));
        }
        if self.adaptive && self.samples.along() > 1 && !Self::fits_adaptive(size) {
            let allowed = format!(
                "at most {} pixels are sampled adaptively; samples {} has no such limit",
                Self::MAX_ADAPTIVE_PIXELS,
                Self::ADAPTIVE
            );
            return refuse(format!("{value} with samples auto"), allowed);
        }
        Ok(())
    }

    /// Returns true if a picture of this question takes several samples only in pixels where
    /// colours change. The question must have a time as its only channel, because such a time is
    /// the same all over a pixel that looks uniform.
    pub fn is_adaptive(&self, ask: QuestionName) -> bool {
        let several = self.adaptive && self.samples.along() > 1;
        several && ask.is_time() && ask.kind().channels.len() == 1
    }

    /// Returns the samples of each pixel in a picture of this size. A picture with too many pixels
    /// to hold at once gets one sample per pixel instead of samples in corners.
    pub fn samples_of(&self, size: [u32; 2]) -> Sampling {
        match self.samples {
            Sampling::Corners if !Self::fits_adaptive(size) => Sampling::SINGLE,
            samples => samples,
        }
    }

    /// Returns true if all pixels of a picture can be held in memory at once.
    fn fits_adaptive(size: [u32; 2]) -> bool {
        size.into_iter().map(u64::from).product::<u64>() <= Self::MAX_ADAPTIVE_PIXELS
    }

    /// Returns true if grain is smoothed. Pixels with many samples have little, and more to lose.
    pub fn denoises(&self) -> bool {
        self.denoise && self.samples.along() <= Self::DENOISED
    }

    /// Returns the part of a question's answers that is shown.
    pub fn shown(&self, ask: QuestionName) -> Result<Shown, SceneError> {
        let Some(name) = &self.channel else { return Ok(Shown::Natural) };
        if let Some((_, tint)) = ask.kind().tint.filter(|(tint, _)| tint == name) {
            return Ok(Shown::Tint(tint));
        }
        let allowed = || ask.kind().has_no_channel(name);
        let refused = || SceneError::new("channel", format!("'{name}'"), allowed());
        ask.channel(name).map(Shown::Channel).ok_or_else(refused)
    }

    /// Forgets times that were taken from the view: they suit no other.
    pub fn forget_view_times(&mut self) {
        if self.of_view {
            (self.times, self.of_view) = (Vec::new(), false);
        }
    }

    /// Returns this picture in the colours of another: what belongs to the picture itself stays.
    pub fn with_colours_of(&self, other: &PictureTable) -> Self {
        PictureTable {
            curve: self.curve,
            samples: self.samples,
            adaptive: self.adaptive,
            legend: self.legend,
            caption: self.caption,
            bits: self.bits,
            channel: self.channel.clone(),
            ..other.clone()
        }
    }

    /// Returns true if the colours of times follow the view's own, because the user chose none.
    pub fn follows_view(&self) -> bool {
        self.times.is_empty() || self.of_view
    }

    /// Returns true if the colours show times.
    pub fn paints_times(&self, ask: QuestionName) -> bool {
        let kind = ask.kind();
        let channel = match self.shown(ask) {
            Ok(Shown::Channel(channel)) => Some(channel),
            Ok(Shown::Natural) if kind.painted == Painted::First => Some(0),
            _ => None,
        };
        channel.is_some_and(|channel| kind.channels[channel].scale == ChannelScale::Times)
    }

    /// Checks that every setting can be used.
    pub fn check(&self) -> Result<(), SceneError> {
        Ground::of(self)?;
        let refuse =
            |setting, value: String, allowed: &str| Err(SceneError::new(setting, value, allowed));
        if !Self::SAMPLES.contains(&self.samples.along()) {
            let (least, most) = Self::SAMPLES.into_inner();
            let allowed = format!("it must be corners or lie between {least} and {most}");
            return refuse("samples", self.samples.to_string(), &allowed);
        }
        if !matches!(self.bits, 8 | 16) {
            return refuse("bits", self.bits.to_string(), "it must be 8 or 16");
        }
        for (setting, value, range, unit) in [
            ("cycles", self.cycles, Self::CYCLES, ""),
            ("offset", self.offset, Self::OFFSETS, ""),
            ("relief", self.relief, Self::RELIEFS, ""),
            ("light", self.light, Self::LIGHTS_DEG, " degrees"),
        ] {
            if !range.contains(&value) {
                let allowed = format!("it must lie {}{unit}", between(&range));
                return refuse(setting, value.to_string(), &allowed);
            }
        }
        let few = matches!(self.times.len(), 0 | 2..=Self::MAX_TIMES);
        if !few || !self.times.iter().all(|secs| Self::SECS.contains(secs)) || !rise(&self.times) {
            let allowed = format!(
                "it must be 2 to {} times {} s, each later than the one before",
                Self::MAX_TIMES,
                between(&Self::SECS)
            );
            return refuse("times", in_a_row(&self.times, "and"), &allowed);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_painted_is_refused_by_name() {
        type Change = fn(&mut PictureTable);
        let changes: [(&str, Change); 13] = [
            ("`palette` is 'rainbow'; the palettes are iris", |p| p.palette = "rainbow".into()),
            ("`samples` is 9; it must be corners or lie", |p| p.samples = Sampling::Square(9)),
            ("`cycles` is 0; it must", |p| p.cycles = 0.0),
            ("`cycles` is NaN; it must", |p| p.cycles = f64::NAN),
            ("`times` is 1; it must be 2 to", |p| p.times = vec![1.0]),
            ("each later", |p| p.times = vec![2.0, 1.0]),
            ("each later", |p| p.times = vec![1.0, 1.0 + f64::EPSILON]),
            ("`bits` is 12; it must be 8 or 16", |p| p.bits = 12),
            ("`offset` is 1.5; it must", |p| p.offset = 1.5),
            ("`relief` is NaN; it must", |p| p.relief = f64::NAN),
            ("`light` is 400; it must", |p| p.light = 400.0),
            ("between 1e-9", |p| p.times = vec![0.0, 1.0]),
            ("between 1e-9", |p| p.times = vec![1.0, f64::NAN]),
        ];
        PictureTable::default().check().unwrap();
        for (words, change) in changes {
            let mut picture = PictureTable::default();
            change(&mut picture);
            let error = picture.check().unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn sizes_end_where_rows_get_too_long() {
        let samples = Sampling::Square(2);
        let picture = PictureTable { samples, ..PictureTable::default() };
        picture.check_size([524_288, 1_000_000]).unwrap();
        let adaptive = PictureTable { adaptive: true, ..picture.clone() };
        adaptive.check_size([7680, 4320]).unwrap();
        let single = PictureTable { samples: Sampling::SINGLE, ..adaptive.clone() };
        single.check_size([8192, 8192]).unwrap();
        let error = adaptive.check_size([8192, 8192]).unwrap_err().to_string();
        assert!(error.contains("samples auto") && error.contains("samples 3"), "{error}");
        let corners = PictureTable::default();
        assert_eq!(corners.samples_of([7680, 4320]), Sampling::Corners);
        assert_eq!(corners.samples_of([8192, 8192]), Sampling::SINGLE);
        assert_eq!(picture.samples_of([8192, 8192]), Sampling::Square(2));
        for size in [[0, 1], [1, 1_000_001], [524_289, 1]] {
            let error = picture.check_size(size).unwrap_err().to_string();
            assert!(error.contains(&format!("`size` is {}x{}", size[0], size[1])), "{error}");
        }
    }

    #[test]
    fn a_plain_picture_writes_no_newer_keys() {
        let text = toml::to_string(&PictureTable::default()).unwrap();
        assert_eq!(text, "palette = \"iris\"\ncurve = true\nsamples = \"corners\"\n");
        let rich = PictureTable {
            reverse: true,
            cycles: 2.5,
            scale: Scale::Linear,
            times: vec![0.5, 2.0, 9.0],
            mirror: true,
            offset: 0.25,
            bits: 16,
            relief: 0.5,
            light: 90.0,
            samples: Sampling::Square(3),
            adaptive: true,
            denoise: false,
            ..PictureTable::default()
        };
        assert_eq!(toml::from_str::<PictureTable>(&toml::to_string(&rich).unwrap()).unwrap(), rich);
    }
}
