//! `flipmap lab`: writes a figure of the lesson as a still or as data, or the lesson as a sheet to
//! print.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use flipmap_lab::home::home_map;
use flipmap_lab::set_up::PREFIX;
use flipmap_lab::sheet::sheet;
use flipmap_lab::still::{Still, StillPainter, still};
use flipmap_lab::take_away::{Extent, FPS, TakeAway, fps_range, write_still};
use flipmap_lab::{Figure, Lab, Theme, flips};
use flipmap_render::film::ffmpeg::Codec;
use flipmap_render::output::PICTURES;
use flipmap_scene::not_among;

use super::exit::Exit;
use super::film_options::number_or_ratio;
use super::options::number_of;
use super::same_file::{keep_apart, one_stream};
use super::size;
use super::suggested::Suggested;

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Name of the figure: single, ghost, double, machine, integrators, twenty or map; a figure's
    /// set-up, as in flipmap:lab=double;start=2.2,2.5; or sheet, the whole lesson to print
    #[arg(hide_possible_values = true, value_parser = Suggested(names()))]
    name: Option<String>,
    /// Picture of the figure to write, its motion as .gif, .mp4, .mkv or, with --fps, .webp through
    /// ffmpeg, or the sheet as .html (- for standard output)
    #[arg(short, long, value_name = "STILL.png")]
    output: Option<PathBuf>,
    /// Data of the figure to write (- for standard output)
    #[arg(long, value_name = "DATA.csv")]
    csv: Option<PathBuf>,
    /// Seconds after the figure's start at which to take the picture and end the film and the data, 0
    /// to 600 (default: 10)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    at: Option<String>,
    /// Frames per second of a film, 4 to 60, for .gif to 50, also as 30000/1001 (default: 25)
    #[arg(long, value_name = "R", allow_hyphen_values = true)]
    fps: Option<String>,
    /// Width and height of the picture in pixels, each 320 to 8192 (default: 1280x800)
    #[arg(long, value_name = "WxH")]
    size: Option<String>,
}

/// Maximum seconds for which a figure may be followed.
const MAX_SECS: f64 = 600.0;

/// Endings of films; a .webp is one if its frames per second are given.
const FILMS: &[&str] = &["gif", "mp4", "mkv"];

/// Name of the lesson's sheet.
const SHEET: &str = "sheet";

/// Returns everything that can be named.
fn names() -> Vec<&'static str> {
    [&Figure::names()[..], &[SHEET]].concat()
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let name = options.name.as_deref().unwrap_or_default();
    if name == SHEET {
        return print_sheet(options);
    }
    let mut lab = named(name)?;
    let at = options.at.as_deref().unwrap_or("10");
    let secs = number_of("--at", at, 0.0..=MAX_SECS, "s")?;
    let size = size(options.size.as_deref().unwrap_or("1280x800"))?;
    if options.output.is_none() && options.csv.is_none() {
        let message = "nothing to write: give -o STILL.png, --csv DATA.csv or both";
        return Err(Exit::Usage(message.to_string()).into());
    }
    let named = [("-o", options.output.as_deref()), ("--csv", options.csv.as_deref())];
    let outputs: Vec<_> =
        named.into_iter().filter_map(|(option, path)| Some((option, path?))).collect();
    let drawn = [PICTURES, FILMS].concat();
    for (option, path) in &outputs {
        super::check_name(path, option, if *option == "-o" { &drawn } else { &["csv"] })?;
    }
    keep_apart(&[], &outputs)?;
    one_stream(&outputs, false)?;
    for (option, path) in &outputs {
        super::check(path, option)?;
    }
    let film = film(options)?;
    if lab.figure == Figure::Map {
        if options.at.is_some() {
            return Err(Exit::Usage("--at: the map stands still; leave it out".to_string()).into());
        }
        if film.is_some() {
            let message = "-o: the map stands still: name a picture, or see flipmap video";
            return Err(Exit::Usage(message.to_string()).into());
        }
        return map(options, size);
    }
    if let (Some(path), Some(live)) = (&options.csv, lab.live()) {
        super::write_whole(path, "--csv", live.csv(secs).as_bytes())?;
    }
    let Some(path) = &options.output else { return Ok(()) };
    match film {
        Some((codec, fps)) => {
            Ok(TakeAway::Film(codec).write(&mut lab, path, Extent { size_px: size, secs, fps })?)
        }
        None => write(path, &still(&mut lab, size, secs)?),
    }
}

/// Returns the codec and the frames per second of the film to write, or `None` if that is a picture or
/// nothing.
fn film(options: &Options) -> Result<Option<(Codec, f64)>, Exit> {
    let codec = options.output.as_deref().and_then(Codec::of);
    let Some(text) = &options.fps else {
        return Ok(codec.filter(|codec| *codec != Codec::WebP).map(|codec| (codec, FPS)));
    };
    let needs = "--fps: only films have frames per second: give -o FILM.gif, .webp, .mp4 or .mkv";
    let codec = codec.ok_or_else(|| Exit::Usage(needs.to_string()))?;
    Ok(Some((codec, number_or_ratio("--fps", text, fps_range(codec))?)))
}

/// Computes a small map and writes it as the map figure, which in the window is the explorer.
fn map(options: &Options, size: [u32; 2]) -> anyhow::Result<()> {
    let map = home_map(MAP_SIDE)?;
    if let Some(path) = &options.csv {
        super::write_whole(path, "--csv", map.csv().as_bytes())?;
    }
    if let Some(path) = &options.output {
        let mut texture = None;
        let still = StillPainter::new(size, Theme::Dark)?.paint(|ui| {
            let texture = texture.get_or_insert_with(|| map.texture(ui.ctx()));
            flips::show(ui, texture, &map.document, &map.seen);
        })?;
        write(path, &still)?;
    }
    Ok(())
}

/// Returns the laboratory with the figure that was named, or set up by a line of text.
fn named(name: &str) -> Result<Lab, Exit> {
    if name.starts_with(PREFIX) {
        let mut lab = Lab::new(Figure::Single);
        lab.open_set_up(name).map_err(|error| Exit::Usage(error.to_string()))?;
        return Ok(lab);
    }
    Figure::named(name).map(Lab::new).ok_or_else(|| {
        let allowed = not_among("figures", &names(), name);
        Exit::Usage(match name {
            "" => format!("name a figure; {allowed}"),
            name => format!("there is no figure called '{name}'; {allowed}"),
        })
    })
}

/// Writes the lesson as a page to print.
fn print_sheet(options: &Options) -> anyhow::Result<()> {
    let others = [&options.at, &options.fps, &options.size];
    let has_others = options.csv.is_some() || others.into_iter().any(Option::is_some);
    let Some(path) = options.output.as_deref().filter(|_| !has_others) else {
        let message =
            "the sheet is a page: give -o SHEET.html, and no --csv, --at, --fps or --size";
        return Err(Exit::Usage(message.to_string()).into());
    };
    super::check_name(path, "-o", &["html"])?;
    super::check(path, "-o")?;
    let page = sheet(&home_map(MAP_SIDE)?)?;
    super::write_whole(path, "-o", page.as_bytes())
}

/// Number of pixels along each side of the small map.
const MAP_SIDE: u32 = 512;

fn size(text: &str) -> Result<[u32; 2], Exit> {
    let fits = |size: &[u32; 2]| size.iter().all(|side| (320..=8192).contains(side));
    size::parse(text).filter(fits).ok_or_else(|| {
        let ways = size::ways();
        Exit::Usage(format!("--size is '{text}'; it must be {ways}, each side 320 to 8192 pixels"))
    })
}

fn write(path: &Path, still: &Still) -> anyhow::Result<()> {
    write_still(still, path).with_context(|| format!("-o: cannot write {}", path.display()))
}
