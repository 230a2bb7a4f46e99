//! Figure 7: the flip-time map explained in words, with the numbers of a scene.

use egui::{Grid, Image, TextureHandle, Ui, vec2};

use super::Figure;
use super::chart::plain;
use super::controls::row;
use crate::scene::{Build, Kind};

/// Counts of the map's known pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Number of pixels known so far.
    pub pixels: u64,
    /// Number of starts that conservation of energy keeps from flipping.
    pub forbidden: u64,
    /// Number of starts that were integrated; mirror images and forbidden starts were not.
    pub simulated: u64,
}

/// Shows a picture of the map beside its explanation: the figure without a window.
pub fn show(ui: &mut Ui, map: &TextureHandle, build: &Build, seen: &Seen) {
    let figure = Figure::Map;
    ui.heading(figure.title());
    ui.label(figure.sentence());
    ui.horizontal_top(|ui| {
        let side = ui.available_height().min(ui.available_width() - 340.0).max(200.0);
        let picture = Image::new(map).fit_to_exact_size(vec2(side, side));
        ui.add(picture.alt_text("The flip-time map"));
        ui.vertical(|ui| explain(ui, build, seen));
    });
}

/// Explains the map; returns the other kind of pendulum if the user chooses it.
pub fn explain(ui: &mut Ui, build: &Build, seen: &Seen) -> Option<Kind> {
    let [p, q] = [build.pendulum().p, build.pendulum().q];
    ui.label(
        "Every pixel is a pendulum let go at rest at its (θ1, θ2). Its colour is how long the \
         second bob takes to flip over the top: dark at once, pink late, white not within the \
         budget.",
    );
    ui.label(
        "Grey starts have too little energy ever to flip: with the second bob upright and the \
         first hanging, the potential energy would exceed what they begin with. The black line \
         around them is where the two are equal. That is a theorem, so they cost nothing.",
    );
    ui.monospace(curve_words(p, q));
    Grid::new("seen").num_columns(2).show(ui, |ui| {
        let share = |count: u64| 100.0 * count as f64 / (seen.pixels.max(1)) as f64;
        row(ui, "pixels", seen.pixels.to_string());
        row(ui, "forbidden", format!("{} ({:.1} %)", seen.forbidden, share(seen.forbidden)));
        row(ui, "integrated", format!("{} ({:.1} %)", seen.simulated, share(seen.simulated)));
    });
    ui.label(format!(
        "The theorem alone spares {:.2} % of the whole torus; mirror images spare half of the rest.",
        100.0 * forbidden_share(p / q)
    ));
    let mut kind = build.kind;
    ui.horizontal(|ui| {
        ui.radio_value(&mut kind, Kind::Points, "two bobs");
        ui.radio_value(&mut kind, Kind::Rods, "uniform bars");
    });
    (kind != build.kind).then_some(kind)
}

/// Formats the condition of the forbidden region with the fewest numbers: for equal bobs
/// 2cos θ1 + cos θ2 > 1, for equal bars 3cos θ1 + cos θ2 > 2.
fn curve_words(p: f64, q: f64) -> String {
    let ratio = p / q;
    format!("forbidden: {} cos θ1 + cos θ2 > {}", plain(ratio), plain(ratio - 1.0))
}

/// Returns the fraction of the torus on which `ratio` cos θ1 + cos θ2 > `ratio` − 1.
pub fn forbidden_share(ratio: f64) -> f64 {
    const STEPS: u32 = 200_000;
    let strip = |k: u32| {
        let theta1 = (f64::from(k) + 0.5) / f64::from(STEPS) * std::f64::consts::PI;
        (ratio - 1.0 - ratio * theta1.cos()).clamp(-1.0, 1.0).acos() / std::f64::consts::PI
    };
    (0..STEPS).map(strip).sum::<f64>() / f64::from(STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_forbidden_shares_are_the_known_ones() {
        let share = |kind| {
            let pendulum = Build { kind, ..Build::default() }.pendulum();
            forbidden_share(pendulum.p / pendulum.q)
        };
        assert!((share(Kind::Rods) - 0.2439).abs() < 5e-5, "{}", share(Kind::Rods));
        assert!((share(Kind::Points) - 0.306_436).abs() < 5e-6, "{}", share(Kind::Points));
    }

    #[test]
    fn the_formulas_are_those_of_the_lesson() {
        let words = |kind| {
            let pendulum = Build { kind, ..Build::default() }.pendulum();
            curve_words(pendulum.p, pendulum.q)
        };
        assert_eq!(words(Kind::Points), "forbidden: 2 cos θ1 + cos θ2 > 1");
        assert_eq!(words(Kind::Rods), "forbidden: 3 cos θ1 + cos θ2 > 2");
    }
}
