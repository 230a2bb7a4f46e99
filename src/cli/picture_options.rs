//! The options that control how samples are painted.

use std::ops::RangeInclusive;
use std::path::Path;
use std::str::FromStr;

use clap::Args;
use flipmap_render::farm::is_deep;
use flipmap_render::output::read_gradient;
use flipmap_scene::film::Film;
use flipmap_scene::palette::gradient_file::ENDINGS;
use flipmap_scene::palette::{Palette, ViewTimes, budget_range_secs};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{
    Document, PictureTable, Sampling, Scale, did_you_mean, in_a_row, named, number, number_within,
};

use super::exit::Exit;
use super::options::set;
use super::same_file::Named;
use super::suggested::Suggested;

/// Options that control how samples are painted.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Picture")]
pub(super) struct PictureOptions {
    #[arg(long, value_name = "NAME", help = palette_help())]
    palette: Option<String>,
    /// Average the colours of N × N samples per pixel, N from 1 to 8; corners (the default): one in
    /// the middle and, where colours change, one in each corner, shared by four pixels; auto: 3 × 3
    /// where colours change, one elsewhere
    #[arg(long, value_name = "N|corners|auto", hide_possible_values = true,
          value_parser = Suggested(vec![Sampling::CORNERS, ADAPTIVE]))]
    pub samples: Option<String>,
    /// Reverse the palette: early flips get its last colour and late ones its first
    #[arg(hide_short_help = true, long)]
    reverse: bool,
    /// Number of times to run through the palette, 1 to 100
    #[arg(hide_short_help = true, long, value_name = "N", allow_hyphen_values = true)]
    cycles: Option<String>,
    /// Colours after the end of the palette: its beginning (plain), or the palette backwards
    /// (mirrored), which shows no seam. With --cycles, mirrored unless the palette is cyclic
    #[arg(hide_short_help = true, long, value_name = "mirrored|plain",
          hide_possible_values = true, value_parser = Suggested::of(&REPEATS))]
    repeat: Option<String>,
    /// Part of the palette to skip before the first time, 0 to 1; 1 is once around
    #[arg(hide_short_help = true, long, value_name = "N", allow_hyphen_values = true)]
    offset: Option<String>,
    /// Colour scale: equal steps of colour for equal ratios (log) or differences (linear) of time, or
    /// one colour between each two of --times (steps)
    #[arg(hide_short_help = true, long, value_name = "log|linear|steps",
          hide_possible_values = true, value_parser = Suggested::of(&Scale::ALL))]
    scale: Option<String>,
    /// Two or more times in seconds that divide the palette into equal steps; view: times of the
    /// view itself (the default for views narrower than the home map); budget: the whole budget
    #[arg(
        hide_short_help = true,
        long,
        value_name = "t1,t2,...|view|budget",
        allow_hyphen_values = true
    )]
    times: Option<String>,
    /// Channel of the question to paint, and to write to --raw and --exr (default: all of them). With
    /// --ask state also energy, which can only be painted: --raw and --exr then get all channels
    #[arg(hide_short_help = true, long, value_name = "NAME", hide_possible_values = true,
          value_parser = Suggested(QuestionName::channel_names()))]
    channel: Option<String>,
    /// Strength of light from the side, 0 to 1; heights are times
    #[arg(long, value_name = "STRENGTH", allow_hyphen_values = true)]
    relief: Option<String>,
    /// Direction to the light of --relief, anticlockwise from the right (default: 135, upper left)
    #[arg(hide_short_help = true, long, value_name = "DEGREES", allow_hyphen_values = true)]
    light: Option<String>,
    /// Bits of each channel of the picture: 8, or 16 in .png and .tiff
    #[arg(hide_short_help = true, long, value_name = "8|16", allow_hyphen_values = true)]
    bits: Option<String>,
    /// Draw a legend in the lower left corner: the values of the colours, with units
    #[arg(long)]
    legend: bool,
    /// Draw in the lower right corner how long a bar is, and the time that a state or a film with a
    /// clock shows
    #[arg(long)]
    caption: bool,
    /// Colours of starts without an answer, of the forbidden region and of the energy curve, as in
    /// unflipped=#101018,forbidden=#303038,curve=#ffffff (default: what suits the palette)
    #[arg(hide_short_help = true, long, value_name = "NAME=#rrggbb,...")]
    colours: Option<String>,
    /// Keep the grain of unresolved chaos (default: it is smoothed along its bands; arrays and counts
    /// are the same)
    #[arg(hide_short_help = true, long)]
    no_denoise: bool,
    /// Leave out the energy curve
    #[arg(hide_short_help = true, long)]
    no_curve: bool,
}

/// Values of `--repeat`: true if every second run through the palette goes backwards.
const REPEATS: [(&str, bool); 2] = [("mirrored", true), ("plain", false)];
/// Keywords of `--times`.
const OF_VIEW: &str = "view";
const OF_BUDGET: &str = "budget";

impl PictureOptions {
    /// Returns true if `--cycles` was given.
    pub(super) fn says_cycles(&self) -> bool {
        self.cycles.is_some()
    }

    /// Returns true if `--repeat` was given.
    pub(super) fn says_repeat(&self) -> bool {
        self.repeat.is_some()
    }

    /// Returns true if `--palette` was not given.
    pub(super) fn says_no_palette(&self) -> bool {
        self.palette.is_none()
    }

    /// Returns true if `--samples` was given.
    pub(super) fn says_samples(&self) -> bool {
        self.samples.is_some()
    }

    /// Returns the file that `--palette` names, if it exists.
    pub(super) fn palette_file(&self) -> Option<Named<'_>> {
        let path = Path::new(self.palette.as_deref()?);
        path.exists().then_some(("--palette", path))
    }

    /// Returns the weight of the view's own times in the colours; `None` if they have none.
    pub(super) fn weight_of_view(&self, document: &Document) -> Option<f64> {
        let weight = ViewTimes::weight(document.scene().view.width_rad().hi);
        let picture = &document.picture;
        let open = picture.times.is_empty() && picture.paints_times(document.question.ask);
        match self.times.as_deref() {
            Some(OF_VIEW) => Some(1.0),
            Some(_) => None,
            None => Some(weight).filter(|weight| open && *weight > 0.0),
        }
    }

    /// Returns true if the colours follow the film's own times.
    pub(super) fn spreads_film(&self, document: &Document, film: &Film) -> bool {
        match self.times.as_deref() {
            Some(said) => said == OF_VIEW,
            None => is_deep(film) && document.picture.times.is_empty(),
        }
    }

    /// Returns true if `--times view` was given.
    pub(super) fn says_of_view(&self) -> bool {
        self.times.as_deref() == Some(OF_VIEW)
    }

    /// Rejects `--samples auto`; the error gives the reason `why`.
    pub(super) fn check_even(&self, why: &str) -> Result<(), Exit> {
        self.refuse_samples(ADAPTIVE, "render", why)
    }

    /// Rejects `--samples` with this word; the error gives the reason `why`.
    fn refuse_samples(&self, word: &str, whose: &str, why: &str) -> Result<(), Exit> {
        if self.samples.as_deref() == Some(word) {
            return Err(Exit::Usage(format!("--samples {word} is for {whose}: {why}")));
        }
        Ok(())
    }

    /// Rejects picture options that films do not have.
    pub(super) fn check_film(&self) -> Result<(), Exit> {
        let why = "every place of a film is sampled once, as finely as its closest frame needs";
        self.check_even(why)?;
        self.refuse_samples(Sampling::CORNERS, "stills", why)?;
        if self.bits.is_some() {
            let why = "--bits is for stills: films have 8 bits a channel";
            return Err(Exit::Usage(why.to_string()));
        }
        Ok(())
    }

    /// Applies `--repeat`, or its default if `--cycles` is given.
    fn repeat(&self, picture: &mut PictureTable) -> Result<(), Exit> {
        if self.cycles.is_some() && picture.cycles > 1.0 {
            picture.mirror = !Palette::is_cyclic(&picture.palette);
        }
        let mirror = |text: &str| named("repeats", &REPEATS, text);
        set(&mut picture.mirror, "--repeat", &self.repeat, mirror)
    }

    /// Applies the options to a document.
    pub(super) fn apply(&self, document: &mut Document) -> Result<(), Exit> {
        let picture = &mut document.picture;
        if let Some(palette) = &self.palette {
            picture.palette = palette_of(palette)?;
        }
        if self.channel.is_some() {
            picture.channel.clone_from(&self.channel);
        }
        let mut samples = (picture.samples, picture.adaptive);
        set(&mut samples, "--samples", &self.samples, samples_of)?;
        (picture.samples, picture.adaptive) = samples;
        picture.curve &= !self.no_curve;
        picture.denoise &= !self.no_denoise;
        picture.legend |= self.legend;
        picture.caption |= self.caption;
        picture.reverse |= self.reverse;
        if let Some(text) = &self.colours {
            let refuse = |why| Exit::Usage(format!("--colours is '{text}'; {why}"));
            picture.colours.set(text).map_err(refuse)?;
        }
        set(&mut picture.scale, "--scale", &self.scale, Scale::from_str)?;
        let within =
            |range: RangeInclusive<f64>| move |text: &str| number_within(text, range.clone(), "");
        set(&mut picture.cycles, "--cycles", &self.cycles, within(PictureTable::CYCLES))?;
        self.repeat(picture)?;
        set(&mut picture.offset, "--offset", &self.offset, within(PictureTable::OFFSETS))?;
        set(&mut picture.relief, "--relief", &self.relief, within(PictureTable::RELIEFS))?;
        set(&mut picture.light, "--light", &self.light, |text| {
            within(PictureTable::LIGHTS_DEG)(text.trim_end_matches(['°', ' ']))
        })?;
        set(&mut picture.bits, "--bits", &self.bits, |text| {
            text.parse().map_err(|_| "it must be 8 or 16")
        })?;
        set(&mut picture.times, "--times", &self.times, |text| {
            if [OF_VIEW, OF_BUDGET].contains(&text) {
                return Ok(Vec::new());
            }
            let times: Option<Vec<f64>> = text.split(',').map(number).collect();
            times.ok_or("it must be times in seconds separated by commas, view or budget")
        })?;
        picture.of_view &= self.times.is_none();
        if self.times.as_deref() == Some(OF_BUDGET) {
            let unit_secs = document.pendulum.unit_secs();
            picture.times = budget_range_secs(unit_secs, document.question.budget.secs).to_vec();
        }
        self.check_times(document)
    }

    /// Rejects options for colours of times if the picture shows something else.
    fn check_times(&self, document: &Document) -> Result<(), Exit> {
        let (picture, ask) = (&document.picture, document.question.ask);
        if picture.paints_times(ask) || picture.shown(ask).is_err() {
            return Ok(());
        }
        let said = [
            ("--reverse", self.reverse),
            ("--cycles", self.cycles.is_some()),
            ("--repeat", self.repeat.is_some()),
            ("--offset", self.offset.is_some()),
            ("--scale", self.scale.is_some()),
            ("--times", self.times.is_some()),
            ("--relief", self.relief.is_some()),
            ("--light", self.light.is_some()),
        ];
        match said.into_iter().find(|(_, said)| *said) {
            Some((option, _)) => Err(Exit::Usage(format!(
                "{option} is for colours of times: those of --ask flip, and of the channel time of \
                 first and return"
            ))),
            None => Ok(()),
        }
    }
}

fn palette_help() -> String {
    let names: Vec<_> = Palette::names()
        .map(|name| if Palette::is_cyclic(name) { format!("{name} (cyclic)") } else { name.into() })
        .collect();
    format!(
        "Colour palette: {}; random-7, or any other number; colours from early to late (#000000,#ff8000,#ffffff); or a gradient \
         file (.{}), with :NAME for one of several in it",
        in_a_row(&names, "or"),
        ENDINGS.join(", .")
    )
}

/// Value of `--samples` that takes several samples only where colours change.
const ADAPTIVE: &str = "auto";

/// Parses `--samples`; the flag is true if only pixels where colours change get several.
fn samples_of(text: &str) -> Result<(Sampling, bool), String> {
    match text {
        ADAPTIVE => return Ok((Sampling::Square(PictureTable::ADAPTIVE), true)),
        Sampling::CORNERS => return Ok((Sampling::Corners, false)),
        _ => {}
    }
    let along = text.parse().ok().filter(|along| PictureTable::SAMPLES.contains(along));
    let square = along.map(|along| (Sampling::Square(along), false));
    square.ok_or_else(|| {
        let (least, most) = PictureTable::SAMPLES.into_inner();
        let meant = did_you_mean(&[Sampling::CORNERS, ADAPTIVE], text);
        format!("it must be corners or auto, or a whole number between {least} and {most}{meant}")
    })
}

/// Returns the palette as a scene stores it: a gradient file becomes its colours.
fn palette_of(text: &str) -> Result<String, Exit> {
    match read_gradient(Path::new(text)) {
        Some(colours) => colours.map_err(|why| Exit::Usage(format!("--palette: {why}"))),
        None => Ok(text.to_string()),
    }
}
