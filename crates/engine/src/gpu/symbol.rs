//! Symbols: numbers that record what is done to them, so that a kernel's maths is printed from the
//! equations in `flipmap_pendulum` and not written a second time.
//!
//! The equations are generic over their number type. A [`Symbol`] is an index into a tape, to which
//! every operator appends a node; run once on symbols, an equation leaves a list of operations,
//! which is printed as straight-line WGSL. Algorithmic differentiation records programs in the same
//! way (Griewank and Walther, *Evaluating Derivatives*, 2008).
//!
//! ```text
//!  x * y + (x * y) * 0.5   ──▶   0  x          ──▶
//!                                1  y
//!                                2  v0 * v1          let v2 = x * y;
//!                                3  0.5
//!                                4  v2 * v3          let v4 = v2 * 0.5f;
//!                                5  v2 + v4          let v5 = v2 + v4;
//! ```
//!
//! * Loops and decisions on plain Rust values (method, rule, coefficients) are resolved while
//!   recording: partial evaluation. Code that branches on the numbers themselves cannot run.
//! * Equal nodes are one node (value numbering), so common subexpressions are computed once.
//!   Operands are not sorted: `x * y` and `y * x` are two nodes.
//! * Operations on two literals are folded (in f64), and so are sums with 0, products with 0, 1 and
//!   −1, quotients by 1, double negatives, and sums with negatives. Numbers are taken to be finite;
//!   nothing is reassociated, so other roundings stay as they are.
//! * Nodes that no result needs are not printed. Operands precede their users on the tape.
//! * For pairs of f32, a product plus a term is one function. Its value is made `normal` again
//!   unless it is used only as the term of another, because terms that cancel can leave a first
//!   part no larger than the second.
//! * Error terms of sums pass through `guard`, because drivers fold them to zero otherwise.
//! * Operators are not inlined: a step has thousands, and it is recorded once.
//! * Every value is a scalar, which on software Vulkan is three times faster than the same maths in
//!   structs.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::shared::to_parts;
use crate::Precision;
use flipmap_numbers::trig::{
    PI_PARTS_F32, PI_PARTS_F64, Rounding, SERIES_F32, SERIES_F64, sin_cos_with,
};
use flipmap_numbers::{Angle, Real};

/// An operation on the tape, or one of its inputs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum SymbolNode {
    /// The bits of an f64.
    Literal(u64),
    /// A variable of the surrounding shader text.
    Variable(&'static str),
    /// An operator between two symbols.
    Binary(char, u32, u32),
    /// The negative of a symbol.
    Negative(u32),
    /// The first operand times the second plus the third, for pairs of f32.
    MultiplyAdd(u32, u32, u32),
    /// A function of symbols, from the shading language or from an included file.
    Call(&'static str, Vec<u32>),
    /// A rounded value that the optimiser must not see through.
    Guard(u32),
}

/// Properties that the surrounding shader text expects of the maths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dialect {
    /// The number type.
    pub precision: Precision,
    /// Spaces before each line.
    pub indent: &'static str,
}

/// The nodes recorded so far, each after its operands, and the index of every distinct one.
struct Tape {
    dialect: Dialect,
    nodes: Vec<SymbolNode>,
    known: HashMap<SymbolNode, u32>,
}

thread_local! {
    static TAPE: RefCell<Option<Tape>> = const { RefCell::new(None) };
}

/// A number that is not known yet, as the index of its node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Symbol(u32);

/// Shader text that computes results, one `let` for each operation and each result, and their names.
pub(crate) struct Maths {
    pub text: String,
    pub results: Vec<String>,
}

/// Runs `maths` on symbols, whose inputs it makes with [`variable`] and [`literal`].
pub(crate) fn write_maths(
    dialect: Dialect,
    maths: impl FnOnce() -> Vec<(String, Symbol)>,
) -> Maths {
    TAPE.with_borrow_mut(|tape| {
        assert!(tape.is_none(), "symbols of two kernels must not mix");
        *tape = Some(Tape { dialect, nodes: Vec::new(), known: HashMap::new() });
    });
    let results = maths();
    let text = TAPE.take().expect("set above").print(&results);
    Maths { text, results: results.into_iter().map(|(name, _)| name).collect() }
}

/// The shader variable `name`.
#[inline(never)]
pub(crate) fn variable(name: &'static str) -> Symbol {
    push(SymbolNode::Variable(name))
}

/// A known number.
#[inline(never)]
pub(crate) fn literal(value: f64) -> Symbol {
    push(SymbolNode::Literal(value.to_bits()))
}

/// The value of the shader function `name`.
pub(crate) fn call(name: &'static str, operands: &[Symbol]) -> Symbol {
    push(SymbolNode::Call(name, operands.iter().map(|operand| operand.0).collect()))
}

fn with_tape<R>(f: impl FnOnce(&mut Tape) -> R) -> R {
    TAPE.with_borrow_mut(|tape| f(tape.as_mut().expect("symbols live inside write_maths")))
}

fn push(node: SymbolNode) -> Symbol {
    with_tape(|tape| {
        if let Some(&index) = tape.known.get(&node) {
            return Symbol(index);
        }
        let index = tape.nodes.len() as u32;
        tape.nodes.push(node.clone());
        tape.known.insert(node, index);
        Symbol(index)
    })
}

impl Symbol {
    /// The absolute value.
    pub(crate) fn abs(self) -> Symbol {
        self.value().map_or_else(|| call("abs", &[self]), |value| literal(value.abs()))
    }

    /// The value of the symbol if it is a literal.
    fn value(self) -> Option<f64> {
        with_tape(|tape| match tape.nodes[self.0 as usize] {
            SymbolNode::Literal(bits) => Some(f64::from_bits(bits)),
            _ => None,
        })
    }

    /// The operand of the symbol if it is a negative.
    fn negated(self) -> Option<Symbol> {
        with_tape(|tape| match tape.nodes[self.0 as usize] {
            SymbolNode::Negative(inner) => Some(Symbol(inner)),
            _ => None,
        })
    }

    fn binary(self, operator: char, other: Symbol) -> Symbol {
        push(SymbolNode::Binary(operator, self.0, other.0))
    }
}

impl Add for Symbol {
    type Output = Symbol;
    #[inline(never)]
    fn add(self, other: Symbol) -> Symbol {
        match (self.value(), other.value()) {
            (Some(a), Some(b)) => literal(a + b),
            (Some(0.0), _) => other,
            (_, Some(0.0)) => self,
            _ => match other.negated() {
                Some(inner) => self - inner,
                None => self.binary('+', other),
            },
        }
    }
}

impl Sub for Symbol {
    type Output = Symbol;
    #[inline(never)]
    fn sub(self, other: Symbol) -> Symbol {
        match (self.value(), other.value()) {
            (Some(a), Some(b)) => literal(a - b),
            (Some(0.0), _) => -other,
            (_, Some(0.0)) => self,
            _ => match other.negated() {
                Some(inner) => self + inner,
                None => self.binary('-', other),
            },
        }
    }
}

impl Mul for Symbol {
    type Output = Symbol;
    #[inline(never)]
    fn mul(self, other: Symbol) -> Symbol {
        match (self.value(), other.value()) {
            (Some(a), Some(b)) => literal(a * b),
            (Some(factor), _) => other.scaled(factor),
            (_, Some(factor)) => self.scaled(factor),
            _ => self.binary('*', other),
        }
    }
}

impl Symbol {
    fn scaled(self, factor: f64) -> Symbol {
        match factor {
            0.0 => literal(0.0),
            1.0 => self,
            -1.0 => -self,
            _ => self.binary('*', literal(factor)),
        }
    }
}

impl Div for Symbol {
    type Output = Symbol;
    #[inline(never)]
    fn div(self, other: Symbol) -> Symbol {
        match (self.value(), other.value()) {
            (Some(a), Some(b)) => literal(a / b),
            (_, Some(1.0)) => self,
            _ => self.binary('/', other),
        }
    }
}

impl Neg for Symbol {
    type Output = Symbol;
    #[inline(never)]
    fn neg(self) -> Symbol {
        match (self.value(), self.negated()) {
            (Some(a), _) => literal(-a),
            (_, Some(inner)) => inner,
            _ => push(SymbolNode::Negative(self.0)),
        }
    }
}

impl Real for Symbol {
    #[inline(never)]
    fn lit(self, value: f64) -> Self {
        literal(value)
    }

    /// Records a product and a sum, because drivers fuse the two by themselves where they can.
    /// Pairs of f32 have one function for both.
    #[inline(never)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let is_pair = with_tape(|tape| tape.dialect.precision == Precision::Df32);
        let is_short = |factor: Symbol| matches!(factor.value(), Some(0.0 | 1.0 | -1.0));
        if !is_pair || is_short(self) || is_short(factor) || term.value() == Some(0.0) {
            return self * factor + term;
        }
        push(SymbolNode::MultiplyAdd(self.0, factor.0, term.0))
    }

    /// Passes every rounded value through `guard`, which no optimiser can see through.
    fn fast_two_sum(self, other: Self) -> (Self, Self) {
        let guard = |x: Symbol| push(SymbolNode::Guard(x.0));
        let sum = guard(self + other);
        (sum, other - guard(sum - self))
    }
}

impl Angle for Symbol {
    fn sin_cos(self) -> (Self, Self) {
        match with_tape(|tape| tape.dialect.precision) {
            Precision::F32 => sin_cos_with(self, PI_PARTS_F32, &SERIES_F32),
            Precision::F64 => sin_cos_with(self, PI_PARTS_F64, &SERIES_F64),
            Precision::Df32 | Precision::Dd => unreachable!("pairs run without angles"),
        }
    }
}

impl Rounding for Symbol {
    fn nearest(self) -> Self {
        call("round", &[self])
    }
}

/// The uses of a value: `any` is true if it is used at all, `alone` if it is used other than as the
/// term of a [`SymbolNode::MultiplyAdd`].
#[derive(Clone, Copy, Default)]
struct Uses {
    any: bool,
    alone: bool,
}

impl Tape {
    fn print(&self, results: &[(String, Symbol)]) -> String {
        let mut uses = vec![Uses::default(); self.nodes.len()];
        for (_, symbol) in results {
            uses[symbol.0 as usize] = Uses { any: true, alone: true };
        }
        // Operands precede their users, so one pass backwards finds all that is needed.
        for index in (0..self.nodes.len()).rev() {
            if uses[index].any {
                self.mark_operands(index, &mut uses);
            }
        }
        let indent = self.dialect.indent;
        let mut text = String::new();
        for (index, node) in self.nodes.iter().enumerate().filter(|(i, _)| uses[*i].any) {
            if !matches!(node, SymbolNode::Literal(_) | SymbolNode::Variable(_)) {
                let mut value = self.expression(node);
                if uses[index].alone && matches!(node, SymbolNode::MultiplyAdd(..)) {
                    value = format!("normal({value}, zero)");
                }
                let _ = writeln!(text, "{indent}let v{index} = {value};");
            }
        }
        for (name, symbol) in results {
            let _ = writeln!(text, "{indent}let {name} = {};", self.operand(symbol.0));
        }
        text
    }

    fn mark_operands(&self, index: usize, uses: &mut [Uses]) {
        let mut mark = |operands: &[u32]| {
            for &operand in operands {
                uses[operand as usize] = Uses { any: true, alone: true };
            }
        };
        match &self.nodes[index] {
            SymbolNode::Binary(_, a, b) => mark(&[*a, *b]),
            SymbolNode::MultiplyAdd(a, b, c) => {
                mark(&[*a, *b]);
                uses[*c as usize].any = true;
            }
            SymbolNode::Negative(a) | SymbolNode::Guard(a) => mark(&[*a]),
            SymbolNode::Call(_, operands) => mark(operands),
            SymbolNode::Literal(_) | SymbolNode::Variable(_) => {}
        }
    }

    fn expression(&self, node: &SymbolNode) -> String {
        match node {
            SymbolNode::Binary(operator, a, b) => {
                let (a, b) = (self.operand(*a), self.operand(*b));
                if self.dialect.precision != Precision::Df32 {
                    return format!("{a} {operator} {b}");
                }
                let function = match operator {
                    '+' => "add",
                    '-' => "subtract",
                    '*' => "multiply",
                    _ => "divide",
                };
                format!("{function}({a}, {b}, zero)")
            }
            SymbolNode::MultiplyAdd(a, b, c) => {
                let [a, b, c] = [a, b, c].map(|operand| self.operand(*operand));
                format!("multiply_add({a}, {b}, {c}, zero)")
            }
            SymbolNode::Negative(a) => format!("-{}", self.operand(*a)),
            SymbolNode::Call(function, operands) => {
                let operands: Vec<String> = operands.iter().map(|a| self.operand(*a)).collect();
                format!("{function}({})", operands.join(", "))
            }
            SymbolNode::Guard(a) => format!("guard({}, zero)", self.operand(*a)),
            SymbolNode::Literal(_) | SymbolNode::Variable(_) => {
                unreachable!("printed where it is used")
            }
        }
    }

    fn operand(&self, index: u32) -> String {
        match self.nodes[index as usize] {
            SymbolNode::Literal(bits) => literal_text(self.dialect.precision, f64::from_bits(bits)),
            SymbolNode::Variable(name) => name.to_string(),
            _ => format!("v{index}"),
        }
    }
}

/// Formats a literal of the shading language that reads back as exactly the nearest number.
pub(crate) fn literal_text(precision: Precision, value: f64) -> String {
    let text = match precision {
        Precision::F32 => format!("{:?}f", value as f32),
        Precision::Df32 => {
            let [high, low] = to_parts(value);
            return format!("Real({high:?}f, {low:?}f)");
        }
        Precision::F64 | Precision::Dd => format!("{value:?}lf"),
    };
    if value < 0.0 { format!("({text})") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(maths: impl FnOnce() -> Symbol) -> String {
        let dialect = Dialect { precision: Precision::F32, indent: "" };
        write_maths(dialect, || vec![("result".to_string(), maths())]).text
    }

    #[test]
    fn trivial_operations_leave_no_text() {
        let text = written(|| {
            let x = variable("x");
            (x * literal(1.0) + literal(0.0) * variable("unused")) / literal(1.0)
        });
        assert_eq!(text, "let result = x;\n");
    }

    #[test]
    fn what_is_used_twice_is_written_once() {
        let text = written(|| {
            let (x, y) = (variable("x"), variable("y"));
            (x * y) + (x * y) * literal(0.5)
        });
        assert_eq!(
            text,
            "let v2 = x * y;\nlet v4 = v2 * 0.5f;\nlet v5 = v2 + v4;\nlet result = v5;\n"
        );
    }

    #[test]
    fn pairs_multiply_and_add_at_once_unless_there_is_nothing_to_multiply() {
        let dialect = Dialect { precision: Precision::Df32, indent: "" };
        let maths = write_maths(dialect, || {
            let (x, y) = (variable("x"), variable("y"));
            let both = x.mul_add(y, y.mul_add(literal(1.0), x));
            vec![("both".to_string(), both), ("double".to_string(), both + x)]
        });
        let sum =
            "let v3 = add(y, x, zero);\nlet v4 = normal(multiply_add(x, y, v3, zero), zero);\n";
        let results = "let both = v4;\nlet double = v5;\n";
        assert_eq!(maths.text, format!("{sum}let v5 = add(v4, x, zero);\n{results}"));
    }

    #[test]
    fn sums_of_products_of_pairs_are_made_normal_where_they_end() {
        let dialect = Dialect { precision: Precision::Df32, indent: "" };
        let maths = write_maths(dialect, || {
            let (x, y) = (variable("x"), variable("y"));
            let sum = x.mul_add(x, y.mul_add(y, x));
            vec![("square".to_string(), sum * sum)]
        });
        let sums = "let v2 = multiply_add(y, y, x, zero);\n\
                    let v3 = normal(multiply_add(x, x, v2, zero), zero);\n";
        let square = "let v4 = multiply(v3, v3, zero);\nlet square = v4;\n";
        assert_eq!(maths.text, format!("{sums}{square}"));
    }

    #[test]
    fn what_no_result_needs_is_not_written() {
        let text = written(|| {
            let x = variable("x");
            let _ = x * x;
            -x
        });
        assert_eq!(text, "let v2 = -x;\nlet result = v2;\n");
    }

    #[test]
    fn literals_read_back_exactly() {
        assert_eq!(literal_text(Precision::F32, 1.0 / 3.0), "0.33333334f");
        assert_eq!(literal_text(Precision::F64, 1.0 / 3.0), "0.3333333333333333lf");
        assert_eq!(literal_text(Precision::F64, -1e-300), "(-1e-300lf)");
    }
}
