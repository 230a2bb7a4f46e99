//! A Taylor step on symbols (counterpart: `cpu/taylor.rs`).

use super::Design;
use crate::gpu::symbol::{Maths, Symbol, call, literal, variable, write_maths};
use crate::start::PHASE;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::series::{MotionSeries, ORDER_F64};

/// Number of coefficients of an expansion.
const TERMS: usize = ORDER_F64 + 1;

impl Design {
    /// The expansion at a state and the step that it allows: the step's length, the `_next` value
    /// of every state variable that moves, and for each watched bob its coefficients with bounds on
    /// where it goes within the step.
    pub(super) fn series_step(&self) -> Maths {
        write_maths(self.dialect(), || {
            let phase: Phase<Symbol> = std::array::from_fn(|i| variable(PHASE[i]));
            let series = MotionSeries::<Symbol, TERMS>::expand(&self.pendulum(), &phase);
            let length = call("length_of", &[TERMS - 2, TERMS - 1].map(|k| self.size(&series, k)));
            let change = series.change(length);
            let mut results = vec![
                ("length".to_string(), length),
                ("time_next".to_string(), variable("time") + length),
            ];
            let moved = (0..6).map(|i| (format!("{}_next", PHASE[i]), phase[i] + change[i]));
            results.extend(moved);
            for bob in self.watched() {
                let [x, y, w] = [
                    &series.phase[2 * bob - 2],
                    &series.phase[2 * bob - 1],
                    &series.speed[bob - 1],
                ];
                results.push((format!("lowest{bob}"), x[0] - reach(x, length)));
                results.push((format!("nearest{bob}"), y[0].abs() - reach(y, length)));
                results.push((format!("steady{bob}"), w[0].abs() - reach(w, length)));
                for (name, all) in [("x", x), ("y", y), ("w", w)] {
                    let named = all.iter().enumerate();
                    results.extend(named.map(|(k, &c)| (format!("{name}{bob}_{k}"), c)));
                }
            }
            results
        })
    }

    /// Size of the coefficients of one order, with momenta in units of their scale.
    fn size(&self, series: &MotionSeries<Symbol, TERMS>, order: usize) -> Symbol {
        let scale = self.inverse_scale();
        let size = |i: usize| {
            let size = series.phase[i][order].abs();
            if i < 4 { size } else { size * scale[i - 4] }
        };
        (1..6).fold(size(0), |largest, i| call("larger", &[largest, size(i)]))
    }
}

/// Upper bound on how far a series moves within `length`.
fn reach(series: &[Symbol; TERMS], length: Symbol) -> Symbol {
    let terms = series[1..].iter().rev();
    terms.fold(literal(0.0), |sum, &term| sum * length + term.abs()) * length
}
