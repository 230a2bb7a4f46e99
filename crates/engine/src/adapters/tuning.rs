//! Settings of the engine that change its speed, for measurements on a device and for windows.

use std::time::Duration;

/// Settings that change the speed of a device; `general` and `at_once` also change the roundings of
/// answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuTuning {
    /// Longest time that a submission may run.
    pub pace: Duration,
    /// Number of steps of a kernel's first slice, before anything has been measured.
    pub first_slice: u32,
    /// Largest number of slices in a submission.
    pub slices: u32,
    /// Largest number of jobs on the device at a time.
    pub slots: usize,
    /// A suitable number of starts for a job; `None` for the adapter's default.
    pub job_size: Option<usize>,
    /// Number of invocations in a workgroup.
    pub workgroup: u32,
    /// True if invocations of a subgroup may exchange values where the adapter can.
    pub subgroups: bool,
    /// True if kernels read their scene as data, false if they are made for it.
    pub general: bool,
    /// True if the general kernel answers at once while the scene's own kernel is compiled for
    /// later pictures. This is for windows only, because answers then depend on time.
    pub at_once: bool,
}

/// Longest time that a submission may run when no window is open; drivers reset at 2 s.
const HEADLESS_PACE: Duration = Duration::from_millis(50);

impl Default for GpuTuning {
    fn default() -> Self {
        GpuTuning {
            pace: HEADLESS_PACE,
            first_slice: 8,
            slices: 8,
            slots: 2,
            job_size: None,
            workgroup: 64,
            subgroups: true,
            general: false,
            at_once: false,
        }
    }
}

impl GpuTuning {
    /// Returns the same settings with one changed by a text like `pace=20`, or an error that says
    /// what is wrong with the text.
    pub fn with(self, text: &str) -> Result<Self, String> {
        let (key, value) = text.split_once('=').unwrap_or((text, ""));
        let number = |least: u32, most: u32| {
            let number = value.parse().ok().filter(|number| (least..=most).contains(number));
            number.ok_or_else(|| format!("{key} must be a whole number from {least} to {most}"))
        };
        let switch = || match value {
            "on" => Ok(true),
            "off" => Ok(false),
            _ => Err(format!("{key} must be on or off")),
        };
        Ok(match key {
            "pace" => GpuTuning { pace: Duration::from_millis(number(1, 1000)?.into()), ..self },
            "first_slice" => GpuTuning { first_slice: number(1, 10_000)?, ..self },
            "slices" => GpuTuning { slices: number(1, MAX_SLICES)?, ..self },
            "slots" => GpuTuning { slots: number(1, 8)? as usize, ..self },
            "job_size" => {
                GpuTuning { job_size: Some(number(1 << 10, MAX_STARTS)? as usize), ..self }
            }
            "workgroup" => match number(32, 256)? {
                size if size.is_power_of_two() => GpuTuning { workgroup: size, ..self },
                _ => return Err("workgroup must be 32, 64, 128 or 256".to_string()),
            },
            "subgroups" => GpuTuning { subgroups: switch()?, ..self },
            "general" => GpuTuning { general: switch()?, ..self },
            _ => return Err(format!("the keys are {}", Self::KEYS.join(", "))),
        })
    }

    /// Every key of [`GpuTuning::with`].
    pub(crate) const KEYS: [&str; 8] =
        ["pace", "first_slice", "slices", "slots", "job_size", "workgroup", "subgroups", "general"];
}

/// Largest number of starts in a job: a dispatch has at most 65,535 workgroups along a side, of at
/// least 32 invocations each.
const MAX_STARTS: u32 = 2_000_000;
/// Largest number of slices that a submission can have.
pub(crate) const MAX_SLICES: u32 = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_understood_and_out_of_range_values_are_refused_in_words() {
        for (key, value) in GpuTuning::KEYS.into_iter().zip([
            ("20", "0"),
            ("1", "0"),
            ("4", "17"),
            ("3", "9"),
            ("4096", "12"),
            ("128", "96"),
            ("off", "no"),
            ("on", "1"),
        ]) {
            let (good, bad) = value;
            let tuned = GpuTuning::default().with(&format!("{key}={good}")).unwrap();
            assert_ne!(tuned, GpuTuning::default(), "{key}");
            let error = GpuTuning::default().with(&format!("{key}={bad}")).unwrap_err();
            assert!(error.contains(key) && error.contains("must be"), "{error}");
        }
        let error = GpuTuning::default().with("speed=9").unwrap_err();
        assert!(error.contains("the keys are pace, first_slice"), "{error}");
        assert!(GpuTuning::default().with("pace").is_err());
    }
}
