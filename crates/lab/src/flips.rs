//! Figure 7: the map, explained with the numbers of its scene, in words that hold for its colours,
//! question and plane.

use egui::{Color32, Grid, Image, Sense, TextureHandle, Ui, vec2};

use super::Figure;
use super::colour_words::colour_words;
use super::controls::row;
use flipmap_numbers::number_text::{brief, count, plain};
use flipmap_pendulum::{Pendulum, Rule};
use flipmap_scene::palette::{AnswerColours, Rgb};
use flipmap_scene::{Document, Kind, Plane, PlaneKind, QuestionSettings, Scene};

/// Counts of the pixels of a picture or of a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Name of the pixels that are counted.
    pub name: &'static str,
    /// Number of pixels computed so far.
    pub pixels: u64,
    /// Number of starts that cannot flip because energy is conserved.
    pub forbidden: u64,
    /// Number of starts that were integrated, which excludes mirror images and forbidden starts, if
    /// it was counted.
    pub simulated: Option<u64>,
}

/// Shows a picture of the map beside its explanation, without the explorer's window.
pub fn show(ui: &mut Ui, map: &TextureHandle, document: &Document, seen: &Seen) {
    let figure = Figure::Map;
    ui.heading(figure.title());
    ui.label(figure.sentence());
    ui.horizontal_top(|ui| {
        let side = ui.available_height().min(ui.available_width() - 340.0).max(200.0);
        let picture = Image::new(map).fit_to_exact_size(vec2(side, side));
        ui.add(picture.alt_text("The flip-time map"));
        ui.vertical(|ui| explain(ui, document, seen));
    });
}

/// Explains the map; returns the other kind of pendulum if the user chooses it.
pub fn explain(ui: &mut Ui, document: &Document, seen: &Seen) -> Option<Kind> {
    let scene = document.scene();
    ui.label(format!("{} {}", plane_words(&scene.plane), question_words(&scene.question)));
    if let Ok(colours) = AnswerColours::new(&scene, &document.picture) {
        meanings(ui, &scene, &colours);
        energy(ui, &scene, &colours);
    }
    let forbids = has_forbidden(&scene);
    Grid::new("seen").num_columns(2).show(ui, |ui| {
        let counted = |part: u64| {
            let share = 100.0 * part as f64 / seen.pixels.max(1) as f64;
            format!("{} ({share:.1} %)", count(part))
        };
        row(ui, seen.name, count(seen.pixels));
        if forbids {
            row(ui, "forbidden", counted(seen.forbidden));
        }
        if let Some(simulated) = seen.simulated {
            row(ui, "integrated", counted(simulated));
            let others = seen.pixels.saturating_sub(seen.forbidden + simulated);
            row(ui, "mirror images, or known at once", counted(others));
        }
    });
    let mut kind = scene.build.kind;
    ui.horizontal(|ui| {
        ui.radio_value(&mut kind, Kind::Points, "two bobs");
        ui.radio_value(&mut kind, Kind::Rods, "uniform bars");
    });
    (kind != scene.build.kind).then_some(kind)
}

/// Describes the start that a pixel of the plane stands for.
fn plane_words(plane: &Plane) -> String {
    if plane.is_at_rest() {
        return "Every pixel is a pendulum let go at rest at its (θ1, θ2).".to_string();
    }
    let [across, up] = plane.axes().map(|axis| axis.symbol());
    match plane.kind {
        PlaneKind::Axes(_) => format!(
            "Every pixel is a pendulum that sets out with its own ({across}, {up}), across and up; \
             the other numbers of the start are the same for all."
        ),
        PlaneKind::Section => format!(
            "Every pixel is a pendulum of energy {} J whose first rod swings forward through the \
             bottom, with its own ({across}, {up}).",
            brief(plane.energy)
        ),
    }
}

/// Describes the meaning of the colours for a question.
fn question_words(question: &QuestionSettings) -> String {
    if !question.ask.is_time() || question.watched() == Rule::Neither {
        return question.ask.kind().about.to_string();
    }
    let bob = match question.watched() {
        Rule::First => "the first bob",
        Rule::Either => "one of the bobs, whichever is first,",
        Rule::Second | Rule::Neither => "the second bob",
    };
    match question.count {
        1 => format!("Its colour is how long {bob} takes to flip over the top."),
        count => format!("Its colour is how long {bob} takes to flip over the top {count} times."),
    }
}

/// Returns true if conservation of energy may keep starts from the event that the question watches
/// for.
fn has_forbidden(scene: &Scene) -> bool {
    scene.question.watched() != Rule::Neither && scene.build.gravity.value() > 0.0
}

/// Shows sample colours of the map, each with its name and its meaning.
fn meanings(ui: &mut Ui, scene: &Scene, colours: &AnswerColours) {
    let title = colours.title(scene.question.ask);
    if !colours.is_square() {
        for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let value = brief(colours.value_along(share));
            let meaning = match scene.question.ask.is_time() {
                true => format!("after {value} s"),
                false => format!("{} {value} {}", title.name, title.unit),
            };
            swatch(ui, colours.colour_along(share), meaning.trim_end());
        }
    }
    if scene.question.ask.is_time() {
        let budget = brief(scene.question.budget.secs);
        swatch(ui, colours.ground().unflipped, &format!("not within {budget} s"));
    }
}

/// Shows a square of a colour with the colour's name and its meaning.
fn swatch(ui: &mut Ui, colour: Rgb, meaning: &str) {
    ui.horizontal(|ui| {
        let (response, painter) = ui.allocate_painter(vec2(24.0, 16.0), Sense::hover());
        let [r, g, b] = colour;
        painter.rect_filled(response.rect, 2.0, Color32::from_rgb(r, g, b));
        ui.label(format!("{}: {meaning}", colour_words(colour)));
    });
}

/// Explains which starts have too little energy to flip, and how many they are.
fn energy(ui: &mut Ui, scene: &Scene, colours: &AnswerColours) {
    if !has_forbidden(scene) {
        return;
    }
    let (rule, pendulum) = (scene.question.watched(), scene.build.pendulum());
    swatch(ui, colours.ground().forbidden, "too little energy ever to flip");
    ui.label(bound_words(rule, &pendulum));
    if !scene.plane.is_at_rest() {
        return;
    }
    let line = colour_words(colours.ground().curve);
    ui.label(format!("The {line} line around these starts is where the two are equal."));
    ui.monospace(curve_words(rule, &pendulum));
    let share = 100.0 * forbidden_share(rule, &pendulum);
    ui.label(format!("That is {share:.2} % of the whole torus, and costs no computation."));
}

/// Describes why starts are forbidden.
fn bound_words(rule: Rule, pendulum: &Pendulum<f64>) -> String {
    let second_is_cheaper = pendulum.p >= pendulum.q;
    let pose = match rule {
        Rule::Second => "the second rod upright and the first hanging",
        Rule::First => "the first rod upright and the second hanging",
        _ if second_is_cheaper => "the second rod upright and the first hanging, the cheaper way,",
        _ => "the first rod upright and the second hanging, the cheaper way,",
    };
    format!(
        "Even with {pose} the potential energy would exceed what they begin with. That is a \
         theorem: none of them has to be integrated."
    )
}

/// Formats the condition for forbidden starts with as few numbers as possible: 2cos θ1 + cos θ2 > 1
/// for equal bobs, 3cos θ1 + cos θ2 > 2 for equal bars.
fn curve_words(rule: Rule, pendulum: &Pendulum<f64>) -> String {
    let (ratio, bound) = ratios(rule, pendulum);
    format!("forbidden: {} cos θ1 + cos θ2 > {}", plain(ratio, 3), plain(bound, 3))
}

/// Returns P and the bound on the depth, both divided by Q.
fn ratios(rule: Rule, pendulum: &Pendulum<f64>) -> (f64, f64) {
    (pendulum.p / pendulum.q, pendulum.least_depth(rule) / pendulum.q)
}

/// Returns the fraction of the torus that is forbidden under a rule for pendulums released from
/// rest.
pub(crate) fn forbidden_share(rule: Rule, pendulum: &Pendulum<f64>) -> f64 {
    const STEPS: u32 = 20_000;
    let (ratio, bound) = ratios(rule, pendulum);
    let strip = |k: u32| {
        let theta1 = (f64::from(k) + 0.5) / f64::from(STEPS) * std::f64::consts::PI;
        (bound - ratio * theta1.cos()).clamp(-1.0, 1.0).acos() / std::f64::consts::PI
    };
    (0..STEPS).map(strip).sum::<f64>() / f64::from(STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::PendulumSpec;

    fn pendulum(kind: Kind) -> Pendulum<f64> {
        PendulumSpec { kind, ..PendulumSpec::default() }.pendulum()
    }

    #[test]
    fn the_forbidden_shares_are_the_known_ones() {
        let share = |kind| forbidden_share(Rule::Second, &pendulum(kind));
        assert!((share(Kind::Rods) - 0.2439).abs() < 5e-5, "{}", share(Kind::Rods));
        assert!((share(Kind::Points) - 0.306_436).abs() < 5e-6, "{}", share(Kind::Points));
        // For the other rules, the forbidden starts are counted pixel by pixel.
        for rule in [Rule::First, Rule::Either] {
            let pendulum = pendulum(Kind::Points);
            let angle = |k: u32| (f64::from(k) + 0.5) / 600.0 * std::f64::consts::TAU;
            let starts = (0..600 * 600).map(|k| [angle(k % 600), angle(k / 600)]);
            let count = starts.filter(|&start| pendulum.forbids(rule, start)).count();
            let counted = count as f64 / 360_000.0;
            assert!((forbidden_share(rule, &pendulum) - counted).abs() < 1e-3, "{rule}");
        }
    }

    #[test]
    fn the_formulas_are_those_of_the_lesson() {
        let words = |rule, kind| curve_words(rule, &pendulum(kind));
        assert_eq!(words(Rule::Second, Kind::Points), "forbidden: 2 cos θ1 + cos θ2 > 1");
        assert_eq!(words(Rule::Second, Kind::Rods), "forbidden: 3 cos θ1 + cos θ2 > 2");
        assert_eq!(words(Rule::First, Kind::Points), "forbidden: 2 cos θ1 + cos θ2 > −1");
    }
}
