//! The matrix equation M α = τ in symbols, and with the numbers of a moment in their place.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, Painter, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::controls::brief;
use super::double_simulation::DoublePendulumSimulation;
use super::drawing::{Tint, wrapped};
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

/// Height of the equation in points.
pub(super) const HEIGHT: f32 = 132.0;
/// Height of a line of text in points.
const LINE: f32 = 18.0;
/// Shares of the width: two columns of M, then α and τ.
const COLUMNS: [f32; 4] = [0.19, 0.23, 0.13, 0.45];
/// Largest font size in points.
const LETTER: f32 = 14.0;

/// The numbers that the symbols of a formula stand for.
struct Moment {
    build: PendulumSpec,
    state: State<f64>,
    acceleration: [f64; 2],
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

/// Lays out a formula in the colours of its parts, with its symbols or with the numbers of a moment
/// in their place.
fn written(formula: &str, moment: Option<&Moment>, tint: &Tint, letter: f32) -> LayoutJob {
    let mut job = LayoutJob::default();
    let font = FontId::proportional(letter);
    for (piece, is_symbol) in pieces(formula) {
        let colour = if is_symbol { part_colour(&piece, tint) } else { tint.ink };
        let text = match moment {
            Some(moment) if is_symbol => number_words(&piece, moment.value(&piece)),
            Some(_) => piece,
            None => piece.replace('·', " "),
        };
        job.append(&text, 0.0, TextFormat::simple(font.clone(), colour));
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

/// Formats a number that replaces a symbol; a number that changes in time has two decimals, so that
/// the layout jumps little.
fn number_words(symbol: &str, value: f64) -> String {
    let moves = symbol.starts_with(['θ', 'ω', 'α', 'Δ']);
    let text = if moves { format!("{value:.2}") } else { brief(value) };
    if value < 0.0 { format!("({})", text.replace('-', "−")) } else { text }
}

/// An entry of the equation, with its formula and its value.
struct Term<'a> {
    formula: &'a str,
    value: f64,
}

/// Shows the equation of a simulation's current moment.
pub(super) fn show(ui: &mut Ui, width: f32, simulation: &DoublePendulumSimulation) {
    let (response, painter) = ui.allocate_painter(vec2(width, HEIGHT), Sense::hover());
    let (build, state) = (simulation.build, simulation.now());
    let pendulum = build.pendulum();
    let Equation { mass, torque } = pendulum.equation(&state);
    let moment = Moment { build, state, acceleration: pendulum.acceleration(&state) };
    response.widget_info(|| {
        let told = format!(
            "M is {:.3}, {:.3}; {:.3}, {:.3}. Accelerations {:.3}, {:.3}. Torques {:.3}, {:.3}",
            mass[0][0],
            mass[0][1],
            mass[1][0],
            mass[1][1],
            moment.acceleration[0],
            moment.acceleration[1],
            torque[0],
            torque[1],
        );
        WidgetInfo::labeled(Role::Image, true, told)
    });
    let [m11, m12, m22, tau1, tau2] = formulas(build.kind);
    let rows = [
        [(m11, mass[0][0]), (m12, mass[0][1]), ("α1", moment.acceleration[0]), (tau1, torque[0])],
        [(m12, mass[1][0]), (m22, mass[1][1]), ("α2", moment.acceleration[1]), (tau2, torque[1])],
    ];
    let rows = rows.map(|row| row.map(|(formula, value)| Term { formula, value }));
    draw(&painter, response.rect, &Tint::of(ui), &moment, &rows);
}

fn formulas(kind: Kind) -> Formulas {
    match kind {
        Kind::Points => POINTS,
        Kind::Rods => RODS,
    }
}

fn draw(painter: &Painter, area: Rect, tint: &Tint, moment: &Moment, rows: &[[Term; 4]; 2]) {
    let width = area.width() - 12.0;
    let mut left = area.left() + 6.0;
    for (column, share) in COLUMNS.into_iter().enumerate() {
        // The columns of M share a pair of brackets, and the equals sign precedes τ.
        let gap = if column == 1 { 2.0 } else { 18.0 };
        let room = share * width - gap;
        let middle = left + 0.5 * (share * width + gap);
        for (row, cells) in rows.iter().enumerate() {
            let top = area.top() + 4.0 + row as f32 * (3.0 * LINE + 6.0);
            lines(painter, pos2(middle, top), room, tint, moment, &cells[column]);
        }
        let [from, to] = [middle - 0.5 * room, middle + 0.5 * room];
        let ends = [(column != 1).then_some(from), (column != 0).then_some(to)];
        bracket(painter, area, ends, tint);
        if column == 3 {
            let at = pos2(from - 10.0, area.center().y);
            let font = FontId::proportional(LETTER + 2.0);
            painter.text(at, egui::Align2::CENTER_CENTER, "=", font, tint.ink);
        }
        left += share * width;
    }
}

/// Writes the lines of a cell, centred: symbols, numbers in their place, and the value.
fn lines(painter: &Painter, top: Pos2, room: f32, tint: &Tint, moment: &Moment, cell: &Term) {
    let layout = |letter: f32| {
        let symbols = written(cell.formula, None, tint, letter);
        let numbers = written(cell.formula, Some(moment), tint, letter);
        let value = format!("= {:.3}", cell.value).replace('-', "−");
        let value = LayoutJob::simple_singleline(value, FontId::proportional(letter), tint.ink);
        // The number in place of an acceleration's symbol is already its value.
        let jobs = if cell.formula.starts_with('α') {
            vec![symbols, numbers]
        } else {
            vec![symbols, numbers, value]
        };
        jobs.into_iter().map(|job| painter.layout_job(job)).collect::<Vec<_>>()
    };
    let widest = layout(LETTER).iter().map(|line| line.size().x).fold(1.0, f32::max);
    let letter = LETTER * ((room - 8.0) / widest).clamp(0.4, 1.0);
    let galleys = layout(letter.floor().max(7.0));
    let first = top.y + if galleys.len() == 2 { 0.5 * LINE } else { 0.0 };
    for (k, galley) in galleys.into_iter().enumerate() {
        let at = pos2(top.x - 0.5 * galley.size().x, first + k as f32 * LINE);
        painter.galley(at, galley, tint.ink);
    }
}

/// Draws the left or right bracket of a matrix, or both.
fn bracket(painter: &Painter, area: Rect, [left, right]: [Option<f32>; 2], tint: &Tint) {
    let stroke = Stroke::new(1.5, tint.ink);
    for (x, hook) in [(left, 5.0), (right, -5.0)] {
        let Some(x) = x else { continue };
        let (top, bottom) = (area.top() + 2.0, area.bottom() - 8.0);
        painter.line_segment([pos2(x, top), pos2(x, bottom)], stroke);
        for y in [top, bottom] {
            painter.line_segment([pos2(x, y), pos2(x + hook, y)], stroke);
        }
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
        let text = |moment| written("m2·l1²·sin Δ·ω2", moment, &Tint::DARK, 14.0);
        assert_eq!(text(None).text, "m2 l1² sin Δ ω2");
        let numbers = text(Some(&moment));
        assert_eq!(numbers.text, "1·1²·sin (−1.50)·(−1.00)");
        let colours: Vec<Color32> = numbers.sections.iter().map(|part| part.format.color).collect();
        let (first, second, ink) = (Tint::DARK.parts[0], Tint::DARK.parts[1], Tint::DARK.ink);
        assert_eq!(colours, [second, ink, first, ink, second]);
    }
}
