//! A second pendulum beside the first, with one difference.

use egui::{ComboBox, Grid, Ui};

use super::controls::{FRICTIONS, GRAVITIES, LENGTHS, MASSES, number};
use super::double_simulation::DoublePendulumSimulation;
use flipmap_pendulum::State;
use flipmap_scene::PendulumSpec;

/// What differs between two pendulums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Difference {
    Angle,
    Mass,
    Length,
    Gravity,
    Friction,
}

impl Difference {
    const ALL: [Difference; 5] = [
        Difference::Angle,
        Difference::Mass,
        Difference::Length,
        Difference::Gravity,
        Difference::Friction,
    ];

    /// Returns the name of the quantity, its unit, and its range.
    fn described(self) -> (&'static str, &'static str, std::ops::RangeInclusive<f64>) {
        match self {
            Difference::Angle => ("θ2 more by", " rad", 1e-6..=1.0),
            Difference::Mass => ("Mass m2", " kg", MASSES),
            Difference::Length => ("Length l2", " m", LENGTHS),
            Difference::Gravity => ("Gravity g", " m/s²", GRAVITIES),
            Difference::Friction => ("Friction of the pivots", " N m s", FRICTIONS),
        }
    }
}

/// The second pendulum.
#[derive(Clone, Debug)]
pub(super) struct Twin {
    difference: Difference,
    value: f64,
    pub simulation: DoublePendulumSimulation,
}

impl Twin {
    /// Creates a twin of a pendulum, which begins again with it; its second rod is turned a little
    /// further.
    pub(super) fn of(original: &DoublePendulumSimulation) -> Self {
        let simulation = original.clone();
        let mut twin = Twin { difference: Difference::Angle, value: 0.01, simulation };
        twin.begin(original);
        twin
    }

    /// Begins again, as the original does now but for the difference.
    pub(super) fn begin(&mut self, original: &DoublePendulumSimulation) {
        let mut build: PendulumSpec = original.build;
        let mut start: State<f64> = original.start;
        match self.difference {
            Difference::Angle => start.angle[1] += self.value,
            Difference::Mass => build.masses[1] = self.value.into(),
            Difference::Length => build.lengths[1] = self.value.into(),
            Difference::Gravity => build.gravity = self.value.into(),
            Difference::Friction => build.friction = [self.value.into(); 2],
        }
        self.simulation.build = build;
        self.simulation.release(start);
    }

    /// Shows what differs and by how much, and returns true if that was changed.
    pub(super) fn controls(&mut self, ui: &mut Ui) -> bool {
        let (name, unit, range) = self.difference.described();
        let before = self.difference;
        ComboBox::from_label("what differs").selected_text(name).show_ui(ui, |ui| {
            for difference in Difference::ALL {
                ui.selectable_value(&mut self.difference, difference, difference.described().0);
            }
        });
        if self.difference != before {
            self.value = match self.difference {
                Difference::Angle => 0.01,
                Difference::Mass | Difference::Length => 2.0,
                Difference::Gravity => 1.62,
                Difference::Friction => 0.1,
            };
            return true;
        }
        let mut is_changed = false;
        Grid::new("twin").num_columns(2).show(ui, |ui| {
            is_changed = number(ui, name, unit, &mut self.value, range);
        });
        is_changed
    }
}
