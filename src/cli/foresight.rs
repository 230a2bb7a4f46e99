//! What work would take, for `--dry-run`: samples, time by the machine's profile, and bytes.

use std::path::Path;
use std::time::Duration;

use flipmap_engine::choice::IntegrationSetting;
use flipmap_engine::profile::Profile;
use flipmap_engine::run_settings::RunSpec;
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_render::output::{Paths, Sinks, is_stdout, whole_bytes};
use flipmap_render::tiles::{Samples, mirrored_bytes};
use flipmap_scene::Document;
use indicatif::{HumanBytes, HumanCount, HumanDuration};

use super::option_names::by_option;
use super::run_options::EngineOptions;

/// Time of a checked pixel of the home map in that of an unchecked one (README.md, measured).
const CHECKED: f64 = 2.5;

/// Time of a pixel whose growth is followed to the end of the budget in that of a flip on the home map
/// (measured on the built-in scene `islands`); other questions take less.
const TO_THE_END: u32 = 25;

/// The effort of some samples on this machine.
pub(super) struct Foresight {
    samples: u64,
    /// Microseconds per integrated pixel of the home map, if the profile has the setting.
    us_per_sample: Option<f64>,
}

impl Foresight {
    /// Foresees samples with a setting. Measures the engines if this machine has no profile yet.
    pub(super) fn of(
        engine: &EngineOptions,
        setting: IntegrationSetting,
        verify: bool,
        samples: u64,
    ) -> Foresight {
        let IntegrationSetting::Accuracy(accuracy) = setting else {
            return Foresight { samples, us_per_sample: None };
        };
        let is_checked = verify || accuracy == Accuracy::Exact;
        let request = engine.request(setting, is_checked);
        let profile =
            Profile::get(request.threads, &|text| super::tell(&format!("flipmap: {text}")));
        let row = profile.fastest(accuracy, |row| {
            let is_kind = request.kind.is_none_or(|kind| row.engine == kind);
            let of_adapter =
                |name: &String| row.engine == EngineKind::Gpu && row.adapter.contains(&**name);
            is_kind && request.adapter.as_ref().is_none_or(of_adapter)
        });
        let effort = if is_checked { CHECKED } else { 1.0 };
        Foresight { samples, us_per_sample: row.map(|row| row.us_per_pixel * effort) }
    }

    /// Returns the effort in words.
    pub(super) fn sentence(&self) -> String {
        let samples = HumanCount(self.samples);
        match self.us_per_sample {
            Some(us) => {
                let time = Duration::from_secs_f64(self.samples as f64 * us * 1e-6);
                format!(
                    "{samples} samples at most; at the {us:.1} µs of the home map they take {}, and \
                     chaotic or deep views several times as long",
                    HumanDuration(time)
                )
            }
            None => format!("{samples} samples at most; this machine's profile has no such method"),
        }
    }
}

/// Says what a render would take, by the rate of the home map in the profile.
pub(super) fn tell_render(
    engine: &EngineOptions,
    document: &Document,
    spec: &RunSpec,
    paths: &Paths,
    state: Option<&Path>,
) -> anyhow::Result<()> {
    let size = spec.size();
    // Opening the outputs refuses sizes that a format or the memory cannot hold.
    let mut files = paths.clone();
    for path in [&mut files.picture, &mut files.raw, &mut files.exr, &mut files.trust] {
        path.take_if(|path| is_stdout(path));
    }
    drop(Sinks::open(&files, document, size)?);
    let samples = document.picture.samples.most_samples(size);
    let effort = Foresight::of(engine, spec.setting, spec.verify, samples);
    super::say(&effort.sentence())?;
    if !document.question.ask.is_time() {
        super::say(&format!("this question can take {TO_THE_END} times as long as that of flips"))?;
    }
    super::say(&memory(document, size, paths, state.is_some()))?;
    let state = state.map(|path| ("--state", path));
    for (option, path) in by_option(paths).into_iter().chain(state) {
        let file = path.display();
        super::say(&format!("{option} {file}: {}", file_size(option, path, size, document)))?;
    }
    Ok(())
}

/// Bytes of a saved pixel in a file and in memory, measured; what it carries along comes on top.
const SAVED_BYTES: [u64; 2] = [160, 700];
/// Bytes of what a pixel carries along, as tangents or for its nearest return.
const CARRIED_BYTES: u64 = 200;

/// Returns the bytes of the saved pixels of a picture in a file and in memory. Mirror images are not
/// saved.
fn saved_bytes(document: &Document, size: [u32; 2]) -> [u64; 2] {
    let carries = document.question.ask.kind().needs.are_carried();
    let [width, height] = size.map(u64::from);
    let saved = match mirrored_bytes(&document.scene(), size) {
        Some(_) => width * height.div_ceil(2),
        None => width * height,
    };
    SAVED_BYTES.map(|bytes| saved * (bytes + if carries { CARRIED_BYTES } else { 0 }))
}

/// Room for the heads of files, their scenes and what surrounds a pyramid.
const BESIDE_PIXELS: u64 = 128 << 10;

/// Returns the size of an output of `size` pixels in words.
fn file_size(option: &str, path: &Path, size: [u32; 2], document: &Document) -> String {
    let [width, height] = size.map(u64::from);
    let pixels = width * height;
    let channels = document.question.ask.kind().channels.len() as u64;
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let ending = ending.as_ref().and_then(|ending| ending.to_str());
    // Axes are lines of numbers if the view is upright, and else numbers for each pixel.
    let is_upright = document.view.rotate == 0.0;
    let axes = if is_upright { 16 * (width + height) } else { 32 * pixels };
    let depth = u64::from(document.picture.bits) / 8;
    let bytes = match (option, ending) {
        ("--raw", Some("npz")) => (8 * channels + 6) * pixels + axes,
        ("--raw", Some("csv")) => (100 + 25 * channels) * pixels,
        ("--raw", _) => 8 * channels * pixels,
        ("--exr", _) => (4 * channels + 16) * pixels,
        ("--state", _) => saved_bytes(document, size)[0],
        // The levels of a pyramid add a third, and every tile is a file.
        ("--pyramid", _) => 4 * pixels + 1024 * (pixels >> 15),
        _ => 3 * depth * pixels + height,
    };
    format!("at most {}", HumanBytes(bytes + BESIDE_PIXELS))
}

/// Memory in bytes of the program itself, its engine and rows on their way.
const OWN_MEMORY: u64 = 300 << 20;

/// Returns the memory that a picture takes, in words: rows are written as they come, but for the
/// formats that are encoded as a whole, and the half of a symmetric map that waits for its turn.
fn memory(document: &Document, size: [u32; 2], paths: &Paths, saves: bool) -> String {
    let mirrored = mirrored_bytes(&document.scene(), document.picture.samples.grid_size(size));
    let wholes = [&paths.picture, &paths.trust].into_iter().flatten();
    let wholes: u64 = wholes.map(|path| whole_bytes(path, size)).sum();
    let saved = if saves { saved_bytes(document, size)[1] } else { 0 };
    let bytes = OWN_MEMORY + mirrored.unwrap_or(0) + wholes + saved;
    format!("memory: up to about {}", HumanBytes(bytes))
}

/// Returns the room that kept samples with this many channels need on the disk, in words.
pub(super) fn samples_size(samples: u64, channels: usize) -> String {
    format!("about {} of samples", HumanBytes(samples * Samples::bytes(channels) as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effort_is_told_in_words() {
        let effort = Foresight { samples: 2_000_000, us_per_sample: Some(30.0) };
        let told = effort.sentence();
        assert!(told.starts_with("2,000,000 samples at most; at the 30.0 µs"), "{told}");
        assert!(told.contains("they take 60 seconds"), "{told}");
        assert!(Foresight { us_per_sample: None, ..effort }.sentence().contains("no such method"));
        let document = Document::default();
        let size = |option, name| file_size(option, Path::new(name), [1024, 1024], &document);
        assert_eq!(size("--raw", "-"), "at most 8.12 MiB");
        assert_eq!(size("-o", "a.tif"), "at most 3.13 MiB");
    }
}
