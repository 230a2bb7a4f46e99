//! The matrix equation M α = τ in symbols, with the numbers of a moment, and with their values.

use super::double_simulation::DoublePendulumSimulation;
use super::drawing::Tint;
use super::expression::{Expression, Filling, FormulaSymbol, Moment};
use super::formula::{Fence, Formula};
use flipmap_numbers::number_text::fixed;
use flipmap_pendulum::pendulum::Equation;
use flipmap_scene::Kind;

/// The entries of the equation.
struct Entries {
    /// M, row by row.
    mass: [[Expression; 2]; 2],
    /// τ.
    torque: [Expression; 2],
}

/// Returns the entries for bobs on massless rods, or for uniform bars, whose centres of mass and
/// moments of inertia bring the divisors 2 and 3.
fn entries(kind: Kind) -> Entries {
    let [half, third] = match kind {
        Kind::Points => [1, 1],
        Kind::Rods => [2, 3],
    };
    let [m1, m2] = [0, 1].map(|bob| Expression::from(FormulaSymbol::Mass(bob)));
    let [l1, l2] = [0, 1].map(|bob| Expression::from(FormulaSymbol::Length(bob)));
    let [w1, w2] = [0, 1].map(|bob| Expression::from(FormulaSymbol::Speed(bob)));
    let [sin1, sin2] = [0, 1].map(|bob| Expression::Sine(FormulaSymbol::Angle(bob)));
    let (g, sine) =
        (Expression::from(FormulaSymbol::Gravity), Expression::Sine(FormulaSymbol::Difference));
    let cross = (m2.clone() * l1.clone() * l2.clone()).over(half);
    let coupling = cross.clone() * Expression::Cosine(FormulaSymbol::Difference);
    let all = |divisor| m1.clone().over(divisor) + m2.clone();
    Entries {
        mass: [
            [all(third) * l1.clone().squared(), coupling.clone()],
            [coupling, (m2.clone() * l2.clone().squared()).over(third)],
        ],
        torque: [
            -(cross.clone() * sine.clone() * w2.squared()) - all(half) * g.clone() * l1 * sin1,
            cross * sine * w1.squared() - (m2.clone() * g * l2).over(half) * sin2,
        ],
    }
}

/// Returns the equation at a simulation's current moment, as it is printed.
pub(super) fn formula(simulation: &DoublePendulumSimulation, tint: &Tint) -> Formula {
    let (build, state) = (simulation.build, simulation.now());
    let moment = Moment { build, state, acceleration: build.pendulum().acceleration(&state) };
    let Entries { mass, torque } = entries(build.kind);
    let entry = |expression: &Expression| entry(expression, &moment, tint);
    let mass = mass.each_ref().map(|row| row.each_ref().map(entry).to_vec());
    let column = |entries: [Formula; 2]| Formula::Matrix(entries.map(|entry| vec![entry]).to_vec());
    let alpha = [0, 1].map(|bob| {
        let symbol = FormulaSymbol::Acceleration(bob);
        // Its number is its value, so the line in between is empty.
        let blank = Formula::text(" ", tint.ink);
        Formula::Lines(vec![symbol.formula(tint), blank, value(symbol.value(&moment), tint)])
    });
    Formula::Row(vec![
        Formula::Matrix(mass.to_vec()).fenced(Fence::Square),
        column(alpha).fenced(Fence::Square),
        Formula::text(" = ", tint.ink),
        column(torque.each_ref().map(entry)).fenced(Fence::Square),
    ])
}

/// Returns an entry in symbols, in numbers, and with its value.
fn entry(expression: &Expression, moment: &Moment, tint: &Tint) -> Formula {
    let written = |filling| Box::new(expression.formula(filling, tint));
    let room = written(Filling::Widest(moment));
    Formula::Lines(vec![
        *written(Filling::Symbols),
        Formula::Within { room, shown: written(Filling::Numbers(moment)) },
        value(expression.value(moment), tint),
    ])
}

/// Returns a value after a sign of equality.
fn value(value: f64, tint: &Tint) -> Formula {
    let text = |number: &str| Box::new(Formula::text(format!("= {number}"), tint.ink));
    Formula::Within { room: text("−000.000"), shown: text(&fixed(value, 3)) }
}

/// Returns M α = τ.
pub(super) fn short(tint: &Tint) -> Formula {
    let letter = |letter: &str| Formula::variable(letter, None, tint.ink);
    let equals = Formula::text(" = ", tint.ink);
    Formula::Row(vec![letter("M"), letter(" α"), equals, letter("τ")])
}

/// Describes the equation for a screen reader.
pub(super) fn told(simulation: &DoublePendulumSimulation) -> String {
    let (pendulum, state) = (simulation.pendulum(), simulation.now());
    let Equation { mass: [[m11, m12], [m21, m22]], torque } = pendulum.equation(&state);
    let [m11, m12, m21, m22] = [m11, m12, m21, m22].map(|x| fixed(x, 3));
    let [accelerations, torques] =
        [pendulum.acceleration(&state), torque].map(|pair| pair.map(|x| fixed(x, 3)).join(", "));
    format!("M is {m11}, {m12}; {m21}, {m22}. Accelerations {accelerations}. Torques {torques}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Context, RawInput};
    use flipmap_pendulum::State;
    use flipmap_scene::PendulumSpec;

    #[test]
    fn the_formulas_are_the_equation_that_is_computed() {
        let state = State { angle: [1.1, -2.3], speed: [3.0, -4.0] };
        for kind in [Kind::Points, Kind::Rods] {
            let build = PendulumSpec::new(kind, [1.5, 0.7], [0.8, 1.3], 9.81);
            let pendulum = build.pendulum();
            let moment = Moment { build, state, acceleration: pendulum.acceleration(&state) };
            let known = pendulum.equation(&state);
            let Entries { mass, torque } = entries(kind);
            let ours = mass.as_flattened().iter().chain(&torque);
            let known = known.mass.as_flattened().iter().chain(&known.torque);
            for (entry, known) in ours.zip(known) {
                let value = entry.value(&moment);
                assert!(
                    (value - known).abs() < 1e-9,
                    "{kind:?}: {entry:?} is {value}, not {known}"
                );
            }
        }
    }

    /// Lays out the equation of a fast pendulum for a width, and returns its width and height.
    fn size(kind: Kind, width: f32, speeds: [f64; 2]) -> [f32; 2] {
        let mut simulation = DoublePendulumSimulation::from([2.0, 2.6]);
        simulation.build.kind = kind;
        simulation.release(State { angle: [-2.6, -1.7], speed: speeds });
        let (ctx, mut size) = (Context::default(), [0.0; 2]);
        crate::typeface::install(&ctx);
        // Nothing draws the textures.
        ctx.run_ui(RawInput::default(), |ui| {
            let formula = formula(&simulation, &Tint::DARK);
            let laid = formula.fitted(ui.painter(), width, 14.0, Tint::DARK.ink);
            size = [laid.width, laid.height()];
        })
        .textures_delta
        .clear();
        size
    }

    #[test]
    fn the_equation_fits_its_room_and_keeps_its_size_while_numbers_change() {
        for kind in [Kind::Points, Kind::Rods] {
            let [wide, narrow] = [900.0, 616.0].map(|width| size(kind, width, [-12.25, -31.5]));
            assert!(wide[0] <= 900.0 && narrow[0] <= 616.0, "{wide:?} {narrow:?}");
            assert!(narrow[1] < wide[1] && narrow[0] > 0.9 * 616.0, "it is scaled as a whole");
            assert_eq!(wide, size(kind, 900.0, [0.0, 0.5]));
        }
    }
}
