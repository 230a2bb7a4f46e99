//! The colours of a film: converts the samples of a patch to linear light.

use super::WAITING;
use super::mip::{LOOKS, Light, Looks};
use crate::output::{Inset, caption, legend};
use crate::tiles::Samples;
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::film::{Film, Shot};
use flipmap_scene::palette::{AnswerColours, Rgb, Tones, light_table};
use flipmap_scene::{PictureTable, SceneError};

/// Number of steps between the lowest and the highest height.
pub(super) const HIGHEST: f64 = 65534.0;

/// The flips that a frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FlipWindow {
    secs: f64,
    /// True if starts without a shown flip are painted as waiting.
    waits: bool,
}

impl FlipWindow {
    /// Returns the flips that a shot shows: those up to its clock or, without a clock, all up to
    /// [`Film::shown_secs`].
    pub(crate) fn of(film: &Film, shot: &Shot) -> Self {
        match shot.clock_secs {
            Some(secs) => FlipWindow { secs, waits: true },
            None => FlipWindow { secs: film.shown_secs(shot), waits: false },
        }
    }

    /// Returns true for a flip that is shown.
    fn shows(&self, outcome: &Outcome) -> bool {
        outcome.status == Status::Answered && outcome.time <= self.secs
    }

    /// Limits the flips to those within a budget in s.
    pub(super) fn within(self, secs: f64) -> Self {
        FlipWindow { secs: self.secs.min(secs), ..self }
    }
}

/// The colours of a whole film, and the heights if it is lit from the side: a time has the same
/// colour and height in every frame.
pub struct Colours {
    tones: Tones,
    light: [u16; 256],
    is_lit: bool,
}

impl Colours {
    /// Creates the colours of a film from its tones, with heights if it is lit from the side.
    pub(crate) fn new(tones: Tones, is_lit: bool) -> Self {
        Colours { tones, light: light_table(), is_lit }
    }

    /// Returns true if the film is lit from the side.
    pub(crate) fn is_lit(&self) -> bool {
        self.is_lit
    }

    /// Returns the looks of a patch, given its samples and the flips that each look shows.
    pub(crate) fn looks(&self, samples: &Samples, shown: &[FlipWindow; LOOKS]) -> Looks {
        let mut looks: Vec<Light> = Vec::with_capacity(LOOKS);
        for (k, window) in shown.iter().enumerate() {
            let changes = |outcome: Outcome| window.shows(&outcome) != shown[k - 1].shows(&outcome);
            let light = match looks.last() {
                Some(before) if *window == shown[k - 1] || !samples.iter().any(changes) => {
                    before.clone()
                }
                _ => self.light(samples, window),
            };
            looks.push(light);
        }
        looks.try_into().expect("as many looks")
    }

    /// Returns the light of a patch's samples, given the flips that are shown.
    fn light(&self, samples: &Samples, shown: &FlipWindow) -> Light {
        let of = |outcome: Outcome| {
            let rgb = self.colour(&outcome, shown);
            let [red, green, blue] = rgb.map(|channel| self.light[usize::from(channel)]);
            [red, green, blue, if self.is_lit { self.height(&outcome, shown) } else { 0 }]
        };
        samples.iter().map(of).collect()
    }

    /// Returns the height of a flip that is shown, 1 to 65535; 0 without one.
    fn height(&self, outcome: &Outcome, shown: &FlipWindow) -> u16 {
        if !shown.shows(outcome) {
            return 0;
        }
        1 + (self.tones.scale().height(outcome.time) * HIGHEST).round() as u16
    }

    fn colour(&self, outcome: &Outcome, shown: &FlipWindow) -> Rgb {
        let others = if shown.waits { WAITING } else { self.tones.ground().unflipped };
        match outcome.status {
            Status::Answered if !shown.shows(outcome) => others,
            Status::Unflipped => others,
            _ => self.tones.colour(outcome),
        }
    }
}

/// Settles the single colour scale of a film of flips, which each frame records; refuses invalid
/// colours.
pub fn settle_colours(film: &Film, picture: &mut PictureTable) -> Result<(), SceneError> {
    picture.check()?;
    if picture.times.is_empty() {
        picture.times = tones(film, picture)?.range_secs().to_vec();
    }
    Ok(())
}

/// Returns the single colour scale of a film of flips.
pub(crate) fn tones(film: &Film, picture: &PictureTable) -> Result<Tones, SceneError> {
    Tones::new(picture, film.keys[0].scene.pendulum.unit_secs(), film.budget_secs())
}

/// Refuses a film whose frames have too little room for what is to be drawn over them.
pub fn check_insets(film: &Film, picture: &PictureTable) -> Result<(), SceneError> {
    let legend = film_legend(film, picture)?;
    film_caption(film, picture, &film.shot(0), legend.as_ref())?;
    Ok(())
}

/// Returns the caption of a frame that shows a shot, clear of the legend, if the film's picture has one.
pub(crate) fn film_caption(
    film: &Film,
    picture: &PictureTable,
    shot: &Shot,
    legend: Option<&Inset>,
) -> Result<Option<Inset>, SceneError> {
    let caption = picture.caption.then(|| caption(&shot.scene, shot.clock_secs, film.size));
    Ok(caption.transpose()?.map(|caption| caption.clear_of(legend)))
}

/// Returns the legend of a film, if its picture has one.
pub(crate) fn film_legend(
    film: &Film,
    picture: &PictureTable,
) -> Result<Option<Inset>, SceneError> {
    if !picture.legend {
        return Ok(None);
    }
    let mut scene = film.keys[0].scene.scene();
    scene.question.budget.secs = film.budget_secs();
    let colours = AnswerColours::new(&scene, picture)?;
    legend(&colours, scene.question.ask, film.size).map(Some)
}
