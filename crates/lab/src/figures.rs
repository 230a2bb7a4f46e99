//! The table of the lesson's figures. A new figure needs a module, a variant of [`Figure`] and an
//! entry below; names, titles, keys, tabs and the command line follow from the entry.

use egui::Key;

use super::double::Double;
use super::ghost::Ghost;
use super::integrators::Integrators;
use super::machine::MachineFigure;
use super::single::Single;
use super::twenty::Twenty;
use super::{Figure, LiveFigure};

/// The description of a figure.
pub(super) struct Entry {
    /// The figure.
    pub figure: Figure,
    /// Name on the command line.
    pub name: &'static str,
    /// Title, as headings and tabs show it.
    pub title: &'static str,
    /// A sentence on what the figure shows and what to try.
    pub sentence: &'static str,
    /// Key that shows the figure.
    pub key: Key,
    /// Creates the figure in its initial state; returns `None` for the map.
    pub begin: fn() -> Option<Box<dyn LiveFigure>>,
}

/// All figures in the lesson's order, which is also the order of [`Figure`].
pub(super) static ENTRIES: [Entry; 7] = [
    Entry {
        figure: Figure::Single,
        name: "single",
        title: "The single pendulum",
        sentence: "One coordinate, the angle. Drag the bob, and see which of the parts matter to how \
                   it moves.",
        key: Key::F2,
        begin: begin::<Single>,
    },
    Entry {
        figure: Figure::Ghost,
        name: "ghost",
        title: "A real pendulum and its small-angle ghost",
        sentence: "Drag the bob past 90° and let go. The grey ghost swings as if sin θ were θ, \
                   always in 2π√(r/g), and falls out of step.",
        key: Key::F3,
        begin: begin::<Ghost>,
    },
    Entry {
        figure: Figure::Double,
        name: "double",
        title: "The double pendulum",
        sentence: "Hang a second pendulum on the first one's bob. Two angles, both from the \
                   vertical; drag either bob.",
        key: Key::F4,
        begin: begin::<Double>,
    },
    Entry {
        figure: Figure::Machine,
        name: "machine",
        title: "The whole machine",
        sentence: "At every moment a matrix equation gives the accelerations. Drag a bob, change a \
                   mass, and watch the numbers.",
        key: Key::F5,
        begin: begin::<MachineFigure>,
    },
    Entry {
        figure: Figure::Integrators,
        name: "integrators",
        title: "Three integrators",
        sentence: "One start, one Δt, three ways to step. Make Δt larger until explicit Euler runs \
                   away; RK4 hugs zero longest.",
        key: Key::F6,
        begin: begin::<Integrators>,
    },
    Entry {
        figure: Figure::Twenty,
        name: "twenty",
        title: "Twenty pendulums a hair apart",
        sentence: "They look like one, until they fan out: the separation climbs along a straight \
                   line on a logarithmic scale. Make the nudge a thousand times smaller and see \
                   what it buys.",
        key: Key::F7,
        begin: begin::<Twenty>,
    },
    Entry {
        figure: Figure::Map,
        name: "map",
        title: "The flip-time map",
        sentence: "Every start at once. Zoom into the filigree; click a pixel to fly its pendulum.",
        key: Key::F8,
        begin: || None,
    },
];

fn begin<F: LiveFigure + Default + 'static>() -> Option<Box<dyn LiveFigure>> {
    Some(Box::<F>::default())
}
