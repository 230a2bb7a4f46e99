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

mod arrangement;
pub mod chart;
mod clock;
mod colour_words;
mod controls;
mod double;
mod double_simulation;
pub mod drawing;
mod energy;
mod equation;
mod expression;
mod figures;
pub mod flips;
mod formula;
mod ghost;
pub mod home;
mod integrators;
mod labels;
pub mod lesson;
mod machine;
mod playing;
mod polyline;
mod predictions;
mod quantity;
mod reversal;
mod ruler;
pub mod set_up;
pub mod sheet;
mod single;
mod single_simulation;
mod slopes;
pub mod still;
mod sweep;
pub mod take_away;
mod twenty;
mod twin;
pub mod typeface;
mod zero_height;

pub use egui::Theme;
use egui::{Key, ScrollArea, Ui, vec2};
use figures::{ENTRIES, Entry};
use lesson::Lesson;
use playing::Playing;
use ruler::StageRuler;
use set_up::SetUpWord;
use take_away::TakeAway;

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

    /// Returns all names.
    pub fn names() -> Vec<&'static str> {
        ENTRIES.iter().map(|entry| entry.name).collect()
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
    /// Ends the lesson.
    EndLesson,
    /// Pauses the figure that is shown.
    Pause,
    /// Copies the set-up of the figure that is shown.
    CopySetUp,
    /// Writes the figure that is shown to a file.
    TakeAway(TakeAway),
}

/// A figure that runs live and responds to the user.
pub trait LiveFigure: Send {
    /// Returns a copy of the figure at its present moment.
    fn copied(&self) -> Box<dyn LiveFigure>;
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
    /// Returns the set-up, word by word, beginning with the start's angles in rad.
    fn set_up(&self) -> Vec<SetUpWord>;
    /// Begins again as the numbers of all words say, in the order of [`LiveFigure::set_up`].
    fn take_set_up(&mut self, numbers: &[f64]);
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
    /// The lesson of questions beside the figures.
    pub lesson: Lesson,
}

/// Range of the width of the controls in points.
const CONTROLS_WIDTH: std::ops::RangeInclusive<f32> = 312.0..=408.0;
/// Width in points that a row needs beside its slider, for the name and the number.
const BESIDE_SLIDER: f32 = 176.0;
/// Range of the width of a slider in points.
const SLIDER_WIDTH: std::ops::RangeInclusive<f32> = 80.0..=240.0;
/// Height of the playback controls in points.
const BAR_HEIGHT: f32 = 20.0;
/// Space between a figure and its controls in points.
const GAP: f32 = 16.0;
/// Width in points from which on the controls have room beside the figure rather than below it.
const WIDE: f32 = 760.0;
/// Least height of a figure with its controls in points.
const LEAST_HEIGHT: f32 = 120.0;

impl Lab {
    /// Creates every figure in its initial state, and shows one.
    pub fn new(figure: Figure) -> Self {
        let live = ENTRIES.each_ref().map(|entry| (entry.begin)());
        Lab {
            figure,
            live,
            playing: Playing::default(),
            projector: false,
            lesson: Lesson::default(),
        }
    }

    /// Returns the figure that is shown, or `None` if that is the map.
    pub fn live(&mut self) -> Option<&mut (dyn LiveFigure + 'static)> {
        self.live[self.figure as usize].as_deref_mut()
    }

    /// Returns the values that the user has set in the figure that is shown.
    pub fn set(&self) -> Vec<f64> {
        let live = self.live[self.figure as usize].as_ref();
        live.map_or(Vec::new(), |live| set_up::numbers(&live.set_up()))
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

    /// Reveals the answer if the class has made its choice, otherwise plays or pauses the figure,
    /// which stands still before that choice.
    pub fn reveal_or_play(&mut self) {
        if self.lesson.awaits_reveal() {
            self.lesson.reveal();
        } else if !(self.lesson.awaits_choice() && self.playing.paused) {
            self.playing.paused ^= true;
        }
    }

    /// Shows the figure with its sentence above and the playback controls below. Its controls are
    /// beside it or, where that leaves too little room, below it; what is too high can be scrolled.
    pub fn show(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let is_wide = ui.available_width() >= WIDE;
        let has_side = self.lesson.is_on || !self.projector;
        ui.heading(self.figure.title());
        if is_wide {
            self.sentence(ui);
        }
        self.live()?;
        let high = (ui.available_height() - BAR_HEIGHT - 8.0).max(LEAST_HEIGHT);
        let asked = match is_wide && has_side {
            true => self.show_in_columns(ui, high),
            false => self.show_in_one_column(ui, high, !is_wide),
        };
        if let Some(live) = self.live[self.figure as usize].as_deref_mut() {
            self.playing.bar(ui, live, self.projector);
        }
        asked
    }

    /// Shows the figure with its title and nothing that can be operated, as pictures and films do.
    pub fn show_alone(&mut self, ui: &mut Ui) {
        ui.heading(self.figure.title());
        self.draw(ui, ui.available_size());
    }

    fn sentence(&self, ui: &mut Ui) {
        if !self.projector && !self.lesson.hides_answer() {
            ui.label(self.figure.sentence());
        }
    }

    /// Shows the figure with its controls beside it, each `high` points high.
    fn show_in_columns(&mut self, ui: &mut Ui, high: f32) -> Option<FigureRequest> {
        let width = ui.available_width();
        let controls = (0.32 * width).clamp(*CONTROLS_WIDTH.start(), *CONTROLS_WIDTH.end());
        let stage = vec2((width - controls - GAP).max(0.0), high);
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            let scroll = |name| ScrollArea::vertical().id_salt(name).max_height(high);
            ui.vertical(|ui| {
                ui.set_width(stage.x);
                scroll("figure").auto_shrink(false).show(ui, |ui| self.draw(ui, stage));
            });
            let side =
                |ui: &mut Ui| scroll("side").auto_shrink(false).show(ui, |ui| self.side(ui)).inner;
            ui.vertical(side).inner
        })
        .inner
    }

    /// Shows the figure with its controls below it, all of which scroll in `high` points.
    fn show_in_one_column(
        &mut self,
        ui: &mut Ui,
        high: f32,
        has_sentence: bool,
    ) -> Option<FigureRequest> {
        let scroll = ScrollArea::vertical().id_salt("all").max_height(high).auto_shrink(false);
        let shown = scroll.show(ui, |ui| {
            if has_sentence {
                self.sentence(ui);
            }
            let told = self.card(ui);
            let high = (high - ui.min_rect().height() - 8.0).max(LEAST_HEIGHT);
            let stage = vec2(ui.available_width(), high);
            ui.scope(|ui| self.draw(ui, stage));
            told.or(self.operate(ui))
        });
        shown.inner
    }

    /// Draws the figure in an area of `size` points.
    fn draw(&mut self, ui: &mut Ui, size: egui::Vec2) {
        ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
        if let Some(live) = self.live() {
            live.draw(ui, size);
        }
    }

    /// Shows the lesson's question and the controls.
    fn side(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let told = self.card(ui);
        told.or(self.operate(ui))
    }

    /// Shows the lesson's question while the lesson is on.
    fn card(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        if self.lesson.is_on { self.lesson_card(ui) } else { None }
    }

    /// Shows the controls; before an audience only those that a lesson needs.
    fn operate(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        if self.projector && !self.lesson.is_on {
            return None;
        }
        let room = ui.available_width() - BESIDE_SLIDER;
        ui.spacing_mut().slider_width = room.clamp(*SLIDER_WIDTH.start(), *SLIDER_WIDTH.end());
        let mut asked = self.live()?.controls(ui);
        if asked == Some(FigureRequest::Pause) {
            self.playing.paused = true;
            asked = None;
        }
        ui.separator();
        StageRuler::switch(ui);
        asked.or(take_away_buttons(ui))
    }

    /// Returns a copy of the lab with all figures at their present moments.
    pub fn copied(&self) -> Self {
        let live = self.live.each_ref().map(|live| live.as_ref().map(|live| live.copied()));
        Lab { live, playing: self.playing.clone(), ..*self }
    }
}

/// Shows the ways to take a figure away.
fn take_away_buttons(ui: &mut Ui) -> Option<FigureRequest> {
    let mut asked = None;
    ui.horizontal_wrapped(|ui| {
        ui.label("Take away");
        for kind in TakeAway::ALL {
            let hint = format!("Write the figure as .{}", kind.ending());
            if ui.button(kind.name()).on_hover_text(hint).clicked() {
                asked = Some(FigureRequest::TakeAway(kind));
            }
        }
        let hint = "A line of text that opens this figure again when it is pasted here";
        if ui.button("Copy set-up").on_hover_text(hint).clicked() {
            asked = Some(FigureRequest::CopySetUp);
        }
    });
    asked
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
        assert!(Figure::names().starts_with(&["single", "ghost"]));
    }

    /// Returns the texts that a figure shows in a window of a size, with their areas and the parts of
    /// these that can be seen.
    fn texts(lab: &mut Lab, size: egui::Vec2) -> Vec<(String, egui::Rect, egui::Rect)> {
        let ctx = egui::Context::default();
        typeface::install(&ctx);
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
        let mut shapes = Vec::new();
        for _ in 0..3 {
            let input = egui::RawInput { screen_rect: Some(screen), ..egui::RawInput::default() };
            let mut shown = ctx.run_ui(input, |ui| {
                egui::CentralPanel::default().show(ui, |ui| lab.show(ui));
            });
            shown.textures_delta.clear();
            shapes = shown.shapes;
        }
        let text = |clipped: &egui::epaint::ClippedShape| match &clipped.shape {
            // A halo has the words of its label.
            egui::Shape::Text(text)
                if text.override_text_color.is_none() && !text.galley.text().trim().is_empty() =>
            {
                let area = text.galley.mesh_bounds.translate(text.pos.to_vec2());
                let seen = area.intersect(clipped.clip_rect).shrink(1.0);
                Some((text.galley.text().to_string(), area, seen))
            }
            _ => None,
        };
        shapes.iter().filter_map(text).collect()
    }

    /// Sizes of windows in points, down to 640 × 480 pixels at a scale of 2, up to 3840 × 2160.
    const SIZES: [[f32; 2]; 8] = [
        [320.0, 240.0],
        [640.0, 360.0],
        [640.0, 480.0],
        [800.0, 500.0],
        [1280.0, 360.0],
        [1280.0, 800.0],
        [1920.0, 1080.0],
        [3840.0, 2160.0],
    ];

    #[test]
    fn in_no_window_does_anything_cover_another_or_leave_at_the_side() {
        for figure in Figure::all().filter(|figure| *figure != Figure::Map) {
            for (k, size) in SIZES.into_iter().enumerate() {
                let mut lab = Lab::new(figure);
                lab.projector = k % 2 == 1;
                (0..40 * k).for_each(|_| lab.advance(0.05));
                apart(&texts(&mut lab, size.into()), size, &format!("{figure:?}"));
            }
        }
    }

    #[test]
    fn the_lesson_fits_beside_every_figure() {
        for figure in Figure::all().filter(|figure| *figure != Figure::Map) {
            for size in [[640.0, 480.0], [1280.0, 800.0]] {
                let mut lab = Lab::new(figure);
                lab.set_lesson(true);
                apart(&texts(&mut lab, size.into()), size, &format!("{figure:?}"));
            }
        }
    }

    /// Checks that no text covers another, and that none leaves a window at its sides.
    fn apart(texts: &[(String, egui::Rect, egui::Rect)], size: [f32; 2], name: &str) {
        assert!(texts.len() > 5, "{name}");
        for (k, (words, area, seen)) in texts.iter().enumerate() {
            let place = format!("{name} at {size:?}: '{words}' at {area:?}");
            assert!(area.left() >= 0.0 && area.right() <= size[0], "{place}");
            let covers = |other: &egui::Rect| seen.intersect(*other).is_positive();
            let covered = texts[..k].iter().find(|(_, _, other)| covers(other));
            assert!(covered.is_none(), "{place} covers {covered:?}");
        }
    }

    #[test]
    fn numbers_are_written_as_people_read_them() {
        for figure in Figure::all().filter(|figure| *figure != Figure::Map) {
            let mut lab = Lab::new(figure);
            (0..160).for_each(|_| lab.advance(0.05));
            for (words, ..) in texts(&mut lab, vec2(1280.0, 1600.0)) {
                let letters: Vec<char> = words.chars().collect();
                let is_ascii =
                    letters.windows(2).any(|pair| pair[0] == '-' && pair[1].is_ascii_digit());
                // Fields can be pasted.
                assert!(
                    !is_ascii || words.trim_end_matches(" rad") == "1e-7",
                    "{figure:?}: {words}"
                );
            }
        }
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
