//! The options that say how samples are painted.

use std::str::FromStr;

use clap::Args;
use flipmap::scene::{Document, PictureTable, Scale};

use super::exit::Exit;
use super::options::{number, set};

/// How to paint it.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Picture")]
pub struct PictureOptions {
    /// Colour table: batlow, viridis, magma, cividis or romao (cyclic)
    #[arg(long, value_name = "NAME")]
    palette: Option<String>,
    /// N × N samples a pixel, whose colours are averaged
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    pub samples: Option<u32>,
    /// Give early flips the palette's last colour and late ones its first
    #[arg(long)]
    reverse: bool,
    /// Run through the palette so often, 1 to 100 times
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    cycles: Option<String>,
    /// log: equal ratios of times are equal steps of colour; linear: equal differences are
    #[arg(long, value_name = "log|linear")]
    scale: Option<String>,
    /// Seconds at which equal steps of the palette lie: a first and a last one, or more; view:
    /// those of the view itself, as for views narrower than 1e-6 rad; budget: the whole budget
    #[arg(long, value_name = "t1,t2,...|view|budget", allow_hyphen_values = true)]
    times: Option<String>,
    /// Leave out the energy curve
    #[arg(long)]
    no_curve: bool,
}

/// Words for `--times`.
const OF_VIEW: &str = "view";
const OF_BUDGET: &str = "budget";

impl PictureOptions {
    /// Whether it was said how often the palette is run through.
    pub fn says_cycles(&self) -> bool {
        self.cycles.is_some()
    }

    /// Whether no palette was said.
    pub fn says_no_palette(&self) -> bool {
        self.palette.is_none()
    }

    /// Whether the colours are to follow the view's own times.
    pub fn spreads(&self, document: &Document) -> bool {
        let deep = document.scene().view.width_rad().hi < PictureTable::SPREAD_BELOW_RAD;
        match self.times.as_deref() {
            Some(OF_VIEW) => true,
            Some(_) => false,
            None => deep && document.picture.times.is_empty(),
        }
    }

    /// Likewise the film's own, which zooms through so many decades, down to so small a width.
    pub fn spreads_film(&self, document: &Document, decades: f64, width_rad: f64) -> bool {
        let far = decades > PictureTable::SPREAD_FILM_DECADES
            || width_rad < PictureTable::SPREAD_BELOW_RAD;
        match self.times.as_deref() {
            Some(said) => said == OF_VIEW,
            None => far && document.picture.times.is_empty(),
        }
    }

    /// Whether the colours are said to follow the view's own times.
    pub fn says_of_view(&self) -> bool {
        self.times.as_deref() == Some(OF_VIEW)
    }

    /// Puts what was said in a document.
    pub fn apply(&self, document: &mut Document) -> Result<(), Exit> {
        let picture = &mut document.picture;
        if let Some(palette) = &self.palette {
            picture.palette.clone_from(palette);
        }
        picture.samples = self.samples.unwrap_or(picture.samples);
        picture.curve &= !self.no_curve;
        picture.reverse |= self.reverse;
        set(&mut picture.scale, "--scale", &self.scale, Scale::from_str)?;
        set(&mut picture.cycles, "--cycles", &self.cycles, |text| {
            number(text).ok_or("it must be a number between 1 and 100")
        })?;
        set(&mut picture.times, "--times", &self.times, |text| {
            if [OF_VIEW, OF_BUDGET].contains(&text) {
                return Ok(Vec::new());
            }
            let times: Option<Vec<f64>> = text.split(',').map(number).collect();
            times.ok_or("it must be numbers of seconds with commas between them, view or budget")
        })
    }
}
