//! `flipmap compare`: compares two results of the same size.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use flipmap_render::output::compare::{Comparison, Difference, ResultRows, Yardstick, compare};
use flipmap_render::output::{PICTURES, PictureFile, SafeFile, read_document};
use flipmap_scene::QuestionSettings;
use flipmap_scene::question::QuestionName;

use super::exit::Exit;
use super::options::{number_of, set};
use super::same_file::keep_apart;
use super::suggested::Suggested;

#[derive(Args, Debug)]
pub(super) struct Options {
    /// First result: a .npy or .npz written by render --raw, or a PNG
    a: PathBuf,
    /// Second result, of the same kind and size
    b: PathBuf,
    /// Question that both arrays answer: sets the unit, and compares angles on the circle (default:
    /// plain differences)
    #[arg(long, value_name = "NAME", hide_possible_values = true,
          value_parser = Suggested(QuestionName::names()))]
    ask: Option<String>,
    /// Largest difference to ignore. Arrays: in the unit of the channel (default: with --ask the
    /// largest error that counts as right, else 0.001); with --ask and several channels, in
    /// multiples of that error (default: 1). Pictures: in levels of 255 (default: 0)
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    tolerance: Option<String>,
    /// Share of pixels that may differ by more than the tolerance, 0 to 1
    #[arg(long, value_name = "SHARE", default_value = "0", allow_hyphen_values = true)]
    share: String,
    /// Picture of the differences to write: brighter for larger ones, red where the class changed
    #[arg(short, long, value_name = "DIFFERENCE.png")]
    output: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let results = [("the first result", options.a.as_path()), ("the second", &options.b)];
    let picture = options.output.as_deref().map(|path| ("-o", path));
    keep_apart(&results, picture.as_slice())?;
    if let Some(path) = &options.output {
        super::check_name(path, "-o", PICTURES)?;
    }
    let tolerance = options.tolerance.as_deref();
    let tolerance =
        tolerance.map(|text| number_of("--tolerance", text, 0.0..=1e6, "")).transpose()?;
    let allowed = number_of("--share", &options.share, 0.0..=1.0, "")?;
    let ask = asked(options)?;
    one_question(&options.a, &options.b)?;
    let (a, b) = (ResultRows::open(&options.a)?, ResultRows::open(&options.b)?);
    let yardstick = yardstick(ask, &a, &b)?;
    let unit = if a.has_times() { yardstick.unit() } else { "levels" };
    let usual = if a.has_times() { yardstick.tolerance() } else { 0.0 };
    let tolerance = tolerance.unwrap_or(usual);
    let comparison = match &options.output {
        Some(path) => pictured(a, b, (&yardstick, tolerance), path)?,
        None => compare(a, b, (&yardstick, tolerance), &mut |_| Ok(()))?,
    };
    tell(options, &comparison, unit)?;
    if comparison.share() > allowed {
        let why = format!(
            "{} of {} pixels differ by more than {}; the allowed share is {allowed}",
            comparison.differing,
            comparison.pixels,
            in_words(&tolerance.to_string(), unit)
        );
        return Err(Exit::Differs(why).into());
    }
    Ok(())
}

/// Returns the question of `--ask`.
fn asked(options: &Options) -> Result<Option<QuestionName>, Exit> {
    let mut ask = None;
    set(&mut ask, "--ask", &options.ask, |name| name.parse().map(Some))?;
    Ok(ask)
}

/// Returns how to compare answers to a question; plain differences without one.
fn yardstick(
    ask: Option<QuestionName>,
    a: &ResultRows,
    b: &ResultRows,
) -> anyhow::Result<Yardstick> {
    let Some(ask) = ask else {
        return Ok(Yardstick::Plain);
    };
    a.require(ask)?;
    b.require(ask)?;
    Ok(Yardstick::of(ask))
}

/// Refuses two pictures by flipmap that differ in question, count or plane. Other files do not
/// record these.
fn one_question(a: &Path, b: &Path) -> Result<(), Exit> {
    let asked = |path: &Path| {
        let is_file =
            path.is_file() && path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let document = is_file.then(|| read_document(path).ok()).flatten()?;
        let QuestionSettings { ask, count, .. } = document.question;
        let which = if count > 1 { format!(" --count {count}") } else { String::new() };
        Some(format!("{ask}{which} on the plane {}", document.plane.kind))
    };
    match (asked(a), asked(b)) {
        (Some(first), Some(second)) if first != second => Err(Exit::Usage(format!(
            "{} answers the question {first} and {} {second}: only answers to one question can be \
             compared",
            a.display(),
            b.display()
        ))),
        _ => Ok(()),
    }
}

/// Compares two results and draws their differences row by row.
fn pictured(
    a: ResultRows,
    b: ResultRows,
    (yardstick, tolerance): (&Yardstick, f64),
    to: &Path,
) -> anyhow::Result<Comparison> {
    let cannot = || format!("-o: cannot write {}", to.display());
    let mut picture = PictureFile::create(to, a.size(), None).with_context(cannot)?;
    let comparison = compare(a, b, (yardstick, tolerance), &mut |row| {
        let bytes: Vec<u8> = row.iter().flat_map(|by| colour(*by, tolerance)).collect();
        picture.write(&bytes)
    })?;
    picture.complete().and_then(SafeFile::finish).with_context(cannot)?;
    Ok(comparison)
}

/// Colour of a difference: dark up to the tolerance, then brighter with every decade.
fn colour(difference: Difference, tolerance: f64) -> [u8; 3] {
    const ALIKE: [u8; 3] = [24; 3];
    match difference {
        Difference::Class => [0xd5, 0x30, 0x30],
        Difference::By(by) if by <= tolerance => ALIKE,
        Difference::By(by) => {
            let decades = (by / tolerance.max(1e-12)).log10().clamp(0.0, 3.0);
            let level = (90.0 + 55.0 * decades) as u8;
            [level, level, (f64::from(level) * 0.6) as u8]
        }
    }
}

fn tell(options: &Options, comparison: &Comparison, unit: &str) -> anyhow::Result<()> {
    let Comparison { pixels, differing, classes, largest, .. } = *comparison;
    let quantiles = [0.5, 0.9, 0.99].map(|share| comparison.quantile(share));
    if options.json {
        let object = serde_json::json!({
            "pixels": pixels,
            "differing": differing,
            "share": comparison.share(),
            "classes": classes,
            "unit": unit,
            "median": quantiles[0],
            "p90": quantiles[1],
            "p99": quantiles[2],
            "max": largest,
        });
        return super::say_if_heard(&serde_json::to_string_pretty(&object)?);
    }
    super::say_if_heard(&format!(
        "{differing} of {pixels} pixels differ ({:.4} %), {classes} of them in class; median \
         {:.1e}, p90 {:.1e}, p99 {:.1e}, largest {}",
        100.0 * comparison.share(),
        quantiles[0],
        quantiles[1],
        quantiles[2],
        in_words(&format!("{largest:.1e}"), unit)
    ))
}

/// Formats a difference with its unit. An empty unit is that of an array, which does not record it.
fn in_words(difference: &str, unit: &str) -> String {
    let unit = if unit.is_empty() { "in the unit of the channel" } else { unit };
    format!("{difference} {unit}")
}
