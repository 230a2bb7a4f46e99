//! The maths of a kernel as shader text, printed from the Rust of `flipmap_pendulum`.

mod series;

use super::kernel::{Design, Scheme};
use crate::Precision;
use crate::gpu::symbol::{Dialect, Maths, Symbol, literal, variable, write_maths};
use crate::integrator_state::{SLOPES, STARTS};
use crate::start::PHASE;
use flipmap_numbers::dual::Dual;
use flipmap_numbers::polynomial::quintic_hermite;
use flipmap_numbers::trig::Turning;
use flipmap_numbers::{Angle, Real};
use flipmap_pendulum::embedded::{Pair, Trial, plus};
use flipmap_pendulum::extremum::{Extremum, Measure};
use flipmap_pendulum::phase::{Phase, rk4};
use flipmap_pendulum::tangents::Tangents;
use flipmap_pendulum::{Pendulum, State, integrator};
use flipmap_scene::question::Needs;

const INDENT: &str = "    ";

impl Design {
    fn dialect(&self) -> Dialect {
        Dialect { precision: self.precision, indent: INDENT }
    }

    fn pendulum(&self) -> Pendulum<Symbol> {
        match self.scene {
            Some((pendulum, _)) => pendulum.map(literal),
            None => Pendulum {
                a: variable("scene.a"),
                b: variable("scene.b"),
                c: literal(1.0),
                p: variable("scene.p"),
                q: literal(1.0),
                least_det: variable("scene.least_det"),
                friction: None,
                lengths: ["scene.length1", "scene.length2"].map(variable),
            },
        }
    }

    fn inverse_scale(&self) -> [Symbol; 2] {
        match self.scene {
            Some((pendulum, _)) => pendulum.momentum_scale().map(|scale| literal(1.0 / scale)),
            None => ["scene.inverse_scale1", "scene.inverse_scale2"].map(variable),
        }
    }

    /// One step: the `_next` value of every state variable that moves, and the quantities by which
    /// the step is judged.
    pub(crate) fn step(&self) -> Maths {
        match self.ends {
            Needs::Growth => return self.tangent_step(),
            Needs::Extremum(extremum) => return self.extremum_step(extremum),
            Needs::Outcome | Needs::End => {}
        }
        match self.scheme {
            Scheme::Fixed(turning) => self.fixed_step(turning),
            Scheme::Embedded(pair) => self.adaptive_step(pair),
            Scheme::Series => self.series_step(),
        }
    }

    fn fixed_step(&self, turning: Turning) -> Maths {
        write_maths(self.dialect(), || {
            let before = state(["t1", "t2", "w1", "w2"]);
            let change = integrator::rk4(&self.pendulum(), &before, variable("step"), turning);
            let next = if self.compensated {
                let low = ["t1_low", "t2_low"].map(variable);
                let (next, low) = before.plus_with_rest(low, &change);
                [next.angle, next.speed, low].concat()
            } else {
                let next = before.plus(&change);
                [next.angle, next.speed].concat()
            };
            self.state().iter().map(|name| format!("{name}_next")).zip(next).collect()
        })
    }

    fn adaptive_step(&self, pair: Pair) -> Maths {
        const NAMES: Phase<&str> = ["x1", "y1", "x2", "y2", "p1", "p2"];
        const LOWS: Phase<&str> = ["x1_low", "y1_low", "x2_low", "y2_low", "p1_low", "p2_low"];
        write_maths(self.dialect(), || {
            let (pendulum, phase, step) = (self.pendulum(), NAMES.map(variable), variable("step"));
            let trial = pair.trial(&pendulum, self.inverse_scale(), &phase, step);
            let mut results = Vec::new();
            let mut next = phase;
            for i in 0..6 {
                let name = |name: &str| format!("{name}_next");
                if self.compensated {
                    let change = variable(LOWS[i]) + trial.change[i];
                    let (value, rest) = phase[i].fast_two_sum(change);
                    next[i] = value;
                    results.push((name(LOWS[i]), rest));
                } else {
                    next[i] = phase[i] + trial.change[i];
                }
                results.push((name(NAMES[i]), next[i]));
            }
            let time = variable("time");
            if self.compensated {
                let (sum, rest) = time.fast_two_sum(variable("time_low") + step);
                results.push(("time_next".to_string(), sum));
                results.push(("time_low_next".to_string(), rest));
            } else {
                results.push(("time_next".to_string(), time + step));
            }
            results.push(("error_squared".to_string(), trial.error_squared));
            let (before, after) = (pendulum.speeds(&phase), pendulum.speeds(&next));
            for bob in self.watched() {
                results.push((format!("w{bob}"), before[bob - 1]));
                results.push((format!("w{bob}_next"), after[bob - 1]));
                if pair.data().has_bow {
                    results.push((format!("bow{bob}"), trial.bow[bob - 1]));
                }
            }
            results
        })
    }

    fn tangent_step(&self) -> Maths {
        write_maths(self.dialect(), || {
            let pendulum = self.pendulum().map(Dual::<4, Symbol>::new);
            let scale = self.inverse_scale().map(Dual::new);
            let before: Tangents<Symbol> = std::array::from_fn(|i| Dual {
                value: variable(PHASE[i]),
                slope: SLOPES[i].map(variable),
            });
            let step = variable("step");
            let length = Dual::new(step);
            let (next, error) = match self.scheme {
                Scheme::Fixed(_) => (rk4(&pendulum, &before, length), Dual::new(literal(0.0))),
                Scheme::Embedded(pair) => {
                    tried(&before, pair.trial(&pendulum, scale, &before, length))
                }
                Scheme::Series => unreachable!("refused with the job"),
            };
            let error = error.value;
            let mut results = vec![("time_next".to_string(), variable("time") + step)];
            for (i, number) in next.iter().enumerate() {
                results.push((format!("{}_next", PHASE[i]), number.value));
                let slopes = SLOPES[i].iter().zip(number.slope);
                results.extend(slopes.map(|(name, slope)| (format!("{name}_next"), slope)));
            }
            results.push(("error_squared".to_string(), error));
            results
        })
    }

    /// A step with the rates of change of a quantity whose extreme is looked for at both ends, and
    /// the square of the quantity at its end.
    fn extremum_step(&self, extremum: Extremum) -> Maths {
        write_maths(self.dialect(), || {
            let (pendulum, scale) = (self.pendulum(), self.inverse_scale());
            let before: Phase<Symbol> = std::array::from_fn(|i| variable(PHASE[i]));
            let step = variable("step");
            let (after, error) = match self.scheme {
                Scheme::Fixed(_) => (rk4(&pendulum, &before, step), literal(0.0)),
                Scheme::Embedded(pair) => {
                    tried(&before, pair.trial(&pendulum, scale, &before, step))
                }
                Scheme::Series => unreachable!("refused with the job"),
            };
            let start = STARTS.map(variable);
            let measure = Measure { extremum, pendulum, inverse_scale: scale, start };
            let mut results = vec![("time_next".to_string(), variable("time") + step)];
            for (name, value) in PHASE.iter().zip(after) {
                results.push((format!("{name}_next"), value));
            }
            results.push(("error_squared".to_string(), error));
            results.push(("rate".to_string(), measure.rate(&before)));
            results.push(("rate_next".to_string(), measure.rate(&after)));
            results.push(("square_next".to_string(), measure.square(&after)));
            results
        })
    }

    /// The energy of a pendulum, from its state at the end of a slice of steps.
    pub(crate) fn energy(&self) -> String {
        let maths = write_maths(self.dialect(), || {
            let energy = if self.is_adaptive() {
                self.pendulum().energy_of(&std::array::from_fn(|i| variable(PHASE[i])))
            } else {
                self.pendulum().energy(&state(["t1", "t2", "w1", "w2"]))
            };
            vec![("energy".to_string(), energy)]
        });
        maths.text
    }

    /// The coefficients of the quintic of a bob's angle beyond the top over the step (see
    /// `flip::fraction_of_step`).
    pub(crate) fn quintic_of(&self, bob: usize) -> String {
        const ENDS: [[&str; 6]; 2] = [
            ["t1", "t2", "w1", "w2", "t1_low", "t2_low"],
            ["t1_next", "t2_next", "w1_next", "w2_next", "t1_low_next", "t2_low_next"],
        ];
        let maths = write_maths(self.dialect(), || {
            let (side, step) = (variable("side"), variable("step"));
            let ends = ENDS.map(|[t1, t2, w1, w2, t1_low, t2_low]| {
                let end = state([t1, t2, w1, w2]);
                let alpha = self.pendulum().acceleration(&end)[bob - 1];
                let margin = side * end.angle[bob - 1] - variable("PI");
                let rest = [t1_low, t2_low][bob - 1];
                let margin = if self.compensated {
                    margin + (side * variable(rest) - variable("PI_REST"))
                } else {
                    margin
                };
                [margin, side * end.speed[bob - 1] * step, side * alpha * step * step]
            });
            let coefficients = quintic_hermite(ends[0], ends[1]);
            (0..6).map(|k| format!("c{k}")).zip(coefficients).collect()
        });
        maths.text
    }
}

/// The state after a trial step, and the square of its error.
fn tried<T: Real>(before: &Phase<T>, trial: Trial<T>) -> (Phase<T>, T) {
    (plus(before, &trial.change), trial.error_squared)
}

fn state(names: [&'static str; 4]) -> State<Symbol> {
    let [t1, t2, w1, w2] = names.map(variable);
    State { angle: [t1, t2], speed: [w1, w2] }
}

/// The self-check's results for one number type.
pub(super) fn selfcheck(precision: Precision) -> String {
    let maths = write_maths(Dialect { precision, indent: INDENT }, || {
        let (a, b) = (variable("a"), variable("b"));
        let (sum, error) = match precision {
            Precision::F32 => a.fast_two_sum(b),
            _ => (a + b, a - b),
        };
        let mut results =
            vec![("sum", sum), ("error", error), ("product", a * b), ("quotient", a / b)];
        if precision == Precision::Df32 {
            results.push(("both", a.mul_add(b, a)));
        } else {
            let (sin, cos) = a.sin_cos();
            results.extend([("sin", sin), ("cos", cos)]);
        }
        results.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
    });
    maths.text
}
