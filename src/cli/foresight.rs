//! What work would take, for `--dry-run`: samples, time by the machine's profile, and bytes.

use std::path::Path;
use std::time::Duration;

use flipmap_engine::choice::IntegrationSetting;
use flipmap_engine::profile::Profile;
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_render::tiles::Samples;
use flipmap_scene::QuestionSettings;
use indicatif::{HumanBytes, HumanCount, HumanDuration};

use super::run_options::EngineOptions;

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
        samples: u64,
    ) -> Foresight {
        let IntegrationSetting::Accuracy(accuracy) = setting else {
            return Foresight { samples, us_per_sample: None };
        };
        let request = engine.request(setting, accuracy == Accuracy::Exact);
        let profile =
            Profile::get(request.threads, &|text| super::tell(&format!("flipmap: {text}")));
        let row = profile.fastest(accuracy, |row| {
            let is_kind = request.kind.is_none_or(|kind| row.engine == kind);
            let of_adapter =
                |name: &String| row.engine == EngineKind::Gpu && row.adapter.contains(&**name);
            is_kind && request.adapter.as_ref().is_none_or(of_adapter)
        });
        Foresight { samples, us_per_sample: row.map(|row| row.us_per_pixel) }
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

/// Returns the size of an output of `size` pixels in words.
pub(super) fn file_size(path: &Path, size: [u32; 2], question: &QuestionSettings) -> String {
    let pixels = size.map(u64::from).iter().product::<u64>();
    let channels = question.ask.kind().channels.len() as u64;
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let bytes = match ending.as_ref().and_then(|ending| ending.to_str()) {
        Some("npy") => 8 * channels * pixels,
        Some("npz") => (8 * channels + 6) * pixels,
        Some("csv") => (50 + 20 * channels) * pixels,
        Some("exr") => (4 * channels + 16) * pixels,
        Some("tif" | "tiff") => return format!("{}", HumanBytes(3 * pixels)),
        _ => 3 * pixels,
    };
    format!("at most {}", HumanBytes(bytes))
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
        let size =
            |name: &str| file_size(Path::new(name), [1024, 1024], &QuestionSettings::default());
        assert_eq!((size("a.npy"), size("a.tif")), ("at most 8.00 MiB".into(), "3.00 MiB".into()));
    }
}
