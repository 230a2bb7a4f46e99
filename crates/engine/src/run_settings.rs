//! The first of two stages from words to a kernel: the words of a command line, of a scene inside a
//! picture, of a window or of a plan become one typed [`RunSpec`]. The second stage is the choice
//! of an engine and of an integrator config for it (`choice.rs`).

use std::ops::RangeInclusive;
use std::str::FromStr;

use super::choice::IntegrationSetting;
use super::{Accuracy, IntegratorConfig, Method, Precision};
use flipmap_scene::{RunTable, SceneError, between, decimal_hint, not_among, number};

/// The resolved settings of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSpec {
    /// An accuracy level or an explicit integrator config.
    pub setting: IntegrationSetting,
    /// True if every pixel is checked.
    pub verify: bool,
    /// The equivalent run table with every setting filled in. With a level, its `verify` is true
    /// only if checks were requested in addition to the level.
    pub table: RunTable,
}

impl RunSpec {
    /// Size of the picture in pixels if nothing gives one.
    pub const DEFAULT_SIZE: [u32; 2] = [1024, 1024];

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.table.size.unwrap_or(RunSpec::DEFAULT_SIZE)
    }

    /// The settings of an accuracy level.
    pub fn of_level(level: Accuracy) -> Self {
        RunSpec {
            setting: IntegrationSetting::Accuracy(level),
            verify: level.verifies(),
            table: RunTable { accuracy: Some(level.to_string()), ..RunTable::default() },
        }
    }

    /// Resolves the words of a run table to settings.
    pub fn resolve(words: RunTable) -> Result<Self, SceneError> {
        let (setting, table) = resolve(words)?;
        let by_level = matches!(setting, IntegrationSetting::Accuracy(level) if level.verifies());
        Ok(RunSpec { setting, verify: table.verify || by_level, table })
    }
}

fn resolve(words: RunTable) -> Result<(IntegrationSetting, RunTable), SceneError> {
    let mut accuracy = Accuracy::default();
    set(&mut accuracy, "accuracy", &words.accuracy, Accuracy::from_str)?;
    let (verify, size) = (words.verify, words.size);
    let explicit = [&words.method, &words.step, &words.tolerance, &words.precision];
    if explicit.iter().all(|word| word.is_none()) {
        let word = Some(accuracy.to_string());
        let run = RunTable { size, accuracy: word, verify, ..RunTable::default() };
        return Ok((IntegrationSetting::Accuracy(accuracy), run));
    }
    let config = config(&words, accuracy)?;
    let step = config.method.step_secs().map(|_| words.step.unwrap_or("1/120".to_string()));
    let run = RunTable {
        size,
        accuracy: None,
        method: Some(config.method.name().to_string()),
        step,
        tolerance: config.method.tolerance().map(|tolerance| format!("{tolerance:e}")),
        precision: Some(config.precision.to_string()),
        // Of the level, only its checks remain in force.
        verify: verify || accuracy.verifies(),
    };
    Ok((IntegrationSetting::Explicit(config), run))
}

/// The words that resolve to exactly this configuration.
pub fn from_config(config: IntegratorConfig) -> RunTable {
    // The shortest number that reads back as the same value.
    let step = config.method.step_secs().map(|step_secs| format!("{step_secs:?}"));
    RunTable {
        method: Some(config.method.name().to_string()),
        step,
        tolerance: config.method.tolerance().map(|tolerance| format!("{tolerance:e}")),
        precision: Some(config.precision.to_string()),
        ..RunTable::default()
    }
}

fn config(words: &RunTable, accuracy: Accuracy) -> Result<IntegratorConfig, SceneError> {
    let level = accuracy.configs()[0];
    let mut precision = match (&words.method, &words.step) {
        (Some(method), _) => Method::home_precision(method),
        (None, Some(_)) => Precision::F32,
        (None, None) => level.precision,
    };
    set(&mut precision, "precision", &words.precision, Precision::from_str)?;
    let name = match (&words.method, &words.step) {
        (Some(name), _) => name.as_str(),
        (None, Some(_)) => "rk4",
        // The lesson fixes its method; the other levels have one for each precision.
        (None, None) if precision == level.precision || accuracy == Accuracy::Lesson => {
            level.method.name()
        }
        (None, None) => Method::home_method(precision),
    };
    let Some(mut method) = Method::named(name, precision) else {
        let allowed = not_among("methods", &Method::names(), name);
        return Err(SceneError::new("method", format!("'{name}'"), allowed));
    };
    let Some(least) = method.least_tolerance(precision) else {
        let fitting = Precision::ALL.iter().filter(|(_, p)| method.least_tolerance(*p).is_some());
        let fitting: Vec<&str> = fitting.map(|(word, _)| *word).collect();
        let allowed = format!("the method {name} runs in {}", fitting.join(", "));
        return Err(SceneError::new("precision", format!("'{precision}'"), allowed));
    };
    if let Some(step) = &words.step {
        method = with_step(method, step)?;
    }
    if let Some(tolerance) = &words.tolerance {
        method = with_tolerance(method, tolerance, precision, least)?;
    }
    Ok(IntegratorConfig { method, precision })
}

/// Range of the step of rk4 in s.
const STEPS_SECS: RangeInclusive<f64> = 1e-9..=1.0;

fn with_step(method: Method, step: &str) -> Result<Method, SceneError> {
    let refuse = |allowed: String| SceneError::new("step", format!("'{step}'"), allowed);
    if method.step_secs().is_none() {
        let name = method.name();
        return Err(refuse(format!("it is for rk4; {name} chooses its steps by a tolerance")));
    }
    let step_secs = match step.split_once('/') {
        Some((above, below)) => {
            number(above).zip(number(below)).map(|(above, below)| above / below)
        }
        None => number(step),
    };
    match step_secs {
        Some(step_secs) if STEPS_SECS.contains(&step_secs) => Ok(Method::Rk4 { step_secs }),
        _ => Err(refuse(format!(
            "it must be seconds {}, as a number or a fraction{}",
            between(&STEPS_SECS),
            decimal_hint(step, 1)
        ))),
    }
}

/// Largest tolerance that is accepted.
const MAX_TOLERANCE: f64 = 1e-2;

fn with_tolerance(
    method: Method,
    text: &str,
    precision: Precision,
    least: f64,
) -> Result<Method, SceneError> {
    let refuse = |allowed: &str| {
        SceneError::new(
            "tolerance",
            format!("'{text}'"),
            format!("{allowed}{}", decimal_hint(text, 1)),
        )
    };
    let Some(tolerant) = number(text).and_then(|tolerance| method.with_tolerance(tolerance)) else {
        return Err(refuse(match method.step_secs() {
            Some(_) => "it is for methods that choose their steps; rk4 takes a step",
            None => "it must be a number",
        }));
    };
    let within = |tolerance: f64| (least..=MAX_TOLERANCE).contains(&tolerance);
    if tolerant.tolerance().is_some_and(within) {
        return Ok(tolerant);
    }
    Err(refuse(&format!("in {precision} it must lie between {least:e} and {MAX_TOLERANCE:e}")))
}

/// Replaces `value` by the parsed word, if there is one; an error names the setting.
fn set<T, Why: std::fmt::Display>(
    value: &mut T,
    setting: &'static str,
    word: &Option<String>,
    parse: impl Fn(&str) -> Result<T, Why>,
) -> Result<(), SceneError> {
    if let Some(word) = word {
        let refuse = |why: Why| SceneError::new(setting, format!("'{word}'"), why.to_string());
        *value = parse(word).map_err(refuse)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_comes_back_from_its_words() {
        let odd = Method::Rk4 { step_secs: 1.0 / 117.3 };
        let mut configs = vec![IntegratorConfig { method: odd, precision: Precision::F64 }];
        configs.extend(Accuracy::ALL.iter().flat_map(|(_, level)| level.configs()));
        for config in configs {
            let (setting, _) = resolve(from_config(config)).unwrap();
            assert_eq!(setting, IntegrationSetting::Explicit(config));
        }
    }

    fn said(words: &[(&str, &str)]) -> Result<IntegrationSetting, String> {
        let word = |name: &str| words.iter().find(|(n, _)| *n == name).map(|(_, w)| w.to_string());
        let words = RunTable {
            accuracy: word("accuracy"),
            method: word("method"),
            step: word("step"),
            tolerance: word("tolerance"),
            precision: word("precision"),
            ..RunTable::default()
        };
        resolve(words).map(|(setting, _)| setting).map_err(|error| error.to_string())
    }

    fn config(words: &[(&str, &str)]) -> IntegratorConfig {
        match said(words).unwrap() {
            IntegrationSetting::Explicit(config) => config,
            level => panic!("{level:?}"),
        }
    }

    #[test]
    fn steps_are_numbers_or_fractions() {
        assert_eq!(config(&[("method", "rk4"), ("step", "1/120")]).method, Method::LESSON);
        assert_eq!(config(&[("step", "1e-3")]).method, Method::Rk4 { step_secs: 1e-3 });
        for bad in ["0", "-1/120", "nan", "inf", "1/0", "2", "x", "1/"] {
            let message = said(&[("step", bad)]).unwrap_err();
            assert!(message.contains("`step`") && message.contains("between 1e-9 and 1"), "{bad}");
        }
    }

    #[test]
    fn what_is_not_said_follows_from_what_is() {
        assert_eq!(said(&[]).unwrap(), IntegrationSetting::Accuracy(Accuracy::Balanced));
        assert_eq!(
            said(&[("accuracy", "fast")]).unwrap(),
            IntegrationSetting::Accuracy(Accuracy::Fast)
        );
        let of = |words: &[(&str, &str)]| {
            let IntegratorConfig { method, precision } = config(words);
            (method.name(), precision, method.tolerance())
        };
        assert_eq!(of(&[("tolerance", "1e-9")]), ("dop853", Precision::F64, Some(1e-9)));
        assert_eq!(of(&[("precision", "f32")]), ("dopri5", Precision::F32, Some(5e-8)));
        assert_eq!(of(&[("precision", "df32")]), ("dop853", Precision::Df32, Some(1e-12)));
        assert_eq!(of(&[("precision", "dd")]), ("taylor", Precision::Dd, Some(1e-25)));
        assert_eq!(of(&[("method", "rk4")]), ("rk4", Precision::F32, None));
        assert_eq!(of(&[("method", "rk4"), ("precision", "f64")]).1, Precision::F64);
        let lesson = of(&[("accuracy", "lesson"), ("precision", "f64")]);
        assert_eq!((lesson.0, lesson.1), ("rk4", Precision::F64));
    }

    #[test]
    fn what_does_not_go_together_is_refused_with_what_does() {
        for (words, parts) in [
            (&[("method", "dop853"), ("step", "0.01")][..], &["`step`", "a tolerance"][..]),
            (&[("method", "rk4"), ("tolerance", "1e-9")], &["`tolerance`", "a step"]),
            (&[("tolerance", "1e-17")], &["`tolerance`", "f64", "1e-15", "1e-2"]),
            (&[("tolerance", "1e-9"), ("precision", "f32")], &["1e-8"]),
            (&[("tolerance", "one")], &["number"]),
            (&[("method", "taylor"), ("precision", "f32")], &["`precision`", "f64, dd"]),
            (&[("method", "euler")], &["rk4, dopri5, dop853, taylor"]),
            (&[("accuracy", "perfect")], &["lesson, fast, balanced, exact"]),
        ] {
            let message = said(words).unwrap_err();
            assert!(parts.iter().all(|part| message.contains(part)), "{words:?}: {message}");
        }
    }
}
