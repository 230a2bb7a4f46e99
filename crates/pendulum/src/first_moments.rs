//! Launches from near the top, carried to the end of their first moments: the passes of the top in
//! them, and the state at their end.
//!
//! Engines integrate a launch from there. They need not resolve distances from the top far below
//! any rounding error, and a bob's clearance from the top is measured only from then on.

use crate::Accumulators;
use crate::opening::{INDISTINCT_RAD, ORDER_DD, ORDER_F64, from_top};
use crate::pendulum::{Launch, Pendulum, State};
use crate::phase::Phase;
use crate::series::MotionSeries;
use flipmap_numbers::real::Scalar;
use flipmap_numbers::{Dd, Exact};

/// A pass of the top in the first moments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstPass {
    /// Index of the bob.
    pub bob: usize,
    /// Reduced time since the launch.
    pub time: Dd,
    /// True if it goes over the top towards the left.
    pub anticlockwise: bool,
}

/// The start of a launch in numbers that keep their leading digits near the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Release<T> {
    /// Distances of both angles from the top in rad (see [`from_top`]).
    pub from_top: [T; 2],
    /// Unit vectors along the rods, each its cosine and sine.
    pub vectors: [[T; 2]; 2],
    /// Reduced angular velocities.
    pub speed: [T; 2],
}

/// The first moments of a launch.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstMoments {
    /// Reduced time at which they end; 0 if the launch is integrated from its release.
    pub length: f64,
    /// Passes of the top in them by the bobs that were asked for, in order of time.
    pub passes: Vec<FirstPass>,
    /// Angles in [−π, π] rad: ±π for a bob too near the top for double-double to tell its side,
    /// which is then in the sign.
    pub angle: [Dd; 2],
    release: Release<Dd>,
}

impl<T: Scalar> Release<T> {
    /// The release of a start in a number type: angles in (−π, π] rad, speeds reduced.
    pub(super) fn new(start: &State<Exact>) -> Self {
        let [angle, from_top, speed] = [start.angle, start.angle.map(from_top), start.speed]
            .map(|pair| pair.map(T::from_theta));
        let vectors = [0, 1].map(|bob| vector(angle[bob], from_top[bob]));
        Release { from_top, vectors, speed }
    }
}

/// The unit vector of an angle, computed from the distance from the top where that has more digits.
fn vector<T: Scalar>(angle: T, from_top: T) -> [T; 2] {
    if from_top.to_f64().abs() < 0.5 {
        let (sin, cos) = from_top.sin_cos();
        [-cos, -sin]
    } else {
        let (sin, cos) = angle.sin_cos();
        [cos, sin]
    }
}

impl<T: Scalar> Release<T> {
    /// Returns true if both speeds are zero.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.speed == [T::zero(); 2]
    }

    /// The same release in f64.
    fn to_f64(self) -> Release<f64> {
        Release {
            from_top: self.from_top.map(T::to_f64),
            vectors: self.vectors.map(|vector| vector.map(T::to_f64)),
            speed: self.speed.map(T::to_f64),
        }
    }

    /// The same launch with both angles moved by `by` rad.
    fn moved_by(&self, by: [T; 2]) -> Self {
        let turned = |bob: usize| {
            let ([x, y], (sin, cos)) = (self.vectors[bob], by[bob].sin_cos());
            [x * cos - y * sin, y * cos + x * sin]
        };
        let from_top = [0, 1].map(|bob| self.from_top[bob] + by[bob]);
        Release { from_top, vectors: [0, 1].map(turned), ..*self }
    }

    /// Unit vectors and momenta at the release; `pendulum` is in reduced units.
    fn phase(&self, pendulum: &Pendulum<T>) -> Phase<T> {
        let ([[x1, y1], [x2, y2]], [w1, w2]) = (self.vectors, self.speed);
        let coupling = pendulum.c * (x1 * x2 + y1 * y2);
        [x1, y1, x2, y2, pendulum.a * w1 + coupling * w2, coupling * w1 + pendulum.b * w2]
    }

    /// The motion as power series in time, in units of `length`; `pendulum` is in reduced units.
    fn expanded<const N: usize>(&self, pendulum: &Pendulum<T>, length: T) -> MotionSeries<T, N> {
        let square = length * length;
        let pendulum = Pendulum {
            p: pendulum.p * square,
            q: pendulum.q * square,
            friction: pendulum.friction.map(|pair| pair.map(|b| b * length)),
            ..*pendulum
        };
        let in_units = Release { speed: self.speed.map(|w| w * length), ..*self };
        MotionSeries::expand(&pendulum, &in_units.phase(&pendulum))
    }

    /// The distances of both bobs from the top as power series in time, in units of `length`.
    pub(crate) fn series<const N: usize>(&self, pendulum: &Pendulum<T>, length: T) -> [[T; N]; 2] {
        let series = self.expanded::<N>(pendulum, length);
        [0, 1].map(|bob| {
            std::array::from_fn(|k| match k {
                0 => self.from_top[bob],
                // As given: from the momenta it would have lost digits.
                1 => self.speed[bob] * length,
                _ => series.speed[bob][k - 1] / T::from_f64(k as f64),
            })
        })
    }

    /// Unit vectors and momenta after `length`, by series of `N` coefficients.
    fn carried<const N: usize>(&self, pendulum: &Pendulum<T>, length: f64) -> Phase<T> {
        let unit = T::from_f64(length);
        let begun = self.phase(pendulum);
        if length == 0.0 {
            return begun;
        }
        let series = self.expanded::<N>(pendulum, unit);
        let change = series.change(T::from_f64(1.0));
        std::array::from_fn(|i| {
            // Momenta are those of the pendulum in units of `length`.
            let change = if i < 4 { change[i] } else { change[i] / unit };
            begun[i] + change
        })
    }
}

impl FirstMoments {
    /// The first moments of a start, with the passes in them and, for a bob that begins exactly at
    /// the top, the side on which it counts as being: the sign of its angle.
    pub(super) fn new(
        start: &State<Exact>,
        length: f64,
        passes: Vec<FirstPass>,
        sides: [Option<f64>; 2],
    ) -> Self {
        let release = Release::<Dd>::new(start);
        let angle = [0, 1].map(|bob| {
            let angle = start.angle[bob].to_dd();
            let own = if angle.hi > 0.0 { 1.0 } else { -1.0 };
            let is_lost = release.from_top[bob].hi.abs() <= INDISTINCT_RAD;
            if is_lost { Dd::PI * Dd::new(sides[bob].unwrap_or(own)) } else { angle }
        });
        FirstMoments { length, passes, angle, release }
    }

    /// The launch in double-double; `unit_secs` is the reduced unit of time in s.
    pub fn launch(&self, unit_secs: Dd) -> Launch {
        Launch { angle: self.angle, speed: self.release.speed.map(|w| w / unit_secs) }
    }

    /// Returns true if [`FirstMoments::angle`] and the speeds describe the launch completely: it is
    /// integrated from its release, and a bob too near the top for double-double is exactly at it.
    pub fn is_plain(&self) -> bool {
        let is_told = |from_top: &Dd| from_top.hi == 0.0 || from_top.hi.abs() > INDISTINCT_RAD;
        self.length == 0.0 && self.release.from_top.iter().all(is_told)
    }

    /// Unit vectors and momenta at a pass, approximated by those at the release; `pendulum` is in
    /// reduced units.
    pub fn phase_at(&self, pass: &FirstPass, pendulum: &Pendulum<f64>) -> Phase<f64> {
        let mut phase = self.release.to_f64().phase(pendulum);
        let other = 1 - pass.bob;
        [phase[2 * pass.bob], phase[2 * pass.bob + 1]] = [-1.0, 0.0];
        // The other bob may be exactly at the top, too, but does not pass it now.
        if phase[2 * other + 1] == 0.0 {
            phase[2 * other + 1] = f64::MIN_POSITIVE;
        }
        phase
    }

    /// Returns true if it is released from rest.
    pub fn is_at_rest(&self) -> bool {
        self.release.is_at_rest()
    }

    /// The first moments of a launch from angles that differ by `by` rad, with the same passes. The
    /// displacement must be small, like the errors of a run.
    #[must_use]
    pub fn moved_by(&self, by: [f64; 2]) -> Self {
        let release = self.release.moved_by(by.map(Dd::new));
        let angle = [0, 1].map(|bob| self.angle[bob] + Dd::new(by[bob]));
        FirstMoments { release, angle, ..self.clone() }
    }

    /// Unit vectors and momenta at their end, to the precision of f64; `pendulum` is in reduced
    /// units.
    pub fn end(&self, pendulum: &Pendulum<f64>) -> Phase<f64> {
        self.release.to_f64().carried::<ORDER_F64>(pendulum, self.length)
    }

    /// Unit vectors and momenta at their end, to the precision of double-double.
    pub fn precise_end(&self, pendulum: &Pendulum<Dd>) -> Phase<Dd> {
        self.release.carried::<ORDER_DD>(pendulum, self.length)
    }

    /// The passes until their end, and the resulting turns.
    pub fn gathered(&self) -> Accumulators {
        let mut gathered = Accumulators::NONE;
        for pass in self.passes.iter().filter(|pass| pass.time.hi <= self.length) {
            gathered.passes[2 * pass.bob + usize::from(!pass.anticlockwise)] += 1;
            gathered.turns[pass.bob] += if pass.anticlockwise { 1 } else { -1 };
        }
        gathered
    }
}
