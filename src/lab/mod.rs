//! The laboratory: the seven figures of the lesson that this program grew from, live.
//!
//! Each figure is a [`LiveFigure`]: a state that advances in fixed steps whatever the frame rate, a
//! drawing, controls, and its data as CSV. A window shows one at a time; [`still`] draws one
//! without a window. The physics is the core's: no equation is written here. The seventh figure is
//! the map itself; [`flips`] explains it.

pub mod chart;
pub mod clock;
mod controls;
mod double;
mod double_simulation;
pub mod drawing;
mod figures;
pub mod flips;
mod ghost;
pub mod home;
pub mod integrators;
mod machine;
mod single;
mod single_simulation;
pub mod still;
pub mod twenty;

use egui::{Key, ScrollArea, Ui, vec2};
use figures::{ENTRIES, Entry};

use crate::physics::State;

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
}

/// A figure that runs live and that the user can change.
pub trait LiveFigure {
    /// Begins again from a start found elsewhere; a single pendulum takes θ1, and is released at
    /// rest.
    fn open(&mut self, start: State<f64>);
    /// Advances the figure by `elapsed_secs`.
    fn advance(&mut self, elapsed_secs: f64);
    /// Draws the figure in an area of `size` points.
    fn draw(&mut self, ui: &mut Ui, size: egui::Vec2);
    /// Shows the figure's sliders and numbers; returns a request to the window if there is one.
    fn controls(&mut self, ui: &mut Ui) -> Option<FigureRequest>;
    /// Returns the values set by the user, with the start first, in rad.
    fn set(&self) -> Vec<f64>;
    /// Returns the data as CSV with a header; data against time cover `secs` from the start.
    fn csv(&self, secs: f64) -> String;
}

/// All figures, and the one that is shown.
pub struct Lab {
    /// The figure that is shown.
    pub figure: Figure,
    /// The figures in the order of the table, nothing in the place of the map.
    live: [Option<Box<dyn LiveFigure>>; ENTRIES.len()],
}

/// Width of the controls in points.
const CONTROLS_WIDTH: f32 = 330.0;

impl Lab {
    /// Creates every figure in its initial state, and shows one.
    pub fn new(figure: Figure) -> Self {
        Lab { figure, live: ENTRIES.each_ref().map(|entry| (entry.begin)()) }
    }

    /// Returns the figure that is shown; none if that is the map.
    pub fn live(&mut self) -> Option<&mut (dyn LiveFigure + 'static)> {
        self.live[self.figure as usize].as_deref_mut()
    }

    /// Returns the values that the user has set in the figure that is shown.
    pub fn set(&self) -> Vec<f64> {
        self.live[self.figure as usize].as_ref().map_or(Vec::new(), |live| live.set())
    }

    /// Shows a figure and opens a start in it.
    pub fn open(&mut self, figure: Figure, start: State<f64>) {
        self.figure = figure;
        if let Some(live) = self.live() {
            live.open(start);
        }
    }

    /// Shows the figure, with its sentence above and its controls beside it.
    pub fn show(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        ui.heading(self.figure.title());
        ui.label(self.figure.sentence());
        let live = self.live()?;
        let size = ui.available_size();
        let stage = vec2((size.x - CONTROLS_WIDTH - 16.0).max(200.0), (size.y - 8.0).max(200.0));
        let mut asked = None;
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(stage.x);
                live.draw(ui, stage);
            });
            ui.vertical(|ui| {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    asked = live.controls(ui);
                });
            });
        });
        asked
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
