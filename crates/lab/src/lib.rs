//! The laboratory: live versions of the seven figures in the lesson that this program grew from.
//!
//! Each figure is a [`LiveFigure`]: a state that advances in fixed steps at any frame rate, a
//! drawing, controls, and data as CSV. A window shows one figure at a time; [`still`] draws one
//! without a window. All equations of motion come from `flipmap_pendulum`. The seventh figure is
//! the map itself, which [`flips`] explains.
//!
//! ```
//! use flipmap_lab::{Figure, Lab};
//!
//! let mut lab = Lab::new(Figure::named("double").unwrap());
//! let data = lab.live().unwrap().csv(2.0);
//! assert!(data.lines().count() > 10, "a header and two seconds of motion");
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod chart;
mod clock;
mod colour_words;
mod controls;
mod double;
mod double_simulation;
pub mod drawing;
mod equation;
mod figures;
pub mod flips;
mod ghost;
pub mod home;
mod integrators;
mod labels;
mod machine;
pub mod number_text;
mod playing;
mod sheet;
mod single;
mod single_simulation;
pub mod still;
pub mod story;
mod twenty;
pub mod typeface;

use egui::{Key, ScrollArea, Ui, vec2};
use figures::{ENTRIES, Entry};
use playing::Playing;

use flipmap_pendulum::State;

/// A figure of the lesson.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// The single pendulum.
    Single,
    /// A real pendulum against its small-angle ghost.
    Ghost,
    /// The double pendulum.
    Double,
    /// The double pendulum as a machine, with its matrix equation.
    Machine,
    /// Three integrators.
    Integrators,
    /// Twenty pendulums.
    Twenty,
    /// The flip-time map.
    Map,
}

impl Figure {
    /// All figures, in the lesson's order.
    pub fn all() -> impl Iterator<Item = Figure> {
        ENTRIES.iter().map(|entry| entry.figure)
    }

    /// Returns the figure with this name.
    pub fn named(name: &str) -> Option<Self> {
        Figure::all().find(|figure| figure.name() == name)
    }

    /// Returns all names, separated by commas.
    pub fn names() -> String {
        ENTRIES.each_ref().map(|entry| entry.name).join(", ")
    }

    fn entry(self) -> &'static Entry {
        &ENTRIES[self as usize]
    }

    /// Returns the figure's name on the command line.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Returns the figure's title.
    pub fn title(self) -> &'static str {
        self.entry().title
    }

    /// Returns a sentence on what the figure shows and what to try.
    pub fn sentence(self) -> &'static str {
        self.entry().sentence
    }

    /// Returns the figure `by` places further on in the lesson, if there is one.
    pub fn beside(self, by: isize) -> Option<Self> {
        Figure::all().nth((self as usize).checked_add_signed(by)?)
    }

    /// Returns the key that shows the figure.
    pub fn key(self) -> Key {
        self.entry().key
    }
}

/// A request from a figure to the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FigureRequest {
    /// Shows this start on the map.
    ToMap(State<f64>),
    /// Shows another figure.
    Show(Figure),
    /// Ends the story.
    EndStory,
}

/// A figure that runs live and responds to the user.
pub trait LiveFigure {
    /// Begins again from a start found elsewhere; a single pendulum takes only θ1 and is released
    /// at rest.
    fn open(&mut self, start: State<f64>);
    /// Begins again from the same start.
    fn restart(&mut self);
    /// Seconds since the start.
    fn secs(&self) -> f64;
    /// Advances the figure by `elapsed_secs`.
    fn advance(&mut self, elapsed_secs: f64);
    /// Describes the current moment for a screen reader.
    fn told(&self) -> String;
    /// Draws the figure in an area of `size` points.
    fn draw(&mut self, ui: &mut Ui, size: egui::Vec2);
    /// Shows the figure's sliders and numbers, and returns a request to the window if the user
    /// makes one.
    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest>;
    /// Returns the values set by the user, beginning with the start's angles in rad.
    fn set(&self) -> Vec<f64>;
    /// Returns the data as CSV with a header; series over time cover `secs` from the start.
    fn csv(&self, secs: f64) -> String;
}

/// The laboratory: all figures, and the one that is shown.
pub struct Lab {
    /// The figure that is shown.
    pub figure: Figure,
    /// The figures in the order of [`ENTRIES`], with `None` for the map.
    live: [Option<Box<dyn LiveFigure>>; ENTRIES.len()],
    /// Pause, speed and scrubbing of the figure that is shown.
    pub playing: Playing,
    /// True if the lab is laid out for an audience: large, with few controls.
    pub projector: bool,
    /// True if the story is shown beside the figures.
    pub story: bool,
}

/// Range of the width of the controls in points.
const CONTROLS_WIDTH: std::ops::RangeInclusive<f32> = 290.0..=410.0;
/// Width in points that a row needs beside its slider, for the name and the number.
const BESIDE_SLIDER: f32 = 176.0;
/// Height of the playback controls in points.
const BAR_HEIGHT: f32 = 30.0;

impl Lab {
    /// Creates every figure in its initial state, and shows one.
    pub fn new(figure: Figure) -> Self {
        let live = ENTRIES.each_ref().map(|entry| (entry.begin)());
        Lab { figure, live, playing: Playing::default(), projector: false, story: false }
    }

    /// Returns the figure that is shown, or `None` if that is the map.
    pub fn live(&mut self) -> Option<&mut (dyn LiveFigure + 'static)> {
        self.live[self.figure as usize].as_deref_mut()
    }

    /// Returns the values that the user has set in the figure that is shown.
    pub fn set(&self) -> Vec<f64> {
        self.live[self.figure as usize].as_ref().map_or(Vec::new(), |live| live.set())
    }

    /// Advances the figure that is shown by a frame of `elapsed_secs`.
    pub fn advance(&mut self, elapsed_secs: f64) {
        if let Some(live) = self.live[self.figure as usize].as_deref_mut() {
            self.playing.advance(live, elapsed_secs);
        }
    }

    /// Shows a figure and opens it at a start.
    pub fn open(&mut self, figure: Figure, start: State<f64>) {
        self.show_figure(figure);
        if let Some(live) = self.live() {
            live.open(start);
        }
    }

    /// Shows a figure at the moment at which the user left it.
    pub fn show_figure(&mut self, figure: Figure) {
        if figure != self.figure {
            self.playing = Playing::at_speed(self.playing.speed);
        }
        self.figure = figure;
    }

    /// Shows the figure with its sentence above, its controls beside it and the playback controls
    /// below.
    pub fn show(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        ui.heading(self.figure.title());
        if !self.projector {
            ui.label(self.figure.sentence());
        }
        self.live()?;
        let size = ui.available_size();
        let has_side = self.story || !self.projector;
        let beside = (0.32 * size.x).clamp(*CONTROLS_WIDTH.start(), *CONTROLS_WIDTH.end());
        let beside = if has_side { beside + 16.0 } else { 0.0 };
        let stage = vec2((size.x - beside).max(200.0), (size.y - BAR_HEIGHT - 8.0).max(160.0));
        let mut asked = None;
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(stage.x);
                self.live()?.draw(ui, stage);
                Some(())
            });
            if has_side {
                let scroll = ScrollArea::vertical().max_height(stage.y).auto_shrink(false);
                ui.vertical(|ui| scroll.show(ui, |ui| asked = self.side(ui)));
            }
        });
        if let Some(live) = self.live[self.figure as usize].as_deref_mut() {
            self.playing.bar(ui, live, self.projector);
        }
        asked
    }

    /// Shows the story and the controls.
    fn side(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let told = if self.story { story::card(ui, self.figure) } else { None };
        if told == Some(FigureRequest::EndStory) {
            self.story = false;
        }
        if self.projector {
            return told;
        }
        ui.spacing_mut().slider_width = (ui.available_width() - BESIDE_SLIDER).max(80.0);
        let asked = self.live()?.controls(ui);
        told.or(asked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_found_by_name_and_stand_in_order() {
        for (place, figure) in Figure::all().enumerate() {
            assert_eq!(figure as usize, place);
            assert_eq!(Figure::named(figure.name()), Some(figure));
        }
        assert_eq!(Figure::named("triple"), None);
        assert!(Figure::names().starts_with("single, ghost"));
    }

    #[test]
    fn every_figure_has_data_that_are_numbers() {
        for figure in Figure::all() {
            let mut lab = Lab::new(figure);
            let Some(live) = lab.live() else { continue };
            let csv = live.csv(2.0);
            let mut lines = csv.lines();
            let columns = lines.next().unwrap().split(',').count();
            let mut count = 0;
            for line in lines {
                let values: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
                assert!(values.len() == columns && values.iter().all(|x| x.is_finite()), "{line}");
                count += 1;
            }
            assert!(count > 20, "{figure:?} has {count} lines");
        }
    }
}
