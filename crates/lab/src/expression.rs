//! Expressions in the symbols of the equations of motion: each has a value at a moment, and is
//! printed in symbols or in numbers.

use std::ops::{Add, Mul, Neg, Sub};

use egui::Color32;

use super::drawing::{Tint, wrapped};
use super::formula::{Fence, Formula};
use flipmap_numbers::number_text::{brief, fixed};
use flipmap_pendulum::State;
use flipmap_scene::PendulumSpec;

/// A quantity of the double pendulum; the number is 0 for the first bob and 1 for the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FormulaSymbol {
    Mass(usize),
    Length(usize),
    Angle(usize),
    Speed(usize),
    Acceleration(usize),
    /// Δ = θ1 − θ2.
    Difference,
    Gravity,
}

/// The numbers that symbols stand for.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    /// The pendulum.
    pub build: PendulumSpec,
    /// Its angles and speeds.
    pub state: State<f64>,
    /// Its accelerations in rad/s².
    pub acceleration: [f64; 2],
}

impl FormulaSymbol {
    /// Returns the number that the symbol stands for, angles from −π to π.
    pub(crate) fn value(self, moment: &Moment) -> f64 {
        let State { angle, speed } = moment.state;
        match self {
            FormulaSymbol::Mass(bob) => moment.build.masses_kg()[bob],
            FormulaSymbol::Length(bob) => moment.build.lengths_m()[bob],
            FormulaSymbol::Angle(bob) => wrapped(angle[bob]),
            FormulaSymbol::Speed(bob) => speed[bob],
            FormulaSymbol::Acceleration(bob) => moment.acceleration[bob],
            FormulaSymbol::Difference => wrapped(angle[0] - angle[1]),
            FormulaSymbol::Gravity => moment.build.gravity.value(),
        }
    }

    /// Returns the symbol as it is printed, in the colour of its part.
    pub(crate) fn formula(self, tint: &Tint) -> Formula {
        let (letter, bob) = match self {
            FormulaSymbol::Mass(bob) => ("m", Some(bob)),
            FormulaSymbol::Length(bob) => ("l", Some(bob)),
            FormulaSymbol::Angle(bob) => ("θ", Some(bob)),
            FormulaSymbol::Speed(bob) => ("ω", Some(bob)),
            FormulaSymbol::Acceleration(bob) => ("α", Some(bob)),
            FormulaSymbol::Difference => ("Δ", None),
            FormulaSymbol::Gravity => ("g", None),
        };
        let index = bob.map(|bob| ["1", "2"][bob]);
        Formula::variable(letter, index, self.colour(tint))
    }

    /// Returns the colour of the part that the symbol belongs to.
    fn colour(self, tint: &Tint) -> Color32 {
        match self {
            FormulaSymbol::Mass(bob)
            | FormulaSymbol::Length(bob)
            | FormulaSymbol::Angle(bob)
            | FormulaSymbol::Speed(bob)
            | FormulaSymbol::Acceleration(bob) => tint.parts[bob],
            FormulaSymbol::Gravity => tint.parts[2],
            FormulaSymbol::Difference => tint.ink,
        }
    }

    /// Returns true if the symbol's number changes in time.
    fn moves(self) -> bool {
        match self {
            FormulaSymbol::Mass(_) | FormulaSymbol::Length(_) | FormulaSymbol::Gravity => false,
            FormulaSymbol::Angle(_)
            | FormulaSymbol::Speed(_)
            | FormulaSymbol::Acceleration(_)
            | FormulaSymbol::Difference => true,
        }
    }
}

/// What is printed in the places of symbols.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Filling<'a> {
    /// The symbols themselves.
    Symbols,
    /// The numbers of a moment.
    Numbers(&'a Moment),
    /// The widest numbers that are usual.
    Widest(&'a Moment),
}

/// An expression in symbols.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expression {
    Symbol(FormulaSymbol),
    /// Terms, each with a sign of its own.
    Sum(Vec<Expression>),
    Minus(Box<Expression>),
    Product(Vec<Expression>),
    Square(Box<Expression>),
    /// An expression divided by a whole number.
    Over(Box<Expression>, u32),
    Sine(FormulaSymbol),
    Cosine(FormulaSymbol),
}

impl From<FormulaSymbol> for Expression {
    fn from(symbol: FormulaSymbol) -> Self {
        Expression::Symbol(symbol)
    }
}

impl Add for Expression {
    type Output = Expression;
    fn add(self, other: Expression) -> Expression {
        match self {
            Expression::Sum(mut terms) => {
                terms.push(other);
                Expression::Sum(terms)
            }
            first => Expression::Sum(vec![first, other]),
        }
    }
}

impl Sub for Expression {
    type Output = Expression;
    fn sub(self, other: Expression) -> Expression {
        self + -other
    }
}

impl Neg for Expression {
    type Output = Expression;
    fn neg(self) -> Expression {
        Expression::Minus(Box::new(self))
    }
}

impl Mul for Expression {
    type Output = Expression;
    fn mul(self, other: Expression) -> Expression {
        match self {
            Expression::Product(mut factors) => {
                factors.push(other);
                Expression::Product(factors)
            }
            first => Expression::Product(vec![first, other]),
        }
    }
}

impl Expression {
    /// Returns the square of the expression.
    pub(crate) fn squared(self) -> Self {
        Expression::Square(Box::new(self))
    }

    /// Returns the expression divided by a whole number; by 1 it stays as it is.
    pub(crate) fn over(self, divisor: u32) -> Self {
        if divisor == 1 { self } else { Expression::Over(Box::new(self), divisor) }
    }

    /// Returns true for a sine and a cosine, which take more room than other factors.
    fn is_function(&self) -> bool {
        matches!(self, Expression::Sine(_) | Expression::Cosine(_))
    }

    /// Returns the value at a moment.
    pub(crate) fn value(&self, moment: &Moment) -> f64 {
        match self {
            Expression::Symbol(symbol) => symbol.value(moment),
            Expression::Sum(terms) => terms.iter().map(|term| term.value(moment)).sum(),
            Expression::Minus(inner) => -inner.value(moment),
            Expression::Product(factors) => {
                factors.iter().map(|factor| factor.value(moment)).product()
            }
            Expression::Square(inner) => inner.value(moment).powi(2),
            Expression::Over(inner, divisor) => inner.value(moment) / f64::from(*divisor),
            Expression::Sine(symbol) => symbol.value(moment).sin(),
            Expression::Cosine(symbol) => symbol.value(moment).cos(),
        }
    }

    /// Returns the expression as it is printed.
    pub(crate) fn formula(&self, filling: Filling, tint: &Tint) -> Formula {
        let ink = |text: &str| Formula::text(text, tint.ink);
        match self {
            Expression::Symbol(symbol) => filled(*symbol, filling, tint),
            Expression::Sum(terms) => {
                let mut parts = Vec::new();
                for (k, term) in terms.iter().enumerate() {
                    let (sign, term) = match term {
                        Expression::Minus(inner) => ("−", &**inner),
                        term => ("+", term),
                    };
                    match (k, sign) {
                        (0, "+") => {}
                        (0, _) => parts.push(ink("−")),
                        _ => parts.push(ink(&format!(" {sign} "))),
                    }
                    parts.push(term.formula(filling, tint));
                }
                Formula::Row(parts)
            }
            Expression::Minus(inner) => Formula::Row(vec![ink("−"), inner.formula(filling, tint)]),
            Expression::Product(factors) => {
                let mut parts = Vec::new();
                for (k, factor) in factors.iter().enumerate() {
                    if k > 0 {
                        let is_wide = factors[k - 1..=k].iter().any(Expression::is_function);
                        parts.push(ink(match (filling, is_wide) {
                            (Filling::Symbols, true) => " ",
                            (Filling::Symbols, false) => "\u{2009}",
                            (Filling::Numbers(_) | Filling::Widest(_), _) => "·",
                        }));
                    }
                    let part = factor.formula(filling, tint);
                    let is_sum = matches!(factor, Expression::Sum(_));
                    parts.push(if is_sum { part.fenced(Fence::Round) } else { part });
                }
                Formula::Row(parts)
            }
            Expression::Square(inner) => inner.formula(filling, tint).with_exponent("2", tint.ink),
            Expression::Over(inner, divisor) => {
                inner.formula(filling, tint).over(ink(&divisor.to_string()))
            }
            Expression::Sine(symbol) => {
                Formula::Row(vec![ink("sin "), filled(*symbol, filling, tint)])
            }
            Expression::Cosine(symbol) => {
                Formula::Row(vec![ink("cos "), filled(*symbol, filling, tint)])
            }
        }
    }
}

/// Returns a symbol, or the number in its place, in the symbol's colour.
fn filled(symbol: FormulaSymbol, filling: Filling, tint: &Tint) -> Formula {
    let number = |moment: &Moment| {
        let value = symbol.value(moment);
        let text = if symbol.moves() { fixed(value, 2) } else { brief(value) };
        if text.starts_with('−') { format!("({text})") } else { text }
    };
    let text = match filling {
        Filling::Symbols => return symbol.formula(tint),
        Filling::Widest(_) if symbol.moves() => "(−00.00)".to_string(),
        Filling::Numbers(moment) | Filling::Widest(moment) => number(moment),
    };
    Formula::text(text, symbol.colour(tint))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the texts of a formula in order.
    fn texts(formula: &Formula) -> Vec<(String, Color32)> {
        let all = |parts: &[&Formula]| parts.iter().flat_map(|part| texts(part)).collect();
        match formula {
            Formula::Text { text, colour, .. } => vec![(text.clone(), *colour)],
            Formula::Row(parts) | Formula::Lines(parts) => all(&parts.iter().collect::<Vec<_>>()),
            Formula::Scripts { base, below, above } => {
                let scripts = [below, above].into_iter().flatten().map(|part| &**part);
                all(&[&**base].into_iter().chain(scripts).collect::<Vec<_>>())
            }
            Formula::Fraction(above, below) => all(&[above, below]),
            Formula::Root(inner) | Formula::Fenced(_, inner) => texts(inner),
            Formula::Matrix(rows) => all(&rows.iter().flatten().collect::<Vec<_>>()),
            Formula::Within { shown, .. } => texts(shown),
        }
    }

    #[test]
    fn numbers_take_the_places_and_the_colours_of_symbols() {
        let state = State { angle: [0.5, 2.0], speed: [0.0, -1.0] };
        let moment = Moment { build: PendulumSpec::default(), state, acceleration: [0.0; 2] };
        let [m2, l1, w2] =
            [FormulaSymbol::Mass(1), FormulaSymbol::Length(0), FormulaSymbol::Speed(1)]
                .map(Expression::from);
        let product = m2 * l1.squared() * Expression::Sine(FormulaSymbol::Difference) * w2;
        let written = |filling| {
            let parts = texts(&product.formula(filling, &Tint::DARK));
            parts.into_iter().map(|(text, _)| text).collect::<String>()
        };
        assert_eq!(written(Filling::Symbols), "m2\u{2009}l12 sin Δ ω2");
        assert_eq!(written(Filling::Numbers(&moment)), "1·12·sin (−1.50)·(−1.00)");
        let colours: Vec<Color32> = texts(&product.formula(Filling::Numbers(&moment), &Tint::DARK))
            .into_iter()
            .filter(|(text, _)| text != "·")
            .map(|(_, colour)| colour)
            .collect();
        let (first, second, ink) = (Tint::DARK.parts[0], Tint::DARK.parts[1], Tint::DARK.ink);
        assert_eq!(colours, [second, first, ink, ink, ink, second]);
        assert!((product.value(&moment) - 1.5f64.sin()).abs() < 1e-15);
    }
}
