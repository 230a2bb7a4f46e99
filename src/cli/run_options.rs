//! The options that say how a scene is computed, and how they become a demand.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use flipmap::engine::choice::{self, Demand, Wish};
use flipmap::engine::{Accuracy, Method, Precision, Recipe};
use flipmap::scene::{Document, PictureTable, RunTable};

use super::exit::Exit;
use super::options::{number, set};

/// How to compute it.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Run")]
pub struct RunOptions {
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<String>,
    /// lesson: RK4 at 120 steps a second in f32; fast: the best of f32; balanced (default): all
    /// but one pixel in a thousand within 1 ms; exact: every pixel checked, and marked where the
    /// checks disagree
    #[arg(long, value_name = "LEVEL")]
    accuracy: Option<String>,
    /// rk4, dopri5, dop853 or taylor: run exactly this instead of a level
    #[arg(long)]
    method: Option<String>,
    /// Seconds a step of rk4, as a number or a fraction
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    step: Option<String>,
    /// Error a step of the other methods may make
    #[arg(long, allow_hyphen_values = true)]
    tolerance: Option<String>,
    /// f32, df32, f64 or dd
    #[arg(long)]
    precision: Option<String>,
    /// Check every pixel, whatever the accuracy
    #[arg(long)]
    verify: bool,
    /// auto: the fastest of the measured profile
    #[arg(long, value_enum, default_value_t = EngineKind::Auto)]
    engine: EngineKind,
    /// Part of the name of the adapter to use
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Threads of the CPU engine (default: one for each core)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineKind {
    #[default]
    Auto,
    Gpu,
    Cpu,
}

/// Without `--size`.
const DEFAULT_SIZE: [u32; 2] = [1024, 1024];

/// What is to be run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// A level or a recipe.
    pub demand: Demand,
    /// Whether every pixel is checked.
    pub verify: bool,
    /// Pixels.
    pub size: [u32; 2],
}

impl RunOptions {
    /// The engine asked for.
    pub fn wish(&self, demand: Demand) -> Wish {
        Wish {
            kind: match self.engine {
                EngineKind::Auto => choice::Kind::Auto,
                EngineKind::Gpu => choice::Kind::Gpu,
                EngineKind::Cpu => choice::Kind::Cpu,
            },
            adapter: self.adapter.clone(),
            threads: self.threads(),
            demand,
            ..Wish::default()
        }
    }

    /// Threads of the processor to use.
    pub fn threads(&self) -> Option<usize> {
        self.threads.map(|threads| threads as usize)
    }

    /// Refuses options that contradict each other.
    pub fn check(&self) -> Result<(), Exit> {
        let usage = |message: &str| Err(Exit::Usage(message.to_string()));
        match self.engine {
            EngineKind::Cpu if self.adapter.is_some() => {
                usage("--adapter names a graphics adapter; leave it out with --engine cpu")
            }
            EngineKind::Gpu if self.threads.is_some() => {
                usage("--threads is for the processor; leave it out with --engine gpu")
            }
            _ => Ok(()),
        }
    }

    /// Fills in the document's run table, so that it says what ran, and gives the same typed.
    pub fn settle(&self, document: &mut Document) -> Result<Plan, Exit> {
        let mut size = document.run.size.unwrap_or(DEFAULT_SIZE);
        set(&mut size, "--size", &self.size, parse_size)?;
        if size.iter().any(|side| !(1..=PictureTable::LONGEST_SIDE).contains(side)) {
            let text = format!("{}x{}", size[0], size[1]);
            return Err(Exit::Usage(format!("--size is '{text}'; {SIZE}")));
        }
        let kept = std::mem::take(&mut document.run);
        let said = self.words_over(&kept);
        let (demand, run) = said.settle()?;
        let verify =
            run.verify || self.verify || matches!(demand, Demand::Level(l) if l.verifies());
        document.run = RunTable { size: Some(size), verify: run.verify || self.verify, ..run };
        Ok(Plan { demand, verify, size })
    }

    /// What is said on the command line, over what the scene's file kept: a level there replaces
    /// any recipe in the file, a method there its step or tolerance.
    fn words_over(&self, kept: &RunTable) -> Words {
        let kept = if self.accuracy.is_some() { RunTable::default() } else { kept.clone() };
        let method = self.method.clone().or(kept.method.clone());
        let same_method = self.method.is_none() || self.method == kept.method;
        let of_kept = |text: Option<String>| text.filter(|_| same_method);
        Words {
            accuracy: self.accuracy.clone().or(kept.accuracy),
            step: self.step.clone().or(of_kept(kept.step)),
            tolerance: self.tolerance.clone().or(of_kept(kept.tolerance)),
            precision: self.precision.clone().or(of_kept(kept.precision)),
            method,
            verify: kept.verify,
        }
    }
}

const SIZE: &str = "it must be WIDTHxHEIGHT with both between 1 and 1000000 pixels";

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.ok_or(SIZE.to_string())
}

/// How to integrate, as words: of the command line or of a scene's file.
struct Words {
    accuracy: Option<String>,
    method: Option<String>,
    step: Option<String>,
    tolerance: Option<String>,
    precision: Option<String>,
    verify: bool,
}

impl Words {
    /// What they ask for, and the run table that asks for the same.
    fn settle(self) -> Result<(Demand, RunTable), Exit> {
        let mut accuracy = Accuracy::default();
        set(&mut accuracy, "--accuracy", &self.accuracy, Accuracy::from_str)?;
        let verify = self.verify;
        let explicit = [&self.method, &self.step, &self.tolerance, &self.precision];
        if explicit.iter().all(|word| word.is_none()) {
            let accuracy = Some(accuracy.to_string());
            let run = RunTable { accuracy, verify, ..RunTable::default() };
            return Ok((Demand::Level(accuracy_of(&run)), run));
        }
        let recipe = self.recipe(accuracy)?;
        let step = match recipe.method {
            Method::Rk4 { .. } => Some(self.step.unwrap_or("1/120".to_string())),
            _ => None,
        };
        let run = RunTable {
            size: None,
            accuracy: None,
            method: Some(recipe.method.name().to_string()),
            step,
            tolerance: recipe.method.tolerance().map(|tolerance| format!("{tolerance:e}")),
            precision: Some(recipe.precision.to_string()),
            // The level stays in what it checks.
            verify: verify || accuracy.verifies(),
        };
        Ok((Demand::Recipe(recipe), run))
    }

    fn recipe(&self, accuracy: Accuracy) -> Result<Recipe, Exit> {
        let level = accuracy.recipes()[0];
        let mut precision = match (&self.method, &self.step) {
            (Some(method), _) => Method::home_precision(method),
            (None, Some(_)) => Precision::F32,
            (None, None) => level.precision,
        };
        set(&mut precision, "--precision", &self.precision, Precision::from_str)?;
        let name = match (&self.method, &self.step) {
            (Some(name), _) => name.as_str(),
            (None, Some(_)) => "rk4",
            // The lesson is its method; the other levels have one for each precision.
            (None, None) if precision == level.precision || accuracy == Accuracy::Lesson => {
                level.method.name()
            }
            (None, None) => Method::home_method(precision),
        };
        let Some(mut method) = Method::named(name, precision) else {
            let names = Method::NAMES.join(", ");
            return Err(Exit::Usage(format!("--method is '{name}'; the methods are {names}")));
        };
        let Some(least) = method.least_tolerance(precision) else {
            let fitting =
                Precision::ALL.iter().filter(|(_, p)| method.least_tolerance(*p).is_some());
            let fitting: Vec<&str> = fitting.map(|(word, _)| *word).collect();
            return Err(Exit::Usage(format!(
                "--precision is '{precision}'; --method {name} runs in {}",
                fitting.join(", ")
            )));
        };
        if let Some(step) = &self.step {
            method = with_step(method, step)?;
        }
        if let Some(tolerance) = &self.tolerance {
            method = with_tolerance(method, tolerance, precision, least)?;
        }
        Ok(Recipe { method, precision })
    }
}

fn accuracy_of(run: &RunTable) -> Accuracy {
    run.accuracy.as_deref().and_then(|word| word.parse().ok()).unwrap_or_default()
}

fn with_step(method: Method, step: &str) -> Result<Method, Exit> {
    let Method::Rk4 { .. } = method else {
        return Err(Exit::Usage(format!(
            "--step is for rk4; {} chooses its steps by --tolerance",
            method.name()
        )));
    };
    let step_secs = match step.split_once('/') {
        Some((above, below)) => {
            number(above).zip(number(below)).map(|(above, below)| above / below)
        }
        None => number(step),
    };
    match step_secs {
        Some(step_secs) if (1e-9..=1.0).contains(&step_secs) => Ok(Method::Rk4 { step_secs }),
        _ => Err(Exit::Usage(format!(
            "--step is '{step}'; it must be seconds between 1e-9 and 1, as a number or a fraction"
        ))),
    }
}

/// Steps are not judged more roughly than this.
const LARGEST_TOLERANCE: f64 = 1e-2;

fn with_tolerance(
    method: Method,
    text: &str,
    precision: Precision,
    least: f64,
) -> Result<Method, Exit> {
    let Some(tolerant) = number(text).and_then(|tolerance| method.with_tolerance(tolerance)) else {
        return Err(Exit::Usage(match method {
            Method::Rk4 { .. } => "--tolerance is for methods that choose their steps; rk4 takes \
                                   --step"
                .to_string(),
            _ => format!("--tolerance is '{text}'; it must be a number"),
        }));
    };
    let within = |tolerance: f64| (least..=LARGEST_TOLERANCE).contains(&tolerance);
    if tolerant.tolerance().is_some_and(within) {
        return Ok(tolerant);
    }
    Err(Exit::Usage(format!(
        "--tolerance is '{text}'; in {precision} it must lie between {least:e} and \
         {LARGEST_TOLERANCE:e}"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(words: &[(&str, &str)]) -> Result<Demand, String> {
        let word = |name: &str| words.iter().find(|(n, _)| *n == name).map(|(_, w)| w.to_string());
        let options = RunOptions {
            accuracy: word("accuracy"),
            method: word("method"),
            step: word("step"),
            tolerance: word("tolerance"),
            precision: word("precision"),
            ..RunOptions::default()
        };
        let plan = options.settle(&mut Document::default()).map_err(|error| error.to_string())?;
        Ok(plan.demand)
    }

    fn recipe(words: &[(&str, &str)]) -> Recipe {
        match said(words).unwrap() {
            Demand::Recipe(recipe) => recipe,
            level => panic!("{level:?}"),
        }
    }

    #[test]
    fn steps_are_numbers_or_fractions() {
        assert_eq!(recipe(&[("method", "rk4"), ("step", "1/120")]).method, Method::LESSON);
        assert_eq!(recipe(&[("step", "1e-3")]).method, Method::Rk4 { step_secs: 1e-3 });
        for bad in ["0", "-1/120", "nan", "inf", "1/0", "2", "x", "1/"] {
            let message = said(&[("step", bad)]).unwrap_err();
            assert!(message.contains("--step") && message.contains("between 1e-9 and 1"), "{bad}");
        }
    }

    #[test]
    fn what_is_not_said_follows_from_what_is() {
        assert_eq!(said(&[]).unwrap(), Demand::Level(Accuracy::Balanced));
        assert_eq!(said(&[("accuracy", "fast")]).unwrap(), Demand::Level(Accuracy::Fast));
        let of = |words: &[(&str, &str)]| {
            let Recipe { method, precision } = recipe(words);
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
            (&[("method", "dop853"), ("step", "0.01")][..], &["--step", "--tolerance"][..]),
            (&[("method", "rk4"), ("tolerance", "1e-9")], &["--tolerance", "--step"]),
            (&[("tolerance", "1e-17")], &["--tolerance", "f64", "1e-15", "1e-2"]),
            (&[("tolerance", "1e-9"), ("precision", "f32")], &["1e-8"]),
            (&[("tolerance", "one")], &["number"]),
            (&[("method", "taylor"), ("precision", "f32")], &["--precision", "f64, dd"]),
            (&[("method", "euler")], &["rk4, dopri5, dop853, taylor"]),
            (&[("accuracy", "perfect")], &["lesson, fast, balanced, exact"]),
        ] {
            let message = said(words).unwrap_err();
            assert!(parts.iter().all(|part| message.contains(part)), "{words:?}: {message}");
        }
    }

    #[test]
    fn a_picture_remembers_how_it_was_made() {
        let mut document = Document::default();
        let lesson = RunOptions { method: Some("rk4".to_string()), ..RunOptions::default() };
        let made = lesson.settle(&mut document).unwrap();
        assert_eq!(RunOptions::default().settle(&mut document).unwrap(), made);
        let other = RunOptions { method: Some("dop853".to_string()), ..RunOptions::default() };
        let Demand::Recipe(other) = other.settle(&mut document).unwrap().demand else { panic!() };
        assert_eq!((other.precision, other.method.tolerance()), (Precision::F64, Some(3e-13)));
        let level = RunOptions { accuracy: Some("exact".to_string()), ..RunOptions::default() };
        let plan = level.settle(&mut document).unwrap();
        assert!(plan.verify && plan.demand == Demand::Level(Accuracy::Exact));
        assert_eq!(RunOptions::default().settle(&mut document).unwrap(), plan);
    }
}
