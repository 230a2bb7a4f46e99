//! The five numbers of a double pendulum, its equations of motion, energy and forbidden starts.
//!
//! The kinetic energy is ½A ω1² + ½B ω2² + C ω1 ω2 cos(θ1−θ2), the potential −P cos θ1 − Q cos θ2:
//! five numbers describe any pendulum of point masses or of rods. Lagrange's equations follow as
//!
//! ```text
//! A α1 + C c α2 = −C s ω2² − P sin θ1        c = cos(θ1−θ2)
//! C c α1 + B α2 =  C s ω1² − Q sin θ2        s = sin(θ1−θ2)
//! ```
//!
//! Friction at the pivots adds −b1 ω1 + b2 (ω2−ω1) to the first right-hand side and −b2 (ω2−ω1) to
//! the second. The determinant of the equations, AB − C² c² = (AB − C²) + C² s², is positive. Its
//! constant part is carried as a sixth number, because computing it from the other five would
//! cancel for a light first bob.

use crate::flip::Rule;
use flipmap_numbers::dd::Dd;
use flipmap_numbers::real::{Angle, Real, Scalar};

/// The five numbers of a pendulum (kg m² and J), the constant that follows from them, and the
/// lengths of its rods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum<T> {
    /// Inertia of the first angle in kg m².
    pub a: T,
    /// Inertia of the second angle in kg m².
    pub b: T,
    /// Coupling of the two angles in kg m².
    pub c: T,
    /// Weight of the first angle in J.
    pub p: T,
    /// Weight of the second angle in J.
    pub q: T,
    /// Least value of the determinant, AB − C², in kg² m⁴.
    pub least_det: T,
    /// Friction b1 and b2 at the two pivots in N m s. Without friction it is `None`, and kernels
    /// and loops contain no code for it.
    pub friction: Option<[T; 2]>,
    /// Lengths l1 and l2 of the rods in m, which turn angular velocities into speeds of the bobs; no
    /// equation of motion contains them.
    pub lengths: [T; 2],
}

/// A start with speeds, to the precision of double-double.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Launch {
    /// Angles θ1 and θ2 in (−π, π], rad.
    pub angle: [Dd; 2],
    /// Angular velocities ω1 and ω2, rad/s.
    pub speed: [Dd; 2],
}

impl Launch {
    /// The release from rest at angles in rad.
    pub fn at_rest(angle: [Dd; 2]) -> Self {
        Launch { angle, speed: [Dd::new(0.0); 2] }
    }

    /// Returns true if both speeds are zero.
    pub fn is_at_rest(&self) -> bool {
        self.speed == [Dd::new(0.0); 2]
    }

    /// The same start with both angles moved by `by` rad.
    #[must_use]
    pub fn moved_by(self, by: [Dd; 2]) -> Self {
        Launch { angle: [0, 1].map(|i| self.angle[i] + by[i]), ..self }
    }
}

/// The state of a pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    /// Angles θ1 and θ2 from the downward vertical in rad, anticlockwise, unwrapped.
    pub angle: [T; 2],
    /// Angular velocities ω1 and ω2 in rad/s.
    pub speed: [T; 2],
}

impl<T> State<T> {
    /// The state of a pendulum released from rest at the two angles.
    pub fn rest(angle: [T; 2]) -> Self
    where
        T: Real,
    {
        let zero = angle[0].lit(0.0);
        State { angle, speed: [zero, zero] }
    }
}

impl<T: Scalar> Pendulum<T> {
    /// A pendulum of bobs on massless rods: masses in kg, lengths in m, gravity in m/s².
    pub fn points(masses: [T; 2], lengths: [T; 2], gravity: T) -> Self {
        let ([m1, m2], [l1, l2]) = (masses, lengths);
        Pendulum {
            a: (m1 + m2) * l1 * l1,
            b: m2 * l2 * l2,
            c: m2 * l1 * l2,
            p: (m1 + m2) * gravity * l1,
            q: m2 * gravity * l2,
            least_det: m1 * m2 * l1 * l1 * l2 * l2,
            friction: None,
            lengths,
        }
    }

    /// A pendulum of uniform bars: masses in kg, lengths in m, gravity in m/s².
    pub fn rods(masses: [T; 2], lengths: [T; 2], gravity: T) -> Self {
        let ([m1, m2], [l1, l2]) = (masses, lengths);
        let lit = T::from_f64;
        Pendulum {
            a: (m1 / lit(3.0) + m2) * l1 * l1,
            b: m2 * l2 * l2 / lit(3.0),
            c: m2 * l1 * l2 / lit(2.0),
            p: (m1 / lit(2.0) + m2) * gravity * l1,
            q: m2 * gravity * l2 / lit(2.0),
            least_det: (m1 / lit(9.0) + m2 / lit(12.0)) * m2 * l1 * l1 * l2 * l2,
            friction: None,
            lengths,
        }
    }

    /// The same motion in units that make C = Q = 1, and the unit of time, √(C/Q), in s.
    ///
    /// Kernels run in these units: the default pendulum becomes A = 2, B = 1, P = 2 without
    /// rounding, whatever its gravity. Requires Q > 0.
    pub fn reduced(&self) -> (Self, T) {
        let one = T::from_f64(1.0);
        let reduced = Pendulum {
            a: self.a / self.c,
            b: self.b / self.c,
            c: one,
            p: self.p / self.q,
            q: one,
            least_det: self.least_det / (self.c * self.c),
            friction: self.friction.map(|pair| pair.map(|b| b / (self.c * self.q).sqrt())),
            lengths: self.lengths,
        };
        (reduced, (self.c / self.q).sqrt())
    }

    /// A bound on both bobs' speeds (rad/s) after any release from rest: the potential energy can
    /// fall by at most 2(P + Q), and ½ω2²(AB − C²c²)/A ≤ kinetic energy, likewise for ω1.
    pub fn greatest_speed(&self) -> f64 {
        let [a, b, p, q, least_det] =
            [self.a, self.b, self.p, self.q, self.least_det].map(T::to_f64);
        (4.0 * (p + q) * a.max(b) / least_det).sqrt()
    }

    /// The depth of a start at rest, its negated potential energy P cos θ1 + Q cos θ2 in J, from
    /// the cosines of its angles.
    pub fn depth(&self, cos: [T; 2]) -> T {
        self.p * cos[0] + self.q * cos[1]
    }

    /// Depth in J beyond which starts cannot meet `rule`: lifting the watched bob to the top takes
    /// more energy than they have, even with the other bob at the bottom.
    pub fn least_depth(&self, rule: Rule) -> T {
        match rule {
            Rule::Second => self.p - self.q,
            Rule::First => self.q - self.p,
            Rule::Either => (self.p - self.q).abs(),
            // Deeper than any start: nothing is forbidden.
            Rule::Neither => (self.p + self.q) + (self.p + self.q),
        }
    }

    /// Returns true if energy conservation proves that a pendulum released from rest at `angle` can
    /// never meet `rule`. Nothing moves without gravity, so then every start is forbidden.
    pub fn forbids(&self, rule: Rule, angle: [T; 2]) -> bool {
        self.forbids_depth(rule, self.depth(angle.map(|theta| theta.sin_cos().1)))
    }

    /// Returns the same as [`Pendulum::forbids`], given a start's [`Pendulum::depth`].
    pub fn forbids_depth(&self, rule: Rule, depth: T) -> bool {
        self.q <= T::zero() || depth > self.least_depth(rule)
    }

    /// The nearest pendulum in f64.
    pub fn to_f64(&self) -> Pendulum<f64> {
        self.map(T::to_f64)
    }
}

impl Pendulum<Dd> {
    /// Returns true if energy conservation proves that a pendulum thrown from `launch` can never
    /// meet `rule`.
    pub fn forbids_launch(&self, rule: Rule, launch: &Launch) -> bool {
        let Launch { angle, speed } = *launch;
        self.forbids_depth(rule, -self.energy(&State { angle, speed }))
    }
}

impl<T: Copy> Pendulum<T> {
    /// Applies `f` to each number.
    #[inline(always)]
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Pendulum<U> {
        Pendulum {
            a: f(self.a),
            b: f(self.b),
            c: f(self.c),
            p: f(self.p),
            q: f(self.q),
            least_det: f(self.least_det),
            friction: self.friction.map(|pair| pair.map(&f)),
            lengths: [f(self.lengths[0]), f(self.lengths[1])],
        }
    }
}

impl<T: Real> Pendulum<T> {
    /// The angular accelerations α1 and α2 in rad/s², from the angles' `(sine, cosine)`.
    #[inline(always)]
    pub fn acceleration_towards(&self, direction: [(T, T); 2], speed: [T; 2]) -> [T; 2] {
        let [(sin1, cos1), (sin2, cos2)] = direction;
        let s = sin1 * cos2 - cos1 * sin2;
        let c = cos1.mul_add(cos2, sin1 * sin2);
        let (cs, cc) = (self.c * s, self.c * c);
        let [torque1, torque2] = self.torques(cs, [sin1, sin2], speed);
        let inverse_det = s.lit(1.0) / cs.mul_add(cs, self.least_det);
        [
            (self.b * torque1 - cc * torque2) * inverse_det,
            (self.a * torque2 - cc * torque1) * inverse_det,
        ]
    }
}

/// The matrix equation M α = τ for the accelerations at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equation<T> {
    /// The matrix M in kg m².
    pub mass: [[T; 2]; 2],
    /// The right-hand sides τ in N m: centrifugal terms, weight and friction.
    pub torque: [T; 2],
}

impl<T: Real> Pendulum<T> {
    /// The right-hand sides τ in N m, with `cs` = C sin(θ1−θ2).
    #[inline(always)]
    fn torques(&self, cs: T, [sin1, sin2]: [T; 2], [w1, w2]: [T; 2]) -> [T; 2] {
        let torques = [-(cs * (w2 * w2)) - self.p * sin1, cs * (w1 * w1) - self.q * sin2];
        match self.drag([w1, w2]) {
            None => torques,
            Some(drag) => [torques[0] + drag[0], torques[1] + drag[1]],
        }
    }

    /// The torques of friction in N m at these speeds (rad/s), if there is any.
    #[inline(always)]
    pub(crate) fn drag(&self, [w1, w2]: [T; 2]) -> Option<[T; 2]> {
        let [b1, b2] = self.friction?;
        let joint = b2 * (w2 - w1);
        Some([joint - b1 * w1, -joint])
    }
}

impl<T: Angle> Pendulum<T> {
    /// The matrix equation whose solution is [`Pendulum::acceleration`].
    pub fn equation(&self, state: &State<T>) -> Equation<T> {
        let [(sin1, cos1), (sin2, cos2)] = state.angle.map(Angle::sin_cos);
        let coupling = self.c * (cos1 * cos2 + sin1 * sin2);
        let cs = self.c * (sin1 * cos2 - cos1 * sin2);
        Equation {
            mass: [[self.a, coupling], [coupling, self.b]],
            torque: self.torques(cs, [sin1, sin2], state.speed),
        }
    }

    /// The angular accelerations α1 and α2 in rad/s².
    #[inline(always)]
    pub fn acceleration(&self, state: &State<T>) -> [T; 2] {
        let direction = [state.angle[0].sin_cos(), state.angle[1].sin_cos()];
        self.acceleration_towards(direction, state.speed)
    }

    /// Kinetic plus potential energy in J; zero if both rods are level and at rest.
    pub fn energy(&self, state: &State<T>) -> T {
        let (sin1, cos1) = state.angle[0].sin_cos();
        let (sin2, cos2) = state.angle[1].sin_cos();
        let c = cos1 * cos2 + sin1 * sin2;
        let [w1, w2] = state.speed;
        let half = c.lit(0.5);
        let kinetic = half * self.a * w1 * w1 + half * self.b * w2 * w2 + self.c * w1 * w2 * c;
        kinetic - self.p * cos1 - self.q * cos2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Pendulum<f64> {
        Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0)
    }

    #[test]
    fn accelerations_solve_the_matrix_equation() {
        for pendulum in [
            Pendulum::points([1.0, 2.0], [1.0, 0.6], 9.81),
            Pendulum::rods([0.3, 2.0], [0.4, 0.6], 1.62),
        ] {
            let state = State { angle: [1.1f64, -2.3], speed: [3.0, -4.0] };
            let [a1, a2] = pendulum.acceleration(&state);
            let (s, c) = (state.angle[0] - state.angle[1]).sin_cos();
            let Pendulum { a, b, c: k, p, q, .. } = pendulum;
            let first = a * a1 + k * c * a2 + k * s * 16.0 + p * state.angle[0].sin();
            let second = k * c * a1 + b * a2 - k * s * 9.0 + q * state.angle[1].sin();
            assert!(first.abs() < 1e-12 && second.abs() < 1e-12);
            assert!((pendulum.least_det - (a * b - k * k)).abs() < 1e-12);
        }
    }

    #[test]
    fn small_swings_are_the_normal_modes() {
        // ω² = (g/l)(2 ± √2), with θ2 = ∓√2 θ1.
        for sign in [-1.0, 1.0] {
            let theta1 = 1e-6;
            let state = State::rest([theta1, -sign * 2f64.sqrt() * theta1]);
            let [a1, _] = unit().acceleration(&state);
            assert!((-a1 / theta1 - (2.0 + sign * 2f64.sqrt())).abs() < 1e-9);
        }
    }

    #[test]
    fn reduced_units_move_the_same_way() {
        let pendulum = Pendulum::rods([0.3, 2.0], [0.4, 0.6], 1.62);
        let (reduced, unit_secs) = pendulum.reduced();
        let state = State { angle: [1.1, -2.3], speed: [3.0, -4.0] };
        let scaled = State { angle: state.angle, speed: state.speed.map(|w| w * unit_secs) };
        let (plain, scaled) = (pendulum.acceleration(&state), reduced.acceleration(&scaled));
        for i in 0..2 {
            assert!((plain[i] * unit_secs * unit_secs / scaled[i] - 1.0).abs() < 1e-13);
        }
        let home = Pendulum::points([1.0, 1.0], [1.0, 1.0], 9.81f64).reduced().0;
        assert_eq!((home.a, home.b, home.p, home.least_det), (2.0, 1.0, 2.0, 1.0));
    }

    #[test]
    fn forbidden_shares_of_the_torus_are_the_known_ones() {
        let share = |pendulum: Pendulum<f64>, rule| {
            let n = 1000;
            let angle = |i: usize| (i as f64 + 0.5) / n as f64 * std::f64::consts::TAU;
            let count =
                (0..n * n).filter(|k| pendulum.forbids(rule, [angle(k / n), angle(k % n)])).count();
            count as f64 / (n * n) as f64
        };
        let rods = Pendulum::rods([1.0, 1.0], [1.0, 1.0], 9.81);
        assert!((share(unit(), Rule::Second) - 0.306437).abs() < 1e-4);
        assert!((share(rods, Rule::Second) - 0.243925).abs() < 1e-4);
        let (first, either) = (share(unit(), Rule::First), share(unit(), Rule::Either));
        assert!(first > 0.5 && either == share(unit(), Rule::Second));
    }

    #[test]
    fn no_pendulum_is_faster_than_the_bound() {
        let pendulum = Pendulum::points([1.0, 0.3], [1.0, 0.6], 9.81);
        let mut fastest = 0f64;
        for start in [[3.1, 3.1], [2.9, -3.0], [-1.0, 3.1]] {
            let mut orbit = crate::taylor::Orbit::new(pendulum, State::rest(start));
            while orbit.time() < 20.0 {
                orbit.step();
                fastest = orbit.state().speed.iter().fold(fastest, |f, w| f.max(w.abs()));
            }
        }
        assert!(fastest < pendulum.greatest_speed() && fastest > 0.3 * pendulum.greatest_speed());
    }

    #[test]
    fn without_gravity_everything_is_forbidden() {
        let weightless = Pendulum::points([1.0, 1.0], [1.0, 1.0], 0.0);
        assert!(weightless.forbids(Rule::Either, [3.0, 3.0]));
    }
}
