//! The energy of a pendulum, and the bar that shows its parts.

use egui::{Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::drawing::Tint;
use super::zero_height::ZeroHeight;
use flipmap_numbers::number_text::fixed;
use flipmap_pendulum::State;
use flipmap_scene::PendulumSpec;

/// The energy of a pendulum in J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Energy {
    pub kinetic: f64,
    /// The potential energy, counted from the height that the user has chosen.
    pub potential: f64,
    /// The potential energy where the pendulum hangs at rest.
    pub least: f64,
}

impl Energy {
    /// Creates the energy of a pendulum of a weight in N from its parts, of which the potential one is
    /// counted from where it hangs at rest.
    pub(crate) fn new(
        [kinetic, potential]: [f64; 2],
        weight_newtons: f64,
        zero: ZeroHeight,
    ) -> Self {
        let least = -weight_newtons * zero.above_m;
        Energy { kinetic, potential: potential + least, least }
    }

    /// Returns the energy of a double pendulum's state.
    pub(crate) fn of(build: &PendulumSpec, state: &State<f64>, zero: ZeroHeight) -> Self {
        let pendulum = build.pendulum();
        let potential = pendulum.energy(&State::rest(state.angle));
        let parts = [pendulum.energy(state) - potential, potential + pendulum.p + pendulum.q];
        let weight = build.gravity.value() * build.masses_kg().iter().sum::<f64>();
        Energy::new(parts, weight, zero)
    }

    /// Returns the energy of a default double pendulum's state, counted from where it hangs at rest.
    pub(crate) fn of_default(state: &State<f64>) -> Self {
        Energy::of(&PendulumSpec::default(), state, ZeroHeight::default())
    }

    /// Returns the sum of both parts.
    pub(crate) fn sum(self) -> f64 {
        self.kinetic + self.potential
    }

    /// Returns the part of the bar at which an energy stands, 0 where the pendulum hangs at rest and 1
    /// at the sum.
    fn share(self, energy: f64) -> f32 {
        let whole = self.sum() - self.least;
        if whole > 0.0 { ((energy - self.least) / whole).clamp(0.0, 1.0) as f32 } else { 0.0 }
    }

    /// Shows both parts in one bar, with a mark where it counts as 0, and their sum.
    pub(crate) fn bar(self, ui: &mut Ui, name: &str) {
        let tint = Tint::of(ui);
        let words = [("potential", self.potential), ("kinetic", self.kinetic), ("sum", self.sum())]
            .map(|(name, energy)| format!("{name} {} J", fixed(energy, 2)));
        let size = vec2(ui.available_width(), 16.0);
        let (response, painter) = ui.allocate_painter(size, Sense::hover());
        let told = format!("{name}: {}", words.join(", "));
        response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &told));
        let area = response.rect;
        let (left, right) = area.split_left_right_at_fraction(self.share(self.potential));
        painter.rect_filled(left, 2.0, tint.parts[2]);
        painter.rect_filled(right, 2.0, tint.parts[1]);
        if self.least < 0.0 && self.sum() >= 0.0 {
            let x = area.left() + self.share(0.0) * area.width();
            painter.vline(x, area.y_range(), Stroke::new(2.0, tint.ink));
        }
        ui.horizontal_wrapped(|ui| {
            let colours = [tint.parts[2], tint.parts[1], tint.ink];
            for (words, colour) in words.into_iter().zip(colours) {
                ui.colored_label(colour, words);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_height_moves_the_potential_energy_and_nothing_else() {
        let state = State { angle: [1.0, 2.0], speed: [0.5, -1.0] };
        let build = PendulumSpec::default();
        let [low, high] =
            [0.0, 1.0].map(|above_m| Energy::of(&build, &state, ZeroHeight { above_m }));
        assert_eq!(low.kinetic, high.kinetic);
        // Two masses of 1 kg hang 1 m below the height.
        assert!((low.potential - high.potential - 2.0 * 9.81).abs() < 1e-12);
        assert!((low.share(low.potential) - high.share(high.potential)).abs() < 1e-6);
        assert_eq!((low.share(0.0), low.least), (0.0, 0.0));
        let zero = f64::from(high.share(0.0)) * (high.sum() - high.least);
        assert!((zero - 2.0 * 9.81).abs() < 1e-4, "the mark stands at the height: {zero}");
    }
}
