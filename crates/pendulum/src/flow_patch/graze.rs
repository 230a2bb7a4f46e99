//! Grazes: turns of a bob near the top in which some starts of a cell flip and others do not.

use super::Dynamics;
use crate::phase::Phase;
use flipmap_numbers::jet::Jet;

/// A bob's turn near the top.
#[derive(Clone, Debug)]
pub struct Graze {
    pub(super) bob: usize,
    /// The sign of the bob's sine before it reaches the top.
    pub(super) side: f64,
    pub(super) time: f64,
    /// Delay of each start's turn after that of the middle start, in reduced time.
    pub(super) shift: Jet,
    /// Height beyond the top at the turn, in rad (as a sine).
    pub(super) height: Jet,
    /// The states of all starts at their turns.
    pub(super) phase: Phase<Jet>,
}

impl Graze {
    pub(super) fn concerns_any(&self) -> bool {
        self.height.middle() + self.height.spread() >= 0.0
    }

    pub(super) fn concerns_all(&self) -> bool {
        self.height.middle() > self.height.spread()
    }

    /// The reduced time at which the start at a point of the cell flips, and its state then; `None`
    /// if it does not flip in this graze.
    pub fn flip(&self, dynamics: &Dynamics, at: [f64; 2]) -> Option<(f64, Phase<f64>)> {
        let height = self.height.at(at);
        if height < 0.0 {
            return None;
        }
        let phase = self.phase.map(|jet| jet.at(at));
        let turn = self.time + self.shift.at(at);
        let (rise, then) = self.rise(dynamics, phase, height);
        Some((turn - rise, then))
    }

    /// Distance from the top at which the start at a point of the cell turns round, as a sine.
    pub(super) fn clearance(&self, at: [f64; 2]) -> f64 {
        self.height.at(at).abs()
    }

    /// The time from the crossing of the top to the turn of a bob that rises `height` beyond it,
    /// and the state at the crossing.
    fn rise(&self, dynamics: &Dynamics, mut phase: Phase<f64>, height: f64) -> (f64, Phase<f64>) {
        let (x, y) = (2 * self.bob, 2 * self.bob + 1);
        // The height's polynomial gives it to more digits than the phase does.
        phase[y] = -self.side * height;
        let [x1, y1, x2, y2, ..] = phase;
        let speed = dynamics.pendulum.speeds(&phase);
        let pull = dynamics.pendulum.acceleration_towards([(y1, x1), (y2, x2)], speed)[self.bob];
        let mut back = (2.0 * height / pull.abs()).sqrt();
        let mut then = phase;
        for _ in 0..6 {
            (then, _) = dynamics.moved(&phase, -back);
            let rate = dynamics.pendulum.speeds(&then)[self.bob] * then[x];
            if rate == 0.0 {
                break;
            }
            back += then[y] / rate;
        }
        (back, then)
    }
}
