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
pub mod flips;
mod ghost;
pub mod home;
pub mod integrators;
mod machine;
mod single;
mod single_simulation;
pub mod still;
pub mod twenty;

use egui::{ScrollArea, Ui, vec2};

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
    /// All figures, in the lesson's order: each with its name, its title, and a suggestion to try.
    pub const ALL: [(Figure, &'static str, &'static str, &'static str); 7] = [
        (
            Figure::Single,
            "single",
            "The single pendulum",
            "One angle says everything. Drag the bob, and see which of the parts matter to how it \
             moves: the mass does not.",
        ),
        (
            Figure::Ghost,
            "ghost",
            "A real pendulum and its small-angle ghost",
            "Drag the bob past 90° and let go. The grey ghost swings as if sin θ were θ, always in \
             2π√(r/g), and falls out of step.",
        ),
        (
            Figure::Double,
            "double",
            "The double pendulum",
            "Hang a second pendulum on the first one's bob. Two angles, both from the vertical; \
             drag either bob.",
        ),
        (
            Figure::Machine,
            "machine",
            "The whole machine",
            "At every moment a matrix equation gives the accelerations. Drag a bob, change a mass, \
             and watch the numbers.",
        ),
        (
            Figure::Integrators,
            "integrators",
            "Three integrators",
            "One start, one Δt, three ways to step. Make Δt larger until explicit Euler runs away; \
             RK4 hugs zero longest.",
        ),
        (
            Figure::Twenty,
            "twenty",
            "Twenty pendulums a hair apart",
            "They look like one, until they fan out: the separation climbs along a straight line \
             on a logarithmic scale. Make the nudge a thousand times smaller and see what it buys.",
        ),
        (
            Figure::Map,
            "map",
            "The flip-time map",
            "Every start at once. Zoom into the filigree; click a pixel to fly its pendulum.",
        ),
    ];

    /// Returns the figure with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known, ..)| *known == name).map(|(figure, ..)| *figure)
    }

    /// Returns all names, separated by commas.
    pub fn names() -> String {
        Self::ALL.map(|(_, name, ..)| name).join(", ")
    }

    /// Returns the figure's name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// Returns the figure's title.
    pub fn title(self) -> &'static str {
        Self::ALL[self as usize].2
    }

    /// Returns a sentence on what the figure shows and what to try.
    pub fn sentence(self) -> &'static str {
        Self::ALL[self as usize].3
    }
}

/// A request from a figure to the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FigureRequest {
    /// Shows this start (θ1, θ2 in rad) on the map.
    ToMap([f64; 2]),
}

/// A figure that runs live and that the user can change.
pub trait LiveFigure {
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

/// All figures except the map, and the one that is shown.
#[derive(Clone, Debug)]
pub struct Lab {
    /// The figure that is shown.
    pub figure: Figure,
    single: single::Single,
    ghost: ghost::Ghost,
    double: double::Double,
    machine: machine::MachineFigure,
    integrators: integrators::Integrators,
    twenty: twenty::Twenty,
}

/// Width of the controls in points.
const CONTROLS_WIDTH: f32 = 330.0;

impl Lab {
    /// Creates every figure in its initial state, and shows one.
    pub fn new(figure: Figure) -> Self {
        Lab {
            figure,
            single: Default::default(),
            ghost: Default::default(),
            double: Default::default(),
            machine: Default::default(),
            integrators: Default::default(),
            twenty: Default::default(),
        }
    }

    /// Returns the figure that is shown; none if that is the map.
    pub fn live(&mut self) -> Option<&mut dyn LiveFigure> {
        Some(match self.figure {
            Figure::Single => &mut self.single,
            Figure::Ghost => &mut self.ghost,
            Figure::Double => &mut self.double,
            Figure::Machine => &mut self.machine,
            Figure::Integrators => &mut self.integrators,
            Figure::Twenty => &mut self.twenty,
            Figure::Map => return None,
        })
    }

    /// Returns the values that the user has set in the figure that is shown.
    pub fn set(&self) -> Vec<f64> {
        match self.figure {
            Figure::Single => self.single.set(),
            Figure::Ghost => self.ghost.set(),
            Figure::Double => self.double.set(),
            Figure::Machine => self.machine.set(),
            Figure::Integrators => self.integrators.set(),
            Figure::Twenty => self.twenty.set(),
            Figure::Map => Vec::new(),
        }
    }

    /// Shows a figure and opens a start (θ1, θ2 in rad) in it, or in the machine if it takes none.
    pub fn open(&mut self, figure: Figure, start: [f64; 2]) {
        self.figure = figure;
        match figure {
            Figure::Integrators => self.integrators.open(start),
            Figure::Twenty => self.twenty.open(start),
            _ => self.machine.open(start),
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
        for (place, (figure, name, ..)) in Figure::ALL.into_iter().enumerate() {
            assert_eq!(figure as usize, place);
            assert_eq!(Figure::named(name), Some(figure));
        }
        assert_eq!(Figure::named("triple"), None);
        assert!(Figure::names().starts_with("single, ghost"));
    }

    #[test]
    fn every_figure_has_data_that_are_numbers() {
        for (figure, ..) in Figure::ALL {
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
