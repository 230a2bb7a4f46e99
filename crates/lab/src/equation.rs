//! The matrix equation M α = τ in symbols, and with the numbers of a moment in their place.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId};

use super::drawing::{LETTER, Tint, wrapped};
use flipmap_numbers::number_text::{brief, fixed};
use flipmap_pendulum::State;
use flipmap_pendulum::pendulum::Equation;
use flipmap_scene::{Kind, PendulumSpec};

/// The five different entries of the equation as formulas: M11, M12, M22, τ1 and τ2. A dot means
/// multiplication, and Δ is θ1 − θ2.
type Formulas = [&'static str; 5];

/// The formulas for bobs on massless rods.
const POINTS: Formulas = [
    "(m1 + m2)·l1²",
    "m2·l1·l2·cos Δ",
    "m2·l2²",
    "−m2·l1·l2·sin Δ·ω2² − (m1 + m2)·g·l1·sin θ1",
    "m2·l1·l2·sin Δ·ω1² − m2·g·l2·sin θ2",
];
/// The formulas for uniform bars.
const RODS: Formulas = [
    "(m1/3 + m2)·l1²",
    "m2·l1·l2/2·cos Δ",
    "m2·l2²/3",
    "−m2·l1·l2/2·sin Δ·ω2² − (m1/2 + m2)·g·l1·sin θ1",
    "m2·l1·l2/2·sin Δ·ω1² − m2·g·l2/2·sin θ2",
];

/// The numbers that the symbols of a formula stand for.
pub(super) struct Moment {
    /// The pendulum.
    pub build: PendulumSpec,
    /// Its angles and speeds.
    pub state: State<f64>,
    /// Its accelerations in rad/s².
    pub acceleration: [f64; 2],
}

impl Moment {
    /// Returns the number that a symbol stands for.
    fn value(&self, symbol: &str) -> f64 {
        let State { angle, speed } = self.state;
        let pair = match symbol.chars().next() {
            Some('m') => self.build.masses_kg(),
            Some('l') => self.build.lengths_m(),
            Some('θ') => angle.map(wrapped),
            Some('ω') => speed,
            Some('α') => self.acceleration,
            Some('Δ') => [wrapped(angle[0] - angle[1]); 2],
            _ => [self.build.gravity.value(); 2],
        };
        pair[usize::from(symbol.ends_with('2'))]
    }
}

/// Splits a formula into symbols (true) and the text between them (false).
fn pieces(formula: &str) -> Vec<(String, bool)> {
    let mut pieces: Vec<(String, bool)> = Vec::new();
    let mut letters = formula.chars().peekable();
    while let Some(letter) = letters.next() {
        let is_numbered = "mlθωα".contains(letter)
            && letters.peek().is_some_and(|next| ['1', '2'].contains(next));
        let mut piece = letter.to_string();
        if is_numbered {
            piece.extend(letters.next());
        }
        let is_symbol = is_numbered || "gΔ".contains(letter);
        match pieces.last_mut() {
            Some((text, false)) if !is_symbol => text.push(letter),
            _ => pieces.push((piece, is_symbol)),
        }
    }
    pieces
}

/// What is written in the places of symbols.
#[derive(Clone, Copy)]
pub(super) enum Filling<'a> {
    /// The symbols themselves.
    Symbols,
    /// The numbers of a moment.
    Numbers(&'a Moment),
    /// The widest numbers that are usual, so that columns keep their width while numbers change.
    Widest(&'a Moment),
}

/// Lays out a formula in the colours of its parts.
fn written(formula: &str, filling: Filling, tint: &Tint) -> LayoutJob {
    let mut job = LayoutJob::default();
    for (piece, is_symbol) in pieces(formula) {
        let colour = if is_symbol { part_colour(&piece, tint) } else { tint.ink };
        let text = match filling {
            Filling::Symbols => piece.replace('·', " "),
            Filling::Widest(_) if is_symbol && moves(&piece) => "(−00.00)".to_string(),
            Filling::Widest(moment) | Filling::Numbers(moment) if is_symbol => {
                number_words(&piece, moment.value(&piece))
            }
            _ => piece,
        };
        let format = TextFormat::simple(FontId::proportional(LETTER), colour);
        job.append(&text, 0.0, format);
    }
    job
}

/// Returns the colour of the part that a symbol belongs to.
fn part_colour(symbol: &str, tint: &Tint) -> Color32 {
    match symbol.chars().last() {
        Some('1') => tint.parts[0],
        Some('2') => tint.parts[1],
        Some('g') => tint.parts[2],
        _ => tint.ink,
    }
}

/// Returns true if a symbol's number changes in time.
fn moves(symbol: &str) -> bool {
    symbol.starts_with(['θ', 'ω', 'α', 'Δ'])
}

/// Formats a number that replaces a symbol.
fn number_words(symbol: &str, value: f64) -> String {
    let text = if moves(symbol) { fixed(value, 2) } else { brief(value) };
    if text.starts_with('−') { format!("({text})") } else { text }
}

/// An entry of the equation, with its formula and its value.
pub(super) struct Term {
    formula: &'static str,
    value: f64,
}

impl Term {
    /// Returns the lines of the entry: symbols, numbers in their place, and the value. A sum takes a
    /// line for each of its two parts if it is `broken`.
    pub(super) fn lines(&self, filling: Filling, broken: bool, tint: &Tint) -> Vec<LayoutJob> {
        let split = self.formula.find(" − ").filter(|_| broken);
        let (first, second) = self.formula.split_at(split.unwrap_or(self.formula.len()));
        let parts = [first, second.trim_start()];
        let all = |filling| {
            let parts = parts.into_iter().filter(|part| !part.is_empty());
            parts.map(move |part| written(part, filling, tint))
        };
        let mut lines: Vec<LayoutJob> = all(Filling::Symbols).collect();
        // The number in place of an acceleration's symbol is its value.
        if !self.formula.starts_with('α') {
            lines.extend(all(filling));
        }
        let value = match filling {
            Filling::Widest(_) => "= −000.000".to_string(),
            _ => format!("= {}", fixed(self.value, 3)),
        };
        let font = FontId::proportional(LETTER);
        lines.push(LayoutJob::simple_singleline(value, font, tint.ink));
        lines
    }
}

/// Returns the entries of M, α and τ, row by row.
pub(super) fn terms(
    kind: Kind,
    equation: &Equation<f64>,
    acceleration: [f64; 2],
) -> [[Term; 4]; 2] {
    let Equation { mass, torque } = equation;
    let [m11, m12, m22, tau1, tau2] = formulas(kind);
    let rows = [
        [(m11, mass[0][0]), (m12, mass[0][1]), ("α1", acceleration[0]), (tau1, torque[0])],
        [(m12, mass[1][0]), (m22, mass[1][1]), ("α2", acceleration[1]), (tau2, torque[1])],
    ];
    rows.map(|row| row.map(|(formula, value)| Term { formula, value }))
}

/// Describes the equation for a screen reader.
pub(super) fn told(equation: &Equation<f64>, acceleration: [f64; 2]) -> String {
    let Equation { mass: [[m11, m12], [m21, m22]], torque } = equation;
    let [[m11, m12], [m21, m22]] = [[m11, m12], [m21, m22]].map(|row| row.map(|x| fixed(*x, 3)));
    let [accelerations, torques] =
        [acceleration, *torque].map(|pair| pair.map(|x| fixed(x, 3)).join(", "));
    format!("M is {m11}, {m12}; {m21}, {m22}. Accelerations {accelerations}. Torques {torques}")
}

fn formulas(kind: Kind) -> Formulas {
    match kind {
        Kind::Points => POINTS,
        Kind::Rods => RODS,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the value of a formula at a moment; the formula is a sum of products of powers.
    fn value(formula: &str, moment: &Moment) -> f64 {
        let mut text = String::new();
        for (piece, is_symbol) in pieces(formula) {
            match is_symbol {
                true => text.push_str(&format!("{{{}}}", moment.value(&piece))),
                false => text.push_str(&piece),
            }
        }
        let mut sum = 0.0;
        let mut sign = 1.0;
        // The bracketed sum of masses is the only sum inside a product.
        for part in
            text.replace(" + m", "+m").split(' ').fold(vec![String::new()], |mut all, word| {
                let depth = all.last().unwrap().matches('(').count()
                    > all.last().unwrap().matches(')').count();
                match word {
                    "−" if !depth => all.extend(["−".to_string(), String::new()]),
                    "+" if !depth => all.extend(["+".to_string(), String::new()]),
                    word => *all.last_mut().unwrap() += &format!("{word} "),
                }
                all
            })
        {
            match part.trim() {
                "−" => sign = -1.0,
                "+" => sign = 1.0,
                product => sum += sign * product_value(product),
            }
        }
        sum
    }

    fn product_value(text: &str) -> f64 {
        let (sign, text) = text.strip_prefix('−').map_or((1.0, text), |rest| (-1.0, rest));
        text.split('·').map(|factor| factor_value(factor.trim())).product::<f64>() * sign
    }

    fn factor_value(text: &str) -> f64 {
        if let Some(inner) = text.strip_prefix('(') {
            let inner = inner.trim_end_matches([')', ' ']);
            return inner.split('+').map(|part| factor_value(part.trim())).sum();
        }
        let function = |name: &str| text.strip_prefix(name).map(|rest| factor_value(rest.trim()));
        if let Some(angle) = function("sin ") {
            return angle.sin();
        }
        if let Some(angle) = function("cos ") {
            return angle.cos();
        }
        if let Some((whole, divisor)) = text.split_once('/') {
            return factor_value(whole) / divisor.trim().parse::<f64>().unwrap();
        }
        if let Some(root) = text.strip_suffix('²') {
            return factor_value(root).powi(2);
        }
        text.trim_matches(['{', '}']).parse().unwrap()
    }

    #[test]
    fn the_formulas_are_the_equation_that_is_computed() {
        let state = State { angle: [1.1, -2.3], speed: [3.0, -4.0] };
        for kind in [Kind::Points, Kind::Rods] {
            let build = PendulumSpec::new(kind, [1.5, 0.7], [0.8, 1.3], 9.81);
            let pendulum = build.pendulum();
            let moment = Moment { build, state, acceleration: pendulum.acceleration(&state) };
            let Equation { mass, torque } = pendulum.equation(&state);
            let known = [mass[0][0], mass[0][1], mass[1][1], torque[0], torque[1]];
            for (formula, known) in formulas(kind).into_iter().zip(known) {
                let value = value(formula, &moment);
                assert!(
                    (value - known).abs() < 1e-9,
                    "{kind:?}: {formula} is {value}, not {known}"
                );
            }
        }
    }

    #[test]
    fn numbers_take_the_places_and_the_colours_of_symbols() {
        let state = State { angle: [0.5, 2.0], speed: [0.0, -1.0] };
        let moment = Moment { build: PendulumSpec::default(), state, acceleration: [0.0; 2] };
        let text = |filling| written("m2·l1²·sin Δ·ω2", filling, &Tint::DARK);
        assert_eq!(text(Filling::Symbols).text, "m2 l1² sin Δ ω2");
        let numbers = text(Filling::Numbers(&moment));
        assert_eq!(numbers.text, "1·1²·sin (−1.50)·(−1.00)");
        let colours: Vec<Color32> = numbers.sections.iter().map(|part| part.format.color).collect();
        let (first, second, ink) = (Tint::DARK.parts[0], Tint::DARK.parts[1], Tint::DARK.ink);
        assert_eq!(colours, [second, ink, first, ink, second]);
    }
}
