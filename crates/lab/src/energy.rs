//! The energy of a pendulum, and the bar that shows its parts.

use egui::{Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::drawing::Tint;
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
    /// Creates the energy of a pendulum from its parts, of which the potential one is counted from where
    /// it hangs at rest; `lift_joules` is the work of lifting it from there to the height that counts
    /// instead.
    pub(crate) fn new([kinetic, potential]: [f64; 2], lift_joules: f64) -> Self {
        Energy { kinetic, potential: potential - lift_joules, least: -lift_joules }
    }

    /// Returns the energy of a double pendulum's state; the potential energy is counted from `zero_m`
    /// above the pivot.
    pub(crate) fn of(build: &PendulumSpec, state: &State<f64>, zero_m: f64) -> Self {
        let pendulum = build.pendulum();
        let potential = pendulum.energy(&State::rest(state.angle));
        let hanging = -pendulum.p - pendulum.q;
        let parts = [pendulum.energy(state) - potential, potential - hanging];
        Energy::new(parts, weight_newtons(build) * zero_m - hanging)
    }

    /// Returns the energy of a default double pendulum's state, counted from where it hangs at rest.
    pub(crate) fn of_default(state: &State<f64>) -> Self {
        let build = PendulumSpec::default();
        Energy::of(&build, state, hanging_m(&build))
    }

    /// Returns the sum of both parts.
    pub(crate) fn sum(self) -> f64 {
        self.kinetic + self.potential
    }

    /// Returns the part of the bar at which an energy stands, 0 where the pendulum hangs at rest and 1
    /// at the sum.
    fn share(self, energy: f64) -> f32 {
        let whole = self.sum() - self.least;
        if whole > 0.0 { ((energy - self.least) / whole).clamp(0.0, 1.0) as f32 } else { 1.0 }
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

fn weight_newtons(build: &PendulumSpec) -> f64 {
    build.gravity.value() * build.masses_kg().iter().sum::<f64>()
}

/// Returns the height in m above the pivot of the centre of mass of a double pendulum that hangs at
/// rest, which is negative.
pub(crate) fn hanging_m(build: &PendulumSpec) -> f64 {
    let pendulum = build.pendulum();
    -(pendulum.p + pendulum.q) / weight_newtons(build)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::Kind;

    #[test]
    fn potential_energy_is_that_of_the_masses_above_the_height_that_counts() {
        // Masses of 1.5 and 0.7 kg, rods of 0.8 and 1.3 m; the bobs, or the middles of the bars.
        for (kind, share) in [(Kind::Points, 1.0), (Kind::Rods, 0.5)] {
            let build = PendulumSpec::new(kind, [1.5, 0.7], [0.8, 1.3], 9.81);
            let state = State { angle: [1.0, 2.0], speed: [0.5, -1.0] };
            let [y1, y2] = [0.8 * -1f64.cos(), 1.3 * -2f64.cos()];
            for zero_m in [-2.1, 0.0, 0.4] {
                let energy = Energy::of(&build, &state, zero_m);
                let known = 9.81 * (1.5 * (share * y1 - zero_m) + 0.7 * (y1 + share * y2 - zero_m));
                assert!((energy.potential - known).abs() < 1e-12, "{kind:?}, {zero_m}");
                let hanging = Energy::of(&build, &State::rest([0.0; 2]), zero_m);
                assert!((hanging.potential - energy.least).abs() < 1e-12);
            }
            let none = Energy::of(&build, &State::rest([0.0; 2]), hanging_m(&build));
            assert!(none.potential.abs() < 1e-12 && none.least.abs() < 1e-12);
        }
    }

    #[test]
    fn another_height_changes_the_mark_and_not_the_bar() {
        let state = State { angle: [1.0, 2.0], speed: [0.5, -1.0] };
        let build = PendulumSpec::default();
        let [low, high] = [0.0, 1.0].map(|by| Energy::of(&build, &state, hanging_m(&build) + by));
        assert_eq!(low.kinetic, high.kinetic);
        assert!((low.share(low.potential) - high.share(high.potential)).abs() < 1e-6);
        assert!(low.share(0.0).abs() < 1e-6);
        let zero = f64::from(high.share(0.0)) * (high.sum() - high.least);
        assert!((zero - 2.0 * 9.81).abs() < 1e-4, "two masses of 1 kg, 1 m higher: {zero} J");
    }
}
